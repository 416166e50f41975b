//! The surfaces of rigid tools as a grid, beside that of the body they press; not what they press.

use super::sheet::{Pose, Sheet};
use crate::deck::Deck;
use crate::driver::Driver;
use crate::vtu::{Array, Grid, three};
use nalgebra::Vector3;

/// Half of what is shown of a plane, in sizes of the mesh.
const REACH: f64 = 0.6;

/// All tools of a deck; none without tools.
pub(crate) fn tools<const D: usize>(driver: &Driver<D>, deck: &Deck) -> Option<Grid> {
    let mesh = driver.mesh();
    let (low, high) = mesh.bounds();
    let middle = (Vector3::from(three(&low)) + Vector3::from(three(&high))) * 0.5;
    let mut grid = Grid {
        points: Vec::new(),
        cells: Vec::new(),
        point_data: Vec::new(),
        cell_data: Vec::new(),
    };
    let (mut displacement, mut index) = (Vec::new(), Vec::new());
    for (k, tool) in deck.tools.iter().enumerate() {
        let name = &tool.name.value;
        let (translation, turn) = driver
            .tool_displacement(name)
            .ok()
            .zip(driver.tool_turn(name).ok())?;
        let sheet = Sheet::new(tool, D, middle, REACH * mesh.size());
        let pose = Pose {
            translation: three(translation.as_slice()).into(),
            turn,
        };
        let first = grid.points.len() as i64;
        for (x, u) in sheet.points.iter().zip(sheet.displacement(&pose)) {
            let now = if driver.has_large_strains() {
                x + u
            } else {
                *x
            };
            grid.points.push(now.into());
            displacement.extend_from_slice(u.as_slice());
        }
        for piece in &sheet.pieces {
            let kind = match piece.len() {
                2 => 3,
                3 => 5,
                _ => 9,
            };
            grid.cells
                .push((piece.iter().map(|&n| first + n as i64).collect(), kind));
            index.push(k as f64);
        }
    }
    grid.point_data.push(Array {
        name: "displacement".into(),
        components: 3,
        values: displacement,
    });
    grid.cell_data.push(Array {
        name: "tool".into(),
        components: 1,
        values: index,
    });
    (!grid.cells.is_empty()).then_some(grid)
}
