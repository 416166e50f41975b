//! A spring and slider on given paths, driven through the regularised law; not a structure.

use approx::assert_relative_eq;
use moreau_laws::textbook::RegularisedCoulomb;
use moreau_laws::{LawError, Local, Status};
use nalgebra::{Rotation2, SVector, Vector2, Vector3};

const STIFFNESS: f64 = 100.0;
const MU: f64 = 0.4;
const NORMAL_STIFFNESS: f64 = 1e4;

/// A slider pressed by a given force, its drive and the friction force upon it.
struct Slider<const D: usize> {
    law: RegularisedCoulomb,
    pressure: f64,
    drive: Local<D>,
    force: Local<D>,
    dissipated: f64,
}

impl<const D: usize> Slider<D> {
    fn new(pressure: f64) -> Result<Self, LawError> {
        Ok(Self {
            law: RegularisedCoulomb::new(MU, NORMAL_STIFFNESS, STIFFNESS)?,
            pressure,
            drive: Local::zeros(),
            force: Local::zeros(),
            dissipated: 0.0,
        })
    }

    /// One step to the drive given.
    fn step(&mut self, drive: Local<D>) -> Status {
        let mut u = drive - self.drive;
        u[0] = -self.pressure / NORMAL_STIFFNESS;
        let response = self.law.respond(&self.force, &u);
        self.drive = drive;
        self.force = response.force;
        self.dissipated -= response.force.dot(&response.irreversible);
        response.status
    }

    /// Equal steps to the drive given.
    fn drive_to(&mut self, drive: Local<D>, steps: u32) {
        let start = self.drive;
        for step in 1..=steps {
            self.step(start.lerp(&drive, f64::from(step) / f64::from(steps)));
        }
    }
}

/// Hysteresis of a Jenkins element: the implicit step is exact, whatever its size.
#[test]
fn hysteresis() -> Result<(), LawError> {
    for steps in [1, 2, 5, 7, 100] {
        let mut slider = Slider::<2>::new(50.0)?;
        let mut expect = |drive: f64, pull: f64, steps: u32| {
            slider.drive_to(Vector2::new(0.0, drive), steps);
            // The force of the spring on the slider is opposite to friction.
            assert_relative_eq!(-slider.force[1], pull, epsilon = 1e-11);
            slider.dissipated
        };
        expect(0.2, 20.0, steps);
        expect(0.5, 20.0, steps);
        let start = expect(0.5, 20.0, 1);
        expect(0.1, -20.0, steps);
        expect(-0.5, -20.0, steps);
        expect(-0.3, 0.0, steps);
        expect(-0.1, 20.0, steps);
        let end = expect(0.5, 20.0, steps);
        assert_relative_eq!(end - start, 24.0, epsilon = 1e-10);
    }
    Ok(())
}

/// The slider creeps when the pressure falls under a constant drive.
#[test]
fn falling_pressure() -> Result<(), LawError> {
    let mut slider = Slider::<2>::new(50.0)?;
    slider.drive_to(Vector2::new(0.0, 0.5), 10);
    slider.pressure = 25.0;
    assert_eq!(slider.step(slider.drive), Status::Slip);
    assert_relative_eq!(slider.force, Vector2::new(25.0, -10.0), epsilon = 1e-11);
    Ok(())
}

/// A circular drive: the slider follows on a smaller circle, late; first order in the step.
#[test]
fn circular_drive() -> Result<(), LawError> {
    let (radius, friction) = (0.5, 20.0);
    let exact = (radius * radius - (friction / STIFFNESS).powi(2)).sqrt();
    assert_relative_eq!(exact, 0.458_257_6, epsilon = 1e-7);

    let steady = |steps: u32| -> Result<f64, LawError> {
        let mut slider = Slider::<3>::new(50.0)?;
        let on_circle = |step: u32| {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
            Vector3::new(0.0, radius * angle.cos(), radius * angle.sin())
        };
        slider.drive_to(on_circle(0), 10);
        for step in 1..=3 * steps {
            slider.step(on_circle(step % steps));
        }
        let tangential = |v: &Local<3>| SVector::from([v[1], v[2]]);
        let drive = tangential(&slider.drive);
        let pull = tangential(&-slider.force);
        let position = drive - pull / STIFFNESS;
        let h = std::f64::consts::TAU / f64::from(steps);
        assert!(
            (pull.dot(&position) / (friction * exact)).abs() <= h,
            "force not along the slip"
        );
        let lag = Rotation2::rotation_between(&position, &drive).angle();
        assert_relative_eq!(lag, 0.411_516_8, epsilon = h);
        Ok(position.norm())
    };
    assert_relative_eq!(steady(20_000)?, 0.458_226, epsilon = 1e-6);
    let error = |steps| Ok::<_, LawError>((steady(steps)? - exact).abs());
    assert_relative_eq!(error(1000)? / error(2000)?, 2.0, max_relative = 1e-2);
    Ok(())
}
