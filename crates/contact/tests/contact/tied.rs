//! A tied problem is solved as the condensed one is, whatever its ties.

use crate::stack;
use moreau_contact::{
    CondensedProblem, ContactError, ContactSolution, ContactSolver, Penalty, SemismoothNewton,
    Springs, Structure, TiedFactor, TiedProblem, Tolerance, solve_tied,
};
use moreau_laws::{
    AnisotropicCoulomb, Coulomb, Friction, LimitedCoulomb, Local, Status, Tie, Tresca,
};
use nalgebra::{DMatrix, DVector, SMatrix};
use proptest::prelude::*;

/// A structure of which all displacements are those of its contacts: B = 1.
struct Dense {
    stiffness: DMatrix<f64>,
    load: DVector<f64>,
    factor: Option<nalgebra::Cholesky<f64, nalgebra::Dyn>>,
    factorisations: usize,
    solves: usize,
    /// Solves that a factorisation takes as long as.
    worth: f64,
}

impl<const D: usize> Structure<D> for Dense {
    fn stiffness(&self, contact: usize) -> f64 {
        (0..D)
            .map(|k| self.stiffness[(D * contact + k, D * contact + k)])
            .fold(0.0, f64::max)
    }

    fn tie(&mut self, ties: &[SMatrix<f64, D, D>]) -> bool {
        let mut sum = self.stiffness.clone();
        for (i, tie) in ties.iter().enumerate() {
            let mut own = sum.fixed_view_mut::<D, D>(D * i, D * i);
            own += tie;
        }
        self.factorisations += 1;
        let size = sum.diagonal();
        self.factor = sum.cholesky().filter(|factor| {
            let pivots = factor.l_dirty().diagonal();
            // What rounding leaves of a pivot is none.
            pivots.iter().zip(&size).all(|(p, k)| p * p > 1e-13 * k)
        });
        self.factor.is_some()
    }

    fn displacement(&mut self, z: &DVector<f64>, loaded: bool) -> DVector<f64> {
        self.solves += 1;
        let load = if loaded { z + &self.load } else { z.clone() };
        let factor = self.factor.as_ref().expect("tied");
        factor.solve(&load)
    }

    fn worth(&self) -> f64 {
        self.worth
    }

    fn together(&self) -> f64 {
        0.2
    }
}

fn random(seed: &[f64], k: usize) -> f64 {
    seed[k % seed.len()]
}

/// A chain of contacts, each coupled to all, the nearer the more; `rigid` leaves it a translation.
fn sample<const D: usize>(
    contacts: usize,
    seed: &[f64],
    laws: &[Friction],
    rigid: bool,
) -> (Dense, CondensedProblem<D>) {
    let n = D * contacts;
    let b = DMatrix::from_fn(n, n, |i, j| {
        random(seed, 7 * i + 3 * j) / (1.0 + i.abs_diff(j) as f64)
    });
    let mut s = &b * b.transpose() + DMatrix::identity(n, n) * 0.5;
    if rigid {
        // Nothing resists the mean of the first component.
        let mode = DVector::from_fn(n, |i, _| f64::from(u8::from(i % D == 0)));
        let forces = &s * &mode;
        s.ger(-1.0 / forces.dot(&mode), &forces, &forces, 1.0);
    }
    // The last pushes the body onto its contacts.
    let load = DVector::from_fn(n, |i, _| {
        let own = random(seed, 5 * i + 1);
        if i % D == 0 { -0.6 - own.abs() } else { own }
    });
    let origin = (0..contacts)
        .map(|i| Local::<D>::from_fn(|k, _| if k == 0 { 0.3 * random(seed, i) } else { 0.0 }));
    let law = |i: usize| laws[i % laws.len()];
    let friction: Vec<Friction> = (0..contacts).map(law).collect();
    let problem = CondensedProblem::new(
        s.clone(),
        load.clone(),
        origin.collect(),
        friction,
        vec![Local::zeros(); contacts],
    );
    let dense = Dense {
        stiffness: s,
        load,
        factor: None,
        factorisations: 0,
        solves: 0,
        worth: 6.0,
    };
    (dense, problem.expect("valid"))
}

fn tied<const D: usize>(
    structure: &mut Dense,
    problem: &CondensedProblem<D>,
    guess: Option<&ContactSolution<D>>,
) -> Result<ContactSolution<D>, ContactError> {
    let contacts = problem.contacts();
    let load = structure.load.amax();
    let mut own = TiedProblem {
        structure,
        origin: problem.origin().to_vec(),
        friction: problem.laws().to_vec(),
        springs: vec![Springs::default(); contacts],
        load,
        rounding: 0.0,
        weight: 0.0,
        previous: problem.previous().to_vec(),
    };
    let asked = (SemismoothNewton::default().tolerance, 0.0);
    solve_tied(&mut own, guess, asked, &mut TiedFactor::default()).map(|(solution, _)| solution)
}

/// The law holds, and the structure is in balance.
fn assert_solves<const D: usize>(
    structure: &Dense,
    problem: &CondensedProblem<D>,
    found: &ContactSolution<D>,
) -> Result<(), TestCaseError> {
    let scale = problem.force_scale(&found.force);
    let left = &structure.stiffness * stack(&found.motion) - &structure.load - stack(&found.force);
    // Where little holds a body it moves far, and the terms of the balance are large.
    let moved = found.motion.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let rounding = 1e-13 * structure.stiffness.amax() * moved;
    prop_assert!(
        left.amax() < 1e-9 * scale + rounding,
        "out of balance by {:e}",
        left.amax()
    );
    let residual = problem.residual(&found.displacement, &found.force);
    prop_assert!(residual < 1e-9 * scale, "off the law by {residual:e}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Below the friction at which solutions are several it is the one of the condensed problem.
    #[test]
    fn the_solution_is_that_of_the_condensed_problem(
        contacts in 1usize..9, seed in prop::collection::vec(-1.0..1.0f64, 37),
        kind in 0usize..5, rigid in any::<bool>(),
    ) {
        let coulomb = |mu: f64| Friction::from(Coulomb::new(mu).expect("valid"));
        let laws = [
            vec![coulomb(0.1), coulomb(0.0)],
            vec![Tresca::new(0.2).expect("valid").into()],
            vec![LimitedCoulomb::new(0.2, 0.3).expect("valid").into()],
            vec![AnisotropicCoulomb::new(0.05, 0.15).expect("valid").into()],
            vec![coulomb(0.1), Tie.into()],
        ];
        let (mut structure, problem) = sample::<3>(contacts, &seed, &laws[kind], rigid);
        let expected = SemismoothNewton::default().solve(&problem, None);
        let found = tied(&mut structure, &problem, None);
        let (Ok(expected), Ok(found)) = (&expected, &found) else {
            prop_assert!(found.is_ok() || expected.is_err(), "{found:?}");
            return Ok(());
        };
        assert_solves(&structure, &problem, found)?;
        let scale = problem.force_scale(&expected.force);
        for (a, b) in found.force.iter().zip(&expected.force) {
            prop_assert!((a - b).norm() < 1e-8 * scale, "{a} {b}");
        }
        // From its own solution it takes one step at most.
        let again = tied(&mut structure, &problem, Some(found)).expect("solved before");
        prop_assert!(again.iterations <= 2, "{} iterations", again.iterations);
        assert_solves(&structure, &problem, &again)?;
    }

    #[test]
    fn in_the_plane_too(
        contacts in 1usize..12, seed in prop::collection::vec(-1.0..1.0f64, 41), mu in 0.0..0.3f64,
    ) {
        let law = Coulomb::new(mu).expect("valid").into();
        let (mut structure, problem) = sample::<2>(contacts, &seed, &[law], false);
        let found = tied(&mut structure, &problem, None);
        prop_assert!(found.is_ok(), "{found:?}");
        assert_solves(&structure, &problem, &found.expect("asked"))?;
    }
}

/// Springs in series are those of the penalty.
#[test]
fn springs_are_those_of_the_penalty() {
    let seed: Vec<f64> = (0..37).map(|k| f64::sin(3.0 * f64::from(k))).collect();
    let law = Coulomb::new(0.2).expect("valid").into();
    let (mut structure, problem) = sample::<3>(6, &seed, &[law], false);
    let (normal, tangent) = (20.0, 5.0);
    let penalty = Penalty::new(normal, tangent).expect("valid");
    let expected = penalty.solve(&problem, None).expect("solved");
    let compliance = Local::<3>::new(1.0 / normal, 1.0 / tangent, 1.0 / tangent);
    let springs = Springs {
        compliance,
        force: Local::zeros(),
    };
    let load = structure.load.amax();
    let mut own = TiedProblem {
        structure: &mut structure,
        origin: problem.origin().to_vec(),
        friction: problem.laws().to_vec(),
        springs: vec![springs; 6],
        load,
        rounding: 0.0,
        weight: 0.0,
        previous: problem.previous().to_vec(),
    };
    let (found, _) = solve_tied(
        &mut own,
        None,
        (penalty.tolerance, 0.0),
        &mut TiedFactor::default(),
    )
    .expect("solved");
    assert!(expected.force.iter().any(|t| t[0] > 0.1));
    for (a, b) in found.force.iter().zip(&expected.force) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    for (a, b) in found.irreversible.iter().zip(&expected.irreversible) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
}

/// Weighed by a stiffness above that of the contacts, gaps and slips are as small as the tolerance then asks.
#[test]
fn displacements_weigh_by_the_stiffness_that_is_told() {
    let seed: Vec<f64> = (0..37).map(|k| f64::sin(3.0 * f64::from(k))).collect();
    let law: Friction = Coulomb::new(0.2).expect("valid").into();
    let off = |weight: f64, judged: f64| {
        let (mut structure, problem) = sample::<3>(6, &seed, &[law], false);
        let load = structure.load.amax();
        let mut own = TiedProblem {
            structure: &mut structure,
            origin: problem.origin().to_vec(),
            friction: problem.laws().to_vec(),
            springs: vec![Springs::default(); 6],
            load,
            rounding: 0.0,
            weight,
            previous: problem.previous().to_vec(),
        };
        let loose = Tolerance {
            relative: 1e-3,
            ..SemismoothNewton::default().tolerance
        };
        let (found, _) =
            solve_tied(&mut own, None, (loose, 0.0), &mut TiedFactor::default()).expect("solved");
        let pairs = found.irreversible.iter().zip(&found.force);
        let maps = pairs.map(|(u, t)| law.natural_map(u, t, judged).norm());
        maps.fold(0.0, f64::max) / problem.force_scale(&found.force)
    };
    let weight = 1e5;
    assert!(off(0.0, weight) > 1e-3);
    assert!(off(weight, weight) < 1e-3);
}

/// A factor serves many directions, and many contacts take no more of either.
#[test]
fn the_number_of_factors_and_solves_does_not_follow_that_of_contacts() {
    let seed: Vec<f64> = (0..61).map(|k| f64::sin(7.0 * f64::from(k))).collect();
    let law = Coulomb::new(0.1).expect("valid").into();
    let counted = |contacts: usize| {
        let (mut structure, problem) = sample::<3>(contacts, &seed, &[law], false);
        tied(&mut structure, &problem, None).expect("solved");
        (structure.factorisations, structure.solves)
    };
    let ((few, some), (many, all)) = (counted(10), counted(80));
    assert!(
        many <= 3 * few && all <= 4 * some,
        "{few} {some}, {many} {all}"
    );
}

/// Under a load that has hardly changed what sticks and slips is the same, and the factor serves on.
#[test]
fn a_factor_serves_as_long_as_its_statuses_do() {
    let seed: Vec<f64> = (0..37).map(|k| f64::sin(5.0 * f64::from(k))).collect();
    let law = Coulomb::new(0.2).expect("valid").into();
    let (mut structure, problem) = sample::<3>(8, &seed, &[law], false);
    let mut held = TiedFactor::default();
    let asked = (SemismoothNewton::default().tolerance, 0.0);
    let mut solve = |structure: &mut Dense, guess: Option<&ContactSolution<3>>, rounding: f64| {
        let load = structure.load.amax();
        let mut own = TiedProblem {
            structure,
            origin: problem.origin().to_vec(),
            friction: problem.laws().to_vec(),
            springs: vec![Springs::default(); 8],
            load,
            rounding,
            weight: 0.0,
            previous: problem.previous().to_vec(),
        };
        let solved = solve_tied(&mut own, guess, asked, &mut held);
        solved.expect("solved").0
    };
    let found = solve(&mut structure, None, 0.0);
    // The last factor on the way to it may have other statuses.
    let found = solve(&mut structure, Some(&found), 0.0);
    let factorisations = structure.factorisations;
    let slips = |s: &ContactSolution<3>| s.status.contains(&Status::Slip);
    assert!(slips(&found));
    structure.load *= 1.0 + 1e-3;
    let again = solve(&mut structure, Some(&found), 0.0);
    assert_eq!(structure.factorisations, factorisations);
    assert!(again.status == found.status && again.force != found.force);
    assert_solves(&structure, &problem, &again).expect("solved");
    // What is known to rounding is solved to rounding: a change below it asks for no iteration.
    structure.load *= 1.0 + 1e-6;
    let size = structure.load.amax();
    let changed = solve(&mut structure, Some(&again), 0.0);
    let rounded = solve(&mut structure, Some(&again), 1e-3 * size);
    assert!(
        changed.iterations > rounded.iterations,
        "{changed:?} {rounded:?}"
    );
    assert!(rounded.exact && rounded.residual <= 1e-3 * size);
}

/// A long beam on springs, all of it on the ground, pressed down in the middle: next to where it bears it
/// would pull, and next to that bear again. It lifts off at once, not one wave after the other.
#[test]
fn what_lifts_off_is_not_peeled_off() {
    let contacts = 200;
    let bend = DMatrix::from_fn(contacts - 2, contacts, |i, j| match j.wrapping_sub(i) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    });
    let beam = bend.transpose() * &bend * 30.0;
    let stiffness = DMatrix::from_fn(2 * contacts, 2 * contacts, |i, j| match (i % 2, j % 2) {
        (0, 0) => beam[(i / 2, j / 2)] + if i == j { 1e-6 } else { 0.0 },
        _ => f64::from(u8::from(i == j)),
    });
    let load = DVector::from_fn(2 * contacts, |i, _| if i == contacts { -1.0 } else { 0.0 });
    let mut structure = Dense {
        stiffness,
        load,
        factor: None,
        factorisations: 0,
        solves: 0,
        worth: 6.0,
    };
    let springs = Springs {
        compliance: Local::<2>::new(1.0, 1.0),
        force: Local::zeros(),
    };
    let mut problem = TiedProblem {
        structure: &mut structure,
        origin: vec![Local::zeros(); contacts],
        friction: vec![Coulomb::new(0.0).expect("valid").into(); contacts],
        springs: vec![springs; contacts],
        load: 1.0,
        rounding: 0.0,
        weight: 0.0,
        previous: vec![Local::zeros(); contacts],
    };
    let asked = (SemismoothNewton::default().tolerance, 0.0);
    let (found, _) =
        solve_tied(&mut problem, None, asked, &mut TiedFactor::default()).expect("solved");
    let closed = found.force.iter().filter(|t| t[0] > 0.0).count();
    assert!((5..30).contains(&closed), "{closed} bear");
    for (t, u) in found.force.iter().zip(&found.displacement) {
        assert!(t[0] >= 0.0 && u[0] + t[0] > -1e-9 && t[0] * (u[0] + t[0]) < 1e-9);
    }
    let total: f64 = found.force.iter().map(|t| t[0]).sum();
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    let counted = (structure.factorisations, structure.solves);
    assert!(
        counted.0 <= 4 && counted.1 <= 15,
        "{counted:?}: factors and solves"
    );
}

/// Where directions of the Krylov iteration nearly cancel the last answer is solved for anew.
#[test]
fn sums_that_cancel_are_answered_anew() {
    let seed = [
        0.6123798314743251,
        0.8263235021715657,
        -0.8252558433744224,
        0.17422838232814752,
        -0.2989319489132159,
        0.5168062697389766,
        0.12033542906112778,
        0.4899738708009194,
        0.38279234283823776,
        0.7860591956332073,
        -0.5158361637579167,
        -0.050949418761610125,
        -0.006613873493520787,
        0.23066531525667272,
        0.6553471946872953,
        0.45949709099534186,
        -0.5299471252887015,
        0.855908695955347,
        0.844470159256872,
        0.9716534815994234,
        -0.3725949206735367,
        -0.133827775936682,
        -0.6625451346561113,
        0.4377193201321344,
        0.21717345149982223,
        -0.049970679230886376,
        0.7173056409043584,
        -0.8098275994365005,
        -0.4716024710418429,
        -0.5747768042216769,
        -0.8324790152187639,
        -0.6282768059276631,
        0.6383704824848813,
        -0.7193045198870552,
        -0.45169913149494506,
        -0.4867660472153396,
        -0.8049251065299828,
    ];
    let law = Tresca::new(0.2).expect("valid").into();
    let (mut structure, problem) = sample::<3>(5, &seed, &[law], false);
    let found = tied(&mut structure, &problem, None).expect("solvable");
    assert_solves(&structure, &problem, &found).expect("solved");
}

/// What takes more than its iteration is worth is given up, and not iterated to its last.
#[test]
fn an_iteration_that_costs_too_much_is_given_up() {
    let seed: Vec<f64> = (0..37).map(|k| f64::sin(3.0 * f64::from(k))).collect();
    let law = Coulomb::new(0.2).expect("valid").into();
    let (mut structure, problem) = sample::<3>(6, &seed, &[law], false);
    assert!(tied(&mut structure, &problem, None).is_ok());
    let taken = structure.factorisations + structure.solves;
    // A factorisation takes as long as more solves than any iteration may.
    structure.worth = 1e4;
    (structure.factorisations, structure.solves) = (0, 0);
    let found = tied(&mut structure, &problem, None);
    assert!(
        matches!(found, Err(ContactError::NotConverged { .. })),
        "{found:?}"
    );
    assert!(structure.factorisations + structure.solves < taken);
}
