//! Every method for the local problem on problems with known answers, and all against each other.

use crate::stack;
use moreau_contact::{
    Admm, Auto, BlockMatrix, Certificate, CondensedProblem, ContactError, ContactSolver, Dual,
    GaussSeidel, GlobalProblem, LocalProblem, LocalSolution, LocalSolver, NewtonMap, Penalty,
    ProximalNewton, Reason, SemismoothNewton, Tolerance, TrescaFixedPoint, Uzawa,
};
use moreau_laws::{
    AnisotropicCoulomb, Coulomb, Friction, LimitedCoulomb, Local, Status, Tie, Tresca,
};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

const SHARP: f64 = 1e-12;

fn methods<const D: usize>() -> Vec<Box<dyn LocalSolver<D>>> {
    let tolerance = Tolerance {
        relative: SHARP,
        iterations: 100_000,
    };
    let mut all: Vec<Box<dyn LocalSolver<D>>> = vec![
        Box::new(Auto { tolerance: SHARP }),
        Box::new(GaussSeidel { tolerance }),
        Box::new(Uzawa { tolerance }),
        Box::new(Admm { tolerance }),
        Box::new(TrescaFixedPoint { tolerance }),
    ];
    for map in [
        NewtonMap::AlartCurnier,
        NewtonMap::JeanMoreau,
        NewtonMap::Natural,
    ] {
        all.push(Box::new(ProximalNewton { map, tolerance }));
    }
    all
}

fn problem<const D: usize>(w: &DMatrix<f64>, q: &[Local<D>], mu: f64) -> LocalProblem<D> {
    under(w, q, Coulomb::new(mu).expect("valid friction").into())
}

fn under<const D: usize>(w: &DMatrix<f64>, q: &[Local<D>], law: Friction) -> LocalProblem<D> {
    let laws = vec![law; q.len()];
    LocalProblem::new(
        BlockMatrix::from_dense(w).expect("square"),
        q.to_vec(),
        laws,
    )
    .expect("valid problem")
}

/// All laws, of a friction and a limit.
fn laws(mu: f64, limit: f64) -> [Friction; 4] {
    [
        Coulomb::new(mu).expect("valid friction").into(),
        Tresca::new(limit).expect("valid limit").into(),
        LimitedCoulomb::new(mu, limit).expect("valid data").into(),
        AnisotropicCoulomb::new(mu + 0.01, 0.5 * mu + 0.01)
            .expect("valid friction")
            .into(),
    ]
}

fn solve<const D: usize>(
    method: &dyn LocalSolver<D>,
    problem: &LocalProblem<D>,
) -> Result<LocalSolution<D>, TestCaseError> {
    let solved = method.solve(problem, None);
    solved.map_err(|error| TestCaseError::fail(format!("{method:?}: {error}")))
}

/// W = A Aᵀ + 0.05 and q from random numbers.
fn random<const D: usize>(
    contacts: usize,
    entries: &[f64],
    q: &[f64],
) -> (DMatrix<f64>, Vec<Local<D>>) {
    let n = D * contacts;
    let a = DMatrix::from_fn(n, n, |i, j| entries[(i * n + j) % entries.len()]);
    let w = &a * a.transpose() + DMatrix::identity(n, n) * 0.05;
    let q = (0..contacts)
        .map(|i| Local::from_fn(|k, _| q[(D * i + k) % q.len()]))
        .collect();
    (w, q)
}

/// All methods against one another and against Newton's method on S = W⁻¹, which shares no code.
fn agree<const D: usize>(
    contacts: usize,
    entries: &[f64],
    q: &[f64],
    (mu, ties): (f64, bool),
) -> Result<(), TestCaseError> {
    let (w, q) = random::<D>(contacts, entries, q);
    let mut laws = vec![Friction::from(Coulomb::new(mu).expect("valid")); contacts];
    (laws.iter_mut().step_by(2).filter(|_| ties)).for_each(|law| *law = Tie.into());
    let condensed = CondensedProblem::from_delassus(w.clone(), &q, laws.clone()).expect("regular");
    let reference = ContactSolver::solve(&SemismoothNewton::default(), &condensed, None)
        .map_err(|error| TestCaseError::fail(error.to_string()))?;
    let problem = LocalProblem::new(BlockMatrix::from_dense(&w).expect("square"), q, laws)
        .expect("valid problem");
    let scale = (reference.force.iter().map(|t| t.norm())).fold(1.0, f64::max);
    for method in methods::<D>() {
        let solution = solve(&*method, &problem)?;
        for (a, b) in solution.force.iter().zip(&reference.force) {
            prop_assert!((a - b).norm() <= 1e-9 * scale, "{:?}: {} {}", method, a, b);
        }
        let certificate =
            Certificate::new(condensed.laws(), &solution.displacement, &solution.force);
        prop_assert!(certificate.bipotential_gap.abs() <= 1e-9 * scale);
    }
    for i in (0..contacts).step_by(2).filter(|_| ties) {
        prop_assert!(reference.displacement[i].amax() < 1e-9 * scale);
        prop_assert_eq!(reference.status[i], Status::Tied);
    }
    Ok(())
}

/// Fewer than usual, each with ten methods; the variable that asks for more is obeyed all the same.
fn cases() -> u32 {
    let asked = std::env::var("PROPTEST_CASES").ok();
    asked.and_then(|cases| cases.parse().ok()).unwrap_or(300)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    /// Friction below 0.35 keeps these random problems in the range of unique solutions.
    #[test]
    fn methods_agree_in_the_plane(
        contacts in 1usize..7,
        entries in prop::collection::vec(-1.0..1.0f64, 197),
        q in prop::collection::vec(-1.0..0.4f64, 14),
        mu in 0.0..0.35f64,
        ties in any::<bool>(),
    ) {
        agree::<2>(contacts, &entries, &q, (mu, ties))?;
    }

    #[test]
    fn methods_agree_in_space(
        contacts in 1usize..5,
        entries in prop::collection::vec(-1.0..1.0f64, 229),
        q in prop::collection::vec(-1.0..0.4f64, 17),
        mu in 0.0..0.35f64,
        ties in any::<bool>(),
    ) {
        agree::<3>(contacts, &entries, &q, (mu, ties))?;
    }

    /// Where solutions need not be unique the default ends at one all the same.
    #[test]
    fn auto_solves_at_large_friction(
        contacts in 1usize..6,
        entries in prop::collection::vec(-1.0..1.0f64, 229),
        q in prop::collection::vec(-1.0..0.4f64, 17),
        mu in 0.35..3.0f64,
        limit in 0.0..1.0f64,
    ) {
        let (w, q) = random::<3>(contacts, &entries, &q);
        for law in laws(mu, limit) {
            solve(&Auto::default(), &under(&w, &q, law))?;
        }
    }

    /// More contacts than the bodies have freedoms: W is rank deficient, and a solution exists because
    /// the contacts do not move by themselves (w = 0).
    #[test]
    fn auto_solves_rank_deficient_problems(
        unknowns in 3usize..9,
        entries in prop::collection::vec(-1.0..1.0f64, 229),
        load in prop::collection::vec(-1.0..1.0f64, 9),
        mu in 0.0..0.9f64,
        limit in 0.01..1.0f64,
    ) {
        let contacts = 5;
        let stiffness: Vec<_> = (0..unknowns).map(|i| (i, i, 1.0 + i as f64)).collect();
        let entry = |k: usize| (k % unknowns, k / unknowns, entries[(7 * k) % entries.len()]);
        let directions: Vec<_> = (0..3 * contacts * unknowns).map(entry).collect();
        for law in laws(mu, limit) {
            let mut global = GlobalProblem::<3>::new(
                stiffness.clone(), directions.clone(), load[..unknowns].to_vec(),
                vec![Local::zeros(); contacts], vec![law; contacts],
            ).expect("valid");
            prop_assert!(global.local().rank() <= unknowns);
            let solution = global
                .solve(&Auto::default())
                .map_err(|error| TestCaseError::fail(format!("{law:?}: {error}")))?;
            prop_assert!(solution.balance < 1e-12);
            prop_assert!(
                solution.residual.scaled < 1e-6
                    || solution.local.force.iter().all(|r| r.norm() < 1e-8)
            );
        }
    }
}

/// Klarbring's two degrees of freedom: below the critical friction one solution, above it up to three,
/// of which one is found and the possibility of others reported.
#[test]
fn klarbring_below_and_above_the_critical_friction() {
    // K = [[1, −1/2], [−1/2, 1]] in (n, t); W = K⁻¹, q = W f.
    let w = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 4.0]) / 3.0;
    let q = |f_n: f64, f_t: f64| {
        vec![Local::<2>::new(
            (4.0 * f_n + 2.0 * f_t) / 3.0,
            (2.0 * f_n + 4.0 * f_t) / 3.0,
        )]
    };
    // (f_t, f_n), then all solutions (u_t, u_n; r_t, r_n).
    type Case = (f64, (f64, f64), Vec<[f64; 4]>);
    let cases: [Case; 6] = [
        (1.0, (1.9, -1.0), vec![[1.8, 0.0, -0.1, 0.1]]),
        (1.0, (2.9, -1.0), vec![[3.2, 0.6, 0.0, 0.0]]),
        (
            1.0,
            (-3.5, -1.0),
            vec![[-5.0 / 3.0, 0.0, 11.0 / 6.0, 11.0 / 6.0]],
        ),
        (
            3.0,
            (2.9, -1.0),
            vec![
                [0.0, 0.0, -2.9, 1.0],
                [0.2, 0.0, -2.7, 0.9],
                [3.2, 0.6, 0.0, 0.0],
            ],
        ),
        (
            3.0,
            (2.0, -1.0),
            vec![[0.0, 0.0, -2.0, 1.0], [2.0, 0.0, 0.0, 0.0]],
        ),
        (3.0, (-3.5, -1.0), vec![[-0.2, 0.0, 3.3, 1.1]]),
    ];
    for (mu, (f_t, f_n), answers) in cases {
        let problem = problem(&w, &q(f_n, f_t), mu);
        let (contact, ratio) = problem.criticality().expect("a contact");
        assert_eq!(contact, 0);
        assert!((ratio - mu / 2.0).abs() < 1e-12, "μ_c = 2");
        for method in methods::<2>() {
            // At large friction fixed points need not arrive; where they do, it is at a solution.
            let solution = match method.solve(&problem, None) {
                Ok(solution) => solution,
                Err(failure) if mu > 2.0 && failure.best.solver != "proximal Newton" => continue,
                Err(failure) => panic!("{method:?}: {failure}"),
            };
            let (u, r) = (solution.displacement[0], solution.force[0]);
            let distance = |a: &[f64; 4]| {
                let b = [u[1], u[0], r[1], r[0]];
                a.iter()
                    .zip(&b)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max)
            };
            assert!(
                answers.iter().any(|answer| distance(answer) < 1e-6),
                "{method:?} at μ = {mu}, f = ({f_t}, {f_n}): u = {u} r = {r}"
            );
        }
    }
}

/// A problem with open, sticking and slipping contacts, in units of force a and of length b.
fn scaled(a: f64, b: f64) -> LocalProblem<3> {
    let entries: Vec<f64> = (0..229).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
    let loads: Vec<f64> = (0..17).map(|k| -0.4 + (k as f64 * 1.7).sin()).collect();
    let (w, q) = random::<3>(6, &entries, &loads);
    let q: Vec<_> = q.iter().map(|q| q * b).collect();
    problem(&(w * (b / a)), &q, 0.3)
}

/// The same problem in other units is solved in as many iterations, with the same answer.
#[test]
fn no_method_depends_on_units() {
    let reference = scaled(1.0, 1.0);
    let statuses: Vec<_> = methods::<3>()
        .iter()
        .map(|method| method.solve(&reference, None).expect("solvable"))
        .collect();
    let all = reference.statuses(&statuses[0].force, &statuses[0].displacement);
    for status in [Status::Open, Status::Stick, Status::Slip] {
        assert!(
            all.contains(&status),
            "the problem lacks {status:?}: {all:?}"
        );
    }
    // Newtons and metres for millimetres, pounds and inches, and powers of two, which round nothing.
    for (a, b) in [
        (1.0, 1e-3),
        (1.0 / 4.448, 1.0 / 25.4),
        (2f64.powi(40), 2f64.powi(-30)),
    ] {
        let problem = scaled(a, b);
        for (method, reference) in methods::<3>().iter().zip(&statuses) {
            let solution = method.solve(&problem, None).expect("solvable");
            let (there, here) = (solution.iterations, reference.iterations);
            assert!(
                there.abs_diff(here) * 50 <= here,
                "{method:?}: {there} iterations, not {here}"
            );
            for (r, t) in solution.force.iter().zip(&reference.force) {
                assert!((r / a - t).norm() < 1e-10, "{method:?}: {r} {t}");
            }
            if a > 1e9 {
                assert_eq!(solution.iterations, reference.iterations);
                assert_eq!(solution.residual.scaled, reference.residual.scaled);
            }
        }
    }
}

/// Two contacts of large friction between which the sweeps of Gauss–Seidel alternate for ever.
#[test]
fn a_cycle_is_found_and_left() {
    let a = [
        0.7, -0.8, 0.4, -0.5, 0.2, 0.7, -0.5, -0.9, -0.2, -0.6, -0.9, 0.7, -0.3, -0.5, 0.0, 0.6,
    ];
    let a = DMatrix::from_column_slice(4, 4, &a);
    let w = &a * a.transpose() + DMatrix::identity(4, 4) * 0.05;
    let q = [Local::<2>::new(-0.9, -0.1), Local::<2>::new(-0.5, -0.1)];
    let problem = problem(&w, &q, 2.0);
    let failure = LocalSolver::solve(&GaussSeidel::default(), &problem, None).expect_err("cycles");
    assert_eq!(failure.reason, Reason::Cycling { period: 2 });
    assert!(failure.to_string().contains("cycling with period 2"));
    let solution = LocalSolver::solve(&Auto::default(), &problem, None).expect("solvable");
    assert!(solution.residual.scaled < 1e-9);
}

/// Two contacts that can only push each other, both penetrating: there is no solution, and the failure
/// says what was tried.
#[test]
fn an_impossible_problem_ends_with_the_evidence() {
    let w = DMatrix::from_row_slice(
        4,
        4,
        &[
            1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0,
        ],
    );
    let problem = problem(
        &w,
        &[Local::<2>::new(-1.0, 0.0), Local::<2>::new(-1.0, 0.0)],
        0.3,
    );
    assert_eq!(problem.rank(), 2);
    let failure = LocalSolver::solve(&Auto::default(), &problem, None).expect_err("impossible");
    assert!(
        failure.best.residual.of_load > 0.5,
        "nothing pushes the contacts apart"
    );
    let Reason::All(attempts) = &failure.reason else {
        panic!("{failure}");
    };
    assert!(attempts.len() >= 5, "{failure}");
}

/// Bodies of several unknowns, some of which share contacts: W and the balance against dense algebra.
#[test]
fn the_reduction_of_the_global_form_is_that_of_dense_algebra() {
    let n = 7;
    // Unknowns 0–2 and 4–5 are coupled; the others are bodies of their own.
    let mut m = DMatrix::<f64>::identity(n, n) * 3.0;
    for (i, j) in [(0, 1), (1, 2), (4, 5)] {
        m[(i, j)] = -1.0;
        m[(j, i)] = -0.9;
    }
    let h = DMatrix::from_fn(n, 4, |i, j| {
        if i == 3 && j < 2 {
            0.0
        } else {
            ((3 * i + 5 * j) as f64).sin()
        }
    });
    let entries = |a: &DMatrix<f64>| -> Vec<(usize, usize, f64)> {
        let rows = a.nrows();
        (0..a.len())
            .map(|k| (k % rows, k / rows, a[(k % rows, k / rows)]))
            .collect()
    };
    let load: Vec<f64> = (0..n).map(|i| -1.0 + 0.1 * i as f64).collect();
    let free = vec![Local::<2>::new(-0.5, 0.1), Local::<2>::new(-0.2, -0.3)];
    let laws = vec![Coulomb::new(0.4).expect("valid"); 2];
    let mut global = GlobalProblem::new(entries(&m), entries(&h), load.clone(), free.clone(), laws)
        .expect("valid");
    let inverse = m.clone().try_inverse().expect("regular");
    let w = h.transpose() * &inverse * &h;
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let block = global
            .local()
            .operator()
            .row(i / 2)
            .find(|(k, _)| *k == j / 2);
        let stored = block.map_or(0.0, |(_, block)| block[(i % 2, j % 2)]);
        assert!((stored - w[(i, j)]).abs() < 1e-13);
    }
    let solution = global.solve(&Auto::default()).expect("solvable");
    assert!(solution.balance < 1e-14);
    let r = stack(&solution.local.force);
    let v = &inverse * (&h * r + DVector::from_vec(load));
    for (a, b) in v.iter().zip(&solution.bodies) {
        assert!((a - b).abs() < 1e-12);
    }
    let u = h.transpose() * v + stack(&free);
    for (a, b) in u.iter().zip(solution.local.displacement.iter().flatten()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn bad_data_is_refused() {
    let one = || vec![Coulomb::new(0.3).expect("valid")];
    let q = |n| vec![Local::<2>::zeros(); n];
    let identity = || BlockMatrix::<2>::from_dense(&DMatrix::identity(2, 2)).expect("square");
    assert!(matches!(
        LocalProblem::new(identity(), q(2), one()),
        Err(ContactError::Dimension {
            found: 2,
            expected: 1,
            ..
        })
    ));
    let nan = vec![Local::<2>::new(f64::NAN, 0.0)];
    assert!(matches!(
        LocalProblem::new(identity(), nan, one()),
        Err(ContactError::NotFinite { .. })
    ));
    let rigid = BlockMatrix::<2>::from_entries(1, [(1, 1, 1.0)]);
    assert!(matches!(
        LocalProblem::new(rigid, q(1), one()),
        Err(ContactError::Rigid { contact: 0, .. })
    ));
    assert!(matches!(
        GlobalProblem::new(vec![(0, 3, 1.0)], vec![], vec![0.0], q(1), one()),
        Err(ContactError::Dimension {
            found: 4,
            expected: 1,
            ..
        })
    ));
    assert!(matches!(
        GlobalProblem::new(vec![(0, 0, 0.0)], vec![], vec![0.0], q(1), one()),
        Err(ContactError::Indefinite { .. })
    ));
}

/// Contacts on bodies so stiff that a millionth and less of W tells them apart: where forces have far to
/// go, the centre of the proximal point runs ahead of them.
#[test]
fn forces_that_the_bodies_hardly_tell_apart_are_soon_found() {
    for (apart, contacts) in [(1e-6, 4), (1e-8, 2), (1e-8, 4), (1e-9, 4)] {
        let n = 2 * contacts;
        let w = DMatrix::from_fn(n, n, |i, j| {
            let same = f64::from(u8::from(i == j));
            match i % 2 == 0 && j % 2 == 0 {
                true => 1.0 + apart * same,
                false => same,
            }
        });
        let q = |i: usize| Local::<2>::new(-1.0 - 0.2 * apart * i as f64, 0.1);
        let problem = problem(&w, &(0..contacts).map(q).collect::<Vec<_>>(), 0.2);
        let solution = ProximalNewton::default()
            .solve(&problem, None)
            .expect("solvable");
        let whole: f64 = solution.force.iter().map(|r| r[0]).sum();
        assert!((whole - 1.0).abs() < 1e-5, "{whole}");
        let iterations = solution.iterations;
        assert!(
            iterations <= 40,
            "{apart:e}, {contacts} contacts: {iterations} iterations"
        );
    }
}

/// Every method, of both forms, on a condensed problem.
fn all_methods() -> Vec<Box<dyn ContactSolver<2>>> {
    vec![
        Box::new(SemismoothNewton::default()),
        Box::new(Penalty::new(1e3, 1e3).expect("valid")),
        Box::new(Uzawa::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Dual(Auto::default())),
    ]
}

/// One contact pressed and dragged.
fn pressed(stiffness: f64, load: f64) -> CondensedProblem<2> {
    let s = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]) * stiffness;
    let f = DVector::from_vec(vec![-load, load]);
    let law = vec![Coulomb::new(0.3).expect("valid")];
    let zero = vec![Local::zeros()];
    CondensedProblem::new(s, f, vec![Local::<2>::new(10.0, 10.0)], law, zero).expect("valid")
}

#[test]
fn a_guess_that_is_none_is_refused() {
    let problem = pressed(1.0, 12.0);
    for solver in all_methods() {
        let found = solver.solve(&problem, None).expect("solvable");
        for k in 0..2 {
            let mut guess = found.clone();
            guess.displacement[0][k] = f64::NAN;
            guess.force[0][k] = f64::NAN;
            let solution = solver.solve(&problem, Some(&guess));
            let refused = matches!(solution, Err(ContactError::NotFinite { what: "guess" }));
            assert!(refused, "{solver:?}: {solution:?}");
        }
        let mut guess = found.clone();
        guess.force.push(Local::zeros());
        let solution = solver.solve(&problem, Some(&guess));
        assert!(
            matches!(
                solution,
                Err(ContactError::Dimension {
                    found: 2,
                    expected: 1,
                    ..
                })
            ),
            "{solver:?}: {solution:?}"
        );
    }
}

/// Data that overflow, and a proximal term that is no number.
#[test]
fn a_residual_that_is_not_finite_is_never_accepted() {
    let mut held = pressed(1.0, 12.0);
    held.hold(f64::NAN);
    for solver in all_methods() {
        assert!(solver.solve(&held, None).is_err(), "{solver:?}");
        for size in [1e160, 1e308] {
            let solution = solver.solve(&pressed(size, 1.2 * size), None);
            let is_refused = matches!(solution, Err(ContactError::NotFinite { .. }));
            assert!(is_refused, "{solver:?}, {size:e}: {solution:?}");
        }
    }
}

/// A projection may pass over what is no number; the residual does not.
#[test]
fn the_residual_of_what_is_no_number_is_infinite() {
    let problem = pressed(1.0, 12.0);
    let zero = [Local::<2>::zeros()];
    for k in 0..2 {
        let mut nan = zero;
        nan[0][k] = f64::NAN;
        assert_eq!(problem.residual(&nan, &zero), f64::INFINITY);
        assert_eq!(problem.residual(&zero, &nan), f64::INFINITY);
    }
}

/// Where the structure has softened, solutions are judged by the stiffness that it had, and the methods go on until they
/// meet that.
#[test]
fn a_solution_is_as_exact_as_it_will_be_judged() {
    let n = 12;
    let a = DMatrix::from_fn(n, n, |i, j| ((7 * i * i + 3 * j * j + i * j) as f64).sin());
    let w = &a * a.transpose() + DMatrix::identity(n, n) * 0.05;
    let q = |i: usize| Local::<3>::new(-0.4 + (i as f64 * 1.7).sin(), 0.3, -0.2);
    let free: Vec<_> = (0..4).map(q).collect();
    let tolerance = Tolerance::new(1e-8, 20_000);
    let methods: [Box<dyn ContactSolver<3>>; 3] = [
        Box::new(Uzawa { tolerance }),
        Box::new(GaussSeidel { tolerance }),
        Box::new(Dual(GaussSeidel { tolerance })),
    ];
    for law in laws(0.3, 0.2) {
        for method in &methods {
            let problem = CondensedProblem::from_delassus(w.clone(), &free, vec![law; 4]);
            let mut problem = problem.expect("definite");
            let stiffness = 1e3 * (0..4).map(|i| problem.alpha(i)).fold(0.0, f64::max);
            problem.weigh(stiffness);
            let found = method.solve(&problem, None).expect("solvable");
            let (u, t) = (&found.displacement, &found.force);
            let map = |i: usize| law.natural_map(&u[i], &t[i], stiffness).norm();
            let left = (0..4).map(map).fold(0.0, f64::max);
            let asked = 1e-8 * problem.force_scale(t);
            assert!(left <= asked, "{law:?}, {method:?}: {left:.1e} {asked:.1e}");
        }
    }
}
