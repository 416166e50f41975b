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
struct Point {
    response: LargeResponse,
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

/// How the points of a cell move.
struct Course {
    /// F before the step.
    before: [Matrix3<f64>; MAX_POINTS],
    /// h = f − 1 of the step.
    step: [Matrix3<f64>; MAX_POINTS],
    /// Σ w J before the step, and its change \[mm³\].
    volume: f64,
    change: f64,
}

impl Course {
    fn new<const D: usize>(
        (cells, k): (&dyn Cells<D>, usize),
        motion: Motion<'_>,
        count: usize,
    ) -> Option<Self> {
        let mut course = Self {
            before: [Matrix3::zeros(); MAX_POINTS],
            step: [Matrix3::zeros(); MAX_POINTS],
            volume: 0.0,
            change: 0.0,
        };
        cells.gradient(k, motion.from, &mut course.before[..count]);
        cells.gradient(k, motion.by, &mut course.step[..count]);
        for g in 0..count {
            let (before, step) = (&mut course.before[g], &mut course.step[g]);
            *before += Matrix3::identity();
            *step = product(step, &before.try_inverse()?);
            let was = cells.weight(k * count + g) * before.determinant();
            course.volume += was;
            course.change += was * volume_change(step);
        }
        Some(course)
    }

    /// ln(J₁/J₀) of the cell as a whole.
    fn dilatation(&self) -> f64 {
        (self.change / self.volume).ln_1p()
    }
}

/// A cell at the end of a step, whatever its law.
#[derive(Default)]
pub struct Cell {
    points: Vec<Point>,
    mean: Option<Mean>,
    /// Tangents at the points: ∂τ/∂l, then ∂P/∂F.
    tangents: Vec<GradientTangent>,
}

impl Cell {
    /// Stress in balance with the forces: τ, or dev τ + J P̄ 1.
    fn stress(&self, point: &Point) -> Matrix3<f64> {
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
        tensor: impl Fn(&Point) -> Matrix3<f64>,
        force: &mut [f64],
    ) {
        let mut flux = [Matrix3::zeros(); MAX_POINTS];
        for (flux, point) in flux.iter_mut().zip(&self.points) {
            *flux = product(&tensor(point), &point.inverse.transpose());
        }
        cells.gradient_force(k, &flux[..self.points.len()], force);
    }

    /// From ∂τ/∂l to ∂P/∂F at every point, and what the mean dilatation adds, of this part of stresses.
    fn pull_back<const D: usize>(
        &mut self,
        (cells, k): (&dyn Cells<D>, usize),
        part: f64,
    ) -> Option<Coupling> {
        let mut left = [Matrix3::zeros(); MAX_POINTS];
        let mut right = [Matrix3::zeros(); MAX_POINTS];
        let mut bulk = 0.0;
        let mut tangents = std::mem::take(&mut self.tangents);
        for (g, (a, point)) in tangents.iter_mut().zip(&self.points).enumerate() {
            if let Some(mean) = self.mean {
                let by_dilatation = column_mean(a);
                let of_pressure = row_mean(a);
                let both = (by_dilatation[0] + by_dilatation[4] + by_dilatation[8]) / 3.0;
                bulk += point.weight * both;
                left[g] = product(&deviator(&by_dilatation, both), &point.inverse.transpose());
                right[g] = product(&deviator(&of_pressure, both), &point.inverse.transpose());
                remove_means(a);
                for (i, k) in (0..3).flat_map(|i| (0..3).map(move |k| (i, k))) {
                    a[(4 * i, 4 * k)] += part * point.jacobian * mean.pressure;
                }
            }
            let stress = part * self.stress(point);
            for i in 0..3 {
                for j in 0..3 {
                    for m in 0..3 {
                        a[(3 * i + j, 3 * j + m)] -= stress[(i, m)];
                    }
                }
            }
            *a = pulled_back(a, &point.inverse);
        }
        self.tangents = tangents;
        let mean = self.mean?;
        let mut coupling = Coupling {
            volume: [0.0; MOST],
            left: [0.0; MOST],
            right: [0.0; MOST],
            bulk: (bulk / mean.volume - part * mean.pressure) / mean.volume,
        };
        let (count, size) = (self.points.len(), D * cells.nodes(k).len());
        cells.gradient_force(k, &left[..count], &mut coupling.left[..size]);
        cells.gradient_force(k, &right[..count], &mut coupling.right[..size]);
        let dilates = |p: &Point| Matrix3::identity() * p.jacobian;
        self.force((cells, k), dilates, &mut coupling.volume[..size]);
        for side in [&mut coupling.left, &mut coupling.right] {
            side.iter_mut().for_each(|x| *x /= mean.volume);
        }
        Some(coupling)
    }

    /// The symmetric part of the stiffness, by rows of its upper half.
    fn stiffness<const D: usize>(
        &mut self,
        (cells, k): (&dyn Cells<D>, usize),
        coupling: Option<Coupling>,
        stiffness: &mut [f64],
    ) {
        for a in &mut self.tangents {
            *a = 0.5 * (*a + a.transpose());
        }
        cells.gradient_stiffness(k, &self.tangents, stiffness);
        let Some(Coupling {
            volume,
            left,
            right,
            bulk,
        }) = coupling
        else {
            return;
        };
        let size = D * cells.nodes(k).len();
        let w = |i: usize| 0.5 * (left[i] + right[i]);
        let mut entries = stiffness.iter_mut();
        for i in 0..size {
            for (j, entry) in (i..size).zip(entries.by_ref()) {
                *entry += w(i) * volume[j] + volume[i] * w(j) + bulk * volume[i] * volume[j];
            }
        }
    }

    /// (A − ½ (K + Kᵀ)) v of the stiffness with `all`, A, and that of this cell, K.
    fn lacks<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        all: (&[GradientTangent], Option<Coupling>),
        coupling: Option<Coupling>,
        (v, force): (&[f64], &mut [f64]),
    ) {
        let (count, size) = (self.points.len(), force.len());
        let mut rate = [Matrix3::zeros(); MAX_POINTS];
        cells.gradient(k, v, &mut rate[..count]);
        for (rate, (all, given)) in rate[..count]
            .iter_mut()
            .zip(all.0.iter().zip(&self.tangents))
        {
            let symmetric = 0.5 * (given + given.transpose());
            let own = Vector9::from_fn(|ij, _| rate[(ij / 3, ij % 3)]);
            let lacks = (all - symmetric) * own;
            *rate = Matrix3::from_fn(|i, j| lacks[3 * i + j]);
        }
        cells.gradient_force(k, &rate[..count], force);
        let (Some(all), Some(given)) = (all.1, coupling) else {
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
    /// The points of a cell at the end of a step, and their states; `None` where one is turned inside out.
    fn place<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[Turned<L::State>],
        motion: Motion<'_>,
        cell: &mut Cell,
        mut keep: impl FnMut(usize, Turned<L::State>),
    ) -> Option<()> {
        let count = old.len();
        let course = Course::new((cells, k), motion, count)?;
        let dilatation = cells.averages_dilatation().then(|| course.dilatation());
        cell.points.clear();
        let mut pressure = 0.0;
        for (g, (old, step)) in old.iter().zip(&course.step).enumerate() {
            let free = match motion.free.is_empty() {
                true => None,
                false => Some(motion.free_at((cells, k), g)),
            };
            let own = free.map_or(*step, |free| without(free, step));
            let dilatation = dilatation.map(|d| d - 3.0 * free.unwrap_or(0.0));
            let (response, state) = respond_large(&self.0, old, &own, dilatation)?;
            keep(g, state);
            let now = product(&(Matrix3::identity() + step), &course.before[g]);
            let weight = cells.weight(k * count + g);
            pressure += weight * response.stress.trace() / 3.0;
            cell.points.push(Point {
                response,
                inverse: now.try_inverse()?,
                jacobian: now.determinant(),
                weight,
            });
        }
        let volume = course.volume + course.change;
        cell.mean = dilatation.map(|_| Mean {
            volume,
            pressure: pressure / volume,
        });
        Some(())
    }

    /// ∂τ/∂l at a point, of this part of flow; where not `complete`, without what the tangent of the law lacks.
    fn tangent(
        &self,
        (old, point): (&Turned<L::State>, &Point),
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

    /// ∂P/∂F at every point, and what the mean dilatation adds, of this part of flow and of stresses.
    fn tangents<const D: usize>(
        &self,
        of: (&dyn Cells<D>, usize),
        old: &[Turned<L::State>],
        cell: &mut Cell,
        (part, complete): (f64, bool),
    ) -> Option<Coupling> {
        let points = old.iter().zip(&cell.points);
        cell.tangents.clear();
        cell.tangents
            .extend(points.map(|(old, point)| self.tangent((old, point), part, complete)));
        cell.pull_back(of, part)
    }
}

impl<L: BulkLaw, const D: usize> CellLaw<D> for Large<L> {
    type Law = L;
    type State = Turned<L::State>;
    type Room = Cell;

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
        let keep = |g: usize, state| out.new[g] = state;
        if self.place(of, old, motion, cell, keep).is_none() {
            // No forces: who is in search of balance turns back.
            out.force.fill(f64::NAN);
            out.stiffness.fill(f64::NAN);
            return true;
        }
        cell.force(of, |point| cell.stress(point), out.force);
        let part = match kind {
            Stiffness::None => return true,
            Stiffness::Total(part) | Stiffness::Plastic(part) => part,
        };
        let coupling = self.tangents(of, old, cell, (part, false));
        cell.stiffness(of, coupling, out.stiffness);
        true
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric() && self.0.is_isotropic()
    }

    fn has_potential(&self) -> bool {
        self.0.is_symmetric()
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
        if self.place(of, old, motion, &mut cell, |_, _| {}).is_none() {
            return force.fill(f64::NAN);
        }
        let complete = self.tangents(of, old, &mut cell, (1.0, true));
        let all = std::mem::take(&mut cell.tangents);
        let given = self.tangents(of, old, &mut cell, (1.0, false));
        cell.lacks(of, (&all, complete), given, (v, force));
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

    fn stress(&self, state: &Self::State) -> Sym2 {
        state.in_space(&self.0.stress(&state.material))
    }

    fn average_dilatation((cells, k): (&dyn Cells<D>, usize), gradients: &mut [Matrix3<f64>]) {
        if !cells.averages_dilatation() {
            return;
        }
        let count = gradients.len();
        let (mut volume, mut change) = (0.0, 0.0);
        for (g, gradient) in gradients.iter().enumerate() {
            let weight = cells.weight(k * count + g);
            volume += weight;
            change += weight * volume_change(gradient);
        }
        let mean = (change / volume).ln_1p();
        for gradient in gradients {
            let own = volume_change(gradient).ln_1p();
            *gradient = without((own - mean) / 3.0, gradient);
        }
    }

    fn jacobian(gradient: &Matrix3<f64>) -> f64 {
        1.0 + volume_change(gradient)
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
