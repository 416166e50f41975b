//! Contact of two deformable bodies, meshed as they like, in the plane and in space: patches, a block
//! on an incline, Hertz, rings shrunk on each other, and what no choice of meshes or methods may
//! change; not tools.

mod curved;
mod grip;
mod patches;
mod space;
mod space_curved;
mod space_grip;

use crate::close;
use moreau::driver::{Axis, Driver, Loading, Model, ModelError, Settings, Step};
use moreau::laws::{Coulomb, Elastic};
use moreau::mandel::Sym2;
use moreau::mesh::{CellKind, Integration, Mesh, Pairing, PlaneStrain, block2, uniform};
use nalgebra::{Matrix3, Rotation2, SVector, Vector2};
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::fields::prescribed;

const E: f64 = 210e3;
const NU: f64 = 0.3;
const PRESSURE: f64 = 80.0;
const WIDTH: f64 = 6.0;
const HEIGHT: f64 = 2.0;

/// Two blocks, the upper on the lower.
#[derive(Clone)]
struct Stack {
    kinds: [CellKind; 2],
    /// Lines along x of the upper and of the lower block.
    lines: [Vec<f64>; 2],
    young: [f64; 2],
    friction: f64,
    pairing: Pairing,
    /// Whether the lower block is the non-mortar side.
    swapped: bool,
    /// The whole turned by this angle.
    angle: f64,
}

impl Stack {
    fn new(kind: CellKind, cells: [usize; 2]) -> Self {
        Self {
            kinds: [kind; 2],
            lines: cells.map(|n| uniform(0.0, WIDTH, n)),
            young: [E; 2],
            friction: 0.0,
            pairing: Pairing::Mortar,
            swapped: false,
            angle: 0.0,
        }
    }

    fn turn(&self, v: [f64; 2]) -> [f64; 2] {
        (Rotation2::new(self.angle) * Vector2::from(v)).into()
    }

    fn mesh(&self) -> Fallible<Mesh<2>> {
        let upper = uniform(0.0, HEIGHT, 2);
        let lower = uniform(-HEIGHT, 0.0, 2);
        let mesh = block2("upper", self.kinds[0], &self.lines[0], &upper)?.joined(block2(
            "lower",
            self.kinds[1],
            &self.lines[1],
            &lower,
        )?)?;
        Ok(if self.angle == 0.0 {
            mesh
        } else {
            mesh.map(|x| self.turn(x))?
        })
    }

    /// Names of the non-mortar and of the mortar surface.
    fn surfaces(&self) -> [&'static str; 2] {
        let mut surfaces = ["upper.bottom", "lower.top"];
        if self.swapped {
            surfaces.reverse();
        }
        surfaces
    }

    fn driver(&self, mesh: Mesh<2>, settings: Settings<2>) -> Fallible<Driver<2>> {
        let [own, other] = self.surfaces();
        let rule = |kind: CellKind| match kind {
            CellKind::Quad8 | CellKind::Tri6 => Integration::Reduced,
            _ => Integration::Full,
        };
        let model = Model::new(mesh, PlaneStrain::default())
            .material(
                "upper",
                Elastic::new(self.young[0], NU)?,
                rule(self.kinds[0]),
            )?
            .material(
                "lower",
                Elastic::new(self.young[1], NU)?,
                rule(self.kinds[1]),
            )?
            .pair(own, other, Coulomb::new(self.friction)?, self.pairing)?;
        Ok(Driver::new(model, settings)?)
    }
}

/// What holds for every pair: the forces on both surfaces cancel, and the law is obeyed. Returns the
/// force on the upper body.
fn action_is_reaction<const D: usize>(
    driver: &Driver<D>,
    [own, other]: [&str; 2],
) -> Fallible<SVector<f64, D>> {
    let (on_own, on_other) = (driver.contact_force(own)?, driver.contact_force(other)?);
    let size: f64 = driver.contacts().iter().map(|c| c.force.norm()).sum();
    let left = (on_own + on_other).norm();
    assert!(
        left <= 1e-13 * size,
        "{left} N of {size} N are not returned"
    );
    let records: SVector<f64, D> = driver.contacts().iter().map(|c| c.force).sum();
    assert!((records - on_own).norm() <= 1e-13 * size);
    Ok(if own.starts_with("upper") {
        on_own
    } else {
        on_other
    })
}

/// The largest distance of the stress at any point from a uniform one, over that one.
fn stress_error<const D: usize>(driver: &Driver<D>, exact: [f64; 6]) -> f64 {
    let exact = Sym2::from_column_slice(&exact);
    let error = |s: Sym2| (s - exact).norm() / exact.norm();
    let points = driver.points();
    points.iter().map(|p| error(p.stress)).fold(0.0, f64::max)
}

/// A stress by its Mandel components.
fn mandel(s: &Matrix3<f64>) -> [f64; 6] {
    let shear = |i, j| 2f64.sqrt() * s[(i, j)];
    let [a, b, c] = [0, 1, 2].map(|i| s[(i, i)]);
    [a, b, c, shear(1, 2), shear(0, 2), shear(0, 1)]
}

/// Asserts that the stress is the same everywhere.
#[track_caller]
fn uniform_stress<const D: usize>(driver: &Driver<D>, exact: [f64; 6], what: &str) {
    let error = stress_error(driver, exact);
    assert!(error <= 1e-10, "{what}: stress off by {error:.2e}");
}

#[test]
fn pairs_that_make_no_sense_are_refused() -> Fallible {
    let law = Coulomb::new(0.1)?;
    let stack = Stack::new(CellKind::Quad4, [2, 3]);
    let model = || -> Fallible<Model<2, PlaneStrain>> {
        Ok(Model::new(stack.mesh()?, PlaneStrain::default()))
    };
    match model()?.contact("upper.bottom", "lower.tip", law).err() {
        Some(ModelError::UnknownOpposite { nearest, .. }) => {
            assert_eq!(nearest.as_deref(), Some("lower.top"));
        }
        other => return Err(format!("{other:?}").into()),
    }
    match model()?.contact("upper.bottom", "upper.left", law).err() {
        Some(ModelError::SharedSurfaceNode { position, .. }) => assert_eq!(position, [0.0, 0.0]),
        other => return Err(format!("{other:?}").into()),
    }
    // A body that flew off is not held: without an overlap there is no contact.
    let apart = Stack {
        lines: [uniform(0.0, 1.0, 2), uniform(2.0, 3.0, 2)],
        ..stack
    };
    let mut driver = apart.driver(apart.mesh()?, Settings::default())?;
    let step = Step::new("press")
        .fix("upper.left", &[Axis::X])
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .pressure("upper.top", PRESSURE);
    let error = driver.run(&step, 1, |_, _| {}).err();
    assert!(error.is_some_and(|e| e.to_string().contains("free to move")));
    Ok(())
}
