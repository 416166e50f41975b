//! What a converged state gives reason to doubt, against known answers: sizes of strains and rotations,
//! the loads of Euler, gaps before anything moves, tools between nodes, work across a gap.

use moreau_contact::{Ball, Obstacle, Plane, Polyline};
use moreau_driver::{
    Analysis, Axis, Buckling, Deformation, Driver, IncrementError, Model, Settings, Step,
};
use moreau_laws::{Coulomb, Elastic, VonMises};
use moreau_mesh::{
    Axisymmetric, CellKind, Facet, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use std::f64::consts::PI;

const YOUNG: f64 = 1000.0;

/// Without contraction sideways: a bar.
fn bar() -> Elastic {
    Elastic::new(YOUNG, 0.0).expect("valid")
}

fn coulomb(mu: f64) -> Coulomb {
    Coulomb::new(mu).expect("valid")
}

fn grid(kind: CellKind, size: [f64; 2], cells: [usize; 2]) -> Mesh<2> {
    let [x, y] = [0, 1].map(|i| uniform(0.0, size[i], cells[i]));
    block2("b", kind, &x, &y).expect("valid")
}

fn driver<const D: usize, H: Analysis<D>>(
    mesh: Mesh<D>,
    hypothesis: H,
    more: impl FnOnce(Model<D, H>) -> Model<D, H>,
) -> Driver<D> {
    let rule = mesh.kind(0).integration();
    let model = Model::new(mesh, hypothesis)
        .material("b", bar(), rule)
        .expect("valid");
    Driver::new(more(model), Settings::default()).expect("valid")
}

/// Every row of nodes of a block moved in proportion to its height, at its top by `top`.
fn sheared(top: [f64; 2]) -> Driver<2> {
    let mut mesh = grid(CellKind::Quad4, [4.0, 2.0], [4, 2]);
    let mut step = Step::new("shear");
    for row in 0..3 {
        let (name, y) = (format!("row {row}"), f64::from(row));
        mesh.node_group_where(&name, "b", |x| (x[1] - y).abs() < 1e-9)
            .expect("a row");
        step = step.displace(&name, Axis::X, top[0] * y / 2.0).displace(
            &name,
            Axis::Y,
            top[1] * y / 2.0,
        );
    }
    let mut driver = driver(mesh, PlaneStrain::default(), |m| m);
    driver.run(&step, 1, |_, _| {}).expect("converges");
    driver
}

/// A uniform stretch, and a simple shear, of which half is strain and half rotation.
#[test]
fn strains_and_rotations_are_those_of_the_displacement_gradient() {
    let stretched = sheared([0.0, 0.04 * 2.0]).deformation();
    assert!((stretched.strain.largest - 0.04).abs() < 1e-12);
    assert!(stretched.strain.beyond == 0.0 && stretched.rotation.largest < 1e-12);
    assert_eq!(stretched.inverted, []);
    let stretched = sheared([0.0, -0.06 * 2.0]).deformation();
    assert!((stretched.strain.largest - 0.06).abs() < 1e-12);
    assert_eq!(stretched.strain.beyond, 1.0);

    for (shear, beyond) in [(0.34, 0.0), (0.36, 1.0)] {
        let Deformation {
            strain, rotation, ..
        } = sheared([2.0 * shear, 0.0]).deformation();
        assert!((strain.largest - shear / 2.0).abs() < 1e-12, "{strain:?}");
        assert!((rotation.largest - shear / 2.0).abs() < 1e-12);
        // 10° are 0.1745.
        assert_eq!(rotation.beyond, beyond, "{rotation:?}");
    }
}

/// Around an axis the third strain is that of the hoops, u/r.
#[test]
fn hoops_are_strained_by_the_radius_they_gain() {
    let (r, y) = (uniform(10.0, 11.0, 1), uniform(0.0, 1.0, 1));
    let mesh = block2("b", CellKind::Quad4, &r, &y).expect("valid");
    let mut ring = driver(mesh, Axisymmetric, |m| m);
    let step = Step::new("widen")
        .displace("b", Axis::X, 1.0)
        .fix("b", &[Axis::Y]);
    ring.run(&step, 1, |_, _| {}).expect("converges");
    let strain = ring.deformation().strain;
    // Largest at the inner points of the rule of 2 × 2 points, or at the one in the middle.
    let inner = 10.5 - 0.5 / 3f64.sqrt();
    let expected = [1.0 / inner, 1.0 / 10.5];
    assert!(
        expected.iter().any(|e| (strain.largest - e).abs() < 1e-12),
        "{strain:?}"
    );
}

/// A block pressed flat is one of cells without volume, and beyond that of cells turned inside out.
#[test]
fn cells_pressed_through_themselves_are_inverted() {
    assert_eq!(sheared([0.0, -1.9]).deformation().inverted, []);
    let inverted = sheared([0.0, -2.1]).deformation().inverted;
    assert_eq!(
        inverted.iter().map(|i| i.0).collect::<Vec<_>>(),
        (0..8).collect::<Vec<_>>()
    );
}

/// How the top of a column is held against buckling.
#[derive(Clone, Copy)]
enum Top {
    Free,
    Guided,
    Clamped,
}

/// A column of width 1 and height 20, pressed by a rigid plate, or by a load of the same force; the force
/// per depth and what it would buckle at.
fn column(top: Top) -> (f64, Buckling<2>) {
    let mesh = grid(CellKind::Quad8, [1.0, 20.0], [2, 20]);
    let friction = match top {
        Top::Guided => 0.0,
        _ => 10.0,
    };
    let plate = |m: Model<2, PlaneStrain>| match top {
        Top::Free => m,
        _ => m
            .tool(
                "plate",
                Plane::new([0.0, 20.0], [0.0, -1.0]).expect("valid"),
            )
            .and_then(|m| m.contact("b.top", "plate", coulomb(friction)))
            .expect("valid"),
    };
    let mut driver = driver(mesh, PlaneStrain::default(), plate);
    let step = Step::new("press").fix("b.bottom", &[Axis::X, Axis::Y]);
    let step = match top {
        Top::Free => step.pressure("b.top", 1.0),
        _ => step.tool("plate", [0.0, -0.02]),
    };
    driver.run(&step, 1, |_, _| {}).expect("converges");
    let force = driver.reaction("b.bottom").expect("a group")[1];
    assert!((force - 1.0).abs() < 1e-2, "{force}");
    (force, driver.buckling().expect("compressed"))
}

/// π² E I / ℓ² with the lengths ℓ of Euler: 2 L, L and L/2.
#[test]
fn a_column_buckles_at_the_load_of_euler() {
    let inertia = 1.0 / 12.0;
    for (top, length) in [(Top::Free, 40.0), (Top::Guided, 20.0), (Top::Clamped, 10.0)] {
        let (force, buckling) = column(top);
        let euler = PI.powi(2) * YOUNG * inertia / (length * length);
        // Shear makes it softer by P/(κ G A), which is 2 % of the shortest.
        let softer = 1.0 + euler / (YOUNG / 2.0 * 5.0 / 6.0);
        let found = buckling.load_factor * force * softer / euler;
        // Turns are the means of cells, of which the shortest has ten: (π/10)²/12 of the square is lost.
        assert!((found - 1.0).abs() < 1e-2, "ℓ = {length}: {found}");
        if buckling.load_factor < Buckling::<2>::NEAR {
            assert!(buckling.direction[0].abs() > 0.99, "sideways: {buckling:?}");
        }
    }
}

/// The same in space, about the weaker axis; what is pulled does not buckle, whatever its slenderness.
#[test]
fn a_column_in_space_buckles_about_its_weaker_axis() {
    for sign in [1.0, -1.0] {
        let [x, y, z] = [(1.0, 1), (20.0, 8), (2.0, 1)].map(|(l, n)| uniform(0.0, l, n));
        let mesh = block3("b", CellKind::Hex27, &x, &y, &z).expect("valid");
        let mut column = driver(mesh, Solid, |m| m);
        let step = Step::new("press").fix("b.bottom", &[Axis::X, Axis::Y, Axis::Z]);
        let step = step.pressure("b.top", 2.0 * sign);
        column.run(&step, 1, |_, _| {}).expect("converges");
        let found = column.buckling();
        if sign < 0.0 {
            let far = |b: Buckling<3>| b.load_factor > 10.0 * Buckling::<3>::NEAR;
            assert!(found.is_none_or(far), "{found:?}");
            continue;
        }
        let found = found.expect("compressed");
        let euler = PI.powi(2) * YOUNG * (2.0 / 12.0) / 1600.0;
        let ratio = found.load_factor * 4.0 / euler;
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
        assert!(
            found.direction[0].abs() > 0.99 && found.position[1] == 20.0,
            "{found:?}"
        );
    }
}

/// Asking for the instability changes nothing of what follows, to the bit.
#[test]
fn asking_for_buckling_leaves_no_trace() {
    let run = |ask: bool| {
        let mut driver = super::steps::on_floor([5, 2], 0.0, 0.1, Settings::default());
        let press = |depth: f64| {
            Step::new("press")
                .fix("block.left", &[Axis::X])
                .displace("punch", Axis::Y, -depth)
        };
        let mut reports = Vec::new();
        for step in [press(0.1), press(0.15)] {
            reports.extend(driver.run(&step, 2, |_, _| {}).expect("converges"));
            if ask {
                assert!(driver.buckling().is_some());
            }
        }
        let mut state = Vec::new();
        driver.write(&mut state);
        (reports, state)
    };
    assert_eq!(run(false), run(true));
}

/// A block 20 wide and 10 high with its top under a tool.
fn under(tool: impl Obstacle<2> + 'static, kind: CellKind, cells: usize) -> Driver<2> {
    driver(
        grid(kind, [20.0, 10.0], [cells, 4]),
        PlaneStrain::default(),
        |m| {
            m.tool("t", tool)
                .and_then(|m| m.contact("b.top", "t", coulomb(0.2)))
                .expect("valid")
        },
    )
}

fn pressed(mut driver: Driver<2>, depth: f64, increments: usize) -> Driver<2> {
    let step = Step::new("press")
        .fix("b.bottom", &[Axis::X, Axis::Y])
        .tool("t", [0.0, -depth]);
    driver.run(&step, increments, |_, _| {}).expect("converges");
    driver
}

/// A tip between two nodes goes in as far as it moves, and nothing resists it.
#[test]
fn a_tip_between_nodes_is_seen_as_deep_as_it_is() {
    let tip =
        |x: f64| Polyline::new(&[[x + 10.0, 20.0], [x, 10.0], [x - 10.0, 20.0]]).expect("valid");
    for kind in [CellKind::Quad4, CellKind::Quad9] {
        let cells = if kind == CellKind::Quad4 { 21 } else { 11 };
        // A quadratic facet has nodes at its quarters from there.
        let x = if kind == CellKind::Quad4 {
            10.0
        } else {
            10.0 + 5.0 / 11.0
        };
        let tipped = pressed(under(tip(x), kind, cells), 0.3, 1);
        assert_eq!(tipped.tool_force("t").expect("a tool").norm(), 0.0);
        let between = tipped.between_nodes().expect("the tip is inside");
        assert!(between.depth > 0.25 && between.depth < 0.31, "{between:?}");
        assert!((between.position[0] - x).abs() < 0.06 && between.pressed == 0.0);
        assert!((between.facet - 20.0 / cells as f64).abs() < 1e-12);
    }
}

/// A wire thinner than a facet is within the body, at the surface and beneath it.
#[test]
fn a_tool_smaller_than_a_facet_is_seen_behind_it() {
    for depth in [0.7, 1.5, 3.0] {
        let wire = Ball::new([6.1, 10.3], 0.3).expect("valid");
        let driver = pressed(under(wire, CellKind::Quad8, 4), depth, 1);
        let between = driver.between_nodes().expect("the wire is inside");
        // No farther than the cells at the surface are high.
        let expected = depth.min(2.5);
        assert!(
            (between.depth - expected).abs() < 0.05,
            "{depth}: {between:?}"
        );
        assert_eq!(driver.contact_name(between.contact), ("b.top", "t"));
    }
}

/// The bow of a cylinder over a facet is what discretisation leaves, and no tool between nodes.
#[test]
fn the_bow_of_a_round_tool_is_no_tool_between_nodes() {
    for (kind, radius) in [
        (CellKind::Quad4, 10.0),
        (CellKind::Quad8, 10.0),
        (CellKind::Quad4, 50.0),
    ] {
        // Over a node and over the middle of a facet.
        for x in [10.0, 10.5] {
            let cylinder = Ball::new([x, 10.0 + radius], radius).expect("valid");
            for depth in [0.005, 0.05, 0.3] {
                let driver = pressed(under(cylinder, kind, 20), depth, 1);
                assert_eq!(driver.between_nodes(), None, "{radius} {x} {depth}");
            }
        }
    }
    // Nor are nodes that are held within a plane.
    let floor = Plane::new([0.0, 9.0], [0.0, -1.0]).expect("valid");
    let mut held = under(floor, CellKind::Quad4, 20);
    let step = Step::new("hold").fix("b", &[Axis::X, Axis::Y]);
    held.run(&step, 1, |_, _| {}).expect("converges");
    assert_eq!(held.between_nodes(), None);
}

/// A side of serendipity cells that bows towards a plane, in the mesh: the node at its lowest bears from h²/(12 R) away, with
/// edges of length h and a radius R.
#[test]
fn a_curved_side_that_bears_on_what_it_does_not_reach_is_told() {
    let ahead = |radius: f64| {
        let [x, y, z] =
            [4.0, 1.0, 2.0].map(|size| uniform(0.0, size, if size == 4.0 { 2 } else { 1 }));
        let mesh = block3("b", CellKind::Hex20, &x, &y, &z).expect("valid");
        let bow = |x: f64| (x - 1.0).powi(2) / (2.0 * radius);
        let mesh = mesh.map(|[x, y, z]| [x, y + bow(x), z]).expect("valid");
        let away = 4.0 / (12.0 * radius);
        let floor = Plane::new([0.0, -away, 0.0], [0.0, 1.0, 0.0]).expect("valid");
        let mut driver = driver(mesh, Solid, |m| {
            m.tool("t", floor)
                .and_then(|m| m.contact("b.bottom", "t", coulomb(0.2)))
                .expect("valid")
        });
        let step = Step::new("press")
            .fix("b.top", &[Axis::X, Axis::Y, Axis::Z])
            .tool("t", [0.0, 0.001, 0.0]);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        assert!(driver.tool_force("t").expect("a tool").norm() > 0.01);
        (driver.bears_ahead(), away)
    };
    let (told, away) = ahead(6.0);
    let told = told.expect("it bears");
    assert!(
        (told.distance - away).abs() < 0.0012 && (told.position[0] - 1.0).abs() < 1e-3,
        "{told:?}"
    );
    let (flat, _) = ahead(1e6);
    assert_eq!(flat, None);
}

/// A side that meets a die at less than a right angle has nothing of the die behind it, however near to the corner: what is
/// there is behind the top, which touches.
#[test]
fn a_side_that_leans_over_has_no_die_behind_it() {
    let lean = |x: f64, y: f64| x * (1.0 + 0.02 * y);
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        let mesh = grid(kind, [20.0, 10.0], [4, 2]);
        let mut mesh = mesh.map(|[x, y]| [lean(x, y), y]).expect("valid");
        let all = ["b.top", "b.right"].map(|side| mesh.facet_group(side).expect("a side").to_vec());
        mesh.add_facet_group("all", all.concat()).expect("new");
        let die = Plane::new([0.0, 10.0], [0.0, -1.0]).expect("valid");
        let die = driver(mesh, PlaneStrain::default(), |m| {
            m.tool("t", die)
                .and_then(|m| m.contact("all", "t", coulomb(0.2)))
                .expect("valid")
        });
        let driver = pressed(die, 0.1, 1);
        assert!(driver.tool_force("t").expect("a tool")[1] < -1.0);
        assert_eq!(driver.between_nodes(), None, "{kind:?}");
    }
    let side = uniform(0.0, 4.0, 2);
    let mesh = block3("b", CellKind::Hex20, &side, &side, &side).expect("valid");
    let mut mesh = mesh
        .map(|[x, y, z]| [lean(x, y), y, lean(z, y)])
        .expect("valid");
    let all =
        ["b.top", "b.right", "b.front"].map(|s| mesh.facet_group(s).expect("a side").to_vec());
    mesh.add_facet_group("all", all.concat()).expect("new");
    let die = Plane::new([0.0, 4.0, 0.0], [0.0, -1.0, 0.0]).expect("valid");
    let mut driver = driver(mesh, Solid, |m| {
        m.tool("t", die)
            .and_then(|m| m.contact("all", "t", coulomb(0.2)))
            .expect("valid")
    });
    let step = Step::new("press")
        .fix("b.bottom", &[Axis::X, Axis::Y, Axis::Z])
        .tool("t", [0.0, -0.05, 0.0]);
    driver.run(&step, 1, |_, _| {}).expect("converges");
    assert_eq!(driver.between_nodes(), None);
}

/// In space: a ball between the nodes of a face, and one that presses on it.
#[test]
fn a_ball_between_the_nodes_of_a_face_is_seen() {
    for (x, radius, seen) in [(1.0, 0.4, true), (0.0, 20.0, false)] {
        let side = uniform(0.0, 4.0, 2);
        let mesh = block3("b", CellKind::Hex8, &side, &side, &side).expect("valid");
        let ball = Ball::new([x, 4.0 + radius, x], radius).expect("valid");
        let mut driver = driver(mesh, Solid, |m| {
            m.tool("t", ball)
                .and_then(|m| m.contact("b.top", "t", coulomb(0.2)))
                .expect("valid")
        });
        let step = Step::new("press")
            .fix("b.bottom", &[Axis::X, Axis::Y, Axis::Z])
            .tool("t", [0.0, -0.3, 0.0]);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        let between = driver.between_nodes();
        assert_eq!(between.is_some(), seen, "{between:?}");
        if let Some(between) = between {
            assert!((between.depth - 0.3).abs() < 0.02, "{between:?}");
        }
    }
}

/// Gaps before anything moves: of a tool, less what the contact keeps away.
#[test]
fn the_least_gap_of_a_tool_is_its_distance() {
    for (height, offset) in [(10.4, 0.0), (9.5, 0.0), (10.4, 1.0)] {
        let model = Model::new(
            grid(CellKind::Quad8, [20.0, 10.0], [20, 4]),
            PlaneStrain::default(),
        )
        .material("b", bar(), Integration::Reduced)
        .and_then(|m| m.tool("t", Ball::new([7.0, height + 5.0], 5.0).expect("valid")))
        .and_then(|m| m.contact("b.top", "t", coulomb(0.2)))
        .and_then(|m| m.gap_offset(offset))
        .expect("valid");
        let driver = Driver::new(model, Settings::default()).expect("valid");
        let gaps = driver.least_gaps();
        assert_eq!(gaps.len(), 1);
        let expected = height - 10.0 - offset;
        assert!((gaps[0].gap - expected).abs() < 1e-12, "{gaps:?}");
        assert_eq!(gaps[0].position, [7.0, 10.0]);
        assert!(
            gaps[0].met && (gaps[0].inside > 0) == (expected < 0.0),
            "{gaps:?}"
        );
        // Of deeper ones there are fewer, the last at the least gap.
        let inside = |depth: f64| driver.nodes_within(0, depth);
        assert_eq!(gaps[0].inside, inside(driver.rounding_of_gaps()));
        assert_eq!((inside(-expected - 1e-9), inside(-expected + 1e-9)), (1, 0));
    }
}

/// Bodies that overlap, less deep than a facet is long and deeper, and bodies apart; with nodes within the cells of the
/// other one, and on the lines between them.
#[test]
fn overlapping_bodies_are_told_by_their_depth() {
    let places = [(10.5, true), (9.8, true), (8.0, false)];
    // Cells without nodes between their corners have all of them on those lines.
    let cells = [(CellKind::Quad8, 7), (CellKind::Quad4, 10)];
    for ((bottom, met), (kind, columns)) in places.into_iter().flat_map(|p| cells.map(|c| (p, c))) {
        let lower = grid(kind, [20.0, 10.0], [20, 10]);
        let (x, y) = (
            uniform(5.0, 15.0, columns),
            uniform(bottom, bottom + 7.0, 4),
        );
        let upper = block2("up", kind, &x, &y).expect("valid");
        let model = Model::new(
            lower.joined(upper).expect("two bodies"),
            PlaneStrain::default(),
        )
        .material("b", bar(), kind.integration())
        .and_then(|m| m.material("up", bar(), kind.integration()))
        .and_then(|m| m.contact("up.bottom", "b.top", coulomb(0.2)))
        .expect("valid");
        let driver = Driver::new(model, Settings::default()).expect("valid");
        let gap = driver.least_gaps()[0];
        assert!((gap.gap - (bottom - 10.0)).abs() < 1e-9, "{gap:?}");
        assert_eq!((gap.met, gap.inside > 0), (met, bottom < 10.0), "{gap:?}");
    }
}

/// A tool that comes from afar within one increment does no work on its way: an elastic body without friction
/// has stored all of it.
#[test]
fn a_tool_does_no_work_across_a_gap() {
    for gap in [0.0, 1.0, 100.0] {
        let cylinder = Ball::new([10.0, 20.0 + gap], 10.0).expect("valid");
        let model = Model::new(
            grid(CellKind::Quad4, [20.0, 10.0], [20, 10]),
            PlaneStrain::default(),
        )
        .material("b", bar(), Integration::Full)
        .and_then(|m| m.tool("t", cylinder))
        .and_then(|m| m.contact("b.top", "t", coulomb(0.0)))
        .expect("valid");
        let driver = Driver::new(model, Settings::default()).expect("valid");
        let driver = pressed(driver, gap + 0.2, 1);
        let e = driver.energies();
        assert!(e.stored > 0.0);
        // Nodes close one after the other, and on a round tool their normals turn.
        assert!(e.imbalance().abs() < 0.1 * e.stored, "{gap}: {e:?}");
    }
}

/// What numbers do not hold is no result: the increment fails, and nothing has changed.
#[test]
fn a_state_beyond_all_numbers_is_refused() {
    let mut driver = driver(
        grid(CellKind::Quad8, [4.0, 2.0], [2, 1]),
        PlaneStrain::default(),
        |m| m,
    );
    let step = |u: f64| {
        Step::new("pull")
            .fix("b.bottom", &[Axis::X, Axis::Y])
            .displace("b.top", Axis::Y, u)
    };
    let error = driver
        .run(&step(1e300), 1, |_, _| {})
        .expect_err("no result");
    let IncrementError::Stopped { cause, .. } = &error else {
        panic!("{error}")
    };
    assert!(
        matches!(**cause, IncrementError::NotFinite { .. }),
        "{cause}"
    );
    assert!(error.to_string().contains("beyond anything"), "{error}");
    assert_eq!(driver.increments(), 0);
    driver.run(&step(1e-3), 1, |_, _| {}).expect("converges");
}

/// The side of a billet that comes to lie on its platen passes through it where only the top has a contact, which is told;
/// with a contact of the side too nothing is, nor of a top that is pressed in part by a platen that is told as a plane.
#[test]
fn sides_that_come_to_lie_on_a_tool_are_told() {
    let upset = |sides: &[&str], width: f64, by: f64| {
        let (x, y) = (uniform(0.0, 5.0, 8), uniform(0.0, 5.0, 8));
        let mut mesh = block2("b", CellKind::Quad4, &x, &y).expect("valid");
        let sides: Vec<Facet> = (sides.iter())
            .flat_map(|g| mesh.facet_group(g).expect("there").to_vec())
            .filter(|&f| mesh.facet_nodes(f).all(|a| mesh.nodes()[a][0] <= width))
            .collect();
        mesh.add_facet_group("pressed", sides).expect("a new name");
        let steel = VonMises::new(70e3, 0.33, 100.0).and_then(|l| l.with_isotropic(100.0));
        let model = Model::with_large_strains(mesh, Axisymmetric)
            .material("b", steel.expect("valid"), Integration::BBar)
            .and_then(|m| {
                m.tool(
                    "platen",
                    Plane::new([0.0, 5.0], [0.0, -1.0]).expect("valid"),
                )
            })
            .and_then(|m| m.contact("pressed", "platen", coulomb(0.4)))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("upset")
            .fix("b.left", &[Axis::X])
            .fix("b.bottom", &[Axis::Y])
            .tool("platen", [0.0, -by]);
        driver.run(&step, 20, |_, _| {}).expect("converges");
        driver.beside_contacts()
    };
    let told = upset(&["b.top"], 9.0, 2.5).expect("the side is told");
    assert!(
        told.contact == 0 && told.count > 0 && told.depth > 0.05,
        "{told:?}"
    );
    assert_eq!(upset(&["b.top", "b.right"], 9.0, 2.5), None);
    assert_eq!(upset(&["b.top"], 2.6, 0.3), None);
}
