//! Blocks mapped to the shapes of the benchmarks; not their loads.

use moreau::mesh::{CellKind, Integration, Mesh, MeshError, block2, block3, geometric, uniform};
use std::f64::consts::FRAC_PI_2;

/// All pairs of a plane kind and a rule without spurious modes that the outline leaves free.
pub const PLANE_ELEMENTS: [(CellKind, Integration); 8] = [
    (CellKind::Tri3, Integration::Full),
    (CellKind::Tri6, Integration::Reduced),
    (CellKind::Tri6, Integration::Full),
    (CellKind::Quad4, Integration::Full),
    (CellKind::Quad4, Integration::BBar),
    (CellKind::Quad8, Integration::Reduced),
    (CellKind::Quad8, Integration::Full),
    (CellKind::Quad9, Integration::Full),
];

/// From radius and angle.
fn polar([r, angle]: [f64; 2]) -> [f64; 2] {
    [r * angle.cos(), r * angle.sin()]
}

/// A quarter of a ring, `radial` × `around` cells. Sides: `body.left` the bore, `body.right` the
/// outside, `body.bottom` on the axis x, `body.top` on the axis y.
///
/// # Errors
/// Those of [`block2`].
pub fn quarter_ring(
    kind: CellKind,
    (inner, outer): (f64, f64),
    (radial, around): (usize, usize),
) -> Result<Mesh<2>, MeshError> {
    let mesh = block2(
        "body",
        kind,
        &uniform(inner, outer, radial),
        &uniform(0.0, FRAC_PI_2, around),
    )?;
    mesh.map(|x| match x[1] == FRAC_PI_2 {
        true => [0.0, x[0]],
        false => polar(x),
    })
}

/// Cook's membrane, n × n cells: clamped at `body.left`, loaded at `body.right`.
///
/// # Errors
/// Those of [`block2`].
pub fn cook(kind: CellKind, n: usize) -> Result<Mesh<2>, MeshError> {
    let lines = uniform(0.0, 1.0, n);
    block2("body", kind, &lines, &lines)?
        .map(|[s, t]| [48.0 * s, 44.0 * s + t * (44.0 + s * (16.0 - 44.0))])
}

/// Shape of a central hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hole {
    /// A circle of the diameter given.
    Round,
    /// A square of that side.
    Square,
}

/// A quarter of a plate `width` × `length` with a central hole, n cells from the hole to the
/// edge and 2n around it. Sides: `body.left` the hole, `body.bottom` on x and `body.top` on y; the
/// edges of the plate are the groups `plate.right` and `plate.top`.
///
/// # Errors
/// Those of [`block2`].
pub fn holed_plate(
    kind: CellKind,
    shape: Hole,
    (width, length, hole): (f64, f64, f64),
    n: usize,
) -> Result<Mesh<2>, MeshError> {
    let mesh = block2(
        "body",
        kind,
        &uniform(0.0, 1.0, n),
        &uniform(0.0, 2.0, 2 * n),
    )?;
    let mut mesh = mesh.map(|x| around_hole(shape, (width, length, hole), x))?;
    let w = 0.5 * width;
    mesh.facet_group_where("plate.right", "body.right", |x| x[0] > w * (1.0 - 1e-12))?;
    mesh.facet_group_where("plate.top", "body.right", |x| {
        x[1] > 0.5 * length * (1.0 - 1e-12)
    })?;
    Ok(mesh)
}

/// The quarter of [`holed_plate`] as one layer of solid cells, z from 0 to the thickness.
///
/// # Errors
/// Those of [`block3`].
pub fn holed_slab(
    kind: CellKind,
    shape: Hole,
    (width, length, hole): (f64, f64, f64),
    thickness: f64,
    n: usize,
) -> Result<Mesh<3>, MeshError> {
    let mesh = block3(
        "body",
        kind,
        &uniform(0.0, 1.0, n),
        &uniform(0.0, 2.0, 2 * n),
        &uniform(0.0, thickness, 1),
    )?;
    let mut mesh = mesh.map(|[s, t, z]| {
        let [x, y] = around_hole(shape, (width, length, hole), [s, t]);
        [x, y, z]
    })?;
    mesh.facet_group_where("plate.top", "body.right", |x| {
        x[1] > 0.5 * length * (1.0 - 1e-12)
    })?;
    Ok(mesh)
}

/// From s across the plate, 0 to 1, and t around the hole, 0 to 2.
fn around_hole(shape: Hole, (width, length, hole): (f64, f64, f64), [s, t]: [f64; 2]) -> [f64; 2] {
    let (w, l, r) = (0.5 * width, 0.5 * length, 0.5 * hole);
    // Up the right edge, then along the top to the axis.
    let rectangle = |a: f64, b: f64| {
        if t <= 1.0 {
            [a, b * t]
        } else {
            [a * (2.0 - t), b]
        }
    };
    let inner = match shape {
        Hole::Square => rectangle(r, r),
        Hole::Round if t == 2.0 => [0.0, r],
        Hole::Round => polar([r, 0.5 * t * FRAC_PI_2]),
    };
    let outer = rectangle(w, l);
    [0, 1].map(|i| inner[i] + s * (outer[i] - inner[i]))
}

/// A quarter of a plate with a deep notch from each edge that leaves a ligament of width 1 of 10,
/// 30 long; half the ligament is cut into n cells, graded towards the tip of the notch as is the
/// rest. Group `ligament` of nodes on y = 0.
///
/// # Errors
/// Those of [`block2`].
pub fn notched_plate(kind: CellKind, n: usize) -> Result<Mesh<2>, MeshError> {
    const LIGAMENT: f64 = 0.5;
    const RATIO: f64 = 1.5;
    let least = LIGAMENT * (RATIO - 1.0) / (RATIO.powi(n as i32) - 1.0);
    let mut x = geometric(LIGAMENT, -least, RATIO, n);
    x[n] = 0.0;
    x.reverse();
    x.extend_from_slice(&graded(LIGAMENT, 5.0, least, RATIO)[1..]);
    let y = graded(0.0, 15.0, least, RATIO);
    let mut mesh = block2("body", kind, &x, &y)?;
    mesh.node_group_where("ligament", "body.bottom", |x| x[0] <= LIGAMENT)?;
    Ok(mesh)
}

/// Lines from `start` to `end`, the first interval about `width`, each next one wider by `ratio`.
pub fn graded(start: f64, end: f64, width: f64, ratio: f64) -> Vec<f64> {
    let sum = |cells: usize| (ratio.powi(cells as i32) - 1.0) / (ratio - 1.0);
    let mut cells = 1;
    while width * sum(cells) < end - start {
        cells += 1;
    }
    let mut lines = geometric(start, (end - start) / sum(cells), ratio, cells);
    lines[cells] = end;
    lines
}
