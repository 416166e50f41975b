//! A spring pulls a slider: the paths of a Jenkins element with exact answers, through the
//! regularised law and through the condensed contact problem; not a structure.

use crate::close;
use moreau::contact::{CondensedProblem, ContactSolver, SemismoothNewton};
use moreau::laws::textbook::RegularisedCoulomb;
use moreau::laws::{Coulomb, Local, Status};
use nalgebra::{DMatrix, DVector, Rotation2, Vector2};
use verification::problems::Fallible;

/// Tangential spring [N/mm] and normal stiffness [N/mm].
const SPRING: f64 = 100.0;
const NORMAL: f64 = 1e4;
const MU: f64 = 0.4;
/// Round-off of sums of a hundred terms.
const ROUND_OFF: f64 = 1e-12;

/// A slider with history, whichever way its step is solved.
trait Slider<const D: usize> {
    /// One step to the drive given, pressed by a given force [N]. Returns the force of the spring
    /// on the slider, the slip and the status.
    fn step(&mut self, pressure: f64, drive: Local<D>) -> Fallible<(Local<D>, Local<D>, Status)>;
}

/// The spring is that of the regularised law.
struct Regularised<const D: usize> {
    drive: Local<D>,
    force: Local<D>,
}

impl<const D: usize> Slider<D> for Regularised<D> {
    fn step(&mut self, pressure: f64, drive: Local<D>) -> Fallible<(Local<D>, Local<D>, Status)> {
        let law = RegularisedCoulomb::new(MU, NORMAL, SPRING)?;
        let mut u = drive - self.drive;
        u[0] = -pressure / NORMAL;
        let response = law.respond(&self.force, &u);
        (self.drive, self.force) = (drive, response.force);
        Ok((-response.force, response.irreversible, response.status))
    }
}

/// The spring is a structure of stiffness diag(NORMAL, SPRING), the law is exact.
struct Condensed<const D: usize> {
    slider: Local<D>,
    force: Local<D>,
}

impl<const D: usize> Slider<D> for Condensed<D> {
    fn step(&mut self, pressure: f64, drive: Local<D>) -> Fallible<(Local<D>, Local<D>, Status)> {
        // t = S (u − g) − f: the spring pulls with f = SPRING·(drive − slider at the start).
        let mut stiffness = DMatrix::from_diagonal_element(D, D, SPRING);
        stiffness[(0, 0)] = NORMAL;
        let pull = (drive - self.slider) * SPRING;
        let mut load = DVector::from_column_slice(pull.as_slice());
        load[0] = -pressure;
        let problem = CondensedProblem::new(
            stiffness,
            load,
            vec![Local::zeros()],
            vec![Coulomb::new(MU)?],
            vec![self.force],
        )?;
        let solution = SemismoothNewton::default().solve(&problem, None)?;
        let slip = solution.displacement[0];
        self.slider += slip;
        self.force = solution.force[0];
        let mut spring = (drive - self.slider) * SPRING;
        spring[0] = -pressure;
        Ok((spring, slip, solution.status[0]))
    }
}

fn both<const D: usize>() -> [Box<dyn Slider<D>>; 2] {
    let zero = Local::zeros();
    [
        Box::new(Regularised {
            drive: zero,
            force: zero,
        }),
        Box::new(Condensed {
            slider: zero,
            force: zero,
        }),
    ]
}

/// Drives along straight lines, and returns spring force, work dissipated and status at the end.
fn along<const D: usize>(
    slider: &mut dyn Slider<D>,
    pressures: (f64, f64),
    (from, to): (Local<D>, Local<D>),
    steps: u32,
) -> Fallible<(Local<D>, f64, Status)> {
    let mut last = (Local::zeros(), 0.0, Status::Open);
    for step in 1..=steps {
        let s = f64::from(step) / f64::from(steps);
        let pressure = pressures.0 + s * (pressures.1 - pressures.0);
        let (force, slip, status) = slider.step(pressure, from.lerp(&to, s))?;
        let work: f64 = (1..D).map(|i| force[i] * slip[i]).sum();
        last = (force, last.1 + work, status);
    }
    Ok(last)
}

#[test]
fn jenkins_element_hysteresis_is_exact_for_any_step() -> Fallible {
    for steps in [1, 2, 5, 7, 100] {
        for mut slider in both::<2>() {
            let mut at = 0.0;
            let mut go = |to: f64, steps: u32| -> Fallible<(f64, f64, Status)> {
                let path = (Vector2::new(0.0, at), Vector2::new(0.0, to));
                at = to;
                let (force, work, status) = along(slider.as_mut(), (50.0, 50.0), path, steps)?;
                Ok((force[1], work, status))
            };
            // 0 → 0.5: slip begins at 20 N / 100 N/mm.
            let (force, work, status) = go(0.2, steps)?;
            close("force at the onset of slip", force, 20.0, ROUND_OFF);
            assert!(work.abs() < 1e-11, "nothing slipped before: {work}");
            assert_ne!(status, Status::Open);
            let (force, work, status) = go(0.5, steps)?;
            close("force in slip", force, 20.0, ROUND_OFF);
            close("dissipation", work, 20.0 * 0.3, 1e-11);
            assert_eq!(status, Status::Slip);
            // 0.5 → −0.5: reverse slip begins at 0.1.
            let (force, work, _) = go(0.1, steps)?;
            close(
                "force at the onset of reverse slip",
                force,
                -20.0,
                ROUND_OFF,
            );
            assert!(work.abs() < 1e-11);
            let (force, back, _) = go(-0.5, steps)?;
            close("force in reverse slip", force, -20.0, ROUND_OFF);
            // −0.5 → 0.5: forward slip begins at −0.1.
            let (force, work, _) = go(-0.1, steps)?;
            close("force at the onset of forward slip", force, 20.0, ROUND_OFF);
            assert!(work.abs() < 1e-11);
            let (force, forth, _) = go(0.5, steps)?;
            close("force in forward slip", force, 20.0, ROUND_OFF);
            // A closed cycle: 4 · 20 N · (0.5 − 0.2) mm.
            close("dissipation of a cycle", back + forth, 24.0, 1e-11);
        }
    }
    Ok(())
}

#[test]
fn jenkins_element_creeps_when_its_pressure_falls() -> Fallible {
    for steps in [1, 10, 97] {
        for mut slider in both::<2>() {
            let (rest, end) = (Vector2::zeros(), Vector2::new(0.0, 0.5));
            let (force, ..) = along(slider.as_mut(), (50.0, 50.0), (rest, end), steps)?;
            close("force", force[1], 20.0, ROUND_OFF);
            // N: 50 → 25 N at a fixed drive: the slider creeps forward by 10 N / 100 N/mm.
            let (force, work, status) = along(slider.as_mut(), (50.0, 25.0), (end, end), steps)?;
            close("force under half the pressure", force[1], 10.0, ROUND_OFF);
            assert_eq!(status, Status::Slip);
            // ∫ 20…10 N along 0.1 mm, from below for implicit steps; the error is one step's.
            assert!(
                work <= 1.5 + 1e-12 && work >= 1.5 - 0.5 / f64::from(steps) - 1e-12,
                "{work}"
            );
            // The pressure back again: nothing moves, the force stays.
            let (force, work, status) = along(slider.as_mut(), (25.0, 50.0), (end, end), steps)?;
            close(
                "force under the pressure restored",
                force[1],
                10.0,
                ROUND_OFF,
            );
            assert!(work.abs() < 1e-12);
            assert_eq!(status, Status::Stick);
            // It takes the rest of the limit force to slip on, not all of it again.
            let further = Vector2::new(0.0, 0.6 + 1e-3);
            let (force, work, status) = along(slider.as_mut(), (50.0, 50.0), (end, further), 1)?;
            close("force in slip again", force[1], 20.0, ROUND_OFF);
            close("slip again", work, 20.0 * 1e-3, 1e-9);
            assert_eq!(status, Status::Slip);
        }
    }
    Ok(())
}

/// Steady lag of a slider on a circular drive of radius U: it slides on a circle of radius
/// √(U² − (F/k)²), the spring tangent to that circle.
#[test]
fn circular_slider_lags_by_the_exact_angle_to_first_order() -> Fallible {
    const U: f64 = 0.5;
    let reach: f64 = 20.0 / SPRING;
    let exact = (U * U - reach * reach).sqrt();
    let lag = (reach / U).asin();
    close("radius", exact, 0.4582576, 1e-6);
    close("lag", lag, 0.4115168, 1e-6);
    let run = |slider: &mut dyn Slider<3>, steps: u32| -> Fallible<(f64, f64, f64)> {
        let drive = |angle: f64| {
            let at = Rotation2::new(angle) * Vector2::new(U, 0.0);
            Local::<3>::new(0.0, at[0], at[1])
        };
        slider.step(50.0, drive(0.0))?;
        let mut last = (0.0, 0.0, 0.0);
        let turns = 2;
        for step in 1..=turns * steps {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
            let (force, ..) = slider.step(50.0, drive(angle))?;
            let spring = Vector2::new(force[1], force[2]) / SPRING;
            let at = drive(angle);
            let place = Vector2::new(at[1], at[2]) - spring;
            let behind = angle.rem_euclid(std::f64::consts::TAU)
                - place[1].atan2(place[0]).rem_euclid(std::f64::consts::TAU);
            let turned = behind.rem_euclid(std::f64::consts::TAU);
            last = (place.norm(), turned, spring.dot(&place));
        }
        Ok(last)
    };
    for k in 0..2 {
        let mut errors = Vec::new();
        for steps in [1250, 2500, 5000] {
            let (radius, behind, dot) = run(both::<3>()[k].as_mut(), steps)?;
            errors.push([radius - exact, behind - lag, dot]);
        }
        for pair in errors.windows(2) {
            let order = |i: usize| (pair[0][i] / pair[1][i]).log2();
            assert!(
                (order(0) - 1.0).abs() < 0.05,
                "order of the radius: {}",
                order(0)
            );
            assert!(
                order(1) > 0.95 && order(2) > 0.95,
                "orders {} and {}",
                order(1),
                order(2)
            );
        }
    }
    let (radius, ..) = run(both::<3>()[0].as_mut(), 20_000)?;
    close(
        "radius with 20000 steps a turn",
        radius,
        0.458226,
        1e-6 / 0.458226,
    );
    Ok(())
}

/// An elastic bar on a foundation that holds it by a limited shear, clamped at its far end and
/// pulled at the other: u = F²/(2 EA τ) while loaded, Masing's rule after. Linear elements with
/// nodal limits are exact at the nodes as long as no slip front lies within an element.
#[test]
fn elastic_bar_on_a_frictional_foundation_follows_masing() -> Fallible {
    const ELEMENTS: usize = 100;
    const LENGTH: f64 = 10.0;
    let h = LENGTH / ELEMENTS as f64;
    // EA = 1, τ = 1: nodes 0 (pulled) to 99 touch, node 100 is clamped. Each contact has a normal
    // stiffness of its own and is pressed so that μ N = τ times its share of the length.
    let limit = |node: usize| if node == 0 { 0.5 * h } else { h };
    let mut stiffness = DMatrix::<f64>::zeros(2 * ELEMENTS, 2 * ELEMENTS);
    for node in 0..ELEMENTS {
        stiffness[(2 * node, 2 * node)] = 1.0;
        stiffness[(2 * node + 1, 2 * node + 1)] = if node == 0 { 1.0 / h } else { 2.0 / h };
        if node > 0 {
            stiffness[(2 * node + 1, 2 * node - 1)] = -1.0 / h;
            stiffness[(2 * node - 1, 2 * node + 1)] = -1.0 / h;
        }
    }
    let mut u = DVector::<f64>::zeros(2 * ELEMENTS);
    let mut forces = vec![Local::<2>::zeros(); ELEMENTS];
    let path = [
        (2.0, 2.0),
        (4.0, 8.0),
        (6.0, 18.0),
        (5.0, 17.75),
        (3.0, 15.75),
        (0.0, 9.0),
        (-6.0, -18.0),
        (0.0, -9.0),
        (6.0, 18.0),
    ];
    for (pull, expected) in path {
        let mut load = -(&stiffness * &u);
        load[1] += pull;
        for node in 0..ELEMENTS {
            load[2 * node] = -limit(node) / MU;
        }
        let problem = CondensedProblem::new(
            stiffness.clone(),
            load,
            vec![Local::zeros(); ELEMENTS],
            vec![Coulomb::new(MU)?; ELEMENTS],
            forces.clone(),
        )?;
        let solution = SemismoothNewton::default().solve(&problem, None)?;
        for (node, slip) in solution.displacement.iter().enumerate() {
            u[2 * node + 1] += slip[1];
        }
        forces = solution.force;
        close(
            &format!("displacement under F = {pull}"),
            u[1],
            expected,
            1e-11,
        );
    }
    Ok(())
}
