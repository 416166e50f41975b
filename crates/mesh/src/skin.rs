//! Surfaces in space by their triangles, read from the bytes of a file; no mesh of cells.

use crate::ReadError;
use std::collections::HashMap;
use std::io::Cursor;

/// A surface of triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// Points \[mm\].
    pub points: Vec<[f64; 3]>,
    /// Numbers of the corners of each triangle among the points, in the order of the file.
    pub triangles: Vec<[usize; 3]>,
}

/// The surface of an STL file, text or binary; points of equal coordinates are one, and triangles of which two
/// corners are one are left out.
///
/// # Errors
/// [`ReadError::Stl`] for what is no STL file, [`ReadError::NoTriangles`] for one without any.
pub fn read_stl(bytes: &[u8]) -> Result<Skin, ReadError> {
    let triangles: Vec<stl_io::Triangle> = stl_io::create_stl_reader(&mut Cursor::new(bytes))
        .and_then(Iterator::collect)
        .map_err(|error| ReadError::Stl {
            reason: error.to_string(),
        })?;
    let corners = triangles.iter().map(|t| {
        // Zero has two signs.
        t.vertices.map(|v| v.0.map(|x| f64::from(x) + 0.0))
    });
    Skin::of(corners)
}

impl Skin {
    /// The surface of triangles by their corners.
    ///
    /// # Errors
    /// [`ReadError::NoTriangles`].
    pub(crate) fn of(triangles: impl Iterator<Item = [[f64; 3]; 3]>) -> Result<Self, ReadError> {
        let mut skin = Self::default();
        let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
        for corners in triangles {
            let face = corners.map(|x| {
                *numbers.entry(x.map(f64::to_bits)).or_insert_with(|| {
                    skin.points.push(x);
                    skin.points.len() - 1
                })
            });
            let [a, b, c] = face;
            if a != b && b != c && c != a {
                skin.triangles.push(face);
            }
        }
        match skin.triangles.is_empty() {
            true => Err(ReadError::NoTriangles),
            false => Ok(skin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid s
        facet normal 0 0 0\nouter loop
        vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet
        facet normal 0 0 0\nouter loop
        vertex 1 0 -0.0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet
        facet normal 0 0 0\nouter loop
        vertex 1 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet
        endsolid s\n";

    #[test]
    fn points_of_stl_files_are_merged() {
        let skin = read_stl(TEXT.as_bytes()).expect("a surface");
        assert_eq!((skin.points.len(), skin.triangles.len()), (4, 2));
        let corner = |x: [f32; 3]| stl_io::Vertex::new(x);
        let face = |vertices| stl_io::Triangle {
            normal: stl_io::Normal::new([0.0; 3]),
            vertices,
        };
        let [a, b, c, d] = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        let faces = [[a, b, c], [b, d, c]].map(|f| face(f.map(corner)));
        let mut binary = Vec::new();
        stl_io::write_stl(&mut binary, faces.iter()).expect("written");
        assert_eq!(read_stl(&binary).expect("a surface"), skin);
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        assert!(matches!(read_stl(b"no"), Err(ReadError::Stl { .. })));
        assert!(matches!(read_stl(b""), Err(ReadError::Stl { .. })));
        let empty = b"solid s\nendsolid s\n";
        assert!(matches!(read_stl(empty), Err(ReadError::NoTriangles)));
        let cut = &TEXT.as_bytes()[..150];
        assert!(matches!(read_stl(cut), Err(ReadError::Stl { .. })));
    }
}
