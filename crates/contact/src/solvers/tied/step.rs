//! A step of the iteration: its equations in least squares, and how far to go along it; not the map.

use super::iterate::Row;
use super::recycled::LeastSquares;
use super::{At, Tied};
use moreau_laws::Local;
use nalgebra::{DVector, SMatrix};

/// Least part of a step that is worth taking before its equations are solved better.
const WORTH_TAKING: f64 = 0.3;

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

/// Equations of a step, P (E z + (A − E R) W z) = −P G, with P a block a contact.
struct Equations<const D: usize> {
    /// P E and P (A − E R) of every contact.
    blocks: Vec<[SMatrix<f64, D, D>; 2]>,
    /// P⁻¹ / √α, as the merit weighs.
    weights: Vec<SMatrix<f64, D, D>>,
    /// −P G.
    values: DVector<f64>,
}

impl<const D: usize> Equations<D> {
    fn new(tied: &Tied<'_, '_, D>, rows: &[Row<D>]) -> Self {
        let mut equations = Self {
            blocks: Vec::with_capacity(rows.len()),
            weights: Vec::with_capacity(rows.len()),
            values: DVector::zeros(D * rows.len()),
        };
        for (i, row) in rows.iter().enumerate() {
            let tie = &tied.factor.ties[i];
            let soft = SOFTENED * tied.problem.structure.stiffness(i);
            let own = (tie + SMatrix::identity() * soft).try_inverse();
            let left = row.shift - row.elastic * tie;
            let sum = row.elastic + left * own.unwrap_or_else(SMatrix::zeros);
            let (p, inverse) = sum.try_inverse().map_or_else(
                || (SMatrix::identity(), SMatrix::identity()),
                |inverse| (inverse, sum),
            );
            equations.blocks.push([p * row.elastic, p * left]);
            equations.weights.push(inverse / tied.alpha(i).sqrt());
            let value = p * row.value;
            equations
                .values
                .fixed_rows_mut::<D>(D * i)
                .copy_from(&value);
        }
        equations
    }

    /// P (E z + (A − E R) W z).
    fn image(&self, z: &DVector<f64>, answer: &DVector<f64>) -> DVector<f64> {
        let mut image = DVector::zeros(z.len());
        for (i, [force, motion]) in self.blocks.iter().enumerate() {
            let own: Local<D> =
                force * z.fixed_rows::<D>(D * i) + motion * answer.fixed_rows::<D>(D * i);
            image.fixed_rows_mut::<D>(D * i).copy_from(&own);
        }
        image
    }

    /// What is left of the equations, as it is and as the merit weighs it.
    fn size(&self, left: &DVector<f64>) -> [f64; 2] {
        let own = |(i, weight): (usize, &SMatrix<f64, D, D>)| {
            (weight * left.fixed_rows::<D>(D * i)).norm_squared()
        };
        let weighed: f64 = self.weights.iter().enumerate().map(own).sum();
        [left.norm(), weighed.sqrt()]
    }
}

impl<const D: usize> Tied<'_, '_, D> {
    /// The next iterate; `None` if no step along what the Krylov iteration finds makes the merit smaller than
    /// allowed. One that makes it smaller than `good` is not looked for better.
    pub(super) fn step(
        &mut self,
        rows: &[Row<D>],
        now: &At<D>,
        [allowed, good]: [f64; 2],
    ) -> Option<At<D>> {
        let equations = Equations::new(self, rows);
        let whole = equations.size(&equations.values);
        let mut least = LeastSquares::new(equations.values.clone());
        for k in 0..self.factor.pairs.len() {
            let (z, answer) = self.factor.pairs.pair(k);
            least.add(equations.image(z, answer));
        }
        let coarse = INACCURATE.min((now.residual / self.force_scale(now)).sqrt());
        let mut room = LONGEST;
        let mut best = None;
        for (k, accuracy) in ACCURACIES.into_iter().enumerate() {
            let accuracy = coarse * accuracy;
            let is_solved = |left: &DVector<f64>| {
                let [norm, weighed] = equations.size(left);
                norm <= accuracy * whole[0] && (k == 0 || weighed <= accuracy * whole[1])
            };
            while room > 0 && !is_solved(&least.left) {
                let independent = self.extend(&equations, &mut least);
                room = if independent { room - 1 } else { 0 };
            }
            if let Some((trial, part)) = self.search(&least, now, allowed) {
                if part > WORTH_TAKING && trial.merit < good {
                    return Some(trial);
                }
                best = Some(trial);
            }
            if room == 0 {
                break;
            }
        }
        best
    }

    /// Takes in a direction along what is left of the equations; whether it is independent of the others.
    fn extend(&mut self, equations: &Equations<D>, least: &mut LeastSquares) -> bool {
        let z = &least.left / least.left.norm();
        let answer = self.problem.structure.displacement(&z, false);
        self.factor.used += 1;
        self.solves += 1;
        let independent = least.add(equations.image(&z, &answer));
        self.factor.pairs.add(z, answer);
        independent
    }

    /// The iterate along a step at which the merit is smaller than allowed, and what part of it that is.
    fn search(&self, least: &LeastSquares, now: &At<D>, allowed: f64) -> Option<(At<D>, f64)> {
        let y = least.solution();
        let (dz, dv) = self.factor.pairs.combined(&y, now.z.len());
        let summed = self.factor.pairs.size(&y);
        let parts = (0..HALVINGS as i32).map(|k| 0.5f64.powi(k));
        let along = |part: f64| At {
            summed: now.summed + part * summed,
            ..self.at(&now.z + &dz * part, &now.v + &dv * part)
        };
        parts
            .map(|part| (along(part), part))
            .find(|(trial, part)| trial.merit < (1.0 - 1e-4 * part) * allowed)
    }
}
