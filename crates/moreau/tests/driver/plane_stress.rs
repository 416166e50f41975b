//! Plates in plane stress against closed forms and bounds of limit loads; not their laws.

use moreau_driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau_laws::{BulkLaw, Elastic, PointByPoint, VonMises};
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain, PlaneStress, block2, uniform};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const YIELD: f64 = 300.0;
const THICKNESS: f64 = 2.5;

/// A quarter of a plate or ring around the origin, `of(s, φ)` with s from 0 to 1 and the angle φ: groups "left" at s = 0,
/// "right" at s = 1, "bottom" on the axis x, "top" on the axis y.
fn quarter(
    kind: CellKind,
    cells: [usize; 2],
    of: impl Fn(f64, f64) -> [f64; 2],
) -> Fallible<Mesh<2>> {
    let (s, phi) = (
        uniform(0.0, 1.0, cells[0]),
        uniform(0.0, FRAC_PI_2, cells[1]),
    );
    let flat = |x: [f64; 2]| of(x[0], x[1]);
    Ok(block2("b", kind, &s, &phi)?.map(flat)?)
}

fn driver(mesh: Mesh<2>, law: impl BulkLaw) -> Fallible<Driver<2>> {
    let rule = mesh.kind(0).integration_in_plane_stress();
    let model = Model::new(mesh, PlaneStress::new(THICKNESS)?).material("b", law, rule)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// A ring under a pressure p in its bore, of every kind of cell: Lamé's u = p a²/(E (b² − a²)) ((1 − ν) r + (1 + ν) b²/r),
/// and the thickness shrinks alike everywhere, ε₃₃ = −2 ν/E · p a²/(b² − a²).
#[test]
fn a_ring_widens_as_lame_says() -> Fallible<()> {
    let (a, b, p) = (10.0, 20.0, 50.0);
    let c = p * a * a / (YOUNG * (b * b - a * a));
    for (kind, cells, accuracy) in [
        (CellKind::Tri3, [24, 24], 1e-2),
        (CellKind::Quad4, [24, 24], 2e-3),
        (CellKind::Tri6, [6, 6], 1e-3),
        (CellKind::Quad8, [6, 6], 1e-3),
        (CellKind::Quad9, [6, 6], 1e-3),
    ] {
        let ring = |s: f64, phi: f64| {
            let r = a + (b - a) * s;
            [r * phi.cos(), r * phi.sin()]
        };
        let mut driver = driver(quarter(kind, cells, ring)?, Elastic::new(YOUNG, POISSON)?)?;
        let press = Step::new("press")
            .fix("b.bottom", &[Axis::Y])
            .fix("b.top", &[Axis::X])
            .pressure("b.left", p);
        driver.run(&press, 1, |_, _| {})?;
        for (group, r) in [("b.left", a), ("b.right", b)] {
            let u = c * ((1.0 - POISSON) * r + (1.0 + POISSON) * b * b / r);
            for node in driver.mesh().node_group(group)?.to_vec() {
                let found = driver.displacement(node).norm();
                assert!(
                    (found / u - 1.0).abs() < accuracy,
                    "{kind} {group}: {found} {u}"
                );
            }
        }
        let fields = driver.fields();
        let field = fields.iter().find(|f| f.name == "thickness_strain");
        let strains = &field.ok_or("no field")?.values;
        let points = driver.points();
        let volume: f64 = points.iter().map(|q| q.weight).sum();
        let mean: f64 = (points.iter().zip(strains).map(|(q, e)| q.weight * e)).sum();
        let expected = -2.0 * POISSON * c;
        assert!(
            (mean / volume / expected - 1.0).abs() < accuracy,
            "{kind}: {mean}"
        );
        assert!(points.iter().all(|q| q.stress[2].abs() < 1e-10 * p));
    }
    Ok(())
}

/// A bar between smooth grips hardens and unloads as in a tensile test, in cells of every kind; energies balance.
#[test]
fn a_bar_is_pulled_as_in_a_tensile_test() -> Fallible<()> {
    let (length, width, modulus) = (8.0, 3.0, 5e3);
    for kind in [
        CellKind::Tri3,
        CellKind::Quad4,
        CellKind::Tri6,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        let mesh = block2("b", kind, &uniform(0.0, length, 3), &uniform(0.0, width, 2))?;
        let law = VonMises::new(YOUNG, POISSON, YIELD)?
            .with_isotropic(modulus)?
            .with_kinematic(modulus)?;
        let mut driver = driver(mesh, law)?;
        let eps = 0.01;
        let slope = 2.0 * modulus * YOUNG / (YOUNG + 2.0 * modulus);
        let stress = YIELD + slope * (eps - YIELD / YOUNG);
        let to = |eps: f64| {
            Step::new("pull")
                .fix("b.left", &[Axis::X])
                .fix("b.bottom", &[Axis::Y])
                .displace("b.right", Axis::X, eps * length)
        };
        for (eps, increments, expected) in [
            (eps, 4, stress),
            (eps - 0.5 * YIELD / YOUNG, 2, stress - 0.5 * YIELD),
        ] {
            driver.run(&to(eps), increments, |_, _| {})?;
            let force = driver.reaction("b.right")?[0];
            let area = width * THICKNESS;
            assert!(
                (force / (expected * area) - 1.0).abs() < 1e-9,
                "{kind}: {force}"
            );
        }
        let plastic = eps - stress / YOUNG;
        let lateral = -POISSON * (stress - 0.5 * YIELD) / YOUNG - 0.5 * plastic;
        let corner = driver.mesh().node_group("b.top")?[0];
        assert!((driver.displacement(corner)[1] / width - lateral).abs() < 1e-9);
    }
    Ok(())
}

/// The limit load of a plate with a hole lies between that of the net section, σ_Y (w − d), which a strip beside the hole
/// bears, and that of a straight neck across it, 2/√3 of this.
#[test]
fn a_plate_with_a_hole_bears_its_net_section() -> Fallible<()> {
    let (radius, half) = (4.0, 10.0);
    let plate = |s: f64, phi: f64| {
        let out = half / phi.cos().max(phi.sin());
        let r = radius + (out - radius) * s;
        [r * phi.cos(), r * phi.sin()]
    };
    let load = |cells: [usize; 2]| -> Fallible<f64> {
        let mut mesh = quarter(CellKind::Quad8, cells, plate)?;
        mesh.node_group_where("grip", "b.right", |x| x[0] > half * (1.0 - 1e-9))?;
        let mut driver = driver(mesh, VonMises::new(YOUNG, POISSON, YIELD)?)?;
        let pull = Step::new("pull")
            .fix("b.bottom", &[Axis::Y])
            .fix("b.top", &[Axis::X])
            .displace("grip", Axis::X, 0.1);
        let mut least_gap = f64::INFINITY;
        driver.run(&pull, 8, |_, report| {
            least_gap = least_gap.min(report.relative_gap())
        })?;
        assert!(least_gap.is_finite());
        Ok(driver.reaction("grip")?[0] / (YIELD * (half - radius) * THICKNESS))
    };
    let (coarse, fine) = (load([4, 8])?, load([8, 16])?);
    assert!(fine < coarse, "{coarse} {fine}");
    assert!(fine > 1.0 - 1e-6 && fine < 1.06, "{coarse} {fine}");
    Ok(())
}

/// Large strains, a mean dilatation and a law of panels are refused.
#[test]
fn what_plane_stress_does_not_go_with_is_told() -> Fallible<()> {
    let mesh = || block2("b", CellKind::Quad4, &[0.0, 1.0], &[0.0, 1.0]);
    let steel = || Elastic::new(YOUNG, POISSON);
    let large = Model::with_large_strains(mesh()?, PlaneStress::default());
    let panels: Arc<dyn moreau_laws::PanelLaw> = Arc::new(PointByPoint(steel()?));
    let flat = || -> Fallible<_> { Ok(Model::new(mesh()?, PlaneStress::default())) };
    for (refused, words) in [
        (
            large.material("b", steel()?, Integration::Full),
            "large strains",
        ),
        (
            flat()?.material("b", steel()?, Integration::BBar),
            "a mean dilatation",
        ),
        (
            flat()?.panel_material("b", &panels, Integration::Full),
            "a law that answers for panels",
        ),
    ] {
        let error = refused.err().ok_or("accepted")?;
        let is_told = matches!(&error, ModelError::PlaneStress { group, .. } if group == "b");
        assert!(is_told && error.to_string().contains(words), "{error}");
    }
    let strained = Model::with_large_strains(mesh()?, PlaneStrain::default());
    assert!(strained.material("b", steel()?, Integration::BBar).is_ok());
    Ok(())
}
