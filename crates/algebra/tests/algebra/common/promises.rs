//! What every engine promises, against dense algebra: written once, run over each of them.
// Not every test uses all of them.
#![allow(dead_code, unreachable_pub, missing_docs)]

use super::{Sample, laplacian, norm};
use moreau_algebra::{Engine, EngineError, Inertia, Matrix};
use nalgebra::DMatrix;

pub fn engine<E: Engine>(sample: &Sample) -> E {
    E::analyse(&sample.pattern, None).expect("small")
}

/// A factorised engine.
pub fn factorised<E: Engine>(sample: &Sample) -> E {
    let mut engine = engine::<E>(sample);
    let inertia = engine.factorise(&sample.values).expect("regular");
    let zero = inertia.zero;
    let all = inertia.positive + inertia.negative;
    assert_eq!((all, zero), (sample.size() - engine.kept(), 0));
    engine
}

pub fn solved(engine: &mut dyn Engine, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut x = b.clone();
    engine.solve(x.as_mut_slice()).expect("regular");
    x
}

/// Whether two solutions of the same system are the same: to the bit, or of an engine of another kind, whose sums
/// come in the order in which its processes are ready, but for rounding.
fn alike<E: Engine>(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
    let own = std::any::type_name::<E>().starts_with("moreau_algebra");
    a == b || (!own && (a - b).amax() <= 1e-9 * a.amax())
}

/// Solutions as dense algebra finds them, for any number of right-hand sides; of each the same to the bit
/// whatever goes along with it.
pub fn solves<E: Engine>(sample: &Sample, tolerance: f64) {
    let mut engine = factorised::<E>(sample);
    let b = sample.right_hand_sides(11);
    let x = solved(&mut engine, &b);
    let residual = sample.residual(&x, &b);
    assert!(residual < tolerance, "residual {residual:e}");
    for count in [1, 2, 3, 5, 8] {
        let some = solved(&mut engine, &b.columns(0, count).into_owned());
        assert!(
            alike::<E>(&some, &x.columns(0, count).into()),
            "{count} columns"
        );
    }
    let last = solved(&mut engine, &b.columns(10, 1).into_owned());
    assert!(alike::<E>(&last, &x.columns(10, 1).into()));
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
pub fn condenses<E: Engine>(sample: &Sample) {
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

pub fn inertia_of(sample: &Sample) -> Inertia {
    let eigenvalues = sample.eigenvalues();
    let count = |ok: fn(&f64) -> bool| eigenvalues.iter().copied().filter(ok).count();
    Inertia {
        positive: count(|v| *v > 0.0),
        negative: count(|v| *v < 0.0),
        zero: 0,
    }
}

/// Whether a matrix is far enough from a singular one for its inertia to be told.
pub fn is_regular(sample: &Sample) -> bool {
    sample.eigenvalues().iter().all(|v| v.abs() > 1e-9)
}

pub fn refuses_other_sizes<E: Engine>() {
    let (pattern, mut values) = laplacian(3, 0.1);
    let mut engine = E::analyse(&pattern.keeping(4).expect("27"), None).expect("small");
    let not = Err(EngineError::NotFactorised);
    assert_eq!(engine.solve(&mut [0.0; 27]), not);
    assert_eq!(engine.condense(&mut [0.0; 27]), not);
    assert_eq!(engine.expand(&mut [0.0; 27]), not);
    assert_eq!(engine.schur(), Err(EngineError::NotFactorised));
    let (found, expected) = (values.len() - 1, values.len());
    let what = "values";
    let length = EngineError::Length {
        what,
        found,
        expected,
    };
    assert_eq!(engine.factorise(&values[1..]), Err(length));
    engine.factorise(&values).expect("definite");
    for found in [1, 26, 28, 80] {
        let mut x = vec![0.0; found];
        for outcome in [
            engine.solve(&mut x),
            engine.condense(&mut x),
            engine.expand(&mut x),
        ] {
            let other = matches!(outcome, Err(EngineError::Length { expected: 27, .. }));
            assert!(other, "{found}: {outcome:?}");
        }
    }
    // No column at all is none to solve for.
    assert_eq!(engine.solve(&mut []), Ok(()));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let at = values.len() / 2;
        let kept = std::mem::replace(&mut values[at], bad);
        let refused = engine.factorise(&values);
        assert!(
            matches!(refused, Err(EngineError::NotFinite { .. })),
            "{bad}: {refused:?}"
        );
        assert_eq!(engine.solve(&mut [0.0; 27]), not);
        values[at] = kept;
        // What failed leaves nothing behind.
        engine.factorise(&values).expect("definite");
        engine.solve(&mut [1.0; 27]).expect("definite");
    }
}

/// Sizes 0 and 1, all rows dense, and parts that know nothing of each other.
pub fn solves_the_extremes<E: Engine>() {
    for kept in [0, 1] {
        for n in kept..3 {
            let sample = Sample::new(DMatrix::identity(n, n) * 2.0).keeping(kept);
            condenses::<E>(&sample);
            if n > 0 {
                solves::<E>(&sample, 1e-15);
            }
        }
    }
    let all = DMatrix::from_fn(
        50,
        50,
        |i, j| if i == j { 60.0 } else { ((i * j) as f64).sin() },
    );
    for kept in [0, 13, 50] {
        solves::<E>(&Sample::new(all.clone()).keeping(kept), 1e-14);
        condenses::<E>(&Sample::new(all.clone()).keeping(kept));
    }
    let apart = DMatrix::from_fn(60, 60, |i, j| match i == j {
        true => 3.0,
        false if i % 7 == j % 7 => ((i + j) as f64).sin() * 0.3,
        false => 0.0,
    });
    for kept in [0, 9] {
        solves::<E>(&Sample::new(apart.clone()).keeping(kept), 1e-14);
        condenses::<E>(&Sample::new(apart.clone()).keeping(kept));
    }
}

/// A factor knows nothing of the values before it.
pub fn factorises_again<E: Engine>() {
    let (pattern, one) = laplacian(5, 0.3);
    let (_, two) = laplacian(5, 2.0);
    let solution = |engine: &mut E, values: &[f64]| {
        engine.factorise(values).expect("definite");
        let mut x: Vec<f64> = (0..125).map(|i| (i as f64).cos()).collect();
        engine.solve(&mut x).expect("definite");
        (x, engine.least_pivot())
    };
    let mut engine = E::analyse(&pattern, None).expect("small");
    let first = solution(&mut engine, &one);
    let second = solution(&mut engine, &two);
    assert_ne!(first, second);
    let same = |(a, p): (Vec<f64>, f64), (b, q): &(Vec<f64>, f64)| {
        let [a, b] = [a.as_slice(), b].map(|x| DMatrix::from_column_slice(125, 1, x));
        assert!(alike::<E>(&a, &b) && (p / q - 1.0).abs() < 1e-12);
    };
    same(solution(&mut engine, &one), &first);
    let mut fresh = E::analyse(&pattern, None).expect("small");
    same(solution(&mut fresh, &two), &second);
}

/// Fronts of more rows than are gone through at once.
pub fn solves_with_large_fronts<E: Engine>() {
    let (pattern, values) = laplacian(18, 0.5);
    let mut engine = E::analyse(&pattern, None).expect("small");
    engine.factorise(&values).expect("definite");
    let mut matrix = Matrix::new(pattern);
    matrix.values_mut().1.copy_from_slice(&values);
    let n = engine.size();
    let b: Vec<f64> = (0..3 * n).map(|i| (i as f64).sin()).collect();
    let mut x = b.clone();
    engine.solve(&mut x).expect("definite");
    for (x, b) in x.chunks(n).zip(b.chunks(n)) {
        let left = norm(&matrix.residual(x, b));
        assert!(left < 1e-14 * norm(b), "{:e}", left / norm(b));
    }
}
