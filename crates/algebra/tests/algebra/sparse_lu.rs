//! Sparse unsymmetric systems.

use moreau_algebra::{Rows, SparseLu};
use nalgebra::DVector;

#[test]
fn an_unsymmetric_matrix_is_solved() {
    // Tridiagonal, unlike above and below the diagonal.
    let n = 50;
    let mut a = Rows {
        starts: vec![0],
        ..Rows::default()
    };
    let x = DVector::from_fn(n, |i, _| (i as f64).sin());
    let mut b = DVector::zeros(n);
    for i in 0..n {
        for (j, v) in [(i.wrapping_sub(1), -2.0), (i, 3.0), (i + 1, 0.5)] {
            if j < n {
                a.columns.push(j);
                a.values.push(v);
                b[i] += v * x[j];
            }
        }
        a.starts.push(a.columns.len());
    }
    let solved = SparseLu::new(&a)
        .and_then(|lu| lu.solve(b))
        .expect("regular");
    assert!((solved - x).norm() < 1e-12);
}

/// As a dense factorisation: a pivot that rounding has left is none.
#[test]
fn what_is_singular_to_rounding_is_not_solved() {
    let dense = |entries: [f64; 9]| Rows {
        starts: vec![0, 3, 6, 9],
        columns: [0, 1, 2].repeat(3),
        values: entries.to_vec(),
    };
    let solved = |entries: [f64; 9], b: [f64; 3]| {
        SparseLu::new(&dense(entries)).and_then(|lu| lu.solve(DVector::from_row_slice(&b)))
    };
    let mut entries = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
    let nan = entries.map(|_| f64::NAN);
    assert_eq!(solved(entries, [1.0, 0.0, 0.0]), None);
    assert_eq!(solved(nan, [1.0, 0.0, 0.0]), None);
    // Beside it one that is regular, of any size.
    entries[8] = 1.0;
    for size in [1e-200, 1.0, 1e200] {
        let x = solved(entries.map(|v| v * size), [1.0, 0.0, 0.0]).expect("regular");
        let back = entries[0] * x[0] + entries[1] * x[1] + entries[2] * x[2];
        assert!((size * back - 1.0).abs() < 1e-12);
    }
    assert_eq!(solved(entries, [0.0; 3]), Some(DVector::zeros(3)));
}

#[test]
fn nothing_is_solved_too() {
    let lu = SparseLu::new(&Rows::default()).expect("nothing to refuse");
    assert_eq!(lu.solve(DVector::zeros(0)), Some(DVector::zeros(0)));
}
