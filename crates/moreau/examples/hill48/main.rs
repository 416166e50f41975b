//! A sheet of Hill's law pulled along and across its rolling direction, with the closed forms and, where
//! it is isotropic, von Mises; not the law itself.

mod law;

use law::Hill48;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{BulkLaw, Elastic, VonMises, contract};
use moreau::mandel::Sym2;
use moreau::mesh::{CellKind, Integration, Solid, block3};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

const YOUNG: f64 = 210e3;
const YIELD: f64 = 300.0;
const HARDENING: f64 = 1e3;
const SHEET: [f64; 6] = [0.3, 0.4, 0.6, 1.5, 1.5, 1.2];

/// Uniaxial stress \[MPa\] and strains of a cube stretched along an axis.
fn pulled(along: Axis, strain: f64) -> Fallible<(f64, [f64; 3])> {
    let law = Hill48::new(Elastic::new(YOUNG, 0.3)?, SHEET, YIELD, HARDENING)?;
    let (unit, k, corner) = ([0.0, 1.0], along.index(), 7);
    let mut mesh = block3("cube", CellKind::Hex8, &unit, &unit, &unit)?;
    mesh.node_group_where("end", "cube", |x| x[k] == 1.0)?;
    let mut step = Step::new("pull").displace("end", along, strain);
    for (name, axis) in [("at x", Axis::X), ("at y", Axis::Y), ("at z", Axis::Z)] {
        mesh.node_group_where(name, "cube", |x| x[axis.index()] == 0.0)?;
        step = step.fix(name, &[axis]);
    }
    let model = Model::new(mesh, Solid).material("cube", law, Integration::BBar)?;
    let mut driver = Driver::new(model, Settings::default())?;
    driver.run(&step, 4, |_, _| {})?;
    let force = driver.reaction("end")?[k];
    assert_eq!(driver.mesh().nodes()[corner], [1.0; 3]);
    Ok((force, driver.displacement(corner).into()))
}

pub(crate) fn main() -> Fallible<()> {
    let elastic = Elastic::new(YOUNG, 0.3)?;
    contract::bulk(&Hill48::new(elastic, SHEET, YIELD, HARDENING)?)?;
    // σ r = σ_y + H α with r² = G + H along and F + H across, α r = ε − σ/E; thinning by the flow rule.
    let ([f, g, h, ..], strain) = (SHEET, 0.02);
    for (along, r, thinning) in [(Axis::X, (g + h).sqrt(), g), (Axis::Y, (f + h).sqrt(), f)] {
        let (stress, u) = pulled(along, strain)?;
        let exact = (YIELD + HARDENING * strain / r) / (r + HARDENING / (YOUNG * r));
        assert!(
            (stress / exact - 1.0).abs() < 1e-10,
            "{along:?}: {stress} {exact}"
        );
        let plastic = |i: usize, elastic: f64| u[i] - elastic * stress / YOUNG;
        let part = plastic(2, -0.3) / plastic(along.index(), 1.0);
        assert!(
            (part + thinning / (r * r)).abs() < 1e-10,
            "{along:?}: {part}"
        );
    }
    // F = G = H = ½ and L = M = N = 3⁄2 make it von Mises, and a law without axes.
    let isotropic = Hill48::new(elastic, [0.5, 0.5, 0.5, 1.5, 1.5, 1.5], YIELD, HARDENING)?;
    contract::isotropy(&isotropic)?;
    let mises = VonMises::new(YOUNG, 0.3, YIELD)?.with_isotropic(HARDENING)?;
    let (mut a, mut b) = (isotropic.initial(), mises.initial());
    for step in [
        [4e-3, -1e-3, 0.0, 1e-3, 0.0, 2e-3],
        [-2e-3, 0.0, 3e-3, 0.0, -4e-3, 1e-3],
    ] {
        let (hill, other) = (
            isotropic.respond(&a, &Sym2::from(step)),
            mises.respond(&b, &Sym2::from(step)),
        );
        assert!(hill.flows && (hill.stress - other.stress).norm() < 1e-10 * YIELD);
        assert!((hill.tangent - other.tangent).norm() < 1e-10 * YOUNG);
        (a, b) = (hill.state, other.state);
    }
    Ok(())
}
