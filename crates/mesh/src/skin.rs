//! Surfaces in space by their triangles, read from the bytes of a file; no mesh of cells.

use crate::ReadError;
use std::collections::{BTreeSet, HashMap};
use std::io::Cursor;

/// A surface of triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// Points \[mm\].
    pub points: Vec<[f64; 3]>,
    /// Numbers of the corners of each triangle among the points, in the order of the file.
    pub triangles: Vec<[usize; 3]>,
}

/// Corners that are one, in parts of the largest coordinate: STL files are read in single precision, of which a corner that is
/// computed twice in it is a few roundings off, and one in double precision, as by a sine of 2π, one at most.
const SAME: f64 = 4.0 * f32::EPSILON as f64;

/// The surface of an STL file, text or binary; corners that differ by rounding, 5e-7 of the largest coordinate, are one, and
/// triangles of which two corners are one are left out.
///
/// # Errors
/// [`ReadError::Stl`] for what is no STL file, [`ReadError::NoTriangles`] for one without any.
pub fn read_stl(bytes: &[u8]) -> Result<Skin, ReadError> {
    let triangles: Vec<stl_io::Triangle> = stl_io::create_stl_reader(&mut Cursor::new(bytes))
        .and_then(Iterator::collect)
        .map_err(|error| ReadError::Stl {
            reason: error.to_string(),
        })?;
    // Zero has two signs.
    let corners = |t: &stl_io::Triangle| t.vertices.map(|v| v.0.map(|x| f64::from(x) + 0.0));
    let corners: Vec<[[f64; 3]; 3]> = triangles.iter().map(corners).collect();
    Skin::of(merged(&corners).into_iter())
}

/// Triangles whose corners that differ by rounding, directly or from one to the next, are moved to one of them: whatever their
/// order, to the same.
fn merged(triangles: &[[[f64; 3]; 3]]) -> Vec<[[f64; 3]; 3]> {
    let coordinates = triangles.iter().flatten().flatten();
    let finite = coordinates.map(|x| x.abs()).filter(|x| x.is_finite());
    let same = SAME * finite.fold(0.0, f64::max);
    let bits = triangles.iter().flatten().map(|x| x.map(f64::to_bits));
    let points: BTreeSet<[u64; 3]> = bits.collect();
    let points: Vec<[f64; 3]> = points.iter().map(|x| x.map(f64::from_bits)).collect();
    // By cells as large as what is one: what a point is one with is in its cell or in those around.
    let cell = |x: &[f64; 3]| x.map(|x| (x / same).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut one: Vec<usize> = (0..points.len()).collect();
    let root = |one: &[usize], mut k: usize| {
        while one[k] != k {
            k = one[k];
        }
        k
    };
    for (k, x) in points.iter().enumerate() {
        let own = cell(x);
        for step in 0..27 {
            let around = [0, 1, 2].map(|i| own[i].wrapping_add(step / 3_i64.pow(i as u32) % 3 - 1));
            for &other in cells.get(&around).into_iter().flatten() {
                if (0..3).all(|i| (x[i] - points[other][i]).abs() <= same) {
                    let (a, b) = (root(&one, k), root(&one, other));
                    one[a.max(b)] = a.min(b);
                }
            }
        }
        cells.entry(own).or_default().push(k);
    }
    let numbers = points.iter().enumerate();
    let moved: HashMap<[u64; 3], [f64; 3]> = numbers
        .map(|(k, x)| (x.map(f64::to_bits), points[root(&one, k)]))
        .collect();
    let moved = |x: [f64; 3]| moved[&x.map(f64::to_bits)];
    triangles.iter().map(|t| t.map(moved)).collect()
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
    use proptest::prelude::*;

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

    /// A square of n by n on both sides of a thickness, of a size and at a place, its corners as `noise` moves them at their
    /// nth use, as a text.
    fn plate(n: usize, [size, thick, at]: [f64; 3], mut noise: impl FnMut() -> f64) -> Vec<String> {
        let mut faces = Vec::new();
        for k in 0..2 * n * n {
            let [i, j, z] = [k % n, k / n % n, k / n / n];
            for half in [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]] {
                let mut face = "facet normal 0 0 0\nouter loop\n".to_owned();
                for [a, b] in half {
                    let place = [(i + a) as f64, (j + b) as f64].map(|x| x / n as f64 * size);
                    let [x, y, z] =
                        [place[0], place[1], z as f64 * thick].map(|x| at + x + noise());
                    face += &format!("vertex {x} {y} {z}\n");
                }
                faces.push(face + "endloop\nendfacet\n");
            }
        }
        faces
    }

    fn read(faces: &[String]) -> Skin {
        let text = format!("solid s\n{}endsolid s\n", faces.concat());
        read_stl(text.as_bytes()).expect("a surface")
    }

    fn sorted(skin: &Skin) -> Vec<[u64; 3]> {
        let mut points: Vec<_> = skin.points.iter().map(|x| x.map(f64::to_bits)).collect();
        points.sort_unstable();
        points
    }

    proptest! {
        /// Corners are one up to a few roundings of their largest coordinate, wherever the surface is and whatever is first, and
        /// those that are ten times as far from each other are not.
        #[test]
        fn corners_that_rounding_parts_are_one(size in 1e-3..1e3f64, far in 0.0..3.0f64, seed in 0..1000u32) {
            let largest = size * (1.0 + far);
            let thick = 10.0 * SAME * largest;
            let mut state = f64::from(seed) / 1000.0;
            let noise = || {
                state = (state * 997.0 + 0.37).fract();
                (state - 0.5) * f64::from(f32::EPSILON) * largest
            };
            let mut faces = plate(6, [size, thick, far * size], noise);
            let skin = read(&faces);
            prop_assert_eq!((skin.points.len(), skin.triangles.len()), (2 * 49, faces.len()));
            faces.reverse();
            faces.rotate_left(seed as usize % 50);
            prop_assert_eq!(sorted(&read(&faces)), sorted(&skin));
        }
    }

    /// The sine of 2π is no zero; across zero two cells meet.
    #[test]
    fn a_sine_of_a_whole_turn_is_zero() {
        let mut signs = [0.0, -2.2e-15, 2.4e-16, 1e-40].into_iter().cycle();
        let skin = read(&plate(1, [2.0, 1.0, 0.0], || {
            signs.next().unwrap_or_default()
        }));
        assert_eq!((skin.points.len(), skin.triangles.len()), (8, 4));
    }

    /// As many points as a fine tool has are merged in a moment.
    #[test]
    fn many_corners_are_merged() {
        let skin = read(&plate(200, [1.0, 1e-2, 0.0], || 0.0));
        assert_eq!(skin.points.len(), 2 * 201 * 201);
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
