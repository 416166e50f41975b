//! Factors and products of dense matrices, against their definitions.

use moreau_algebra::{
    DenseCholesky, DenseLdlt, Inertia, less_gram, mirror, square, transposed_product,
};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

proptest! {
    /// A = C D Cᵀ has the signs of D, by Sylvester's law.
    #[test]
    fn signs_are_those_of_the_eigenvalues(
        n in 1usize..70, entries in prop::collection::vec(-1.0..1.0f64, 97),
        signs in prop::collection::vec(-1i32..2, 70),
    ) {
        let c = DMatrix::from_fn(n, n, |i, j| {
            entries[(i * 31 + j * 7) % 97] + if i == j { n as f64 } else { 0.0 }
        });
        let d = DMatrix::from_fn(n, n, |i, j| if i == j { f64::from(signs[i]) } else { 0.0 });
        let a = &c * d * c.transpose();
        let factor = DenseLdlt::new(a.clone()).expect("finite");
        let of = |sign: i32| signs[..n].iter().filter(|s| **s == sign).count();
        let expected = Inertia { positive: of(1), negative: of(-1), zero: of(0) };
        prop_assert_eq!(factor.inertia(1e-10 * (1.0 + a.amax())), expected);
        if of(0) == 0 {
            let x = DVector::from_fn(n, |i, _| (i as f64).sin());
            let mut solved = &a * &x;
            factor.solve(&mut solved);
            prop_assert!((solved - x).norm() < 1e-8);
        }
    }
}

#[test]
fn products_are_those_of_the_definition() {
    let c = DMatrix::from_fn(3, 50, |i, j| ((i + 2 * j) as f64).sin());
    let d = DMatrix::from_fn(3, 4, |i, j| ((5 * i + j) as f64).cos());
    assert!((transposed_product(&c, &d) - c.transpose() * &d).amax() < 1e-14);
    // In more than one block of columns.
    let l = DMatrix::from_fn(300, 300, |i, j| ((3 * i + 7 * j) as f64).sin());
    let l = l.lower_triangle();
    assert!((square(l.clone()) - &l * l.transpose()).amax() < 1e-11);
    let a = DMatrix::from_fn(70, 70, |i, j| ((i * j) as f64).sin() + (i + j) as f64);
    let mut lower = a.lower_triangle();
    let expected = a.view((0, 0), (50, 50)) - c.transpose() * &c;
    assert!((less_gram(lower.clone(), &c) - expected).amax() < 1e-12);
    mirror(&mut lower);
    assert_eq!(lower, a);
}

#[test]
fn factors_solve_and_are_refused_where_there_is_none() {
    let l = DMatrix::from_fn(70, 70, |i, j| match i.cmp(&j) {
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Equal => 2.0 + (i as f64).sin(),
        std::cmp::Ordering::Greater => 0.1 * ((3 * i + j) as f64).cos(),
    });
    let a = square(l.clone());
    assert!((&a - &l * l.transpose()).norm() < 1e-12 * a.norm());
    let cholesky = DenseCholesky::new(a.clone()).expect("definite");
    let least = l.diagonal().amin().powi(2);
    assert!(cholesky.holds(0.9e13 * least) && !cholesky.holds(1.1e13 * least));
    let x = DMatrix::from_fn(70, 3, |i, j| ((i + 5 * j) as f64).sin());
    let mut forward = &l * &x;
    cholesky.forward(&mut forward);
    assert!((forward - &x).norm() < 1e-11);
    let mut one = &a * x.column(0);
    cholesky.forward_one(&mut one);
    cholesky.backward_one(&mut one);
    assert!((one - x.column(0)).norm() < 1e-10);
    let none = DenseCholesky::new(DMatrix::zeros(0, 0)).expect("nothing to refuse");
    assert!(none.holds(0.0));
    let mut indefinite = a;
    indefinite[(40, 40)] = -1.0;
    assert!(DenseCholesky::new(indefinite).is_none());
    assert!(DenseCholesky::new(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    assert!(DenseLdlt::new(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    let nothing = DenseLdlt::new(DMatrix::zeros(0, 0)).expect("nothing to refuse");
    assert_eq!(nothing.inertia(0.0), Inertia::default());
}
