//! Every solver on problems with known answers, and all of them against each other.

use moreau_contact::{
    Admm, Auto, BlockMatrix, CondensedProblem, ContactError, ContactSolution, ContactSolver, Dual,
    GaussSeidel, LocalProblem, Newton, NewtonMap, Penalty, ProximalNewton, SemismoothNewton,
    TrescaFixedPoint, Uzawa, uzawa_steps,
};
use moreau_laws::textbook::RegularisedCoulomb;
use moreau_laws::{
    AnisotropicCoulomb, Coulomb, Friction, LimitedCoulomb, Local, ShearBound, Status, Tresca,
};
use nalgebra::{DMatrix, DVector, Matrix3};
use proptest::prelude::*;

fn exact<const D: usize>() -> Vec<Box<dyn ContactSolver<D>>> {
    vec![
        Box::new(SemismoothNewton::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
    ]
}

/// The methods for the local form, on the dual form of a condensed problem.
fn dual<const D: usize>() -> Vec<Box<dyn ContactSolver<D>>> {
    let newton = |map| {
        Dual(ProximalNewton {
            map,
            ..ProximalNewton::default()
        })
    };
    vec![
        Box::new(Dual(Auto::default())),
        Box::new(Dual(GaussSeidel::default())),
        Box::new(Dual(Uzawa::default())),
        Box::new(Dual(Admm::default())),
        Box::new(Dual(TrescaFixedPoint::default())),
        Box::new(newton(NewtonMap::AlartCurnier)),
        Box::new(newton(NewtonMap::JeanMoreau)),
        Box::new(newton(NewtonMap::Natural)),
    ]
}

fn problem<const D: usize>(w: DMatrix<f64>, q: &[Local<D>], mu: f64) -> CondensedProblem<D> {
    under(w, q, Coulomb::new(mu).expect("valid friction").into())
}

fn under<const D: usize>(w: DMatrix<f64>, q: &[Local<D>], law: Friction) -> CondensedProblem<D> {
    CondensedProblem::from_delassus(w, q, vec![law; q.len()]).expect("valid problem")
}

/// A law from outside: g = g₀ tanh(μ t_n/g₀).
#[derive(Debug)]
struct Saturating(f64, f64);

impl ShearBound for Saturating {
    fn bound(&self, t_n: f64) -> f64 {
        self.1 * (self.0 * t_n / self.1).tanh()
    }

    fn slope(&self, t_n: f64) -> f64 {
        self.0 / (self.0 * t_n / self.1).cosh().powi(2)
    }
}

/// The laws but Coulomb's, with friction and limit of the size of the problems' forces.
fn other_laws(mu: f64, limit: f64) -> [Friction; 4] {
    let saturating: &'static Saturating = Box::leak(Box::new(Saturating(mu, limit + 0.01)));
    [
        saturating.into(),
        Tresca::new(limit).expect("valid limit").into(),
        LimitedCoulomb::new(mu, limit).expect("valid data").into(),
        AnisotropicCoulomb::new(mu + 0.01, 0.5 * mu + 0.01)
            .expect("valid friction")
            .into(),
    ]
}

fn assert_solves<const D: usize>(problem: &CondensedProblem<D>, solution: &ContactSolution<D>) {
    let scale = problem.force_scale(&solution.force);
    let residual = problem.residual(&solution.displacement, &solution.force);
    assert!(
        residual <= 1e-9 * scale,
        "residual {residual} N at forces of {scale} N"
    );
    let asked = problem.force(&solution.displacement);
    for (t, asked) in solution.force.iter().zip(&asked) {
        assert!(
            (t - asked).norm() <= 1e-8 * scale,
            "force {t} against structure {asked}"
        );
    }
}

/// One contact in 3D with coupled W; answers to ten digits, cross-checked by the bipotential gap.
#[test]
fn one_coupled_contact_in_space() {
    let w = Matrix3::new(1.0, 0.2, -0.1, 0.2, 0.8, 0.05, -0.1, 0.05, 0.6);
    let w = DMatrix::from_iterator(3, 3, w.iter().copied());
    let v = Local::<3>::new;
    let cases = [
        (
            v(-1.0, 0.5, -0.3),
            0.3,
            v(1.0715348565, -0.2720533, 0.1712420),
            v(0.0, 0.5052264, -0.3180110),
        ),
        (
            v(-1.0, 0.05, -0.03),
            0.3,
            v(1.0711995704, -0.2653838, 0.1812280),
            v(0.0, 0.0609942, -0.0416524),
        ),
        (v(0.2, 0.5, -0.3), 0.3, v(0.0, 0.0, 0.0), v(0.2, 0.5, -0.3)),
        (
            v(-1.0, 2.0, 1.0),
            0.9,
            v(1.1518289669, -0.9576284, -0.3969671),
            v(0.0, 1.4444147, 0.5987554),
        ),
    ];
    for (q, mu, force, displacement) in cases {
        let problem = problem(w.clone(), &[q], mu);
        for solver in exact() {
            let s = solver.solve(&problem, None).expect("solvable");
            assert!(
                (s.force[0] - force).norm() < 1e-7,
                "{solver:?}: {}",
                s.force[0]
            );
            assert!((s.force[0][0] - force[0]).abs() < 1e-8);
            assert!((s.displacement[0] - displacement).norm() < 1e-7);
            assert!(s.certificate(&problem).bipotential_gap.abs() < 1e-9);
            let expected = if force.norm() == 0.0 {
                Status::Open
            } else {
                Status::Slip
            };
            assert_eq!(s.status[0], expected);
        }
    }
}

/// Klarbring's two degrees of freedom at μ below the critical value 2: the unique solutions.
#[test]
fn klarbring_below_the_critical_friction() {
    let k = DMatrix::from_row_slice(2, 2, &[1.0, -0.5, -0.5, 1.0]);
    let law = vec![Coulomb::new(1.0).expect("valid")];
    let zero = vec![Local::<2>::zeros()];
    // (f_t, f_n) → (u_t, u_n; r_t, r_n)
    let cases = [
        ((1.9, -1.0), (1.8, 0.0, -0.1, 0.1)),
        ((2.9, -1.0), (3.2, 0.6, 0.0, 0.0)),
        ((-3.5, -1.0), (-5.0 / 3.0, 0.0, 11.0 / 6.0, 11.0 / 6.0)),
    ];
    for ((f_t, f_n), (u_t, u_n, r_t, r_n)) in cases {
        let load = DVector::from_row_slice(&[f_n, f_t]);
        let problem =
            CondensedProblem::new(k.clone(), load, zero.clone(), law.clone(), zero.clone())
                .expect("valid");
        for solver in exact() {
            let s = solver.solve(&problem, None).expect("solvable");
            assert!(
                (s.displacement[0] - Local::<2>::new(u_n, u_t)).norm() < 1e-9,
                "{solver:?}"
            );
            assert!(
                (s.force[0] - Local::<2>::new(r_n, r_t)).norm() < 1e-9,
                "{solver:?}"
            );
            // Half of the critical coefficient, where it touches.
            let found = problem.criticality(&s.status);
            let expected = (r_n > 0.0).then_some((0, 0.5));
            assert_eq!(found, expected, "{solver:?}");
        }
    }
}

/// Four contacts at a friction far beyond the critical one, where there may be no solution: a method that finds none does
/// not go on until its iterations are used up.
#[test]
fn what_leads_nowhere_ends_early() {
    let mut failed = 0;
    for seed in 0..12 {
        let entry = |k: usize| (1.0 + 12.9898 * k as f64 + 78.233 * f64::from(seed)).sin();
        let entries: Vec<f64> = (0..64).map(entry).collect();
        let q = [0, 1, 2, 3].map(|i| Local::<2>::new(-1.0, 3.0 * entry(100 + i)));
        let problem = problem(definite(8, &entries), &q, 20.0);
        let (uzawa, seidel) = (Uzawa::default(), GaussSeidel::default());
        for (limit, outcome) in [
            (uzawa.tolerance.iterations, uzawa.solve(&problem, None)),
            (seidel.tolerance.iterations, seidel.solve(&problem, None)),
        ] {
            if let Err(ContactError::NotConverged { iterations, .. }) = outcome {
                failed += 1;
                assert!(4 * iterations < limit, "{iterations} of {limit}");
            }
        }
    }
    assert!(failed > 0);
}

/// From S as from W, in the plane and in space.
#[test]
fn the_critical_friction_of_a_contact_is_that_of_its_compliance() {
    fn check<const D: usize>(w: &[f64], mu: f64) {
        let w = DMatrix::from_row_slice(D, D, w);
        let (law, q) = (
            vec![Coulomb::new(mu).expect("valid")],
            [Local::<D>::zeros()],
        );
        let local = LocalProblem::new(
            BlockMatrix::from_dense(&w).expect("square"),
            q.to_vec(),
            law.clone(),
        );
        let (_, expected) = local.expect("valid").criticality().expect("a contact");
        let problem = CondensedProblem::from_delassus(w, &q, law).expect("definite");
        let (contact, found) = problem.criticality(&[Status::Stick]).expect("closed");
        assert_eq!(contact, 0);
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        assert_eq!(problem.criticality(&[Status::Open]), None);
    }
    // Of an anisotropic law between stretched vectors.
    let m = [1.0, 0.5, 1.0];
    let w = |k: usize, l: usize| [1.0, 0.2, -0.1, 0.2, 0.8, 0.05, -0.1, 0.05, 0.6][3 * k + l];
    let stretched = DMatrix::from_fn(3, 3, |k, l| m[k] * w(k, l) * m[l]);
    let q = [Local::<3>::zeros()];
    let law = AnisotropicCoulomb::new(0.3, 0.6).expect("valid").into();
    let anisotropic = under(DMatrix::from_fn(3, 3, w), &q, law).criticality(&[Status::Stick]);
    let (_, expected) =
        (problem(stretched, &q, 0.6).criticality(&[Status::Stick])).expect("closed");
    let (_, found) = anisotropic.expect("closed");
    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    check::<2>(&[4.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 4.0 / 3.0], 3.0);
    check::<3>(&[1.0, 0.2, -0.1, 0.2, 0.8, 0.05, -0.1, 0.05, 0.6], 0.9);
}

/// A random symmetric positive definite matrix with eigenvalues in [0.05, …].
fn definite(n: usize, entries: &[f64]) -> DMatrix<f64> {
    let a = DMatrix::from_fn(n, n, |i, j| entries[(i * n + j) % entries.len()]);
    &a * a.transpose() + DMatrix::identity(n, n) * 0.05
}

fn agree<const D: usize>(w: DMatrix<f64>, q: &[f64], law: Friction) -> Result<(), TestCaseError> {
    let contacts = w.nrows() / D;
    let free: Vec<_> = (0..contacts)
        .map(|i| Local::<D>::from_fn(|k, _| q[(D * i + k) % q.len()]))
        .collect();
    let problem = under(w, &free, law);
    let mut solutions = Vec::new();
    for solver in exact().into_iter().chain(dual()) {
        let solution = solver
            .solve(&problem, None)
            .map_err(|e| TestCaseError::fail(format!("{solver:?}, {law:?}: {e}")))?;
        assert_solves(&problem, &solution);
        let certificate = solution.certificate(&problem);
        prop_assert!(
            certificate.bipotential_gap.abs() < 1e-8 * (1.0 + problem.force_scale(&solution.force))
        );
        prop_assert!(certificate.penetration < 1e-8);
        solutions.push(solution);
    }
    let scale = problem.force_scale(&solutions[0].force);
    for s in &solutions[1..] {
        for (a, b) in solutions[0].force.iter().zip(&s.force) {
            prop_assert!((a - b).norm() <= 1e-8 * scale, "{} against {}", a, b);
        }
    }
    let stiff = Penalty::new(1e11, 1e11).expect("valid");
    let regularised = stiff
        .solve(&problem, None)
        .map_err(|e| TestCaseError::fail(format!("{law:?}: {e}")))?;
    for (a, b) in solutions[0].force.iter().zip(&regularised.force) {
        prop_assert!((a - b).norm() <= 1e-8 * scale, "{} against {}", a, b);
    }
    Ok(())
}

/// μ and g₀ of a plane law, infinite where there is none.
fn plane_bound(law: &Friction) -> (f64, f64) {
    match law {
        Friction::Coulomb(law) => (law.friction(), f64::INFINITY),
        Friction::Tresca(law) => (f64::INFINITY, law.limit()),
        Friction::Limited(law) => (law.friction(), law.limit()),
        Friction::Anisotropic(law) => (law.friction()[0], f64::INFINITY),
        Friction::Bounded(law) => panic!("{law:?} has no straight edges"),
        Friction::Tie(law) => panic!("{law:?} has no edges"),
    }
}

/// All solutions of a plane problem: with every contact open or closed, and stuck or on one of the edges of
/// the friction, its equations are linear; kept is what meets all inequalities.
fn enumerate(w: &DMatrix<f64>, q: &[f64], law: &Friction) -> Vec<DVector<f64>> {
    let (n, (mu, limit)) = (w.nrows(), plane_bound(law));
    let q = DVector::from_fn(n, |i, _| q[i % q.len()]);
    // Stuck, or t_t = a t_n + b.
    let mut shears = vec![None];
    for side in [-1.0, 1.0] {
        shears.extend(mu.is_finite().then_some(Some((side * mu, 0.0))));
        shears.extend(limit.is_finite().then_some(Some((0.0, side * limit))));
    }
    let ways = 2 * shears.len();
    let mut found = Vec::new();
    for code in 0..ways.pow(n as u32 / 2) {
        let way = |i: usize| code / ways.pow(i as u32) % ways;
        let mut rows = w.clone();
        let mut rhs = -&q;
        for i in 0..n / 2 {
            // Open at the odd ones.
            if way(i) % 2 == 1 {
                rows.row_mut(2 * i).fill(0.0);
                (rows[(2 * i, 2 * i)], rhs[2 * i]) = (1.0, 0.0);
            }
            if let Some((a, b)) = shears[way(i) / 2] {
                let k = 2 * i + 1;
                rows.row_mut(k).fill(0.0);
                (rows[(k, k)], rows[(k, k - 1)], rhs[k]) = (1.0, -a, b);
            }
        }
        let Some(t) = rows.lu().solve(&rhs) else {
            continue;
        };
        let u = w * &t + &q;
        let obeys = |i: usize| {
            let (t_n, t_t, u_n, u_t) = (t[2 * i], t[2 * i + 1], u[2 * i], u[2 * i + 1]);
            let bound = if mu.is_finite() {
                (mu * t_n).min(limit)
            } else {
                limit
            };
            let opposed = u_t.abs() < 1e-12 || (t_t + bound * u_t.signum()).abs() < 1e-12;
            t_n > -1e-12 && u_n > -1e-12 && t_t.abs() < bound + 1e-12 && opposed
        };
        if (0..n / 2).all(obeys) {
            found.push(t);
        }
    }
    found
}

/// Where a contact hardly presses, and slips, the rounding of the slip is more than the tolerance asks of the force: every
/// method ends there.
#[test]
fn a_contact_that_hardly_presses_is_solved_to_rounding() {
    let steep = definite(
        4,
        &[
            0.828_034_956,
            0.815_505_184,
            0.975_306_820,
            -0.964_406_679,
            0.0,
        ],
    );
    let entries = [0.393_281_698_262_629_26, -0.079_870_710_859_483_73];
    let mut soft = DMatrix::from_row_slice(2, 2, &[entries[0], entries[1], 0.0, 0.0]);
    soft = &soft * soft.transpose() + DMatrix::identity(2, 2) * 0.05;
    let cases = [
        (
            steep,
            vec![
                Local::<2>::new(-8.776_527_8e-6, -0.654_621_457),
                Local::zeros(),
            ],
            0.01,
        ),
        (
            soft,
            vec![Local::<2>::new(0.0, -0.398_416_309_204_069)],
            0.026_403_225_966_080_548,
        ),
    ];
    for (w, free, mu) in cases {
        let along = AnisotropicCoulomb::new(mu + 0.01, mu).expect("valid");
        for law in [along.into(), Coulomb::new(mu).expect("valid").into()] {
            let problem = under(w.clone(), &free, law);
            for solver in exact().into_iter().chain(dual()) {
                let found = solver.solve(&problem, None);
                let found = found.unwrap_or_else(|e| panic!("{solver:?}, {law:?}: {e}"));
                assert!(found.residual < 1e-13, "{solver:?}, {law:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Against the answer that comes from trying all statuses, of which there is one.
    #[test]
    fn the_answer_is_that_of_all_statuses_tried(
        contacts in 1usize..4,
        entries in prop::collection::vec(-1.0..1.0f64, 197),
        q in prop::collection::vec(-1.0..0.4f64, 14),
        mu in 0.0..0.35f64,
        limit in 0.01..0.3f64,
    ) {
        let w = definite(2 * contacts, &entries);
        let coulomb = Coulomb::new(mu).expect("valid").into();
        let straight = |law: &Friction| !matches!(law, Friction::Bounded(_));
        let others = other_laws(mu, limit).into_iter().filter(straight);
        for law in others.chain([coulomb]) {
            let answers = enumerate(&w, &q, &law);
            prop_assert!(!answers.is_empty());
            let free: Vec<_> =
                (0..contacts).map(|i| Local::<2>::new(q[2 * i], q[2 * i + 1])).collect();
            let problem = under(w.clone(), &free, law);
            for solver in exact().into_iter().chain(dual()) {
                let s = solver
                    .solve(&problem, None)
                    .map_err(|e| TestCaseError::fail(format!("{solver:?}, {law:?}: {e}")))?;
                let scale = problem.force_scale(&s.force);
                let off = |answer: &DVector<f64>| {
                    let pairs = answer.iter().zip(s.force.iter().flatten());
                    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                };
                let nearest = answers.iter().map(off).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= 1e-8 * scale, "{solver:?}, {law:?}: {nearest}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Friction below 0.35 keeps these random problems in the range of unique solutions.
    #[test]
    fn exact_solvers_agree_in_the_plane(
        contacts in 1usize..7,
        entries in prop::collection::vec(-1.0..1.0f64, 197),
        q in prop::collection::vec(-1.0..0.4f64, 14),
        mu in 0.0..0.35f64,
    ) {
        agree::<2>(definite(2 * contacts, &entries), &q, Coulomb::new(mu).expect("valid").into())?;
    }

    #[test]
    fn exact_solvers_agree_in_space(
        contacts in 1usize..5,
        entries in prop::collection::vec(-1.0..1.0f64, 229),
        q in prop::collection::vec(-1.0..0.4f64, 17),
        mu in 0.0..0.35f64,
    ) {
        agree::<3>(definite(3 * contacts, &entries), &q, Coulomb::new(mu).expect("valid").into())?;
    }

    /// The same under the other laws.
    #[test]
    fn exact_solvers_agree_under_every_law(
        contacts in 1usize..5,
        entries in prop::collection::vec(-1.0..1.0f64, 229),
        q in prop::collection::vec(-1.0..0.4f64, 17),
        mu in 0.0..0.35f64,
        limit in 0.0..0.3f64,
    ) {
        for law in other_laws(mu, limit) {
            agree::<2>(definite(2 * contacts, &entries), &q, law)?;
            agree::<3>(definite(3 * contacts, &entries), &q, law)?;
        }
    }

    /// At any friction the Newton method ends at a solution.
    #[test]
    fn newton_solves_at_large_friction(
        contacts in 1usize..6,
        entries in prop::collection::vec(-1.0..1.0f64, 197),
        q in prop::collection::vec(-1.0..0.4f64, 14),
        mu in 0.35..1.2f64,
    ) {
        let free: Vec<_> =
            (0..contacts).map(|i| Local::<2>::new(q[2 * i], q[2 * i + 1])).collect();
        let problem = problem(definite(2 * contacts, &entries), &free, mu);
        let solution = SemismoothNewton::default()
            .solve(&problem, None)
            .map_err(|e| TestCaseError::fail(e.to_string()))?;
        assert_solves(&problem, &solution);
    }

    /// The penalty method is the return mapping of the regularised law, for any k.
    #[test]
    fn penalty_obeys_the_regularised_law(
        contacts in 1usize..6,
        entries in prop::collection::vec(-1.0..1.0f64, 197),
        q in prop::collection::vec(-1.0..0.4f64, 14),
        mu in 0.0..0.35f64,
        exponent in -1.0..5.0f64,
    ) {
        let k = 10f64.powf(exponent);
        let free: Vec<_> =
            (0..contacts).map(|i| Local::<2>::new(q[2 * i], q[2 * i + 1])).collect();
        let problem = problem(definite(2 * contacts, &entries), &free, mu);
        let s = Penalty::new(k, k)
            .expect("valid")
            .solve(&problem, None)
            .map_err(|e| TestCaseError::fail(e.to_string()))?;
        let law = RegularisedCoulomb::new(mu, k, k).expect("valid");
        let scale = problem.force_scale(&s.force);
        for i in 0..contacts {
            let response = law.respond(&problem.previous()[i], &s.displacement[i]);
            // The return mapping multiplies the rounding of u by k.
            let rounding = k * 1e-13 * (1.0 + s.displacement[i].norm());
            prop_assert!((response.force - s.force[i]).norm() <= 1e-9 * scale + rounding);
        }
    }
}

/// A fixed problem with open, sticking and slipping contacts.
fn mixed() -> CondensedProblem<2> {
    let n = 12;
    let w = DMatrix::from_fn(n, n, |i, j| {
        let decay = (-((i / 2) as f64 - (j / 2) as f64).abs()).exp();
        if i == j {
            1.2
        } else if (i + j) % 2 == 0 {
            0.4 * decay
        } else {
            0.05 * decay
        }
    });
    let q: Vec<_> = [
        (-1.0, 0.02),
        (-0.8, 0.5),
        (0.6, 0.3),
        (-0.7, -0.4),
        (0.9, 0.0),
        (-0.5, 0.01),
    ]
    .iter()
    .map(|&(n, t)| Local::<2>::new(n, t))
    .collect();
    problem(w, &q, 0.3)
}

#[test]
fn penalty_error_falls_as_one_over_k() {
    let problem = mixed();
    let exact = SemismoothNewton::default()
        .solve(&problem, None)
        .expect("solvable");
    for status in [Status::Open, Status::Stick, Status::Slip] {
        assert!(
            exact.status.contains(&status),
            "the problem lacks {status:?}"
        );
    }
    let error = |k: f64| {
        let s = Penalty::new(k, k)
            .expect("valid")
            .solve(&problem, None)
            .expect("every k");
        let difference = |(a, b): (&Local<2>, &Local<2>)| (a - b).norm();
        s.force
            .iter()
            .zip(&exact.force)
            .map(difference)
            .fold(0.0, f64::max)
    };
    for exponent in 2..9 {
        let ratio = error(10f64.powi(exponent)) / error(10f64.powi(exponent + 1));
        assert!(
            (ratio - 10.0).abs() < 0.5,
            "1e{exponent}: the error fell {ratio} times"
        );
    }
    for exponent in [-2, 0, 12, 16] {
        assert!(error(10f64.powi(exponent)).is_finite());
    }
    assert!(error(1e16) < 1e-10);
}

#[test]
fn lost_energy_of_the_penalty_halves_when_k_doubles() {
    let problem = mixed();
    let lost = |k: f64| {
        let s = Penalty::new(k, k)
            .expect("valid")
            .solve(&problem, None)
            .expect("every k");
        assert!(s.certificate(&problem).bipotential_gap.abs() < 1e-12);
        let energy = |(i, t): (usize, &Local<2>)| t.dot(&(s.irreversible[i] - s.displacement[i]));
        s.force.iter().enumerate().map(energy).sum::<f64>()
    };
    assert!((lost(1e4) / lost(2e4) - 2.0).abs() < 1e-3);
}

#[test]
fn the_answer_does_not_depend_on_the_guess() {
    let problem = mixed();
    let newton = SemismoothNewton::default();
    let reference = newton.solve(&problem, None).expect("solvable");
    let again = newton.solve(&problem, Some(&reference)).expect("solvable");
    assert_eq!(again.iterations, 0, "a solution is recognised");
    let mut far = reference.clone();
    for u in &mut far.displacement {
        *u = Local::<2>::new(5.0, -7.0);
    }
    let from_far = newton.solve(&problem, Some(&far)).expect("solvable");
    assert_eq!(from_far.status, reference.status);
    for (a, b) in from_far.force.iter().zip(&reference.force) {
        assert!((a - b).norm() < 1e-11);
    }
}

/// A rigid block on two contacts: only contact holds it. Its weight is shared, and friction stops
/// it from sliding.
#[test]
fn newton_treats_a_body_that_only_contact_holds() {
    let spring = 100.0;
    // Two contact nodes tied by a bar along the tangent; free to move and to turn as a whole.
    let mut s = DMatrix::zeros(4, 4);
    for (i, j, v) in [
        (1, 1, spring),
        (3, 3, spring),
        (1, 3, -spring),
        (3, 1, -spring),
    ] {
        s[(i, j)] = v;
    }
    let load = DVector::from_row_slice(&[-10.0, 1.0, -10.0, 1.0]);
    let zero = vec![Local::<2>::zeros(); 2];
    let law = vec![Coulomb::new(0.3).expect("valid"); 2];
    let problem = CondensedProblem::new(s, load, zero.clone(), law, zero.clone()).expect("valid");
    let touching = ContactSolution {
        displacement: zero.clone(),
        motion: zero.clone(),
        irreversible: zero,
        force: vec![Local::<2>::new(10.0, 0.0); 2],
        status: vec![Status::Stick; 2],
        iterations: 0,
        residual: 0.0,
        exact: true,
    };
    let solution = SemismoothNewton::default()
        .solve(&problem, Some(&touching))
        .expect("solvable");
    for t in &solution.force {
        assert!((t - Local::<2>::new(10.0, -1.0)).norm() < 1e-10);
    }
    // From above the ground, where nothing holds it, it is started again with all contacts closed.
    let above = vec![Local::<2>::new(0.01, 0.0); 2];
    let (s, load) = (
        problem.stiffness().clone(),
        DVector::from_row_slice(&[-10.0, 1.0, -10.0, 1.0]),
    );
    let law = vec![Coulomb::new(0.3).expect("valid"); 2];
    let falling =
        CondensedProblem::new(s, load, above, law, vec![Local::zeros(); 2]).expect("valid");
    let landed = SemismoothNewton::default()
        .solve(&falling, None)
        .expect("solvable");
    for (u, t) in landed.displacement.iter().zip(&landed.force) {
        assert!(u[0].abs() < 1e-14 && (t - Local::<2>::new(10.0, -1.0)).norm() < 1e-10);
    }
    let refused = Uzawa::default().solve(&problem, None);
    assert!(matches!(refused, Err(ContactError::Floating { .. })));
}

/// Stopped early, a solution is a prefix of the exact one: as good as was asked, with forces the law
/// admits, and it says that it is not exact.
#[test]
fn a_solution_is_as_good_as_was_asked() {
    let problem = mixed();
    for (k, solver) in exact().iter().enumerate() {
        let whole = solver.solve(&problem, None).expect("solvable");
        assert!(whole.exact);
        assert_eq!(solver.approach(&problem, None, 0.0).as_ref(), Ok(&whole));
        let mut iterations = whole.iterations;
        for enough in [1e-6, 1e-3, 1e-1] {
            let part = solver.approach(&problem, None, enough).expect("solvable");
            assert!(part.residual <= enough, "{solver:?}: {}", part.residual);
            assert!(part.iterations <= iterations, "{solver:?}");
            iterations = part.iterations;
            assert!(part.certificate(&problem).excess_force < 1e-15);
            if part.exact {
                assert_eq!(part, whole, "{solver:?}");
            }
        }
        // In the plane the last step of Newton's method is the one that arrives.
        let saved = whole.iterations - iterations;
        assert!(
            k == 0 || 2 * saved > whole.iterations,
            "{solver:?}: {saved}"
        );
    }
}

/// Newton's method in space, where slip turns, has steps to save, and is as good in the common measure
/// whatever α it iterates with.
#[test]
fn newton_in_space_stops_where_it_is_enough() {
    let entries: Vec<f64> = (0..997).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
    let newton = SemismoothNewton::default();
    let (mut whole, mut part) = (0, 0);
    for case in 0..20 {
        let free = |i: usize| Local::<3>::new(-0.5, entries[case + i], entries[2 * case + 5 * i]);
        let q: Vec<_> = (0..4).map(free).collect();
        let problem = problem(definite(12, &entries[17 * case..]), &q, 0.3);
        whole += newton.solve(&problem, None).expect("solvable").iterations;
        for enough in [1e-2, 1e-1] {
            let early = newton.approach(&problem, None, enough).expect("solvable");
            assert!(early.residual <= enough, "{case}: {}", early.residual);
            part += early.iterations;
        }
    }
    assert!(4 * part < 7 * whole, "{part} of {whole}");
}

/// The same of the methods for the local form, which measure residuals otherwise: they are asked again
/// until the measure of condensed problems is met, and from a solution they need not move.
#[test]
fn a_dual_solution_is_as_good_as_was_asked() {
    let problem = mixed();
    for solver in dual() {
        let whole = solver.solve(&problem, None).expect("solvable");
        assert!(whole.exact, "{solver:?}");
        assert!(whole.residual <= 1e-10 * problem.force_scale(&whole.force));
        let mut iterations = whole.iterations;
        for enough in [1e-6, 1e-3, 1e-1] {
            let part = solver.approach(&problem, None, enough).expect("solvable");
            assert!(part.residual <= enough, "{solver:?}: {}", part.residual);
            assert!(part.iterations <= iterations, "{solver:?}");
            iterations = part.iterations;
        }
        assert!(iterations < whole.iterations, "{solver:?}: nothing saved");
        let again = solver.solve(&problem, Some(&whole)).expect("solved");
        assert!(again.iterations <= 1, "{solver:?}: {}", again.iterations);
    }
    let mut seidel = GaussSeidel::default();
    seidel.tolerance.iterations = 3;
    match Dual(seidel).solve(&problem, None) {
        Err(ContactError::NotConverged {
            solver: "Gauss-Seidel",
            iterations,
            residual,
            tolerance,
        }) => assert!(iterations <= 3 && residual > tolerance && residual.is_finite()),
        other => panic!("expected NotConverged, got {other:?}"),
    }
}

#[test]
fn a_tolerance_that_cannot_be_met_is_an_error_with_numbers() {
    let problem = mixed();
    let mut solver = Uzawa::default();
    solver.tolerance.iterations = 3;
    match solver.solve(&problem, None) {
        Err(ContactError::NotConverged {
            solver: "Uzawa",
            iterations: 3,
            residual,
            tolerance,
        }) => {
            assert!(residual > tolerance && residual.is_finite());
        }
        other => panic!("expected NotConverged, got {other:?}"),
    }
}

/// A chain of stiff springs on soft ones, far from where it was linearised: its nodes over tools at given
/// heights.
fn chain(tools: &[f64]) -> CondensedProblem<2> {
    let n = tools.len();
    let normal = |i: usize| 2 * i;
    let mut s = DMatrix::<f64>::identity(2 * n, 2 * n);
    for i in 0..n - 1 {
        let stiff = 1e10 * (1.0 + 0.3 * (i as f64).sin());
        for (a, b, k) in [
            (i, i, stiff),
            (i + 1, i + 1, stiff),
            (i, i + 1, -stiff),
            (i + 1, i, -stiff),
        ] {
            s[(normal(a), normal(b))] += k;
        }
    }
    let origin = tools.iter().map(|&g| Local::<2>::new(-g, 0.0)).collect();
    let law = vec![Coulomb::new(0.3).expect("valid"); n];
    let zero = vec![Local::zeros(); n];
    CondensedProblem::new(s, DVector::zeros(2 * n), origin, law, zero).expect("valid")
}

/// One end pressed, all else in the air: methods on W end at the rounding of 10¹⁰ N/mm on positions of
/// 10³ mm, which is far above their tolerance.
#[test]
fn methods_on_the_compliance_end_at_the_rounding_of_positions() {
    let methods: [Box<dyn ContactSolver<2>>; 3] = [
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
        Box::new(Dual(Auto::default())),
    ];
    for solver in methods {
        let mut rounded = 0;
        for height in (0..20).map(|k| 1000.1 + 0.377 * f64::from(k)) {
            let problem = chain(&[height, 999.0, 999.0, 999.0]);
            let solution = solver.solve(&problem, None).expect("solvable");
            let pressed = solution.force[0][0];
            assert!(
                (pressed / (4.0 * height) - 1.0).abs() < 1e-5,
                "{solver:?}: {pressed}"
            );
            rounded += usize::from(solution.residual > 1e-10 * pressed);
        }
        assert!(
            rounded > 0,
            "{solver:?}: the tolerance was met all the time"
        );
    }
}

/// All but the ends in the air: forces there are none only to the rounding of 10¹⁰ N/mm on positions of
/// 10³ mm, and not even that is to be had at all nodes at once.
#[test]
fn forces_far_from_the_origin_are_solved_for_to_their_rounding() {
    let n = 8;
    let normal = |i: usize| 2 * i;
    let tools: Vec<f64> = (0..n)
        .map(|i| match i {
            0 | 7 => 1000.1,
            _ => 999.0,
        })
        .collect();
    let problem = chain(&tools);
    let s = problem.stiffness();
    let solution = SemismoothNewton::default()
        .solve(&problem, None)
        .expect("solvable");
    assert!(solution.iterations < 10, "{}", solution.iterations);
    let inner = DMatrix::from_fn(n - 2, n - 2, |i, j| s[(normal(i + 1), normal(j + 1))]);
    let pull = DVector::from_fn(n - 2, |i, _| {
        let ends = [0, n - 1].map(|e| s[(normal(i + 1), normal(e))] * tools[e]);
        -(ends[0] + ends[1])
    });
    let lifted = inner.lu().solve(&pull).expect("regular");
    for i in 1..n - 1 {
        let (u, t) = (&solution.displacement[i], &solution.force[i]);
        let gap = lifted[i - 1] - tools[i];
        assert!((u[0] - gap).abs() < 1e-9, "{i}: {} {gap}", u[0]);
        assert_eq!(t[0], 0.0, "{i}");
    }
    // The soft springs carry the chain where its ends are pressed.
    let carried = lifted.sum() + tools[0] + tools[n - 1];
    let pressed = solution.force[0][0] + solution.force[n - 1][0];
    assert!(
        (pressed / carried - 1.0).abs() < 1e-6,
        "{pressed} {carried}"
    );
}

/// Soft springs take what they are pressed by, stiff ones tend to the law: the step predicts statuses at
/// the stiffness of the structure and the spring in series, and takes a handful of iterations for all.
#[test]
fn springs_of_any_stiffness_take_a_handful_of_iterations() {
    let entries: Vec<f64> = (0..229).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
    let n = 12;
    let a = DMatrix::from_fn(n, n, |i, j| entries[(i * n + j) % entries.len()]);
    let w = &a * a.transpose() + DMatrix::identity(n, n) * 0.05;
    let free = |k: usize| Local::<3>::new(-0.4 + (k as f64 * 1.7).sin(), 0.3, -0.2);
    let q: Vec<_> = (0..4).map(free).collect();
    let problem = problem(w, &q, 0.3);
    for k in [1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e6, 1e12] {
        let solution = Penalty::new(k, k).expect("valid").solve(&problem, None);
        let solution = solution.expect("converges");
        assert!(solution.iterations <= 5, "{k:e}: {}", solution.iterations);
        let pressed = |u: &Local<3>| k * (-u[0]).max(0.0);
        // Of stiff ones the penetration is rounding.
        let soft = solution.displacement.iter().zip(&solution.force);
        for (u, t) in soft.filter(|_| k <= 1.0) {
            assert!((t[0] - pressed(u)).abs() <= 1e-6 * k, "{k:e}: {u} {t}");
        }
        for (normal, tangent) in [(k, 1.0), (1.0, k), (k, 1e6), (1e6, k)] {
            let unlike = Penalty::new(normal, tangent).expect("valid");
            let iterations = unlike.solve(&problem, None).expect("converges").iterations;
            assert!(iterations <= 12, "{normal:e}, {tangent:e}: {iterations}");
        }
    }
}

/// Contacts in units of their own, powers of two, which round nothing: line searches on an energy weigh stiff
/// and soft contacts alike, so that Newton's methods take the same steps.
#[test]
fn contacts_of_unlike_stiffness_weigh_alike() {
    let entries: Vec<f64> = (0..997).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
    let n = 12;
    let (mut steps, mut off) = (0, [0; 2]);
    for case in 0..40 {
        let w = definite(n, &entries[13 * case..]);
        let unit = |i: usize| 2f64.powi([5, -4, 0, 3][i]);
        let scaled = DMatrix::from_fn(n, n, |k, l| w[(k, l)] * unit(k / 3) * unit(l / 3));
        let free = |i: usize| {
            let q = |k: usize| entries[500 + 3 * case + 7 * i + k];
            Local::<3>::new(q(0) - 0.4, q(1), q(2))
        };
        let q: Vec<_> = (0..4).map(free).collect();
        let own: Vec<_> = (0..4).map(|i| free(i) * unit(i)).collect();
        let (plain, scaled) = (problem(w, &q, 1.0), problem(scaled, &own, 1.0));
        for (solver, off) in newton_methods().iter().zip(&mut off) {
            let taken = |problem| solver.solve(problem, None).map(|s| s.iterations).ok();
            let (a, b) = (taken(&plain), taken(&scaled));
            steps += a.unwrap_or(0);
            *off += a.unwrap_or(50).abs_diff(b.unwrap_or(50));
        }
    }
    // Few differ, by what the last step leaves: 16 and 7 steps of 405. With squares of forces it is 95 and 139.
    assert!(steps > 300, "hardly anything was nonlinear: {steps}");
    assert!(off.iter().all(|off| *off <= 40), "{off:?} of {steps}");
}

fn newton_methods() -> [Box<dyn ContactSolver<3>>; 2] {
    [
        Box::new(SemismoothNewton::default()),
        Box::new(Dual(Newton::default())),
    ]
}

/// Uzawa's steps against the eigenvalues that they bound: α W contracts with every contact in its own scale.
#[test]
fn uzawa_steps_follow_the_largest_eigenvalue_and_the_slope() {
    let entries: Vec<f64> = (0..229).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
    for (n, mu) in [(3, 0.0), (3, 0.8), (12, 0.0), (12, 0.8)] {
        let unit = |k: usize| 10f64.powi((k / 3) as i32);
        let w = definite(n, &entries);
        let w = DMatrix::from_fn(n, n, |k, l| w[(k, l)] * unit(k) * unit(l));
        let q = vec![Local::<3>::zeros(); n / 3];
        let steps = uzawa_steps(&problem(w.clone(), &q, mu)).expect("definite");
        let root = |k: usize| steps[k / 3].sqrt();
        let scaled = DMatrix::from_fn(n, n, |k, l| root(k) * w[(k, l)] * root(l));
        let largest = scaled.symmetric_eigenvalues().max();
        let expected = 1.0 / (1.05 * 1f64.hypot(mu));
        assert!(
            (largest / expected - 1.0).abs() < 1e-2,
            "{largest} {expected}"
        );
        // The mean of the diagonal block is 1/α of a contact up to a factor that all share.
        let mean = |i: usize| (0..3).map(|k| w[(3 * i + k, 3 * i + k)]).sum::<f64>() * steps[i];
        for i in 0..n / 3 {
            assert!((mean(i) / mean(0) - 1.0).abs() < 1e-9);
        }
    }
}

/// Where sweeps lead nowhere either, the iteration ends: what it began with once more would end as it did.
#[test]
fn what_has_led_nowhere_is_not_tried_again() {
    // Contacts under a friction beyond that of any solids, on matrices that are nearly singular.
    let mut unsolved = 0;
    for seed in [614_u64, 1835, 3611, 6298, 9375] {
        let mut bits = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut random = || {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let n = 1 + (seed % 4) as usize;
        let a = DMatrix::from_fn(2 * n, 2 * n, |_, _| random());
        let held = 10_f64.powi(-1 - (seed / 4 % 7) as i32);
        let stiffness = &a * a.transpose() + DMatrix::identity(2 * n, 2 * n) * held;
        let law: Friction = Coulomb::new(10_f64.powf(random() + 0.5))
            .expect("valid")
            .into();
        let mut origin = || Local::<2>::new(random() - 0.3, 3.0 * random());
        let origin: Vec<_> = (0..n).map(|_| origin()).collect();
        let load = DVector::from_fn(2 * n, |_, _| random());
        let zero = vec![Local::zeros(); n];
        let problem = CondensedProblem::new(stiffness, load, origin, vec![law; n], zero);
        let solver = SemismoothNewton::default();
        match solver.solve(&problem.expect("valid"), None) {
            Err(ContactError::NotConverged { iterations, .. }) => {
                unsolved += 1;
                assert!(
                    iterations < solver.tolerance.iterations / 2,
                    "{seed}: {iterations}"
                );
            }
            other => assert!(other.is_ok(), "{seed}: {other:?}"),
        }
    }
    assert!(unsolved > 0, "solves what it is to end at");
}
