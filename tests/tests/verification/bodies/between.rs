//! Bodies that touch more than one other, and pairs that make no sense.

use super::*;
use moreau::mesh::Solid;

/// Three bodies, two pairs; the middle one is held by its contacts alone.
#[test]
fn a_pressure_passes_through_a_body_between_two_others() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(bodies: [(CellKind, usize); 3]) -> Fallible {
        let names = ["low", "middle", "high"];
        for middle_first in [false, true] {
            let block = |k: usize| {
                let (kind, n) = bodies[k];
                let lines = from_fn(|axis| match axis {
                    0 => uniform(0.0, WIDTH, n),
                    1 => uniform(k as f64, 1.0 + k as f64, 1),
                    _ => uniform(0.0, DEPTH, n - 1),
                });
                H::block(names[k], kind, &lines)
            };
            let mesh = block(0)?.joined(block(1)?)?.joined(block(2)?)?;
            let mut pairs = [("middle.bottom", "low.top"), ("high.bottom", "middle.top")];
            if middle_first {
                pairs[1] = (pairs[1].1, pairs[1].0);
            }
            let mut model = Model::new(mesh, H::default());
            for (name, (kind, _)) in names.into_iter().zip(bodies) {
                model = model.material(name, Elastic::new(E, NU)?, kind.integration())?;
            }
            for (own, other) in pairs {
                model = model.contact(own, other, Coulomb::new(0.3)?)?;
            }
            let mut driver = Driver::new(model, Settings::default())?;
            let mut step = Step::new("press")
                .fix("low.bottom", &[Axis::Y])
                .pressure("high.top", PRESSURE);
            for (side, _, axis) in sides::<D>() {
                step = step.fix(&format!("low.{side}"), &[axis]);
            }
            driver.run(&step, 1, |_, _| {})?;
            uniform_stress(&driver, squeezed::<H, D>(), "through the middle");
            let middle = driver.contact_force("middle")?;
            let most = 1e-10 * PRESSURE * H::FOOTPRINT;
            assert!(middle.norm() <= most, "{middle}");
        }
        Ok(())
    }
    use CellKind::{Hex8, Hex20, Quad4, Quad8, Tet4, Tet10, Tri6};
    check::<PlaneStrain, 2>([(Quad8, 3), (Quad4, 5), (Tri6, 4)])?;
    check::<Solid, 3>([(Hex8, 3), (Hex8, 4), (Tet4, 3)])?;
    check::<Solid, 3>([(Hex8, 2), (Hex20, 3), (Tet10, 2)])
}

/// The corner of a block is a contact point on the floor, and opposite to those of a wall.
#[test]
fn a_block_in_a_corner_is_held_by_two_other_bodies() -> Fallible {
    const SIDE: f64 = 3.0;
    const PUSH: f64 = 30.0;
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        let block = |name: &str, x: [f64; 2], y: [f64; 2], n: usize| {
            block2(name, kind, &uniform(x[0], x[1], n), &uniform(y[0], y[1], n))
        };
        let mut mesh = block("block", [0.0, SIDE], [0.0, SIDE], 3)?
            .joined(block("floor", [0.0, SIDE], [-1.0, 0.0], 4)?)?
            .joined(block("wall", [-1.0, 0.0], [0.0, SIDE], 2)?)?;
        mesh.node_group_where("foot", "wall.left", |x| x[1] == 0.0)?;
        let law = Coulomb::new(0.0)?;
        let mut model = Model::new(mesh, PlaneStrain::default());
        for name in ["block", "floor", "wall"] {
            model = model.material(name, Elastic::new(E, NU)?, kind.integration())?;
        }
        let model = model.contact("block.bottom", "floor.top", law)?.contact(
            "wall.right",
            "block.left",
            law,
        )?;
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("push")
            .fix("floor.bottom", &[Axis::Y])
            .fix("floor.left", &[Axis::X])
            .fix("wall.left", &[Axis::X])
            .fix("foot", &[Axis::Y])
            .pressure("block.top", PRESSURE)
            .pressure("block.right", PUSH);
        driver.run(&step, 1, |_, _| {})?;
        for point in driver.points() {
            let [x, y] = point.position;
            let x_stress = if y > 0.0 { -PUSH } else { 0.0 };
            let y_stress = if x > 0.0 { -PRESSURE } else { 0.0 };
            let z_stress = NU * (x_stress + y_stress);
            let exact = Sym2::from_column_slice(&[x_stress, y_stress, z_stress, 0.0, 0.0, 0.0]);
            let error = (point.stress - exact).norm() / PRESSURE;
            assert!(
                error <= 1e-10,
                "{kind}: stress off by {error:.2e} at {x}, {y}"
            );
        }
    }
    Ok(())
}

#[test]
fn pairs_that_make_no_sense_are_refused() -> Fallible {
    let law = Coulomb::new(0.1)?;
    let stack = Stack::<PlaneStrain, 2>::new([CellKind::Quad4; 2], [[2, 2], [3, 2]]);
    let model = || -> Fallible<Model<2, PlaneStrain>> {
        Ok(Model::new(stack.mesh()?, PlaneStrain::default()))
    };
    match model()?.contact("upper.bottom", "lower.tip", law).err() {
        Some(ModelError::UnknownOpposite { nearest, .. }) => {
            assert_eq!(nearest.as_deref(), Some("lower.top"));
        }
        other => return Err(format!("{other:?}").into()),
    }
    match model()?.contact("upper.bottom", "upper.left", law).err() {
        Some(ModelError::SharedSurfaceNode { position, .. }) => assert_eq!(position, [0.0, 0.0]),
        other => return Err(format!("{other:?}").into()),
    }
    // A body that flew off is not held: without an overlap there is no contact.
    let mut apart = stack.clone();
    apart.lines[0][0] = uniform(0.0, 1.0, 2);
    apart.lines[1][0] = uniform(2.0, 3.0, 2);
    let mut driver = apart.driver(apart.mesh()?, Settings::default())?;
    let step = Step::new("press")
        .fix("upper.left", &[Axis::X])
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .pressure("upper.top", PRESSURE);
    let error = driver.run(&step, 1, |_, _| {}).err();
    assert!(error.is_some_and(|e| e.to_string().contains("free to move")));
    Ok(())
}
