//! The surfaces of rigid tools where they are in an increment, outlines in the plane; not what they press.

use crate::deck::Deck;
use crate::grids::{Pose, Sheet};
use crate::mesh::Mesh;
use crate::table::Table;
use crate::vtu::three;
use nalgebra::Vector3;

/// Half of what is shown of a plane in space, in sizes of the mesh.
const REACH: f64 = 0.6;
/// How far a line without ends is drawn, in sizes of the mesh.
const FAR: f64 = 10.0;

/// Outlines of the tools of a deck in the plane, or the pieces of their surfaces in space, in a row of the history, with
/// their translations magnified as those of the body are, and their turns as they are.
pub(super) fn outlines<const D: usize>(
    deck: &Deck,
    (history, row): (&Table, usize),
    mesh: &Mesh<D>,
    magnification: f64,
) -> Vec<Vec<[f64; D]>> {
    let number = |name: &str| history.numbers(name).get(row).copied().unwrap_or(0.0);
    let (low, high) = mesh.bounds();
    let (middle, reach) = match D {
        2 => (Vector3::zeros(), FAR),
        _ => (
            0.5 * (Vector3::from(three(&low)) + Vector3::from(three(&high))),
            REACH,
        ),
    };
    let outline = |tool: &crate::deck::ToolEntry| -> Vec<Vec<[f64; D]>> {
        let name = &tool.name.value;
        let [x, y, z] =
            ["x", "y", "z"].map(|axis| magnification * number(&format!("u.{name}.{axis}")));
        let turn = |axis: &str| number(&format!("turn.{name}{axis}")).to_radians();
        let pose = Pose {
            translation: Vector3::new(x, y, z),
            turn: match D {
                2 => Vector3::new(0.0, 0.0, turn("")),
                _ => Vector3::new(turn(".x"), turn(".y"), turn(".z")),
            },
        };
        let sheet = Sheet::new(tool, D, middle, reach * mesh.size());
        let places = sheet.points.iter().zip(sheet.displacement(&pose));
        let places: Vec<[f64; D]> = places
            .map(|(x, u)| std::array::from_fn(|i| x[i] + u[i]))
            .collect();
        match D {
            2 => vec![places],
            _ => sheet
                .pieces
                .iter()
                .map(|piece| piece.iter().map(|&k| places[k]).collect())
                .collect(),
        }
    };
    deck.tools.iter().flat_map(outline).collect()
}
