//! The outlines of rigid tools in the plane where they are in an increment; not what they press.

use crate::deck::Deck;
use crate::simulation::tools::{Pose, Sheet};
use crate::table::Table;
use nalgebra::Vector3;

/// How far a line without ends is drawn, in sizes of the mesh.
const FAR: f64 = 10.0;

/// The outlines of the tools of a plane deck in a row of the history, with their translations magnified as
/// those of the body are, and their turns as they are. `size` is that of the mesh.
pub(super) fn outlines(
    deck: &Deck,
    (history, row): (&Table, usize),
    size: f64,
    magnification: f64,
) -> Vec<Vec<[f64; 2]>> {
    let number = |name: &str| history.numbers(name).get(row).copied().unwrap_or(0.0);
    let outline = |tool: &crate::deck::ToolEntry| {
        let name = &tool.name.value;
        let [x, y] = ["x", "y"].map(|axis| magnification * number(&format!("u.{name}.{axis}")));
        let turn = number(&format!("turn.{name}")).to_radians();
        let pose = Pose {
            translation: Vector3::new(x, y, 0.0),
            turn: Vector3::new(0.0, 0.0, turn),
        };
        let sheet = Sheet::new(tool, 2, Vector3::zeros(), FAR * size);
        let places = sheet.points.iter().zip(sheet.displacement(&pose));
        places.map(|(x, u)| [x.x + u.x, x.y + u.y]).collect()
    };
    deck.tools.iter().map(outline).collect()
}
