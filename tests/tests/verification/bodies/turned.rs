//! Two bodies under large strains that are pressed together and turned by a right angle: nothing but the frame changes.

use super::*;
use moreau::mandel::to_matrix;
use moreau::mesh::Solid;

use CellKind::{Hex8, Hex20, Quad4, Quad8, Tri6};

const CLOSED: f64 = 0.6;
/// Increments of the right angle, in the plane and in space.
const TURNS: [usize; 2] = [6, 3];

/// Steel with hardening.
fn pressed<H: Blocks<D>, const D: usize>(stack: Stack<H, D>) -> Stack<H, D> {
    Stack {
        yield_stress: Some(300.0),
        large: Some(500.0),
        ..stack
    }
}

/// The rotation by a part of the right angle.
fn rotation<const D: usize>(part: f64) -> SMatrix<f64, D, D> {
    let angle = 0.5 * PI * part;
    let axis = match D {
        2 => Vector3::z(),
        _ => Vector3::new(1.0, 2.0, -0.5),
    };
    let all = Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle).into_inner();
    SMatrix::from_fn(|i, j| all[(i, j)])
}

/// Uniaxial compression that is the same everywhere, in pressures and stresses, and its pressure.
fn state<const D: usize>(driver: &Driver<D>, turn: &SMatrix<f64, D, D>, what: &str) -> f64 {
    let in_frame = |stress: &Sym2| {
        let turn = Matrix3::from_fn(|i, j| match i < D && j < D {
            true => turn[(i, j)],
            false => f64::from(u8::from(i == j)),
        });
        turn.transpose() * to_matrix(stress) * turn
    };
    let points = driver.points();
    let first = in_frame(&points[0].stress);
    let pressure = -first[(1, 1)];
    for point in &points {
        let off = (in_frame(&point.stress) - first).norm();
        assert!(off <= 1e-9 * pressure, "{what}: {off:e} of {pressure}");
    }
    for c in driver.contacts() {
        close(what, c.t[0] / c.area, pressure, 1e-9);
        let shear = c.t.rows(1, D - 1).norm();
        assert!(shear <= 1e-9 * pressure * c.area, "{what}: {shear:e}");
        let slip = c.u.rows(1, D - 1).norm();
        assert!(slip <= 1e-9 * CLOSED, "{what}: slip {slip:e}");
    }
    pressure
}

/// Squeezes a stack, then turns both of its ends by a right angle.
fn turned<H: Blocks<D>, const D: usize>(stack: &Stack<H, D>) -> Fallible {
    let what = stack.what();
    let settings = Settings {
        // Pressures are asked for more exactly than forces are by default.
        tolerance: 1e-12,
        ..Settings::default()
    };
    let mut driver = stack.driver(stack.mesh()?, settings)?;
    let squeeze = stack
        .held("squeeze")
        .displace("upper.top", Axis::Y, -CLOSED);
    driver.run(&squeeze, 4, |_, _| {})?;
    let pressure = state(&driver, &SMatrix::identity(), &what);
    let nodes = driver.mesh().nodes().to_vec();
    let at = |driver: &Driver<D>, a: usize| SVector::from(nodes[a]) + driver.displacement(a);
    let straight: Vec<SVector<f64, D>> = (0..nodes.len()).map(|a| at(&driver, a)).collect();
    let mut ends = driver.mesh().node_group("lower.bottom")?;
    ends.extend(driver.mesh().node_group("upper.top")?);
    let mut end = driver.applied().clone();
    end.displacement.clear();
    let turns = TURNS[D - 2];
    for k in 1..=turns {
        let turn = rotation::<D>(k as f64 / turns as f64);
        for &a in &ends {
            let displacement = turn * straight[a] - SVector::from(nodes[a]);
            (0..D).for_each(|i| _ = end.displacement.insert(D * a + i, displacement[i]));
        }
        driver.advance(&end)?;
        close(&what, state(&driver, &turn, &what), pressure, 1e-9);
        for a in 0..nodes.len() {
            let off = (at(&driver, a) - turn * straight[a]).norm();
            assert!(off <= 1e-9 * HEIGHT, "{what}: node {a} is {off:e} mm off");
        }
    }
    Ok(())
}

#[test]
fn what_is_pressed_and_turned_in_the_plane_is_as_if_it_were_not_turned() -> Fallible {
    for (kinds, swapped, friction) in [
        ([Quad8, Quad8], false, 0.0),
        ([Quad8, Quad8], true, 0.3),
        ([Quad4, Quad8], false, 0.3),
        ([Tri6, Quad4], true, 0.3),
    ] {
        let stack = Stack::<PlaneStrain, 2>::new(kinds, [[5, 2], [4, 2]]);
        turned(&pressed(Stack {
            swapped,
            friction,
            ..stack
        }))?;
    }
    Ok(())
}

#[test]
fn what_is_pressed_and_turned_in_space_is_as_if_it_were_not_turned() -> Fallible {
    for (kinds, swapped) in [([Hex8, Hex8], true), ([Hex20, Hex8], false)] {
        let stack = Stack::<Solid, 3>::new(kinds, [[2, 1, 1], [1, 1, 2]]);
        let friction = 0.3;
        turned(&pressed(Stack {
            swapped,
            friction,
            ..stack
        }))?;
    }
    Ok(())
}
