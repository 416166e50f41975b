//! The history: a row for each converged increment; contact points have a table of their own.

use crate::deck::{Setup, Unit, Units, columns};
use crate::driver::{Driver, IncrementReport, Loading, ModelError, Numbers, PointField, Saved};
use crate::mandel::{Sym2, von_mises};
use crate::table::{Column, Table, Values};
use nalgebra::SVector;

/// Where an increment is.
pub(super) struct Place<'a> {
    /// Number of the step, from 1.
    pub(super) stage: usize,
    /// Directions in which the step holds or moves each group.
    pub(super) directions: &'a [Vec<usize>],
}

/// Index of the column `time`.
const TIME: usize = 2;

/// What a load factor rounds, as a part of its step, where the structure carries no more.
const ROUNDING: f64 = 1e-9;

/// Reaction of a group whose supports were let go, by component: a force that goes in proportion to the step.
#[derive(Debug, Clone, Default, PartialEq)]
struct LetGo {
    at_start: Vec<f64>,
    now: Vec<f64>,
}

/// How a row is made, and those that were.
#[derive(Debug, Clone)]
pub(super) struct History {
    held: Vec<[String; 2]>,
    tools: Vec<String>,
    surfaces: Vec<String>,
    /// Whether there are moments of tools.
    moments: bool,
    /// Of every held group, and then of every surface.
    let_go: Vec<LetGo>,
    table: Table,
}

impl History {
    pub(super) fn new<const D: usize>(units: Units, setup: &Setup<D>) -> Self {
        let column = |(name, unit): (String, Unit)| Column {
            name,
            unit: unit.symbol(units).to_owned(),
            values: match unit {
                Unit::Count => Values::Counts(Vec::new()),
                _ => Values::Numbers(Vec::new()),
            },
        };
        Self {
            table: Table::new(columns(setup).into_iter().map(column).collect()),
            let_go: vec![
                LetGo {
                    at_start: vec![0.0; D],
                    now: vec![0.0; D],
                };
                setup.held.len() + setup.surfaces.len()
            ],
            held: setup.held.clone(),
            tools: setup.tools.clone(),
            surfaces: setup.surfaces.clone(),
            moments: setup.moments,
        }
    }

    pub(super) fn table(&self) -> &Table {
        &self.table
    }

    /// Takes note of the supports that a step to a loading lets go, beside what is left of those before. The directions
    /// are those in which the step before held each group, all where there is none.
    pub(super) fn begin<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        end: &Loading<D>,
        directions: &[Vec<usize>],
    ) {
        let groups = self.held.iter().map(|[_, nodes]| nodes);
        let groups = groups.chain(&self.surfaces);
        for (k, (group, own)) in groups.zip(&mut self.let_go).enumerate() {
            let force = driver
                .released(group, end)
                .unwrap_or_else(|_| SVector::zeros());
            let held = |i: usize| directions.get(k).is_none_or(|d| d.contains(&i));
            own.at_start.clone_from(&own.now);
            (0..D)
                .filter(|&i| held(i))
                .for_each(|i| own.at_start[i] += force[i]);
        }
    }

    /// Names of the held groups, and then of the surfaces.
    fn groups(&self) -> impl Iterator<Item = &String> {
        self.held.iter().map(|[name, _]| name).chain(&self.surfaces)
    }

    /// Takes over the rows of another, by the names of the columns; what it did not tell is not a number.
    pub(super) fn take_over(&mut self, other: &Self) {
        let theirs = |name: &String| other.groups().position(|n| n == name);
        let theirs: Vec<_> = self.groups().map(theirs).collect();
        for (own, k) in self.let_go.iter_mut().zip(theirs) {
            k.iter().for_each(|&k| own.clone_from(&other.let_go[k]));
        }
        let rows = other.table.rows();
        let theirs = |column: &Column| match other.table.column(&column.name) {
            Some(theirs) => theirs.values.clone(),
            None => Values::Numbers(vec![f64::NAN; rows]),
        };
        let column = |column: &Column| Column {
            values: theirs(column),
            ..column.clone()
        };
        self.table = Table::new(self.table.columns().iter().map(column).collect());
    }

    /// Forgets all rows but the last.
    pub(super) fn forget(&mut self) {
        let last = self.table.last();
        self.table.clear();
        last.iter().for_each(|row| self.table.push(row));
    }

    /// Makes the row of an increment.
    pub(super) fn record<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        report: &IncrementReport,
        place: &Place<'_>,
    ) {
        let energies = &report.energies;
        let time = (place.stage - 1) as f64 + report.fraction;
        let before = self.table.last().map_or(0.0, |row| row[TIME]);
        for group in &mut self.let_go {
            let left = group.at_start.iter().map(|f| f * (1.0 - report.fraction));
            group.now = left.collect();
        }
        let mut row = vec![
            place.stage as f64,
            report.increment as f64,
            match (0.0..ROUNDING).contains(&(before - time)) {
                true => before,
                false => time,
            },
            report.newton_iterations as f64,
            report.contact_iterations as f64,
            report.cuts as f64,
            report.open as f64,
            report.stick as f64,
            report.slip as f64,
            report.plastic_fraction,
            energies.external_work,
            energies.stored,
            energies.plastic_dissipation,
            energies.friction_dissipation,
            energies.penalty,
            report.certificate.bipotential_gap,
            report.certificate.penetration,
            report.certificate.excess_force,
            report.out_of_balance,
            report.factorisations as f64,
        ];
        let mut let_go = self.let_go.iter().map(|group| &group.now);
        for ([_, nodes], directions) in self.held.iter().zip(place.directions) {
            // A node on two groups is held by each along its own directions.
            let force = driver.reaction(nodes).ok();
            let held = |i: usize| match directions.contains(&i) {
                true => force.map_or(f64::NAN, |f| f[i]),
                false => 0.0,
            };
            let left = let_go.next().into_iter().flatten().enumerate();
            row.extend(left.map(|(i, left)| held(i) + left));
            row.extend(mean_displacement(driver, nodes));
        }
        for tool in &self.tools {
            let force = driver.tool_force(tool).ok();
            row.extend((0..D).map(|i| force.map_or(f64::NAN, |f| f[i])));
            let motion = driver.tool_displacement(tool).ok();
            row.extend((0..D).map(|i| motion.map_or(f64::NAN, |u| u[i])));
            if self.moments {
                let moment = driver.tool_moment(tool).ok();
                let axes = if D == 3 { 0..3 } else { 2..3 };
                row.extend(axes.clone().map(|i| moment.map_or(f64::NAN, |m| m[i])));
                let turn = driver.tool_turn(tool).ok();
                row.extend(axes.map(|i| turn.map_or(f64::NAN, |t| t[i].to_degrees())));
            }
        }
        for surface in &self.surfaces {
            let contact = driver.contact_force(surface).ok();
            let left = let_go.next().map(|f| SVector::from_column_slice(f));
            // What a probe is held by beside contact.
            let force = match driver.is_contact_surface(surface) {
                true => contact,
                false => contact
                    .zip(driver.reaction(surface).ok())
                    .zip(left)
                    .map(|((f, held), left)| f + held + left),
            };
            row.extend((0..D).map(|i| force.map_or(f64::NAN, |f| f[i])));
            row.extend(mean_displacement(driver, surface));
        }
        if driver.has_large_strains() {
            row.push(driver.worst_quality().0);
        }
        row.extend(driver.fields().iter().map(largest));
        self.table.push(&row);
    }

    /// The last value of a column, by name.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        let column = self.table.column(name)?;
        column.values.numbers().pop()
    }
}

impl Saved for History {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        for group in &mut self.let_go {
            numbers.list(&mut group.at_start)?;
            numbers.list(&mut group.now)?;
        }
        let mut rows = self.table.rows();
        numbers.count(&mut rows)?;
        let mut columns = self.table.columns().to_vec();
        for column in &mut columns {
            let mut values = column.values.numbers();
            numbers.list(&mut values)?;
            if values.len() != rows {
                return Err(ModelError::Saved {
                    what: "rows of the history",
                    found: values.len(),
                    expected: rows,
                });
            }
            column.values = match column.values {
                Values::Counts(_) => Values::Counts(values.iter().map(|&v| v as i64).collect()),
                _ => Values::Numbers(values),
            };
        }
        self.table = Table::new(columns);
        Ok(())
    }
}

/// Largest size of a field over the points of its law: the absolute value of a scalar, the length of a
/// vector, the equivalent value √(3/2 s : s) of a tensor.
fn largest(field: &PointField) -> f64 {
    let size = |v: &[f64]| match v.len() {
        6 => von_mises(&Sym2::from_column_slice(v)),
        _ => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
    };
    // Not a number where the law has no such field.
    let sizes = field.values.chunks_exact(field.components).map(size);
    sizes.fold(0.0, f64::max)
}

/// Mean displacement of the nodes of a group.
fn mean_displacement<const D: usize>(driver: &Driver<D>, group: &str) -> [f64; D] {
    let nodes = driver.mesh().node_group(group).unwrap_or_default();
    std::array::from_fn(|i| {
        let sum: f64 = nodes.iter().map(|&n| driver.displacement(n)[i]).sum();
        sum / nodes.len() as f64
    })
}
