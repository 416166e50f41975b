//! Surfaces that are tied: nothing passes from one body to the other but displacements that agree, and their forces.

use crate::collapse::{collapse, limit};
use moreau_contact::{ContactSolver, GaussSeidel, Penalty, Plane};
use moreau_driver::{
    Analysis, Axis, Driver, IncrementReport, Model, ModelError, Numbers, Saved, Seam, Settings,
    Step,
};
use moreau_laws::{Coulomb, Isotropic, Status, VonMises};
use moreau_mesh::{Axisymmetric, CellKind, Mesh, PlaneStrain, Solid, block2, block3, uniform};
use nalgebra::SVector;
use std::ops::ControlFlow;

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    steel.with_hardening(Isotropic::linear(2000.0).expect("valid"))
}

fn elastic() -> VonMises {
    VonMises::new(210e3, 0.3, 1e9).expect("valid")
}

fn model<const D: usize, H: Analysis<D>>(
    mesh: Mesh<D>,
    hypothesis: H,
    (kind, law, large): (CellKind, &VonMises, bool),
    bodies: &[&str],
) -> Model<D, H> {
    let mut model = match large {
        true => Model::with_large_strains(mesh, hypothesis),
        false => Model::new(mesh, hypothesis),
    };
    for body in bodies {
        model = model
            .material(body, law.clone(), kind.integration())
            .expect("valid");
    }
    model
}

fn settings<const D: usize>(seam: Seam) -> Settings<D> {
    Settings {
        seam,
        ..Settings::default()
    }
}

/// An upper and a lower block of the plane with these numbers of cells along what they share, a distance apart.
fn plane(kind: CellKind, cells: [usize; 2], apart: f64) -> Mesh<2> {
    let block = |name: &str, cells: usize, y: [f64; 2]| {
        block2(
            name,
            kind,
            &uniform(0.0, 6.0, cells),
            &uniform(y[0], y[1], 2),
        )
    };
    let upper = block("upper", cells[0], [3.0 + apart, 5.0 + apart]).expect("valid");
    let lower = block("lower", cells[1], [0.0, 3.0]).expect("valid");
    let mut mesh = upper.joined(lower).expect("names differ");
    mesh.node_group_where("corner", "lower.bottom", |x| x[0] == 0.0)
        .expect("there");
    mesh
}

fn space(kind: CellKind, cells: [usize; 2]) -> Mesh<3> {
    let block = |name: &str, cells: usize, y: [f64; 2]| {
        let lines = uniform(0.0, 6.0, cells);
        block3(name, kind, &lines, &uniform(y[0], y[1], 1), &lines)
    };
    let upper = block("upper", cells[0], [3.0, 5.0]).expect("valid");
    let mut mesh = upper
        .joined(block("lower", cells[1], [0.0, 3.0]).expect("valid"))
        .expect("names differ");
    mesh.node_group_where("corner", "lower.bottom", |x| x[0] == 0.0 && x[2] == 0.0)
        .expect("there");
    mesh.node_group_where("beside", "lower.bottom", |x| x[0] == 6.0 && x[2] == 0.0)
        .expect("there");
    mesh
}

/// The largest difference of a stress from a uniform one \[MPa\], by the entries of the plane.
fn off<const D: usize>(driver: &Driver<D>, expected: [f64; 3]) -> f64 {
    let at = |s: &moreau_mandel::Sym2| {
        let s = moreau_mandel::to_matrix(s);
        [s[(0, 0)], s[(1, 1)], s[(0, 1)]]
    };
    let points = driver.points();
    let differences = points.iter().flat_map(|p| {
        let found = at(&p.stress);
        (0..3).map(move |k| (found[k] - expected[k]).abs())
    });
    differences.fold(0.0, f64::max)
}

/// Tractions of a uniform stress on all sides of both blocks that are not tied.
fn stressed<const D: usize>([xx, yy, xy]: [f64; 3]) -> Step<D> {
    let mut step = Step::new("stress");
    for body in ["upper", "lower"] {
        for (side, sign) in [("right", 1.0), ("left", -1.0)] {
            let mut traction = [0.0; D];
            (traction[0], traction[1]) = (sign * xx, sign * xy);
            step = step.traction(&format!("{body}.{side}"), traction);
        }
    }
    for (side, sign) in [("upper.top", 1.0), ("lower.bottom", -1.0)] {
        let mut traction = [0.0; D];
        (traction[0], traction[1]) = (sign * xy, sign * yy);
        step = step.traction(side, traction);
    }
    step
}

const STRESSES: [[f64; 3]; 4] = [
    [0.0, 100.0, 0.0],
    [0.0, -100.0, 0.0],
    [0.0, 0.0, 60.0],
    [40.0, -70.0, -50.0],
];

#[test]
fn a_uniform_stress_passes_between_meshes_that_do_not_match() {
    for kind in [
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Tri6,
        CellKind::Quad9,
    ] {
        for stress in STRESSES {
            let mesh = plane(kind, [5, 3], 0.0);
            let model = model(
                mesh,
                PlaneStrain::default(),
                (kind, &elastic(), false),
                &["upper", "lower"],
            );
            let model = model.tie("upper.bottom", "lower.top").expect("valid");
            let mut driver = Driver::new(model, Settings::default()).expect("valid");
            let step = stressed(stress)
                .fix("corner", &[Axis::X, Axis::Y])
                .fix("lower.bottom", &[Axis::Y]);
            let reports = driver.run(&step, 1, |_, _| {}).expect("linear");
            assert!(reports[0].newton_iterations <= 2, "{kind}: {reports:?}");
            assert!(off(&driver, stress) < 1e-9 * 100.0, "{kind} {stress:?}");
            for c in driver.contacts() {
                assert_eq!(c.status, Status::Tied);
                let traction = c.force / c.area;
                assert!((traction[1] + stress[1]).abs() < 1e-7, "{kind}: {traction}");
                assert!((traction[0] + stress[2]).abs() < 1e-7, "{kind}: {traction}");
            }
            let force = driver.contact_force("upper.bottom").expect("there");
            let other = driver.contact_force("lower.top").expect("there");
            assert!((force + other).norm() < 1e-9 * (1.0 + force.norm()));
        }
    }
}

#[test]
fn a_uniform_stress_passes_in_space_and_by_both_seams() {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        for (stress, seam) in [
            ([0.0, 100.0, 0.0], Seam::Condensed),
            ([0.0, -100.0, 30.0], Seam::Tied),
        ] {
            let mesh = space(kind, [3, 2]);
            let bodies = ["upper", "lower"];
            let model = model(mesh, Solid, (kind, &elastic(), false), &bodies);
            let model = model.tie("upper.bottom", "lower.top").expect("valid");
            let mut driver = Driver::new(model, settings(seam)).expect("valid");
            let step = stressed(stress)
                .fix("corner", &[Axis::X, Axis::Y, Axis::Z])
                .fix("beside", &[Axis::Z])
                .fix("lower.bottom", &[Axis::Y]);
            driver.run(&step, 1, |_, _| {}).expect("linear");
            assert!(
                off(&driver, stress) < 1e-7,
                "{kind} {}",
                off(&driver, stress)
            );
        }
    }
}

/// Under prescribed displacements of the sides too, the tied nodes there included.
#[test]
fn prescribed_nodes_of_a_tied_surface_do_not_disturb_a_uniform_strain() {
    let kind = CellKind::Quad8;
    let mut mesh = plane(kind, [5, 3], 0.0);
    let sides = [
        "upper.left",
        "upper.right",
        "upper.top",
        "lower.left",
        "lower.right",
        "lower.bottom",
    ];
    let mut nodes: Vec<usize> = Vec::new();
    for side in sides {
        nodes.extend(mesh.node_group(side).expect("there"));
    }
    nodes.sort_unstable();
    nodes.dedup();
    for &a in &nodes {
        mesh.add_node_group(&format!("n{a}"), vec![a]).expect("new");
    }
    let strain = |x: [f64; 2]| [1e-3 * x[0] + 4e-4 * x[1], -7e-4 * x[1] + 2e-4 * x[0]];
    let places: Vec<[f64; 2]> = mesh.nodes().to_vec();
    let model = model(
        mesh,
        PlaneStrain::default(),
        (kind, &elastic(), false),
        &["upper", "lower"],
    );
    let model = model.tie("upper.bottom", "lower.top").expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let mut step = Step::new("strain");
    for &a in &nodes {
        let u = strain(places[a]);
        step = step.displace(&format!("n{a}"), Axis::X, u[0]).displace(
            &format!("n{a}"),
            Axis::Y,
            u[1],
        );
    }
    driver.run(&step, 1, |_, _| {}).expect("linear");
    for (a, &x) in places.iter().enumerate() {
        let u = driver.displacement(a) - SVector::from(strain(x));
        assert!(u.norm() < 1e-13, "node {a} at {x:?}: {u}");
    }
}

/// One body cut in two at matching nodes has the answers of the whole.
#[test]
fn a_body_that_is_cut_and_tied_is_the_body() {
    for (law, large, move_by) in [
        (elastic(), false, 0.01),
        (steel(), false, 0.05),
        (steel(), true, 1.0),
    ] {
        let kind = CellKind::Quad8;
        let (lines, heights) = (uniform(0.0, 6.0, 4), uniform(0.0, 5.0, 5));
        let whole = block2("whole", kind, &lines, &heights).expect("valid");
        let upper = block2("upper", kind, &lines, &heights[3..]).expect("valid");
        let lower = block2("lower", kind, &lines, &heights[..4]).expect("valid");
        let cut = upper.joined(lower).expect("valid");
        let hypothesis = PlaneStrain::default;
        let one = model(whole, hypothesis(), (kind, &law, large), &["whole"]);
        let two = model(cut, hypothesis(), (kind, &law, large), &["upper", "lower"]);
        let two = two.tie("upper.bottom", "lower.top").expect("valid");
        let step = |bottom: &str, top: &str| {
            Step::new("pull")
                .fix(bottom, &[Axis::X, Axis::Y])
                .displace(top, Axis::Y, move_by)
                .displace(top, Axis::X, 0.3 * move_by)
        };
        let mut one = Driver::new(one, Settings::default()).expect("valid");
        let mut two = Driver::new(two, Settings::default()).expect("valid");
        let alone = one.run(&step("whole.bottom", "whole.top"), 4, |_, _| {});
        let tied = two.run(&step("lower.bottom", "upper.top"), 4, |_, _| {});
        let (alone, tied) = (alone.expect("converges"), tied.expect("converges"));
        for (a, b) in alone.iter().zip(&tied) {
            assert_eq!(a.newton_iterations, b.newton_iterations, "{large}");
            let (x, y) = (a.energies.external_work, b.energies.external_work);
            assert!((x - y).abs() < 1e-9 * x.abs(), "{x} {y}");
        }
        let force = [
            one.reaction("whole.top").expect("there"),
            two.reaction("upper.top").expect("there"),
        ];
        assert!((force[0] - force[1]).norm() < 1e-9 * force[0].norm());
        let of = |driver: &Driver<2>, x: &[f64; 2]| {
            let nodes = driver.mesh().nodes();
            let at = nodes
                .iter()
                .position(|y| (y[0] - x[0]).hypot(y[1] - x[1]) < 1e-9);
            driver.displacement(at.expect("there"))
        };
        for x in two.mesh().nodes() {
            assert!((of(&one, x) - of(&two, x)).norm() < 1e-9 * move_by);
        }
    }
}

/// Turned by a right angle, in large steps and across a distance between the surfaces: no stress, and the forces of a
/// pull turn with the body.
#[test]
fn a_rotation_leaves_no_stress_also_across_a_distance() {
    for (apart, kind) in [
        (0.0, CellKind::Quad8),
        (0.08, CellKind::Quad4),
        (-0.05, CellKind::Quad8),
    ] {
        let mut mesh = plane(kind, [4, 3], apart);
        let held = mesh.node_group("lower.bottom").expect("there");
        for &a in &held {
            mesh.add_node_group(&format!("n{a}"), vec![a]).expect("new");
        }
        let places: Vec<[f64; 2]> = mesh.nodes().to_vec();
        let model = model(
            mesh,
            PlaneStrain::default(),
            (kind, &elastic(), true),
            &["upper", "lower"],
        );
        let model = model.tie("upper.bottom", "lower.top").expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        for k in 1..=9 {
            let (sin, cos) = (10.0 * f64::from(k)).to_radians().sin_cos();
            let mut step = Step::new(&format!("turn {k}"));
            for &a in &held {
                let [x, y] = places[a];
                step = step
                    .displace(&format!("n{a}"), Axis::X, cos * x - sin * y - x)
                    .displace(&format!("n{a}"), Axis::Y, sin * x + cos * y - y);
            }
            driver.run(&step, 1, |_, _| {}).expect("converges");
        }
        let stress = off(&driver, [0.0; 3]);
        assert!(stress < 1e-6, "{apart}: {stress}");
        for (a, [x, y]) in places.iter().enumerate() {
            let turned = SVector::from([-y - x, x - y]);
            assert!((driver.displacement(a) - turned).norm() < 1e-10);
        }
        // The top looks along −x now: what pulls it there is normal to the tie.
        let mut pull = Step::new("pull").traction("upper.top", [-100.0, 0.0]);
        for &a in &held {
            let [x, y] = places[a];
            let group = format!("n{a}");
            pull = (pull.displace(&group, Axis::X, -y - x)).displace(&group, Axis::Y, x - y);
        }
        driver.run(&pull, 1, |_, _| {}).expect("converges");
        let sum = |k: usize| driver.contacts().iter().map(|c| c.t[k]).sum::<f64>();
        let [normal, shear] = [sum(0), sum(1)];
        assert!((normal / -600.0 - 1.0).abs() < 1e-2, "{apart}: {normal}");
        assert!(shear.abs() < 6.0, "{apart}: {shear}");
    }
}

/// Forces of a tie are action and reaction, in sum and in moment, across a distance too.
#[test]
fn forces_of_a_tie_leave_neither_force_nor_moment() {
    for apart in [0.0, 0.1] {
        let kind = CellKind::Quad8;
        let model = model(
            plane(kind, [5, 3], apart),
            PlaneStrain::default(),
            (kind, &elastic(), false),
            &["upper", "lower"],
        );
        let model = model.tie("upper.bottom", "lower.top").expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("bend")
            .fix("lower.bottom", &[Axis::X, Axis::Y])
            .traction("upper.right", [0.0, 30.0])
            .traction("upper.top", [50.0, 0.0]);
        driver.run(&step, 1, |_, _| {}).expect("linear");
        let (mut sum, mut moment, mut size) = (SVector::<f64, 2>::zeros(), 0.0, 0.0);
        for (a, x) in driver.mesh().nodes().iter().enumerate() {
            let f = driver.nodal_contact_force(a);
            sum += f;
            moment += x[0] * f[1] - x[1] * f[0];
            size += f.norm();
        }
        assert!(size > 100.0);
        assert!(sum.norm() < 1e-12 * size, "{sum}");
        assert!(moment.abs() < 1e-10 * size, "{apart}: {moment}");
        // What acts on the upper block: 30 · 2 upwards and 50 · 6 to the right.
        let force = driver.contact_force("upper.bottom").expect("there");
        assert!(
            (force - SVector::from([-300.0, -60.0])).norm() < 1e-8,
            "{force}"
        );
    }
}

fn pressed(seam: Seam, contact: Option<Box<dyn ContactSolver<2>>>) -> Driver<2> {
    let kind = CellKind::Quad8;
    let model = model(
        plane(kind, [8, 3], 0.0),
        PlaneStrain::default(),
        (kind, &steel(), false),
        &["upper", "lower"],
    );
    let model = model
        .tool("die", Plane::new([0.0, 5.0], [0.05, -1.0]).expect("valid"))
        .expect("new")
        .contact("upper.top", "die", Coulomb::new(0.2).expect("valid"))
        .expect("valid")
        .tie("upper.bottom", "lower.top")
        .expect("valid");
    let mut settings = settings(seam);
    if let Some(contact) = contact {
        settings.contact = contact;
    }
    Driver::new(model, settings).expect("valid")
}

fn press() -> Step<2> {
    Step::new("press")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .tool("die", [0.01, -0.03])
}

/// A tool presses what only a tie holds: both seams and springs find one answer. Methods that need an inverse of S refuse it.
#[test]
fn a_tie_under_a_tool_is_the_same_by_every_way() {
    let solve = |seam, contact: Option<Box<dyn ContactSolver<2>>>| {
        let mut driver = pressed(seam, contact);
        driver.run(&press(), 4, |_, _| {}).expect("converges");
        let tied = driver.contacts().iter().filter(|c| c.contact == 1);
        assert!(tied.clone().count() > 8 && tied.clone().all(|c| c.status == Status::Tied));
        assert!(tied.clone().all(|c| c.u.norm() < 1e-12), "apart");
        driver
    };
    let first = solve(Seam::Condensed, None);
    let force = first.tool_force("die").expect("there");
    assert!(force[1] < -100.0, "{force}");
    type Method = Option<Box<dyn ContactSolver<2>>>;
    let others: [(Seam, Method, f64); 2] = [
        (Seam::Tied, None, 1e-8),
        // Springs are those of contacts: they yield by 1e-12 mm, ties not at all.
        (
            Seam::Condensed,
            Some(Box::new(Penalty::new(1e14, 1e14).expect("valid"))),
            1e-6,
        ),
    ];
    for (seam, contact, within) in others {
        let driver = solve(seam, contact);
        let apart = (driver.tool_force("die").expect("there") - force).norm();
        assert!(apart < within * force.norm(), "{seam:?}: {apart:e}");
    }
    let mut refused = pressed(Seam::Condensed, Some(Box::new(GaussSeidel::default())));
    assert!(refused.run(&press(), 4, |_, _| {}).is_err());
}

/// What [`pressed`] and [`press`] are, computed in units of so many millimetres and megapascals; its reports, and its
/// displacements and forces in millimetres and newtons.
fn in_units(seam: Seam, [length, stress]: [f64; 2]) -> (Vec<IncrementReport>, [Vec<f64>; 2]) {
    let kind = CellKind::Quad8;
    let mesh = plane(kind, [8, 3], 0.0).map(|x| x.map(|x| x / length));
    let hardening = Isotropic::linear(2000.0 / stress).expect("valid");
    let law = VonMises::new(210e3 / stress, 0.3, 300.0 / stress).expect("valid");
    let model = model(
        mesh.expect("valid"),
        PlaneStrain::new(1.0 / length).expect("valid"),
        (kind, &law.with_hardening(hardening), false),
        &["upper", "lower"],
    );
    let die = Plane::new([0.0, 5.0 / length], [0.05, -1.0]).expect("valid");
    let model = (model.tool("die", die).expect("new"))
        .contact("upper.top", "die", Coulomb::new(0.2).expect("valid"))
        .and_then(|m| m.tie("upper.bottom", "lower.top"));
    let mut driver = Driver::new(model.expect("valid"), settings(seam)).expect("valid");
    let step = Step::new("press")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .tool("die", [0.01, -0.03].map(|u| u / length));
    let reports = driver.run(&step, 4, |_, _| {}).expect("converges");
    let force = stress * length * length;
    let moved = driver.displacements().iter().map(|u| u * length);
    let forces = driver
        .contacts()
        .iter()
        .flat_map(|c| [0, 1].map(|i| c.force[i] * force));
    let numbers = [moved.collect(), forces.collect()];
    (reports, numbers)
}

/// Powers of two do not even round: ties know no length and no stress of their own. In the factor of the stiffness what a
/// first guess of the forces rounds off is left of them, and no iteration more.
#[test]
fn units_do_not_matter_to_a_tie() {
    for (seam, within) in [(Seam::Condensed, 0.0), (Seam::Tied, 1e-12)] {
        let (reports, [moved, forces]) = in_units(seam, [1.0, 1.0]);
        assert!(reports.iter().any(|r| r.plastic_fraction > 0.0));
        for units in [[10, -20], [-10, 0], [20, 0], [0, 40]] {
            let (others, found) = in_units(seam, units.map(|e| 2f64.powi(e)));
            for (a, b) in reports.iter().zip(&others) {
                let counts = |r: &IncrementReport| (r.newton_iterations, r.contact_iterations);
                assert_eq!(counts(a), counts(b), "{seam:?} {units:?}");
            }
            for (numbers, found) in [&moved, &forces].into_iter().zip(&found) {
                let size = numbers.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                let pairs = numbers.iter().zip(found).map(|(a, b)| (a - b).abs());
                let off = pairs.fold(0.0, f64::max);
                assert!(
                    off <= within * size,
                    "{seam:?} {units:?}: {off:e} of {size:e}"
                );
            }
        }
    }
}

#[test]
fn a_tie_goes_on_from_a_checkpoint_to_the_bit() {
    let mut whole = pressed(Seam::Condensed, None);
    whole.run(&press(), 4, |_, _| {}).expect("converges");
    let mut first = pressed(Seam::Condensed, None);
    let mut ramp = first.begin(&press(), 4).expect("valid");
    first
        .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
        .expect("converges");
    first
        .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
        .expect("converges");
    let mut numbers = Vec::new();
    first.write(&mut numbers);
    ramp.write(&mut numbers);
    let mut second = pressed(Seam::Condensed, None);
    let mut ramp = second.begin(&press(), 4).expect("valid");
    let mut from = Numbers::Read(&numbers);
    second.read(&mut from).expect("whole");
    ramp.read(&mut from).expect("whole");
    while !ramp.is_done() {
        second
            .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
            .expect("converges");
    }
    assert_eq!(whole.displacements(), second.displacements());
}

/// A layer of the same material bends with its block as one beam does.
#[test]
fn a_tied_layer_bends_as_one_beam() {
    let kind = CellKind::Quad8;
    let bar = |name: &str, cells: usize, y: [f64; 2]| {
        block2(
            name,
            kind,
            &uniform(0.0, 40.0, cells),
            &uniform(y[0], y[1], 1),
        )
        .expect("valid")
    };
    let mesh = bar("upper", 26, [1.0, 2.0])
        .joined(bar("lower", 20, [0.0, 1.0]))
        .expect("valid");
    let law = VonMises::new(210e3, 0.0, 1e9).expect("valid");
    let model = model(
        mesh,
        PlaneStrain::default(),
        (kind, &law, false),
        &["upper", "lower"],
    );
    let model = model.tie("upper.bottom", "lower.top").expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("bend")
        .fix("lower.left", &[Axis::X, Axis::Y])
        .fix("upper.left", &[Axis::X, Axis::Y])
        .traction("upper.right", [0.0, -1.0])
        .traction("lower.right", [0.0, -1.0]);
    driver.run(&step, 1, |_, _| {}).expect("linear");
    let tip = driver.mesh().nodes().iter().position(|x| *x == [40.0, 2.0]);
    let found = driver.displacement(tip.expect("there"))[1];
    // Euler's beam and Timoshenko's shear: F l³/(3 E I) + 6 F l/(5 G A), with F = 2, I = 8/12, A = 2.
    let expected = 2.0 * 64e3 / (3.0 * 210e3 * 8.0 / 12.0) + 1.2 * 2.0 * 40.0 / (105e3 * 2.0);
    assert!(
        (found + expected).abs() < 3e-3 * expected,
        "{found} {expected}"
    );
    // Not tied, each would carry half with an eighth of the inertia.
    assert!(expected < 0.4 * 4.0 * expected);
}

/// Round the axis too: a shaft in a sleeve of other cells, pulled along its axis and squeezed.
#[test]
fn a_sleeve_is_tied_to_its_shaft() {
    let kind = CellKind::Quad8;
    let shaft = block2("shaft", kind, &uniform(0.0, 3.0, 2), &uniform(0.0, 6.0, 4)).expect("valid");
    let sleeve =
        block2("sleeve", kind, &uniform(3.0, 5.0, 2), &uniform(0.0, 6.0, 3)).expect("valid");
    let mesh = sleeve.joined(shaft).expect("valid");
    let model = model(
        mesh,
        Axisymmetric,
        (kind, &elastic(), false),
        &["shaft", "sleeve"],
    );
    let model = model.tie("sleeve.left", "shaft.right").expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("squeeze")
        .fix("shaft.bottom", &[Axis::Y])
        .fix("sleeve.bottom", &[Axis::Y])
        .pressure("sleeve.right", 80.0)
        .pressure("sleeve.top", -50.0)
        .pressure("shaft.top", -50.0);
    driver.run(&step, 1, |_, _| {}).expect("linear");
    // σ_r = σ_θ = −80, σ_z = 50.
    assert!(off(&driver, [-80.0, 50.0, 0.0]) < 1e-8);
}

/// A tube that is tied to one around it, between meshes that do not match, collapses at the pressure of the whole.
#[test]
fn a_tube_in_a_tube_collapses_as_one() {
    let kind = CellKind::Quad8;
    let tube = |name: &str, [from, to]: [f64; 2], cells: usize| {
        let (r, z) = (uniform(from, to, 4), uniform(0.0, 10.0, cells));
        block2(name, kind, &r, &z).expect("valid")
    };
    let (inner, outer) = (
        tube("inner", [100.0, 150.0], 1),
        tube("outer", [150.0, 200.0], 2),
    );
    let mesh = inner.joined(outer).expect("valid");
    let steel = VonMises::new(210e3, 0.3, 240.0).expect("valid");
    for seam in [Seam::Condensed, Seam::Tied] {
        let bodies = &["inner", "outer"];
        let model = model(mesh.clone(), Axisymmetric, (kind, &steel, false), bodies);
        let model = model.tie("outer.left", "inner.right").expect("valid");
        let mut driver = Driver::new(model, settings(seam)).expect("valid");
        let step = Step::new("press")
            .fix("inner", &[Axis::Y])
            .fix("outer", &[Axis::Y])
            .pressure("inner.left", 1.25 * limit());
        let (found, _) = collapse(&mut driver, &step, 10);
        let off = (1.25 * found.load_factor - 1.0).abs();
        assert!(off < 1e-4, "{seam:?}: {found:?}");
        let bound = found.upper_bound.expect("von Mises");
        let gap = bound.load_factor / found.load_factor - 1.0;
        assert!(gap.abs() < 1e-4, "{seam:?}: {bound:?} of {found:?}");
    }
}

/// Four blocks about a node: the corner of one is in two ties.
#[test]
fn ties_may_cross() {
    let kind = CellKind::Quad8;
    let block = |name: &str, x: [f64; 2], y: [f64; 2], cells: usize| {
        block2(
            name,
            kind,
            &uniform(x[0], x[1], cells),
            &uniform(y[0], y[1], cells),
        )
        .expect("valid")
    };
    let mesh = block("a", [0.0, 3.0], [3.0, 6.0], 3)
        .joined(block("b", [3.0, 6.0], [3.0, 6.0], 2))
        .and_then(|m| m.joined(block("c", [0.0, 3.0], [0.0, 3.0], 2)))
        .and_then(|m| m.joined(block("d", [3.0, 6.0], [0.0, 3.0], 3)))
        .expect("valid");
    let bodies = ["a", "b", "c", "d"];
    let model = model(
        mesh,
        PlaneStrain::default(),
        (kind, &elastic(), false),
        &bodies,
    );
    let model = (model.tie("a.right", "b.left").expect("valid"))
        .tie("a.bottom", "c.top")
        .expect("valid")
        .tie("d.left", "c.right")
        .expect("valid")
        .tie("d.top", "b.bottom")
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("pull")
        .fix("c.left", &[Axis::X])
        .fix("a.left", &[Axis::X])
        .fix("c.bottom", &[Axis::Y])
        .fix("d.bottom", &[Axis::Y])
        .traction("a.top", [0.0, 100.0])
        .traction("b.top", [0.0, 100.0]);
    driver.run(&step, 1, |_, _| {}).expect("linear");
    assert!(off(&driver, [0.0, 100.0, 0.0]) < 1e-7);
}

#[test]
fn what_cannot_be_tied_is_refused() {
    let kind = CellKind::Quad8;
    let make = |apart: f64| {
        let mesh = plane(kind, [4, 3], apart);
        let law = elastic();
        model(
            mesh,
            PlaneStrain::default(),
            (kind, &law, false),
            &["upper", "lower"],
        )
    };
    let itself = make(0.0).tie("upper.bottom", "upper.bottom").err();
    assert!(
        matches!(itself, Some(ModelError::SharedSurfaceNode { .. })),
        "{itself:?}"
    );
    let apart = make(0.6).tie("upper.bottom", "lower.top").err();
    let Some(ModelError::TiedApart {
        apart,
        bridged,
        position,
        ..
    }) = apart
    else {
        panic!("{apart:?}");
    };
    assert!((apart - 0.6).abs() < 1e-12 && (bridged - 0.5).abs() < 1e-12);
    assert_eq!(position[1], 3.6);
    let away = make(0.0).tie("upper.top", "lower.bottom").err();
    assert!(
        matches!(
            away,
            Some(ModelError::TiedApart { .. } | ModelError::NothingToTie { .. })
        ),
        "{away:?}"
    );
    // Up to a quarter of the longer facet, of 2 mm.
    assert!(make(0.499).tie("upper.bottom", "lower.top").is_ok());
    let apart = make(0.501).tie("upper.bottom", "lower.top").err();
    assert!(
        matches!(apart, Some(ModelError::TiedApart { .. })),
        "{apart:?}"
    );
    for (surface, to, group) in [
        ("upper.bottom", "lower.top", "upper.bottom"),
        ("lower.top", "upper.bottom", "lower.top"),
        ("upper.bottom", "lower.bottom", "upper.bottom"),
        ("lower.top", "upper.top", "lower.top"),
        ("lower.bottom", "upper.bottom", "upper.bottom"),
    ] {
        let twice = make(0.0).tie("upper.bottom", "lower.top").expect("valid");
        let twice = twice.tie(surface, to).err();
        assert!(
            matches!(&twice, Some(ModelError::TiedTwice { group: g, .. }) if g == group),
            "{twice:?}"
        );
    }
    let unknown = make(0.0).tie("upper.botom", "lower.top").err();
    assert!(
        unknown
            .expect("refused")
            .to_string()
            .contains("upper.bottom")
    );
}

/// Of a surface that reaches beyond the body opposite: its nodes there are free, carry nothing, and are no points of the tie.
#[test]
fn nodes_with_nothing_opposite_are_free() {
    let kind = CellKind::Quad8;
    let block = |name: &str, end: f64, cells: usize, y: [f64; 2]| {
        let (x, y) = (uniform(0.0, end, cells), uniform(y[0], y[1], 2));
        block2(name, kind, &x, &y).expect("valid")
    };
    let whole = [0.5, 1.0, 1.5, 2.0].map(|x| 4.0 + x);
    for (end, free) in [(4.0, &whole[..]), (4.3, &whole[2..]), (6.0, &[])] {
        let mesh = block("upper", 6.0, 6, [3.0, 5.0])
            .joined(block("lower", end, 4, [0.0, 3.0]))
            .expect("valid");
        let bodies = ["upper", "lower"];
        let model = model(
            mesh,
            PlaneStrain::default(),
            (kind, &elastic(), false),
            &bodies,
        );
        let model = model.tie("upper.bottom", "lower.top").expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let untied = driver.untied_nodes(0);
        let at = |&a: &usize| driver.mesh().nodes()[a][0];
        let mut places: Vec<f64> = untied.iter().map(at).collect();
        places.sort_by(f64::total_cmp);
        assert_eq!(places, free, "{end}");
        let surface = driver.mesh().node_group("upper.bottom").expect("there");
        assert!(driver.contacts().len() <= surface.len() - free.len());
        let points = driver.contacts().iter().map(|c| c.node);
        assert!(points.clone().all(|a| !untied.contains(&a)));
        let pull = Step::new("pull")
            .fix("lower.bottom", &[Axis::X, Axis::Y])
            .traction("upper.top", [0.0, 50.0]);
        driver.run(&pull, 1, |_, _| {}).expect("linear");
        let force = driver.contact_force("upper.bottom").expect("there");
        assert!(
            (force - SVector::from([0.0, -300.0])).norm() < 1e-8,
            "{force}"
        );
        assert!(
            untied
                .iter()
                .all(|&a| driver.nodal_contact_force(a).norm() == 0.0)
        );
    }
}

/// Half of a symmetric body between meshes that do not match: the nodes on the plane of symmetry are held along x, and a tie
/// holds nothing there that the whole body is free of.
#[test]
fn half_of_a_body_moves_as_the_whole() {
    let kind = CellKind::Quad8;
    let of = |from: f64, cells: [usize; 2]| {
        let block = |name: &str, cells: usize, y: [f64; 2]| {
            let (x, y) = (uniform(from, 6.0, cells), uniform(y[0], y[1], 2));
            block2(name, kind, &x, &y).expect("valid")
        };
        let mesh = block("upper", cells[0], [3.0, 5.0])
            .joined(block("lower", cells[1], [0.0, 3.0]))
            .expect("valid");
        let bodies = ["upper", "lower"];
        let model = model(
            mesh,
            PlaneStrain::default(),
            (kind, &elastic(), false),
            &bodies,
        );
        let model = model.tie("upper.bottom", "lower.top").expect("valid");
        Driver::new(model, Settings::default()).expect("valid")
    };
    let (mut half, mut whole) = (of(0.0, [5, 3]), of(-6.0, [10, 6]));
    let squeeze = Step::new("squeeze")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .pressure("upper.right", 100.0);
    let both = squeeze.clone().pressure("upper.left", 100.0);
    whole.run(&both, 1, |_, _| {}).expect("linear");
    let held = (squeeze.fix("upper.left", &[Axis::X])).fix("lower.left", &[Axis::X]);
    half.run(&held, 1, |_, _| {}).expect("linear");
    for (a, x) in half.mesh().nodes().iter().enumerate() {
        let u = half.displacement(a);
        let is_here = |y: &[f64; 2]| (x[0] - y[0]).hypot(x[1] - y[1]) < 1e-9;
        let beside = whole.mesh().nodes().iter().enumerate();
        // Where the bodies meet one of two.
        let off = (beside.filter(|(_, y)| is_here(y)))
            .map(|(b, _)| (whole.displacement(b) - u).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(off < 1e-12, "node {a} at {x:?}: {off:e}");
    }
}
