//! What no contact problem can be made of, or asked for, is refused and told.

use moreau_contact::{
    Auto, CondensedProblem, ContactError, ContactSolver, Dual, GaussSeidel, Penalty,
    SemismoothNewton, Uzawa,
};
use moreau_laws::{Coulomb, Friction, Local};
use nalgebra::{DMatrix, DVector};

fn law() -> Friction {
    Coulomb::new(0.3).expect("valid").into()
}

fn condensed(stiffness: DMatrix<f64>) -> Result<CondensedProblem<2>, ContactError> {
    let n = stiffness.nrows() / 2;
    let (zero, load) = (vec![Local::zeros(); n], DVector::repeat(2 * n, -1.0));
    CondensedProblem::new(stiffness, load, zero.clone(), vec![law(); n], zero)
}

fn all() -> [Box<dyn ContactSolver<2>>; 5] {
    [
        Box::new(SemismoothNewton::default()),
        Box::new(Penalty::new(1e6, 1e6).expect("valid")),
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
        Box::new(Dual(Auto::default())),
    ]
}

/// Methods that read one triangle and such that read both would solve two problems. Rounding is none of it.
#[test]
fn a_matrix_that_is_not_symmetric_is_refused() {
    let across = |v: f64| {
        let mut a = DMatrix::identity(4, 4) * 2.0;
        (a[(2, 0)], a[(0, 2)]) = (v, 0.5);
        a
    };
    assert!(condensed(across(0.5 + 1e-12)).is_ok());
    let error = condensed(across(1.5)).err();
    assert!(
        matches!(error, Some(ContactError::Unsymmetric { .. })),
        "{error:?}"
    );
    // A structure may be unstable, under the stresses in it.
    let unstable = DMatrix::from_diagonal(&DVector::from_row_slice(&[1.0, -3.0]));
    assert!(condensed(unstable).is_ok());
}

/// The component that is told is that at which the matrix stops to be positive definite: its leading part before it is.
#[test]
fn the_component_told_is_where_the_factorisation_broke_down() {
    for at in 0..6 {
        // A Gram matrix whose row `at` is a sum of those before, or less than nothing; diagonals tell nothing of it.
        let mut root = DMatrix::from_fn(6, 6, |i, j| ((3 * i * i + 7 * j + i * j) as f64).sin());
        for k in 0..6 {
            root[(at, k)] = (0..at).map(|i| root[(i, k)]).sum();
        }
        let singular = &root * root.transpose();
        let mut indefinite = singular.clone();
        indefinite[(at, at)] -= 1e-3;
        for s in [singular, indefinite.clone()] {
            match condensed(s).expect("symmetric").delassus() {
                Err(ContactError::Floating { component }) => assert_eq!(component, at),
                other => panic!("{other:?}"),
            }
        }
        match CondensedProblem::<2>::from_delassus(indefinite, &[Local::zeros(); 3], vec![law(); 3])
        {
            Err(ContactError::Indefinite { component, .. }) => assert_eq!(component, at),
            other => panic!("{other:?}"),
        }
    }
}

/// A residual that is enough is one from zero to anything; at infinity everything is.
#[test]
fn how_much_is_enough_is_a_residual() {
    let s = DMatrix::from_row_slice(
        4,
        4,
        &[
            3.0, 0.5, -1.0, 0.0, 0.5, 2.0, 0.0, -0.5, -1.0, 0.0, 4.0, 0.3, 0.0, -0.5, 0.3, 3.0,
        ],
    );
    let problem = condensed(s).expect("symmetric");
    for solver in all() {
        let whole = solver.solve(&problem, None).expect("solvable");
        for enough in [f64::INFINITY, f64::MAX, 1e300, 1e9] {
            let found = solver
                .approach(&problem, None, enough)
                .expect("anything is enough");
            assert!(found.iterations <= whole.iterations && found.residual.is_finite());
        }
        for enough in [f64::NAN, -1.0, -f64::MIN_POSITIVE, f64::NEG_INFINITY] {
            let error = solver.approach(&problem, None, enough).err();
            assert!(
                matches!(error, Some(ContactError::OutOfRange { .. })),
                "{solver:?} {enough}: {error:?}"
            );
        }
    }
}

/// Lists of another length are slips of the caller, told as such: what is too long is not cut off.
#[test]
fn lists_of_another_length_are_no_answers() {
    let condensed = condensed(DMatrix::identity(4, 4)).expect("symmetric");
    let local = condensed.delassus().expect("regular");
    let panics = |what: &str, call: &dyn Fn()| {
        let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call));
        let message = found.expect_err(what);
        let message = message.downcast_ref::<String>().cloned();
        assert!(
            message.is_some_and(|m| m.contains("a contact") || m.contains("a law")),
            "{what}"
        );
    };
    let right = vec![Local::<2>::zeros(); 2];
    for wrong in [vec![Local::<2>::zeros()], vec![Local::<2>::zeros(); 3]] {
        panics("force", &|| drop(condensed.force(&wrong)));
        panics("residual", &|| {
            drop(condensed.residual(&wrong, &right).to_string())
        });
        panics("residual", &|| {
            drop(condensed.residual(&right, &wrong).to_string())
        });
        panics("statuses", &|| drop(condensed.statuses(&right, &wrong)));
        let statuses = vec![moreau_laws::Status::Stick; wrong.len()];
        panics("criticality", &|| {
            drop(format!("{:?}", condensed.criticality(&statuses)))
        });
        panics("displacement", &|| drop(local.displacement(&wrong)));
        panics("residual", &|| {
            drop(format!("{:?}", local.residual(&right, &wrong)))
        });
        panics("statuses", &|| drop(local.statuses(&wrong, &right)));
    }
}
