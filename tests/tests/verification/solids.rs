//! Solids under large strains beside the plane: a slab one cell thick is plane strain, a quarter of a ring is axial
//! symmetry within its facets; not what only solids do.

use moreau::contact::Plane;
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Status};
use moreau::mesh::{
    Axisymmetric, CellKind, Facet, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use std::f64::consts::FRAC_PI_2;
use verification::problems::Fallible;
use verification::problems::large::steel;

/// A body of linear cells with all its sides but its foot under a platen at a height, with friction.
fn under<const D: usize, H: Analysis<D>>(
    mut mesh: Mesh<D>,
    hypothesis: H,
    sides: &[&str],
    (height, friction): (f64, f64),
) -> Fallible<Driver<D>> {
    let mut facets: Vec<Facet> = Vec::new();
    for side in sides {
        facets.extend(mesh.facet_group(side)?);
    }
    mesh.add_facet_group("surface", facets)?;
    let up = |s: f64| std::array::from_fn(|i| if i == 1 { s } else { 0.0 });
    let model = Model::with_large_strains(mesh, hypothesis)
        .material("b", steel(500.0)?, Integration::BBar)?
        .tool("platen", Plane::new(up(height), up(-1.0))?)?
        .contact("surface", "platen", Coulomb::new(friction)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

fn down<const D: usize>(step: Step<D>, by: f64) -> Step<D> {
    step.fix("b.bottom", &[Axis::Y]).tool(
        "platen",
        std::array::from_fn(|i| if i == 1 { -by } else { 0.0 }),
    )
}

/// Forces of the platen and statuses along it, increment by increment.
type Course = Vec<([f64; 2], Vec<Status>)>;

fn course<const D: usize>(
    driver: &mut Driver<D>,
    step: &Step<D>,
    kept: impl Fn(&[f64; D]) -> bool,
) -> Fallible<Course> {
    let mut all = Course::new();
    driver.run(step, 10, |driver, _| {
        let force = driver.tool_force("platen").expect("a tool");
        let of = driver.contacts().iter().filter(|c| kept(&c.position));
        all.push(([force[0], force[1]], of.map(|c| c.status).collect()));
    })?;
    Ok(all)
}

/// The side folds onto the platen in both.
#[test]
fn a_slab_one_cell_thick_is_plane_strain() -> Fallible {
    const THICKNESS: f64 = 1.25;
    let lines = uniform(0.0, 10.0, 6);
    let mesh = block2("b", CellKind::Quad4, &lines, &lines)?;
    let (shape, sides) = ((10.0, 0.2), ["b.top", "b.right"]);
    let mut plane = under(mesh, PlaneStrain::new(THICKNESS)?, &sides, shape)?;
    let mesh = block3("b", CellKind::Hex8, &lines, &lines, &[0.0, THICKNESS])?;
    let mut slab = under(mesh, Solid, &sides, shape)?;
    let step = down(Step::new("upset").fix("b.left", &[Axis::X]), 4.0);
    let flat = course(&mut plane, &step, |_| true)?;
    let step = down(Step::new("upset").fix("b.left", &[Axis::X]), 4.0)
        .fix("b.back", &[Axis::Z])
        .fix("b.front", &[Axis::Z]);
    let solid = course(&mut slab, &step, |x| x[2] == 0.0)?;
    let largest = flat[9].0[1].abs();
    assert!(largest > 1e4);
    for ((a, on), (b, also)) in flat.iter().zip(&solid) {
        for i in 0..2 {
            assert!((a[i] - b[i]).abs() < 1e-9 * largest, "{a:?} {b:?}");
        }
        let count = |all: &[Status], status| all.iter().filter(|s| **s == status).count();
        for status in [Status::Open, Status::Stick, Status::Slip] {
            assert_eq!(count(on, status), count(also, status), "{status:?}");
        }
    }
    Ok(())
}

/// A quarter of a ring of so many cells around: load and bore.
fn ring(around: usize) -> Fallible<[f64; 2]> {
    let (radii, heights) = (uniform(4.5, 9.0, 5), uniform(0.0, 3.0, 3));
    let mesh = block3(
        "b",
        CellKind::Hex8,
        &radii,
        &heights,
        &uniform(0.0, FRAC_PI_2, around),
    )?;
    let mesh = mesh.map(|[r, y, angle]| [r * angle.cos(), y, r * angle.sin()])?;
    let mut driver = under(mesh, Solid, &["b.top", "b.left", "b.right"], (3.0, 0.1))?;
    let step = down(Step::new("squeeze"), 0.9)
        .fix("b.back", &[Axis::Z])
        .fix("b.front", &[Axis::X]);
    driver.run(&step, 10, |_, _| {})?;
    let load = 4.0 * driver.tool_force("platen")?[1];
    Ok([load, bore(&driver)])
}

/// Mean way outwards of the nodes of the bore.
fn bore<const D: usize>(driver: &Driver<D>) -> f64 {
    let radius = |x: &[f64; D]| {
        x.iter()
            .enumerate()
            .map(|(i, x)| if i == 1 { 0.0 } else { x * x })
            .sum::<f64>()
            .sqrt()
    };
    let nodes = driver.mesh().nodes().iter().enumerate();
    let of = nodes.filter(|(_, x)| x[1] == 0.0 && (radius(x) - 4.5).abs() < 1e-9);
    let ways: Vec<f64> = of
        .map(|(a, x)| {
            let now: [f64; D] = std::array::from_fn(|i| x[i] + driver.displacement(a)[i]);
            radius(&now) - 4.5
        })
        .collect();
    ways.iter().sum::<f64>() / ways.len() as f64
}

/// Twice as many facets are off by a quarter.
#[test]
fn a_quarter_of_a_ring_is_axial_symmetry_within_its_facets() -> Fallible {
    let mesh = block2(
        "b",
        CellKind::Quad4,
        &uniform(4.5, 9.0, 5),
        &uniform(0.0, 3.0, 3),
    )?;
    let mut driver = under(
        mesh,
        Axisymmetric,
        &["b.top", "b.left", "b.right"],
        (3.0, 0.1),
    )?;
    driver.run(&down(Step::new("squeeze"), 0.9), 10, |_, _| {})?;
    let exact = [driver.tool_force("platen")?[1], bore(&driver)];
    let off = |around: usize| -> Fallible<[f64; 2]> {
        let found = ring(around)?;
        Ok([0, 1].map(|i| (found[i] / exact[i] - 1.0).abs()))
    };
    let (coarse, fine) = (off(8)?, off(16)?);
    for i in 0..2 {
        assert!(
            coarse[i] < 2e-2 && fine[i] < 0.3 * coarse[i],
            "{coarse:?} {fine:?}"
        );
    }
    Ok(())
}
