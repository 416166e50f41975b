//! Semismooth Newton method through the factor of a structure: its linear steps by a Krylov iteration on
//! vectors of the interface; not the structure.

use super::recycled::{LeastSquares, Recycled};
use super::{ContactSolution, Tolerance};
use crate::ContactError;
use crate::problem::{split, stack};
use crate::tied::TiedProblem;
use moreau_laws::{Local, Status};
use nalgebra::{DVector, SMatrix};

/// Ties over the stiffness of a contact: from here to a million times an iteration takes nearly the same
/// steps, and forces round off in proportion.
const TIGHT: f64 = 1e3;

/// α of the map, in parts of the stiffness of a contact, and the parts to try where Newton stalls.
const PARTS: [f64; 5] = [0.1, 1.0, 0.01, 1e-4, 1e-6];

/// Iterates of which the worst bounds the merit of the next.
const MEMORY: usize = 6;

/// How far below the worst of them it has to be.
const CLEARLY: f64 = 0.7;

/// Least part of a step that is worth taking before its equations are solved better.
const WORTH_TAKING: f64 = 0.3;

/// Iterations without progress after which a residual may be rounding, and that over the tolerance.
const STALLED: usize = 3;
const ROUNDED: f64 = 100.0;

/// Accuracies to which the equations of a step are solved in turn, over the first, where it is of no use.
const ACCURACIES: [f64; 3] = [1.0, 1e-2, 1e-5];

/// The first accuracy at most.
const INACCURATE: f64 = 0.01;

/// Halvings of a step.
const HALVINGS: usize = 7;

/// Directions of one step at most.
const LONGEST: usize = 120;

/// Compliance of the structure between the ties of a contact, over the inverse of its stiffness there: an
/// estimate that the Krylov iteration starts from.
const SOFTENED: f64 = 0.3;

/// Newton's method on the natural map of a tied problem.
///
/// With statuses come ties R: nothing where a contact is open, stiff springs across a closed gap and along
/// what sticks, and the stiffness of friction across the direction of slip. One factorisation of
/// K + BᵀRB answers them; the unknown left is z = t + R v, of which the map has about a unit derivative,
/// and what that lacks a Krylov iteration finds, with a solve for each of its directions. A new factor is
/// made where the statuses have changed and the directions that this has taken cost as much. It is the
/// augmented Lagrangian \[83\]–\[90\], its correction solved for instead of repeated: neither the ties
/// nor the accuracy of the iteration enter the result.
struct Tied<'a, 'b, const D: usize> {
    problem: &'a mut TiedProblem<'b, D>,
    /// α over the stiffness of a contact.
    part: f64,
    ties: Vec<SMatrix<f64, D, D>>,
    /// The statuses that the ties are of.
    tied: Vec<Status>,
    /// Solves since the factorisation.
    used: usize,
    /// What is tied beyond its status.
    propped: Vec<usize>,
    directions: Recycled,
}

/// Where the iteration stands.
struct At<const D: usize> {
    z: DVector<f64>,
    v: DVector<f64>,
    u: Vec<Local<D>>,
    t: Vec<Local<D>>,
    /// u + C (t − t*): the part that obeys the law.
    irreversible: Vec<Local<D>>,
    map: Vec<Local<D>>,
    residual: f64,
    merit: f64,
}

/// The linearised map of a contact: E dt + A du = −G.
struct Row<const D: usize> {
    elastic: SMatrix<f64, D, D>,
    shift: SMatrix<f64, D, D>,
    value: Local<D>,
}

/// A pair (u, t) that obeys the law, of which the statuses are expected.
struct Guess<const D: usize> {
    u: Vec<Local<D>>,
    irreversible: Vec<Local<D>>,
    t: Vec<Local<D>>,
}

/// Solves a tied problem to a tolerance, or to a residual that is `enough` \[N\] where that is larger. Returns with the solution z = t + R v of the ties R that were the last, for which
/// (K + BᵀRB) Δu = f + Bᵀ z.
///
/// Where the statuses leave the structure a rigid motion it is one of the solutions.
///
/// # Errors
/// [`ContactError::NotConverged`], and [`ContactError::Singular`] where nothing holds the structure.
pub fn solve_tied<const D: usize>(
    problem: &mut TiedProblem<'_, D>,
    guess: Option<&ContactSolution<D>>,
    (tolerance, enough): (Tolerance, f64),
) -> Result<(ContactSolution<D>, DVector<f64>), ContactError> {
    let mut guess = Guess::new(problem, guess);
    let mut newton = Tied {
        ties: Vec::new(),
        tied: Vec::new(),
        part: PARTS[0],
        used: 0,
        propped: Vec::new(),
        directions: Recycled::default(),
        problem,
    };
    let mut now = newton.begin(&mut guess)?;
    let mut first = Some(guess);
    // A body that only contact holds has no stiffness against contacts that open on the way: then they are
    // closed once more.
    let mut again = true;
    let mut progress = Progress::default();
    let mut part = 0;
    for iterations in 0..=tolerance.iterations {
        let target = newton.target(&now, tolerance, progress.stalls(now.residual));
        if now.residual <= target.max(PARTS[0] * enough) {
            if newton.part == PARTS[0] {
                let exact = now.residual <= target;
                return Ok(newton.solution(now, iterations, exact));
            }
            // Residuals are comparable at one α only.
            part = 0;
            now = newton.with_part(part, now);
            progress.forget();
            continue;
        }
        if !now.residual.is_finite() {
            break;
        }
        let status = newton.statuses(&now);
        let stale = newton.stale(&status);
        if first.is_none() && stale > 0 && newton.is_worn(stale) {
            now = newton.renew(now, &status)?;
        }
        let rows = match first.take() {
            Some(guess) => newton.rows_of_guess(&now, &guess),
            None => newton.rows(&now),
        };
        match newton.step(&rows, &now, progress.allowed(now.merit)) {
            Some(next) => now = next,
            None if newton.used > 1 && stale > 0 => now = newton.renew(now, &status)?,
            None if again && !newton.propped.is_empty() => {
                again = false;
                let mut closed = Guess {
                    u: now.u,
                    irreversible: now.irreversible,
                    t: now.t,
                };
                newton.part = PARTS[0];
                now = newton.begin(&mut closed)?;
                first = Some(closed);
                progress.forget();
            }
            None => {
                part += 1;
                if part == PARTS.len() {
                    break;
                }
                now = newton.with_part(part, now);
                progress.forget();
            }
        }
    }
    if !newton.propped.is_empty() {
        return Err(ContactError::Singular);
    }
    Err(ContactError::NotConverged {
        solver: "semismooth Newton through the factor",
        iterations: tolerance.iterations,
        residual: now.residual,
        tolerance: tolerance.relative * newton.force_scale(&now),
    })
}

/// How the iteration went so far.
struct Progress {
    merits: Vec<f64>,
    least: f64,
    /// Iterations since the residual was last halved.
    stalled: usize,
    begun: bool,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            merits: Vec::new(),
            least: f64::INFINITY,
            stalled: 0,
            begun: false,
        }
    }
}

impl Progress {
    /// Takes note of a residual; whether the last ones were no smaller.
    fn stalls(&mut self, residual: f64) -> bool {
        self.stalled = match residual < 0.5 * self.least {
            true => 0,
            false => self.stalled + 1,
        };
        self.least = self.least.min(residual);
        self.stalled >= STALLED
    }

    /// Takes note of a merit; what that of the next iterate may be. The first step is that of the guess.
    fn allowed(&mut self, merit: f64) -> f64 {
        self.merits.push(merit);
        let recent = &self.merits[self.merits.len().saturating_sub(MEMORY)..];
        let worst = recent.iter().copied().fold(0.0, f64::max);
        match std::mem::replace(&mut self.begun, true) {
            false => f64::INFINITY,
            true => merit.max(CLEARLY * worst),
        }
    }

    /// Merits of another α are no measure.
    fn forget(&mut self) {
        self.merits.clear();
    }
}

impl<const D: usize> Guess<D> {
    /// The last solution; without one, what is closed before anything has moved sticks.
    fn new(problem: &TiedProblem<'_, D>, solution: Option<&ContactSolution<D>>) -> Self {
        if let Some(s) = solution {
            return Self {
                u: s.displacement.clone(),
                irreversible: s.irreversible.clone(),
                t: s.force.clone(),
            };
        }
        let closed = |(i, g): (usize, &Local<D>)| {
            let mut pair = (Local::zeros(), Local::zeros());
            match g[0] <= 0.0 {
                true => pair.1[0] = problem.structure.stiffness(i),
                false => pair.0[0] = g[0],
            }
            pair
        };
        let pairs = problem.origin.iter().enumerate().map(closed);
        let (u, t): (Vec<Local<D>>, Vec<Local<D>>) = pairs.unzip();
        Self {
            irreversible: u.clone(),
            u,
            t,
        }
    }
}

impl<const D: usize> Tied<'_, '_, D> {
    /// Residual at which the law holds \[N\]. Where the iteration stalls solves round off, by what the structure is
    /// softer than its contacts are stiff.
    fn target(&self, now: &At<D>, tolerance: Tolerance, stalls: bool) -> f64 {
        let full = tolerance.relative * self.force_scale(now);
        let part = if stalls { ROUNDED } else { PARTS[0] };
        (part * full).max(self.rounding(now))
    }

    /// Another α, at the same place.
    fn with_part(&mut self, part: usize, now: At<D>) -> At<D> {
        self.part = PARTS[part];
        self.at(now.z, now.v)
    }

    /// How many statuses are not those of the ties.
    fn stale(&self, status: &[Status]) -> usize {
        let pairs = status.iter().zip(&self.tied);
        pairs.filter(|(a, b)| a != b).count()
    }

    /// Whether a new factor is cheaper than the solves that stale statuses will take beside those done.
    fn is_worn(&self, stale: usize) -> bool {
        (self.used + stale) as f64 >= self.problem.structure.worth()
    }

    fn alpha(&self, i: usize) -> f64 {
        let alpha = self.part * self.problem.structure.stiffness(i);
        alpha / (1.0 + alpha * self.problem.springs[i].compliance.mean())
    }

    /// The ties of a status at (u, t).
    fn tie(&self, i: usize, status: Status, u: &Local<D>, t: &Local<D>) -> SMatrix<f64, D, D> {
        let tight = TIGHT * self.problem.structure.stiffness(i);
        let mut tie = match status {
            Status::Open => return SMatrix::zeros(),
            Status::Stick => SMatrix::identity() * tight,
            Status::Slip => {
                let mut across = SMatrix::<f64, D, D>::zeros();
                across[(0, 0)] = tight;
                let (mut slip, mut shear) = (*u, *t);
                (slip[0], shear[0]) = (0.0, 0.0);
                let (length, force) = (slip.norm(), shear.norm());
                if D == 3 && force > 0.0 && length > 0.0 {
                    let d = slip / length;
                    let stiffness = (force / length).min(tight);
                    for j in 1..D {
                        for k in 1..D {
                            let one = f64::from(u8::from(j == k));
                            across[(j, k)] += stiffness * (one - d[j] * d[k]);
                        }
                    }
                }
                across
            }
        };
        let compliance = &self.problem.springs[i].compliance;
        if compliance.amax() > 0.0 {
            // In series with the springs: R (1 + C R)⁻¹.
            let series = SMatrix::identity() + SMatrix::from_diagonal(compliance) * tie;
            tie = series.try_inverse().map_or(tie, |inverse| tie * inverse);
            tie = (tie + tie.transpose()) * 0.5;
        }
        tie
    }

    /// Factorises with the ties of statuses at (u, t). Where that leaves the structure free to move, what
    /// slips and the smallest gaps are tied as what sticks.
    fn factorise(
        &mut self,
        status: &[Status],
        (u, t): (&[Local<D>], &[Local<D>]),
    ) -> Result<(), ContactError> {
        let count = status.len();
        self.ties = (0..count)
            .map(|i| self.tie(i, status[i], &u[i], &t[i]))
            .collect();
        self.tied = status.to_vec();
        self.used = 0;
        self.directions.clear();
        self.propped.clear();
        let mut loose: Vec<usize> = (0..count).filter(|&i| status[i] != Status::Stick).collect();
        loose.sort_by(|&a, &b| u[a][0].total_cmp(&u[b][0]));
        let mut more = 3 * D;
        let mut loose = loose.into_iter();
        while !self.problem.structure.tie(&self.ties) {
            let mut some = loose.by_ref().take(more).peekable();
            if some.peek().is_none() {
                return Err(ContactError::Singular);
            }
            for i in some {
                self.ties[i] = SMatrix::identity() * (TIGHT * self.problem.structure.stiffness(i));
                self.propped.push(i);
            }
            more *= 4;
        }
        Ok(())
    }

    /// Where the ties of a guess lead; what had to be tied beyond it is closed in the guess as well.
    fn begin(&mut self, guess: &mut Guess<D>) -> Result<At<D>, ContactError> {
        let (u, t) = (&guess.irreversible, &guess.t);
        let status: Vec<Status> = (0..u.len())
            .map(|i| self.problem.friction[i].status(&u[i], &t[i], self.alpha(i)))
            .collect();
        self.factorise(&status, (u, t))?;
        for &i in &self.propped {
            if status[i] == Status::Open {
                guess.u[i] = Local::zeros();
                guess.irreversible[i] = Local::zeros();
                guess.t[i] = Local::zeros();
                guess.t[i][0] = self.problem.structure.stiffness(i);
            }
        }
        let (u, t) = (&guess.u, &guess.t);
        let z: Vec<Local<D>> = (0..u.len())
            .map(|i| t[i] + self.ties[i] * (u[i] - self.problem.origin[i]))
            .collect();
        Ok(self.solve(stack(&z)))
    }

    /// Where z leads.
    fn solve(&mut self, z: DVector<f64>) -> At<D> {
        self.used += 1;
        let v = self.problem.structure.displacement(&z, true);
        self.at(z, v)
    }

    /// A new factor, with the ties of now.
    fn renew(&mut self, now: At<D>, status: &[Status]) -> Result<At<D>, ContactError> {
        self.factorise(status, (&now.u, &now.t))?;
        let v = split::<D>(&now.v);
        let z: Vec<Local<D>> = (0..v.len())
            .map(|i| now.t[i] + self.ties[i] * v[i])
            .collect();
        Ok(self.solve(stack(&z)))
    }

    fn at(&self, z: DVector<f64>, v: DVector<f64>) -> At<D> {
        let p = &*self.problem;
        let count = p.friction.len();
        let local =
            |all: &DVector<f64>, i: usize| -> Local<D> { all.fixed_rows::<D>(D * i).into() };
        let mut at = At {
            u: Vec::with_capacity(count),
            t: Vec::with_capacity(count),
            irreversible: Vec::with_capacity(count),
            map: Vec::with_capacity(count),
            residual: 0.0,
            merit: 0.0,
            z,
            v,
        };
        for i in 0..count {
            let v = local(&at.v, i);
            let t = local(&at.z, i) - self.ties[i] * v;
            let u = p.origin[i] + v;
            let springs = &p.springs[i];
            let irreversible = u + springs.compliance.component_mul(&(t - springs.force));
            let map = p.friction[i].natural_map(&irreversible, &t, self.alpha(i));
            at.residual = at.residual.max(map.norm());
            at.merit += map.norm_squared() / self.alpha(i);
            at.u.push(u);
            at.t.push(t);
            at.irreversible.push(irreversible);
            at.map.push(map);
        }
        at
    }

    fn statuses(&self, at: &At<D>) -> Vec<Status> {
        let p = &*self.problem;
        (0..at.u.len())
            .map(|i| p.friction[i].status(&at.irreversible[i], &at.t[i], self.alpha(i)))
            .collect()
    }

    /// Derivatives E and A of the map of a contact at (u, t).
    fn derivatives(&self, i: usize, u: &Local<D>, t: &Local<D>) -> [SMatrix<f64, D, D>; 2] {
        let law = &self.problem.friction[i];
        let (projector, shift) = law.correct_jacobian(u, t, self.alpha(i));
        let springs = SMatrix::from_diagonal(&self.problem.springs[i].compliance);
        [SMatrix::identity() - projector + shift * springs, shift]
    }

    fn rows(&self, now: &At<D>) -> Vec<Row<D>> {
        let row = |i: usize| {
            let [elastic, shift] = self.derivatives(i, &now.irreversible[i], &now.t[i]);
            Row {
                elastic,
                shift,
                value: -now.map[i],
            }
        };
        (0..now.u.len()).map(row).collect()
    }

    /// The map linearised where the last solution was, on the same side of its kinks.
    fn rows_of_guess(&self, now: &At<D>, guess: &Guess<D>) -> Vec<Row<D>> {
        let row = |i: usize| {
            let [elastic, shift] = self.derivatives(i, &guess.irreversible[i], &guess.t[i]);
            let (force, moved) = (now.t[i] - guess.t[i], now.u[i] - guess.u[i]);
            Row {
                value: -(elastic * force + shift * moved),
                elastic,
                shift,
            }
        };
        (0..now.u.len()).map(row).collect()
    }

    /// The next iterate; `None` if no step along what the Krylov iteration finds makes the merit smaller than
    /// allowed.
    fn step(&mut self, rows: &[Row<D>], now: &At<D>, allowed: f64) -> Option<At<D>> {
        let count = rows.len();
        let alpha: Vec<f64> = (0..count).map(|i| self.alpha(i)).collect();
        // P of every contact, and P (E z + (A − E R) W z).
        let preconditioners: Vec<SMatrix<f64, D, D>> = (0..count)
            .map(|i| {
                let soft = SOFTENED * self.problem.structure.stiffness(i);
                let own = (self.ties[i] + SMatrix::identity() * soft).try_inverse();
                let left = rows[i].shift - rows[i].elastic * self.ties[i];
                let sum = rows[i].elastic + left * own.unwrap_or_else(SMatrix::zeros);
                sum.try_inverse().unwrap_or_else(SMatrix::identity)
            })
            .collect();
        let image = |z: &DVector<f64>, answer: &DVector<f64>, ties: &[SMatrix<f64, D, D>]| {
            let mut out = DVector::zeros(z.len());
            for (i, row) in rows.iter().enumerate() {
                let z: Local<D> = z.fixed_rows::<D>(D * i).into();
                let w: Local<D> = answer.fixed_rows::<D>(D * i).into();
                let own = row.elastic * (z - ties[i] * w) + row.shift * w;
                out.fixed_rows_mut::<D>(D * i)
                    .copy_from(&(preconditioners[i] * own));
            }
            out
        };
        let values: Vec<Local<D>> = (0..count)
            .map(|i| preconditioners[i] * rows[i].value)
            .collect();
        let mut least = LeastSquares::new(stack(&values));
        // What is left of the equations, as the merit weighs it.
        let inverses: Vec<SMatrix<f64, D, D>> = preconditioners
            .iter()
            .map(|p| p.try_inverse().unwrap_or_else(SMatrix::identity))
            .collect();
        let weighed = |left: &DVector<f64>| -> f64 {
            let own = |i: usize| {
                let left: Local<D> = left.fixed_rows::<D>(D * i).into();
                (inverses[i] * left).norm_squared() / alpha[i]
            };
            (0..count).map(own).sum::<f64>().sqrt()
        };
        let size = (least.left.norm(), weighed(&least.left));
        for k in 0..self.directions.len() {
            let (z, answer) = self.directions.pair(k);
            least.add(image(z, answer, &self.ties));
        }
        let scale = self.force_scale(now);
        let coarse = INACCURATE.min((now.residual / scale).sqrt());
        let mut taken = 0;
        let mut best: Option<At<D>> = None;
        for (k, accuracy) in ACCURACIES.into_iter().enumerate() {
            let accuracy = coarse * accuracy;
            let solved = |left: &DVector<f64>| {
                left.norm() <= accuracy * size.0 && (k == 0 || weighed(left) <= accuracy * size.1)
            };
            while !solved(&least.left) && taken < LONGEST {
                let mut z = least.left.clone();
                let length = z.norm();
                z /= length;
                let answer = self.problem.structure.displacement(&z, false);
                self.used += 1;
                taken += 1;
                let independent = least.add(image(&z, &answer, &self.ties));
                self.directions.add(z, answer);
                if !independent {
                    taken = LONGEST;
                }
            }
            let (dz, dv) = self.directions.combined(&least.solution(), now.z.len());
            let mut part = 1.0;
            for _ in 0..HALVINGS {
                let trial = self.at(&now.z + &dz * part, &now.v + &dv * part);
                if trial.merit < (1.0 - 1e-4 * part) * allowed {
                    let better = trial.merit < now.merit || allowed.is_infinite();
                    if part > WORTH_TAKING && better {
                        return Some(trial);
                    }
                    best = Some(trial);
                    break;
                }
                part *= 0.5;
            }
            if taken >= LONGEST {
                break;
            }
        }
        best
    }

    /// Size of the forces in play \[N\].
    fn force_scale(&self, at: &At<D>) -> f64 {
        let forces = at.t.iter().chain(&self.problem.previous);
        let load = self.problem.load.max(f64::MIN_POSITIVE);
        forces.map(|t| t.norm()).fold(load, f64::max)
    }

    /// Rounding of the map \[N\]: of displacements in the stiffness of a contact, and of what ties hold, which
    /// forces are differences from.
    fn rounding(&self, at: &At<D>) -> f64 {
        let count = at.u.len();
        let stiffest = (0..count).map(|i| self.problem.structure.stiffness(i));
        let stiffest = stiffest.fold(0.0, f64::max);
        let held = stack(&at.t) - &at.z;
        let terms = ((D * count) as f64).sqrt();
        4.0 * f64::EPSILON * (terms * stiffest * at.v.amax() + held.amax())
    }

    fn solution(
        &self,
        now: At<D>,
        iterations: usize,
        exact: bool,
    ) -> (ContactSolution<D>, DVector<f64>) {
        let status = self.statuses(&now);
        // The projection of the last iterate lies in the cone exactly; it differs from t by less than the
        // residual.
        let force = now.t.iter().zip(&now.map).map(|(t, g)| t - g).collect();
        let solution = ContactSolution {
            residual: now.residual,
            motion: split(&now.v),
            displacement: now.u,
            irreversible: now.irreversible,
            force,
            status,
            iterations,
            exact,
        };
        (solution, now.z)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ContactSolver, SemismoothNewton};
    use super::*;
    use crate::ContactProblem;
    use crate::tied::{Springs, Structure};
    use moreau_laws::{AnisotropicCoulomb, Coulomb, Friction, LimitedCoulomb, Tresca};
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    /// A structure of which all displacements are those of its contacts: B = 1.
    struct Dense {
        stiffness: DMatrix<f64>,
        load: DVector<f64>,
        factor: Option<nalgebra::Cholesky<f64, nalgebra::Dyn>>,
        factorisations: usize,
        solves: usize,
    }

    impl<const D: usize> Structure<D> for Dense {
        fn stiffness(&self, contact: usize) -> f64 {
            (0..D)
                .map(|k| self.stiffness[(D * contact + k, D * contact + k)])
                .fold(0.0, f64::max)
        }

        fn tie(&mut self, ties: &[SMatrix<f64, D, D>]) -> bool {
            let mut sum = self.stiffness.clone();
            for (i, tie) in ties.iter().enumerate() {
                let mut own = sum.fixed_view_mut::<D, D>(D * i, D * i);
                own += tie;
            }
            self.factorisations += 1;
            self.factor = sum.cholesky();
            self.factor.is_some()
        }

        fn displacement(&mut self, z: &DVector<f64>, loaded: bool) -> DVector<f64> {
            self.solves += 1;
            let load = if loaded { z + &self.load } else { z.clone() };
            let factor = self.factor.as_ref().expect("tied");
            factor.solve(&load)
        }

        fn worth(&self) -> f64 {
            6.0
        }
    }

    fn random(seed: &[f64], k: usize) -> f64 {
        seed[k % seed.len()]
    }

    /// A chain of contacts, each coupled to all, the nearer the more; `rigid` leaves it a translation.
    fn sample<const D: usize>(
        contacts: usize,
        seed: &[f64],
        laws: &[Friction],
        rigid: bool,
    ) -> (Dense, ContactProblem<D>) {
        let n = D * contacts;
        let b = DMatrix::from_fn(n, n, |i, j| {
            random(seed, 7 * i + 3 * j) / (1.0 + i.abs_diff(j) as f64)
        });
        let mut s = &b * b.transpose() + DMatrix::identity(n, n) * 0.5;
        if rigid {
            // Nothing resists the mean of the first component.
            let mode = DVector::from_fn(n, |i, _| f64::from(u8::from(i % D == 0)));
            let forces = &s * &mode;
            s.ger(-1.0 / forces.dot(&mode), &forces, &forces, 1.0);
        }
        // The last pushes the body onto its contacts.
        let load = DVector::from_fn(n, |i, _| {
            let own = random(seed, 5 * i + 1);
            if i % D == 0 { -0.6 - own.abs() } else { own }
        });
        let origin = (0..contacts)
            .map(|i| Local::<D>::from_fn(|k, _| if k == 0 { 0.3 * random(seed, i) } else { 0.0 }));
        let law = |i: usize| laws[i % laws.len()];
        let friction: Vec<Friction> = (0..contacts).map(law).collect();
        let problem = ContactProblem::new(
            s.clone(),
            load.clone(),
            origin.collect(),
            friction,
            vec![Local::zeros(); contacts],
        );
        let dense = Dense {
            stiffness: s,
            load,
            factor: None,
            factorisations: 0,
            solves: 0,
        };
        (dense, problem.expect("valid"))
    }

    fn tied<const D: usize>(
        structure: &mut Dense,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let contacts = problem.contacts();
        let load = structure.load.amax();
        let mut own = TiedProblem {
            structure,
            origin: problem.origin().to_vec(),
            friction: problem.laws().to_vec(),
            springs: vec![Springs::default(); contacts],
            load,
            previous: problem.previous().to_vec(),
        };
        let asked = (SemismoothNewton::default().tolerance, 0.0);
        solve_tied(&mut own, guess, asked).map(|(solution, _)| solution)
    }

    /// The law holds, and the structure is in balance.
    fn assert_solves<const D: usize>(
        structure: &Dense,
        problem: &ContactProblem<D>,
        found: &ContactSolution<D>,
    ) -> Result<(), TestCaseError> {
        let scale = problem.force_scale(&found.force);
        let left =
            &structure.stiffness * stack(&found.motion) - &structure.load - stack(&found.force);
        prop_assert!(
            left.amax() < 1e-9 * scale,
            "out of balance by {:e}",
            left.amax()
        );
        let residual = problem.residual(&found.displacement, &found.force);
        prop_assert!(residual < 1e-9 * scale, "off the law by {residual:e}");
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// Below the friction at which solutions are several it is the one of the condensed problem.
        #[test]
        fn the_solution_is_that_of_the_condensed_problem(
            contacts in 1usize..9, seed in prop::collection::vec(-1.0..1.0f64, 37),
            kind in 0usize..4, rigid in any::<bool>(),
        ) {
            let coulomb = |mu: f64| Friction::from(Coulomb::new(mu).expect("valid"));
            let laws = [
                vec![coulomb(0.1), coulomb(0.0)],
                vec![Tresca::new(0.2).expect("valid").into()],
                vec![LimitedCoulomb::new(0.2, 0.3).expect("valid").into()],
                vec![AnisotropicCoulomb::new(0.05, 0.15).expect("valid").into()],
            ];
            let (mut structure, problem) = sample::<3>(contacts, &seed, &laws[kind], rigid);
            let expected = SemismoothNewton::default().solve(&problem, None);
            let found = tied(&mut structure, &problem, None);
            let (Ok(expected), Ok(found)) = (&expected, &found) else {
                prop_assert!(found.is_ok() || expected.is_err(), "{found:?}");
                return Ok(());
            };
            assert_solves(&structure, &problem, found)?;
            let scale = problem.force_scale(&expected.force);
            for (a, b) in found.force.iter().zip(&expected.force) {
                prop_assert!((a - b).norm() < 1e-8 * scale, "{a} {b}");
            }
            // From its own solution it takes one step at most.
            let again = tied(&mut structure, &problem, Some(found)).expect("solved before");
            prop_assert!(again.iterations <= 2, "{} iterations", again.iterations);
            assert_solves(&structure, &problem, &again)?;
        }

        #[test]
        fn in_the_plane_too(
            contacts in 1usize..12, seed in prop::collection::vec(-1.0..1.0f64, 41), mu in 0.0..0.3f64,
        ) {
            let law = Coulomb::new(mu).expect("valid").into();
            let (mut structure, problem) = sample::<2>(contacts, &seed, &[law], false);
            let found = tied(&mut structure, &problem, None);
            prop_assert!(found.is_ok(), "{found:?}");
            assert_solves(&structure, &problem, &found.expect("asked"))?;
        }
    }

    /// Springs in series are those of the penalty.
    #[test]
    fn springs_are_those_of_the_penalty() {
        use crate::Penalty;
        let seed: Vec<f64> = (0..37).map(|k| f64::sin(3.0 * f64::from(k))).collect();
        let law = Coulomb::new(0.2).expect("valid").into();
        let (mut structure, problem) = sample::<3>(6, &seed, &[law], false);
        let (normal, tangent) = (20.0, 5.0);
        let penalty = Penalty::new(normal, tangent).expect("valid");
        let expected = penalty.solve(&problem, None).expect("solved");
        let compliance = Local::<3>::new(1.0 / normal, 1.0 / tangent, 1.0 / tangent);
        let springs = Springs {
            compliance,
            force: Local::zeros(),
        };
        let load = structure.load.amax();
        let mut own = TiedProblem {
            structure: &mut structure,
            origin: problem.origin().to_vec(),
            friction: problem.laws().to_vec(),
            springs: vec![springs; 6],
            load,
            previous: problem.previous().to_vec(),
        };
        let (found, _) = solve_tied(&mut own, None, (penalty.tolerance, 0.0)).expect("solved");
        assert!(expected.force.iter().any(|t| t[0] > 0.1));
        for (a, b) in found.force.iter().zip(&expected.force) {
            assert!((a - b).norm() < 1e-9, "{a} {b}");
        }
        for (a, b) in found.irreversible.iter().zip(&expected.irreversible) {
            assert!((a - b).norm() < 1e-9, "{a} {b}");
        }
    }

    /// A factor serves many directions, and many contacts take no more of either.
    #[test]
    fn the_number_of_factors_and_solves_does_not_follow_that_of_contacts() {
        let seed: Vec<f64> = (0..61).map(|k| f64::sin(7.0 * f64::from(k))).collect();
        let law = Coulomb::new(0.1).expect("valid").into();
        let counted = |contacts: usize| {
            let (mut structure, problem) = sample::<3>(contacts, &seed, &[law], false);
            tied(&mut structure, &problem, None).expect("solved");
            (structure.factorisations, structure.solves)
        };
        let ((few, some), (many, all)) = (counted(10), counted(80));
        assert!(
            many <= 3 * few && all <= 4 * some,
            "{few} {some}, {many} {all}"
        );
    }
}
