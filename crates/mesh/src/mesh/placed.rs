//! A mesh whose groups have a name in common; not what stands beside it.

use super::Mesh;
use super::groups::Group;

impl<const D: usize> Mesh<D> {
    /// The mesh with groups called `NAME.GROUP`, and with one of all cells that is called `NAME`, as a block has them.
    pub fn named(mut self, name: &str) -> Self {
        let groups = std::mem::take(&mut self.groups);
        let named = |(own, group)| (format!("{name}.{own}"), group);
        self.groups = groups.into_iter().map(named).collect();
        let all = Group::Cells((0..self.cell_count()).collect());
        self.groups.insert(name.to_owned(), all);
        self
    }
}

#[cfg(test)]
mod tests {
    use crate::{CellKind, Mesh, MeshError, block2};

    fn block() -> Mesh<2> {
        block2("b", CellKind::Quad8, &[1.0, 2.0, 4.0], &[0.0, 1.0]).expect("a mesh")
    }

    #[test]
    fn a_mesh_is_turned_and_named() {
        let mesh = block()
            .map(|[x, y]| [10.0 - 2.0 * y, 2.0 * x])
            .expect("a turn");
        assert_eq!(mesh.bounds(), ([8.0, 2.0], [10.0, 8.0]));
        assert!((mesh.size() - 40f64.sqrt()).abs() < 1e-12);
        let mesh = mesh.named("part");
        let names: Vec<&str> = mesh.group_names().collect();
        let sides = ["bottom", "left", "right", "top"].map(|side| format!("part.b.{side}"));
        assert_eq!(names[..2], ["part", "part.b"]);
        assert_eq!(names[2..], sides);
        assert_eq!(mesh.cell_group("part").expect("all"), [0, 1]);
    }

    #[test]
    fn mirrors_and_what_is_not_finite_are_refused() {
        let mirrored = block().map(|[x, y]| [-x, y]).map(|_| ());
        assert!(
            matches!(mirrored, Err(MeshError::InvertedCell { .. })),
            "{mirrored:?}"
        );
        let flat = block().map(|[x, _]| [x, 0.0]).map(|_| ());
        assert!(
            matches!(flat, Err(MeshError::DegenerateCell { .. })),
            "{flat:?}"
        );
        let far = block().map(|[x, y]| [x * f64::MAX, y]).map(|_| ());
        assert!(matches!(far, Err(MeshError::NotFinite { .. })), "{far:?}");
    }
}
