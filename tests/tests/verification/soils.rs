//! Soils whose flow is not associated, ψ < φ: uniform states against an independent integration point by
//! point, others against an independent finite element code; not their strengths, which are in `laws`.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, IncrementReport, Model, Settings, Step};
use moreau::laws::{Coulomb, DruckerPrager, ElasticDruckerPrager};
use moreau::mesh::{
    Axisymmetric, CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform,
};
use verification::problems::Fallible;

const YOUNG: f64 = 20e3;
const POISSON: f64 = 0.25;
const COHESION: f64 = 10.0;
const SIDE: f64 = 2.0;

fn soil((friction, dilatancy): (f64, f64)) -> Fallible<ElasticDruckerPrager> {
    let plastic = DruckerPrager::mohr_coulomb(COHESION, friction, dilatancy)?;
    Ok(ElasticDruckerPrager::new(YOUNG, POISSON, plastic)?)
}

/// The soil in principal stresses, by another algorithm: λ by bisection of the yield function along the
/// return, no closed form and no tangent.
struct Reference {
    friction: f64,
    dilatancy: f64,
    apex: f64,
    elastic_strain: [f64; 3],
}

impl Reference {
    fn new((friction, dilatancy): (f64, f64)) -> Self {
        let slope = |angle: f64| {
            let sine = angle.to_radians().sin();
            2.0 * 6f64.sqrt() * sine / (3.0 - sine)
        };
        Self {
            friction: slope(friction),
            dilatancy: slope(dilatancy),
            apex: COHESION / friction.to_radians().tan(),
            elastic_strain: [0.0; 3],
        }
    }

    /// Elastic strains and stresses at the end of strain increments.
    fn after(&self, d_eps: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let lame = YOUNG * POISSON / (1.0 + POISSON) / (1.0 - 2.0 * POISSON);
        let two_g = YOUNG / (1.0 + POISSON);
        let stress = |e: [f64; 3]| {
            let dilation: f64 = e.iter().sum();
            e.map(|e| lame * dilation + two_g * e)
        };
        let parts = |s: [f64; 3]| {
            let mean = s.iter().sum::<f64>() / 3.0;
            let deviator = s.map(|s| s - mean);
            let norm = deviator.iter().map(|s| s * s).sum::<f64>().sqrt();
            (mean, deviator, norm)
        };
        let trial: [f64; 3] = std::array::from_fn(|i| self.elastic_strain[i] + d_eps[i]);
        let (_, deviator, norm) = parts(stress(trial));
        let direction = deviator.map(|s| s / norm + self.dilatancy / 3.0);
        let returned =
            |lambda: f64| -> [f64; 3] { std::array::from_fn(|i| trial[i] - lambda * direction[i]) };
        let excess = |lambda: f64| {
            let (mean, _, norm) = parts(stress(returned(lambda)));
            norm - self.friction * (self.apex - mean)
        };
        if excess(0.0) <= 0.0 {
            return (trial, stress(trial));
        }
        let (mut low, mut high) = (0.0, norm / two_g);
        if excess(high) >= 0.0 {
            // The apex: only where far too much is tried.
            return (self.elastic_strain, [self.apex; 3]);
        }
        while high - low > 1e-17 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            match excess(middle) > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        let e = returned(low);
        (e, stress(e))
    }

    /// Shortens along the second axis with the first free of stress, and the third too or held; the strain
    /// increment along the first and the stress along the second.
    fn shorten(&mut self, by: f64, held: bool) -> (f64, f64) {
        let strains = |x: f64| [x, -by, if held { 0.0 } else { x }];
        let (mut low, mut high) = (-by, 4.0 * by);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            match self.after(strains(middle)).1[0] < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        let (elastic, stress) = self.after(strains(low));
        self.elastic_strain = elastic;
        (low, stress[1])
    }
}

/// ψ < φ.
const ANGLES: [(f64, f64); 4] = [(30.0, 0.0), (45.0, 0.0), (20.0, 5.0), (30.0, 10.0)];

/// Increments of a block that is shortened by 15 %, on to the plateau of its load.
const INCREMENTS: usize = 30;

/// What a block tells of an increment: its load over that of the reference, and the motion of its side.
fn compare<const D: usize>(
    mut driver: Driver<D>,
    step: &Step<D>,
    (angles, held): ((f64, f64), bool),
    (top, axis, area): (&str, usize, f64),
    what: &str,
) -> Fallible {
    let mut reference = Reference::new(angles);
    let (mut side, mut compared) = (0.0, 0);
    let far: Vec<usize> = (0..driver.mesh().nodes().len())
        .filter(|&a| driver.mesh().nodes()[a][0] > SIDE - 1e-9)
        .collect();
    let reports = driver.run(step, INCREMENTS, |driver, report| {
        assert_eq!(report.cuts, 0, "{what}: increment {}", report.increment);
        let (x, stress) = reference.shorten(0.15 / INCREMENTS as f64, held);
        side += SIDE * x;
        let load = driver.reaction(top).map_or(f64::NAN, |r| r[axis]);
        close(what, load / area, stress, 1e-8);
        for &a in &far {
            close(what, driver.displacement(a)[0], side, 1e-8);
        }
        compared += 1;
    })?;
    assert_eq!(compared, INCREMENTS);
    let most = reports.iter().map(|r| r.newton_iterations).max();
    assert!(most <= Some(8), "{what}: {most:?} iterations");
    Ok(())
}

/// The load of a block between smooth plates in plane strain rises to a plateau on which the tangent loses
/// nearly all stiffness, for every cell and every rule.
#[test]
fn a_soil_that_does_not_dilate_is_crushed_in_plane_strain() -> Fallible {
    use Integration::{BBar, Full, Reduced};
    for (kind, rule) in [
        (CellKind::Quad8, Reduced),
        (CellKind::Tri6, Reduced),
        (CellKind::Quad8, Full),
        (CellKind::Quad9, Full),
        (CellKind::Quad4, BBar),
        (CellKind::Quad4, Full),
        (CellKind::Tri3, Full),
    ] {
        for angles in ANGLES {
            let grid = uniform(0.0, SIDE, 2);
            let model = Model::new(block2("soil", kind, &grid, &grid)?, PlaneStrain::default())
                .material("soil", soil(angles)?, rule)?;
            let step = Step::new("crush")
                .fix("soil.left", &[Axis::X])
                .fix("soil.bottom", &[Axis::Y])
                .displace("soil.top", Axis::Y, -0.15 * SIDE);
            let driver = Driver::new(model, Settings::default())?;
            let what = format!("{kind} {rule:?} {angles:?}");
            compare(driver, &step, (angles, true), ("soil.top", 1, SIDE), &what)?;
        }
    }
    Ok(())
}

/// The same in space between two smooth walls, and without them a bar, which is one about an axis too.
#[test]
fn a_soil_that_does_not_dilate_is_crushed_in_space() -> Fallible {
    let grid = uniform(0.0, SIDE, 1);
    let angles = (30.0, 0.0);
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        for held in [true, false] {
            let mesh = block3("soil", kind, &grid, &grid, &grid)?;
            let model =
                Model::new(mesh, Solid).material("soil", soil(angles)?, kind.integration())?;
            let walls = if held { "soil" } else { "soil.back" };
            let step = Step::new("crush")
                .fix("soil.left", &[Axis::X])
                .fix("soil.bottom", &[Axis::Y])
                .fix(walls, &[Axis::Z])
                .displace("soil.top", Axis::Y, -0.15 * SIDE);
            let driver = Driver::new(model, Settings::default())?;
            let what = format!("{kind} {held}");
            let top = ("soil.top", 1, SIDE * SIDE);
            compare(driver, &step, (angles, held), top, &what)?;
        }
    }
    let model = Model::new(block2("soil", CellKind::Quad8, &grid, &grid)?, Axisymmetric).material(
        "soil",
        soil(angles)?,
        Integration::Reduced,
    )?;
    let step = Step::new("crush").fix("soil.bottom", &[Axis::Y]).displace(
        "soil.top",
        Axis::Y,
        -0.15 * SIDE,
    );
    let driver = Driver::new(model, Settings::default())?;
    let top = ("soil.top", 1, std::f64::consts::PI * SIDE * SIDE);
    compare(driver, &step, (angles, false), top, "about an axis")
}

/// The most iterations of an increment, where none was cut.
fn most(reports: &[IncrementReport]) -> usize {
    assert!(reports.iter().all(|r| r.cuts == 0), "increments were cut");
    let iterations = reports.iter().map(|r| r.newton_iterations);
    iterations.max().unwrap_or(usize::MAX)
}

/// Between rough plates nothing is uniform. The loads are those of an independent code, full Newton with
/// the unsymmetric tangent and a dense factor, on the same 4 × 4 cells of quad8 with 2 × 2 points.
#[test]
fn a_soil_between_rough_plates_carries_what_an_independent_code_finds() -> Fallible {
    let loads = [
        205.7194236875,
        352.2254877478,
        481.1750930057,
        600.2054132891,
        710.9947622361,
    ];
    let grid = uniform(0.0, SIDE, 4);
    let mesh = block2("soil", CellKind::Quad8, &grid, &grid)?;
    let model = Model::new(mesh, PlaneStrain::default()).material(
        "soil",
        soil((30.0, 0.0))?,
        Integration::Reduced,
    )?;
    let step = Step::new("crush")
        .fix("soil.left", &[Axis::X])
        .fix("soil.bottom", &[Axis::X, Axis::Y])
        .fix("soil.top", &[Axis::X])
        .displace("soil.top", Axis::Y, -0.05);
    let mut driver = Driver::new(model, Settings::default())?;
    let mut found = Vec::new();
    let reports = driver.run(&step, loads.len(), |driver, _| {
        found.push(driver.reaction("soil.top").map_or(f64::NAN, |r| -r[1]));
    })?;
    assert_eq!(found.len(), loads.len());
    for (found, load) in found.iter().zip(loads) {
        close("load", *found, load, 1e-8);
    }
    assert!(most(&reports) <= 8, "{} iterations", most(&reports));
    Ok(())
}

/// Under a rough punch some contacts slip, and the contact forces obey their law exactly.
#[test]
fn a_soil_that_does_not_dilate_under_a_rough_punch() -> Fallible {
    for (kind, angles, friction) in [
        (CellKind::Quad8, (30.0, 0.0), 0.5),
        (CellKind::Tri6, (30.0, 0.0), 0.1),
        (CellKind::Quad4, (45.0, 0.0), 0.1),
        (CellKind::Quad8, (20.0, 5.0), 0.1),
    ] {
        let grid = uniform(0.0, SIDE, 6);
        let mut mesh = block2("soil", kind, &grid, &grid)?;
        mesh.facet_group_where("under", "soil.top", |x| x[0] <= 1.0 + 1e-9)?;
        let model = Model::new(mesh, PlaneStrain::default())
            .material("soil", soil(angles)?, kind.integration())?
            .tool("punch", Plane::new([0.0, SIDE], [0.0, -1.0])?)?
            .contact("under", "punch", Coulomb::new(friction)?)?;
        let step = Step::new("indent")
            .fix("soil.left", &[Axis::X])
            .fix("soil.right", &[Axis::X])
            .fix("soil.bottom", &[Axis::X, Axis::Y])
            .tool("punch", [0.0, -0.05]);
        let mut driver = Driver::new(model, Settings::default())?;
        let reports = driver.run(&step, 10, |_, _| {})?;
        let slips = reports.iter().any(|r| r.slip > 0);
        assert!(slips || friction > 0.1, "{kind}: nothing slips");
        for report in &reports {
            assert!(report.relative_gap() < 1e-10, "{kind}");
            assert!(report.certificate.excess_force < 1e-8);
        }
        let iterations = most(&reports);
        assert!(
            iterations <= 10,
            "{kind} {angles:?}: {iterations} iterations"
        );
    }
    Ok(())
}
