//! Contacts whose structure has next to no stiffness: what their gaps are is seen all the same.

use moreau_contact::{CondensedProblem, ContactError, ContactSolver, Penalty, SemismoothNewton};
use moreau_laws::{Coulomb, Friction, Local, Status};
use nalgebra::{DMatrix, DVector};

fn methods() -> [Box<dyn ContactSolver<2>>; 2] {
    [
        Box::new(SemismoothNewton::default()),
        Box::new(Penalty::new(1e16, 1e16).expect("valid")),
    ]
}

/// Contacts of diagonal stiffness under normal loads, with gaps.
fn problem(stiffness: &[f64], load: &[f64], gaps: &[f64]) -> CondensedProblem<2> {
    let law: Friction = Coulomb::new(0.3).expect("valid").into();
    let both = |v: &[f64]| DVector::from_iterator(2 * v.len(), v.iter().flat_map(|v| [*v, 0.0]));
    let own = DVector::from_iterator(2 * stiffness.len(), stiffness.iter().flat_map(|s| [*s; 2]));
    let origin = gaps.iter().map(|g| Local::<2>::new(*g, 0.0)).collect();
    let zero = vec![Local::zeros(); gaps.len()];
    let stiffness = DMatrix::from_diagonal(&own);
    let laws = vec![law; gaps.len()];
    CondensedProblem::new(stiffness, both(load), origin, laws, zero).expect("valid")
}

/// Pressed, a contact is closed: u_n = 0 and t_n the load, without any stiffness too, in any units.
#[test]
fn a_contact_of_no_stiffness_is_closed_by_its_load() {
    for (solver, unit) in methods()
        .iter()
        .flat_map(|s| [1e-6, 1.0, 1e6].map(|u| (s, u)))
    {
        for stiffness in [0.0, 1e-3, 1.0] {
            for weight in [0.0, 100.0] {
                let mut problem = problem(&[stiffness * unit], &[-unit], &[0.1]);
                problem.weigh(weight * unit);
                let found = solver.solve(&problem, None).expect("pressed");
                let expected = unit * (1.0 - 0.1 * stiffness);
                let (u, t) = (found.irreversible[0], found.force[0]);
                let told = format!("{solver:?} {stiffness} {unit} {weight}: {u:?} {t:?}");
                assert!(
                    found.exact && (t[0] / expected - 1.0).abs() < 1e-9,
                    "{told}"
                );
                // A structure of this stiffness tells rounding of forces from displacements no larger.
                let rounding = 1e-13 / (stiffness + weight).max(1e-12);
                assert!(u[0].abs() < 1e-9 + rounding.min(1e-6), "{told}");
                let gap = found.certificate(&problem).bipotential_gap;
                assert!(gap.abs() < 1e-6 * unit, "{told}: {gap}");
            }
        }
    }
}

/// Beside a stiff contact, open or closed: the soft one is closed by its own load.
#[test]
fn a_stiff_contact_does_not_hide_a_soft_one() {
    for solver in methods() {
        for soft in [0.0, 1e-12, 1e-9] {
            for (load, closed) in [(0.0, false), (-0.5, false), (-20.0, true)] {
                let problem = problem(&[100.0, soft], &[load, -1.0], &[0.1, 0.05]);
                let found = solver.solve(&problem, None).expect("pressed");
                let (u, t) = (&found.irreversible, &found.force);
                let told = format!("{solver:?} {soft} {load}: {u:?} {t:?}");
                assert!(found.exact && u[1][0].abs() < 1e-9, "{told}");
                assert!((t[1][0] - 1.0).abs() < 1e-9, "{told}");
                let expected = if closed { 0.0 } else { 0.1 + load / 100.0 };
                assert!((u[0][0] - expected).abs() < 1e-9, "{told}");
            }
        }
    }
}

/// Pulled, nothing holds it: there is no solution, and none is told.
#[test]
fn a_contact_of_no_stiffness_that_is_pulled_has_no_solution() {
    for solver in methods() {
        let found = solver.solve(&problem(&[0.0], &[1.0], &[0.1]), None);
        assert!(matches!(found, Err(ContactError::Singular)), "{found:?}");
    }
}

/// The weight of a map never vanishes, and of contacts of some stiffness it is their own.
#[test]
fn the_weight_of_displacements_never_vanishes() {
    assert_eq!(problem(&[0.0], &[-1.0], &[0.1]).alpha(0), 10.0);
    assert_eq!(problem(&[0.0], &[0.0], &[0.1]).alpha(0), 1.0);
    let mixed = problem(&[100.0, 0.0, 1.0], &[-1.0; 3], &[0.1; 3]);
    assert!(mixed.alpha(1) > 0.0 && mixed.alpha(1) < 1e-3);
    assert_eq!((mixed.alpha(0), mixed.alpha(2)), (100.0, 1.0));
    assert_eq!(problem(&[-3.0, 2.0], &[-1.0; 2], &[0.1; 2]).alpha(0), -3.0);
    let mut held = problem(&[0.0], &[-1.0], &[0.1]);
    held.hold(2.0);
    assert_eq!(held.alpha(0), 2.0);
}

/// A body that nothing holds under a load of rounding: where that is told, it is at rest where it is.
#[test]
fn a_load_that_is_rounding_moves_nothing() {
    let s = DMatrix::from_row_slice(
        4,
        4,
        &[
            1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0,
        ],
    );
    let load = DVector::from_row_slice(&[1e-10, 0.0, 2e-10, 0.0]);
    let gaps = vec![Local::<2>::new(0.1, 0.0); 2];
    let before = vec![Local::<2>::new(1.0, 0.0), Local::zeros()];
    let problem = CondensedProblem::new(
        s,
        load,
        gaps,
        vec![Coulomb::new(0.3).expect("valid"); 2],
        before,
    );
    let mut problem = problem.expect("valid");
    let solve = |problem: &_| SemismoothNewton::default().solve(problem, None);
    assert!(solve(&problem).is_err());
    problem.rounds(1e-9);
    let solution = solve(&problem).expect("at rest");
    assert!(solution.exact);
    assert_eq!(solution.motion, [Local::<2>::zeros(); 2]);
    assert_eq!(solution.status, [Status::Open; 2]);
    // A load that is more than that moves it.
    problem.rounds(1e-12);
    assert!(solve(&problem).is_err());
}
