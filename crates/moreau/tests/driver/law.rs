//! What the balance of forces does not see: a gap that the linearised contact did not foresee, and where
//! the multipliers of held nodes go.

use moreau_contact::Polyline;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic, Status};
use moreau_mesh::{CellKind, PlaneStrain, block2, uniform};

/// A block on a floor is pushed towards a wall that its last node has not seen: without a force it is
/// in balance inside the wall, and the law alone says no.
#[test]
fn a_block_that_is_pushed_into_a_wall_stops_there() {
    let (x, y) = (uniform(0.0, 10.0, 4), uniform(0.0, 4.0, 2));
    let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
    let kind = mesh.kind(0);
    let floor_and_wall = Polyline::new(&[[-50.0, 0.0], [12.0, 0.0], [12.0, 50.0]]);
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "block",
            Elastic::new(1000.0, 0.3).expect("valid"),
            kind.integration(),
        )
        .and_then(|m| m.tool("groove", floor_and_wall.expect("valid")))
        .and_then(|m| m.contact("block.bottom", "groove", Coulomb::new(0.0).expect("valid")))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let push =
        Step::new("push")
            .fix("block.bottom", &[Axis::Y])
            .displace("block.left", Axis::X, 2.5);
    let reports = driver.run(&push, 1, |_, _| {}).expect("converges");
    assert_eq!((reports.len(), reports[0].cuts), (1, 0));
    assert!(
        reports[0].certificate.penetration < 1e-12,
        "{:?}",
        reports[0]
    );
    let last = driver
        .contacts()
        .iter()
        .find(|c| c.position == [10.0, 0.0] && c.status != Status::Open)
        .expect("the corner touches the wall");
    assert!((driver.displacement(last.node)[0] - 2.0).abs() < 1e-12);
    assert!(driver.tool_force("groove").expect("exists")[0] < -1.0);
}

/// The multiplier of a node that is held goes to those beside it by the inverse squares of their
/// distances: of 1.5 mm², four fifths over 1 mm and one over 2 mm.
#[test]
fn a_held_node_leaves_its_area_to_the_nearer_of_its_neighbours() {
    let x = [0.0, 1.0, 3.0, 6.0];
    let block = |name, y: [f64; 2]| block2(name, CellKind::Quad4, &x, &uniform(y[0], y[1], 1));
    let mut mesh = block("upper", [0.0, 1.0])
        .and_then(|m| m.joined(block("lower", [-1.0, 0.0])?))
        .expect("valid");
    mesh.node_group_where("pin", "upper.bottom", |x| x[0] == 1.0)
        .expect("a node");
    let steel = || Elastic::new(210e3, 0.3).expect("valid");
    let rule = CellKind::Quad4.integration();
    let model = Model::new(mesh, PlaneStrain::default())
        .material("upper", steel(), rule)
        .and_then(|m| m.material("lower", steel(), rule))
        .and_then(|m| {
            m.contact(
                "upper.bottom",
                "lower.top",
                Coulomb::new(0.0).expect("valid"),
            )
        })
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let press = Step::new("press")
        .fix("pin", &[Axis::X, Axis::Y])
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .pressure("upper.top", 10.0);
    driver.run(&press, 1, |_, _| {}).expect("converges");
    for (x, area) in [(0.0, 0.5 + 1.2), (1.0, 0.0), (3.0, 2.5 + 0.3), (6.0, 1.5)] {
        let c = driver
            .contacts()
            .iter()
            .find(|c| c.position[0] == x)
            .expect("a node");
        assert!((c.area - area).abs() < 1e-12, "{} at {x}", c.area);
    }
}
