//! A material point of von Mises on paths with known answers; not random states.

use crate::contract::for_all;
use crate::samples::vector;
use approx::assert_relative_eq;
use moreau_laws::{BulkLaw, LawError, VonMises, VonMisesState};
use moreau_mandel::{Sym2, deviator, rotation, trace};
use nalgebra::{Matrix3, SMatrix};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, FRAC_PI_8, SQRT_2};

const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const YIELD: f64 = 300.0;
const STRAIN: f64 = YIELD / YOUNG;

fn perfect() -> Result<VonMises, LawError> {
    VonMises::new(YOUNG, POISSON, YIELD)
}

/// A point driven in steps, its strain and its state.
pub(crate) struct Point<const TERMS: usize> {
    pub(crate) law: VonMises<TERMS>,
    pub(crate) state: VonMisesState<TERMS>,
    pub(crate) strain: Sym2,
}

impl<const TERMS: usize> Point<TERMS> {
    pub(crate) fn new(law: VonMises<TERMS>) -> Self {
        Self {
            law,
            state: VonMisesState::default(),
            strain: Sym2::zeros(),
        }
    }

    /// One step to a strain; what must hold in every step is checked here.
    pub(crate) fn strain_to(&mut self, strain: Sym2) {
        let new = self.law.respond(&self.state, &(strain - self.strain)).state;
        assert!(self.law.yield_function(&new) <= 1e-12 * YIELD);
        assert!(trace(&new.plastic_strain).abs() <= 1e-15);
        assert!(self.law.dissipation(&self.state, &new) >= 0.0);
        self.state = new;
        self.strain = strain;
    }

    /// One step to given strain components, `None` being free of stress: Newton on the others.
    fn drive_to(&mut self, strain: [Option<f64>; 6]) {
        let target = Sym2::from_fn(|i, _| strain[i].unwrap_or(self.strain[i]));
        let mut d_eps = target - self.strain;
        for _ in 0..50 {
            let response = self.law.respond(&self.state, &d_eps);
            let free = |i: usize| strain[i].is_none();
            let residual = Sym2::from_fn(|i, _| if free(i) { response.stress[i] } else { 0.0 });
            if residual.norm() <= 1e-13 * YIELD {
                return self.strain_to(self.strain + d_eps);
            }
            let jacobian = SMatrix::<f64, 6, 6>::from_fn(|i, j| match (free(i), free(j)) {
                (true, true) => response.tangent[(i, j)],
                _ if i == j => YOUNG,
                _ => 0.0,
            });
            d_eps -= jacobian.cholesky().map_or(residual, |c| c.solve(&residual));
        }
        panic!("no equilibrium at {strain:?}");
    }

    /// One step of uniaxial stress.
    pub(crate) fn pull_to(&mut self, eps: f64) -> f64 {
        self.drive_to([Some(eps), None, None, Some(0.0), Some(0.0), Some(0.0)]);
        self.stress()[0]
    }

    pub(crate) fn stress(&self) -> Sym2 {
        self.law.stress(&self.state)
    }
}

/// Uniaxial strain yields at σ_y/2G and rises with the bulk modulus, in any number of steps.
#[test]
fn uniaxial_strain() -> Result<(), LawError> {
    let law = perfect()?;
    let eps_y = YIELD / (2.0 * law.elastic().shear_modulus());
    assert_relative_eq!(eps_y, 1.857_142_857e-3, max_relative = 1e-9);
    let along = |eps: f64| Sym2::from([eps, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for steps in [1, 2, 3, 7, 100] {
        let mut point = Point::new(law.clone());
        point.strain_to(along(eps_y));
        assert_relative_eq!(point.stress()[0], 525.0, max_relative = 1e-12);
        assert!(point.state.p <= 1e-15);
        for step in 1..=steps {
            let eps = eps_y + (0.005 - eps_y) * f64::from(step) / f64::from(steps);
            point.strain_to(along(eps));
            let stress = point.stress();
            assert_relative_eq!(stress[0], 175e3 * eps + 200.0, max_relative = 1e-12);
            assert_relative_eq!(stress[1], 175e3 * eps - 100.0, max_relative = 1e-12);
        }
        assert_relative_eq!(point.stress()[0], 1075.0, max_relative = 1e-12);
        assert_relative_eq!(point.stress()[1], 775.0, max_relative = 1e-12);
        assert_relative_eq!(point.stress()[2], 775.0, max_relative = 1e-12);
    }
    Ok(())
}

#[test]
fn simple_shear() -> Result<(), LawError> {
    for steps in [1, 10] {
        let mut point = Point::new(perfect()?);
        for step in 1..=steps {
            let gamma_half = 10.0 * STRAIN * f64::from(step) / f64::from(steps);
            point.strain_to(Sym2::from([0.0, 0.0, 0.0, 0.0, 0.0, SQRT_2 * gamma_half]));
        }
        let shear = point.stress()[5] / SQRT_2;
        assert_relative_eq!(shear, YIELD / 3f64.sqrt(), max_relative = 1e-12);
        assert_relative_eq!(shear, 173.205_080_8, epsilon = 1e-7);
    }
    Ok(())
}

/// Plane strain tension at ε_y = a given multiple of the yield strain, in equal steps.
fn plane_strain_tension(multiple: u32, steps_per_unit: u32) -> Result<Sym2, LawError> {
    let mut point = Point::new(perfect()?);
    for step in 1..=multiple * steps_per_unit {
        let eps = STRAIN * f64::from(step) / f64::from(steps_per_unit);
        point.drive_to([None, Some(eps), Some(0.0), Some(0.0), Some(0.0), Some(0.0)]);
    }
    Ok(point.stress())
}

#[test]
fn plane_strain_tension_tends_to_its_limit() -> Result<(), LawError> {
    let k = YIELD / 3f64.sqrt();
    let limit = plane_strain_tension(50, 20)?;
    assert_relative_eq!(limit[1], 2.0 * k, max_relative = 1e-10);
    assert_relative_eq!(limit[2], k, max_relative = 1e-10);
    assert!(limit[0].abs() <= 1e-10 * YIELD);
    Ok(())
}

/// The exact σ_yy at ε_y = a given multiple of the yield strain.
///
/// On the yield ellipse σ_yy = 2k cos ψ, σ_zz = 2k cos(ψ + π/3); with σ_x = 0 and dε_z = 0 the flow
/// rule integrates to √3/2 · E ε_y/σ_y = (½ − ν)(cos ψ − √3 sin ψ) − ¾ ln tan ½ψ + constant.
fn exact_plane_strain_tension(multiple: f64) -> f64 {
    let flow = |psi: f64| {
        (0.5 - POISSON) * (psi.cos() - 3f64.sqrt() * psi.sin()) - 0.75 * (0.5 * psi).tan().ln()
    };
    // It yields with σ_zz = ν σ_yy.
    let at_yield = (3f64.sqrt() * (1.0 - POISSON) / (1.0 + POISSON)).atan() - FRAC_PI_6;
    let elastic = (1.0 - POISSON * POISSON) / (1.0 - POISSON + POISSON * POISSON).sqrt();
    let (mut low, mut high) = (0.0, at_yield);
    for _ in 0..100 {
        let psi = 0.5 * (low + high);
        if elastic + 2.0 / 3f64.sqrt() * (flow(psi) - flow(at_yield)) > multiple {
            low = psi;
        } else {
            high = psi;
        }
    }
    2.0 / 3f64.sqrt() * YIELD * low.cos()
}

#[test]
fn plane_strain_tension_on_the_way() -> Result<(), LawError> {
    for (multiple, tolerance) in [(2, 7e-4), (5, 4e-6), (10, 1e-10)] {
        let exact = exact_plane_strain_tension(f64::from(multiple));
        let error = |steps| Ok::<_, LawError>(exact - plane_strain_tension(multiple, steps)?[1]);
        assert!(
            error(2000)?.abs() <= tolerance,
            "at {multiple} times the yield strain"
        );
        // Backward Euler is of first order, and falls short.
        assert_relative_eq!(error(100)? / error(200)?, 2.0, max_relative = 0.05);
    }
    Ok(())
}

/// The first branch with the hardening modulus H, isotropic or kinematic.
fn hardened(h: f64, eps: f64) -> f64 {
    YIELD + YOUNG * h / (YOUNG + h) * (eps - STRAIN)
}

#[test]
fn linear_isotropic_hardening() -> Result<(), LawError> {
    let h = 10e3;
    for steps in [1, 4, 25] {
        let mut point = Point::new(perfect()?.with_isotropic(h)?);
        for step in 1..=steps {
            let eps = STRAIN + 4.0 * STRAIN * f64::from(step) / f64::from(steps);
            assert_relative_eq!(point.pull_to(eps), hardened(h, eps), max_relative = 1e-12);
        }
        // The elastic range of the reversal is twice the current yield stress.
        let (top, p) = (point.stress()[0], point.state.p);
        assert_relative_eq!(p, (top - YIELD) / h, max_relative = 1e-11);
        let range = 2.0 * top / YOUNG;
        let eps = 5.0 * STRAIN - range;
        assert_relative_eq!(
            point.pull_to(eps + 1e-9 * STRAIN),
            -top,
            max_relative = 1e-8
        );
        assert_eq!(point.state.p, p);
        let further = point.pull_to(eps - STRAIN);
        let expected = -top - YOUNG * h / (YOUNG + h) * STRAIN;
        assert_relative_eq!(further, expected, max_relative = 1e-12);
        assert!(point.state.p > p);
    }
    Ok(())
}

#[test]
fn linear_kinematic_hardening() -> Result<(), LawError> {
    let h = 10e3;
    for steps in [1, 4, 25] {
        let mut point = Point::new(perfect()?.with_kinematic(h)?);
        for step in 1..=steps {
            let eps = STRAIN + 4.0 * STRAIN * f64::from(step) / f64::from(steps);
            assert_relative_eq!(point.pull_to(eps), hardened(h, eps), max_relative = 1e-12);
        }
        // The elastic range of the reversal stays 2σ_y.
        let (top, p) = (point.stress()[0], point.state.p);
        let eps = 5.0 * STRAIN - 2.0 * STRAIN;
        let bottom = point.pull_to(eps + 1e-9 * STRAIN);
        assert_relative_eq!(bottom, top - 2.0 * YIELD, epsilon = 1e-6);
        assert_eq!(point.state.p, p);
        let further = point.pull_to(eps - STRAIN);
        let expected = top - 2.0 * YIELD - YOUNG * h / (YOUNG + h) * STRAIN;
        assert_relative_eq!(further, expected, max_relative = 1e-11);
        assert!(point.state.p > p);
    }
    Ok(())
}

/// The angle left between the stress and a constant deviatoric strain rate, that starts at a
/// right angle to a stress on the yield surface, after 2G‖Δe‖ = 2R in equal steps of backward
/// Euler.
fn angle_of_krieg(steps: u32) -> Result<f64, LawError> {
    let law = perfect()?;
    let two_g = 2.0 * law.elastic().shear_modulus();
    let radius = (2.0f64 / 3.0).sqrt() * YIELD;
    let across = Sym2::from([2.0, -1.0, -1.0, 0.0, 0.0, 0.0]) / 6f64.sqrt();
    let along = Sym2::from([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);

    let mut point = Point::new(law);
    let start = radius / two_g * across;
    point.strain_to(start);
    for step in 1..=steps {
        let size = 2.0 * radius / two_g * f64::from(step) / f64::from(steps);
        point.strain_to(start + size * along);
    }
    let s = deviator(&point.stress());
    Ok(s.dot(&across).atan2(s.dot(&along)))
}

/// Krieg and Krieg (1977): tan(β/2) = tan(β₀/2) exp(−2G‖Δe‖/R).
#[test]
fn non_proportional_path() -> Result<(), LawError> {
    let exact = 2.0 * ((0.5 * FRAC_PI_2).tan() * (-2.0f64).exp()).atan();
    assert_relative_eq!(exact, 0.269_035_990_7, epsilon = 1e-10);
    let table = [
        (1, 0.463_647_6),
        (2, FRAC_PI_8),
        (4, 0.341_750_2),
        (8, 0.308_892_6),
        (16, 0.289_959_1),
        (64, 0.274_468_5),
    ];
    for (steps, angle) in table {
        assert_relative_eq!(angle_of_krieg(steps)?, angle, epsilon = 1e-7);
    }
    let error = |steps| Ok::<_, LawError>(angle_of_krieg(steps)? - exact);
    assert_relative_eq!(error(512)? / error(1024)?, 2.0, max_relative = 5e-3);
    Ok(())
}

/// A permutation of the axes, which rounds nothing, and a rotation by 37°.
#[test]
fn change_of_axes() -> Result<(), LawError> {
    let law = perfect()?.with_isotropic(5e3)?.with_kinematic(20e3)?;
    let (sin, cos) = 37f64.to_radians().sin_cos();
    let permutation = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    for q in [permutation, turn, permutation * turn] {
        let r = rotation(&q);
        let steps = prop::collection::vec(vector::<6>(3.0 * STRAIN), 1..6);
        for_all(&steps, |steps| {
            let (mut point, mut turned) = (Point::new(law.clone()), Point::new(law.clone()));
            for d_eps in steps {
                point.strain_to(point.strain + d_eps);
                turned.strain_to(r * point.strain);
                let (expected, stress) = (r * point.stress(), turned.stress());
                // Strains of size ε are known to 10⁻¹⁶ ε only, stresses thus to E times that.
                let round_off = 1e-13 * (YIELD + YOUNG * point.strain.norm());
                prop_assert!((expected - stress).norm() <= round_off);
            }
            Ok(())
        });
    }
    Ok(())
}
