//! Nodes straight under sharp edges and tips of tools, on the way to them, at them and off them.

use moreau_contact::{Obstacle, Polyline, Triangulated};
use moreau_driver::{Analysis, Axis, Driver, Increments, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic};
use moreau_mesh::{CellKind, Mesh, PlaneStrain, Solid, block2, block3, uniform};
use nalgebra::{SMatrix, SVector};

const FULL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Rise of the faces of tools \[rad\].
const RISE: f64 = std::f64::consts::FRAC_PI_6;

/// An elastic block under a tool.
fn pressed<const D: usize>(
    (mesh, kind): (Mesh<D>, CellKind),
    hypothesis: impl Analysis<D>,
    (surface, tool): (&str, impl Obstacle<D> + 'static),
    (mu, large): (f64, bool),
) -> Driver<D> {
    let model = match large {
        true => Model::with_large_strains(mesh, hypothesis),
        false => Model::new(mesh, hypothesis),
    };
    let law = Elastic::new(70e3, 0.3).expect("valid");
    let model = model
        .material("b", law, kind.integration())
        .and_then(|m| m.tool("t", tool))
        .and_then(|m| m.contact(surface, "t", Coulomb::new(mu).expect("valid")))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

/// A wedge above the origin, whose end is its tip there, or as broad as twice `flat` \[mm\].
fn wedge(flat: f64) -> Polyline {
    let rise = 10.0 * RISE.tan();
    let points = [[10.0, rise], [flat, 0.0], [-flat, 0.0], [-10.0, rise]];
    let sharp = [points[0], points[1], points[3]];
    Polyline::new(if flat > 0.0 { &points } else { &sharp }).expect("valid")
}

/// A wedge along y whose edge is the axis, and a pyramid whose tip is the origin, both above it.
fn above(is_pyramid: bool) -> Triangulated {
    let (half, rise) = (10.0, 10.0 * RISE.tan());
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut points: Vec<[f64; 3]> = corners.map(|[x, y]| [x * half, y * half, rise]).into();
    let mut faces = vec![[0, 1, 2], [0, 2, 3]];
    if is_pyramid {
        points.push([0.0; 3]);
        faces.extend([[1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]);
    } else {
        points.extend([[0.0, -half, 0.0], [0.0, half, 0.0]]);
        faces.extend([
            [0, 3, 5],
            [0, 5, 4],
            [1, 4, 5],
            [1, 5, 2],
            [0, 4, 1],
            [3, 2, 5],
        ]);
    }
    Triangulated::new(&points, &faces, 0.3).expect("closed")
}

/// The block of two cells in the plane whose middle node is `gap` below the origin; `half` of it, left of its plane of
/// symmetry.
fn block(gap: f64, half: bool) -> (Mesh<2>, CellKind) {
    let x = if half {
        uniform(-1.0, 0.0, 1)
    } else {
        uniform(-1.0, 1.0, 2)
    };
    let kind = CellKind::Quad4;
    (
        block2("b", kind, &x, &[-1.0 - gap, -gap]).expect("valid"),
        kind,
    )
}

/// The same in space.
fn solid(gap: f64, [x, y]: [[f64; 2]; 2]) -> (Mesh<3>, CellKind) {
    let lines = |[low, high]: [f64; 2]| uniform(low, high, (high - low) as usize);
    let kind = CellKind::Hex8;
    (
        block3("b", kind, &lines(x), &lines(y), &[-1.0 - gap, -gap]).expect("valid"),
        kind,
    )
}

/// The force of the tool, after it has come down by 0.02 beyond a gap in some increments; at each it is along the axis that
/// is pushed along, up to rounding.
fn straight<const D: usize>(
    mut driver: Driver<D>,
    held: &[(&str, &[Axis])],
    gap: f64,
    count: usize,
) -> f64 {
    let down = std::array::from_fn(|i| if i + 1 == D { -0.02 - gap } else { 0.0 });
    let step = Step::new("press").tool("t", down);
    let step = held
        .iter()
        .fold(step, |step, (on, axes)| step.fix(on, axes));
    driver
        .run(&step, Increments::equal(count), |driver, _| {
            let force = driver.tool_force("t").expect("exists");
            let aside = force.rows(0, D - 1).amax();
            assert!(
                aside <= 1e-8 * force[D - 1].abs().max(1.0),
                "{gap} {count}: {force}"
            );
        })
        .expect("converges");
    driver.tool_force("t").expect("exists")[D - 1]
}

/// Whatever the strains, the gap before, the increments and the friction, a wedge or a pyramid on the middle node of a block
/// is pushed back along its axis, by twice or four times what a plane of symmetry leaves of it.
#[test]
fn what_is_symmetric_is_pushed_back_along_its_axis() {
    let cases = [0.0, 0.03].map(|gap| [1, 4, 5].map(|count| (gap, count)));
    for (gap, count) in cases.concat() {
        for (mu, large) in [(0.0, false), (0.0, true), (0.1, false), (0.1, true)] {
            let case = format!("{gap} {count} {mu} {large}");
            let how = (mu, large);
            let same = |whole: f64, parts: f64| {
                let off = (whole - parts).abs();
                assert!(
                    off <= 1e-7 * whole.abs() && whole < -100.0,
                    "{case}: {whole} {parts}"
                );
            };
            let plane = |half: bool| {
                let side: (&str, &[Axis]) = if half {
                    ("b.right", &FULL[..1])
                } else {
                    ("b.bottom", &FULL[..2])
                };
                let driver = pressed(
                    block(gap, half),
                    PlaneStrain::default(),
                    ("b.top", wedge(0.0)),
                    how,
                );
                straight(driver, &[("b.bottom", &FULL[..2]), side], gap, count)
            };
            let space = |is_pyramid: bool, x: [f64; 2], y: [f64; 2], held: &[(&str, &[Axis])]| {
                let driver = pressed(
                    solid(gap, [x, y]),
                    Solid,
                    ("b.front", above(is_pyramid)),
                    how,
                );
                let held = [&[("b.back", &FULL[..])], held].concat();
                straight(driver, &held, gap, count)
            };
            let (all, left) = ([-1.0, 1.0], [-1.0, 0.0]);
            let right: (&str, &[Axis]) = ("b.right", &FULL[..1]);
            same(plane(false), 2.0 * plane(true));
            same(
                space(false, all, all, &[]),
                2.0 * space(false, left, all, &[right]),
            );
            same(
                space(true, all, all, &[]),
                2.0 * space(true, left, all, &[right]),
            );
        }
    }
}

/// The forces that take the nodes under the edge of a wedge a unit along the first and the last axis \[N/mm\], and none of
/// the rest.
fn stiffness<const D: usize>(
    (mut mesh, kind): (Mesh<D>, CellKind),
    hypothesis: impl Analysis<D> + Copy,
    tool: impl Obstacle<D> + Clone + 'static,
    bottom: &str,
) -> SMatrix<f64, 2, 2> {
    let nodes = mesh.nodes().iter().enumerate();
    let is_under = |x: &[f64; D]| x[0] == 0.0 && x[D - 1] == 0.0;
    let under: Vec<usize> = nodes.filter(|(_, x)| is_under(x)).map(|(a, _)| a).collect();
    mesh.add_node_group("under", under.clone())
        .expect("a new name");
    let columns = [[1e-3, 0.0], [0.0, 1e-3]].map(|[aside, down]| {
        let model = (mesh.clone(), kind);
        let mut driver = pressed(model, hypothesis, (bottom, tool.clone()), (0.0, false));
        let step = Step::new("move")
            .fix(bottom, &FULL[..D])
            .displace("under", Axis::X, aside)
            .displace("under", FULL[D - 1], down);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        let force: SVector<f64, D> = under.iter().map(|&a| driver.nodal_reaction(a)).sum();
        SVector::from([force[0], force[D - 1]]) / 1e-3
    });
    SMatrix::from_columns(&columns)
}

/// Drawn sideways once it presses, the edge keeps its nodes, which move with it, as long as the force that takes is one of
/// its faces and their friction; then the nodes are left behind on a face, and all its friction holds them.
fn drawn<const D: usize>(
    block: impl Fn(f64) -> (Mesh<D>, CellKind),
    hypothesis: impl Analysis<D> + Copy,
    (top, bottom): (&str, &str),
    tool: &(impl Obstacle<D> + Clone + 'static),
    mu: f64,
) {
    let stiffness = stiffness(block(0.0), hypothesis, tool.clone(), bottom);
    let soft = stiffness.try_inverse().expect("regular");
    // The largest way aside at which they are held.
    let (down, cone) = (0.02, (RISE + mu.atan()).tan());
    let held = down * cone * stiffness[(1, 1)] / stiffness[(0, 0)];
    // The normal of a face, and the force that goes with it.
    let n = SVector::from([-RISE.sin(), -RISE.cos()]);
    let e = SVector::from([(mu.atan() - RISE).tan(), -1.0]);
    let to = |aside: f64, gap: f64| {
        std::array::from_fn(|i| match i {
            0 => aside,
            i if i + 1 == D => -down - gap,
            _ => 0.0,
        })
    };
    for (gap, count) in [(0.0, 1), (0.0, 5), (0.03, 1), (0.03, 4), (0.03, 5)] {
        for part in [0.9, 1.5] {
            let mut driver = pressed(block(gap), hypothesis, (top, tool.clone()), (mu, false));
            let fixed = |name: &str| Step::new(name).fix(bottom, &FULL[..D]);
            let press = fixed("press").tool("t", to(0.0, gap));
            let draw = fixed("draw").tool("t", to(part * held, gap));
            let equal = Increments::equal(count);
            driver.run(&press, equal, |_, _| {}).expect("converges");
            let check = |driver: &Driver<D>, corners: usize| {
                let aside = driver.tool_displacement("t").expect("exists")[0];
                let force = driver.tool_force("t").expect("exists");
                let force = SVector::from([force[0], force[D - 1]]);
                let (way, stays) = (SVector::from([aside, -down]), aside < held);
                assert_eq!(corners > 0, stays, "{gap} {count} {aside}: {force}");
                // K d, and the λ e of which n·(K⁻¹ λ e) = n·d.
                let expected = match stays {
                    true => stiffness * way,
                    false => e * (n.dot(&way) / n.dot(&(soft * e))),
                };
                let off = (force - expected).norm();
                assert!(
                    off <= 1e-6 * expected.norm(),
                    "{gap} {count} {aside}: {force} {expected}"
                );
            };
            driver
                .run(&draw, equal, |driver, report| {
                    check(driver, report.corners.len())
                })
                .expect("converges");
        }
    }
}

#[test]
fn a_tip_keeps_its_node_until_a_face_with_its_friction_cannot_hold_it() {
    let block = |gap: f64| block(gap, false);
    for mu in [0.0, 0.1] {
        drawn(
            block,
            PlaneStrain::default(),
            ("b.top", "b.bottom"),
            &wedge(0.0),
            mu,
        );
    }
}

/// In space without friction: what a node slides along an edge meets none there, and some on a face.
#[test]
fn an_edge_keeps_its_nodes_until_a_face_cannot_hold_them() {
    let block = |gap: f64| solid(gap, [[-1.0, 1.0], [0.0, 1.0]]);
    drawn(block, Solid, ("b.front", "b.back"), &above(false), 0.0);
}

/// Under the edges of a pyramid, in a quarter of what it is pressed into, nodes are at both faces alike.
#[test]
fn the_edges_of_a_pyramid_do_not_choose_between_its_faces() {
    let near = [0.0, 0.02, 0.5, 1.0];
    for (gap, count) in [(0.0, 1), (0.0, 5), (0.03, 1), (0.03, 4), (0.03, 5)] {
        for (mu, large) in [(0.0, false), (0.0, true), (0.1, false), (0.1, true)] {
            let z = [-1.0 - gap, -0.3 - gap, -gap];
            let mesh = block3("b", CellKind::Hex8, &near, &near, &z).expect("valid");
            let tool = ("b.front", above(true));
            let mut driver = pressed((mesh, CellKind::Hex8), Solid, tool, (mu, large));
            let step = Step::new("press")
                .fix("b.back", &FULL)
                .fix("b.left", &FULL[..1])
                .fix("b.bottom", &FULL[1..2])
                .tool("t", [0.0, 0.0, -0.02 - gap]);
            driver
                .run(&step, Increments::equal(count), |driver, _| {
                    let force = driver.tool_force("t").expect("exists");
                    let off = (force[0] - force[1]).abs();
                    assert!(
                        off <= 1e-8 * force[2].abs().max(1.0),
                        "{gap} {count} {mu} {large}: {force}"
                    );
                })
                .expect("converges");
            let force = driver.tool_force("t").expect("exists");
            assert!(force[0] > 1.0 && force[2] < -10.0, "{force}");
        }
    }
}

/// A blunt wedge whose corner comes down through a gap beside the axis of its cone has the node under it as one that touches
/// it at first.
#[test]
fn the_corner_of_a_blunt_tool_finds_its_node_across_a_gap() {
    let pressed = |gap: f64, count: usize, how: (f64, bool)| {
        let driver = pressed(
            block(gap, false),
            PlaneStrain::default(),
            ("b.top", wedge(1.0)),
            how,
        );
        straight(driver, &[("b.bottom", &FULL[..2])], gap, count)
    };
    for how in [(0.0, false), (0.1, false), (0.1, true)] {
        let first = pressed(0.0, 1, how);
        for (gap, count) in [(0.0, 5), (0.03, 1), (0.03, 4), (0.03, 5)] {
            let force = pressed(gap, count, how);
            assert!(
                (force - first).abs() <= 1e-7 * first.abs(),
                "{gap} {count}: {force} {first}"
            );
        }
    }
}

/// A wedge that comes down obliquely, with its tip on the middle node as it meets the block, takes it along as one that
/// touches it at first; one whose tip is beside the node there pushes it aside with a face.
#[test]
fn a_tip_that_comes_obliquely_takes_the_node_that_it_meets() {
    let pushed = |gap: f64, apart: f64, beside: f64, large: bool| {
        let rise = 10.0 * RISE.tan();
        let points = [[10.0, rise], [0.0, 0.0], [-10.0, rise]];
        let wedge = points.map(|[x, y]| [x - apart + beside, y]);
        let wedge = Polyline::new(&wedge).expect("valid");
        let mut driver = pressed(
            block(gap, false),
            PlaneStrain::default(),
            ("b.top", wedge),
            (0.1, large),
        );
        let step = Step::new("press").tool("t", [apart + 0.002, -0.02 - gap]);
        let step = step.fix("b.bottom", &FULL[..2]);
        driver
            .run(&step, Increments::equal(1), |_, _| ())
            .expect("converges");
        driver.tool_force("t").expect("exists")
    };
    for large in [false, true] {
        let touching = pushed(0.0, 0.0, 0.0, large);
        let met = pushed(0.03, 0.003, 0.0, large);
        assert!(
            (met - touching).norm() <= 1e-7 * touching.norm(),
            "{met} {touching}"
        );
        let aside = pushed(0.03, 0.003, 1e-4, large);
        assert!(
            (aside - touching).norm() > 0.01 * touching.norm(),
            "{aside}"
        );
    }
}
