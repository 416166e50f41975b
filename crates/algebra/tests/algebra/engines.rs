//! What every engine promises, against dense algebra: written once, run over each of them.

use crate::common::promises::*;
use crate::common::{Sample, definite, indefinite, laplacian, norm, saddle};
use moreau_algebra::{Cholesky, Cost, Either, Engine, EngineError, Inertia, Ldlt, Matrix};
use nalgebra::DMatrix;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn definite_systems_are_solved(sample in definite(1..40)) {
        solves::<Cholesky>(&sample, 1e-14);
        solves::<Ldlt>(&sample, 1e-14);
        solves::<Either>(&sample, 1e-14);
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
        solves::<Either>(&sample, 1e-13);
    }

    /// One after the other, in any order.
    #[test]
    fn definite_and_indefinite_systems_take_turns(
        sample in indefinite(2..20),
        shifts in prop::collection::vec(prop::bool::ANY, 1..6),
    ) {
        prop_assume!(is_regular(&sample));
        let size = sample.size();
        let largest = sample.dense.clone().symmetric_eigenvalues().amax();
        // Far beyond the largest eigenvalue: definite, and with the same entries.
        let definite = Sample::new(&sample.dense + DMatrix::identity(size, size) * (2.0 * largest));
        let mut engine = engine::<Either>(&sample);
        for shifted in shifts {
            let own = if shifted { &definite } else { &sample };
            prop_assert_eq!(engine.factorise(&own.values), Ok(inertia_of(own)));
            let b = own.right_hand_sides(3);
            let x = solved(&mut engine, &b);
            prop_assert!(own.residual(&x, &b) < 1e-13);
        }
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

/// An order of elimination in which nothing can be a pivot where it stands: the constraints come first, and in
/// sets that each know only unknowns of their own.
fn constraints_first(blocks: usize) -> Sample {
    let n = 6 * blocks;
    let mut k = DMatrix::zeros(n, n);
    for b in 0..blocks {
        // Two constraints on four unknowns that a chain couples to the next.
        let (r, u) = (2 * b, 2 * blocks + 4 * b);
        for (row, at, v) in [
            (r, u, 1.0),
            (r, u + 1, -1.0),
            (r + 1, u + 2, 1.0),
            (r + 1, u + 1, 0.5),
        ] {
            (k[(row, at)], k[(at, row)]) = (v, v);
        }
        for i in u..u + 4 {
            k[(i, i)] += 2.0;
            if i + 1 < n {
                (k[(i, i + 1)], k[(i + 1, i)]) = (-1.0, -1.0);
            }
        }
    }
    Sample::new(k)
}

#[test]
fn constraints_that_come_first_are_delayed_to_their_unknowns() {
    for blocks in [1, 2, 7, 40] {
        let sample = constraints_first(blocks);
        let mut engine = engine::<Ldlt>(&sample);
        let expected = Inertia {
            positive: 4 * blocks,
            negative: 2 * blocks,
            zero: 0,
        };
        assert_eq!(engine.factorise(&sample.values), Ok(expected));
        solves::<Ldlt>(&sample, 1e-14);
        let refused = self::engine::<Cholesky>(&sample).factorise(&sample.values);
        assert_eq!(refused, Err(EngineError::NotPositiveDefinite { row: 0 }));
    }
}

/// Eigenvalues of the Laplacian of a path: those of the cube are their sums.
fn path(n: usize) -> Vec<f64> {
    let angle = std::f64::consts::PI / n as f64;
    (0..n)
        .map(|k| 2.0 - 2.0 * (k as f64 * angle).cos())
        .collect()
}

/// The Laplacian of a cube less a shift, whose eigenvalues are known: many fronts, some of them large.
#[test]
fn the_inertia_of_a_shifted_laplacian_is_known() {
    for n in [5, 9, 13] {
        let path = path(n);
        for shift in [0.05, 0.7, 3.1, 5.9, 11.3] {
            let (pattern, values) = laplacian(n, -shift);
            let mut sums = path.iter().flat_map(|a| path.iter().map(move |b| a + b));
            let all: Vec<f64> = sums
                .by_ref()
                .flat_map(|ab| path.iter().map(move |c| ab + c - shift))
                .collect();
            let negative = all.iter().filter(|v| **v < 0.0).count();
            let expected = Inertia {
                positive: all.len() - negative,
                negative,
                zero: 0,
            };
            let mut engine = Ldlt::analyse(&pattern, None).expect("small");
            assert_eq!(engine.factorise(&values), Ok(expected), "{n} {shift}");
            // The residual is that of rounding, and next to nothing after one refinement.
            let mut matrix = Matrix::new(pattern);
            matrix.values_mut().1.copy_from_slice(&values);
            let b: Vec<f64> = (0..all.len()).map(|i| (i as f64).sin()).collect();
            let mut x = b.clone();
            engine.solve(&mut x).expect("regular");
            let mut r = matrix.residual(&x, &b);
            let size = 12.0 * norm(&x);
            assert!(norm(&r) < 1e-13 * size, "{:e}", norm(&r) / size);
            engine.solve(&mut r).expect("regular");
            x.iter_mut().zip(r).for_each(|(x, r)| *x += r);
            let left = norm(&matrix.residual(&x, &b));
            assert!(left < 1e-15 * size, "{:e}", left / size);
        }
    }
}

/// The Laplacian itself leaves one motion free, two bodies leave two: the matrix is told to be singular, and
/// how often.
#[test]
fn singular_matrices_are_told_and_not_divided_by() {
    for n in [2, 3, 6, 10, 14, 18] {
        let (pattern, values) = laplacian(n, 0.0);
        let mut engine = Ldlt::analyse(&pattern, None).expect("small");
        let found = engine.factorise(&values);
        let Err(EngineError::Singular { inertia, row }) = found else {
            panic!("{n}: {found:?}, least pivot {:e}", engine.least_pivot());
        };
        let size = n * n * n;
        let expected = Inertia {
            positive: size - 1,
            negative: 0,
            zero: 1,
        };
        assert_eq!((inertia, row), (expected, size - 1));
        assert_eq!(
            engine.solve(&mut vec![1.0; size]),
            Err(EngineError::NotFactorised)
        );
        // Nearly singular ones have a factor, and a least pivot that tells.
        let (_, values) = laplacian(n, 1e-9);
        engine.factorise(&values).expect("regular");
        let least = engine.least_pivot();
        assert!(least > 1e-12 && least < 1e-5, "{least:e}");
    }
    for zeros in [1, 3] {
        let sample = Sample::new(DMatrix::zeros(zeros, zeros));
        let inertia = Inertia {
            zero: zeros,
            ..Inertia::default()
        };
        let found = engine::<Ldlt>(&sample).factorise(&sample.values);
        assert_eq!(found, Err(EngineError::Singular { row: 0, inertia }));
    }
    // Of two columns that are alike one is a zero, whatever the scale.
    for scale in [1e-150, 1e-7, 1.0, 1e100] {
        let alike = DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        let sample = Sample::new(alike * scale);
        let found = engine::<Ldlt>(&sample).factorise(&sample.values);
        let Err(EngineError::Singular { inertia, .. }) = found else {
            panic!("{found:?}");
        };
        assert_eq!(
            inertia,
            Inertia {
                positive: 1,
                negative: 1,
                zero: 1
            }
        );
    }
}

/// With rows and columns in other units, as wide apart as 10 to the fourth of these powers.
fn solves_in_units(plain: &Sample, powers: i32, expected: Inertia) {
    let size = |i: usize| 10f64.powi(powers * (i as i32 % 5 - 2));
    let n = plain.size();
    let scaled = DMatrix::from_fn(n, n, |i, j| plain.dense[(i, j)] * size(i) * size(j));
    let sample = Sample::new(scaled);
    let mut engine = engine::<Ldlt>(&sample);
    assert_eq!(engine.factorise(&sample.values), Ok(expected), "{powers}");
    let exact = plain.right_hand_sides(1);
    let mut x = &plain.dense * &exact;
    for i in 0..n {
        x[i] *= size(i);
    }
    engine.solve(x.as_mut_slice()).expect("regular");
    for i in 0..n {
        let error = x[i] * size(i) - exact[i];
        assert!(error.abs() < 1e-12, "{error:e}");
    }
}

/// Units are of no concern; of constraints, which have no size of their own, within reason.
#[test]
fn rows_of_any_size_are_solved_alike() {
    let (positive, negative, zero) = (20, 10, 0);
    let inertia = Inertia {
        positive,
        negative,
        zero,
    };
    for powers in [0, 1, 3] {
        solves_in_units(&constraints_first(5), powers, inertia);
    }
    let chain = DMatrix::from_fn(40, 40, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 | 7 => -0.4,
        _ => 0.0,
    });
    let inertia = Inertia {
        positive: 40,
        ..Inertia::default()
    };
    for powers in [0, 3, 20] {
        solves_in_units(&Sample::new(chain.clone()), powers, inertia);
    }
}

#[test]
fn other_sizes_and_numbers_are_refused_and_leave_nothing_behind() {
    refuses_other_sizes::<Cholesky>();
    refuses_other_sizes::<Ldlt>();
}

fn refuses_what_has_no_room<E: Engine>() {
    let (pattern, _) = laplacian(6, 1.0);
    let entries = E::analyse(&pattern, None).expect("small").cost().entries;
    for bytes in [0, 4 * entries as u64, 8 * entries as u64 - 8] {
        let no = E::analyse(&pattern, Some(bytes)).expect_err("too large");
        assert!(no.entries > no.room && no.entries <= entries);
        assert_eq!(no.room, bytes as f64 / 8.0);
    }
    assert!(E::analyse(&pattern, Some(8 * entries as u64)).is_ok());
}

#[test]
fn a_factor_larger_than_its_room_is_refused_before_it_is_made() {
    refuses_what_has_no_room::<Cholesky>();
    refuses_what_has_no_room::<Ldlt>();
    // Or while it is, where delays make it grow.
    let sample = constraints_first(30);
    let cost = engine::<Ldlt>(&sample).cost().entries;
    let mut engine = Ldlt::analyse(&sample.pattern, Some(8 * cost as u64)).expect("fits");
    let found = engine.factorise(&sample.values);
    assert!(
        matches!(found, Err(EngineError::TooLarge(no)) if no.entries > no.room),
        "{found:?}"
    );
}

#[test]
fn small_dense_and_disconnected_systems_are_solved() {
    solves_the_extremes::<Cholesky>();
    solves_the_extremes::<Ldlt>();
}

#[test]
fn other_values_on_the_same_pattern_are_factorised_as_by_a_new_engine() {
    factorises_again::<Cholesky>();
    factorises_again::<Ldlt>();
}

/// Springs in a row of which only the first is held, by a soft one: a motion with that little stiffness, in
/// which the last pivot is that of the springs in series.
fn tells_what_hardly_resists<E: Engine>() {
    let n = 6;
    for held in [1.0, 1e-3, 1e-6, 1e-12] {
        let chain = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 if i == 0 => 1.0 + held,
            0 if i + 1 == n => 1.0,
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        let sample = Sample::new(chain);
        let engine = factorised::<E>(&sample);
        let series = 1.0 / (1.0 / held + (n - 1) as f64);
        let ratio = engine.least_pivot() / series;
        // But for the scale of its row.
        assert!(ratio > 0.4 && ratio < 1.001, "{ratio} at {held:e}");
        assert_eq!(engine.cost().operations, (4 * (n - 1) + 1) as f64);
        assert_eq!(Cost::of(&sample.pattern).entries, (2 * n - 1) as f64);
    }
    let none = factorised::<E>(&Sample::new(DMatrix::zeros(0, 0)));
    assert_eq!(none.least_pivot(), f64::INFINITY);
}

#[test]
fn the_least_pivot_tells_what_hardly_resists() {
    tells_what_hardly_resists::<Cholesky>();
    tells_what_hardly_resists::<Ldlt>();
}

#[test]
fn large_fronts_are_solved_with_in_parts() {
    solves_with_large_fronts::<Cholesky>();
    solves_with_large_fronts::<Ldlt>();
}
