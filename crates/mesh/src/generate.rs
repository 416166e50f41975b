//! Structured blocks on grid lines; not a mesher of arbitrary shapes.

use crate::{CellKind, Facet, Mesh, MeshError};
use std::array::from_fn;

/// `cells + 1` lines at equal distances from `start` to `end` \[mm\], both ends exact.
pub fn uniform(start: f64, end: f64, cells: usize) -> Vec<f64> {
    refine(&[start, end], cells)
}

/// `cells + 1` lines from `start` \[mm\], the first interval `first_width` wide \[mm\], each next
/// one `ratio` times as wide as the one before.
///
/// A negative width walks downwards, from a surface into the depth; the lines then decrease, and
/// must be reversed for [`block2`] and [`block3`].
pub fn geometric(start: f64, first_width: f64, ratio: f64, cells: usize) -> Vec<f64> {
    let mut lines = vec![start];
    let (mut line, mut width) = (start, first_width);
    for _ in 0..cells {
        line += width;
        width *= ratio;
        lines.push(line);
    }
    lines
}

/// The lines with every interval cut into `parts` equal parts; the given lines are kept exactly.
/// With 0 parts no interval is left, only the first line.
pub fn refine(lines: &[f64], parts: usize) -> Vec<f64> {
    let inside = |pair: &[f64]| {
        let (a, b) = (pair[0], pair[1]);
        (1..=parts).map(move |k| {
            if k == parts {
                b
            } else {
                a + (b - a) * k as f64 / parts as f64
            }
        })
    };
    lines
        .first()
        .copied()
        .into_iter()
        .chain(lines.windows(2).flat_map(inside))
        .collect()
}

/// Rectangular block on increasing grid lines `x` and `y` \[mm\], any plane kind of cell.
///
/// Its groups are the cells `name` and the facets `name.left`, `name.right` (least and greatest
/// x), `name.bottom`, `name.top` (least and greatest y). Nodes are numbered row by row, x fastest,
/// and so are the cells; mid-side nodes are in the middle of their edges. Triangles cut each
/// rectangle of the grid in two, along alternating diagonals.
///
/// # Errors
///
/// [`MeshError::WrongDimension`] for a solid kind, [`MeshError::TooFewLines`],
/// [`MeshError::LinesNotIncreasing`], and those of [`Mesh::new`] for lines that are not finite or
/// nearly coincide.
pub fn block2(name: &str, kind: CellKind, x: &[f64], y: &[f64]) -> Result<Mesh<2>, MeshError> {
    const QUADRILATERAL: Cut<2> = &[&[[0, 0], [1, 0], [1, 1], [0, 1]]];
    const RISING: Cut<2> = &[&[[0, 0], [1, 0], [1, 1]], &[[0, 0], [1, 1], [0, 1]]];
    const FALLING: Cut<2> = &[&[[0, 0], [1, 0], [0, 1]], &[[1, 0], [1, 1], [0, 1]]];
    let cuts = match kind {
        CellKind::Tri3 | CellKind::Tri6 => [RISING, FALLING],
        _ => [QUADRILATERAL; 2],
    };
    block(name, kind, [x, y], cuts)
}

/// Box-shaped block on increasing grid lines `x`, `y` and `z` \[mm\], of hexahedra or tetrahedra.
///
/// Its groups are those of [`block2`] and `name.back`, `name.front` (least and greatest z).
/// Tetrahedra cut each box of the grid in six around its diagonal, conformingly.
///
/// # Errors
///
/// Those of [`block2`], with [`MeshError::WrongDimension`] for a plane kind.
pub fn block3(
    name: &str,
    kind: CellKind,
    x: &[f64],
    y: &[f64],
    z: &[f64],
) -> Result<Mesh<3>, MeshError> {
    const BOX: Cut<3> = &[&[
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [0, 0, 1],
        [1, 0, 1],
        [1, 1, 1],
        [0, 1, 1],
    ]];
    // One for each order in which a path along the edges from 000 to 111 can take the three axes.
    const PATHS: Cut<3> = &[
        &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
        &[[0, 0, 0], [0, 1, 0], [0, 1, 1], [1, 1, 1]],
        &[[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1]],
        &[[0, 0, 0], [1, 0, 0], [1, 1, 1], [1, 0, 1]],
        &[[0, 0, 0], [0, 0, 1], [1, 1, 1], [0, 1, 1]],
        &[[0, 0, 0], [0, 1, 0], [1, 1, 1], [1, 1, 0]],
    ];
    let cut = match kind {
        CellKind::Tet4 | CellKind::Tet10 => PATHS,
        _ => BOX,
    };
    block(name, kind, [x, y, z], [cut; 2])
}

/// How a box of the grid is cut into cells, each by its corners as corners of the unit box.
type Cut<const D: usize> = &'static [&'static [[usize; D]]];

/// A block whose boxes are cut by the two given ways in turn, like the squares of a chessboard.
fn block<const D: usize>(
    name: &str,
    kind: CellKind,
    lines: [&[f64]; D],
    cuts: [Cut<D>; 2],
) -> Result<Mesh<D>, MeshError> {
    if kind.dimension() != D {
        return Err(MeshError::WrongDimension {
            cell: 0,
            kind,
            dimension: D,
        });
    }
    for (axis, lines) in ['x', 'y', 'z'].into_iter().zip(lines) {
        check_lines(axis, lines)?;
    }
    let boxes = lines.map(|lines| lines.len() - 1);
    // Quadratic cells live on a grid twice as fine, where their mid-side nodes are grid points.
    let order = if kind.nodes() > kind.corner_count() {
        2
    } else {
        1
    };
    let grid = lines.map(|lines| refine(lines, order));
    let points: [usize; D] = from_fn(|i| grid[i].len());

    let mut cells: Vec<(CellKind, Vec<usize>)> = Vec::new();
    for index in (0..boxes.iter().product()).map(|flat| unflatten(flat, boxes)) {
        for corners in cuts[index.iter().sum::<usize>() % 2] {
            let at =
                |offset: [usize; D]| flatten(from_fn(|i| order * index[i] + offset[i]), points);
            cells.push((
                kind,
                offsets(kind, corners, order).into_iter().map(at).collect(),
            ));
        }
    }

    // Grid points that no cell uses, the centres of serendipity cells, are no nodes.
    let mut used = vec![false; points.iter().product()];
    for &point in cells.iter().flat_map(|(_, nodes)| nodes) {
        used[point] = true;
    }
    let mut number = vec![0; used.len()];
    let mut nodes = Vec::new();
    for point in (0..used.len()).filter(|&point| used[point]) {
        number[point] = nodes.len();
        let index = unflatten(point, points);
        nodes.push(from_fn(|i| grid[i][index[i]]));
    }
    for node in cells.iter_mut().flat_map(|(_, nodes)| nodes) {
        *node = number[*node];
    }

    let mut mesh = Mesh::new(nodes, cells)?;
    name_groups(&mut mesh, name)?;
    Ok(mesh)
}

fn check_lines(axis: char, lines: &[f64]) -> Result<(), MeshError> {
    if lines.len() < 2 {
        return Err(MeshError::TooFewLines {
            axis,
            count: lines.len(),
        });
    }
    // A NaN does not increase.
    match lines
        .windows(2)
        .position(|pair| !pair.is_sorted_by(|a, b| a < b))
    {
        Some(i) => Err(MeshError::LinesNotIncreasing {
            axis,
            index: i + 1,
            previous: lines[i],
            value: lines[i + 1],
        }),
        None => Ok(()),
    }
}

/// Grid points of a cell with the given corners, relative to its box: the image of the reference
/// nodes by the affine map that takes the reference corners to these.
fn offsets<const D: usize>(
    kind: CellKind,
    corners: &[[usize; D]],
    order: usize,
) -> Vec<[usize; D]> {
    let reference: Vec<&[f64]> = kind.reference_nodes().collect();
    let origin = reference[0];
    // The corner at the other end of the edge from the first one along each reference axis.
    let along = |axis: usize| {
        let beside = |x: &&[f64]| (0..D).all(|i| (x[i] == origin[i]) != (i == axis));
        let corner = reference.iter().take(corners.len()).position(beside);
        corner.unwrap_or_default()
    };
    let ends: [usize; D] = from_fn(along);
    let place = |x: &&[f64]| {
        from_fn(|i| {
            let moved = (0..D).map(|j| {
                let part = (x[j] - origin[j]) / (reference[ends[j]][j] - origin[j]);
                part * (corners[ends[j]][i] as f64 - corners[0][i] as f64)
            });
            (order as f64 * (corners[0][i] as f64 + moved.sum::<f64>())).round() as usize
        })
    };
    reference.iter().map(place).collect()
}

/// Position of an index in a grid of the given extents, the first coordinate running fastest.
fn flatten<const D: usize>(index: [usize; D], extents: [usize; D]) -> usize {
    (0..D).rev().fold(0, |flat, i| flat * extents[i] + index[i])
}

/// Inverse of [`flatten`].
fn unflatten<const D: usize>(mut flat: usize, extents: [usize; D]) -> [usize; D] {
    extents.map(|extent| {
        let i = flat % extent;
        flat /= extent;
        i
    })
}

/// Names all cells, and the facets of each side.
fn name_groups<const D: usize>(mesh: &mut Mesh<D>, name: &str) -> Result<(), MeshError> {
    const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];
    mesh.add_cell_group(name, (0..mesh.cell_count()).collect())?;
    let boundary = mesh.boundary_facets();
    let (low, high) = mesh.bounds();
    for (axis, sides) in SIDES.iter().enumerate().take(D) {
        for (side, bound) in sides.iter().zip([low[axis], high[axis]]) {
            let on_side = |facet: &Facet| {
                mesh.facet_nodes(*facet)
                    .all(|node| mesh.nodes()[node][axis] == bound)
            };
            let facets = boundary.iter().copied().filter(on_side).collect();
            mesh.add_facet_group(&format!("{name}.{side}"), facets)?;
        }
    }
    Ok(())
}
