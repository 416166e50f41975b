//! A simulation, and its tables and grids as columns of bytes; no column is named here.

use crate::law::{PythonLaw, Raised};
use moreau::deck::{Findings, Given, Laws, Severity};
use moreau::driver::IncrementError;
use moreau::laws::PanelLaw;
use moreau::simulation::{Array, Grid, Simulation as Course, StepError};
use moreau::table::{Table, Values};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

/// Between two looks at the signals of the interpreter, which other threads may hold.
const LOOK: Duration = Duration::from_millis(10);

/// Severity, class, message, label, help, line and column, and the file if it is one that the deck includes.
type Found = (
    &'static str,
    &'static str,
    String,
    String,
    Option<String>,
    usize,
    usize,
    Option<PathBuf>,
);

/// Name, unit and values: bytes of numbers, bytes of whole numbers, or texts.
type Column = (String, String, Py<PyAny>);

/// Name, unit, components and bytes of numbers.
type Field = (String, &'static str, usize, Py<PyByteArray>);

/// Points, cells with the number of points before each, types, fields of points and of cells.
type Bodies = (
    Py<PyByteArray>,
    Py<PyByteArray>,
    Py<PyBytes>,
    Vec<Field>,
    Vec<Field>,
);

/// A deck under way.
#[pyclass(frozen)]
pub(crate) struct Simulation {
    course: Mutex<Course>,
    raised: Raised,
}

#[pymethods]
impl Simulation {
    /// Opens a deck with laws in place of those of its materials: the simulation unless it has errors, the findings,
    /// and these as text with the name of a file.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        text: String,
        folder: PathBuf,
        file: String,
        meshes: BTreeMap<PathBuf, Vec<u8>>,
        laws: BTreeMap<String, Bound<'_, PyAny>>,
    ) -> PyResult<(Option<Self>, Vec<Found>, String)> {
        let raised = Raised::default();
        let law =
            |(on, asked): (String, Bound<'_, PyAny>)| -> PyResult<(String, Arc<dyn PanelLaw>)> {
                Ok((on, Arc::new(PythonLaw::new(&asked, &raised)?)))
            };
        let given = Given {
            meshes,
            laws: laws.into_iter().map(law).collect::<PyResult<Laws>>()?,
            ..Given::default()
        };
        let (course, findings) = py.detach(|| Course::open(&text, &folder, &given));
        if let Some(error) = raised.take() {
            return Err(error);
        }
        let course = course.map(|course| Self {
            course: Mutex::new(course),
            raised,
        });
        let shown = findings.render(&file, &text, false);
        Ok((course, found(&findings, &text), shown))
    }

    /// Applies the next increment, with the interpreter free for others; whether there was one. A step that does not
    /// go on is none: the outcome tells.
    fn advance(&self, py: Python<'_>) -> PyResult<bool> {
        let mut course = self.course()?;
        let course = &mut *course;
        let mut raised = None;
        let outcome = py.detach(|| {
            let mut looked = Instant::now();
            course.advance(&mut |_, _| {
                if looked.elapsed() < LOOK {
                    return ControlFlow::Continue(());
                }
                looked = Instant::now();
                match Python::attach(|py| py.check_signals()) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(signal) => {
                        raised = Some(signal);
                        ControlFlow::Break(())
                    }
                }
            })
        });
        match (outcome, raised) {
            (Err(StepError::Increment(IncrementError::Interrupted)), Some(signal)) => Err(signal),
            (Err(StepError::Increment(IncrementError::Law(fault))), _) if fault.breaks_off() => {
                Err(self.raised.or_fault(py, &fault))
            }
            (outcome, _) => Ok(matches!(outcome, Ok(Some(_)))),
        }
    }

    /// Goes on with another step, the text of its keys: the findings, or, of one that is refused, also these as
    /// text.
    fn replace_step(&self, py: Python<'_>, step: String) -> PyResult<(Vec<Found>, Option<String>)> {
        let mut course = self.course()?;
        let course = &mut *course;
        let replaced = py.detach(|| course.replace_step(&step));
        if let Some(error) = self.raised.take() {
            return Err(error);
        }
        Ok(match replaced {
            Ok(findings) => (found(&findings, ""), None),
            Err(refused) => (
                found(&refused.findings, &refused.text),
                Some(refused.to_string()),
            ),
        })
    }

    /// The deck with every default spelt out.
    fn resolved(&self) -> PyResult<String> {
        Ok(self.course()?.deck().resolved())
    }

    /// Dimension, increments that have converged, and the part of all steps that is done.
    fn progress(&self) -> PyResult<(usize, usize, f64)> {
        let course = self.course()?;
        let course = &*course;
        let deck = course.deck();
        let done = course.done() / deck.steps.len().max(1) as f64;
        Ok((deck.analysis.dimension(), course.increments(), done))
    }

    /// `run.json`, and the summary for a person.
    fn outcome(&self) -> PyResult<(String, String)> {
        let outcome = self.course()?.outcome();
        Ok((outcome.json(), outcome.to_string()))
    }

    fn history(&self, py: Python<'_>) -> PyResult<Vec<Column>> {
        columns(py, self.course()?.history())
    }

    fn contacts(&self, py: Python<'_>) -> PyResult<Vec<Column>> {
        columns(py, &self.course()?.contacts())
    }

    /// Coordinates of the nodes and their displacements.
    fn nodes(&self, py: Python<'_>) -> PyResult<[Py<PyByteArray>; 2]> {
        let course = self.course()?;
        let course = &*course;
        Ok([&course.nodes()[..], course.displacements()].map(|v| numbers(py, v)))
    }

    /// The grid of this name, if there is one: `body`, `contact`, `points` or `failed`.
    fn grid(&self, py: Python<'_>, name: &str) -> PyResult<Option<Bodies>> {
        let course = self.course()?;
        let course = &*course;
        let grid = py.detach(|| match name {
            "body" => Some(Some(course.body())),
            "contact" => Some(course.surface()),
            "points" => Some(Some(course.points())),
            "failed" => Some(course.failed()),
            _ => None,
        });
        let expected = "expected \"body\", \"contact\", \"points\" or \"failed\"";
        let grid = grid.ok_or_else(|| {
            PyValueError::new_err(format!("there is no grid called {name:?}, {expected}"))
        })?;
        Ok(grid.map(|grid| bodies(py, course, &grid)))
    }

    /// Pictures as SVG, by name.
    #[pyo3(signature = (field=None, magnification=None))]
    fn pictures(
        &self,
        py: Python<'_>,
        field: Option<&str>,
        magnification: Option<f64>,
    ) -> PyResult<Vec<(&'static str, String)>> {
        let course = self.course()?;
        let course = &*course;
        Ok(py.detach(|| course.pictures(field, magnification)))
    }

    fn save(&self, py: Python<'_>) -> PyResult<Py<PyBytes>> {
        let course = self.course()?;
        let course = &*course;
        let state = py.detach(|| course.save());
        Ok(PyBytes::new(py, &state).unbind())
    }

    fn restore(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        let mut course = self.course()?;
        let course = &mut *course;
        let restored = py.detach(|| course.restore(state));
        restored.map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

impl Simulation {
    /// The simulation, if no other thread is at work on it.
    fn course(&self) -> PyResult<MutexGuard<'_, Course>> {
        match self.course.try_lock() {
            Ok(course) => Ok(course),
            Err(TryLockError::Poisoned(course)) => Ok(course.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread is at work on this simulation: give every thread its own",
            )),
        }
    }
}

fn found(findings: &Findings, text: &str) -> Vec<Found> {
    let one = |(finding, line, column): (&moreau::deck::Finding, usize, usize)| {
        let severity = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let (message, label) = (finding.message.clone(), finding.label.clone());
        let help = finding.help.clone();
        let file = findings.file(&finding.span).map(PathBuf::from);
        (
            severity,
            finding.class.name(),
            message,
            label,
            help,
            line,
            column,
            file,
        )
    };
    findings.places(text).map(one).collect()
}

fn numbers(py: Python<'_>, values: &[f64]) -> Py<PyByteArray> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    PyByteArray::new(py, &bytes).unbind()
}

fn counts(py: Python<'_>, values: &[i64]) -> Py<PyByteArray> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    PyByteArray::new(py, &bytes).unbind()
}

fn columns(py: Python<'_>, table: &Table) -> PyResult<Vec<Column>> {
    let column = |column: &moreau::table::Column| {
        let values = match &column.values {
            Values::Numbers(values) => ("numbers", numbers(py, values))
                .into_pyobject(py)?
                .into_any(),
            Values::Counts(values) => ("counts", counts(py, values)).into_pyobject(py)?.into_any(),
            Values::Texts(values) => ("texts", values).into_pyobject(py)?.into_any(),
        };
        Ok((column.name.clone(), column.unit.clone(), values.unbind()))
    };
    table.columns().iter().map(column).collect()
}

fn bodies(py: Python<'_>, course: &Course, grid: &Grid) -> Bodies {
    let fields = |arrays: &[Array]| {
        let field = |array: &Array| {
            let values = numbers(py, &array.values);
            (
                array.name.clone(),
                course.unit(&array.name),
                array.components,
                values,
            )
        };
        arrays.iter().map(field).collect()
    };
    let mut cells = Vec::new();
    for (points, _) in &grid.cells {
        cells.push(points.len() as i64);
        cells.extend(points);
    }
    let types: Vec<u8> = grid.cells.iter().map(|(_, kind)| *kind).collect();
    (
        numbers(py, &grid.points.concat()),
        counts(py, &cells),
        PyBytes::new(py, &types).unbind(),
        fields(&grid.point_data),
        fields(&grid.cell_data),
    )
}
