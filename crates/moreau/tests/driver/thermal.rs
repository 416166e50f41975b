//! Bodies that are heated and cooled against closed forms; not what heats them.

use moreau_driver::{Analysis, Axis, Driver, Model, ModelError, Numbers, Saved, Settings, Step};
use moreau_laws::{Coulomb, Elastic, PanelLaw, PointByPoint, VonMises};
use moreau_mesh::{
    Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, PlaneStress, Solid, block2, block3,
    uniform,
};
use std::sync::Arc;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

const YOUNG: f64 = 200e3;
const POISSON: f64 = 0.3;
const ALPHA: f64 = 1.2e-5;
const HEAT: f64 = 100.0;

fn near(found: f64, expected: f64, allowed: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= allowed, "{what}: {found:e}, not {expected:e}");
}

fn plate(kind: CellKind) -> Fallible<Mesh<2>> {
    let mesh = block2("b", kind, &uniform(1.0, 5.0, 3), &uniform(0.0, 2.0, 2))?;
    Ok(mesh)
}

fn heated<const D: usize>(step: Step<D>) -> Step<D> {
    step.temperature("b", |_| HEAT)
}

fn bodies<const D: usize, H: Analysis<D>>(
    mesh: Mesh<D>,
    hypothesis: H,
    large: bool,
    rule: Integration,
) -> Fallible<Driver<D>> {
    let model = match large {
        true => Model::with_large_strains(mesh, hypothesis),
        false => Model::new(mesh, hypothesis),
    };
    let model = model
        .material("b", Elastic::new(YOUNG, POISSON)?, rule)?
        .expansion("b", ALPHA)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Stresses of all points, by their largest difference from one.
fn off<const D: usize>(driver: &Driver<D>, expected: [f64; 3]) -> f64 {
    let of = |i: usize| {
        let all = driver.points();
        let all = all.iter().map(move |p| (p.stress[i] - expected[i]).abs());
        all.fold(0.0, f64::max)
    };
    (0..3).map(of).fold(0.0, f64::max)
}

/// Nothing holds what is heated: it grows by α ΔT, and by (1 + ν) α ΔT where its length cannot grow, and bears no stress in
/// the plane; around an axis the hoops grow too. Under large strains the factor is e^{α ΔT}.
#[test]
fn a_free_body_grows_without_stress() -> Fallible<()> {
    let strain = ALPHA * HEAT;
    for large in [false, true] {
        let grown = |e: f64| if large { e.exp_m1() } else { e };
        for kind in [CellKind::Tri6, CellKind::Quad8] {
            for rule in [Integration::Reduced, Integration::BBar] {
                let held = heated(Step::new("heat").fix("b.bottom", &[Axis::Y]));
                let planar = held.clone().displace("b.left", Axis::X, 0.0);
                let mut driver = bodies(plate(kind)?, PlaneStrain::default(), large, rule)?;
                let reports = driver.run(&planar, 1, |_, _| {})?;
                assert!(reports[0].newton_iterations <= 1 + 3 * usize::from(large));
                let length = grown((1.0 + POISSON) * strain);
                let corner = driver.displacement(driver.mesh().node_group("b.right")?[0]);
                near(corner[0], 4.0 * length, 1e-13, "plane strain");
                let through = match large {
                    // Of Cauchy: the body has grown by the factor J.
                    true => -YOUNG * strain / (2.0 * (1.0 + POISSON) * strain).exp(),
                    false => -YOUNG * strain,
                };
                near(off(&driver, [0.0, 0.0, through]), 0.0, 1e-8, "stresses");

                let mut driver = bodies(plate(kind)?, Axisymmetric, large, rule)?;
                driver.run(&held, 1, |_, _| {})?;
                for node in 0..driver.mesh().nodes().len() {
                    let ([r, y], u) = (driver.mesh().nodes()[node], driver.displacement(node));
                    near(u[0], r * grown(strain), 1e-13, "radius");
                    near(u[1], y * grown(strain), 1e-13, "height");
                }
                near(off(&driver, [0.0; 3]), 0.0, 1e-8, "stresses");
            }
        }
        for (kind, rule) in [
            (CellKind::Hex8, Integration::BBar),
            (CellKind::Tet10, Integration::Full),
        ] {
            let lines = [0.0, 1.0, 3.0];
            let mesh = block3("b", kind, &lines, &lines, &lines)?;
            let mut driver = bodies(mesh, Solid, large, rule)?;
            let step = Step::new("heat")
                .fix("b.left", &[Axis::X])
                .fix("b.bottom", &[Axis::Y])
                .fix("b.back", &[Axis::Z]);
            driver.run(&heated(step), 2, |_, _| {})?;
            for node in 0..driver.mesh().nodes().len() {
                let (x, u) = (driver.mesh().nodes()[node], driver.displacement(node));
                (0..3).for_each(|i| near(u[i], x[i] * grown(strain), 1e-13, "solid"));
            }
            near(off(&driver, [0.0; 3]), 0.0, 1e-8, "stresses");
        }
    }
    Ok(())
}

/// A plate grows by α ΔT in all three directions, and clamped all round is under −E α ΔT/(1 − ν); a cube under
/// −E α ΔT/(1 − 2ν).
#[test]
fn a_clamped_body_is_pressed() -> Fallible<()> {
    let strain = ALPHA * HEAT;
    let sides = ["b.left", "b.right"];
    for kind in [CellKind::Quad4, CellKind::Tri3, CellKind::Quad9] {
        let rule = kind.integration_in_plane_stress();
        let free = Step::new("heat")
            .fix("b.left", &[Axis::X])
            .fix("b.bottom", &[Axis::Y]);
        let mut driver = bodies(plate(kind)?, PlaneStress::new(2.0)?, false, rule)?;
        driver.run(&heated(free.clone()), 1, |_, _| {})?;
        near(off(&driver, [0.0; 3]), 0.0, 1e-9, "free");
        let fields = driver.fields();
        let thickness = fields.iter().find(|f| f.name == "thickness_strain");
        for &e in &thickness.expect("of a plate").values {
            near(e, strain, 1e-16, "thickness");
        }
        let clamped = free.fix("b.right", &[Axis::X]).fix("b.top", &[Axis::Y]);
        let pressure = -YOUNG * strain / (1.0 - POISSON);
        driver.run(&heated(clamped), 1, |_, _| {})?;
        // What had grown is pressed back.
        near(
            off(&driver, [pressure, pressure, 0.0]),
            0.0,
            1e-9,
            "held when warm",
        );

        let clamped = sides
            .iter()
            .fold(Step::new("heat"), |step, side| step.fix(side, &[Axis::X]));
        let clamped = clamped.fix("b.bottom", &[Axis::Y]).fix("b.top", &[Axis::Y]);
        let mut driver = bodies(plate(kind)?, PlaneStress::new(2.0)?, false, rule)?;
        driver.run(&heated(clamped), 1, |_, _| {})?;
        near(off(&driver, [pressure, pressure, 0.0]), 0.0, 1e-9, "plate");
        let side = driver.reaction("b.right")?[0];
        near(side, pressure * 2.0 * 2.0, 1e-8, "reaction");
    }
    let lines = [0.0, 1.0, 2.0];
    let mesh = block3("b", CellKind::Hex20, &lines, &lines, &lines)?;
    let mut driver = bodies(mesh, Solid, false, Integration::Reduced)?;
    let all = ["left", "right", "bottom", "top", "back", "front"];
    let clamped = all.iter().fold(Step::new("heat"), |step, side| {
        step.fix(&format!("b.{side}"), &[Axis::X, Axis::Y, Axis::Z])
    });
    driver.run(&heated(clamped), 1, |_, _| {})?;
    let pressure = -YOUNG * strain / (1.0 - 2.0 * POISSON);
    near(off(&driver, [pressure; 3]), 0.0, 1e-8, "cube");
    Ok(())
}

/// Two strips bonded to each other bend as Timoshenko says: κ = 6 Δα ΔT (1 + m)² / (h (3 (1 + m)² + (1 + m n)(m² + 1/(m n)))),
/// m = t₁/t₂, n = E₁/E₂ (*Journal of the Optical Society of America* 11 (1925) 233-255).
#[test]
fn a_strip_of_two_metals_bends() -> Fallible<()> {
    let (length, low, high) = (40.0, 1.0, 0.5);
    let (e_low, e_high) = (200e3, 100e3);
    let (a_low, a_high) = (1.2e-5, 2.4e-5);
    let lines = [0.0, 0.5 * low, low, low + 0.5 * high, low + high];
    let mut mesh = block2("b", CellKind::Quad8, &uniform(0.0, length, 40), &lines)?;
    let below = |mesh: &Mesh<2>, cell: usize| {
        let nodes = mesh.cell_nodes(cell);
        nodes.iter().all(|&a| mesh.nodes()[a][1] < low + 1e-9)
    };
    let (steel, brass) = (0..mesh.cell_count()).partition(|&cell| below(&mesh, cell));
    mesh.add_cell_group("steel", steel)?;
    mesh.add_cell_group("brass", brass)?;
    mesh.node_group_where("foot", "b.left", |x| x[1] == 0.0)?;
    let on_the_floor = |x0: f64| {
        let at = |x: &[f64; 2]| (x[0] - x0).abs() + x[1].abs() < 1e-9;
        mesh.nodes().iter().position(at).expect("a node")
    };
    let places = [0.0, 10.0, 20.0].map(on_the_floor);
    let rule = CellKind::Quad8.integration_in_plane_stress();
    let model = Model::new(mesh, PlaneStress::new(1.0)?)
        .material("steel", Elastic::new(e_low, POISSON)?, rule)?
        .material("brass", Elastic::new(e_high, POISSON)?, rule)?
        .expansion("steel", a_low)?
        .expansion("brass", a_high)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("heat")
        .fix("b.left", &[Axis::X])
        .fix("foot", &[Axis::Y]);
    driver.run(&heated(step), 1, |_, _| {})?;
    let [u0, u1, u2] = places.map(|node| driver.displacement(node)[1]);
    let bent = (u0 - 2.0 * u1 + u2) / 100.0;
    let (m, n) = (low / high, e_low / e_high);
    let stiff = 3.0 * (1.0 + m).powi(2) + (1.0 + m * n) * (m * m + 1.0 / (m * n));
    let kappa = 6.0 * (a_high - a_low) * HEAT * (1.0 + m).powi(2) / ((low + high) * stiff);
    near(bent, -kappa, 1e-6 * kappa, "curvature");
    Ok(())
}

/// A ring cooled onto a shaft of the same steel, both free to grow along the axis: Lamé's pressure,
/// p = E α |ΔT| (c² − b²)/(2 c²), and hoops of the ring that carry it.
#[test]
fn a_ring_shrinks_onto_a_shaft() -> Fallible<()> {
    let (b, c, cold) = (10.0, 20.0, -150.0);
    for large in [false, true] {
        let shaft = block2("b", CellKind::Quad8, &uniform(0.0, b, 4), &[0.0, 1.0])?;
        let ring = block2("ring", CellKind::Quad8, &uniform(b, c, 8), &[0.0, 1.0])?;
        let mesh = shaft.joined(ring)?;
        let steel = Elastic::new(YOUNG, POISSON)?;
        let model = match large {
            true => Model::with_large_strains(mesh, Axisymmetric),
            false => Model::new(mesh, Axisymmetric),
        };
        let model = model
            .material("b", steel, Integration::Reduced)?
            .material("ring", steel, Integration::Reduced)?
            .expansion("ring", ALPHA)?
            .contact("ring.left", "b.right", Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let cool = Step::new("cool")
            .fix("b.bottom", &[Axis::Y])
            .fix("ring.bottom", &[Axis::Y])
            .temperature("ring", move |_| cold);
        driver.run(&cool, 2, |_, _| {})?;
        let pressure = YOUNG * ALPHA * -cold * (c * c - b * b) / (2.0 * c * c);
        let exact = if large { 6e-3 } else { 1e-3 };
        for point in driver.points() {
            let r = point.position[0];
            let [radial, hoop] = match r < b {
                true => [-pressure; 2],
                false => {
                    let k = pressure * b * b / (c * c - b * b);
                    [k * (1.0 - c * c / (r * r)), k * (1.0 + c * c / (r * r))]
                }
            };
            near(point.stress[0], radial, exact * pressure, "radial");
            near(point.stress[2], hoop, 2.0 * exact * pressure, "hoop");
            near(point.stress[1], 0.0, exact * pressure, "axial");
        }
        let kept = driver.energies();
        near(
            kept.taken(),
            kept.external_work,
            2e-2 * kept.stored,
            "energy",
        );
    }
    Ok(())
}

/// A tube that is hot inside, T = ΔT ln(c/r)/ln(c/b), and keeps its length: S. P. Timoshenko and J. N. Goodier, *Theory of
/// Elasticity* (1970), section 151.
#[test]
fn a_tube_hot_inside_is_pressed_there() -> Fallible<()> {
    let (b, c) = (10.0, 20.0_f64);
    let mesh = block2("b", CellKind::Quad8, &uniform(b, c, 16), &[0.0, 1.0])?;
    let mut driver = bodies(mesh, Axisymmetric, false, Integration::Reduced)?;
    let held = Step::new("heat")
        .fix("b.bottom", &[Axis::Y])
        .fix("b.top", &[Axis::Y])
        .temperature("b", move |x| HEAT * (c / x[0]).ln() / (c / b).ln());
    driver.run(&held, 1, |_, _| {})?;
    let k = YOUNG * ALPHA * HEAT / (2.0 * (1.0 - POISSON) * (c / b).ln());
    let squares = b * b / (c * c - b * b);
    for point in driver.points() {
        let r = point.position[0];
        let (log, whole) = ((c / r).ln(), (c / b).ln());
        let ratio = c * c / (r * r);
        let radial = k * (-log - squares * (1.0 - ratio) * whole);
        let hoop = k * (1.0 - log - squares * (1.0 + ratio) * whole);
        near(point.stress[0], radial, 1e-2 * k, "radial");
        near(point.stress[2], hoop, 1e-2 * k, "hoop");
    }
    Ok(())
}

/// A bar between walls yields as it is heated and is under tension when it has cooled, by what it yielded; all work is that of
/// heat, and comes back or is dissipated.
#[test]
fn a_bar_between_walls_keeps_a_stress_when_it_cools() -> Fallible<()> {
    let limit = 200.0;
    let heat = 150.0;
    let make = |large: bool| -> Fallible<Driver<2>> {
        let mesh = block2("b", CellKind::Quad8, &uniform(0.0, 4.0, 2), &[0.0, 1.0])?;
        let law = VonMises::new(YOUNG, POISSON, limit)?.with_isotropic(2000.0)?;
        let model = match large {
            true => Model::with_large_strains(mesh, Axisymmetric),
            false => Model::new(mesh, Axisymmetric),
        };
        let model = model
            .material("b", law, Integration::Reduced)?
            .expansion("b", ALPHA)?;
        Ok(Driver::new(model, Settings::default())?)
    };
    let held = |name| {
        Step::new(name)
            .fix("b.bottom", &[Axis::Y])
            .fix("b.top", &[Axis::Y])
    };
    // ε = σ/E + εᵖ + α ΔT = 0 with |σ| = σ₀ + H |εᵖ|.
    let yielded = (YOUNG * ALPHA * heat - limit) / (YOUNG + 2000.0);
    let hot = -limit - 2000.0 * yielded;
    for large in [false, true] {
        let mut driver = make(large)?;
        driver.run(&held("heat").temperature("b", move |_| heat), 8, |_, _| {})?;
        let work = driver.energies().external_work;
        // A bar that is pressed by as much takes as much.
        let mut pressed = make(large)?;
        let down = f64::exp_m1(-ALPHA * heat);
        let down = if large { down } else { -ALPHA * heat };
        let press = Step::new("press").fix("b.bottom", &[Axis::Y]);
        pressed.run(&press.displace("b.top", Axis::Y, down), 8, |_, _| {})?;
        let same = if large { 5e-3 } else { 1e-11 };
        near(work, pressed.energies().external_work, same * work, "work");
        let exact = if large { 8e-3 } else { 1e-10 };
        near(off(&driver, [0.0, hot, 0.0]), 0.0, exact * limit, "hot");
        assert!(driver.energies().plastic_dissipation > 0.1 * work);
        driver.run(&held("cool"), 2, |_, _| {})?;
        let cold = hot + YOUNG * ALPHA * heat;
        assert!(cold > 0.1 * limit);
        near(off(&driver, [0.0, cold, 0.0]), 0.0, exact * limit, "cold");
        let now = driver.energies();
        let left = now.taken() - now.external_work;
        near(left, 0.0, 3e-2 * now.external_work, "energy");

        // The same over one step, whose temperature rises and falls.
        let mut at_once = make(large)?;
        let over = held("both").temperature("b", move |_| heat);
        let over = over.over(1, &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]);
        at_once.run(&over, 4, |_, _| {})?;
        near(
            off(&at_once, [0.0, cold, 0.0]),
            0.0,
            exact * limit,
            "at once",
        );
    }
    Ok(())
}

/// A step that is taken up from its numbers in the middle of its heat goes on to the bit.
#[test]
fn heat_that_is_resumed_goes_on_to_the_bit() -> Fallible<()> {
    let make = || -> Fallible<Driver<2>> {
        let law = VonMises::new(YOUNG, POISSON, 200.0)?.with_isotropic(2000.0)?;
        let model = Model::new(plate(CellKind::Quad8)?, PlaneStrain::default())
            .material("b", law, Integration::Reduced)?
            .expansion("b", ALPHA)?;
        Ok(Driver::new(model, Settings::default())?)
    };
    let held = |name: &str| Step::new(name).fix("b.bottom", &[Axis::X, Axis::Y]);
    let heat = held("heat")
        .pressure("b.top", 10.0)
        .temperature("b", |x| 80.0 * x[0])
        .over(1, &[[0.0, 0.0], [0.3, 1.0], [1.0, 0.5]]);
    let bits = |driver: &Driver<2>| {
        let mut numbers = Vec::new();
        driver.write(&mut numbers);
        numbers.into_iter().map(f64::to_bits).collect::<Vec<u64>>()
    };
    let steps = [heat, held("cool")];
    let mut whole = make()?;
    for step in &steps {
        whole.run(step, 4, |_, _| {})?;
    }
    let mut driver = make()?;
    for step in &steps {
        let mut ramp = driver.begin(step, 4)?;
        while !ramp.is_done() {
            driver.proceed(&mut ramp, &mut |_| std::ops::ControlFlow::Continue(()))?;
            let mut numbers = Vec::new();
            driver.write(&mut numbers);
            ramp.write(&mut numbers);
            let mut fresh = make()?;
            let mut left = Numbers::Read(&numbers);
            fresh.read(&mut left)?;
            let mut again = fresh.begin(step, 4)?;
            again.read(&mut left)?;
            assert_eq!(again, ramp);
            (driver, ramp) = (fresh, again);
        }
    }
    assert_eq!(bits(&driver), bits(&whole));
    Ok(())
}

/// A law that answers for panels of points is heated as one that answers point by point.
#[test]
fn laws_of_panels_are_heated_alike() -> Fallible<()> {
    let law = VonMises::new(YOUNG, POISSON, 200.0)?.with_isotropic(2000.0)?;
    let stresses = |model: Model<2, PlaneStrain>| -> Fallible<Vec<f64>> {
        let mut driver = Driver::new(model.expansion("b", ALPHA)?, Settings::default())?;
        let held = Step::new("heat").fix("b.bottom", &[Axis::X, Axis::Y]);
        driver.run(&held.temperature("b", |x| 100.0 * x[1]), 2, |_, _| {})?;
        let points = driver.points();
        Ok(points
            .iter()
            .flat_map(|p| p.stress.iter().copied().collect::<Vec<_>>())
            .collect())
    };
    for rule in [Integration::Reduced, Integration::BBar] {
        let model = || {
            Ok::<_, Box<dyn std::error::Error>>(Model::new(
                plate(CellKind::Quad4)?,
                PlaneStrain::default(),
            ))
        };
        let own = stresses(model()?.material("b", law.clone(), rule)?)?;
        let panel: Arc<dyn PanelLaw> = Arc::new(PointByPoint(law.clone()));
        let other = stresses(model()?.panel_material("b", &panel, rule)?)?;
        assert!(own.iter().any(|s| s.abs() > 50.0));
        for (a, b) in own.iter().zip(&other) {
            near(*b, *a, 1e-6, "stress");
        }
    }
    Ok(())
}

#[test]
fn what_is_no_temperature_is_refused() -> Fallible<()> {
    let model = |alpha: f64| {
        let model = Model::new(plate(CellKind::Quad4)?, PlaneStrain::default());
        let model = model.material("b", Elastic::new(YOUNG, POISSON)?, Integration::BBar)?;
        Ok::<_, Box<dyn std::error::Error>>(model.expansion("b", alpha))
    };
    assert!(matches!(
        model(f64::NAN)?.err(),
        Some(ModelError::OutOfRange { .. })
    ));
    let mut driver = Driver::new(model(ALPHA)??, Settings::default())?;
    let held = Step::new("heat").fix("b.bottom", &[Axis::X, Axis::Y]);
    let twice = heated(heated(held.clone()));
    let refused = driver.loading(&twice).err();
    assert!(
        matches!(refused, Some(ModelError::TwoTemperatures { cell: 0, .. })),
        "{refused:?}"
    );
    let none = held.clone().temperature("b", |x| (x[0] - 3.0).sqrt());
    match driver.loading(&none).err() {
        Some(ModelError::OutOfRange { what, value, .. }) => {
            assert!(what == "temperature of cell 0" && value.is_nan(), "{what}");
        }
        other => panic!("{other:?}"),
    }
    assert!(
        driver
            .loading(&held.clone().temperature("b.top", |_| 1.0))
            .is_err()
    );
    // Of a mesh with other points.
    let other = bodies(
        plate(CellKind::Quad8)?,
        PlaneStrain::default(),
        false,
        Integration::Full,
    )?;
    let loading = other.loading(&heated(held.clone()))?;
    let refused = driver.advance(&loading).err();
    assert!(refused.is_some());
    // Who steps through amplitudes that end in nothing is where he was.
    let over = heated(held).over(1, &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]);
    driver.run(&over, 2, |_, _| {})?;
    near(
        driver
            .displacements()
            .iter()
            .fold(0.0, |m: f64, u| m.max(u.abs())),
        0.0,
        1e-15,
        "back",
    );
    Ok(())
}

/// Where the dilatation of a cell is a mean, its heat is one too: a clamped cell has one pressure.
#[test]
fn a_cell_of_one_dilatation_has_one_heat() -> Fallible<()> {
    let mesh = block2("b", CellKind::Quad4, &[0.0, 1.0, 2.0], &[0.0, 1.0])?;
    for large in [false, true] {
        let rule = Integration::BBar;
        let mut driver = bodies(mesh.clone(), PlaneStrain::default(), large, rule)?;
        let held = Step::new("heat").fix("b", &[Axis::X, Axis::Y]);
        driver.run(&held.temperature("b", |x| HEAT * x[0]), 1, |_, _| {})?;
        for point in driver.points() {
            let heat = HEAT * (point.position[0].floor() + 0.5);
            let pressure = -YOUNG * ALPHA * heat / (1.0 - 2.0 * POISSON);
            near(point.stress[0], pressure, 1e-8, "pressure");
        }
    }
    Ok(())
}
