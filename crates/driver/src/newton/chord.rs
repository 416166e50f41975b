//! What the steps of an increment are expected to leave: whether the factor of an earlier tangent serves
//! one, and how exact its contact solution has to be; not the factorisation.

/// What the steps of an increment tell of the factor at hand.
///
/// A step with the factor of an earlier tangent, of the chord method, lacks the factorisation, which
/// in space takes as long as many solves. It contracts the imbalance by about as much every time:
/// by what the tangent has changed since.
#[derive(Debug, Default)]
pub(crate) struct Chord {
    /// Imbalance before the last step \[N\].
    before: f64,
    /// Whether the last step had the factor of its own tangent.
    fresh: bool,
    /// Part of the last step that was taken; zero before the first.
    part: f64,
    /// Imbalance that the last step was expected to leave \[N\]; not finite before the second.
    forecast: f64,
}

/// The tangent changes in the step that follows as well.
const AGEING: f64 = 4.0;

/// Contraction from which on a factor is of no use.
const POOR: f64 = 0.5;

/// Part of what a step is expected to leave that its contact solution may keep.
pub(crate) const FORCING: f64 = 1e-2;

impl Chord {
    /// Takes note of a step that begins at this imbalance \[N\].
    pub(crate) fn begin(&mut self, imbalance: f64, fresh: bool) {
        let last = match self.part < 1.0 {
            true => f64::INFINITY,
            false => imbalance / self.before,
        };
        let contraction = match (self.fresh, fresh) {
            // Newton's method converges quadratically.
            (true, true) => last * last,
            (true, false) => AGEING * last,
            (false, false) => last,
            (false, true) => f64::INFINITY,
        };
        self.forecast = contraction * imbalance;
        self.before = imbalance;
        self.fresh = fresh;
    }

    /// Whether what the last step is expected to leave will do with the factor at hand, so that the
    /// tangent there is not needed.
    pub(crate) fn may_serve(&self, target: f64, worth: f64) -> bool {
        self.reaches(self.forecast, target, worth)
    }

    /// Residual that the contact solution of the step may keep \[N\]: a part of what the step is
    /// expected to leave, at most of the imbalance at its start; nothing if it may be the last (the
    /// second choice of S. C. Eisenstat and H. F. Walker, SIAM J. Sci. Comput. 17, 1996).
    pub(crate) fn contact_residual(&self, imbalance: f64, target: f64) -> f64 {
        let expected = self.forecast.min(imbalance);
        match expected > target {
            true => FORCING * expected,
            false => 0.0,
        }
    }

    /// Takes note of the part of the step that was taken.
    pub(crate) fn taken(&mut self, part: f64) {
        self.part = part;
    }

    /// Whether steps with the factor at hand reach the target \[N\] sooner than one with a new factor,
    /// which takes as long as `worth` steps.
    pub(crate) fn serves(&self, imbalance: f64, target: f64, worth: f64) -> bool {
        self.part >= 1.0 && self.reaches(imbalance, target, worth)
    }

    fn reaches(&self, imbalance: f64, target: f64, worth: f64) -> bool {
        let ageing = if self.fresh { AGEING } else { 1.0 };
        let contraction = ageing * imbalance / self.before;
        if contraction.is_nan() || contraction >= POOR {
            return false;
        }
        let steps = (target / imbalance).ln() / contraction.ln();
        // A new factor would need a step or two as well.
        steps <= 1.0 + 0.5 * worth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(before: f64, fresh: bool) -> Chord {
        let mut chord = Chord::default();
        chord.begin(before, fresh);
        chord.taken(1.0);
        chord
    }

    #[test]
    fn the_last_step_needs_no_factor_of_its_own() {
        let (imbalance, target) = (1e-8, 1e-10);
        assert!(after(1e-4, true).serves(imbalance, target, 0.0));
        // A first step tells nothing, nor does a shortened one.
        assert!(!Chord::default().serves(imbalance, target, 100.0));
        let mut shortened = after(1e-4, true);
        shortened.taken(0.5);
        assert!(!shortened.serves(imbalance, target, 100.0));
    }

    #[test]
    fn slow_steps_serve_as_far_as_a_factorisation_is_dear() {
        // A tenth a step, seven steps to go.
        let chord = after(1e-2, false);
        assert!(!chord.serves(1e-3, 1e-10, 11.0));
        assert!(chord.serves(1e-3, 1e-10, 13.0));
        assert!(!after(1e-2, true).serves(1e-3, 1e-10, 13.0));
        assert!(!after(1e-2, false).serves(9e-3, 1e-10, 13.0));
        assert!(!after(1e-2, false).serves(f64::NAN, 1e-10, 13.0));
    }

    #[test]
    fn a_contact_solution_is_as_exact_as_the_step_it_belongs_to() {
        // Before the second step there is no forecast.
        let mut chord = after(1.0, true);
        assert_eq!(chord.contact_residual(1.0, 1e-10), FORCING);
        // A tenth, then a hundredth of that; never more than a part of the imbalance.
        chord.begin(1e-1, true);
        assert!((chord.contact_residual(1e-1, 1e-10) - FORCING * 1e-3).abs() < 1e-15);
        assert!((chord.contact_residual(1e-4, 1e-10) - FORCING * 1e-4).abs() < 1e-15);
        // The last is exact, and so is one before which there was none.
        assert_eq!(chord.contact_residual(1e-1, 2e-3), 0.0);
        assert_eq!(chord.contact_residual(0.0, 1e-10), 0.0);
        assert_eq!(Chord::default().contact_residual(f64::NAN, 1e-10), 0.0);
    }

    #[test]
    fn a_step_that_is_likely_to_be_the_last_needs_no_tangent_at_its_end() {
        let mut chord = after(1.0, true);
        assert!(!chord.may_serve(1e-10, 0.0));
        // A tenth, then a hundredth of that, then a ten thousandth.
        chord.begin(1e-1, true);
        assert!(!chord.may_serve(1e-10, 0.0));
        chord.taken(1.0);
        chord.begin(1e-3, true);
        assert!(chord.may_serve(1e-10, 0.0));
        // What was shortened tells nothing.
        chord.taken(0.5);
        chord.begin(1e-5, true);
        assert!(!chord.may_serve(1e-10, 0.0));
        // With a factor from before, a tenth of a tenth.
        let mut stale = after(1e-8, false);
        stale.begin(1e-9, false);
        assert!(stale.may_serve(1e-10, 0.0));
        assert!(!stale.may_serve(1e-13, 0.0));
        assert!(stale.may_serve(1e-13, 6.0));
    }
}
