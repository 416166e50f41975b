//! A linearised increment with its contacts tied in the factor of its stiffness; not how their problem is
//! solved.

use crate::driver::Driver;
use crate::error::Inaccurate;
use crate::interface::elimination::{Elimination, row};
use crate::linear::suspension::{spring, steepness};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics};
use crate::settings::{Nesting, Seam};
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::{Springs, Structure, TiedFactor};
use moreau_laws::{Local, Status};
use nalgebra::{DMatrix, DVector, Dyn, LU, SMatrix};
use std::collections::BTreeMap;

/// Ties that hold what touches, over the stiffness of a contact: the structure is softer by its inverse.
const FIRM: f64 = 1e5;

/// Right-hand sides that an entry of the factor serves when it is read.
const AT_ONCE: usize = 8;

/// What one of so many takes, over one alone: 0.27 to 0.32 by `cargo run --release -p moreau-algebra --example
/// engines 16 24 30`.
const TOGETHER: f64 = 0.3;

/// How much an entry of B may have changed, with frames that turn, since a factor of which the ties serve on: as
/// often as they are firmer than the structure, this is the part by which a step is wrong, and what is wrong vanishes
/// with the steps.
const TURNED: f64 = 1e-6;

/// Rounding of the force of a tie, over its stiffness times the largest displacement.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// B: rows of all components of all contacts, empty of those that are switched off.
type Rows = Vec<Vec<(u32, f64)>>;

/// The factor that the last contact problem of an increment has left.
#[derive(Debug, Default)]
pub(crate) struct Held<const D: usize> {
    /// The rows that its ties are in.
    pub(crate) rows: Rows,
    pub(crate) factor: TiedFactor<D>,
}

/// Whether rows are those of frames that have hardly turned; what an entry is of rounding may be left out.
fn are_near(a: &Rows, b: &Rows) -> bool {
    let at = |row: &[(u32, f64)], p: u32| {
        let found = row.binary_search_by_key(&p, |&(q, _)| q);
        found.map_or(0.0, |k| row[k].1)
    };
    let within = |a: &[(u32, f64)], b: &[(u32, f64)]| {
        (a.iter()).all(|&(p, value)| (value - at(b, p)).abs() <= TURNED)
    };
    a.len() == b.len() && (a.iter().zip(b)).all(|(a, b)| within(a, b) && within(b, a))
}

/// The rows of all contacts.
fn rows<const D: usize>(driver: &Driver<D>, system: &System, kinematics: &[Kinematics<D>]) -> Rows {
    let unknown = |dof: usize| system.unknown(dof).map(|p| p as usize);
    let directions = &system.prescribed().directions;
    let mut rows = Vec::with_capacity(D * kinematics.len());
    for (motion_row, k) in driver.footing.rows.iter().zip(kinematics) {
        for j in 0..D {
            rows.push(match k.active[j] {
                true => {
                    let row = row((motion_row, directions), k, j, unknown).into_iter();
                    row.map(|(p, c)| (p as u32, c)).collect()
                }
                false => Vec::new(),
            });
        }
    }
    rows
}

/// A linearised increment seen from its contacts.
pub(crate) struct Tied<'a, const D: usize> {
    system: &'a mut System,
    rows: Rows,
    /// The rows that ties are in.
    tied_rows: &'a mut Rows,
    /// f at the unknowns \[N\].
    load: Vec<f64>,
    /// Of every contact \[N/mm\].
    stiffness: Vec<f64>,
    ties: Vec<SMatrix<f64, D, D>>,
    border: Option<Border>,
    /// Stiffness of a proximal term on the contacts, part of K \[N/mm\].
    pub(crate) soft: f64,
    pub(crate) solves: usize,
}

/// A load q of unknown factor λ, the equation q·u + c λ = m that decides it, and a node that is held by
/// springs whose force vanishes: what K alone leaves free at collapse.
struct Border {
    /// q at the unknowns \[N\].
    load: Vec<f64>,
    compliance: f64,
    missing: f64,
    /// Unknowns of the node.
    pivot: Vec<usize>,
    /// Their springs \[N/mm\].
    spring: f64,
    /// What the factor makes of q and of unit forces at the node.
    answers: Vec<Vec<f64>>,
    /// The equations of λ and of the forces of the springs.
    equations: LU<f64, Dyn, Dyn>,
}

impl Border {
    /// Sets up the equations of the amounts from what the factor makes of each of them; false where nothing decides
    /// them.
    fn decide(&mut self, answers: Vec<Vec<f64>>) -> bool {
        // q·(x + Σ a y) + c λ = m, and a spring is as long as its node is displaced: s = x + Σ a y.
        let size = answers.len();
        let mut equations = DMatrix::identity(size, size);
        equations[(0, 0)] = self.compliance;
        for (k, answer) in answers.iter().enumerate() {
            equations[(0, k)] += dot(&self.load, answer);
            for (j, &p) in self.pivot.iter().enumerate() {
                equations[(1 + j, k)] -= answer[p];
            }
        }
        self.answers = answers;
        self.equations = equations.lu();
        self.equations.is_invertible()
    }

    /// Amounts of the load and of the spring forces, where the others displace by x.
    fn amounts(&self, x: &[f64], missing: f64) -> DVector<f64> {
        let mut value = DVector::zeros(1 + self.pivot.len());
        value[0] = missing - dot(&self.load, x);
        for (k, &p) in self.pivot.iter().enumerate() {
            value[1 + k] = x[p];
        }
        let zero = DVector::zeros(value.len());
        self.equations.solve(&value).unwrap_or(zero)
    }
}

/// x ← x + Bᵀ z.
fn spread(rows: &Rows, z: impl Iterator<Item = f64>, x: &mut [f64]) {
    for (row, z) in rows.iter().zip(z) {
        for &(p, c) in row {
            x[p as usize] += c * z;
        }
    }
}

/// B x.
fn relative(rows: &Rows, x: &[f64]) -> DVector<f64> {
    let sum = |row: &Vec<(u32, f64)>| row.iter().map(|&(p, c)| c * x[p as usize]).sum();
    DVector::from_iterator(rows.len(), rows.iter().map(sum))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<'a, const D: usize> Tied<'a, D> {
    /// Under a load at every degree of freedom \[N\], and one of unknown factor with c and m of its equation. What is
    /// held is kept if it serves here.
    pub(crate) fn new(
        driver: &Driver<D>,
        system: &'a mut System,
        kinematics: &[Kinematics<D>],
        load: &[f64],
        border: Option<(&SparseVector, f64, f64)>,
        (tied_rows, factor): (&'a mut Rows, &mut TiedFactor<D>),
    ) -> Self {
        let rows = rows(driver, system, kinematics);
        if border.is_some() || !system.holds_ties() || !are_near(tied_rows, &rows) {
            *factor = TiedFactor::default();
        }
        let mut stiffness = Vec::with_capacity(driver.footing.rows.len());
        for motion_row in &driver.footing.rows {
            let own = (motion_row.own.iter()).flat_map(|&(a, _)| (0..D).map(move |i| D * a + i));
            let own = own.filter_map(|dof| system.unknown(dof));
            let largest = own.map(|p| system.diagonal(p)).fold(0.0, f64::max);
            stiffness.push(if largest > 0.0 {
                largest
            } else {
                system.shift()
            });
        }
        let pivot = system.pivot.map_or(0..0, |a| D * a..D * a + D);
        let pivot = pivot.filter_map(|dof| system.unknown(dof));
        let border = border.map(|(load, compliance, missing)| Border {
            load: system.at_unknowns(|dof| load.at(dof)),
            compliance,
            missing,
            pivot: pivot.map(|p| p as usize).collect(),
            spring: system.shift(),
            answers: Vec::new(),
            equations: DMatrix::zeros(0, 0).lu(),
        });
        Self {
            load: system.at_unknowns(|dof| load[dof]),
            rows,
            tied_rows,
            stiffness,
            ties: factor.ties().to_vec(),
            border,
            soft: 0.0,
            solves: 0,
            system,
        }
    }

    /// Springs of components that follow from others, as where a node touches several tools or conditions prescribe a slip,
    /// from the last contact forces that were found; none of the others. See
    /// [`Suspended`](crate::linear::suspension::Suspended).
    pub(crate) fn suspension(
        &self,
        driver: &Driver<D>,
        kinematics: &[Kinematics<D>],
        force: &[Local<D>],
    ) -> Vec<Springs<D>> {
        let penalty = driver.compliances(kinematics);
        let of = |&force| Springs {
            compliance: Local::zeros(),
            force,
        };
        let mut springs: Vec<Springs<D>> = force.iter().map(of).collect();
        let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (c, point) in driver.points.iter().enumerate() {
            at.entry(point.node).or_default().push(c);
        }
        let may_follow =
            |points: &&Vec<usize>| points.len() > 1 || kinematics[points[0]].known_slip.is_some();
        for points in at.values().filter(may_follow) {
            let mut rows = Elimination::new(self.load.len());
            for &c in points {
                for j in (0..D).filter(|&j| kinematics[c].active[j]) {
                    let row = self.rows[D * c + j].iter();
                    let row = row.map(|&(p, v)| (p as usize, v)).collect();
                    if !rows.solve(D * c + j, &row, &[]) {
                        let steepness = steepness(&kinematics[c], &force[c], penalty[c][j]);
                        springs[c].compliance[j] = 1.0 / spring(self.stiffness[c], steepness);
                    }
                }
            }
        }
        springs
    }

    /// Factorises with what touches held to its surface, and what sticks in its place, by springs of a compliance
    /// \[mm/N\] where they have one; false where that leaves a motion without stiffness.
    pub(crate) fn hold_statuses(
        &mut self,
        status: &[Status],
        compliance: impl Fn(usize) -> Local<D>,
    ) -> bool {
        let of = |(i, status): (usize, &Status)| {
            let mut tie = SMatrix::<f64, D, D>::zeros();
            let held = match status {
                Status::Open => 0,
                Status::Slip => 1,
                Status::Stick | Status::Tied => D,
            };
            let (firm, springs) = (FIRM * self.stiffness[i], compliance(i));
            (0..held).for_each(|j| tie[(j, j)] = firm / (1.0 + firm * springs[j]));
            tie
        };
        let ties: Vec<_> = status.iter().enumerate().map(of).collect();
        self.tie(&ties)
    }

    /// The largest load at a node \[N\].
    pub(crate) fn largest_load(&self) -> f64 {
        largest(self.load.iter().copied())
    }

    /// A proximal term c/2 |v|² on the contacts, which makes K regular; whether it was another.
    pub(crate) fn hold(&mut self, c: f64) -> bool {
        std::mem::replace(&mut self.soft, c) != c
    }

    /// (R + c) B x.
    fn held(&self, x: &[f64]) -> DVector<f64> {
        let v = relative(self.tied_rows, x);
        let mut held = DVector::zeros(v.len());
        for (i, tie) in self.ties.iter().enumerate() {
            let own: Local<D> = v.fixed_rows::<D>(D * i).into();
            held.fixed_rows_mut::<D>(D * i)
                .copy_from(&(tie * own + own * self.soft));
        }
        held
    }

    /// Solves with the factor, and with the load of unknown factor; returns what that is.
    fn solve(&mut self, x: &mut [f64], missing: f64) -> f64 {
        self.system.solve_tied(x);
        self.solves += 1;
        self.add_border(x, missing)
    }

    /// Adds the answers to the load of unknown factor; returns what that is.
    fn add_border(&self, x: &mut [f64], missing: f64) -> f64 {
        let Some(border) = &self.border else {
            return 0.0;
        };
        let amounts = border.amounts(x, missing);
        for (answer, amount) in border.answers.iter().zip(amounts.iter()) {
            for (x, y) in x.iter_mut().zip(answer) {
                *x += amount * y;
            }
        }
        amounts[0]
    }

    /// The displacement increments of all unknowns, (K + BᵀRB) Δu = f + Bᵀ z + λ q, written to `step` at
    /// every degree of freedom, and λ.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn expand(mut self, z: &DVector<f64>, step: &mut [f64]) -> Result<f64, Inaccurate> {
        let mut f = std::mem::take(&mut self.load);
        spread(&self.rows, z.iter().copied(), &mut f);
        let mut x = f.clone();
        let missing = self.border.as_ref().map_or(0.0, |b| b.missing);
        let mut factor = self.solve(&mut x, missing);
        let mut before = f64::INFINITY;
        loop {
            let held = self.held(&x);
            let applied: Vec<f64> = match &self.border {
                Some(b) => f.iter().zip(&b.load).map(|(f, q)| f + factor * q).collect(),
                None => f.clone(),
            };
            let given = largest(applied.iter().chain(held.iter()).copied());
            let (mut left, mut expected) = self.system.left(&applied, &x, given);
            // Ties are so firm that what rounding leaves of them is more than that of the structure.
            let firmest = largest(self.ties.iter().map(|tie| tie.amax()));
            expected += ROUNDED * firmest * largest(x.iter().copied());
            spread(self.tied_rows, held.iter().map(|t| -t), &mut left);
            let found = largest(left.iter().copied());
            if found <= expected {
                break;
            }
            // What is no number is not below either.
            if found.is_nan() || found >= 0.5 * before {
                return Err(Inaccurate { found, expected });
            }
            before = found;
            factor += self.solve(&mut left, 0.0);
            x.iter_mut().zip(left).for_each(|(x, c)| *x += c);
        }
        self.system.spread(&x, step);
        Ok(factor)
    }
}

impl<const D: usize> Structure<D> for Tied<'_, D> {
    fn stiffness(&self, contact: usize) -> f64 {
        self.stiffness[contact]
    }

    fn tie(&mut self, ties: &[SMatrix<f64, D, D>]) -> bool {
        self.ties = ties.to_vec();
        self.tied_rows.clone_from(&self.rows);
        let (rows, soft) = (&self.rows, SMatrix::identity() * self.soft);
        let springs = self.border.as_ref().map(|b| (b.pivot.clone(), b.spring));
        let held = self.system.tie(|pattern, values| {
            for (i, tie) in ties.iter().enumerate() {
                let tie = tie + soft;
                if tie.amax() > 0.0 {
                    let own: [&[(u32, f64)]; D] = std::array::from_fn(|j| &*rows[D * i + j]);
                    for (p, q, value) in congruence(own, &tie) {
                        if let Some(slot) = pattern.slot(p, q) {
                            values[slot as usize] += value;
                        }
                    }
                }
            }
            if let Some((pivot, spring)) = springs {
                pivot
                    .into_iter()
                    .for_each(|p| values[pattern.diagonal(p)] += spring);
            }
        });
        held && self.make_border()
    }

    fn displacement(&mut self, z: &DVector<f64>, loaded: bool) -> DVector<f64> {
        let mut x = match loaded {
            true => self.load.clone(),
            false => vec![0.0; self.load.len()],
        };
        let missing = self.border.as_ref().filter(|_| loaded).map(|b| b.missing);
        spread(&self.rows, z.iter().copied(), &mut x);
        self.solve(&mut x, missing.unwrap_or(0.0));
        relative(&self.rows, &x)
    }

    fn displacements(&mut self, z: &[DVector<f64>]) -> Vec<DVector<f64>> {
        let size = self.load.len();
        let mut answers = Vec::with_capacity(z.len());
        for some in z.chunks(AT_ONCE) {
            let mut columns = vec![0.0; size * some.len()];
            let each = |k: usize| size * k..size * (k + 1);
            for (k, z) in some.iter().enumerate() {
                spread(&self.rows, z.iter().copied(), &mut columns[each(k)]);
            }
            self.system.solve_tied(&mut columns);
            self.solves += some.len();
            for k in 0..some.len() {
                let x = &mut columns[each(k)];
                self.add_border(x, 0.0);
                answers.push(relative(&self.rows, x));
            }
        }
        answers
    }

    fn worth(&self) -> f64 {
        self.system.solves_per_factorisation()
    }

    fn together(&self) -> f64 {
        TOGETHER
    }
}

/// Entries of the lower triangle of Σ row_j R_jk row_kᵀ.
fn congruence<const D: usize>(
    rows: [&[(u32, f64)]; D],
    tie: &SMatrix<f64, D, D>,
) -> Vec<(u32, u32, f64)> {
    let mut entries = Vec::new();
    for j in 0..D {
        for k in (0..D).filter(|&k| tie[(j, k)] != 0.0) {
            for &(p, a) in rows[j] {
                let lower = rows[k].iter().filter(|(q, _)| *q <= p);
                entries.extend(lower.map(|&(q, b)| (p, q, a * tie[(j, k)] * b)));
            }
        }
    }
    entries
}

impl<const D: usize> Tied<'_, D> {
    /// Eliminates the factor of the load and the springs of the pivot with the factor at hand; false where
    /// nothing decides them.
    fn make_border(&mut self) -> bool {
        let Some(mut border) = self.border.take() else {
            return true;
        };
        let unit = |p: usize| {
            let mut e = vec![0.0; self.load.len()];
            e[p] = border.spring;
            e
        };
        let mut answers = vec![border.load.clone()];
        answers.extend(border.pivot.iter().map(|&p| unit(p)));
        for answer in &mut answers {
            self.system.solve_tied(answer);
            self.solves += 1;
        }
        let decided = border.decide(answers);
        self.border = Some(border);
        decided
    }
}

impl<const D: usize> Driver<D> {
    /// The nodes that the contacts couple, where contacts may be tied in the factor.
    pub(crate) fn coupled(&self, seam: Seam, loading: &Loading<D>) -> Option<Vec<Vec<usize>>> {
        let method = self.settings.contact.springs();
        // Which nodes are coupled must not change within an increment.
        let may = !self.repairs()
            && self.settings.nesting == Nesting::Inside
            && seam != Seam::Condensed
            && method.is_some();
        may.then(|| self.nodes_of_points(loading, |_| true))
    }

    /// The nodes that contact forces couple which turn with tools under large strains, where these are driven.
    pub(crate) fn turned(&self, loading: &Loading<D>) -> Vec<Vec<usize>> {
        let is_driven = |&tool: &usize| {
            let node = self.tool_node(tool);
            loading.axle_of(tool).is_some()
                || (D * node..D * node + D).any(|dof| !loading.displacement.contains_key(&dof))
        };
        let large = self.has_large_strains();
        self.nodes_of_points(loading, |p| large && p.tool.as_ref().is_some_and(is_driven))
    }

    /// The nodes of the rows of some contact points, that of the turn of a tool with them.
    fn nodes_of_points(
        &self,
        loading: &Loading<D>,
        of: impl Fn(&ContactPoint<D>) -> bool,
    ) -> Vec<Vec<usize>> {
        let pairs = self.points.iter().zip(&self.footing.rows);
        let nodes = |(point, row): (&ContactPoint<D>, &RelativeMotionRow<D>)| {
            let turns = point.tool.filter(|&tool| loading.axle_of(tool).is_some());
            let turn = turns.map(|tool| self.turn_dof(tool) / D);
            row.nodes().into_iter().chain(turn).collect()
        };
        pairs.filter(|(p, _)| of(p)).map(nodes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain whose end only a spring holds, under f and a load of unknown factor.
    #[test]
    fn amounts_leave_the_springs_without_force_and_decide_the_factor() {
        // Two masses that nothing but their own spring connects: K alone is singular.
        let k = DMatrix::from_row_slice(2, 2, &[3.0, -3.0, -3.0, 3.0]);
        let (load, compliance, missing, spring) = (vec![1.0, 2.0], 0.5, 0.7, 40.0);
        let mut held = k.clone();
        held[(1, 1)] += spring;
        let solve = |f: &[f64]| -> Vec<f64> {
            let x = held.clone().lu().solve(&DVector::from_column_slice(f));
            x.expect("regular").as_slice().to_vec()
        };
        let mut border = Border {
            load: load.clone(),
            compliance,
            missing,
            pivot: vec![1],
            spring,
            answers: Vec::new(),
            equations: DMatrix::zeros(0, 0).lu(),
        };
        let answers = vec![solve(&load), solve(&[0.0, spring])];
        assert!(border.decide(answers.clone()));
        let f = [0.4, -0.9];
        let mut x = solve(&f);
        let amounts = border.amounts(&x, missing);
        for (x, k) in x.iter_mut().zip(0..) {
            *x += amounts[0] * answers[0][k] + amounts[1] * answers[1][k];
        }
        let factor = amounts[0];
        let left = &k * DVector::from_column_slice(&x);
        for i in 0..2 {
            assert!((left[i] - f[i] - factor * load[i]).abs() < 1e-12);
        }
        assert!((dot(&load, &x) + compliance * factor - missing).abs() < 1e-12);
    }
}
