//! Problems of large strain with reference figures of an independent implementation; not the comparison with
//! them.

mod reference;

pub use reference::{Difference, Tables};

use super::Fallible;
use moreau::contact::{Ball, Plane};
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Isotropic, VonMises};
use moreau::mesh::{
    Axisymmetric, CellKind, Facet, Integration, Mesh, PlaneStrain, block2, uniform,
};

/// Steel of the platens and discs.
///
/// # Errors
/// None for a hardening modulus that is not negative.
pub fn steel(hardening: f64) -> Fallible<VonMises> {
    Ok(VonMises::new(210e3, 0.3, 300.0)?.with_isotropic(hardening)?)
}

/// Kinds of cells, their rules and what tables call them.
pub type Cells = (CellKind, Integration, &'static str);

/// Serendipity cells with four points.
pub const QUAD8: Cells = (CellKind::Quad8, Integration::Reduced, "Q8");

/// Linear cells with the mean dilatation.
pub const QUAD4: Cells = (CellKind::Quad4, Integration::BBar, "Q4md");

/// A block of steel that a platen presses from above.
#[derive(Clone, Copy)]
pub struct Billet<'a> {
    /// Lower and upper ends in x, or r \[mm\].
    pub x: [f64; 2],
    /// Height \[mm\].
    pub height: f64,
    /// Cells along both.
    pub cells: [usize; 2],
    /// What they are.
    pub kind: Cells,
    /// Sides that may touch the platen.
    pub touching: &'a [&'a str],
}

/// The square block of plane strain, a quarter.
pub const SQUARE: Billet<'static> = Billet {
    x: [0.0, 10.0],
    height: 10.0,
    cells: [8, 8],
    kind: QUAD8,
    touching: &["top", "right"],
};

/// The cylinder, its upper half.
pub const CYLINDER: Billet<'static> = Billet {
    height: 15.0,
    cells: [8, 12],
    ..SQUARE
};

/// The ring 6 : 3 : 2, its upper half.
pub const RING: Billet<'static> = Billet {
    x: [4.5, 9.0],
    height: 3.0,
    cells: [12, 8],
    touching: &["top", "left", "right"],
    ..SQUARE
};

impl Billet<'_> {
    /// Its mesh, with what may touch as the facets of `block.surface`.
    ///
    /// # Errors
    /// None for sizes and counts that are positive.
    pub fn mesh(&self) -> Fallible<Mesh<2>> {
        let x = uniform(self.x[0], self.x[1], self.cells[0]);
        let y = uniform(0.0, self.height, self.cells[1]);
        let mut mesh = block2("block", self.kind.0, &x, &y)?;
        let mut facets: Vec<Facet> = Vec::new();
        for side in self.touching {
            facets.extend(mesh.facet_group(&format!("block.{side}"))?);
        }
        mesh.add_facet_group("block.surface", facets)?;
        Ok(mesh)
    }

    /// The billet under its platen, with this hardening modulus \[MPa\] and friction.
    ///
    /// # Errors
    /// None for numbers that are not negative.
    pub fn driver<H: Analysis<2>>(
        &self,
        hypothesis: H,
        hardening: f64,
        friction: f64,
    ) -> Fallible<Driver<2>> {
        let model = Model::with_large_strains(self.mesh()?, hypothesis)
            .material("block", steel(hardening)?, self.kind.1)?
            .tool("platen", Plane::new([0.0, self.height], [0.0, -1.0])?)?
            .contact("block.surface", "platen", Coulomb::new(friction)?)?;
        Ok(Driver::new(model, Settings::default())?)
    }

    /// Its foot and its axis of symmetry are held.
    pub fn held(&self, step: &str) -> Step<2> {
        let step = Step::new(step).fix("block.bottom", &[Axis::Y]);
        match self.x[0] == 0.0 {
            true => step.fix("block.left", &[Axis::X]),
            false => step,
        }
    }
}

/// Half of a block of 40 mm × 20 mm that sticks to its ground, under a disc of radius 10 mm.
///
/// # Errors
/// None for a coefficient of friction that is not negative.
pub fn indented(friction: f64) -> Fallible<Driver<2>> {
    let lines = |fine: f64, cells: usize, coarse: f64| {
        let mut all = uniform(0.0, fine, cells);
        all.extend((1..=6).map(|i| fine + coarse * (f64::from(i) / 6.0).powf(1.5)));
        all
    };
    let x = lines(7.0, 14, 13.0);
    let mut y: Vec<f64> = lines(4.0, 8, 16.0).iter().map(|y| 20.0 - y).collect();
    y.reverse();
    let mesh = block2("block", CellKind::Quad8, &x, &y)?;
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("block", steel(500.0)?, Integration::Reduced)?
        .tool("disc", Ball::new([0.0, 30.0], 10.0)?)?
        .contact("block.top", "disc", Coulomb::new(friction)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// A block of 20 mm × 20 mm between two platens that turn about its middle.
///
/// # Errors
/// None.
pub fn turned() -> Fallible<Driver<2>> {
    let lines = uniform(-10.0, 10.0, 8);
    let mut mesh = block2("block", CellKind::Quad8, &lines, &lines)?;
    mesh.node_group_where("pin", "block", |x| x[0].hypot(x[1]) < 1e-9)?;
    for (half, side, sign) in [("upper", "block.top", 1.0), ("lower", "block.bottom", -1.0)] {
        let mut facets = mesh.facet_group(side)?.to_vec();
        for side in ["left", "right"] {
            let name = format!("{half}-{side}");
            mesh.facet_group_where(&name, &format!("block.{side}"), |x| sign * x[1] > -1e-9)?;
            facets.extend(mesh.facet_group(&name)?);
        }
        mesh.add_facet_group(half, facets)?;
    }
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("block", steel(500.0)?, Integration::Reduced)?
        .tool("top", Plane::new([0.0, 10.0], [0.0, -1.0])?)?
        .reference([0.0, 0.0])?
        .contact("upper", "top", Coulomb::new(0.3)?)?
        .tool("bottom", Plane::new([0.0, -10.0], [0.0, 1.0])?)?
        .reference([0.0, 0.0])?
        .contact("lower", "bottom", Coulomb::new(0.3)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// A bar of 53.3 mm that is drawn until it necks, an eighth of its section: slightly thinner in the middle, with
/// hardening that saturates.
///
/// # Errors
/// None.
pub fn bar(kind: Cells) -> Fallible<Driver<2>> {
    let (length, radius) = (26.667, 6.413);
    let (x, y) = (uniform(0.0, radius, 4), uniform(0.0, length, 15));
    let mesh =
        block2("bar", kind.0, &x, &y)?.map(|x| [x[0] * (0.982 + 0.018 * x[1] / length), x[1]])?;
    let hardening = Isotropic::voce(0.715 - 0.45, 16.93)?.with_linear(0.12924)?;
    let law = VonMises::new(206.9, 0.29, 0.45)?.with_hardening(hardening);
    let model = Model::with_large_strains(mesh, Axisymmetric).material("bar", law, kind.1)?;
    Ok(Driver::new(model, Settings::default())?)
}
