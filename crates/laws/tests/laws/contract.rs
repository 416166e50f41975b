//! The public contract on samples that proptest draws, and on laws that are wrong; not the contract.

pub(crate) use moreau_laws::contract::Departure;
use moreau_laws::contract::{self, Space};
use moreau_laws::{AnisotropicCoulomb, Bipotential, Coulomb};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestRunner};

/// Samples of a bipotential, still to be drawn.
pub(crate) struct Samples<X> {
    /// Admissible fluxes.
    pub flux: BoxedStrategy<X>,
    /// Admissible forces.
    pub force: BoxedStrategy<X>,
    /// Fluxes that are not admissible; `None` if all are.
    pub flux_outside: Option<BoxedStrategy<X>>,
    /// Forces that are not admissible.
    pub force_outside: BoxedStrategy<X>,
    /// Pairs (x, y) that obey the law.
    pub law: BoxedStrategy<(X, X)>,
    /// Ways to leave it.
    pub departure: BoxedStrategy<Departure<X>>,
}

/// Runs a property on samples.
pub(crate) fn for_all<S: Strategy + Clone + 'static>(
    samples: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    run(&samples.clone().boxed(), &property);
}

/// Compiled once for each type of value, and not for each property.
fn run<V: std::fmt::Debug>(
    samples: &BoxedStrategy<V>,
    property: &dyn Fn(V) -> Result<(), TestCaseError>,
) {
    let config = Config {
        cases: 512,
        failure_persistence: None,
        ..Config::default()
    };
    if let Err(failure) = TestRunner::new(config).run(samples, property) {
        panic!("{failure}");
    }
}

/// Values of a strategy, always the same.
fn drawn<S: Strategy>(strategy: &S) -> Vec<S::Value> {
    let mut runner = TestRunner::deterministic();
    let mut one = || strategy.new_tree(&mut runner).expect("a value").current();
    (0..512).map(|_| one()).collect()
}

/// The contract of a bipotential and its law.
pub(crate) fn check<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    let outside = samples.flux_outside.as_ref();
    let samples = contract::Samples {
        flux: drawn(&samples.flux),
        force: drawn(&samples.force),
        flux_outside: outside.map(drawn).unwrap_or_default(),
        force_outside: drawn(&samples.force_outside),
        law: drawn(&samples.law),
        departure: drawn(&samples.departure),
    };
    if let Err(violation) = contract::bipotential(b, &samples) {
        panic!("{violation}");
    }
}

/// Laws of friction at the ends of their parameters are laws: what is allowed is of the size of what is compared.
#[test]
fn laws_at_the_ends_of_their_parameters_pass() {
    for mu in [1e-6, 1e2, 1e4, 1e6] {
        let law = Coulomb::new(mu).expect("valid");
        for report in [contract::friction::<2>(law), contract::friction::<3>(law)] {
            report.unwrap_or_else(|violation| panic!("{mu}: {violation}"));
        }
    }
    for (across, along) in [(1e-5, 1.0), (1e-3, 10.0), (1.0, 1e-5)] {
        let law = AnisotropicCoulomb::new(across, along).expect("valid");
        let report = contract::friction::<3>(law);
        report.unwrap_or_else(|violation| panic!("{across} {along}: {violation}"));
    }
}
