//! Contact patch test: a uniform pressure passes through a plane without a flaw; not bodies of
//! different meshes.

use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mandel::Sym2;
use moreau::mesh::{CellKind, Integration, NodeKind, PlaneStrain, Solid, block2, block3, uniform};
use std::f64::consts::PI;
use verification::problems::Fallible;

const PRESSURE: f64 = 80.0;
const NU: f64 = 0.3;
/// Round-off of an elastic solution.
const ROUND_OFF: f64 = 1e-12;

#[test]
fn uniform_pressure_on_a_rigid_plane_gives_consistent_reactions() -> Fallible {
    const CELLS: usize = 4;
    let width = 6.0;
    let h = width / CELLS as f64;
    for kind in [
        CellKind::Quad4,
        CellKind::Tri3,
        CellKind::Tri6,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        for rule in [Integration::Reduced, Integration::Full] {
            if rule == Integration::Reduced && matches!(kind, CellKind::Quad4 | CellKind::Quad9) {
                // Free to hourglass.
                continue;
            }
            // Distorted inside, regular on the outline.
            let mesh = block2(
                "block",
                kind,
                &uniform(0.0, width, CELLS),
                &uniform(0.0, 3.0, 3),
            )?;
            let mesh = mesh.map(|[x, y]| {
                let bump = (PI * x / width).sin() * (PI * y / 3.0).sin();
                [x + 0.2 * bump, y - 0.15 * bump]
            })?;
            let model = Model::new(mesh, PlaneStrain::default())
                .material("block", Elastic::new(210e3, NU)?, rule)?
                .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
                .contact("block.bottom", "floor", Coulomb::new(0.0)?)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let step = Step::new("press")
                .fix("block.left", &[Axis::X])
                .pressure("block.top", PRESSURE);
            driver.run(&step, 1, |_, _| {})?;

            let exact = [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0];
            let exact = Sym2::from_column_slice(&exact);
            for point in driver.points() {
                let error = (point.stress - exact).norm() / PRESSURE;
                assert!(
                    error <= ROUND_OFF,
                    "{kind} {rule:?}: stress off by {error:.2e}"
                );
            }
            // An edge passes 1/6, 2/3, 1/6 of its load, or halves; inner corners have two edges.
            let quadratic = kind.nodes() > kind.corner_count();
            let corner = if quadratic { h / 6.0 } else { h / 2.0 };
            for contact in driver.contacts() {
                let inner = contact.position[0] > 0.0 && contact.position[0] < width;
                let share = match contact.kind {
                    NodeKind::Midside => 2.0 / 3.0 * h,
                    NodeKind::Corner if inner => 2.0 * corner,
                    NodeKind::Corner => corner,
                    NodeKind::Face => panic!("an edge has no face"),
                };
                let error = (contact.t[0] / (PRESSURE * share) - 1.0).abs();
                assert!(
                    error <= 10.0 * ROUND_OFF,
                    "{kind} {rule:?}: reaction off by {error:.2e}"
                );
                assert!((contact.area / share - 1.0).abs() < 1e-14);
                assert!(contact.t[1] == 0.0 && contact.u[0].abs() < 1e-15);
                assert_ne!(contact.status, Status::Open);
            }
        }
    }
    Ok(())
}

/// Every point of the surface takes the pressure, also where the consistent loads of the nodes are
/// negative (the corners of hex20) or zero (those of tet10). Uniform stress means that the nodal
/// reactions are the consistent loads.
#[test]
fn uniform_pressure_on_a_rigid_plane_passes_through_solids() -> Fallible {
    use CellKind::{Hex8, Hex20, Hex27, Tet4, Tet10};
    use Integration::{BBar, Full, Reduced};
    let h = 2.0 / 3.0;
    // Shares of an inner corner, of the middle of an inner edge and of a face, over the square of a
    // cell; tetrahedra have edges of two kinds and corners of several, which add up.
    let hex20 = [4.0 / 20.0, 2.0 / 5.0, 0.0];
    let hex27 = [4.0 / 36.0, 2.0 / 9.0, 4.0 / 9.0];
    for (kind, rule, shares) in [
        (Tet4, Full, None),
        (Tet10, Reduced, None),
        (Hex8, Full, Some([1.0, 0.0, 0.0])),
        (Hex8, BBar, Some([1.0, 0.0, 0.0])),
        (Hex20, Reduced, Some(hex20)),
        (Hex20, Full, Some(hex20)),
        (Hex27, Full, Some(hex27)),
    ] {
        let lines = uniform(0.0, 2.0, 3);
        let mesh = block3("block", kind, &lines, &lines, &lines)?;
        let model = Model::new(mesh, Solid)
            .material("block", Elastic::new(210e3, NU)?, rule)?
            .tool("floor", Plane::new([0.0; 3], [0.0, 0.0, 1.0])?)?
            .contact("block.back", "floor", Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("press")
            .fix("block.left", &[Axis::X])
            .fix("block.bottom", &[Axis::Y])
            .pressure("block.front", PRESSURE);
        driver.run(&step, 1, |_, _| {})?;
        let exact = Sym2::from_column_slice(&[0.0, 0.0, -PRESSURE, 0.0, 0.0, 0.0]);
        for point in driver.points() {
            let error = (point.stress - exact).norm() / PRESSURE;
            assert!(
                error <= ROUND_OFF,
                "{kind} {rule:?}: stress off by {error:.2e}"
            );
        }
        let mut area = 0.0;
        for contact in driver.contacts() {
            let pressure = contact.t[0] / contact.area;
            let error = (pressure / PRESSURE - 1.0).abs();
            assert!(
                error <= 10.0 * ROUND_OFF,
                "{kind} {rule:?}: pressure off by {error:.2e}"
            );
            assert!(contact.area > 0.0 && contact.status != Status::Open);
            area += contact.area;
            if let Some(shares) = shares {
                let on_edge = |v: &&f64| **v == 0.0 || **v == 2.0;
                let edges = contact.position[..2].iter().filter(on_edge).count();
                let share = shares[contact.kind as usize] * h * h * 0.5f64.powi(edges as i32);
                assert!((contact.area / share - 1.0).abs() < 1e-13, "{kind}");
            }
        }
        assert!((area / 4.0 - 1.0).abs() < 1e-13, "{kind}");
    }
    Ok(())
}
