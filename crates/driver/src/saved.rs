//! The state of a driver as a list of numbers, and back to the bit; not the file that holds them.

use crate::driver::{Driver, State};
use crate::error::ModelError;
use crate::model::load::Loading;
use crate::settings::Seam;
use crate::vector::SparseVector;
use moreau_contact::ContactSolution;
use moreau_laws::{Local, Status};
use nalgebra::{SVector, Vector};

/// Reads numbers in the order in which they were written.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    left: &'a [f64],
}

/// Statuses as numbers.
const STATUSES: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

impl<'a> Reader<'a> {
    /// From the first number on.
    pub fn new(numbers: &'a [f64]) -> Self {
        Self { left: numbers }
    }

    /// The next numbers.
    ///
    /// # Errors
    /// [`ModelError::Saved`] if there are fewer.
    pub fn take(&mut self, count: usize) -> Result<&'a [f64], ModelError> {
        let Some((head, tail)) = self.left.split_at_checked(count) else {
            return Err(ModelError::Saved {
                what: "numbers left",
                found: self.left.len(),
                expected: count,
            });
        };
        self.left = tail;
        Ok(head)
    }

    /// The next number.
    ///
    /// # Errors
    /// See [`Reader::take`].
    pub fn number(&mut self) -> Result<f64, ModelError> {
        Ok(self.take(1)?[0])
    }

    /// The next number, a count.
    ///
    /// # Errors
    /// See [`Reader::take`].
    pub fn count(&mut self) -> Result<usize, ModelError> {
        // A number that is no count becomes one that does not fit.
        Ok(self.number()? as usize)
    }

    /// A list of known length, with its count before it.
    fn list(&mut self, what: &'static str, expected: usize) -> Result<&'a [f64], ModelError> {
        let found = self.count()?;
        if found != expected {
            return Err(ModelError::Saved {
                what,
                found,
                expected,
            });
        }
        self.take(found)
    }

    fn vectors<const D: usize>(&mut self, count: usize) -> Result<Vec<Local<D>>, ModelError> {
        let numbers = self.take(D.saturating_mul(count))?;
        Ok(numbers.chunks(D).map(Local::from_column_slice).collect())
    }

    fn statuses(&mut self, count: usize) -> Result<Vec<Status>, ModelError> {
        let status = |&n: &f64| {
            STATUSES
                .get(n as usize)
                .copied()
                .ok_or(ModelError::OutOfRange {
                    what: "a saved contact status".into(),
                    value: n,
                    expected: "0, 1 or 2",
                })
        };
        self.take(count)?.iter().map(status).collect()
    }

    pub(crate) fn loading<const D: usize>(&mut self) -> Result<Loading<D>, ModelError> {
        let prescribed = self.count()?;
        let pairs = self.take(prescribed.saturating_mul(2))?;
        Ok(Loading {
            displacement: pairs.chunks(2).map(|p| (p[0] as usize, p[1])).collect(),
            force: self.sparse()?,
        })
    }

    fn sparse(&mut self) -> Result<SparseVector, ModelError> {
        let count = self.count()?;
        let pairs = self.take(count.saturating_mul(2))?;
        Ok(pairs.chunks(2).map(|p| (p[0] as usize, p[1])).collect())
    }
}

fn write_list(list: &[f64], out: &mut Vec<f64>) {
    out.push(list.len() as f64);
    out.extend(list);
}

fn write_sparse(pairs: impl ExactSizeIterator<Item = (usize, f64)>, out: &mut Vec<f64>) {
    out.push(pairs.len() as f64);
    out.extend(pairs.flat_map(|(dof, value)| [dof as f64, value]));
}

fn write_vectors<const D: usize>(list: &[Local<D>], out: &mut Vec<f64>) {
    out.extend(list.iter().flat_map(Vector::iter));
}

fn write_statuses(list: impl Iterator<Item = Status>, out: &mut Vec<f64>) {
    out.extend(list.map(|status| match status {
        Status::Open => 0.0,
        Status::Stick => 1.0,
        Status::Slip => 2.0,
    }));
}

pub(crate) fn write_loading<const D: usize>(loading: &Loading<D>, out: &mut Vec<f64>) {
    write_sparse(loading.displacement.iter().map(|(&dof, &u)| (dof, u)), out);
    write_sparse(loading.force.iter(), out);
}

impl<const D: usize> Driver<D> {
    /// Appends the committed state: all that [`Driver::read`] needs to go on as if nothing had
    /// happened.
    pub fn write(&self, out: &mut Vec<f64>) {
        let state = &self.state;
        out.extend([state.increment as f64, state.farthest]);
        write_list(&state.displacement, out);
        write_list(&state.internal, out);
        write_sparse(state.contact.iter(), out);
        write_loading(&state.loading, out);
        out.push(f64::from(u8::from(state.last.is_some())));
        if let Some((d_u, loading)) = &state.last {
            write_list(d_u, out);
            write_loading(loading, out);
        }
        let e = &state.energies;
        out.extend([e.external_work, e.stored, e.plastic_dissipation]);
        out.extend([e.friction_dissipation, e.penalty]);
        out.push(state.contacts.len() as f64);
        write_statuses(state.contacts.iter().map(|c| c.status), out);
        for c in &state.contacts {
            write_vectors(&[c.u, c.t, c.force, c.spring], out);
            out.extend([c.area, f64::from(u8::from(c.held))]);
        }
        out.push(f64::from(u8::from(state.solution.is_some())));
        if let Some(s) = &state.solution {
            write_vectors(&s.displacement, out);
            write_vectors(&s.irreversible, out);
            write_vectors(&s.force, out);
            write_statuses(s.status.iter().copied(), out);
            out.extend([s.iterations as f64, s.residual]);
        }
        for block in &self.blocks {
            write_list(&block.state(), out);
        }
        // An elastic factor at hand is not computed again: that counts.
        let held = self.system.as_ref();
        let elastic = held.is_some_and(crate::linear::system::System::holds_elastic_factor);
        out.push(f64::from(u8::from(held.is_some())));
        out.push(f64::from(u8::from(elastic)));
        out.push(f64::from(u8::from(
            held.is_some_and(crate::linear::system::System::is_tied),
        )));
        let pivot = held.and_then(|s| s.pivot);
        out.push(pivot.map_or(-1.0, |node| node as f64));
    }

    /// Takes over a state that [`Driver::write`] left of a driver of the same model.
    ///
    /// # Errors
    /// [`ModelError::Saved`] and [`ModelError::OutOfRange`] for numbers of another model; the
    /// driver is then of no use.
    pub fn read(&mut self, from: &mut Reader<'_>) -> Result<(), ModelError> {
        let (dofs, points) = (self.state.displacement.len(), self.points.len());
        let (increment, farthest) = (from.count()?, from.number()?);
        let displacement = from.list("degrees of freedom", dofs)?.to_vec();
        let internal = from.list("degrees of freedom", dofs)?.to_vec();
        let loads = Loading::<D> {
            force: from.sparse()?,
            ..Loading::default()
        };
        loads.check(self.mesh.nodes().len(), dofs)?;
        let contact = loads.force;
        let loading: Loading<D> = from.loading()?;
        loading.check(self.mesh.nodes().len(), dofs)?;
        let last = match from.count()? {
            0 => None,
            _ => Some((
                from.list("degrees of freedom", dofs)?.to_vec(),
                from.loading()?,
            )),
        };
        let mut energies = self.state.energies;
        for energy in [
            &mut energies.external_work,
            &mut energies.stored,
            &mut energies.plastic_dissipation,
            &mut energies.friction_dissipation,
            &mut energies.penalty,
        ] {
            *energy = from.number()?;
        }
        let found = from.count()?;
        if found != points {
            return Err(ModelError::Saved {
                what: "contact points",
                found,
                expected: points,
            });
        }
        let status = from.statuses(points)?;
        let mut contacts = self.state.contacts.clone();
        for (contact, status) in contacts.iter_mut().zip(status) {
            contact.status = status;
            for vector in [&mut contact.u, &mut contact.t] {
                *vector = SVector::from_column_slice(from.take(D)?);
            }
            contact.force = SVector::from_column_slice(from.take(D)?);
            contact.spring = SVector::from_column_slice(from.take(D)?);
            contact.area = from.number()?;
            contact.held = from.count()? == 1;
        }
        let solution = match from.count()? {
            0 => None,
            _ => Some(ContactSolution {
                displacement: from.vectors(points)?,
                irreversible: from.vectors(points)?,
                // Of the iteration that found it; the next begins where that has led.
                motion: vec![Local::zeros(); points],
                force: from.vectors(points)?,
                status: from.statuses(points)?,
                iterations: from.count()?,
                residual: from.number()?,
                exact: true,
            }),
        };
        for block in &mut self.blocks {
            let found = from.count()?;
            let expected = block.restore(from.take(found)?);
            if found != expected {
                return Err(ModelError::Saved {
                    what: "numbers of material states in a block",
                    found,
                    expected,
                });
            }
        }
        let (held, elastic) = (from.count()? == 1, from.count()? == 1);
        let seam = match from.count()? == 1 {
            true => Seam::Tied,
            false => Seam::Condensed,
        };
        let nodes = 0..self.mesh.nodes().len();
        let pivot = Some(from.number()?)
            .filter(|&n| n >= 0.0)
            .map(|n| n as usize);
        let pivot = pivot.filter(|node| nodes.contains(node));
        self.state = State {
            increment,
            displacement,
            last,
            internal,
            loading,
            energies,
            contacts,
            contact,
            farthest,
            solution,
        };
        self.system = None;
        if held {
            let loading = self.state.loading.clone();
            let mut system = self.elastic_system(&loading, pivot, seam)?;
            if elastic {
                // The elastic stiffness was positive definite when it was first factorised.
                let _ = system.factorise(true);
            }
            self.system = Some(system);
        }
        Ok(())
    }
}
