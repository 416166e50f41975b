//! The paper's two problems as drivers, and the independent reference figures for them; not the
//! checks made on them.

use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau::laws::{Coulomb, VonMises};
use moreau::mesh::{
    CellKind, Integration, Mesh, MeshError, PlaneStrain, block2, geometric, refine, uniform,
};
use std::error::Error;

/// Young's modulus of both problems \[MPa\].
pub const YOUNG: f64 = 210_000.0;
/// Poisson's ratio of both problems.
pub const POISSON: f64 = 0.3;
/// Yield stress of both problems \[MPa\].
pub const YIELD_STRESS: f64 = 300.0;
/// Half-width of Prandtl's punch \[mm\].
pub const HALF_WIDTH: f64 = 10.0;
/// Travel of Prandtl's punch \[mm\], in [`PRANDTL_INCREMENTS`].
pub const PRANDTL_TRAVEL: f64 = 0.4;
/// Increments of Prandtl's problem.
pub const PRANDTL_INCREMENTS: usize = 40;
/// Travel of the punch on the block \[mm\], in [`BLOCK_INCREMENTS`].
pub const BLOCK_TRAVEL: f64 = 0.2;
/// Increments of the punched block.
pub const BLOCK_INCREMENTS: usize = 20;

/// Prandtl's limit load of the whole punch, B σ_y/√3 (2 + π) \[N/mm\].
pub fn prandtl_load() -> f64 {
    2.0 * HALF_WIDTH * YIELD_STRESS / 3f64.sqrt() * (2.0 + std::f64::consts::PI)
}

/// Grid lines of the mesh of 56 cells: columns from the axis outwards, rows from the bottom up.
pub fn prandtl_lines() -> (Vec<f64>, Vec<f64>) {
    let mut x = uniform(0.0, HALF_WIDTH, 4);
    x.extend(
        geometric(HALF_WIDTH, 2.5 * 1.640849940365, 1.640849940365, 4)
            .into_iter()
            .skip(1),
    );
    let mut y = geometric(0.0, -2.5, 1.342041860819, 7);
    y.reverse();
    // The ratios are rounded in the twelfth digit; the block ends at 50 mm.
    if let (Some(last), Some(first)) = (x.last_mut(), y.first_mut()) {
        (*last, *first) = (50.0, -50.0);
    }
    (x, y)
}

/// Paper 8.1: half of a block under a rigid, flat, smooth punch, every interval of the 56-cell
/// mesh cut into `refinement` parts.
///
/// # Errors
/// None for a refinement of 1 or more.
pub fn prandtl(
    refinement: usize,
    integration: Integration,
    settings: Settings<2>,
) -> Result<Driver<2>, Box<dyn Error>> {
    let (x, y) = prandtl_lines();
    let (x, y) = (refine(&x, refinement), refine(&y, refinement));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    mesh.facet_group_where("contact", "block.top", |x| {
        x[0] <= HALF_WIDTH * (1.0 + 1e-9)
    })?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "block",
            VonMises::new(YOUNG, POISSON, YIELD_STRESS)?,
            integration,
        )?
        .tool("punch", Plane::new([0.0, 0.0], [0.0, -1.0])?)?
        .contact("contact", "punch", Coulomb::new(0.0)?)?;
    Ok(Driver::new(model, settings)?)
}

/// The step of Prandtl's problem: the punch travels down.
pub fn prandtl_step(travel: f64) -> Step<2> {
    Step::new("indent")
        .fix("block.left", &[Axis::X])
        .fix("block.right", &[Axis::X])
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .tool("punch", [0.0, -travel])
}

/// Load of the whole punch \[N/mm\].
///
/// # Errors
/// None on a driver of [`prandtl`].
pub fn prandtl_punch_load(driver: &Driver<2>) -> Result<f64, ModelError> {
    Ok(-2.0 * driver.tool_force("punch")?[1])
}

/// Paper 8.2: half of a block 100 mm × 20 mm on a rigid foundation with Coulomb friction, punched
/// over half of its top; `cells` along x and y.
///
/// # Errors
/// A friction that is negative.
pub fn block(
    cells: [usize; 2],
    friction: f64,
    integration: Integration,
    settings: Settings<2>,
) -> Result<Driver<2>, Box<dyn Error>> {
    block_of(block_mesh(cells)?, friction, integration, settings)
}

/// [`block`], with every node moved by up to `size` times its coordinates, differently for every
/// seed: what rounding may do.
///
/// # Errors
/// As [`block`]; a size that turns cells inside out.
pub fn shaken_block(
    cells: [usize; 2],
    friction: f64,
    (seed, size): (u64, f64),
    settings: Settings<2>,
) -> Result<Driver<2>, Box<dyn Error>> {
    let noise = |x: f64, salt: u64| {
        // The finaliser of a common generator: bits that look random.
        let mut z = x.to_bits() ^ (seed << 8 | salt).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x * (1.0 + size * ((z >> 11) as f64 / (1u64 << 52) as f64 - 1.0))
    };
    let mesh = block_mesh(cells)?.map(|[x, y]| [noise(x, 1), noise(y, 2)])?;
    block_of(mesh, friction, Integration::Reduced, settings)
}

fn block_of(
    mesh: Mesh<2>,
    friction: f64,
    integration: Integration,
    settings: Settings<2>,
) -> Result<Driver<2>, Box<dyn Error>> {
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "block",
            VonMises::new(YOUNG, POISSON, YIELD_STRESS)?,
            integration,
        )?
        .tool("foundation", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
        .contact("block.bottom", "foundation", Coulomb::new(friction)?)?;
    Ok(Driver::new(model, settings)?)
}

fn block_mesh([nx, ny]: [usize; 2]) -> Result<Mesh<2>, MeshError> {
    let (x, y) = (uniform(0.0, 50.0, nx), uniform(0.0, 20.0, ny));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    mesh.node_group_where("punch", "block.top", |x| x[0] <= 25.0 * (1.0 + 1e-9))?;
    Ok(mesh)
}

/// The punch moves to a total travel, downwards positive.
pub fn block_step(travel: f64) -> Step<2> {
    Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -travel)
}

/// Load of the punch on half of the block \[N/mm\].
///
/// # Errors
/// None on a driver of [`block`].
pub fn block_punch_load(driver: &Driver<2>) -> Result<f64, ModelError> {
    Ok(-driver.reaction("punch")?[1])
}

/// Reference figures: an independent implementation (closest-point return, exact Coulomb law by an
/// active-set Newton method, residual 1e-10), cross-checked by conic optimisation on single
/// increments and by an augmented Lagrangian in another program on the whole paths.
pub mod reference {
    use std::collections::BTreeMap;

    macro_rules! file {
        ($name:literal) => {
            ($name, include_str!(concat!("../reference/", $name, ".csv")))
        };
    }

    const FILES: [(&str, &str); 13] = [
        file!("B_mesh20_g2_mu0.05_exact_contact_final"),
        file!("B_mesh20_g2_mu0.05_exact_load"),
        file!("B_mesh20_g2_mu0.1_exact_contact_final"),
        file!("B_mesh20_g2_mu0.1_exact_load"),
        file!("B_mesh20_g2_mu0.1_unload_exact_contact_final"),
        file!("B_mesh20_g2_mu0.1_unload_exact_load"),
        file!("B_mesh20_g3_mu0.1_exact_contact_final"),
        file!("B_mesh20_g3_mu0.1_exact_load"),
        file!("P_mesh56_g2_exact_contact_final"),
        file!("P_mesh56_g2_exact_load"),
        file!("P_mesh56_g3_exact_contact_final"),
        file!("P_mesh56_g3_exact_load"),
        file!("P_meshx2_g2_exact_load"),
    ];

    /// A row of a file, by column name.
    pub type Row = BTreeMap<&'static str, &'static str>;

    /// Rows of a reference file, by its name without ending; empty for an unknown name.
    pub fn rows(name: &str) -> Vec<Row> {
        let Some((_, text)) = FILES.iter().find(|(n, _)| *n == name) else {
            return Vec::new();
        };
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        lines
            .map(|line| header.iter().copied().zip(line.split(',')).collect())
            .collect()
    }

    /// A column as numbers; NaN where it is none.
    pub fn column(name: &str, column: &str) -> Vec<f64> {
        let number = |row: &Row| {
            row.get(column)
                .and_then(|v| v.parse().ok())
                .unwrap_or(f64::NAN)
        };
        rows(name).iter().map(number).collect()
    }
}
