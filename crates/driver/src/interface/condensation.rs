//! The contact problem condensed from the interface unknowns, and the way back to them; not how
//! it is solved.

use crate::interface::elimination::{Elimination, Transformation, row};
use crate::linear::suspension::{Suspended, precedence, steepness};
use crate::linear::system::System;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics};
use moreau_algebra::{DenseCholesky, DenseLdlt, less_gram, mirror, transposed_product};
use moreau_contact::{CondensedProblem, ContactError};
use moreau_laws::{Local, Status};
use nalgebra::{DMatrix, DVector};

/// The contact problem of a linearised increment, and the way back to the interface unknowns.
///
/// The interface unknowns x of all contact nodes, on both sides, are expressed by the local
/// displacements u and by as many others, y, as are left: x = T (u − u_now, y), so that B x =
/// u − u_now. Contact forces do work on u alone, and y is condensed out of Tᵀ S T. A tool leaves no
/// y. Contacts that are left out of the problem are without force too: their u are among the y.
pub(crate) struct Condensation<const D: usize> {
    pub(crate) problem: CondensedProblem<D>,
    transformation: Transformation,
    rest: InternalUnknowns,
    /// Contacts of the problem, and those that are left out of it.
    pub(crate) contacts: Vec<usize>,
    left_out: Vec<usize>,
    /// Which of the motions of all contacts and then of the other unknowns the unknowns of the problem and its y are; `None`
    /// where no contact is left out.
    places: Option<Vec<usize>>,
    /// Components of the problem that are not switched off.
    active: Vec<bool>,
}

impl<const D: usize> Condensation<D> {
    /// Turns stiffness and load of the condensed system into the local frames of the contacts, of which `among` are those of
    /// the problem, in order;
    /// `previous` are the contact forces at the start of the step, `force` the last that were found, `springs` those of
    /// a penalty in series with the contacts \[mm/N\].
    ///
    /// # Errors
    /// [`ContactError::Singular`] if a body is not held even with all its contacts stuck;
    /// [`ContactError::Overconstrained`] where displacement conditions leave contacts no freedom.
    pub(crate) fn new(
        system: &System,
        (stiffness, load): (DMatrix<f64>, &DVector<f64>),
        (points, motion_rows): (&[ContactPoint<D>], &[RelativeMotionRow<D>]),
        (kinematics, among): (&[Kinematics<D>], Vec<usize>),
        (previous, force, springs): (&[Local<D>], &[Local<D>], &[Local<D>]),
    ) -> Result<Self, ContactError> {
        let contacts = (points, motion_rows);
        let InFrames {
            transformation,
            mut stiffness,
            mut load,
        } = InFrames::new(
            system,
            (stiffness, load),
            contacts,
            kinematics,
            (force, springs),
        )?;
        let is_left_out = |c: &usize| among.binary_search(c).is_err();
        let left_out: Vec<usize> = (0..points.len()).filter(is_left_out).collect();
        let places = places::<D>(&among, &left_out, load.len());
        if let Some(order) = &places {
            switch_off(&mut stiffness, kinematics, left_out.iter().map(|&c| (c, c)));
            load = DVector::from_iterator(order.len(), order.iter().map(|&k| load[k]));
            let entry = |i: usize, j: usize| stiffness[(order[i], order[j])];
            stiffness = DMatrix::from_fn(order.len(), order.len(), entry);
        }
        let (mut stiffness, load, rest) =
            InternalUnknowns::condense(stiffness, load, D * among.len())?;
        switch_off(
            &mut stiffness,
            kinematics,
            among.iter().copied().enumerate(),
        );
        let of = || among.iter().map(|&c| &kinematics[c]);
        let now: Vec<Local<D>> = of().map(|k| k.u).collect();
        let laws = of().map(|k| k.law).collect();
        let previous = among.iter().map(|&c| previous[c]).collect();
        let problem = CondensedProblem::new(stiffness, load, now, laws, previous)?;
        Ok(Self {
            problem,
            transformation,
            rest,
            active: of().flat_map(|k| (0..D).map(|j| k.active[j])).collect(),
            contacts: among,
            left_out,
            places,
        })
    }

    /// The motions of all contacts and then the other unknowns, from those of the problem and its y.
    fn moved(&self, motion: &DVector<f64>, y: &DVector<f64>) -> DVector<f64> {
        let values = motion.iter().chain(y.iter()).copied();
        match &self.places {
            None => DVector::from_iterator(motion.len() + y.len(), values),
            Some(places) => {
                let mut moved = DVector::zeros(places.len());
                places
                    .iter()
                    .zip(values)
                    .for_each(|(&k, value)| moved[k] = value);
                moved
            }
        }
    }

    /// Forces on the motions of all contacts and then on the other unknowns, on those of the problem first.
    fn seen(&self, forces: DVector<f64>) -> DVector<f64> {
        match &self.places {
            None => forces,
            Some(places) => DVector::from_iterator(places.len(), places.iter().map(|&k| forces[k])),
        }
    }

    /// Motions u − u_now of the contacts that are left out, each with its contact.
    pub(crate) fn left_out(&self, motion: &[Local<D>]) -> Vec<(usize, Local<D>)> {
        let components = motion.iter().flat_map(|u| (0..D).map(|j| u[j]));
        let motion = DVector::from_iterator(D * motion.len(), components);
        let y = self.rest.expand(&motion, self.rest.load.clone());
        let of = |(i, &c): (usize, &usize)| (c, Local::from_fn(|j, _| y[D * i + j]));
        self.left_out.iter().enumerate().map(of).collect()
    }

    /// Interface displacements x for displacements u − u_now.
    pub(crate) fn interface(&self, motion: &[Local<D>]) -> DVector<f64> {
        let components = motion.iter().flat_map(|u| (0..D).map(|j| u[j]));
        let motion = DVector::from_iterator(D * motion.len(), components);
        let y = self.rest.expand(&motion, self.rest.load.clone());
        self.transformation.apply(&self.moved(&motion, &y))
    }

    /// The interface as it is under these statuses; `None` if they leave it a rigid motion.
    pub(crate) fn yielding(&self, status: &[Status]) -> Option<Yielding<'_, D>> {
        let free: Vec<usize> = (0..self.active.len())
            .filter(|&k| self.active[k] && gives_way(status[k / D], k % D))
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

/// Components of the contacts of the problem, of those left out, and the unknowns after them, of so many in all; `None` where
/// that is their order.
fn places<const D: usize>(among: &[usize], left_out: &[usize], all: usize) -> Option<Vec<usize>> {
    let contacts = among.iter().chain(left_out);
    let components = contacts.flat_map(|&c| D * c..D * c + D);
    let others = D * (among.len() + left_out.len())..all;
    (!left_out.is_empty()).then(|| components.chain(others).collect())
}

/// Components that take no part in the law: alone on their diagonal, of the size of their neighbours. Contacts come with their
/// places.
fn switch_off<const D: usize>(
    stiffness: &mut DMatrix<f64>,
    kinematics: &[Kinematics<D>],
    contacts: impl Iterator<Item = (usize, usize)>,
) {
    let typical = stiffness.diagonal().amax().max(f64::MIN_POSITIVE);
    for (i, c) in contacts {
        for j in (0..D).filter(|&j| !kinematics[c].active[j]) {
            stiffness[(D * i + j, D * i + j)] = typical;
        }
    }
}

/// The condensed system in (u, y), before y is condensed out.
pub(crate) struct InFrames {
    pub(crate) transformation: Transformation,
    /// Tᵀ S T \[N/mm\], and the springs of what is suspended.
    pub(crate) stiffness: DMatrix<f64>,
    load: DVector<f64>,
}

impl InFrames {
    /// Of a stiffness and a load of the interface unknowns; `force` are the last contact forces that were found,
    /// `springs` those of a penalty in series with the contacts \[mm/N\].
    ///
    /// # Errors
    /// [`ContactError::Overconstrained`] where displacement conditions leave contacts no freedom.
    pub(crate) fn new<const D: usize>(
        system: &System,
        (stiffness, load): (DMatrix<f64>, &DVector<f64>),
        (points, motion_rows): (&[ContactPoint<D>], &[RelativeMotionRow<D>]),
        kinematics: &[Kinematics<D>],
        (force, springs): (&[Local<D>], &[Local<D>]),
    ) -> Result<Self, ContactError> {
        let mut order: Vec<(usize, usize)> = (kinematics.iter().enumerate())
            .flat_map(|(c, k)| (0..D).filter(|&j| k.active[j]).map(move |j| (c, j)))
            .collect();
        let eliminated = |order: &[(usize, usize)]| {
            let mut rows = Elimination::new(load.len());
            let mut suspended = Vec::new();
            for &(c, j) in order {
                let k = &kinematics[c];
                let row_of = |j: usize| {
                    let given = (&motion_rows[c], &system.prescribed().directions);
                    row(given, k, j, |dof| system.interface_index(dof))
                };
                let row = row_of(j);
                let own = (0..D).filter_map(|i| system.interface_index(D * points[c].node + i));
                let own: Vec<usize> = own.collect();
                let is_known = j > 0 && k.known_slip.is_some();
                if row.is_empty() && !is_known {
                    return Err(ContactError::Overconstrained { contact: c });
                }
                if !rows.solve(D * c + j, &row, &own) {
                    suspended.push(Suspended {
                        component: D * c + j,
                        measure: if is_known { row_of(0) } else { row.clone() },
                        row,
                        force: force[c][j],
                        steepness: steepness(k, &force[c], springs[c][j]),
                    });
                }
            }
            Ok((rows, suspended))
        };
        let (mut rows, mut suspended) = eliminated(&order)?;
        // Of the nodes in corners between tools any order does.
        let pairs = || {
            points
                .iter()
                .zip(motion_rows)
                .filter(|(p, _)| p.tool.is_none())
        };
        let is_between = |s: &Suspended| {
            let node = points[s.component / D].node;
            pairs().any(|(_, row)| row.weights().any(|(a, _)| a == node))
        };
        if suspended.iter().any(is_between) {
            order.sort_by_key(|&(c, j)| precedence(&kinematics[c].law, &force[c], j));
            (rows, suspended) = eliminated(&order)?;
        }
        let transformation = rows.finish(D * points.len());
        let of_node = system.shift();
        let springs = suspended.iter().map(|s| s.spring(&stiffness, of_node));
        let springs: Vec<f64> = springs.collect();
        let mut stiffness = transformation.congruence(&stiffness);
        let mut load = transformation.transposed(load);
        for (own, spring) in suspended.iter().zip(springs) {
            let row = transformation.combination(&own.row);
            own.add(spring, &row, (&mut stiffness, &mut load));
        }
        Ok(Self {
            transformation,
            stiffness,
            load,
        })
    }
}

/// Whether a status leaves a component of a relative displacement free, under a shear that stays what it is.
pub(crate) fn gives_way(status: Status, component: usize) -> bool {
    match status {
        Status::Open => true,
        Status::Slip => component > 0,
        Status::Stick | Status::Tied => false,
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
        let g = self.condensation.seen(transformation.transposed(g));
        let (own, load) = rest.reduce(&g, active.len());
        let mut x = DVector::from_iterator(self.free.len(), self.free.iter().map(|&k| own[k]));
        self.factor.forward_one(&mut x);
        self.factor.backward_one(&mut x);
        let mut u = DVector::zeros(active.len());
        for (&k, x) in self.free.iter().zip(x.iter()) {
            u[k] = *x;
        }
        let y = rest.expand(&u, load);
        transformation.apply(&self.condensation.moved(&u, &y))
    }
}

/// The unknowns y that no contact force acts on: y = S_yy⁻¹ (f_y − S_yu u).
struct InternalUnknowns {
    factor: Factor,
    /// L⁻¹ S_yu of a definite factor, else S_yy⁻¹ S_yu.
    coupling: DMatrix<f64>,
    /// L⁻¹ f_y of a definite factor, else S_yy⁻¹ f_y.
    load: DVector<f64>,
}

/// Of S_yy.
enum Factor {
    /// There are no such unknowns.
    None,
    Definite(DenseCholesky),
    /// Where bodies are unstable, however their contacts are held.
    Indefinite(DenseLdlt),
}

/// Eigenvalue of S_yy, over its largest diagonal, below which it is rounding of a rigid motion, if others are negative.
const FAINT: f64 = 1e-9;

impl Factor {
    /// # Errors
    /// [`ContactError::Singular`].
    fn new(block: impl Fn() -> DMatrix<f64>) -> Result<Self, ContactError> {
        let own = block();
        let stiffest = own.diagonal().amax();
        let definite = DenseCholesky::new(own).filter(|f| f.holds(stiffest));
        if let Some(factor) = definite {
            return Ok(Self::Definite(factor));
        }
        DenseLdlt::new(block())
            .filter(|factor| factor.inertia(FAINT * stiffest).zero == 0)
            .map(Self::Indefinite)
            .ok_or(ContactError::Singular)
    }
}

impl InternalUnknowns {
    /// Schur complement and load on the first `kept` unknowns, and the way back to the others.
    ///
    /// # Errors
    /// [`ContactError::Singular`].
    fn condense(
        s: DMatrix<f64>,
        f: DVector<f64>,
        kept: usize,
    ) -> Result<(DMatrix<f64>, DVector<f64>, Self), ContactError> {
        let others = s.nrows() - kept;
        let mut rest = Self {
            factor: Factor::None,
            coupling: s.view((kept, 0), (others, kept)).into_owned(),
            load: DVector::zeros(0),
        };
        if others == 0 {
            return Ok((s, f, rest));
        }
        rest.factor = Factor::new(|| s.view((kept, kept), (others, others)).into_owned())?;
        let own = match &rest.factor {
            Factor::None => s,
            Factor::Definite(factor) => {
                factor.forward(&mut rest.coupling);
                less_gram(s, &rest.coupling)
            }
            Factor::Indefinite(factor) => {
                let coupling = rest.coupling.clone();
                for mut column in rest.coupling.column_iter_mut() {
                    let mut answer = column.clone_owned();
                    factor.solve(&mut answer);
                    column.copy_from(&answer);
                }
                let mut own = s.view((0, 0), (kept, kept)).into_owned();
                own -= transposed_product(&coupling, &rest.coupling);
                mirror(&mut own);
                own
            }
        };
        let (load, y) = rest.reduce(&f, kept);
        rest.load = y;
        Ok((own, load, rest))
    }

    /// A load reduced to the first `kept` unknowns, and [`Self::load`] of it.
    fn reduce(&self, f: &DVector<f64>, kept: usize) -> (DVector<f64>, DVector<f64>) {
        let given = f.rows(kept, f.len() - kept).into_owned();
        let mut y = given.clone();
        let on_y = match &self.factor {
            Factor::None => &y,
            Factor::Definite(factor) => {
                factor.forward_one(&mut y);
                &y
            }
            Factor::Indefinite(factor) => {
                factor.solve(&mut y);
                &given
            }
        };
        (f.rows(0, kept) - self.coupling.tr_mul(on_y), y)
    }

    /// y for u and [`Self::load`] of a load.
    fn expand(&self, u: &DVector<f64>, load: DVector<f64>) -> DVector<f64> {
        let mut y = load - &self.coupling * u;
        if let Factor::Definite(factor) = &self.factor {
            factor.backward_one(&mut y);
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Schur complement is what the whole system answers on what is kept, of a stable structure and of one that is not.
    #[test]
    fn condensing_keeps_the_solution() {
        let l = DMatrix::from_fn(5, 5, |i, j| {
            if i >= j {
                1.0 + (i + 2 * j) as f64 * 0.3
            } else {
                0.0
            }
        });
        let f = DVector::from_fn(5, |i, _| (i as f64).cos());
        for signs in [
            [1.0; 5],
            [1.0, 1.0, 1.0, -1.0, 1.0],
            [-1.0, 1.0, -2.0, 1.0, -1.0],
        ] {
            let s = &l * DMatrix::from_diagonal(&DVector::from(signs.to_vec())) * l.transpose();
            let (own, load, rest) =
                InternalUnknowns::condense(s.clone(), f.clone(), 2).expect("regular");
            assert_eq!(own, own.transpose());
            let x = s.lu().solve(&f).expect("regular");
            let u = own.lu().solve(&load).expect("regular");
            assert!((&u - x.rows(0, 2)).norm() < 1e-10 * x.norm().max(1.0));
            let y = rest.expand(&u, rest.load.clone());
            assert!((y - x.rows(2, 3)).norm() < 1e-10 * x.norm().max(1.0));
        }
        let floating = DMatrix::from_element(3, 3, 1.0);
        assert!(InternalUnknowns::condense(floating, DVector::zeros(3), 1).is_err());
        // Rounding makes it no unstable one.
        let mut nearly = DMatrix::from_element(3, 3, 1.0);
        nearly[(2, 2)] -= 1e-13;
        assert!(InternalUnknowns::condense(nearly, DVector::zeros(3), 1).is_err());
    }
}
