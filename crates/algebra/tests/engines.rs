//! What every engine promises, against dense algebra: written once, run over each of them.

mod common;

use common::{Sample, columns, definite, graph, indefinite, laplacian, saddle};
use moreau_algebra::{Cholesky, Cost, Engine, EngineError, Inertia, Ldlt, Pattern};
use nalgebra::DMatrix;
use proptest::prelude::*;

fn engine<E: Engine>(sample: &Sample) -> E {
    E::analyse(&sample.pattern, None).expect("small")
}

/// A factorised engine.
fn factorised<E: Engine>(sample: &Sample) -> E {
    let mut engine = engine::<E>(sample);
    let inertia = engine.factorise(&sample.values).expect("regular");
    let zero = inertia.zero;
    let all = inertia.positive + inertia.negative;
    assert_eq!((all, zero), (sample.size() - engine.kept(), 0));
    engine
}

fn solved(engine: &mut dyn Engine, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut x = b.clone();
    engine.solve(x.as_mut_slice()).expect("regular");
    x
}

/// Solutions as dense algebra finds them, for any number of right-hand sides; of each the same to the bit
/// whatever goes along with it.
fn solves<E: Engine>(sample: &Sample, tolerance: f64) {
    let mut engine = factorised::<E>(sample);
    let b = sample.right_hand_sides(11);
    let x = solved(&mut engine, &b);
    let residual = sample.residual(&x, &b);
    assert!(residual < tolerance, "residual {residual:e}");
    for count in [1, 2, 3, 5, 8] {
        let some = solved(&mut engine, &b.columns(0, count).into_owned());
        assert!(some == x.columns(0, count), "{count} columns");
    }
    let last = solved(
        &mut engine,
        &b.column(10)
            .into_owned()
            .reshape_generic(nalgebra::Dyn(sample.size()), nalgebra::Dyn(1)),
    );
    assert!(last == x.columns(10, 1));
    let exact = sample.dense.clone().lu().solve(&b).expect("regular");
    let least = sample
        .eigenvalues()
        .into_iter()
        .map(f64::abs)
        .fold(1.0, f64::min);
    let error = (&x - &exact).amax() / exact.amax().max(1e-300);
    assert!(
        error < 1e-12 / least,
        "error {error:e}, least eigenvalue {least:e}"
    );
}

/// S, g and u_i against their definitions.
fn condenses<E: Engine>(sample: &Sample) {
    let (n, kept) = (sample.size(), sample.pattern.kept());
    let m = n - kept;
    let mut engine = factorised::<E>(sample);
    let part = |i: usize, j: usize, rows: usize, columns: usize| {
        sample.dense.view((i, j), (rows, columns)).into_owned()
    };
    let inverse = part(0, 0, m, m).try_inverse().expect("regular");
    let coupling = part(m, 0, kept, m);
    let s = part(m, m, kept, kept) - &coupling * &inverse * coupling.transpose();
    let found = engine.schur().expect("factorised");
    let size = sample.dense.amax().max(1.0) * inverse.amax().max(1.0);
    assert!(
        (&found - &s).amax() <= 1e-11 * size * size,
        "{:e}",
        (&found - &s).amax()
    );
    assert_eq!(found, found.transpose());
    let b = sample.right_hand_sides(3);
    let mut x = b.clone();
    engine.condense(x.as_mut_slice()).expect("factorised");
    let g = b.rows(m, kept) - &coupling * &inverse * b.rows(0, m);
    assert!((x.rows(m, kept) - g).amax() <= 1e-11 * size * size);
    // Under any displacements of those that are kept.
    let given = DMatrix::from_fn(kept, 3, |i, j| ((i + 2 * j) as f64).cos());
    x.rows_mut(m, kept).copy_from(&given);
    engine.expand(x.as_mut_slice()).expect("factorised");
    assert_eq!(x.rows(m, kept), given);
    let inner = &inverse * (b.rows(0, m) - coupling.transpose() * &given);
    assert!((x.rows(0, m) - inner).amax() <= 1e-10 * size * size);
}

fn inertia_of(sample: &Sample) -> Inertia {
    let eigenvalues = sample.eigenvalues();
    let count = |ok: fn(&f64) -> bool| eigenvalues.iter().copied().filter(ok).count();
    Inertia {
        positive: count(|v| *v > 0.0),
        negative: count(|v| *v < 0.0),
        zero: 0,
    }
}

/// Whether a matrix is far enough from a singular one for its inertia to be told.
fn is_regular(sample: &Sample) -> bool {
    sample.eigenvalues().iter().all(|v| v.abs() > 1e-9)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn definite_systems_are_solved(sample in definite(1..40)) {
        solves::<Cholesky>(&sample, 1e-14);
        solves::<Ldlt>(&sample, 1e-14);
    }

    #[test]
    fn definite_systems_are_condensed(sample in definite(1..40), kept in 0..40usize) {
        let kept = kept.min(sample.size());
        let sample = sample.keeping(kept);
        condenses::<Cholesky>(&sample);
        condenses::<Ldlt>(&sample);
    }

    #[test]
    fn indefinite_systems_are_solved_and_their_signs_counted(sample in indefinite(1..40)) {
        prop_assume!(is_regular(&sample));
        let mut engine = engine::<Ldlt>(&sample);
        prop_assert_eq!(engine.factorise(&sample.values), Ok(inertia_of(&sample)));
        solves::<Ldlt>(&sample, 1e-13);
    }

    #[test]
    fn saddle_points_have_as_many_negative_signs_as_constraints((sample, rows) in saddle(2..30)) {
        let mut engine = engine::<Ldlt>(&sample);
        let expected = Inertia { positive: sample.size() - rows, negative: rows, zero: 0 };
        prop_assert_eq!(engine.factorise(&sample.values), Ok(expected));
        solves::<Ldlt>(&sample, 1e-13);
    }

    /// Only the inner unknowns have to be regular.
    #[test]
    fn indefinite_systems_are_condensed(sample in indefinite(2..30), kept in 1..10usize) {
        let kept = kept.min(sample.size() - 1);
        let m = sample.size() - kept;
        let inner = Sample::new(sample.dense.view((0, 0), (m, m)).into_owned());
        prop_assume!(inner.eigenvalues().iter().all(|v| v.abs() > 1e-3) && inner.dense.amax() > 0.1);
        let mut engine = engine::<Ldlt>(&sample.clone().keeping(kept));
        prop_assert_eq!(engine.factorise(&sample.values), Ok(inertia_of(&inner)));
        condenses::<Ldlt>(&sample.clone().keeping(kept));
        if is_regular(&sample) {
            solves::<Ldlt>(&sample.keeping(kept), 1e-12);
        }
    }
}
