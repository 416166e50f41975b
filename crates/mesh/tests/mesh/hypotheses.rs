//! Strains of rigid motions and of linear displacement fields on distorted cells.

use crate::ROUND_OFF;
use approx::{assert_abs_diff_eq, assert_relative_eq};
use moreau_mandel::{Sym2, from_matrix};
use moreau_mesh::{
    Axisymmetric, Element, Hex8, Hex20, Hex27, Hypothesis, MeshError, PlaneStrain, Quad4, Quad8,
    Quad9, Solid, Tet4, Tet10, Tri3, Tri6,
};
use nalgebra::{Matrix3, SVector};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Numbers that make a cell and a field on it: shifts of the nodes, a displacement gradient.
fn numbers<const K: usize>() -> impl Strategy<Value = [f64; K]> {
    [(); K].map(|()| -1.0..1.0)
}

/// Reference nodes moved a little, then to radii above 1.
fn moved<const D: usize, const N: usize, E: Element<D, N>>(shifts: &[f64; 24]) -> [[f64; D]; N] {
    std::array::from_fn(|a| {
        std::array::from_fn(|i| 3.0 + E::NODES[a][i] + 0.03 * shifts[(a * D + i) % 24])
    })
}

/// Strain at ξ of the displacement field u, interpolated: ε = Σ B_a u(x_a), [77].
fn strain<const D: usize, const N: usize, E: Element<D, N>, H: Hypothesis<D>>(
    nodes: &[[f64; D]; N],
    xi: [f64; D],
    u: impl Fn(&[f64; D]) -> [f64; D],
) -> Sym2 {
    let at = E::map(nodes, xi);
    (0..N)
        .map(|a| {
            H::strain_operator(at.shape[a], &at.gradient[a], &at.x)
                * SVector::<f64, D>::from(u(&nodes[a]))
        })
        .sum()
}

fn rigid_modes_do_not_strain<const D: usize, const N: usize, E: Element<D, N>, H: Hypothesis<D>>(
    shifts: &[f64; 24],
) {
    let nodes = moved::<D, N, E>(shifts);
    for xi in E::NODES {
        for mode in 0..H::rigid_modes(&xi).len() {
            let strain = strain::<D, N, E, H>(&nodes, xi, |x| H::rigid_modes(x)[mode]);
            assert_abs_diff_eq!(strain.norm(), 0.0, epsilon = 1e3 * ROUND_OFF);
        }
    }
}

/// Strain of u = A x + (0.3, …) in the plane; the hoop strain is u_r/r under axial symmetry.
fn linear_fields_strain_exactly_in_the_plane<const N: usize, E: Element<2, N>>(
    shifts: &[f64; 24],
    a: &[f64; 9],
) {
    let nodes = moved::<2, N, E>(shifts);
    let u = |x: &[f64; 2]| {
        [
            0.3 + a[0] * x[0] + a[1] * x[1],
            0.3 + a[2] * x[0] + a[3] * x[1],
        ]
    };
    for xi in E::NODES {
        let x = E::map(&nodes, xi).x;
        let mut exact = from_matrix(&Matrix3::new(
            a[0], a[1], 0.0, a[2], a[3], 0.0, 0.0, 0.0, 0.0,
        ));
        let plane = strain::<2, N, E, PlaneStrain>(&nodes, xi, u);
        assert_abs_diff_eq!(plane, exact, epsilon = 1e3 * ROUND_OFF);
        exact[2] = u(&x)[0] / x[0];
        let axisymmetric = strain::<2, N, E, Axisymmetric>(&nodes, xi, u);
        assert_abs_diff_eq!(axisymmetric, exact, epsilon = 1e3 * ROUND_OFF);
    }
}

fn linear_fields_strain_exactly_in_space<const N: usize, E: Element<3, N>>(
    shifts: &[f64; 24],
    a: &[f64; 9],
) {
    let nodes = moved::<3, N, E>(shifts);
    let u = |x: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| 0.3 + (0..3).map(|j| a[3 * i + j] * x[j]).sum::<f64>())
    };
    let exact = from_matrix(&Matrix3::from_row_slice(a));
    for xi in E::NODES {
        let strain = strain::<3, N, E, Solid>(&nodes, xi, u);
        assert_abs_diff_eq!(strain, exact, epsilon = 1e3 * ROUND_OFF);
    }
}

proptest! {
    #[test]
    fn rigid_motions_do_not_strain(s in numbers::<24>()) {
        rigid_modes_do_not_strain::<2, 3, Tri3, PlaneStrain>(&s);
        rigid_modes_do_not_strain::<2, 6, Tri6, PlaneStrain>(&s);
        rigid_modes_do_not_strain::<2, 4, Quad4, PlaneStrain>(&s);
        rigid_modes_do_not_strain::<2, 8, Quad8, PlaneStrain>(&s);
        rigid_modes_do_not_strain::<2, 9, Quad9, PlaneStrain>(&s);
        rigid_modes_do_not_strain::<2, 3, Tri3, Axisymmetric>(&s);
        rigid_modes_do_not_strain::<2, 8, Quad8, Axisymmetric>(&s);
        rigid_modes_do_not_strain::<3, 4, Tet4, Solid>(&s);
        rigid_modes_do_not_strain::<3, 10, Tet10, Solid>(&s);
        rigid_modes_do_not_strain::<3, 8, Hex8, Solid>(&s);
        rigid_modes_do_not_strain::<3, 20, Hex20, Solid>(&s);
        rigid_modes_do_not_strain::<3, 27, Hex27, Solid>(&s);
    }

    #[test]
    fn linear_fields_have_their_exact_strain(s in numbers::<24>(), a in numbers::<9>()) {
        linear_fields_strain_exactly_in_the_plane::<3, Tri3>(&s, &a);
        linear_fields_strain_exactly_in_the_plane::<6, Tri6>(&s, &a);
        linear_fields_strain_exactly_in_the_plane::<4, Quad4>(&s, &a);
        linear_fields_strain_exactly_in_the_plane::<8, Quad8>(&s, &a);
        linear_fields_strain_exactly_in_the_plane::<9, Quad9>(&s, &a);
        linear_fields_strain_exactly_in_space::<4, Tet4>(&s, &a);
        linear_fields_strain_exactly_in_space::<10, Tet10>(&s, &a);
        linear_fields_strain_exactly_in_space::<8, Hex8>(&s, &a);
        linear_fields_strain_exactly_in_space::<20, Hex20>(&s, &a);
        linear_fields_strain_exactly_in_space::<27, Hex27>(&s, &a);
    }
}

#[test]
fn rigid_modes_are_as_many_as_the_hypothesis_allows() {
    assert_eq!(PlaneStrain::rigid_modes(&[1.0, 2.0]).len(), 3);
    assert_eq!(Axisymmetric::rigid_modes(&[1.0, 2.0]), [[0.0, 1.0]]);
    assert_eq!(Solid::rigid_modes(&[1.0, 2.0, 3.0]).len(), 6);
}

#[test]
fn measures_are_thickness_circumference_and_one() {
    let slice = PlaneStrain::new(2.5).expect("a positive thickness is valid");
    assert_eq!(slice.measure(&[7.0, 8.0]), slice.thickness());
    assert_eq!(PlaneStrain::default().measure(&[7.0, 8.0]), 1.0);
    assert_relative_eq!(Axisymmetric.measure(&[3.0, 8.0]), 6.0 * PI);
    assert_eq!(Solid.measure(&[7.0, 8.0, 9.0]), 1.0);
}

#[test]
fn a_thickness_must_be_positive_and_finite() {
    for value in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(PlaneStrain::new(value), Err(MeshError::Thickness { value }));
    }
    let error = PlaneStrain::new(f64::NAN).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the thickness is NaN mm: it must be positive and finite"
    );
}
