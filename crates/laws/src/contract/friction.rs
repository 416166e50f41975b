//! The contract of laws of friction; not their solution in a structure.

use super::random::Random;
use super::{Report, Violation};
use crate::friction::Friction;
use crate::local::{Local, Status, tangential, tangential_norm};

/// Pressures that are drawn, over seven decades.
const SAMPLES: usize = 1024;
/// Round-off allowed, relative to the size of the terms.
const ROUND_OFF: f64 = 1e-12;

/// Checks a law of friction in R^D, at pressures from 10⁻³ to 10⁴:
///
/// - the bound g(t_n) of the shear is not negative, does not fall and is concave, with its slope;
/// - b(−u, t) ≥ −u·t, with equality on the law (open, stick, slip) and nowhere else, and +∞ where a
///   displacement or a force is not admissible;
/// - the correction is admissible, its fixed points are the law and its derivatives those of
///   differences;
/// - the projection is admissible, leaves what is, and is the nearest force;
/// - the status of a pair is that by which it was made;
/// - a law between tractions is, scaled by an area, that between forces;
/// - what is not a number comes out.
///
/// # Errors
/// The first [`Violation`].
pub fn friction<const D: usize>(law: impl Into<Friction>) -> Result<Report, Violation> {
    let law = law.into();
    let mut random = Random::new();
    let mut report = Report::default();
    for _ in 0..SAMPLES {
        let size = 10f64.powf(random.between(-3.0, 4.0));
        let point = Point::<D> {
            isotropic: law.isotropic(),
            stretch: law.stretch(),
            t_n: size * random.between(0.1, 1.0),
            tau: tangential(&random.direction::<D>()).normalize(),
            slip: 10f64.powf(random.between(-2.0, 2.0)),
            alpha: size * 10f64.powf(random.between(-2.0, 2.0)),
            law,
        };
        point.bound(&mut random, &mut report)?;
        point.pairs(&mut report)?;
        point.departures(&mut report)?;
        point.projection(&mut random, &mut report)?;
        point.derivatives(&mut random, &mut report)?;
        point.scaled(&mut random, &mut report)?;
    }
    let mut nothing = Local::<D>::zeros();
    nothing[0] = f64::NAN;
    let out = law.correct(&nothing, &Local::zeros(), 1.0);
    let out = out.iter().any(|c| c.is_nan());
    report.holds("what is not a number comes out", out, || "of a gap".into())?;
    Ok(report)
}

/// A pressure with a direction of slip.
struct Point<const D: usize> {
    law: Friction,
    /// The law between stretched vectors.
    isotropic: Friction,
    stretch: Local<D>,
    t_n: f64,
    tau: Local<D>,
    slip: f64,
    alpha: f64,
}

impl<const D: usize> Point<D> {
    /// The force of a share of the bound, at the pressure t_n.
    fn force(&self, t_n: f64, share: f64) -> Local<D> {
        let mut t = share * self.isotropic.bound(t_n) * self.tau;
        t[0] = t_n;
        t.component_mul(&self.stretch)
    }

    /// The displacement of a gap and of a slip against τ.
    fn displacement(&self, gap: f64, slip: f64) -> Local<D> {
        let mut u = -slip * self.tau;
        u[0] = gap;
        u.component_div(&self.stretch)
    }

    fn at(&self, u: &Local<D>, t: &Local<D>) -> String {
        let (u, t) = (u.as_slice(), t.as_slice());
        format!("of {:?} at u = {u:?}, t = {t:?}", self.law)
    }

    /// b(−u, t) + u·t, and the round-off to expect in it.
    fn gap(&self, u: &Local<D>, t: &Local<D>) -> (f64, f64) {
        let b = self.law.b(&-u, t);
        (b + u.dot(t), ROUND_OFF * (b.abs() + u.norm() * t.norm()))
    }

    fn bound(&self, random: &mut Random, report: &mut Report) -> Result<(), Violation> {
        let g = |t_n: f64| self.isotropic.bound(t_n);
        let (low, high) = (self.t_n, self.t_n * random.between(1.0, 9.0));
        let at = || format!("of {:?} between {low:e} and {high:e}", self.law);
        let round_off = ROUND_OFF * g(high).abs();
        report.at_most("the bound is not negative", (-g(low), 0.0), at)?;
        report.at_most("the bound does not fall", (g(low) - g(high), round_off), at)?;
        let below = 0.5 * (g(low) + g(high)) - g(0.5 * (low + high));
        report.at_most("the bound is concave", (below, round_off), at)?;
        let h = 1e-4 * high;
        let difference = |h: f64| (g(high + h) - g(high - h)) / (2.0 * h);
        let (near, far) = (difference(h), difference(2.0 * h));
        let slope = self.isotropic.slope(high);
        let allowed = 10.0 * (near - far).abs() + 1e3 * round_off / h;
        let property = "the slope is the derivative of the bound";
        report.at_most(property, ((slope - near).abs(), allowed), at)?;
        let least = self.isotropic.slope(0.0);
        report.holds("the slope is finite at no pressure", least.is_finite(), at)
    }

    /// Pairs of the law, of every status.
    fn pairs(&self, report: &mut Report) -> Result<(), Violation> {
        let g = self.isotropic.bound(0.0);
        let closed = if self.isotropic.bound(self.t_n) > 0.0 {
            Status::Stick
        } else {
            Status::Slip
        };
        let open = if g > 0.0 { 0.0 } else { self.slip };
        for (u, t, status) in [
            (
                self.displacement(self.slip, open),
                self.force(0.0, 0.0),
                Status::Open,
            ),
            (
                self.displacement(self.slip, self.slip),
                self.force(0.0, 1.0),
                Status::Open,
            ),
            (
                self.displacement(0.0, 0.0),
                self.force(self.t_n, 0.5),
                closed,
            ),
            (
                self.displacement(0.0, self.slip),
                self.force(self.t_n, 1.0),
                Status::Slip,
            ),
        ] {
            let at = || self.at(&u, &t);
            let (gap, round_off) = self.gap(&u, &t);
            report.at_most("b(−u, t) = −u·t on the law", (gap.abs(), round_off), at)?;
            for alpha in [0.1 * self.alpha, self.alpha] {
                let map = self.law.natural_map(&u, &t, alpha).norm();
                let allowed = 10.0 * ROUND_OFF * (t.norm() + alpha * u.norm());
                report.at_most("the law is a fixed point", (map, allowed), at)?;
                let found = self.law.status(&u, &t, alpha);
                report.holds("the status is that of the pair", found == status, at)?;
            }
        }
        Ok(())
    }

    /// What is lost off the law is positive, and it is no fixed point; outside the domain b is infinite.
    fn departures(&self, report: &mut Report) -> Result<(), Violation> {
        let (t_n, slip) = (self.t_n, self.slip);
        let g = self.isotropic.bound(t_n);
        let mut pairs = vec![(
            self.displacement(slip, 0.0),
            self.force(t_n, 1.0),
            slip * t_n,
        )];
        if g > 0.0 {
            let short = (
                self.displacement(0.0, slip),
                self.force(t_n, 0.9),
                0.1 * g * slip,
            );
            let along = (
                self.displacement(0.0, -slip),
                self.force(t_n, 1.0),
                2.0 * g * slip,
            );
            pairs.extend([short, along]);
        }
        for (u, t, lost) in pairs {
            let at = || self.at(&u, &t);
            let (gap, round_off) = self.gap(&u, &t);
            let error = (gap - lost).abs();
            report.at_most("b(−u, t) > −u·t off the law", (error, round_off), at)?;
            let map = self.law.natural_map(&u, &t, self.alpha).norm();
            // A direction of the stretched frame is shorter in that of the contact, and a force is nearer to a steep bound
            // than its shear is to it.
            let steep = self.isotropic.slope(t_n).hypot(1.0);
            let shorter = self.stretch.min().powi(2) / steep;
            let least = 1e-3 * lost / (slip + t.norm() / self.alpha) * shorter;
            report.at_most("off the law is no fixed point", (least, map), at)?;
        }
        let mut drawn = self.force(t_n, 0.0);
        drawn[0] = -t_n;
        let beyond = self.displacement(0.0, slip);
        for (u, t) in [
            (self.displacement(-slip, 0.0), self.force(t_n, 0.5)),
            (beyond, drawn),
            (beyond, self.force(t_n, 1.001) + 1e-9 * t_n * self.tau),
        ] {
            let infinite = self.law.b(&-u, &t) == f64::INFINITY;
            report.holds("b is infinite outside its domain", infinite, || {
                self.at(&u, &t)
            })?;
        }
        Ok(())
    }

    fn projection(&self, random: &mut Random, report: &mut Report) -> Result<(), Violation> {
        let law = &self.law;
        let mut drawn = || random.vector::<D>(2.0 * self.t_n);
        let (q, other, u) = (drawn(), law.project(&drawn()), drawn() / self.alpha);
        let (none, p) = (Local::zeros(), law.project(&q));
        let at = || self.at(&u, &q);
        for force in [p, law.correct(&u, &q, self.alpha)] {
            report.holds(
                "a projected force is admissible",
                law.b(&none, &force) == 0.0,
                at,
            )?;
        }
        let round_off = 1e2 * ROUND_OFF * q.norm();
        let moved = (law.project(&p) - p).norm();
        report.at_most("projecting twice is projecting", (moved, round_off), at)?;
        let away = |t: &Local<D>| (q - t).component_div(&self.stretch).norm();
        let farther = away(&p) - away(&other);
        report.at_most(
            "the projection is the nearest force",
            (farther, round_off),
            at,
        )
    }

    /// By central differences off the kinks, where those of one step and of two agree.
    fn derivatives(&self, random: &mut Random, report: &mut Report) -> Result<(), Violation> {
        let (law, alpha) = (&self.law, self.alpha);
        let t = random.vector::<D>(2.0 * self.t_n);
        let u = random.vector::<D>(self.t_n / alpha);
        let (by_t, by_u) = law.correct_jacobian(&u, &t, alpha);
        let d = random.direction::<D>();
        let h = 1e-5 * self.t_n;
        let moved = |f: &dyn Fn(f64) -> Local<D>| {
            let slope = |h: f64| (f(h) - f(-h)) / (2.0 * h);
            let (near, far) = (slope(h), slope(2.0 * h));
            (near, (near - far).norm())
        };
        let differences = [
            (by_t * d, moved(&|h| law.correct(&u, &(t + h * d), alpha))),
            (
                -by_u * d / alpha,
                moved(&|h| law.correct(&(u + h / alpha * d), &t, alpha)),
            ),
        ];
        // Rounding of the force over the step, and of what is stretched beside what is not.
        let stretched = self.stretch.max() / self.stretch.min();
        let round_off = f64::EPSILON * stretched * t.norm() / h;
        for (derivative, (difference, kink)) in differences {
            if kink > 1e-6 {
                continue;
            }
            let error = (derivative - difference).norm();
            let property = "the derivatives of the correction";
            let allowed = 1e-7 + kink + round_off;
            report.at_most(property, (error, allowed), || self.at(&u, &t))?;
        }
        Ok(())
    }

    fn scaled(&self, random: &mut Random, report: &mut Report) -> Result<(), Violation> {
        let area = random.between(0.1, 9.0);
        let q = random.vector::<D>(2.0 * self.t_n);
        let error =
            (self.law.scaled(area).project(&(area * q)) / area - self.law.project(&q)).norm();
        let allowed = 1e2 * ROUND_OFF * q.norm();
        report.at_most(
            "forces are tractions times an area",
            (error, allowed),
            || format!("of {:?} on {area} at {:e}", self.law, tangential_norm(&q)),
        )?;
        let mut pressed = Local::<D>::zeros();
        pressed[0] = self.t_n;
        let kept = self.law.scaled(0.0).project(&pressed) == pressed;
        report.holds("a pressure stays on no area", kept, || {
            self.at(&pressed, &pressed)
        })
    }
}
