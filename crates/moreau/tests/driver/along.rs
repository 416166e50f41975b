//! Supports along a direction: what they hold is what supports along an axis hold of the body turned back.

use moreau_contact::Plane;
use moreau_driver::{
    Analysis, Axis, Driver, IncrementReport, Model, ModelError, Numbers, Settings, Step,
};
use moreau_laws::{
    BulkLaw, Coulomb, Elastic, Hill, HillCoefficients, Isotropic, Orthotropic, VonMises,
};
use moreau_mesh::{
    Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    steel.with_hardening(Isotropic::linear(500.0).expect("valid"))
}

/// In the plane by 37°, in space about an axis that is none of the coordinates.
fn rotation<const D: usize>() -> SMatrix<f64, D, D> {
    let axis = if D == 2 {
        Vector3::z()
    } else {
        Vector3::new(0.3, -0.5, 1.0).normalize()
    };
    let all = Rotation3::new(axis * 37.0f64.to_radians()).into_inner();
    SMatrix::from_fn(|i, j| all[(i, j)])
}

fn unit<const D: usize>(axis: usize) -> SVector<f64, D> {
    SVector::from_fn(|i, _| f64::from(u8::from(i == axis)))
}

fn body<const D: usize>(cells: usize, height: f64) -> Mesh<D>
where
    Mesh<D>: Blocks<D>,
{
    Mesh::<D>::of(cells, height)
}

trait Blocks<const D: usize>: Sized {
    fn of(cells: usize, height: f64) -> Self;
}

impl Blocks<2> for Mesh<2> {
    fn of(cells: usize, height: f64) -> Self {
        let (x, y) = (uniform(0.0, 12.0, cells), uniform(0.0, height, cells));
        block2("body", CellKind::Quad8, &x, &y).expect("valid")
    }
}

impl Blocks<3> for Mesh<3> {
    fn of(cells: usize, height: f64) -> Self {
        let (x, z) = (uniform(0.0, 12.0, cells), uniform(0.0, height, cells));
        block3("body", CellKind::Hex20, &x, &x, &z).expect("valid")
    }
}

/// What is pressed, and how.
struct Case<L> {
    law: L,
    /// The law of the turned body: where it has axes they are turned along.
    turned: L,
    large: bool,
    friction: Option<f64>,
    depth: f64,
    cells: usize,
    increments: usize,
}

/// A block held at its sides that is pressed on a part of its top, on a rough floor or on a support, as it is or turned.
fn pressed<H: Analysis<D>, L: BulkLaw + Clone, const D: usize>(
    case: &Case<L>,
    hypothesis: H,
    turned: bool,
    settings: Settings<D>,
) -> (Driver<D>, Vec<IncrementReport>)
where
    Mesh<D>: Blocks<D>,
{
    let q = match turned {
        true => rotation::<D>(),
        false => SMatrix::identity(),
    };
    let mut mesh = body::<D>(case.cells, 16.0);
    let top = if D == 2 { "body.top" } else { "body.front" };
    let bottom = if D == 2 { "body.bottom" } else { "body.back" };
    mesh.node_group_where("punch", top, |x| x[0] <= 5.0 + 1e-9)
        .expect("not empty");
    let mesh = mesh
        .map(|x| (q * SVector::from(x)).into())
        .expect("not turned inside out");
    let rule = mesh.kind(0).integration();
    let mut model = match case.large {
        true => Model::with_large_strains(mesh, hypothesis),
        false => Model::new(mesh, hypothesis),
    };
    let law = if turned { &case.turned } else { &case.law };
    model = model.material("body", law.clone(), rule).expect("valid");
    let up = q * unit::<D>(D - 1);
    if let Some(friction) = case.friction {
        model = model
            .tool("floor", Plane::new([0.0; D], up.into()).expect("valid"))
            .and_then(|m| m.contact(bottom, "floor", Coulomb::new(friction).expect("valid")))
            .expect("valid");
    }
    let mut driver = Driver::new(model, settings).expect("valid");
    let axes = [Axis::X, Axis::Y, Axis::Z];
    // Of any length.
    let along = |axis: usize| (q * unit::<D>(axis) * 3.0).into();
    let mut step = Step::new("press");
    for (axis, side) in ["body.left", "body.bottom"]
        .into_iter()
        .enumerate()
        .take(D - 1)
    {
        step = match turned {
            true => step.fix_along(side, along(axis)),
            false => step.fix(side, &[axes[axis]]),
        };
    }
    if case.friction.is_none() {
        step = match turned {
            true => step.fix_along(bottom, along(D - 1)),
            false => step.fix(bottom, &[axes[D - 1]]),
        };
    }
    let step = match turned {
        true => step.displace_along("punch", along(D - 1), -case.depth),
        false => step.displace("punch", axes[D - 1], -case.depth),
    };
    let reports = driver
        .run(&step, case.increments, |_, _| {})
        .expect("converges");
    (driver, reports)
}

/// The turned block has the answer of the other one, turned.
/// Iterations of an increment from which on it is far too large.
const WANDERS: usize = 15;

fn compare<H: Analysis<D>, L: BulkLaw + Clone, const D: usize>(case: &Case<L>, hypothesis: H)
where
    Mesh<D>: Blocks<D>,
{
    let (plain, reports) = pressed(case, hypothesis, false, Settings::default());
    let (turned, others) = pressed(case, hypothesis, true, Settings::default());
    same(case, (&plain, &reports), (&turned, &others), 1e-10);
}

fn same<L, const D: usize>(
    case: &Case<L>,
    (plain, reports): (&Driver<D>, &[IncrementReport]),
    (turned, others): (&Driver<D>, &[IncrementReport]),
    tolerance: f64,
) {
    let q = rotation::<D>();
    let mut apart = 0.0f64;
    for a in 0..plain.mesh().nodes().len() {
        apart = apart.max((q * plain.displacement(a) - turned.displacement(a)).norm());
    }
    assert!(apart <= tolerance * case.depth, "{apart:e}");
    let force = plain.reaction("punch").expect("a group").norm();
    let groups = ["body.left", "body.bottom", "punch"];
    for group in groups {
        let [a, b] = [plain, turned].map(|d| d.reaction(group).expect("a group"));
        assert!((q * a - b).norm() <= tolerance * force, "{group}: {a} {b}");
    }
    // Without other conditions at its nodes a reaction is along its direction.
    for node in plain.mesh().node_group("body.left").expect("a group") {
        let (a, b) = (plain.nodal_reaction(node), turned.nodal_reaction(node));
        assert!((q * a - b).norm() <= tolerance * force);
    }
    for (a, b) in plain.contacts().iter().zip(turned.contacts()) {
        assert_eq!(a.status, b.status);
        assert!((q * a.force - b.force).norm() <= tolerance * force);
    }
    let last = |r: &[IncrementReport]| r.last().expect("some").clone();
    let [a, b] = [last(reports), last(others)];
    let work = a.energies.external_work;
    assert!((work - b.energies.external_work).abs() <= 10.0 * tolerance * work);
    assert!((a.energies.stored - b.energies.stored).abs() <= 10.0 * tolerance * work);
    assert!((a.plastic_fraction - b.plastic_fraction).abs() < 1e-12);
    // One at the tolerance may take another iteration for its rounding, which also decides where a way that wanders leads.
    for (a, b) in reports.iter().zip(others) {
        let counts = [a, b].map(|r| r.newton_iterations);
        let wanders = counts.iter().any(|count| *count > WANDERS);
        assert!(wanders || counts[0].abs_diff(counts[1]) <= 1, "{counts:?}");
    }
}

fn case<L: Clone>(law: L) -> Case<L> {
    Case {
        turned: law.clone(),
        law,
        large: false,
        friction: None,
        depth: 0.06,
        cells: 4,
        increments: 3,
    }
}

#[test]
fn a_turned_block_answers_as_the_block_does() {
    compare(
        &case(Elastic::new(210e3, 0.3).expect("valid")),
        PlaneStrain::default(),
    );
    compare(&case(steel()), PlaneStrain::default());
    let solid = Case {
        cells: 2,
        ..case(steel())
    };
    compare(&solid, Solid);
}

/// The nodes at the edge of the floor are held by the support at the side, too.
#[test]
fn a_turned_block_rubs_on_a_turned_floor_as_the_block_does() {
    let rough = |cells| Case {
        friction: Some(0.2),
        cells,
        ..case(steel())
    };
    compare(&rough(4), PlaneStrain::default());
    compare(&rough(2), Solid);
}

#[test]
fn a_turned_block_strains_as_much() {
    let squeezed = Case {
        large: true,
        friction: Some(0.2),
        depth: 1.5,
        increments: 6,
        ..case(steel())
    };
    compare(&squeezed, PlaneStrain::default());
}

/// A rolled sheet with its axes at an angle, and the body turned with them, under small and large strains.
#[test]
fn axes_turn_with_what_has_them() {
    let rolled = |axes: &Matrix3<f64>| {
        let elastic = Orthotropic::new([210e3, 150e3, 90e3], [0.3, 0.25, 0.2], [80e3, 60e3, 50e3]);
        let criterion = HillCoefficients::lankford(1.8, 1.2, 2.3).expect("a sheet");
        let law = Hill::new(
            elastic.expect("a crystal").along(axes),
            criterion.along(axes),
            300.0,
        );
        let hardening = Isotropic::linear(500.0).expect("valid");
        law.expect("valid").with_hardening(hardening)
    };
    let axes = |about: Vector3<f64>| Rotation3::new(about).into_inner();
    let flat = axes(20.0f64.to_radians() * Vector3::z());
    let about = |q: SMatrix<f64, 2, 2>| {
        Matrix3::from_fn(|i, j| match (i, j) {
            (0..2, 0..2) => q[(i, j)],
            _ => f64::from(u8::from(i == j)),
        })
    };
    let sheet = |large, depth| Case {
        turned: rolled(&(about(rotation::<2>()) * flat)),
        large,
        depth,
        increments: 6,
        ..case(rolled(&flat))
    };
    compare(&sheet(false, 0.06), PlaneStrain::default());
    compare(&sheet(true, 0.8), PlaneStrain::default());
    let skew = axes(Vector3::new(0.4, 0.9, -0.3));
    let block = |large, depth| Case {
        turned: rolled(&(rotation::<3>() * skew)),
        large,
        depth,
        cells: 2,
        increments: 12,
        ..case(rolled(&skew))
    };
    compare(&block(false, 0.06), Solid);
    compare(&block(true, 0.6), Solid);
}

/// Conjugate gradients with a coarse space, and ties in the factor.
#[test]
fn a_turned_block_answers_by_every_linear_solver() {
    let rough = Case {
        friction: Some(0.2),
        cells: 6,
        ..case(steel())
    };
    let (plain, reports) = pressed(&rough, PlaneStrain::default(), false, Settings::default());
    let small = || Settings {
        memory: Some(8 * plain.factor_entries() as u64 - 8),
        ..Settings::default()
    };
    let (coarse, others) = pressed(&rough, PlaneStrain::default(), true, small());
    assert!(others.iter().all(|r| r.linear_iterations > 0));
    // The coarse space is turned as well: it takes no more iterations.
    let (_, straight) = pressed(&rough, PlaneStrain::default(), false, small());
    let count = |r: &[IncrementReport]| r.iter().map(|r| r.linear_iterations).sum::<usize>();
    let [straight, turned] = [count(&straight), count(&others)];
    assert!(10 * turned <= 11 * straight, "{turned} after {straight}");
    let exact = |r: &[IncrementReport]| {
        let mut told = r.to_vec();
        told.iter_mut()
            .zip(&reports)
            .for_each(|(r, plain)| r.newton_iterations = plain.newton_iterations);
        told
    };
    same(&rough, (&plain, &reports), (&coarse, &exact(&others)), 1e-8);
    let tied = Settings {
        seam: moreau_driver::Seam::Tied,
        ..Settings::default()
    };
    let (tied, others) = pressed(&rough, PlaneStrain::default(), true, tied);
    same(&rough, (&plain, &reports), (&tied, &exact(&others)), 1e-8);
}

fn elastic<H: Analysis<D>, const D: usize>(mesh: Mesh<D>, hypothesis: H) -> Driver<D> {
    let law = Elastic::new(210e3, 0.3).expect("valid");
    let model = Model::new(mesh, hypothesis).material("body", law, Integration::Reduced);
    Driver::new(model.expect("valid"), Settings::default()).expect("valid")
}

fn square() -> Driver<2> {
    let lines = uniform(0.0, 10.0, 3);
    elastic(
        block2("body", CellKind::Quad8, &lines, &lines).expect("valid"),
        PlaneStrain::default(),
    )
}

/// A 60° sector of a tube between planes of symmetry, under pressure inside: Lamé's displacements.
#[test]
fn a_sector_of_a_tube_is_lames() {
    let (inner, outer, pressure) = (10.0f64, 20.0f64, 50.0);
    let (r, angle) = (uniform(inner, outer, 4), uniform(30.0, 90.0, 6));
    let mesh = block2("body", CellKind::Quad8, &r, &angle).expect("valid");
    let mesh = mesh.map(|x| {
        let (s, c) = x[1].to_radians().sin_cos();
        [x[0] * c, x[0] * s]
    });
    let mut driver = elastic(mesh.expect("valid"), PlaneStrain::default());
    // The plane at 30°, whose normal is at 120°, and that at 90°.
    let (s, c) = 120.0f64.to_radians().sin_cos();
    let step = Step::new("press")
        .fix_along("body.bottom", [c, s])
        .fix("body.top", &[Axis::X])
        .pressure("body.left", pressure);
    let report = driver
        .run(&step, 1, |_, _| {})
        .expect("converges")
        .remove(0);
    let (young, poisson) = (210e3, 0.3);
    let k = pressure * inner * inner / (outer * outer - inner * inner);
    let exact =
        |r: f64| (1.0 + poisson) / young * k * ((1.0 - 2.0 * poisson) * r + outer * outer / r);
    for (a, x) in driver.mesh().nodes().iter().enumerate() {
        let x = SVector::from(*x);
        let u = driver.displacement(a);
        let radial = exact(x.norm());
        assert!(
            (u - x.normalize() * radial).norm() < 2e-4 * exact(inner),
            "{x} {u}"
        );
    }
    // The hoop stress over a cut carries the pressure on the bore; without work, and along the normal.
    for (group, n) in [("body.bottom", [c, s]), ("body.top", [1.0, 0.0])] {
        let force = driver.reaction(group).expect("a group");
        let n = SVector::from(n);
        assert!((force.dot(&n).abs() - pressure * inner).abs() < 1e-3 * pressure * inner);
        assert!((force - n * n.dot(&force)).norm() < 1e-12 * force.norm());
    }
    let stored = report.energies.stored;
    assert!((report.energies.external_work - stored).abs() < 1e-12 * stored);
}

#[test]
fn directions_that_are_axes_change_no_bit() {
    let pull = |step: Step<2>| {
        let mut driver = square();
        let step = step.displace("body.right", Axis::X, 0.01);
        driver.run(&step, 2, |_, _| {}).expect("converges");
        driver
            .displacements()
            .iter()
            .map(|u| u.to_bits())
            .collect::<Vec<_>>()
    };
    let axes = Step::new("pull")
        .fix("body.left", &[Axis::X])
        .fix("body.bottom", &[Axis::Y]);
    let along = Step::new("pull")
        .fix_along("body.left", [-2.0, 0.0])
        .fix_along("body.bottom", [0.0, 1e-3]);
    assert_eq!(pull(axes), pull(along));
}

/// x and a direction, a direction given twice, and three of which the third follows.
#[test]
fn several_conditions_at_a_node_hold_together() {
    let mut driver = square();
    let step = Step::new("pull")
        .fix("body.left", &[Axis::X])
        .fix_along("body.bottom", [0.6, 0.8])
        .fix_along("body.bottom", [3.0, 4.0])
        .displace_along("body.right", [0.8, -0.6], 0.02);
    driver.run(&step, 2, |_, _| {}).expect("converges");
    let group = |name: &str| driver.mesh().node_group(name).expect("a group");
    let [bottom, left, right] = ["body.bottom", "body.left", "body.right"].map(group);
    let corner = *bottom.iter().find(|a| left.contains(a)).expect("a corner");
    assert!(driver.displacement(corner).norm() < 1e-16);
    let other = *bottom.iter().find(|a| right.contains(a)).expect("a corner");
    let u = driver.displacement(other);
    assert!((u - SVector::from([0.016, -0.012])).norm() < 1e-15, "{u}");
    for a in right {
        let off = driver.displacement(a).dot(&SVector::from([0.8, -0.6])) - 0.02;
        assert!(off.abs() < 1e-15);
    }
}

#[test]
fn what_contradicts_is_told_with_its_node_and_groups() {
    let driver = square();
    let step = Step::new("pull")
        .fix("body.left", &[Axis::X, Axis::Y])
        .displace_along("body.bottom", [0.6, 0.8], 0.1);
    let error = driver.loading(&step).expect_err("contradicts");
    let text = error.to_string();
    let ModelError::ContradictingDisplacements {
        node,
        groups,
        first,
        second,
        ..
    } = error
    else {
        panic!("{error:?}");
    };
    assert_eq!((node, first, second), (0, 0.0, 0.1));
    assert_eq!(groups, ["body.left", "body.bottom"]);
    assert_eq!(
        text,
        "step \"pull\" prescribes the displacement of node 0 along (0.6, 0.8) as 0 and as 0.1 mm, by the conditions on \
         \"body.left\" and \"body.bottom\": remove one"
    );
    let none = Step::new("pull").fix_along("body.left", [0.0, 0.0]);
    assert!(matches!(
        driver.loading(&none),
        Err(ModelError::OutOfRange { .. })
    ));
    let unknown = Step::new("pull").fix_along("body.lef", [0.6, 0.8]);
    assert!(driver.loading(&unknown).is_err());
}

/// At r = 0 only the axes are directions; beside it, a cone is as good as another surface.
#[test]
fn a_skew_direction_at_the_axis_is_refused() {
    let lines = uniform(0.0, 10.0, 2);
    let mesh = || block2("body", CellKind::Quad8, &lines, &lines).expect("valid");
    let driver = elastic(mesh(), Axisymmetric);
    let cone = Step::new("press").fix_along("body.bottom", [0.6, 0.8]);
    let error = driver.loading(&cone).expect_err("refused");
    assert!(
        matches!(error, ModelError::DirectionAtAxis { node: 0, .. }),
        "{error}"
    );
    let flat = Step::new("press").fix_along("body.bottom", [0.0, 0.8]);
    assert!(driver.loading(&flat).is_ok());
    // A cone that its seat pushes inwards: every node slides on it.
    let mesh = mesh()
        .map(|x| [x[0] + 5.0, x[1] - 0.5 * x[0]])
        .expect("valid");
    let mut driver = elastic(mesh, Axisymmetric);
    let n = [0.5, 1.0];
    let step = Step::new("press")
        .fix_along("body.bottom", n)
        .traction("body.top", [0.0, -50.0]);
    driver.run(&step, 1, |_, _| {}).expect("converges");
    for a in driver.mesh().node_group("body.bottom").expect("a group") {
        assert!(driver.displacement(a).dot(&SVector::from(n)).abs() < 1e-16);
        assert!(driver.displacement(a)[0] > 0.0);
    }
    let force = driver.reaction("body.bottom").expect("a group");
    assert!((force[0] / force[1] - 0.5).abs() < 1e-12);
    // The top is a cone too, whose height does not matter to a vertical load.
    let load = 50.0 * std::f64::consts::PI * (15.0 * 15.0 - 5.0 * 5.0) * 1.25f64.sqrt();
    assert!((force[1] / load - 1.0).abs() < 1e-12, "{} {load}", force[1]);
}

#[test]
fn a_skew_support_alone_leaves_the_other_motions_free() {
    let mut driver = square();
    let step = Step::new("pull").fix_along("body.left", [0.6, 0.8]);
    let supports = driver.supports(&step).expect("valid");
    // Along the side it holds a turn as well; across its direction nothing is held.
    assert_eq!(supports[0].free.len(), 1, "{supports:?}");
    let motion = &supports[0].motions[2];
    assert_eq!(
        motion.groups,
        [("body.left".to_owned(), vec!["(0.6, 0.8)".to_owned()])]
    );
    let error = driver.run(&step, 1, |_, _| {}).expect_err("free");
    let text = error.to_string();
    assert!(
        text.contains("translation along x with translation along y"),
        "{text}"
    );
    let held = step.fix_along("body.bottom", [0.8, -0.6]);
    assert!(driver.supports(&held).expect("valid")[0].free.is_empty());
    assert!(driver.run(&held, 1, |_, _| {}).is_ok());
}

/// Held along a direction and pulled, then released: the reaction fades, and the stresses with it.
#[test]
fn a_released_support_lets_go() {
    let mut driver = square();
    let n = [0.6, 0.8];
    let hold = Step::new("hold")
        .fix("body.left", &[Axis::X])
        .fix("body.bottom", &[Axis::Y]);
    let pull = hold.clone().displace_along("body.right", n, 0.02);
    driver.run(&pull, 1, |_, _| {}).expect("converges");
    let force = driver.reaction("body.right").expect("a group");
    let n = SVector::from(n);
    assert!(force.norm() > 10.0);
    driver
        .run(&hold, 2, |driver, report| {
            let left = driver.reaction("body.right").expect("a group");
            // What is left of it is that of the other support at the corner.
            assert!(left[0].abs() < 1e-9);
            assert!(
                report.increment < 3 || driver.energies().stored < 1e-12 || report.increment == 2
            );
        })
        .expect("converges");
    let moved = (0..driver.mesh().nodes().len()).map(|a| driver.displacement(a).norm());
    assert!(moved.fold(0.0, f64::max) < 1e-12 * n.norm());
    let energies = driver.energies();
    assert!(energies.external_work.abs() < 1e-12 * 0.02 * force.norm());
}

#[test]
fn a_state_with_skew_supports_is_read_back_to_the_bit() {
    let rough = Case {
        friction: Some(0.2),
        ..case(steel())
    };
    let make = || {
        let (driver, _) = pressed(&rough, PlaneStrain::default(), true, Settings::default());
        driver
    };
    let further = |driver: &mut Driver<2>| {
        let end = driver.applied().clone();
        let mut more = end.clone();
        more.displacement.values_mut().for_each(|u| *u *= 1.2);
        driver.advance(&more).expect("converges");
        let mut numbers = Vec::new();
        driver.write(&mut numbers);
        numbers.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let mut first = make();
    let mut numbers = Vec::new();
    first.write(&mut numbers);
    let mut second = make();
    second
        .read(&mut Numbers::Read(&numbers))
        .expect("of this model");
    assert_eq!(first.applied(), second.applied());
    assert_eq!(further(&mut first), further(&mut second));
}
