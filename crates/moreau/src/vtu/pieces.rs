//! A grid in pieces, one for each process that holds cells of it, and the file that names them all: parallel VTK; not
//! what is in a piece.

use super::{Array, Grid, Stored, point_data};
use std::fmt::Write as _;

/// Number in the whole of each point of a piece.
const IN_WHOLE: &str = "point_of_body";

/// The pieces of a grid by the process of each cell of the mesh, in the order of the processes: of the cells that its
/// field `cell` names, each made when it is asked for. `None` without that field.
pub(crate) fn pieces<'a>(
    grid: &'a Grid,
    process: &[u32],
) -> Option<impl ExactSizeIterator<Item = Grid> + use<'a>> {
    let named = |arrays: &[Array]| arrays.iter().position(|a| a.name == "cell");
    let arrays = [&grid.cell_data, &grid.point_data];
    let cells = arrays
        .into_iter()
        .find_map(|arrays| named(arrays).map(|at| &arrays[at].values))?;
    let of = |&cell: &f64| process.get(cell as usize).copied().unwrap_or(0);
    let owner: Vec<u32> = cells.iter().map(of).collect();
    let count = process.iter().max().map_or(0, |&last| last + 1);
    let piece = move |p: u32| {
        let own: Vec<usize> = (0..owner.len()).filter(|&k| owner[k] == p).collect();
        part(grid, &own)
    };
    Some((0..count).map(piece))
}

/// Some cells of a grid with their points.
fn part(grid: &Grid, cells: &[usize]) -> Grid {
    let mut number = vec![None; grid.points.len()];
    let used = cells.iter().flat_map(|&k| &grid.cells[k].0);
    used.for_each(|&point| number[point as usize] = Some(0));
    let points: Vec<usize> = (0..number.len()).filter(|&k| number[k].is_some()).collect();
    for (own, &point) in points.iter().enumerate() {
        number[point] = Some(own as i64);
    }
    let renumbered = |&point: &i64| number[point as usize].unwrap_or(0);
    let mut piece = Grid {
        points: points.iter().map(|&k| grid.points[k]).collect(),
        cells: (cells.iter().map(|&k| &grid.cells[k]))
            .map(|(nodes, kind)| (nodes.iter().map(renumbered).collect(), *kind))
            .collect(),
        point_data: grid.point_data.iter().map(|a| chosen(a, &points)).collect(),
        cell_data: grid.cell_data.iter().map(|a| chosen(a, cells)).collect(),
    };
    piece.point_data.push(Array {
        name: IN_WHOLE.into(),
        components: 1,
        values: points.iter().map(|&k| k as f64).collect(),
    });
    piece
}

/// Some of the values of an array.
fn chosen(array: &Array, which: &[usize]) -> Array {
    let n = array.components;
    Array {
        values: (which.iter())
            .flat_map(|&k| array.values[n * k..n * (k + 1)].iter().copied())
            .collect(),
        ..array.clone()
    }
}

/// The file that names the files of pieces, by one of these.
pub(crate) fn whole(piece: &Grid, files: &[String]) -> Vec<u8> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n\
         <PUnstructuredGrid GhostLevel=\"0\">\n",
    );
    let sections = [
        ("PPointData", &piece.point_data),
        ("PCellData", &piece.cell_data),
    ];
    // Writing to a string does not fail.
    for (section, arrays) in sections {
        let _ = writeln!(text, "<{section}>");
        for array in arrays {
            let name = Stored::named(&array.name);
            let _ = writeln!(
                text,
                "<PDataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{}\"/>",
                array.components
            );
        }
        let _ = writeln!(text, "</{section}>");
    }
    text.push_str("<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n");
    for file in files {
        let _ = writeln!(text, "<Piece Source=\"{file}\"/>");
    }
    text.push_str("</PUnstructuredGrid>\n</VTKFile>\n");
    text.into_bytes()
}

/// The values at the points of the whole from its pieces; `None` if one of them is not one, or torn.
pub(crate) fn joined(pieces: &[Vec<u8>]) -> Option<Vec<Array>> {
    let mut all: Vec<Array> = Vec::new();
    for bytes in pieces {
        let mut arrays = point_data(bytes)?;
        let at = arrays.iter().position(|a| a.name == IN_WHOLE)?;
        let numbers = arrays.remove(at).values;
        if all.is_empty() {
            all = arrays.clone();
            all.iter_mut().for_each(|whole| whole.values.clear());
        }
        if all.len() != arrays.len() {
            return None;
        }
        for (whole, array) in all.iter_mut().zip(arrays) {
            let n = whole.components;
            for (&number, values) in numbers.iter().zip(array.values.chunks_exact(n)) {
                let start = n * number as usize;
                if whole.values.len() < start + n {
                    whole.values.resize(start + n, 0.0);
                }
                whole.values[start..start + n].copy_from_slice(values);
            }
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three quadrilaterals in a row, two of them with one process.
    #[test]
    fn pieces_have_all_cells_and_are_joined_again() {
        let array = |name: &str, components, values: Vec<f64>| Array {
            name: name.into(),
            components,
            values,
        };
        let numbers = |n: usize| (0..n).map(|k| k as f64).collect::<Vec<f64>>();
        let grid = Grid {
            points: (0..8)
                .map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0])
                .collect(),
            cells: (0..3).map(|k| (vec![k, k + 1, k + 5, k + 4], 9)).collect(),
            point_data: vec![array("u", 3, numbers(24)), array("p", 1, numbers(8))],
            cell_data: vec![array("cell", 1, numbers(3))],
        };
        let parts: Vec<Grid> = pieces(&grid, &[0, 1, 0]).expect("the field").collect();
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[1].points, [1, 2, 5, 6].map(|k| grid.points[k]));
        assert_eq!(parts[1].cells, [(vec![0, 1, 3, 2], 9)]);
        assert_eq!(parts[0].cell_data[0].values, [0.0, 2.0]);
        let corner =
            |piece: &Grid, k: usize, at: usize| piece.points[piece.cells[k].0[at] as usize];
        assert_eq!(corner(&parts[0], 1, 2), [3.0, 1.0, 0.0]);
        let bytes: Vec<Vec<u8>> = parts.iter().map(Grid::vtu).collect();
        assert_eq!(joined(&bytes), Some(grid.point_data.clone()));
        assert_eq!(joined(&[grid.vtu()]), None);
        let text = String::from_utf8(whole(&parts[0], &["a_0.vtu".into(), "a_1.vtu".into()]));
        let text = text.expect("text");
        assert_eq!(text.matches("<Piece Source=\"a_").count(), 2);
        assert!(text.contains("Name=\"u\" NumberOfComponents=\"3\""));
        let bare = Grid {
            cell_data: Vec::new(),
            ..grid
        };
        assert!(pieces(&bare, &[0, 1, 0]).is_none());
    }
}
