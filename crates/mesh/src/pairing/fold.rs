//! A surface that may touch itself: which of its facets are the non-mortar side, and which the mortar side; not how they
//! are coupled.

use super::face::Face;
use super::tree::Tree;
use super::{Sides, normals, reach};
use crate::mesh::{Change, Facet, Mesh};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The side of a pair that a facet is on.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    NonMortar,
    Mortar,
}

impl Side {
    fn opposite(self) -> Self {
        match self {
            Self::NonMortar => Self::Mortar,
            Self::Mortar => Self::NonMortar,
        }
    }
}

/// A surface that may touch itself, parted into its two sides.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Fold {
    /// Facets of the non-mortar side.
    pub non_mortar: Vec<Facet>,
    /// Facets of the mortar side.
    pub mortar: Vec<Facet>,
}

impl<const D: usize> Mesh<D> {
    /// The two sides of a surface whose facets face each other with the nodes at the given positions \[mm\]. Facets opposite to each other are on different sides, those that share a
    /// node on the same one as far as that leaves them; the first that faces any is on the non-mortar side, and one that
    /// nothing faces is on the side of the nearest that something does.
    pub fn fold(&self, positions: &[[f64; D]], surface: &[Facet]) -> Fold {
        let face = |&f: &Facet| {
            let (kind, nodes) = (self.facet_kind(f), self.facet_nodes(f));
            Face::new(kind, nodes, positions, Change::default())
        };
        let faces: Vec<Face<D>> = surface.iter().map(face).collect();
        let sides = Sides {
            normals: normals(&faces),
            own: &faces,
            other: &faces,
            tree: Tree::new(faces.iter().map(Face::bounds).collect()),
            reach: reach(faces.iter()),
        };
        let mut facing = vec![BTreeSet::new(); faces.len()];
        for (i, face) in faces.iter().enumerate() {
            for j in sides.faced(face) {
                facing[i].insert(j);
                facing[j].insert(i);
            }
        }
        let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, face) in faces.iter().enumerate() {
            let nodes = face.nodes.iter();
            nodes.for_each(|&a| at.entry(a).or_default().push(i));
        }
        let mut side: Vec<Option<Side>> = vec![None; faces.len()];
        for first in 0..faces.len() {
            if side[first].is_some() || facing[first].is_empty() {
                continue;
            }
            side[first] = Some(Side::NonMortar);
            let mut open = VecDeque::from([first]);
            while let Some(i) = open.pop_front() {
                let Some(own) = side[i] else { continue };
                let across = facing[i].iter().map(|&j| (j, own.opposite()));
                let beside = faces[i].nodes.iter().flat_map(|a| &at[a]);
                let beside = beside.filter(|j| !facing[**j].is_empty());
                for (j, other) in across.chain(beside.map(|&j| (j, own))) {
                    if side[j].is_none() {
                        side[j] = Some(other);
                        open.push_back(j);
                    }
                }
            }
        }
        // A facet that nothing faces yet may be faced before long.
        let mut open: VecDeque<usize> = (0..faces.len()).filter(|&i| side[i].is_some()).collect();
        while let Some(i) = open.pop_front() {
            for &j in faces[i].nodes.iter().flat_map(|a| &at[a]) {
                if side[j].is_none() {
                    side[j] = side[i];
                    open.push_back(j);
                }
            }
        }
        let on = |which: Side| {
            let all = surface.iter().zip(&side);
            let own = all.filter(|(_, side)| **side == Some(which));
            own.map(|(facet, _)| *facet).collect()
        };
        Fold {
            non_mortar: on(Side::NonMortar),
            mortar: on(Side::Mortar),
        }
    }
}

impl<const D: usize> Sides<'_, D> {
    /// The facets opposite to one.
    fn faced(&self, face: &Face<D>) -> BTreeSet<usize> {
        match D {
            2 => self.faced_in_plane(face),
            _ => self.faced_in_space(face),
        }
    }
}
