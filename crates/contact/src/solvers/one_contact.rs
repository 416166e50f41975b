//! A single contact, solved exactly; no iteration over contacts.

use moreau_laws::{Bounded, Friction, Local};
use nalgebra::SMatrix;

/// The bound g(t_n) of the shear in an isotropic law.
#[derive(Debug, Clone, Copy)]
pub(super) enum Bound {
    /// min(μ t_n, g₀): μ infinite where pressure does not count, g₀ under Coulomb's law.
    Line { slope: f64, limit: f64 },
    /// Concave and never falling.
    Curve(Bounded),
}

impl Bound {
    /// Of a law, between its stretched vectors.
    pub(super) fn of(law: &Friction) -> Self {
        match law.isotropic() {
            Friction::Tresca(law) => Self::given(law.limit()),
            Friction::Limited(law) => Self::Line {
                slope: law.friction(),
                limit: law.limit(),
            },
            Friction::Bounded(law) => Self::Curve(law),
            law => Self::Line {
                slope: law.coefficient(),
                limit: f64::INFINITY,
            },
        }
    }

    /// A constant one, Tresca's.
    pub(super) fn given(limit: f64) -> Self {
        Self::Line {
            slope: f64::INFINITY,
            limit,
        }
    }

    /// g and its derivative at a pressure t_n.
    pub(super) fn at(&self, pressure: f64) -> (f64, f64) {
        match *self {
            Self::Curve(law) => (law.bound(pressure), law.slope(pressure)),
            Self::Line { slope, limit } if slope.is_infinite() => (limit, 0.0),
            Self::Line { slope, limit } if slope * pressure < limit => (slope * pressure, slope),
            Self::Line { limit, .. } => (limit, 0.0),
        }
    }

    /// Whether no shear is resisted without pressure.
    fn needs_pressure(&self) -> bool {
        match self {
            Self::Line { slope, .. } => slope.is_finite(),
            Self::Curve(law) => law.bound(0.0) <= 0.0,
        }
    }

    /// Whether shear is resisted at some pressure.
    fn resists(&self) -> bool {
        match self {
            Self::Line { slope, limit } => *slope > 0.0 && *limit > 0.0,
            Self::Curve(law) => law.bound(0.0) > 0.0 || law.slope(0.0) > 0.0,
        }
    }
}

/// Force of a single contact u = W t + q with a positive definite W under a law, the shear bounded as
/// given: opens if it may, else sticks if the bound allows, else slips. `guess` is a force near the
/// answer.
pub(super) fn solve<const D: usize>(
    (w, q): (&SMatrix<f64, D, D>, &Local<D>),
    law: &Friction,
    bound: Bound,
    guess: &Local<D>,
) -> Local<D> {
    if law.is_tie() {
        // What W does not see is left as it is.
        let u = w * guess + q;
        return w
            .try_inverse()
            .map_or(*guess, |inverse| guess - inverse * u);
    }
    if !matches!(law, Friction::Anisotropic(_)) {
        return isotropic((w, q), bound, guess);
    }
    // Between stretched vectors the law is isotropic.
    let m: Local<D> = law.stretch();
    let w = SMatrix::from_fn(|k, l| m[k] * w[(k, l)] * m[l]);
    let (q, guess) = (q.component_mul(&m), guess.component_div(&m));
    isotropic((&w, &q), bound, &guess).component_mul(&m)
}

fn isotropic<const D: usize>(
    (w, q): (&SMatrix<f64, D, D>, &Local<D>),
    bound: Bound,
    guess: &Local<D>,
) -> Local<D> {
    if bound.needs_pressure() {
        if q[0] >= 0.0 {
            return Local::zeros();
        }
    } else {
        let dragged = Tangent::open(w, q).force(bound, guess);
        let gap = q[0] + (1..D).map(|k| w[(0, k)] * dragged[k]).sum::<f64>();
        if gap >= 0.0 {
            return dragged;
        }
    }
    Tangent::closed(w, q).force(bound, guess)
}

/// The equation S x = b − λ x of the shear x of a contact that slips by −u_t = λ x, and the pressure
/// p + c·x that goes with it. In the plane only the first components count.
struct Tangent {
    s: [[f64; 2]; 2],
    b: [f64; 2],
    p: f64,
    c: [f64; 2],
}

/// A solution of it: pressure and shear, the size of the shear, the derivatives of pressure and size.
struct Trial {
    force: [f64; 3],
    size: f64,
    d_pressure: f64,
    d_size: f64,
}

impl Tangent {
    /// Without pressure.
    fn open<const D: usize>(w: &SMatrix<f64, D, D>, q: &Local<D>) -> Self {
        let inside = |k: usize| k + 1 < D;
        let s = |k, l| match inside(k) && inside(l) {
            true => w[(k + 1, l + 1)],
            false => 0.0,
        };
        Self {
            s: [[s(0, 0), s(0, 1)], [s(1, 0), s(1, 1)]],
            b: [0, 1].map(|k| if inside(k) { -q[k + 1] } else { 0.0 }),
            p: 0.0,
            c: [0.0; 2],
        }
    }

    /// With the pressure that closes the gap: what is left of W is its Schur complement.
    fn closed<const D: usize>(w: &SMatrix<f64, D, D>, q: &Local<D>) -> Self {
        let normal = 1.0 / w[(0, 0)];
        let mut tangent = Self::open(w, q);
        for k in 0..D - 1 {
            for l in 0..D - 1 {
                tangent.s[k][l] -= w[(k + 1, 0)] * w[(0, l + 1)] * normal;
            }
            tangent.b[k] += w[(k + 1, 0)] * q[0] * normal;
            tangent.c[k] = -w[(0, k + 1)] * normal;
        }
        tangent.p = -q[0] * normal;
        tangent
    }

    /// The force with the least λ ≥ 0 found for which the bound admits it.
    fn force<const D: usize>(&self, bound: Bound, guess: &Local<D>) -> Local<D> {
        let mut t = Local::zeros();
        if !bound.resists() {
            t[0] = self.p;
        } else if D == 2 {
            (t[0], t[1]) = self.plane(bound);
        } else {
            let found = self.spatial(bound, [guess[1], guess[2]]);
            (t[0], t[1], t[2]) = (found[0], found[1], found[2]);
        }
        t[0] = t[0].max(0.0);
        // The root is found to rounding; the bound is met exactly.
        let (limit, _) = bound.at(t[0]);
        let size = (1..D).map(|k| t[k] * t[k]).sum::<f64>().sqrt();
        if size > limit {
            for k in 1..D {
                t[k] *= limit / size;
            }
        }
        t
    }

    /// Pressure and shear in the plane, where slip is on one of the edges t_t = ± g(t_n).
    fn plane(&self, bound: Bound) -> (f64, f64) {
        let (stiffness, b, c) = (self.s[0][0], self.b[0], self.c[0]);
        let stick = b / stiffness;
        let pressure = self.p + c * stick;
        if stiffness > 0.0 && stick.abs() <= bound.at(pressure).0 {
            return (pressure, stick);
        }
        let side = b.signum();
        match bound {
            Bound::Line { slope, limit } => self.line_edge(side, slope, limit),
            Bound::Curve(law) => self.curve_edge(side, &law),
        }
    }

    /// Pressure and shear on the edge of min(μ t_n, g₀).
    fn line_edge(&self, side: f64, slope: f64, limit: f64) -> (f64, f64) {
        let c = self.c[0];
        if slope.is_finite() {
            // t_t = ± μ t_n leaves a linear equation. Without a positive factor the contact wedges: there
            // is no slip on the cone.
            let opens = 1.0 - side * slope * c;
            let edge = self.p / opens;
            if opens > 0.0 && slope * edge <= limit {
                return (edge, side * slope * edge);
            }
            if limit.is_infinite() {
                return (self.p, 0.0);
            }
        }
        (self.p + c * side * limit, side * limit)
    }

    /// Pressure and shear on the edge of a curve: t_n = p ± c g(t_n) by Newton's method from where the left
    /// side is the larger. The difference is convex or concave there, and the iteration one-sided after its
    /// first step; where it does not rise, the contact wedges.
    fn curve_edge(&self, side: f64, law: &Bounded) -> (f64, f64) {
        let (p, c) = (self.p, side * self.c[0]);
        let difference = |t: f64| t - p - c * law.bound(t);
        let mut pressure = p.abs().max(c.abs() * law.bound(0.0));
        for _ in 0..100 {
            if difference(pressure) >= 0.0 {
                break;
            }
            pressure *= 2.0;
        }
        for _ in 0..100 {
            let rise = 1.0 - c * law.slope(pressure);
            let next = (pressure - difference(pressure) / rise).max(0.0);
            if rise <= 0.0 || !next.is_finite() {
                return (p, 0.0);
            }
            let moved = (next - pressure).abs();
            pressure = next;
            if moved <= f64::EPSILON * next {
                break;
            }
        }
        (pressure, side * law.bound(pressure))
    }

    /// Pressure and shear in space. The excess |x| − g of the shear is positive at λ = 0, where the
    /// contact would stick, and negative at λ = ∞, so that a safeguarded Newton iteration on the
    /// reciprocals (as in the secular equation of trust regions) cannot fail.
    fn spatial(&self, bound: Bound, guess: [f64; 2]) -> [f64; 3] {
        let size_of = self.s[0][0].abs() + self.s[1][1].abs();
        let mut found = [self.p, 0.0, 0.0];
        if let Some(stick) = self.at(0.0)
            && stick.size <= bound.at(stick.force[0]).0
        {
            return stick.force;
        }
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let before = self.slip_over_force(guess);
        let mut lambda = if before > 0.0 && before.is_finite() {
            before
        } else {
            0.5 * size_of
        };
        for _ in 0..100 {
            let Some(trial) = self.at(lambda) else {
                low = lambda;
                lambda = lambda.max(1e-8 * size_of) * 4.0;
                continue;
            };
            found = trial.force;
            let (limit, slope) = bound.at(trial.force[0]);
            let excess = trial.size - limit;
            if excess.abs() <= 8.0 * f64::EPSILON * trial.size {
                break;
            }
            if excess > 0.0 {
                low = lambda;
            } else {
                high = lambda;
            }
            let rise = slope * trial.d_pressure / (limit * limit);
            let rise = rise - trial.d_size / (trial.size * trial.size);
            let newton = lambda - (1.0 / trial.size - 1.0 / limit) / rise;
            lambda = if limit > 0.0 && rise > 0.0 && newton > low && newton < high {
                newton
            } else {
                between(low, high)
            };
            if lambda <= low || lambda >= high {
                break;
            }
        }
        found
    }

    /// The solution at λ; `None` where S + λ is singular.
    fn at(&self, lambda: f64) -> Option<Trial> {
        let [[s11, s12], [s21, s22]] = self.s;
        let ([b1, b2], [c1, c2]) = (self.b, self.c);
        let trace = s11.abs() + s22.abs();
        let (d1, d2) = (s11 + lambda, s22 + lambda);
        let det = d1 * d2 - s12 * s21;
        if det <= f64::EPSILON * trace * trace {
            return None;
        }
        let (x, y) = ((d2 * b1 - s12 * b2) / det, (d1 * b2 - s21 * b1) / det);
        let (dx, dy) = ((s12 * y - d2 * x) / det, (s21 * x - d1 * y) / det);
        let size = (x * x + y * y).sqrt();
        let d_size = if size > 0.0 {
            (x * dx + y * dy) / size
        } else {
            0.0
        };
        Some(Trial {
            force: [self.p + c1 * x + c2 * y, x, y],
            size,
            d_pressure: c1 * dx + c2 * dy,
            d_size,
        })
    }

    /// λ of a shear.
    fn slip_over_force(&self, x: [f64; 2]) -> f64 {
        let slip = |k: usize| self.b[k] - self.s[k][0] * x[0] - self.s[k][1] * x[1];
        (slip(0) * x[0] + slip(1) * x[1]) / (x[0] * x[0] + x[1] * x[1])
    }
}

/// A number between two bounds, far from both where they differ in size.
fn between(low: f64, high: f64) -> f64 {
    if high.is_infinite() {
        4.0 * low
    } else if low > 0.0 {
        (low * high).sqrt()
    } else {
        0.1 * high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::{AnisotropicCoulomb, Coulomb, LimitedCoulomb, ShearBound, Tresca};
    use proptest::prelude::*;

    /// Shear that a film keeps without pressure, and that the tools' asperities bound at last.
    #[derive(Debug)]
    struct Film {
        cohesion: f64,
    }

    impl ShearBound for Film {
        fn bound(&self, t_n: f64) -> f64 {
            self.cohesion + 0.3 * (1.0 - (-2.0 * t_n).exp())
        }

        fn slope(&self, t_n: f64) -> f64 {
            0.6 * (-2.0 * t_n).exp()
        }
    }

    static FILMS: [Film; 2] = [Film { cohesion: 0.0 }, Film { cohesion: 0.2 }];

    /// The laws, of friction and limit about as given.
    fn laws(mu: f64, limit: f64) -> [Friction; 6] {
        [
            Coulomb::new(mu).expect("valid").into(),
            Tresca::new(limit).expect("valid").into(),
            LimitedCoulomb::new(mu, limit).expect("valid").into(),
            AnisotropicCoulomb::new(mu + 0.01, 0.4 * mu + 0.01)
                .expect("valid")
                .into(),
            (&FILMS[0]).into(),
            (&FILMS[1]).into(),
        ]
    }

    fn check<const D: usize>(entries: &[f64], law: &Friction) -> Result<(), TestCaseError> {
        let a = SMatrix::<f64, D, D>::from_fn(|i, j| entries[3 * i + j]);
        let w = a * a.transpose() + SMatrix::identity() * 0.01;
        let q = Local::<D>::from_fn(|k, _| entries[9 + k]);
        let guess = Local::<D>::from_fn(|k, _| entries[12 + k]);
        for guess in [guess, Local::zeros()] {
            let t = solve((&w, &q), law, Bound::of(law), &guess);
            let u = w * t + q;
            let map = law.natural_map(&u, &t, 1.0 / w.norm());
            prop_assert!(
                map.norm() <= 1e-11 * (1.0 + t.norm()),
                "{law:?}: {} at {t}",
                map.norm()
            );
        }
        Ok(())
    }

    /// Tresca's law is normal: its force has the least energy of all admissible ones, whatever the
    /// coefficient that stands beside the given limit.
    fn least<const D: usize>(entries: &[f64], limit: f64) -> Result<(), TestCaseError> {
        let a = SMatrix::<f64, D, D>::from_fn(|i, j| entries[3 * i + j]);
        let w = a * a.transpose() + SMatrix::identity() * 0.01;
        let q = Local::<D>::from_fn(|k, _| entries[9 + k]);
        let coulomb = Coulomb::new(0.3).expect("valid").into();
        let energy = |t: &Local<D>| 0.5 * t.dot(&(w * t)) + t.dot(&q);
        let t = solve((&w, &q), &coulomb, Bound::given(limit), &Local::zeros());
        let law = Tresca::new(limit).expect("valid");
        for (k, step) in (0..30).zip([1e-3, 0.1, 1.0].iter().cycle()) {
            let d = Local::<D>::from_fn(|j, _| entries[(4 * k + 7 * j) % 15]);
            let other = law.project(&(t + d * *step));
            prop_assert!(energy(&other) >= energy(&t) - 1e-13, "{t} {other}");
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn with_a_given_limit_the_energy_is_least(
            entries in prop::collection::vec(-1.0..1.0f64, 15), limit in 0.0..3.0f64,
        ) {
            least::<2>(&entries, limit)?;
            least::<3>(&entries, limit)?;
        }

        #[test]
        fn the_law_is_met_whatever_w_q_and_friction(
            entries in prop::collection::vec(-1.0..1.0f64, 15), mu in 0.0..3.0f64,
            limit in 0.0..3.0f64,
        ) {
            for law in laws(mu, limit) {
                check::<2>(&entries, &law)?;
                check::<3>(&entries, &law)?;
            }
        }
    }
}
