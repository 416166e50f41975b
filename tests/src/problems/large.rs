//! Problems of large strain with reference figures of an independent implementation; not the checks made
//! on them.

use super::Fallible;
use crate::workspace;
use moreau::contact::Plane;
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, VonMises};
use moreau::mesh::{CellKind, Facet, Integration, Mesh, block2, uniform};

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

/// A block that an edge at the top presses or platens squeeze, its cells, and where it may touch.
#[derive(Clone, Copy)]
pub struct Billet<'a> {
    /// Lower and upper ends in x, or r \[mm\].
    pub x: [f64; 2],
    /// Height \[mm\].
    pub height: f64,
    /// Cells along both.
    pub cells: [usize; 2],
    /// Their kind and rule.
    pub kind: (CellKind, Integration),
    /// Sides that may touch the platen; [`Billet::mesh`] has those but what is on the foot.
    pub touching: &'a [&'a str],
}

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
        if !facets.is_empty() {
            mesh.add_facet_group("block.surface", facets)?;
        }
        Ok(mesh)
    }

    /// The billet under a platen with this friction, or without it.
    ///
    /// # Errors
    /// None for a hardening modulus and a coefficient of friction that are not negative.
    pub fn driver<H: Analysis<2>>(
        &self,
        hypothesis: H,
        hardening: f64,
        friction: Option<f64>,
    ) -> Fallible<Driver<2>> {
        let mut model = Model::with_large_strains(self.mesh()?, hypothesis).material(
            "block",
            steel(hardening)?,
            self.kind.1,
        )?;
        if let Some(mu) = friction {
            model = model
                .tool("platen", Plane::new([0.0, self.height], [0.0, -1.0])?)?
                .contact("block.surface", "platen", Coulomb::new(mu)?)?;
        }
        Ok(Driver::new(model, Settings::default())?)
    }

    /// The platen goes down by this.
    pub fn squeezed(&self, by: f64) -> Step<2> {
        let step = Step::new("upset")
            .fix("block.bottom", &[Axis::Y])
            .tool("platen", [0.0, -by]);
        match self.x[0] == 0.0 {
            true => step.fix("block.left", &[Axis::X]),
            false => step,
        }
    }
}
