//! A block under a pressure p and a shear q on its top: what statics alone says of the contact below,
//! and the linear pressure under a block that is rigid beside its bed; not an incline.
//!
//! With the width w and the height h, whatever the block is made of: Σ t_n = p w, Σ t_t = −q w,
//! Σ t_n x = q h w; it slides at q = μ p, and tips at q h = p w / 2. A rigid block on an elastic bed:
//! p (1 + 12 (q/p) (h/w) (x/w)), so that an edge lifts off at q h / (p w) = 1/6.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Analysis, Axis, Driver, IncrementError, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Mesh, PlaneStrain, Solid, block2, block3, uniform};
use nalgebra::SVector;
use std::array::from_fn;
use verification::problems::Fallible;

const WIDTH: f64 = 6.0;
/// Along z.
const DEPTH: f64 = 4.0;
const PRESSURE: f64 = 80.0;

/// A block on the plane y = 0, with the middle of its base at the origin.
struct Pad<H, const D: usize> {
    hypothesis: H,
    kind: CellKind,
    height: f64,
    young: f64,
    friction: f64,
    /// Of the shear, along the base.
    direction: [f64; D],
    make: fn(&str, CellKind, [f64; 2], [usize; 3]) -> Fallible<Mesh<D>>,
}

fn plane(height: f64, friction: f64) -> Pad<PlaneStrain, 2> {
    Pad {
        hypothesis: PlaneStrain::default(),
        kind: CellKind::Quad8,
        height,
        young: 210e3,
        friction,
        direction: [1.0, 0.0],
        make: |name, kind, [low, high], [nx, ny, _]| {
            let x = uniform(-0.5 * WIDTH, 0.5 * WIDTH, nx);
            Ok(block2(name, kind, &x, &uniform(low, high, ny))?)
        },
    }
}

/// The shear is along no axis: friction is a cone.
fn space(height: f64, friction: f64) -> Pad<Solid, 3> {
    Pad {
        hypothesis: Solid,
        kind: CellKind::Hex8,
        height,
        young: 210e3,
        friction,
        direction: [0.8, 0.0, 0.6],
        make: |name, kind, [low, high], [nx, ny, nz]| {
            let x = uniform(-0.5 * WIDTH, 0.5 * WIDTH, nx);
            let z = uniform(-0.5 * DEPTH, 0.5 * DEPTH, nz);
            Ok(block3(name, kind, &x, &uniform(low, high, ny), &z)?)
        },
    }
}

impl<H: Analysis<D> + Copy, const D: usize> Pad<H, D> {
    /// What the base measures \[mm²\].
    fn base() -> f64 {
        WIDTH * if D == 3 { DEPTH } else { 1.0 }
    }

    fn shear(&self, q: f64) -> [f64; D] {
        self.direction.map(|along| q * along)
    }

    /// On a rigid plane, pressed but not yet sheared.
    fn pressed(&self) -> Fallible<Driver<D>> {
        let mesh = (self.make)("pad", self.kind, [0.0, self.height], [5, 3, 4])?;
        let model = Model::new(mesh, self.hypothesis)
            .material(
                "pad",
                Elastic::new(self.young, 0.3)?,
                self.kind.integration(),
            )?
            .tool(
                "floor",
                Plane::new([0.0; D], from_fn(|i| f64::from(u8::from(i == 1))))?,
            )?
            .contact("pad.bottom", "floor", Coulomb::new(self.friction)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let press = Step::new("press").pressure("pad.top", PRESSURE);
        driver.run(&press, 1, |_, _| {})?;
        Ok(driver)
    }

    /// The step to a shear q.
    fn drag(&self, q: f64) -> Step<D> {
        let shear = self.shear(q);
        Step::new("drag")
            .pressure("pad.top", PRESSURE)
            .traction("pad.top", shear)
    }

    /// Force and moments Σ t_n x about the middle of the base, against those of the loads.
    fn in_balance(&self, driver: &Driver<D>, q: f64, tolerance: f64) {
        let (area, shear) = (Self::base(), self.shear(q));
        let contacts = driver.contacts();
        let force: SVector<f64, D> = contacts.iter().map(|c| c.force).sum();
        for axis in 0..D {
            let arm = contacts.iter().map(|c| c.position[axis] * c.force[1]);
            let moment: f64 = arm.sum();
            let (expected, lever) = match axis {
                1 => (PRESSURE * area, 0.0),
                _ => (-shear[axis] * area, self.height * shear[axis] * area),
            };
            let scale = PRESSURE * area;
            assert!(
                (force[axis] - expected).abs() <= tolerance * scale,
                "force {axis} at q = {q}: {} and {expected}",
                force[axis]
            );
            assert!(
                (moment - lever).abs() <= tolerance * scale * WIDTH,
                "moment {axis} at q = {q}: {moment} and {lever}"
            );
        }
    }

    /// Carries a shear up to the limit and no further, and ends in collapse when loaded beyond.
    fn carries(&self, limit: f64) -> Fallible<Driver<D>> {
        let mut driver = self.pressed()?;
        for part in [0.3, 0.7, 0.999] {
            driver.run(&self.drag(part * limit), 1, |_, _| {})?;
            self.in_balance(&driver, part * limit, 1e-10);
        }
        self.beyond(limit, 1.001)?;
        self.beyond(limit, 2.0)
    }

    /// Loaded beyond the limit, in increments of which one may meet it exactly.
    fn beyond(&self, limit: f64, factor: f64) -> Fallible<Driver<D>> {
        let mut driver = self.pressed()?;
        match driver.run(&self.drag(factor * limit), 4, |_, _| {}) {
            Err(IncrementError::Collapse { collapse, .. }) => {
                let found = collapse.load_factor * factor;
                close("shear at the limit", found, 1.0, 1e-6);
            }
            Err(error) => return Err(error.into()),
            Ok(_) => panic!("{factor} of the limit is carried"),
        }
        self.in_balance(&driver, limit, 1e-5);
        Ok(driver)
    }
}

#[test]
fn a_pad_slides_when_its_shear_is_the_friction_of_its_pressure() -> Fallible {
    fn check<H: Analysis<D> + Copy, const D: usize>(pad: &Pad<H, D>) -> Fallible {
        let driver = pad.carries(pad.friction * PRESSURE)?;
        for c in driver.contacts() {
            assert_eq!(c.status, Status::Slip, "all of it slides");
            for (i, along) in pad.direction.iter().enumerate() {
                // Friction against the shear, everywhere along it: it is a cone.
                if i != 1 {
                    let friction = -pad.friction * c.force[1] * along;
                    assert!((c.force[i] - friction).abs() <= 1e-5 * PRESSURE);
                }
            }
        }
        Ok(())
    }
    for young in [210e3, 1e3] {
        check(&Pad {
            young,
            ..plane(1.0, 0.3)
        })?;
    }
    check(&Pad {
        young: 1e3,
        ..space(1.0, 0.3)
    })
}

#[test]
fn a_pad_tips_when_its_pressure_has_come_to_its_edge() -> Fallible {
    fn check<H: Analysis<D> + Copy, const D: usize>(pad: &Pad<H, D>) -> Fallible {
        // Of the edge, along the shear.
        let reach = 0.5 * WIDTH;
        let driver = pad.carries(PRESSURE * reach / pad.height)?;
        for c in driver.contacts() {
            let at_edge = c.position[0] > reach - 1e-9;
            assert_eq!(c.t[0] <= 1e-4 * PRESSURE, !at_edge, "{:?}", c.position);
        }
        Ok(())
    }
    check(&plane(WIDTH, 0.7))?;
    let mut solid = space(WIDTH, 0.7);
    solid.direction = [1.0, 0.0, 0.0];
    check(&solid)
}

/// A pad on a bed without lateral contraction, of its own width: a uniform shear, and a normal stress
/// linear in x and constant over the height, are an exact solution where the sides of the bed carry the
/// shear too. Displacements are quadratic, and in the space of the elements. Returns the driver under
/// the shear q, with a block so many times as stiff as the bed.
fn on_bed<H: Analysis<D> + Copy, const D: usize>(
    pad: &Pad<H, D>,
    q: f64,
    stiffer: f64,
) -> Fallible<Driver<D>> {
    let young = 1e3;
    let mesh = (pad.make)("pad", pad.kind, [0.0, pad.height], [4, 2, 2])?;
    let mesh = mesh.joined((pad.make)("bed", pad.kind, [-1.0, 0.0], [4, 1, 2])?)?;
    let model = Model::new(mesh, pad.hypothesis)
        .material(
            "pad",
            Elastic::new(stiffer * young, 0.0)?,
            pad.kind.integration(),
        )?
        .material("bed", Elastic::new(young, 0.0)?, pad.kind.integration())?
        .contact("pad.bottom", "bed.top", Coulomb::new(pad.friction)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let side = |sign: f64| from_fn(|i| if i == 1 { sign * q } else { 0.0 });
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let step = pad
        .drag(q)
        .fix("bed.bottom", &axes[..D])
        .traction("bed.right", side(1.0))
        .traction("bed.left", side(-1.0));
    // At once: nothing has turned yet.
    driver.run(&step, 1, |_, _| {})?;
    Ok(driver)
}

/// The largest distance of a pressure from the linear one, over the mean.
fn off_the_line<const D: usize>(driver: &Driver<D>, slope: f64) -> f64 {
    let error = |c: &moreau::driver::ContactRecord<D>| {
        let exact = PRESSURE * (1.0 + 12.0 * slope * c.position[0] / WIDTH);
        (c.traction()[0] - exact).abs() / PRESSURE
    };
    driver.contacts().iter().map(error).fold(0.0, f64::max)
}

#[test]
fn the_pressure_under_a_rigid_pad_is_linear_up_to_lift_off() -> Fallible {
    fn check<H: Analysis<D> + Copy, const D: usize>(pad: &Pad<H, D>) -> Fallible {
        let shear = |slope: f64| slope * PRESSURE * WIDTH / pad.height;
        for slope in [0.05, -0.12, 1.0 / 6.0 - 1e-3] {
            let mut errors = [0.0; 2];
            for (error, stiffer) in errors.iter_mut().zip([1e2, 1e4]) {
                let driver = on_bed(pad, shear(slope), stiffer)?;
                // The motion of a stiff body rounds its forces, and its lever is long.
                pad.in_balance(&driver, shear(slope), 1e-7);
                *error = off_the_line(&driver, slope);
                if stiffer == 1e4 {
                    assert!(driver.contacts().iter().all(|c| c.status == Status::Stick));
                }
            }
            assert!(
                errors[1] <= 1e-4 && errors[1] < 2e-2 * errors[0],
                "{errors:?}"
            );
        }
        // The edge that comes first is the trailing one, whichever side that is.
        for sign in [1.0, -1.0] {
            let slope = sign * (1.0 / 6.0 + 1e-3);
            let driver = on_bed(pad, shear(slope), 1e4)?;
            for c in driver.contacts() {
                let trailing = c.position[0] * sign <= -0.5 * WIDTH + 1e-9;
                assert_eq!(c.status == Status::Open, trailing, "{:?}", c.position);
            }
        }
        Ok(())
    }
    // So high that nothing slides before the edge lifts off: q/p = w/h of the slope.
    let (height, friction) = (10.0 * WIDTH, 3.0);
    check(&plane(height, friction))?;
    let mut solid = space(height, friction);
    (solid.kind, solid.direction) = (CellKind::Hex27, [1.0, 0.0, 0.0]);
    check(&solid)
}
