//! Laws of materials that are classes of Python, asked for all points of a panel in one call; what they are is in
//! `python/moreau_fem/law.py`.

use moreau::driver::LawFault;
use moreau::laws::{NoAnswer, Panel, PanelLaw};
use moreau::mandel::{Sym2, Sym4};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyTuple};
use std::sync::{Arc, Mutex, PoisonError};

/// What laws have raised and nobody has taken yet.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    /// The first that was raised since it was taken.
    pub(crate) fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Keeps what was raised, and tells it in words.
    fn keep(&self, error: PyErr) -> NoAnswer {
        let told = NoAnswer(error.to_string());
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(error);
        told
    }

    /// What a law raised, or what is wrong with its answer as an exception that tells where.
    pub(crate) fn or_fault(&self, py: Python<'_>, fault: &LawFault) -> PyErr {
        self.take().unwrap_or_else(|| law_error(py, fault))
    }
}

fn law_error(py: Python<'_>, fault: &LawFault) -> PyErr {
    let place = match fault {
        LawFault::NotFinite { place, .. } | LawFault::Unsymmetric { place, .. } => Some(place),
        _ => None,
    };
    let place = place.map(|p| (p.cell, p.point, p.position.clone()));
    let error = py.import("moreau_fem.errors").and_then(|errors| {
        let kind = errors.getattr("LawError")?;
        match place {
            Some((cell, point, position)) => {
                let position = PyTuple::new(py, position)?;
                kind.call1((fault.to_string(), cell, point, position))
            }
            None => kind.call1((fault.to_string(),)),
        }
    });
    error.map_or_else(|error| error, PyErr::from_value)
}

/// A law as `moreau_fem.law.Asked` hands it over.
#[derive(Debug)]
pub(crate) struct PythonLaw {
    asked: Py<PyAny>,
    fields: Vec<(String, usize)>,
    initial: Vec<f64>,
    symmetric: bool,
    raised: Raised,
}

impl PythonLaw {
    pub(crate) fn new(asked: &Bound<'_, PyAny>, raised: &Raised) -> PyResult<Self> {
        Ok(Self {
            fields: asked.getattr("fields")?.extract()?,
            initial: asked.getattr("initial")?.extract()?,
            symmetric: asked.getattr("symmetric")?.extract()?,
            asked: asked.clone().unbind(),
            raised: raised.clone(),
        })
    }

    fn ask(&self, py: Python<'_>, panel: Panel<'_>) -> PyResult<()> {
        let strain = bytes(py, 6 * panel.d_eps.len(), panel.d_eps.iter().flatten())?;
        let state = bytes(py, panel.old.len(), panel.old)?;
        let answer = self.asked.bind(py);
        let answer = answer.call_method1("respond", (strain, state))?;
        let (stress, tangent, new): (PyBuffer<f64>, PyBuffer<f64>, PyBuffer<f64>) =
            answer.extract()?;
        let [stress, tangent, new] = [stress, tangent, new].map(|array| array.to_vec(py));
        for (out, own) in panel.stress.iter_mut().zip(stress?.chunks_exact(6)) {
            *out = Sym2::from_column_slice(own);
        }
        for (out, own) in panel.tangent.iter_mut().zip(tangent?.chunks_exact(36)) {
            *out = Sym4::from_row_slice(own);
        }
        // Shapes have been looked at.
        for (out, own) in panel.new.iter_mut().zip(new?) {
            *out = own;
        }
        Ok(())
    }
}

/// Numbers as bytes, which an array takes as they are.
fn bytes<'py, 'a>(
    py: Python<'py>,
    count: usize,
    values: impl IntoIterator<Item = &'a f64>,
) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, 8 * count, |bytes| {
        for (bytes, x) in bytes.chunks_exact_mut(8).zip(values) {
            bytes.copy_from_slice(&x.to_ne_bytes());
        }
        Ok(())
    })
}

impl PanelLaw for PythonLaw {
    fn initial(&self) -> Vec<f64> {
        self.initial.clone()
    }

    fn fields(&self) -> Vec<(String, usize)> {
        self.fields.clone()
    }

    fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    fn respond(&self, panel: Panel<'_>) -> Result<(), NoAnswer> {
        Python::attach(|py| self.ask(py, panel)).map_err(|error| self.raised.keep(error))
    }
}
