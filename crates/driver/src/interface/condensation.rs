//! The contact problem condensed from the interface unknowns, and the way back to them; not how
//! it is solved.

use crate::linear::suspension::Suspended;
use crate::linear::system::System;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics};
use crate::vector::directions::Directions;
use moreau_algebra::DenseCholesky;
use moreau_contact::{CondensedProblem, ContactError};
use moreau_laws::{Local, Status};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// The contact problem of a linearised increment, and the way back to the interface unknowns.
///
/// The interface unknowns x of all contact nodes, on both sides, are expressed by the local
/// displacements u and by as many others, y, as are left: x = T (u − u_now, y), so that B x =
/// u − u_now. Contact forces do work on u alone, and y is condensed out of Tᵀ S T. A tool leaves no
/// y.
pub(crate) struct Condensation<const D: usize> {
    pub(crate) problem: CondensedProblem<D>,
    transformation: Transformation,
    rest: InternalUnknowns,
    /// Components that are not switched off.
    active: Vec<bool>,
}

impl<const D: usize> Condensation<D> {
    /// Turns stiffness and load of the condensed system into the local frames of the contacts;
    /// `previous` are the contact forces at the start of the step, `force` the last that were found.
    ///
    /// # Errors
    /// [`ContactError::Singular`] if a body is not held even with all its contacts stuck;
    /// [`ContactError::Overconstrained`] where displacement conditions leave contacts no freedom.
    pub(crate) fn new(
        system: &System,
        (stiffness, load): (DMatrix<f64>, &DVector<f64>),
        (points, motion_rows): (&[ContactPoint<D>], &[RelativeMotionRow<D>]),
        kinematics: &[Kinematics<D>],
        (previous, force): (Vec<Local<D>>, &[Local<D>]),
    ) -> Result<Self, ContactError> {
        let mut rows = Elimination::new(load.len());
        let mut suspended = Vec::new();
        for (c, k) in kinematics.iter().enumerate() {
            for j in (0..D).filter(|&j| k.active[j]) {
                let given = (&motion_rows[c], &system.prescribed().directions);
                let row = row(given, k, j, |dof| system.interface_index(dof));
                let own = (0..D).filter_map(|i| system.interface_index(D * points[c].node + i));
                let own: Vec<usize> = own.collect();
                if row.is_empty() {
                    return Err(ContactError::Overconstrained { contact: c });
                }
                if !rows.solve(D * c + j, &row, &own) {
                    let (component, force) = (D * c + j, force[c][j]);
                    suspended.push(Suspended {
                        component,
                        row,
                        force,
                    });
                }
            }
        }
        let transformation = rows.finish(D * points.len());
        let springs: Vec<f64> = suspended.iter().map(|s| s.spring(&stiffness)).collect();
        let mut stiffness = transformation.congruence(stiffness);
        let mut load = transformation.transposed(load);
        for (own, spring) in suspended.iter().zip(springs) {
            let row = transformation.combination(&own.row);
            own.add(spring, &row, (&mut stiffness, &mut load));
        }
        let (mut stiffness, load, rest) =
            InternalUnknowns::condense(stiffness, load, D * points.len())?;
        // Components switched off: alone on their diagonal, of the size of their neighbours.
        let typical = stiffness.diagonal().amax().max(f64::MIN_POSITIVE);
        for (c, k) in kinematics.iter().enumerate() {
            for j in (0..D).filter(|&j| !k.active[j]) {
                stiffness[(D * c + j, D * c + j)] = typical;
            }
        }
        let now: Vec<Local<D>> = kinematics.iter().map(|k| k.u).collect();
        let laws = kinematics.iter().map(|k| k.law).collect();
        let problem = CondensedProblem::new(stiffness, load, now, laws, previous)?;
        Ok(Self {
            problem,
            transformation,
            rest,
            active: kinematics
                .iter()
                .flat_map(|k| (0..D).map(|j| k.active[j]))
                .collect(),
        })
    }

    /// Interface displacements x for displacements u − u_now.
    pub(crate) fn interface(&self, motion: &[Local<D>]) -> DVector<f64> {
        let components = motion.iter().flat_map(|u| (0..D).map(|j| u[j]));
        let motion = DVector::from_iterator(D * motion.len(), components);
        let y = self.rest.expand(&motion, self.rest.load.clone());
        self.transformation.apply(&motion, &y)
    }

    /// The interface as it is under these statuses; `None` if they leave it a rigid motion.
    pub(crate) fn yielding(&self, status: &[Status]) -> Option<Yielding<'_, D>> {
        let gives = |k: usize| match status[k / D] {
            Status::Open => true,
            Status::Slip => !k.is_multiple_of(D),
            Status::Stick | Status::Tied => false,
        };
        let free: Vec<usize> = (0..self.active.len())
            .filter(|&k| self.active[k] && gives(k))
            .collect();
        let stiffness = self.problem.stiffness();
        let own = DMatrix::from_fn(free.len(), free.len(), |i, j| stiffness[(free[i], free[j])]);
        let stiffest = own.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        let factor = DenseCholesky::new(own).filter(|f| f.holds(stiffest))?;
        Some(Yielding {
            condensation: self,
            factor,
            free,
        })
    }
}

/// The interface with what touches held to its surface, and what sticks to its place; the forces
/// of what slips do not change. What is left is as linear as the bodies are.
pub(crate) struct Yielding<'a, const D: usize> {
    condensation: &'a Condensation<D>,
    /// Components that give way.
    free: Vec<usize>,
    factor: DenseCholesky,
}

impl<const D: usize> Yielding<'_, D> {
    /// Interface displacements x under forces g at its unknowns \[N\], in the stiffness of the
    /// condensed system.
    pub(crate) fn displacement(&self, g: &DVector<f64>) -> DVector<f64> {
        let Condensation {
            transformation,
            rest,
            active,
            ..
        } = self.condensation;
        let g = transformation.transposed(g);
        let (own, load) = rest.reduce(&g, active.len());
        let mut x = DVector::from_iterator(self.free.len(), self.free.iter().map(|&k| own[k]));
        self.factor.forward_one(&mut x);
        self.factor.backward_one(&mut x);
        let mut u = DVector::zeros(active.len());
        for (&k, x) in self.free.iter().zip(x.iter()) {
            u[k] = *x;
        }
        let y = rest.expand(&u, load);
        transformation.apply(&u, &y)
    }
}

/// A component of the relative displacement as a combination of unknowns, those that a degree of
/// freedom is given by.
pub(crate) fn row<const D: usize>(
    (motion_row, directions): (&RelativeMotionRow<D>, &Directions),
    kinematics: &Kinematics<D>,
    component: usize,
    unknown: impl Fn(usize) -> Option<usize>,
) -> BTreeMap<usize, f64> {
    let mut row = BTreeMap::new();
    for (a, w) in motion_row.weights() {
        for i in 0..D {
            let along = |dof: usize| kinematics.axes[(dof - D * a, component)];
            let coefficient = w * directions.component(D * a + i, along);
            if let Some(dof) = unknown(D * a + i)
                && coefficient != 0.0
            {
                *row.entry(dof).or_insert(0.0) += coefficient;
            }
        }
    }
    if let Some((dof, coefficient)) = kinematics.turning(component)
        && let Some(dof) = unknown(dof)
        && coefficient != 0.0
    {
        row.insert(dof, coefficient);
    }
    row
}

/// A coefficient below this part of the relative displacement's is none.
const NONE: f64 = 1e-8;

/// Coefficient of an own unknown, over the largest, from which on it is the one solved for.
const OWN: f64 = 0.05;

/// Gauss–Jordan elimination of the rows B x = u, each for one interface unknown.
pub(crate) struct Elimination {
    /// Which of the solved unknowns each one is.
    place: Vec<Option<usize>>,
    solved: Vec<Solved>,
}

/// x_dof = Σ u-coefficients u + Σ x-coefficients x.
struct Solved {
    dof: usize,
    u: BTreeMap<usize, f64>,
    x: BTreeMap<usize, f64>,
}

impl Elimination {
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            place: vec![None; unknowns],
            solved: Vec::new(),
        }
    }

    /// Whether a row says something that those solved do not: whether after them a coefficient is left
    /// that is above a part of its largest.
    pub(crate) fn is_independent(&self, row: &BTreeMap<usize, f64>, part: f64) -> bool {
        let largest =
            |row: &BTreeMap<usize, f64>| row.values().fold(0.0, |m: f64, c| m.max(c.abs()));
        largest(&self.reduced(row.clone()).1) > part * largest(row)
    }

    /// Solves Σ row x = u_component, for one of the `own` unknowns if it can; false if no unknown
    /// is left to solve for.
    pub(crate) fn solve(
        &mut self,
        component: usize,
        row: &BTreeMap<usize, f64>,
        own: &[usize],
    ) -> bool {
        let (u, x) = self.reduced(row.clone());
        let largest = |among: &mut dyn Iterator<Item = (&usize, &f64)>| {
            among
                .map(|(&dof, &c)| (dof, c))
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        };
        let Some(any) = largest(&mut x.iter()).filter(|(_, c)| c.abs() > NONE) else {
            return false;
        };
        let (dof, pivot) = largest(&mut x.iter().filter(|(dof, _)| own.contains(dof)))
            .filter(|(_, c)| c.abs() >= OWN * any.1.abs())
            .unwrap_or(any);
        let over = |all: BTreeMap<usize, f64>| all.into_iter().map(move |(k, c)| (k, -c / pivot));
        let mut u: BTreeMap<usize, f64> = over(u).collect();
        u.insert(component, 1.0 / pivot);
        let x = over(x).filter(|(k, _)| *k != dof).collect();
        self.place[dof] = Some(self.solved.len());
        self.solved.push(Solved { dof, u, x });
        true
    }

    /// A combination of unknowns with those that are solved replaced.
    fn reduced(&self, mut x: BTreeMap<usize, f64>) -> (BTreeMap<usize, f64>, BTreeMap<usize, f64>) {
        let mut u = BTreeMap::new();
        // One that was solved earlier may bring in later ones, never the other way round.
        let first = |x: &BTreeMap<usize, f64>| {
            let places = x.keys().filter_map(|&dof| self.place[dof]);
            places.min()
        };
        while let Some(solved) = first(&x).map(|k| &self.solved[k]) {
            let c = x.remove(&solved.dof).unwrap_or(0.0);
            add(&mut u, &solved.u, c);
            add(&mut x, &solved.x, c);
        }
        (u, x)
    }

    /// Every unknown by the u of all components and the unknowns never solved for.
    fn finish(mut self, components: usize) -> Transformation {
        for k in (0..self.solved.len()).rev() {
            let x = std::mem::take(&mut self.solved[k].x);
            // All of those solved later have been finished.
            let (u, x) = self.reduced(x);
            add(&mut self.solved[k].u, &u, 1.0);
            self.solved[k].x = x;
        }
        let unknowns = self.place.len();
        let mut column = components;
        let mut columns = vec![0; unknowns];
        for dof in (0..unknowns).filter(|&dof| self.place[dof].is_none()) {
            columns[dof] = column;
            column += 1;
        }
        let row = |dof: usize| match self.place[dof] {
            None => vec![(columns[dof], 1.0)],
            Some(k) => {
                let Solved { u, x, .. } = &self.solved[k];
                let rest = x.iter().map(|(&dof, &c)| (columns[dof], c));
                u.iter().map(|(&k, &c)| (k, c)).chain(rest).collect()
            }
        };
        Transformation {
            rows: (0..unknowns).map(row).collect(),
            columns: column,
        }
    }
}

fn add(to: &mut BTreeMap<usize, f64>, from: &BTreeMap<usize, f64>, factor: f64) {
    for (&k, &c) in from {
        *to.entry(k).or_insert(0.0) += factor * c;
    }
}

/// The sparse matrix T of x = T (u, y), by rows.
struct Transformation {
    rows: Vec<Vec<(usize, f64)>>,
    columns: usize,
}

impl Transformation {
    fn apply(&self, u: &DVector<f64>, y: &DVector<f64>) -> DVector<f64> {
        let z = |k: usize| if k < u.len() { u[k] } else { y[k - u.len()] };
        let row = |row: &Vec<(usize, f64)>| row.iter().map(|&(k, c)| c * z(k)).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(row))
    }

    /// Σ row x by (u, y).
    fn combination(&self, row: &BTreeMap<usize, f64>) -> BTreeMap<usize, f64> {
        let mut sum = BTreeMap::new();
        for (&x, &c) in row {
            for &(z, t) in &self.rows[x] {
                *sum.entry(z).or_insert(0.0) += c * t;
            }
        }
        sum
    }

    /// Tᵀ f.
    fn transposed(&self, f: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(self.columns);
        for (row, f) in self.rows.iter().zip(f.iter()) {
            for &(k, c) in row {
                out[k] += c * f;
            }
        }
        out
    }

    /// Tᵀ S T of a symmetric S.
    fn congruence(&self, s: DMatrix<f64>) -> DMatrix<f64> {
        let own = |(i, row): (usize, &Vec<(usize, f64)>)| {
            let row = row.iter().map(move |&(k, c)| (i, k, c));
            row.collect::<Vec<_>>()
        };
        let entries: Vec<(usize, usize, f64)> =
            self.rows.iter().enumerate().flat_map(own).collect();
        let mut out = DMatrix::zeros(self.columns, self.columns);
        let mut column = DVector::zeros(self.columns);
        for (s, row) in s.column_iter().zip(&self.rows) {
            column.fill(0.0);
            for &(i, k, c) in &entries {
                column[k] += c * s[i];
            }
            for &(k, c) in row {
                out.column_mut(k).axpy(c, &column, 1.0);
            }
        }
        out.fill_upper_triangle_with_lower_triangle();
        out
    }
}

/// The unknowns y that no contact force acts on: y = S_yy⁻¹ (f_y − S_yu u).
struct InternalUnknowns {
    factor: Option<DenseCholesky>,
    /// L⁻¹ S_yu.
    coupling: DMatrix<f64>,
    /// L⁻¹ f_y.
    load: DVector<f64>,
}

impl InternalUnknowns {
    /// Schur complement and load on the first `kept` unknowns, and the way back to the others.
    fn condense(
        s: DMatrix<f64>,
        f: DVector<f64>,
        kept: usize,
    ) -> Result<(DMatrix<f64>, DVector<f64>, Self), ContactError> {
        let others = s.nrows() - kept;
        let mut rest = Self {
            factor: None,
            coupling: s.view((kept, 0), (others, kept)).into_owned(),
            load: DVector::zeros(0),
        };
        if others == 0 {
            return Ok((s, f, rest));
        }
        let own = s.view((0, 0), (kept, kept)).into_owned();
        let block = s.view((kept, kept), (others, others)).into_owned();
        let stiffest = block.diagonal().amax();
        let factor = DenseCholesky::new(block).filter(|f| f.holds(stiffest));
        let factor = factor.ok_or(ContactError::Singular)?;
        factor.forward(&mut rest.coupling);
        rest.factor = Some(factor);
        let mut own = own - rest.coupling.tr_mul(&rest.coupling);
        own.fill_upper_triangle_with_lower_triangle();
        let (load, y) = rest.reduce(&f, kept);
        rest.load = y;
        Ok((own, load, rest))
    }

    /// A load reduced to the first `kept` unknowns, and L⁻¹ f_y.
    fn reduce(&self, f: &DVector<f64>, kept: usize) -> (DVector<f64>, DVector<f64>) {
        let mut y = f.rows(kept, f.len() - kept).into_owned();
        if let Some(factor) = &self.factor {
            factor.forward_one(&mut y);
        }
        (f.rows(0, kept) - self.coupling.tr_mul(&y), y)
    }

    /// y for u and L⁻¹ f_y.
    fn expand(&self, u: &DVector<f64>, load: DVector<f64>) -> DVector<f64> {
        let mut y = load - &self.coupling * u;
        if let Some(factor) = &self.factor {
            factor.backward_one(&mut y);
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Rows that share unknowns, chained and in cycles: B T is the identity on u.
        #[test]
        fn the_transformation_inverts_the_rows(
            entries in prop::collection::vec(-1.0..1.0f64, 24),
            mask in prop::collection::vec(any::<bool>(), 24),
        ) {
            let (rows, unknowns) = (4, 6);
            let mut b = DMatrix::zeros(rows, unknowns);
            for (k, (&v, &m)) in entries.iter().zip(&mask).enumerate() {
                b[(k / unknowns, k % unknowns)] = if m { v } else { 0.0 };
            }
            for r in 0..rows {
                b[(r, r)] += 2.5;
            }
            let mut elimination = Elimination::new(unknowns);
            for r in 0..rows {
                let row = (0..unknowns).filter(|&i| b[(r, i)] != 0.0).map(|i| (i, b[(r, i)]));
                prop_assert!(elimination.solve(r, &row.collect(), &[r]));
            }
            let t = elimination.finish(rows);
            prop_assert_eq!(t.columns, unknowns);
            let identity = t.congruence(DMatrix::identity(unknowns, unknowns));
            let mut product = DMatrix::zeros(rows, unknowns);
            for k in 0..unknowns {
                let z = DVector::from_fn(unknowns, |i, _| f64::from(u8::from(i == k)));
                let x = t.apply(&z.rows(0, rows).into_owned(), &z.rows(rows, unknowns - rows).into_owned());
                product.set_column(k, &(&b * &x));
                prop_assert!((x.norm_squared() - identity[(k, k)]).abs() < 1e-10 * identity.amax());
            }
            prop_assert!((product - DMatrix::identity(rows, unknowns)).amax() < 1e-10);
        }
    }

    #[test]
    fn a_row_without_freedom_is_refused() {
        let mut elimination = Elimination::new(2);
        let row = |c: [f64; 2]| -> BTreeMap<usize, f64> { [(0, c[0]), (1, c[1])].into() };
        assert!(elimination.solve(0, &row([1.0, 2.0]), &[0]));
        assert!(elimination.solve(1, &row([1.0, -1.0]), &[0]));
        assert!(!elimination.solve(2, &row([3.0, 1.0]), &[0]));
    }

    /// The Schur complement is what the whole system answers on what is kept.
    #[test]
    fn condensing_keeps_the_solution() {
        let l = DMatrix::from_fn(5, 5, |i, j| {
            if i >= j {
                1.0 + (i + 2 * j) as f64 * 0.3
            } else {
                0.0
            }
        });
        let s = &l * l.transpose();
        let f = DVector::from_fn(5, |i, _| (i as f64).cos());
        let (own, load, rest) =
            InternalUnknowns::condense(s.clone(), f.clone(), 2).expect("definite");
        let x = s.lu().solve(&f).expect("regular");
        let u = own.lu().solve(&load).expect("regular");
        assert!((&u - x.rows(0, 2)).norm() < 1e-10);
        let y = rest.expand(&u, rest.load.clone());
        assert!((y - x.rows(2, 3)).norm() < 1e-10);
        let floating = DMatrix::from_element(3, 3, 1.0);
        assert!(InternalUnknowns::condense(floating, DVector::zeros(3), 1).is_err());
    }
}
