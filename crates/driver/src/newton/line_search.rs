//! How far to go along a Newton step; not which step.

use crate::assembly::cell_law::Stiffness;
use crate::driver::Driver;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::newton::iterate::Iterate;
use crate::vector::prescribed::residual;
use crate::vector::{SparseVector, largest};

/// Step lengths that are tried before the last is taken.
const TRIALS: usize = 12;

/// Slope of ΔΦ at a step length over that at zero, below which the length is accepted.
const ACCEPTED_SLOPE: f64 = 0.5;

/// A Newton step from an iterate.
pub(crate) struct NewtonStep {
    /// Displacements of the step, at every degree of freedom \[mm\].
    pub(crate) displacement: Vec<f64>,
    /// What it adds to the unknown factor of a load; zero where none is unknown.
    pub(crate) factor: f64,
    /// What that adds to the applied forces \[N\].
    pub(crate) growth: SparseVector,
    /// Contact forces at its end, in the frames of its begin \[N\].
    pub(crate) contact: SparseVector,
    /// How they change to its end as they turn with their tools \[N\].
    pub(crate) turned: SparseVector,
    /// Whether the iterate has all prescribed displacements and the motions of tools already.
    pub(crate) complete: bool,
    /// Whether it makes up for prescribed displacements that are missing.
    pub(crate) arrives: bool,
    /// Out-of-balance force left by the contact solver \[N\].
    pub(crate) slack: f64,
    /// Whether the tangent at its end is likely to be needed.
    pub(crate) tangent: bool,
    /// Residual that a step may leave \[N\] where forces have no potential; `None` where ΔΦ decides.
    pub(crate) allowed: Option<f64>,
}

/// The way along a step from an iterate.
struct Line<'a, const D: usize> {
    end: &'a Loading<D>,
    from: &'a Iterate,
    step: &'a NewtonStep,
    /// Whether the contact forces of the end act on the whole way, turning with it: what is searched then has the
    /// slope −vᵀKv at the start, wherever tools have moved, and none at the end of a step on which all is linear.
    under_last: bool,
}

impl<const D: usize> Line<'_, D> {
    fn displacement(&self, s: f64) -> Vec<f64> {
        let pairs = self.from.d_u.iter().zip(&self.step.displacement);
        pairs.map(|(u, v)| u + s * v).collect()
    }

    /// Contact forces between those of both ends.
    fn contact(&self, s: f64) -> SparseVector {
        if self.under_last {
            let turned = |a, b| a + s * b;
            return self.step.contact.with(&self.step.turned, turned);
        }
        self.from
            .contact
            .with(&self.step.contact, |a, b| (1.0 - s) * a + s * b)
    }

    /// Out-of-balance force at the part s of the step under contact forces, at every degree of freedom;
    /// zero at those prescribed.
    fn residual(
        &self,
        system: &System,
        internal: &[f64],
        contact: &SparseVector,
        s: f64,
    ) -> Vec<f64> {
        let growth = self.step.growth.scaled(s);
        residual(
            internal,
            &[&self.end.force, &growth, contact],
            system.prescribed(),
        )
    }

    /// Slope of ΔΦ along the step, where the residual is this.
    fn slope(&self, residual: &[f64]) -> f64 {
        let pairs = self.step.displacement.iter().zip(residual);
        -pairs.map(|(v, r)| v * r).sum::<f64>()
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

impl<const D: usize> Driver<D> {
    /// Goes along a Newton step, and returns the part taken: all of it, unless that overshoots the minimum
    /// of ΔΦ with contact forces between those of both ends. Friction that changes can make ΔΦ no potential
    /// of the step, which then does not begin downhill; there the norm of the residual decides; where the
    /// forces of the bulk have none, the largest residual of the last iterations, so that kinks are passed.
    pub(crate) fn search(
        &mut self,
        system: &mut System,
        end: &Loading<D>,
        step: &NewtonStep,
        iterate: &mut Iterate,
    ) -> f64 {
        let none = SparseVector::default();
        let line = Line {
            end,
            from: iterate,
            step,
            under_last: self.has_large_strains(),
        };
        let d_u = line.displacement(1.0);
        let stiffness = match step.tangent {
            true => Stiffness::Plastic(1.0),
            false => Stiffness::None,
        };
        let assembly = self.assemble(system, end, (&d_u, &none), stiffness);
        let scale = self.force_scale((&assembly, line.from.heated), end, &step.contact);
        let before = line.residual(
            system,
            &line.from.assembly.internal,
            &line.contact(0.0),
            0.0,
        );
        let (at_start, out, before) = (
            line.slope(&before),
            largest(before.iter().copied()),
            norm(&before),
        );
        let after = line.residual(system, &assembly.internal, &line.contact(1.0), 1.0);
        let (at_end, left) = (line.slope(&after), largest(after.iter().copied()));
        let overshoots = match step.allowed {
            Some(allowed) => left > allowed,
            None if at_start < 0.0 => at_end > ACCEPTED_SLOPE * at_start.abs(),
            None => norm(&after) > before,
        };
        // A step that turns cells inside out leads to no forces.
        let inverts = !left.is_finite();
        // While prescribed displacements or motions are missing, ΔΦ is not what the step minimises; in balance
        // its slope is rounding; and an iterate that is in balance, but not under the law, is better than any beside it.
        let enough = self.accepted_residual(system, scale, &d_u) + step.slack;
        let searched = (step.complete || line.under_last && !step.arrives) && out > enough;
        if !inverts && (!searched || !overshoots || left <= enough) {
            *iterate = Iterate {
                d_u,
                assembly,
                contact: step.contact.clone(),
                heated: line.from.heated,
                part: 1.0,
            };
            return 1.0;
        }
        let s = match step.allowed {
            Some(allowed) => {
                self.backtrack(system, &line, |r| largest(r.iter().copied()) <= allowed)
            }
            None if at_start < 0.0 => self.minimise(system, &line, at_start, at_end),
            None => self.backtrack(system, &line, |r| norm(r) < before),
        };
        let d_u = line.displacement(s);
        *iterate = Iterate {
            assembly: self.assemble(system, end, (&d_u, &none), Stiffness::Plastic(1.0)),
            contact: line.contact(s),
            heated: line.from.heated,
            d_u,
            part: s,
        };
        s
    }

    /// The residual at the part s of a step.
    fn residual_along(&mut self, system: &mut System, line: &Line<'_, D>, s: f64) -> Vec<f64> {
        let (trial, none) = (line.displacement(s), SparseVector::default());
        let at = self.assemble(system, line.end, (&trial, &none), Stiffness::None);
        line.residual(system, &at.internal, &line.contact(s), s)
    }

    /// Step length at which the slope of ΔΦ about vanishes, by the Illinois variant of regula
    /// falsi between the slopes at 0 and at 1.
    fn minimise(
        &mut self,
        system: &mut System,
        line: &Line<'_, D>,
        at_start: f64,
        at_end: f64,
    ) -> f64 {
        let (mut low, mut high) = ((0.0, at_start), (1.0, at_end));
        let mut last_side = 0.0;
        let mut s = 1.0;
        for _ in 0..TRIALS {
            let margin = 0.05 * (high.0 - low.0);
            s = match high.1.is_finite() {
                true => (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1),
                false => 0.5 * (low.0 + high.0),
            };
            s = s.clamp(low.0 + margin, high.0 - margin);
            let slope = line.slope(&self.residual_along(system, line, s));
            if slope.abs() <= ACCEPTED_SLOPE * at_start.abs() {
                break;
            }
            // An end that stays twice weighs half.
            if slope > 0.0 || !slope.is_finite() {
                high = (s, slope);
                low.1 *= if last_side > 0.0 { 0.5 } else { 1.0 };
            } else {
                low = (s, slope);
                high.1 *= if last_side < 0.0 { 0.5 } else { 1.0 };
            }
            last_side = slope;
        }
        s
    }

    /// Step length at which the residual will do.
    fn backtrack(
        &mut self,
        system: &mut System,
        line: &Line<'_, D>,
        will_do: impl Fn(&[f64]) -> bool,
    ) -> f64 {
        let mut s = 1.0;
        for _ in 0..TRIALS {
            s *= 0.5;
            if will_do(&self.residual_along(system, line, s)) {
                break;
            }
        }
        s
    }
}
