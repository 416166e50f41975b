//! Uniform states that pass between meshes that do not match, in space.

use super::*;
use moreau::laws::Status;
use moreau::mesh::{Solid, block3};
use nalgebra::{Rotation3, Vector3};

/// Length of the blocks along z.
const DEPTH: f64 = 5.0;

/// A map of the footprint of a block, (x, z).
type Map = fn([f64; 2]) -> [f64; 2];

fn straight(x: [f64; 2]) -> [f64; 2] {
    x
}

/// Lines shifted by up to √2/5, more so in the middle; the sides stay what they are.
fn shifted([x, z]: [f64; 2]) -> [f64; 2] {
    let shift = 2f64.sqrt() / 5.0;
    [
        x + shift * (PI * x / WIDTH).sin(),
        z - shift * (PI * z / DEPTH).sin(),
    ]
}

/// Turned about the middle, the less the farther from it: no face is a parallelogram.
fn swirled([x, z]: [f64; 2]) -> [f64; 2] {
    let both = (PI * x / WIDTH).sin() * (PI * z / DEPTH).sin();
    let (s, c) = (0.5 * both).sin_cos();
    let (a, b) = (x - 0.5 * WIDTH, z - 0.5 * DEPTH);
    [0.5 * WIDTH + c * a - s * b, 0.5 * DEPTH + s * a + c * b]
}

/// Twice as wide, and turned about the middle as a whole.
fn turned([x, z]: [f64; 2]) -> [f64; 2] {
    let (s, c) = 0.6f64.sin_cos();
    let (a, b) = (2.2 * (x - 0.5 * WIDTH), 2.2 * (z - 0.5 * DEPTH));
    [0.5 * WIDTH + c * a - s * b, 0.5 * DEPTH + s * a + c * b]
}

/// Two blocks in space, the upper on the lower; y points up.
#[derive(Clone)]
pub(super) struct Pile {
    pub(super) kinds: [CellKind; 2],
    /// Cells along x, y and z of the upper and of the lower block.
    pub(super) cells: [[usize; 3]; 2],
    /// Of the footprints.
    pub(super) maps: [Map; 2],
    pub(super) young: [f64; 2],
    pub(super) friction: f64,
    pub(super) pairing: Pairing,
    /// Whether the lower block is the non-mortar side.
    pub(super) swapped: bool,
    /// Of the whole.
    pub(super) rotation: Rotation3<f64>,
}

impl Pile {
    pub(super) fn new(kinds: [CellKind; 2], cells: [[usize; 3]; 2]) -> Self {
        Self {
            kinds,
            cells,
            maps: [straight; 2],
            young: [E; 2],
            friction: 0.0,
            pairing: Pairing::Mortar,
            swapped: false,
            rotation: Rotation3::identity(),
        }
    }

    pub(super) fn turn(&self, v: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(v)).into()
    }

    /// As it was before the whole was turned.
    pub(super) fn back(&self, v: [f64; 3]) -> [f64; 3] {
        (self.rotation.inverse() * Vector3::from(v)).into()
    }

    pub(super) fn mesh(&self) -> Fallible<Mesh<3>> {
        let block = |k: usize, name: &str, y: [f64; 2]| -> Fallible<Mesh<3>> {
            let [n_x, n_y, n_z] = self.cells[k];
            let (x, z) = (uniform(0.0, WIDTH, n_x), uniform(0.0, DEPTH, n_z));
            let y = uniform(y[0], y[1], n_y);
            Ok(block3(name, self.kinds[k], &x, &y, &z)?.map(|[x, y, z]| {
                let [x, z] = self.maps[k]([x, z]);
                [x, y, z]
            })?)
        };
        let lower = block(1, "lower", [-HEIGHT, 0.0])?;
        let mut mesh = block(0, "upper", [0.0, HEIGHT])?.joined(lower)?;
        // What the upper block does not cover; its footprint is a box.
        let beside = |x: f64, side: f64| x < -1e-9 || x > side + 1e-9;
        let _ = mesh.node_group_where("uncovered", "lower.top", |x| {
            beside(x[0], WIDTH) || beside(x[2], DEPTH)
        });
        if self.rotation == Rotation3::identity() {
            return Ok(mesh);
        }
        Ok(mesh.map(|x| self.turn(x))?)
    }

    /// Names of the non-mortar and of the mortar surface.
    pub(super) fn surfaces(&self) -> [&'static str; 2] {
        let mut surfaces = ["upper.bottom", "lower.top"];
        if self.swapped {
            surfaces.reverse();
        }
        surfaces
    }

    pub(super) fn driver(&self, mesh: Mesh<3>, settings: Settings<3>) -> Fallible<Driver<3>> {
        let [own, other] = self.surfaces();
        let model = Model::new(mesh, Solid)
            .material("upper", Elastic::new(self.young[0], NU)?, Integration::Full)?
            .material("lower", Elastic::new(self.young[1], NU)?, Integration::Full)?
            .pair(own, other, Coulomb::new(self.friction)?, self.pairing)?;
        Ok(Driver::new(model, settings)?)
    }

    pub(super) fn what(&self) -> String {
        format!("{:?} {:?} swapped {}", self.kinds, self.cells, self.swapped)
    }
}

/// Every pairing of elements and meshes of the patch tests; bodies of one footprint.
fn piles() -> Vec<Pile> {
    let mut all = Vec::new();
    for kinds in [
        [CellKind::Hex8, CellKind::Hex8],
        [CellKind::Tet4, CellKind::Hex8],
        [CellKind::Tet4, CellKind::Tet4],
    ] {
        for (cells, maps) in [
            ([[3, 1, 2], [3, 1, 2]], [straight, straight as Map]),
            ([[3, 1, 3], [4, 1, 4]], [straight, straight]),
            ([[5, 1, 2], [2, 1, 5]], [straight, straight]),
            ([[4, 1, 3], [5, 1, 4]], [straight, shifted]),
            ([[4, 1, 4], [4, 1, 3]], [straight, swirled]),
        ] {
            for swapped in [false, true] {
                all.push(Pile {
                    maps,
                    swapped,
                    ..Pile::new(kinds, cells)
                });
            }
        }
    }
    all
}

const SQUEEZED: [f64; 6] = [0.0, -PRESSURE, 0.0, 0.0, 0.0, 0.0];

/// 4.7 and 4.8: the upper body is held by its contact and two planes of symmetry.
#[test]
fn a_uniform_pressure_passes_between_faces_that_do_not_match() -> Fallible {
    for (pile, ratio) in piles()
        .into_iter()
        .zip([1.0, 10.0, 1000.0].into_iter().cycle())
    {
        let pile = Pile {
            young: [E, E / ratio],
            ..pile
        };
        let what = format!("{}, 1:{ratio}", pile.what());
        let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
        let mut step = Step::new("press")
            .fix("lower.bottom", &[Axis::Y])
            .pressure("upper.top", PRESSURE);
        for body in ["upper", "lower"] {
            step = step
                .fix(&format!("{body}.left"), &[Axis::X])
                .fix(&format!("{body}.back"), &[Axis::Z]);
        }
        let reports = driver.run(&step, 1, |_, _| {})?;
        uniform_stress(&driver, SQUEEZED, &what);
        let force = action_is_reaction(&driver, pile.surfaces())?;
        close("resultant", force[1], PRESSURE * WIDTH * DEPTH, 1e-10);
        for c in driver.contacts() {
            assert_ne!(c.status, Status::Open);
            close(&what, c.t[0] / c.area, PRESSURE, 1e-9);
        }
        let report = &reports[0];
        assert!(report.relative_gap().abs() < 1e-12 && report.certificate.penetration < 1e-12);
        let work = report.energies.external_work;
        close("energy", report.energies.stored, work, 1e-9);
    }
    Ok(())
}

/// 4.8: pressure also on the part of the lower block that the upper does not cover.
#[test]
fn a_uniform_pressure_passes_beside_an_overhang_in_space() -> Fallible {
    let wide: Map = |[x, z]| [1.5 * x - 0.25 * WIDTH, 1.25 * z];
    for kinds in [
        [CellKind::Hex8, CellKind::Tet4],
        [CellKind::Tet4, CellKind::Hex8],
    ] {
        for swapped in [false, true] {
            let pile = Pile {
                maps: [straight, wide],
                swapped,
                ..Pile::new(kinds, [[4, 1, 3], [6, 1, 5]])
            };
            let mut mesh = pile.mesh()?;
            mesh.facet_group_where("left of it", "lower.top", |x| x[0] <= 0.0)?;
            mesh.facet_group_where("right of it", "lower.top", |x| x[0] >= WIDTH)?;
            mesh.facet_group_where("before it", "lower.top", |x| {
                x[2] >= DEPTH && x[0] >= 0.0 && x[0] <= WIDTH
            })?;
            mesh.node_group_where("line", "lower.bottom", |x| x[0] < -0.2 * WIDTH)?;
            let mut driver = pile.driver(mesh, Settings::default())?;
            let step = Step::new("press")
                .fix("line", &[Axis::X])
                .fix("upper.left", &[Axis::X])
                .fix("upper.back", &[Axis::Z])
                .fix("lower.back", &[Axis::Z])
                .fix("lower.bottom", &[Axis::Y])
                .pressure("left of it", PRESSURE)
                .pressure("right of it", PRESSURE)
                .pressure("before it", PRESSURE)
                .pressure("upper.top", PRESSURE);
            driver.run(&step, 1, |_, _| {})?;
            uniform_stress(&driver, SQUEEZED, &pile.what());
            action_is_reaction(&driver, pile.surfaces())?;
        }
    }
    Ok(())
}

/// 4.8: faces turned against each other. Around the upper block the exact displacements hold what
/// it covers in part; what lies wholly beneath it is free.
#[test]
fn a_uniform_pressure_passes_between_faces_that_are_turned() -> Fallible {
    for kind in [CellKind::Hex8, CellKind::Tet4] {
        for swapped in [false, true] {
            let pile = Pile {
                maps: [straight, turned],
                young: [E, E / 3.0],
                swapped,
                ..Pile::new([CellKind::Hex8, kind], [[11, 1, 9], [13, 1, 12]])
            };
            let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
            let mesh = driver.mesh();
            let mut held: Vec<usize> = Vec::new();
            let uncovered = mesh.node_group("uncovered")?;
            for &facet in mesh.facet_group("lower.top")? {
                if mesh.facet_nodes(facet).any(|a| uncovered.contains(&a)) {
                    held.extend(mesh.facet_nodes(facet));
                }
            }
            for side in ["left", "right", "back", "front", "bottom"] {
                held.extend(mesh.node_group(&format!("lower.{side}"))?);
            }
            held.sort_unstable();
            held.dedup();
            let covered = mesh.node_group("lower.top")?;
            assert!(
                covered
                    .iter()
                    .filter(|a| held.binary_search(a).is_err())
                    .count()
                    > 5
            );
            let e = PRESSURE / pile.young[1];
            let middle = [0.5 * WIDTH, -HEIGHT, 0.5 * DEPTH];
            let field = |x: &[f64; 3]| {
                let x: [f64; 3] = std::array::from_fn(|i| x[i] - middle[i]);
                [NU * e * x[0], -e * x[1], NU * e * x[2]]
            };
            let step = Step::new("press")
                .fix("upper.left", &[Axis::X])
                .fix("upper.back", &[Axis::Z])
                .pressure("upper.top", PRESSURE);
            let end = prescribed(&driver, &step, &held, field)?;
            driver.advance(&end)?;
            uniform_stress(&driver, SQUEEZED, &pile.what());
            action_is_reaction(&driver, pile.surfaces())?;
        }
    }
    Ok(())
}

/// 4.9 and 4.10: a uniform shear in any direction of an interface that is turned, first below the
/// limit, the upper body held by friction alone, then beyond, when it slips by what is left over.
#[test]
fn a_uniform_shear_sticks_then_slips_on_a_turned_interface() -> Fallible {
    const FRICTION: f64 = 0.25;
    const SLIP: f64 = 1e-4;
    let oblique = nalgebra::Unit::new_normalize(Vector3::new(1.0, -2.0, 0.5));
    for (k, pile) in piles().into_iter().enumerate() {
        let rotation = match k % 3 {
            0 => Rotation3::identity(),
            1 => Rotation3::from_axis_angle(&Vector3::z_axis(), PI / 6.0),
            _ => Rotation3::from_axis_angle(&oblique, PI / 6.0),
        };
        let pile = Pile {
            friction: FRICTION,
            rotation,
            ..pile
        };
        let what = pile.what();
        let (s, c) = (0.4 + k as f64).sin_cos();
        let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
        // The state of a shear, and how far the upper body has slipped.
        let state = |shear: f64| {
            let (x, z) = (shear * c, shear * s);
            Matrix3::new(0.0, x, 0.0, x, -PRESSURE, z, 0.0, z, 0.0)
        };
        let field = |at: &[f64; 3], shear: f64, slip: f64| {
            let x = pile.back(*at);
            let e = PRESSURE / E;
            let slope = 2.0 * shear * (1.0 + NU) / E;
            let along = slope * x[1] + if x[1] > 0.0 { slip } else { 0.0 };
            pile.turn([
                NU * e * x[0] + c * along,
                -e * x[1],
                NU * e * x[2] + s * along,
            ])
        };
        let loads = |shear: f64, top: bool| {
            let traction = |n: [f64; 3]| pile.turn((state(shear) * Vector3::from(n)).into());
            let mut step = Step::new("shear");
            for body in ["upper", "lower"] {
                for (side, n) in [
                    ("right", [1.0, 0.0, 0.0]),
                    ("left", [-1.0, 0.0, 0.0]),
                    ("front", [0.0, 0.0, 1.0]),
                    ("back", [0.0, 0.0, -1.0]),
                ] {
                    step = step.traction(&format!("{body}.{side}"), traction(n));
                }
            }
            match top {
                true => step.traction("upper.top", traction([0.0, 1.0, 0.0])),
                false => step,
            }
        };
        let stress = |shear: f64| {
            mandel(&(rotation.matrix() * state(shear) * rotation.matrix().transpose()))
        };
        let bottom = driver.mesh().node_group("lower.bottom")?;
        let both: Vec<usize> = [bottom.clone(), driver.mesh().node_group("upper.top")?].concat();

        let limit = FRICTION * PRESSURE;
        let shear = 0.99 * limit;
        let end = prescribed(&driver, &loads(shear, true), &bottom, |x| {
            field(x, shear, 0.0)
        })?;
        driver.advance(&end)?;
        uniform_stress(&driver, stress(shear), &format!("stick, {what}"));
        let force = action_is_reaction(&driver, pile.surfaces())?;
        let exact = rotation * (state(shear) * Vector3::new(0.0, -WIDTH * DEPTH, 0.0));
        assert!((force - exact).norm() <= 1e-9 * exact.norm());
        assert!(driver.contacts().iter().all(|c| c.status == Status::Stick));

        let end = prescribed(&driver, &loads(limit, false), &both, |x| {
            field(x, limit, SLIP)
        })?;
        driver.advance(&end)?;
        uniform_stress(&driver, stress(limit), &format!("slip, {what}"));
        for c in driver.contacts() {
            assert_eq!(c.status, Status::Slip, "{what}");
            close("slip", c.u.fixed_rows::<2>(1).norm(), SLIP, 1e-6);
        }
        action_is_reaction(&driver, pile.surfaces())?;
    }
    Ok(())
}

#[test]
fn node_to_surface_fails_the_patch_test_in_space_and_keeps_the_balance() -> Fallible {
    let pile = Pile {
        pairing: Pairing::NodeToSurface,
        ..Pile::new([CellKind::Hex8; 2], [[3, 1, 3], [4, 1, 4]])
    };
    let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
    let mut step = Step::new("press")
        .fix("lower.bottom", &[Axis::Y])
        .pressure("upper.top", PRESSURE);
    for body in ["upper", "lower"] {
        step = step
            .fix(&format!("{body}.left"), &[Axis::X])
            .fix(&format!("{body}.back"), &[Axis::Z]);
    }
    driver.run(&step, 1, |_, _| {})?;
    let error = stress_error(&driver, SQUEEZED);
    assert!(error > 1e-3, "{error:.2e}");
    let force = action_is_reaction(&driver, pile.surfaces())?;
    close("resultant", force[1], PRESSURE * WIDTH * DEPTH, 1e-11);
    Ok(())
}

/// Three bodies, two pairs; the middle one is held by its contacts alone.
#[test]
fn a_pressure_passes_through_a_solid_between_two_others() -> Fallible {
    let block = |name: &str, kind, n: usize, y: f64| {
        let lines = |side, n| uniform(0.0, side, n);
        block3(
            name,
            kind,
            &lines(WIDTH, n),
            &lines(1.0, 1),
            &lines(DEPTH, n - 1),
        )?
        .map(|[a, b, c]| [a, b + y, c])
    };
    for middle_first in [false, true] {
        let mesh = block("low", CellKind::Hex8, 3, 0.0)?
            .joined(block("middle", CellKind::Hex8, 4, 1.0)?)?
            .joined(block("high", CellKind::Tet4, 3, 2.0)?)?;
        let mut pairs = [("middle.bottom", "low.top"), ("high.bottom", "middle.top")];
        if middle_first {
            pairs[1] = (pairs[1].1, pairs[1].0);
        }
        let law = Coulomb::new(0.3)?;
        let mut model = Model::new(mesh, Solid);
        for name in ["low", "middle", "high"] {
            model = model.material(name, Elastic::new(E, NU)?, Integration::Full)?;
        }
        for (own, other) in pairs {
            model = model.contact(own, other, law)?;
        }
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("press")
            .fix("low.left", &[Axis::X])
            .fix("low.back", &[Axis::Z])
            .fix("low.bottom", &[Axis::Y])
            .pressure("high.top", PRESSURE);
        driver.run(&step, 1, |_, _| {})?;
        uniform_stress(&driver, SQUEEZED, "through the middle");
        let middle = driver.contact_force("middle")?;
        assert!(
            middle.norm() <= 1e-10 * PRESSURE * WIDTH * DEPTH,
            "{middle}"
        );
    }
    Ok(())
}
