//! Ties: surfaces of two bodies held together as they are at first; not contact.

use crate::error::ModelError;
use crate::model::Model;
use crate::model::analysis::Analysis;
use crate::model::contact::Contact;
use crate::model::motion_row::RelativeMotionRow;
use moreau_laws::Tie;
use moreau_mesh::{Facet, Mesh, Pairing};
use nalgebra::SVector;
use std::collections::{BTreeMap, BTreeSet};

/// Distance of two surfaces that a tie bridges, over the length of a facet there.
const BRIDGED: f64 = 0.25;

/// Distance over the size of the mesh that is rounding.
const ROUNDING: f64 = 1e-12;

impl<const D: usize, H: Analysis<D>> Model<D, H> {
    /// Ties the surface of a body to that of another, each a group of facets: the displacements of both agree, weighted by
    /// dual multipliers, under any force and from the undeformed bodies on. `surface` is the non-mortar side, and should
    /// be the finer one, or that of the softer body. The weights are those of the undeformed bodies under large strains
    /// too; a distance of up to a quarter of a facet is bridged without stress. Nodes that have nothing opposite are free.
    ///
    /// # Errors
    /// An unknown group; [`ModelError::SharedSurfaceNode`]; [`ModelError::TiedTwice`] for a facet that another tie has;
    /// [`ModelError::NothingToTie`], [`ModelError::TiedApart`]; [`ModelError::SharedContactNode`].
    pub fn tie(mut self, surface: &str, to: &str) -> Result<Self, ModelError> {
        let own = self.mesh.node_group(surface)?;
        self.mesh.facet_group(to)?;
        let other = self.mesh.node_group(to)?;
        if let Some(&node) = own.iter().find(|a| other.binary_search(a).is_ok()) {
            return Err(ModelError::SharedSurfaceNode {
                surface: surface.into(),
                opposite: to.into(),
                node,
                position: self.mesh.nodes()[node].to_vec(),
            });
        }
        self.check_untied(surface, to)?;
        let first = self.points.len();
        self.touch(surface, to, Tie.into(), None)?;
        let mut rows = self.tied_rows(surface, to)?;
        for point in &mut self.points[first..] {
            point.tied = rows.remove(&point.node);
        }
        let mut kept = self.points.split_off(first);
        kept.retain(|p| p.tied.is_some());
        self.points.extend(kept);
        self.contacts.push(Contact {
            surface: surface.into(),
            opposite: to.into(),
            pairing: None,
            adjusted: None,
        });
        Ok(self)
    }

    /// No facet is tied twice, on either side, but that several surfaces may be tied to one.
    fn check_untied(&self, surface: &str, to: &str) -> Result<(), ModelError> {
        let facets = |name: &str| self.mesh.facet_group(name).unwrap_or(&[]);
        let tied: BTreeSet<usize> = (self.points.iter())
            .filter(|p| p.tied.is_some())
            .map(|p| p.contact)
            .collect();
        for other in tied.into_iter().map(|k| &self.contacts[k]) {
            let (surface_of, to_of) = (other.surface.as_str(), other.opposite.as_str());
            for (group, taken) in [(surface, surface_of), (surface, to_of), (to, surface_of)] {
                let both: BTreeSet<&Facet> = facets(taken).iter().collect();
                if let Some(&facet) = facets(group).iter().find(|f| both.contains(f)) {
                    let at = self.mesh.facet_nodes(facet).next().unwrap_or_default();
                    return Err(ModelError::TiedTwice {
                        group: group.into(),
                        surface: surface_of.into(),
                        to: to_of.into(),
                        position: self.mesh.nodes()[at].to_vec(),
                    });
                }
            }
        }
        Ok(())
    }

    /// The rows of a tie by their nodes, closed.
    fn tied_rows(
        &self,
        surface: &str,
        to: &str,
    ) -> Result<BTreeMap<usize, RelativeMotionRow<D>>, ModelError> {
        let mesh = &self.mesh;
        let surfaces = (mesh.facet_group(surface)?, mesh.facet_group(to)?);
        let rows = mesh.mortar_rows(mesh.nodes(), surfaces, Pairing::Mortar, &self.hypothesis);
        if rows.is_empty() {
            return Err(ModelError::NothingToTie {
                surface: surface.into(),
                to: to.into(),
            });
        }
        let lengths = lengths(mesh, surfaces.0.iter().chain(surfaces.1));
        let mut beside: BTreeMap<usize, Vec<Facet>> = BTreeMap::new();
        for &facet in surfaces.1 {
            for a in mesh.facet_nodes(facet) {
                beside.entry(a).or_default().push(facet);
            }
        }
        let mut closed = BTreeMap::new();
        for mortar_row in rows {
            let node = mortar_row.node;
            let mut row = RelativeMotionRow::on_surface(mortar_row, mesh.nodes());
            let apart = row.relative(|a| SVector::from(mesh.nodes()[a])).norm();
            let length = row.weights().filter_map(|(a, _)| lengths.get(&a));
            let bridged = BRIDGED * length.copied().fold(0.0, f64::max);
            if apart > bridged {
                return Err(ModelError::TiedApart {
                    surface: surface.into(),
                    to: to.into(),
                    node,
                    position: mesh.nodes()[node].to_vec(),
                    apart,
                    bridged,
                });
            }
            let opposite = row.opposite.clone();
            row.close(mesh.nodes(), ROUNDING * mesh.size(), || {
                behind(mesh, &opposite, &beside)
            });
            closed.insert(node, row);
        }
        Ok(closed)
    }
}

/// The longest side of a facet at each node \[mm\].
fn lengths<'a, const D: usize>(
    mesh: &Mesh<D>,
    facets: impl Iterator<Item = &'a Facet>,
) -> BTreeMap<usize, f64> {
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for &facet in facets {
        let corners = mesh.facet_kind(facet).corner_count();
        let all: Vec<usize> = mesh.facet_nodes(facet).collect();
        let at = |k: usize| SVector::<f64, D>::from(mesh.nodes()[all[k % corners]]);
        let side = |k: usize| (at(k + 1) - at(k)).norm();
        let longest = (0..corners).map(side).fold(0.0, f64::max);
        for a in all {
            let own = lengths.entry(a).or_insert(0.0);
            *own = own.max(longest);
        }
    }
    lengths
}

/// The nodes of the cells behind the facets that have nodes opposite, with the shares of these.
fn behind<const D: usize>(
    mesh: &Mesh<D>,
    opposite: &[(usize, f64)],
    beside: &BTreeMap<usize, Vec<Facet>>,
) -> BTreeMap<usize, f64> {
    let mut shares = BTreeMap::new();
    for &(b, w) in opposite {
        for facet in beside.get(&b).into_iter().flatten() {
            for &a in mesh.cell_nodes(facet.cell) {
                *shares.entry(a).or_insert(0.0) += w.abs();
            }
        }
    }
    shares
}
