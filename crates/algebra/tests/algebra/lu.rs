//! Dense unsymmetric systems.

use moreau_algebra::Lu;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

proptest! {
    #[test]
    fn solves_what_is_regular(
        n in 1usize..60, entries in prop::collection::vec(-1.0..1.0f64, 97),
    ) {
        let a = DMatrix::from_fn(n, n, |i, j| {
            entries[(i * 31 + j * 7) % entries.len()] + if i == j { 4.0 * n as f64 } else { 0.0 }
        });
        let x = DVector::from_fn(n, |i, _| (i as f64).sin());
        let solved = Lu::new(a.clone()).expect("regular").solve(&a * &x);
        prop_assert!((solved - x).norm() < 1e-10);
    }
}

#[test]
fn refuses_what_is_not() {
    let singular = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
    assert!(Lu::new(singular).is_none());
    assert!(Lu::new(DMatrix::from_element(3, 3, f64::NAN)).is_none());
}
