//! Problems of large strain with reference figures of an independent implementation; not the checks made
//! on them.

use super::Fallible;
use crate::workspace;
use moreau::contact::Plane;
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Isotropic, VonMises};
use moreau::mesh::{Axisymmetric, CellKind, Facet, Integration, Mesh, block2, uniform};

/// A table of `tests/reference/finite`: a header, and rows of numbers and words.
pub struct Reference {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Reference {
    /// The table of that name.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(name: &str) -> Fallible<Self> {
        let path = workspace::root().join(format!("tests/reference/finite/{name}.csv"));
        let text =
            std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let header = cells(lines.next().unwrap_or_default());
        let rows = lines.map(cells).collect();
        Ok(Self { header, rows })
    }

    fn at<'a>(&self, row: &'a [String], column: &str) -> &'a str {
        let index = self.header.iter().position(|name| name == column);
        index.and_then(|i| row.get(i)).map_or("", String::as_str)
    }

    /// A column of numbers; NaN where it has none.
    pub fn column(&self, column: &str) -> Vec<f64> {
        let number = |row: &Vec<String>| self.at(row, column).parse().unwrap_or(f64::NAN);
        self.rows.iter().map(number).collect()
    }

    /// A column of words.
    pub fn words(&self, column: &str) -> Vec<&str> {
        let word = |row| self.at(row, column);
        self.rows.iter().map(|row| word(row.as_slice())).collect()
    }
}

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
