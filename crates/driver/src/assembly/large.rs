//! Cells under large strains and rotations: forces and stiffness in the undeformed body, from Kirchhoff
//! stresses where the body is; not how cells are put together.

use crate::assembly::cell_law::{CellLaw, CellOutput, Motion, Stiffness};
use crate::assembly::cells::{Cells, MAX_POINTS};
use moreau_laws::{BulkLaw, FlowPower, LargeResponse, Turned, respond_large, volume_change};
use moreau_mandel::{GradientTangent, Spectrum, Sym2, from_matrix, of_gradients, product, turned};
use nalgebra::{Matrix3, SMatrix, SVector};

/// A law of small strains under large ones: [`respond_large`].
#[derive(Debug, Clone)]
pub struct Large<L>(pub L);

/// Most unknowns of a cell.
const MOST: usize = 3 * MAX_POINTS;

type Vector9 = SVector<f64, 9>;

/// A point at the end of a step.
struct Point<S> {
    response: LargeResponse<S>,
    /// F⁻¹.
    inverse: Matrix3<f64>,
    /// J = det F.
    jacobian: f64,
    /// Quadrature weight in the undeformed body \[mm³\].
    weight: f64,
}

/// The mean dilatation of a cell, J̄ = Σ w J / Σ w.
#[derive(Clone, Copy)]
struct Mean {
    /// Σ w J at the end of the step \[mm³\].
    volume: f64,
    /// P̄ = Σ w ⅓ tr τ / Σ w J, the pressure of the cell in the stress of Cauchy \[MPa\]; tension positive.
    pressure: f64,
}

/// A cell at the end of a step.
pub struct Cell<S> {
    points: Vec<Point<S>>,
    mean: Option<Mean>,
    /// Tangents at the points.
    tangents: Vec<GradientTangent>,
}

impl<S> Default for Cell<S> {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            mean: None,
            tangents: Vec::new(),
        }
    }
}

impl<S> Cell<S> {
    /// Stress in balance with the forces: τ, or dev τ + J P̄ 1.
    fn stress(&self, point: &Point<S>) -> Matrix3<f64> {
        let mut stress = point.response.stress;
        if let Some(mean) = self.mean {
            let missing = point.jacobian * mean.pressure - stress.trace() / 3.0;
            (0..3).for_each(|i| stress[(i, i)] += missing);
        }
        stress
    }

    /// ∫ t : ∂δu/∂x of a tensor t at every point, node by node.
    fn force<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        tensor: impl Fn(&Point<S>) -> Matrix3<f64>,
        force: &mut [f64],
    ) {
        let mut flux = [Matrix3::zeros(); MAX_POINTS];
        for (flux, point) in flux.iter_mut().zip(&self.points) {
            *flux = product(&tensor(point), &point.inverse.transpose());
        }
        cells.gradient_force(k, &flux[..self.points.len()], force);
    }
}

/// What a dilatation of the cell as a whole adds to its stiffness: left ⊗ c + c ⊗ right + κ c ⊗ c with the rate
/// c of the volume.
struct Coupling {
    volume: [f64; MOST],
    left: [f64; MOST],
    right: [f64; MOST],
    bulk: f64,
}

impl<L: BulkLaw> Large<L> {
    /// The points of a cell at the end of a step; `None` where one is turned inside out.
    fn place<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[Turned<L::State>],
        motion: Motion<'_>,
        cell: &mut Cell<L::State>,
    ) -> Option<()> {
        let count = old.len();
        let mut before = [Matrix3::zeros(); MAX_POINTS];
        let mut step = [Matrix3::zeros(); MAX_POINTS];
        cells.gradient(k, motion.from, &mut before[..count]);
        cells.gradient(k, motion.by, &mut step[..count]);
        let (mut volume, mut change) = (0.0, 0.0);
        for g in 0..count {
            let weight = cells.weight(k * count + g);
            before[g] += Matrix3::identity();
            let was = before[g].determinant();
            step[g] = product(&step[g], &before[g].try_inverse()?);
            volume += weight * was;
            change += weight * was * volume_change(&step[g]);
        }
        let dilatation = (change / volume).ln_1p();
        let dilatation = cells.averages_dilatation().then_some(dilatation);
        cell.points.clear();
        let mut pressure = 0.0;
        for g in 0..count {
            let free = match motion.free.is_empty() {
                true => None,
                false => Some(motion.free_at((cells, k), g)),
            };
            let own = free.map_or(step[g], |free| without(free, &step[g]));
            let dilatation = dilatation.map(|d| d - 3.0 * free.unwrap_or(0.0));
            let response = respond_large(&self.0, &old[g], &own, dilatation)?;
            let now = product(&(Matrix3::identity() + step[g]), &before[g]);
            let weight = cells.weight(k * count + g);
            pressure += weight * response.stress.trace() / 3.0;
            cell.points.push(Point {
                response,
                inverse: now.try_inverse()?,
                jacobian: now.determinant(),
                weight,
            });
        }
        let volume = volume + change;
        cell.mean = dilatation.map(|_| Mean {
            volume,
            pressure: pressure / volume,
        });
        Some(())
    }

    /// ∂τ/∂l at a point, of this part of flow and of the stress that is there.
    fn tangent(
        &self,
        (old, point): (&Turned<L::State>, &Point<L::State>),
        part: f64,
        complete: bool,
    ) -> GradientTangent {
        let elastic = || of_gradients(&self.0.elastic_tangent());
        if part == 0.0 {
            return elastic();
        }
        let mut of_law = point.response.law_tangent;
        if complete {
            of_law += self.0.lacking(&old.material, &point.response.d_eps);
        }
        let tangent = point.response.tangent(&of_law);
        match part == 1.0 {
            true => tangent,
            false => elastic() * (1.0 - part) + tangent * part,
        }
    }

    /// ∂P/∂F at every point, and what the mean dilatation adds, of this part of flow and of stresses; where
    /// not `complete`, without what the tangent of the law lacks.
    fn tangents<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[Turned<L::State>],
        cell: &mut Cell<L::State>,
        (part, complete): (f64, bool),
    ) -> Option<Coupling> {
        cell.tangents.clear();
        let mut left = [Matrix3::zeros(); MAX_POINTS];
        let mut right = [Matrix3::zeros(); MAX_POINTS];
        let mut bulk = 0.0;
        for (g, point) in cell.points.iter().enumerate() {
            let mut a = self.tangent((&old[g], point), part, complete);
            if let Some(mean) = cell.mean {
                let by_dilatation = column_mean(&a);
                let of_pressure = row_mean(&a);
                let both = (by_dilatation[0] + by_dilatation[4] + by_dilatation[8]) / 3.0;
                bulk += point.weight * both;
                left[g] = product(&deviator(&by_dilatation, both), &point.inverse.transpose());
                right[g] = product(&deviator(&of_pressure, both), &point.inverse.transpose());
                remove_means(&mut a);
                for (i, k) in (0..3).flat_map(|i| (0..3).map(move |k| (i, k))) {
                    a[(4 * i, 4 * k)] += part * point.jacobian * mean.pressure;
                }
            }
            let stress = part * cell.stress(point);
            for i in 0..3 {
                for j in 0..3 {
                    for m in 0..3 {
                        a[(3 * i + j, 3 * j + m)] -= stress[(i, m)];
                    }
                }
            }
            cell.tangents.push(pulled_back(&a, &point.inverse));
        }
        let mean = cell.mean?;
        let mut coupling = Coupling {
            volume: [0.0; MOST],
            left: [0.0; MOST],
            right: [0.0; MOST],
            bulk: (bulk / mean.volume - part * mean.pressure) / mean.volume,
        };
        let (count, size) = (old.len(), D * cells.nodes(k).len());
        cells.gradient_force(k, &left[..count], &mut coupling.left[..size]);
        cells.gradient_force(k, &right[..count], &mut coupling.right[..size]);
        let dilates = |p: &Point<L::State>| Matrix3::identity() * p.jacobian;
        cell.force((cells, k), dilates, &mut coupling.volume[..size]);
        for side in [&mut coupling.left, &mut coupling.right] {
            side.iter_mut().for_each(|x| *x /= mean.volume);
        }
        Some(coupling)
    }
}

impl<L: BulkLaw, const D: usize> CellLaw<D> for Large<L> {
    type Law = L;
    type State = Turned<L::State>;
    type Room = Cell<L::State>;

    fn law(&self) -> &L {
        &self.0
    }

    fn start(material: L::State) -> Self::State {
        Turned::upright(material)
    }

    fn material(state: &Self::State) -> &L::State {
        &state.material
    }

    fn respond(
        &self,
        of: (&dyn Cells<D>, usize),
        old: &[Self::State],
        motion: Motion<'_>,
        kind: Stiffness,
        out: CellOutput<'_, Self::State>,
        cell: &mut Self::Room,
    ) -> bool {
        if self.place(of, old, motion, cell).is_none() {
            // No forces: who is in search of balance turns back.
            out.force.fill(f64::NAN);
            out.stiffness.fill(f64::NAN);
            return true;
        }
        for (new, point) in out.new.iter_mut().zip(cell.points.iter()) {
            *new = point.response.state;
        }
        cell.force(of, |point| cell.stress(point), out.force);
        let part = match kind {
            Stiffness::None => return true,
            Stiffness::Total(part) | Stiffness::Plastic(part) => part,
        };
        let coupling = self.tangents(of, old, cell, (part, false));
        for a in &mut cell.tangents {
            *a = 0.5 * (*a + a.transpose());
        }
        let (cells, k) = of;
        cells.gradient_stiffness(k, &cell.tangents, out.stiffness);
        if let Some(Coupling {
            volume,
            left,
            right,
            bulk,
        }) = coupling
        {
            let size = out.force.len();
            let w = |i: usize| 0.5 * (left[i] + right[i]);
            let mut entries = out.stiffness.iter_mut();
            for i in 0..size {
                for (j, entry) in (i..size).zip(entries.by_ref()) {
                    *entry += w(i) * volume[j] + volume[i] * w(j) + bulk * volume[i] * volume[j];
                }
            }
        }
        true
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric() && self.0.is_isotropic()
    }

    fn keeps_elastic_stiffness(&self) -> bool {
        false
    }

    fn lacking(
        &self,
        of: (&dyn Cells<D>, usize),
        old: &[Self::State],
        motion: Motion<'_>,
        v: &[f64],
        force: &mut [f64],
    ) {
        let mut cell = Cell::default();
        if self.place(of, old, motion, &mut cell).is_none() {
            return force.fill(f64::NAN);
        }
        let (cells, k) = of;
        let (count, size) = (old.len(), force.len());
        let complete = self.tangents(of, old, &mut cell, (1.0, true));
        let all = std::mem::take(&mut cell.tangents);
        let symmetric = self.tangents(of, old, &mut cell, (1.0, false));
        let given = cell.tangents;
        let mut rate = [Matrix3::zeros(); MAX_POINTS];
        cells.gradient(k, v, &mut rate[..count]);
        for (rate, (all, given)) in rate[..count].iter_mut().zip(all.iter().zip(&given)) {
            let symmetric = 0.5 * (given + given.transpose());
            let own = Vector9::from_fn(|ij, _| rate[(ij / 3, ij % 3)]);
            let lacks = (all - symmetric) * own;
            *rate = Matrix3::from_fn(|i, j| lacks[3 * i + j]);
        }
        cells.gradient_force(k, &rate[..count], force);
        let (Some(all), Some(given)) = (complete, symmetric) else {
            return;
        };
        let nodes = cells.nodes(k);
        let own = |i: usize| v[D * nodes[i / D] + i % D];
        let along = |w: &[f64]| (0..size).map(|i| w[i] * own(i)).sum::<f64>();
        let (dilates, volume) = (along(&all.volume), all.volume);
        let of_right = along(&all.right) - 0.5 * (along(&given.left) + along(&given.right));
        for i in 0..size {
            let of_left = all.left[i] - 0.5 * (given.left[i] + given.right[i]);
            let of_bulk = (all.bulk - given.bulk) * volume[i];
            force[i] += (of_left + of_bulk) * dilates + volume[i] * of_right;
        }
    }

    fn potential(
        &self,
        _: (&dyn Cells<D>, usize),
        _: &[Self::State],
        _: Motion<'_>,
    ) -> Option<f64> {
        None
    }

    fn flow_power(
        &self,
        _: (&dyn Cells<D>, usize),
        _: &[Self::State],
        _: &[f64],
    ) -> Option<FlowPower> {
        None
    }

    fn stress(&self, state: &Self::State, gradient: &Matrix3<f64>) -> Sym2 {
        state.in_space(&self.0.stress(&state.material)) / (1.0 + volume_change(gradient))
    }

    fn fields(gradient: &Matrix3<f64>, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("jacobian", &[1.0 + volume_change(gradient)]);
        let stretch = gradient + gradient.transpose() + gradient * gradient.transpose();
        let strain = Spectrum::new(&stretch).map(|b| 0.5 * b.ln_1p());
        sink("logarithmic_strain", from_matrix(&strain).as_slice());
    }

    fn frame(state: &Self::State) -> Option<Matrix3<f64>> {
        Some(state.frame)
    }
}

/// e⁻ᵃ (1 + h) − 1: of the gradient h of a step what an expansion by the logarithmic strain a in every direction
/// leaves to stresses.
fn without(a: f64, h: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (-a).exp_m1() + h * (-a).exp()
}

/// a : ⅓ 1.
fn column_mean(a: &GradientTangent) -> Vector9 {
    (a.column(0) + a.column(4) + a.column(8)) / 3.0
}

/// ⅓ 1 : a.
fn row_mean(a: &GradientTangent) -> Vector9 {
    (a.row(0) + a.row(4) + a.row(8)).transpose() / 3.0
}

/// A tensor less this third of its trace.
fn deviator(t: &Vector9, mean: f64) -> Matrix3<f64> {
    let mean = Matrix3::identity() * mean;
    Matrix3::from_fn(|i, j| t[3 * i + j]) - mean
}

/// a ← P a P with the projection P on tensors without a trace.
fn remove_means(a: &mut GradientTangent) {
    let mean = column_mean(a);
    for k in [0, 4, 8] {
        let mut column = a.column_mut(k);
        column -= mean;
    }
    let mean = row_mean(a).transpose();
    for k in [0, 4, 8] {
        let mut row = a.row_mut(k);
        row -= mean;
    }
}

/// Aᵢⱼₖₘ = F⁻¹ⱼₙ F⁻¹ₘₚ aᵢₙₖₚ, of gradients in the undeformed body.
fn pulled_back(a: &GradientTangent, inverse: &Matrix3<f64>) -> GradientTangent {
    let mut out = GradientTangent::zeros();
    for i in 0..3 {
        for k in 0..3 {
            let block: SMatrix<f64, 3, 3> = a.fixed_view::<3, 3>(3 * i, 3 * k).into();
            let own = turned(inverse, &block);
            out.fixed_view_mut::<3, 3>(3 * i, 3 * k).copy_from(&own);
        }
    }
    out
}
