//! What an increment counts on its way; not what is told of it.

/// How near residuals are to those of a period before where iterates go round, in parts.
const SAME: f64 = 1e-6;

/// The longest period that is looked for.
const PERIOD: usize = 8;

/// What an increment has counted.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    pub(crate) newton: usize,
    pub(crate) solves: usize,
    pub(crate) contact: usize,
    /// Iterations of the contact solver in the last solve.
    pub(crate) last_contact: usize,
    pub(crate) shortened: usize,
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients, and steps for what a symmetric tangent lacks or for surfaces that move.
    pub(crate) linear: usize,
    /// [`IncrementReport::contact_solves`].
    pub(crate) contact_solves: usize,
    /// Factorisations, and iterations of conjugate gradients, that the system had done before.
    pub(crate) before: (usize, usize),
    pub(crate) residuals: Vec<f64>,
    /// [`IncrementReport::criticality`].
    pub(crate) criticality: Option<(usize, f64)>,
    /// [`IncrementReport::negative_eigenvalues`].
    pub(crate) negative: usize,
    /// Whether the statuses have left a rigid motion free on the way.
    pub(crate) undetermined: bool,
}

impl Counts {
    /// Takes over what a part of the increment has counted.
    pub(crate) fn add(&mut self, part: &Self) {
        self.newton += part.newton;
        self.solves += part.solves;
        self.contact += part.contact;
        self.shortened += part.shortened;
        self.factorisations += part.factorisations;
        self.linear += part.linear;
        self.contact_solves += part.contact_solves;
        self.undetermined |= part.undetermined;
        self.criticality = part.criticality;
        self.negative = part.negative;
        self.residuals.extend(&part.residuals);
    }

    /// These, with those of the way that led to balance.
    pub(crate) fn with(mut self, last: Self) -> Self {
        self.add(&last);
        self.undetermined = last.undetermined;
        self
    }

    /// Whether the last step has left about as much out of balance as the one before.
    pub(crate) fn no_longer_improves(&self) -> bool {
        match self.residuals.as_slice() {
            [.., before, now] => *now >= 0.25 * before,
            _ => false,
        }
    }

    /// Whether the least residual has not been halved in so many iterations.
    pub(crate) fn stagnates(&self, iterations: usize) -> bool {
        let (mut least, mut since) = (f64::INFINITY, 0);
        for &residual in &self.residuals {
            if residual < 0.5 * least {
                (least, since) = (residual, 0);
            } else {
                since += 1;
            }
        }
        since >= iterations
    }

    /// Whether the iterates go round: the residuals of the last two periods are those of the two before.
    pub(crate) fn goes_round(&self) -> bool {
        let back: Vec<f64> = self.residuals.iter().rev().copied().collect();
        let same = |a: f64, b: f64| (a - b).abs() <= SAME * b;
        (1..=PERIOD).any(|period| {
            let pairs = (2 * period).max(6);
            back.len() >= pairs + period && (0..pairs).all(|k| same(back[k], back[k + period]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(residuals: impl Iterator<Item = f64>) -> Counts {
        Counts {
            residuals: residuals.collect(),
            ..Counts::default()
        }
    }

    #[test]
    fn a_way_that_goes_round_is_seen_and_one_that_is_slow_is_not() {
        let cycle = [1.8, 1.2, 19.7, 15.9, 1.82];
        let rounds = |n: usize| (0..n).map(|k| cycle[k % 5]);
        assert!(of([300.0, 56.0].into_iter().chain(rounds(15))).goes_round());
        assert!(!of([300.0, 56.0].into_iter().chain(rounds(13))).goes_round());
        assert!(of(std::iter::repeat_n(3.0, 7)).goes_round());
        assert!(!of(std::iter::repeat_n(3.0, 6)).goes_round());
        assert!(!of((0..40).map(|k| 0.9f64.powi(k))).goes_round());
        assert!(!of((0..40).map(|k| 2.0 + (f64::from(k)).sin())).goes_round());
    }

    #[test]
    fn a_way_that_wanders_stagnates_and_one_that_is_slow_does_not() {
        let wanders = |n: u32| of((0..n).map(|k| 2.0 + f64::from(k).sin()));
        assert!(wanders(16).stagnates(15));
        assert!(!wanders(15).stagnates(15));
        assert!(!of((0..40).map(|k| 0.94f64.powi(k))).stagnates(15));
        let arrives = [5.0, 4.0, 6.0, 3.0, 7.0, 2.0, 1e-3, 1e-8];
        assert!(!of(arrives.into_iter().cycle().take(8)).stagnates(5));
        assert!(of(std::iter::repeat_n(f64::NAN, 15)).stagnates(15));
    }
}
