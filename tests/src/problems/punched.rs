//! The punched elastoplastic block on a rigid foundation with friction, in any units; not the
//! loads it is compared with.

use super::Fallible;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, PlaneStrain, block2, uniform};

/// Half of a steel block of 100 mm by 20 mm, punched over the middle half of its top.
#[derive(Debug, Clone, Copy)]
pub struct Punched {
    /// Millimetres in the unit of length.
    pub length: f64,
    /// Megapascals in the unit of stress.
    pub stress: f64,
    /// Translation of body and foundation, in the unit of length.
    pub origin: [f64; 2],
    /// Coefficient of friction.
    pub friction: f64,
    /// Cells along the half and across the height.
    pub cells: (usize, usize),
    /// Quadrature.
    pub integration: Integration,
    /// Yield stress \[MPa\].
    pub yield_stress: f64,
    /// Linear isotropic hardening \[MPa\].
    pub hardening: f64,
}

impl Default for Punched {
    fn default() -> Self {
        Self {
            length: 1.0,
            stress: 1.0,
            origin: [0.0; 2],
            friction: 0.1,
            cells: (10, 2),
            integration: Integration::Reduced,
            yield_stress: 300.0,
            hardening: 0.0,
        }
    }
}

impl Punched {
    /// Half of the block, symmetric about its left side.
    ///
    /// # Errors
    /// Those of the mesh.
    pub fn half_mesh(&self) -> Fallible<Mesh<2>> {
        self.mesh(0.0, self.cells.0)
    }

    /// The whole block.
    ///
    /// # Errors
    /// Those of the mesh.
    pub fn full_mesh(&self) -> Fallible<Mesh<2>> {
        self.mesh(-50.0, 2 * self.cells.0)
    }

    fn mesh(&self, left: f64, columns: usize) -> Fallible<Mesh<2>> {
        let [x0, y0] = self.origin;
        let x: Vec<f64> = uniform(left, 50.0, columns)
            .iter()
            .map(|x| x0 + x / self.length)
            .collect();
        let y: Vec<f64> = uniform(0.0, 20.0, self.cells.1)
            .iter()
            .map(|y| y0 + y / self.length)
            .collect();
        let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
        let reach = 25.0 / self.length * (1.0 + 1e-9);
        mesh.node_group_where("punch", "block.top", |x| (x[0] - x0).abs() <= reach)?;
        Ok(mesh)
    }

    /// The driver of a mesh of this block.
    ///
    /// # Errors
    /// Those of the model.
    pub fn driver(&self, mesh: Mesh<2>, settings: Settings<2>) -> Fallible<Driver<2>> {
        let law = VonMises::new(210e3 / self.stress, 0.3, self.yield_stress / self.stress)?
            .with_isotropic(self.hardening / self.stress)?;
        let model = Model::new(mesh, PlaneStrain::new(1.0 / self.length)?)
            .material("block", law, self.integration)?
            .tool("foundation", Plane::new(self.origin, [0.0, 1.0])?)?
            .contact("block.bottom", "foundation", Coulomb::new(self.friction)?)?;
        Ok(Driver::new(model, settings)?)
    }

    /// The driver of the half, with default settings.
    ///
    /// # Errors
    /// Those of the model.
    pub fn half(&self) -> Fallible<Driver<2>> {
        self.driver(self.half_mesh()?, Settings::default())
    }

    /// Presses the punch of the half to a depth \[mm\].
    pub fn press(&self, depth: f64) -> Step<2> {
        Step::new("press").fix("block.left", &[Axis::X]).displace(
            "punch",
            Axis::Y,
            -depth / self.length,
        )
    }

    /// Load of the punch, downwards \[N\].
    ///
    /// # Errors
    /// None if the mesh is one of this block.
    pub fn load(&self, driver: &Driver<2>) -> Fallible<f64> {
        Ok(-driver.reaction("punch")?[1] * self.stress * self.length.powi(2))
    }
}
