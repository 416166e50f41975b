//! A linearised increment with its contacts tied in the factor of its stiffness; not how their problem is
//! solved.

use crate::condensation::row;
use crate::driver::{Driver, Nesting};
use crate::interface::Kinematics;
use crate::norm::largest;
use crate::system::{Inaccurate, System};
use moreau_contact::Structure;
use moreau_laws::Local;
use nalgebra::{DVector, SMatrix};

/// A linearised increment seen from its contacts.
pub(crate) struct Tied<'a, const D: usize> {
    system: &'a mut System,
    /// B: rows of all components of all contacts, empty of those that are switched off.
    rows: Vec<Vec<(u32, f64)>>,
    /// f at the unknowns \[N\].
    load: Vec<f64>,
    /// Of every contact \[N/mm\].
    stiffness: Vec<f64>,
    ties: Vec<SMatrix<f64, D, D>>,
    pub(crate) solves: usize,
}

impl<'a, const D: usize> Tied<'a, D> {
    /// Under a load at every degree of freedom \[N\].
    pub(crate) fn new(
        driver: &Driver<D>,
        system: &'a mut System,
        kinematics: &[Kinematics<D>],
        load: &[f64],
    ) -> Self {
        let mut rows = Vec::with_capacity(D * kinematics.len());
        let mut stiffness = Vec::with_capacity(kinematics.len());
        for (footing, k) in driver.footings.iter().zip(kinematics) {
            let own = (footing.own.iter()).flat_map(|&(a, _)| (0..D).map(move |i| D * a + i));
            let own = own.filter_map(|dof| system.unknown(dof));
            let largest = own.map(|p| system.diagonal(p)).fold(0.0, f64::max);
            stiffness.push(if largest > 0.0 { largest } else { system.shift() });
            for j in 0..D {
                rows.push(match k.active[j] {
                    true => {
                        let unknown = |dof: usize| system.unknown(dof).map(|p| p as usize);
                        let row = row(footing, k, j, unknown).into_iter();
                        row.map(|(p, c)| (p as u32, c)).collect()
                    }
                    false => Vec::new(),
                });
            }
        }
        Self {
            load: system.at_unknowns(load),
            rows,
            stiffness,
            ties: Vec::new(),
            solves: 0,
            system,
        }
    }

    /// x ← x + Bᵀ z.
    fn spread(&self, z: impl Iterator<Item = f64>, x: &mut [f64]) {
        for (row, z) in self.rows.iter().zip(z) {
            for &(p, c) in row {
                x[p as usize] += c * z;
            }
        }
    }

    /// The displacement increments of all unknowns, (K + BᵀRB) Δu = f + Bᵀ z, written to `step` at every
    /// degree of freedom.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn expand(mut self, z: &DVector<f64>, step: &mut [f64]) -> Result<(), Inaccurate> {
        let mut f = std::mem::take(&mut self.load);
        self.spread(z.iter().copied(), &mut f);
        let mut x = f.clone();
        self.system.solve_tied(&mut x);
        self.solves += 1;
        let mut before = f64::INFINITY;
        loop {
            let held = self.held(&x);
            let given = largest(f.iter().chain(held.iter()).copied());
            let (mut left, expected) = self.system.left(&f, &x, given);
            self.spread(held.iter().map(|t| -t), &mut left);
            let found = largest(left.iter().copied());
            if found <= expected {
                break;
            }
            if !(found < 0.5 * before) {
                return Err(Inaccurate { found, expected });
            }
            before = found;
            self.system.solve_tied(&mut left);
            self.solves += 1;
            x.iter_mut().zip(left).for_each(|(x, c)| *x += c);
        }
        self.system.spread(&x, step);
        Ok(())
    }

    /// R B x.
    fn held(&self, x: &[f64]) -> DVector<f64> {
        let v = self.relative(x);
        let mut held = DVector::zeros(v.len());
        for (i, tie) in self.ties.iter().enumerate() {
            let own: Local<D> = v.fixed_rows::<D>(D * i).into();
            held.fixed_rows_mut::<D>(D * i).copy_from(&(tie * own));
        }
        held
    }

    /// B x.
    fn relative(&self, x: &[f64]) -> DVector<f64> {
        let sum = |row: &Vec<(u32, f64)>| row.iter().map(|&(p, c)| c * x[p as usize]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(sum))
    }
}

impl<const D: usize> Structure<D> for Tied<'_, D> {
    fn stiffness(&self, contact: usize) -> f64 {
        self.stiffness[contact]
    }

    fn tie(&mut self, ties: &[SMatrix<f64, D, D>]) -> bool {
        self.ties = ties.to_vec();
        let rows = &self.rows;
        let outcome = self.system.tie(|pattern, values| {
            for (i, tie) in ties.iter().enumerate().filter(|(_, t)| t.amax() > 0.0) {
                for j in 0..D {
                    for k in 0..D {
                        for &(p, a) in &rows[D * i + j] {
                            for &(q, b) in rows[D * i + k].iter().filter(|(q, _)| *q <= p) {
                                if let Some(slot) = pattern.slot(p, q) {
                                    values[slot as usize] += a * tie[(j, k)] * b;
                                }
                            }
                        }
                    }
                }
            }
        });
        outcome.is_ok()
    }

    fn displacement(&mut self, z: &DVector<f64>, loaded: bool) -> DVector<f64> {
        let mut x = match loaded {
            true => self.load.clone(),
            false => vec![0.0; self.load.len()],
        };
        self.spread(z.iter().copied(), &mut x);
        self.system.solve_tied(&mut x);
        self.solves += 1;
        self.relative(&x)
    }

    fn worth(&self) -> f64 {
        self.system.solves_per_factorisation()
    }
}

impl<const D: usize> Driver<D> {
    /// The nodes that the contacts couple, where contacts may be tied in the factor.
    pub(crate) fn coupled(&self) -> Option<Vec<Vec<usize>>> {
        let method = self.settings.contact.springs();
        let may = self.settings.nesting == Nesting::Inside && method.is_some();
        let of = |footing: &crate::interface::Footing<D>| {
            footing.weights().map(|(a, _)| a).collect::<Vec<usize>>()
        };
        may.then(|| self.footings.iter().map(of).collect())
    }
}
