//! Tools of a model, and which surfaces touch; not the kinematics of contact points.

use crate::error::ModelError;
use crate::model::analysis::{Analysis, Measure};
use crate::model::points::{ALONG_NORMAL, ContactPoint, Tool, tool_index};
use crate::model::{Model, out_of_range};
use moreau_contact::Obstacle;
use moreau_laws::Friction;
use moreau_mesh::{Pairing, PositiveShare, nearest};
use nalgebra::SVector;
use std::collections::BTreeMap;

/// A surface and what is opposite to it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    pub(crate) surface: String,
    /// Name of a tool or of a surface.
    pub(crate) opposite: String,
    /// How the surfaces of two bodies are paired; `None` on a tool, and of a tie.
    pub(crate) pairing: Option<Pairing>,
    /// [`Model::adjust`], where bodies are not paired yet \[mm\].
    pub(crate) adjusted: Option<f64>,
}

impl<const D: usize, H: Analysis<D>> Model<D, H> {
    /// Adds a rigid tool.
    ///
    /// # Errors
    /// [`ModelError::DuplicateTool`].
    pub fn tool(
        mut self,
        name: &str,
        obstacle: impl Obstacle<D> + 'static,
    ) -> Result<Self, ModelError> {
        if self.tools.iter().any(|t| t.name == name) {
            return Err(ModelError::DuplicateTool { name: name.into() });
        }
        self.tools.push(Tool {
            name: name.into(),
            reference: obstacle.reference(),
            parts: obstacle.parts(),
            obstacle: Box::new(obstacle),
        });
        Ok(self)
    }

    /// Lets the tool added last turn about another point than [`Obstacle::reference`] \[mm\].
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for numbers that are not finite.
    pub fn reference(mut self, point: [f64; D]) -> Result<Self, ModelError> {
        if let Some(&value) = point.iter().find(|x| !x.is_finite()) {
            return Err(out_of_range("reference point", value, "finite coordinates"));
        }
        if let Some(tool) = self.tools.last_mut() {
            tool.reference = point.into();
        }
        Ok(self)
    }

    /// Lets the nodes of a group of facets touch a tool, or the surface of another body that is
    /// named by its group of facets, with friction; limits of the shear are tractions \[MPa\]. Surfaces are paired by the default of
    /// [`Pairing`]; see [`Model::pair`].
    ///
    /// # Errors
    /// An unknown group, [`ModelError::UnknownOpposite`]; [`ModelError::SharedContactNode`]; those
    /// of [`Model::pair`].
    pub fn contact(
        mut self,
        surface: &str,
        opposite: &str,
        law: impl Into<Friction>,
    ) -> Result<Self, ModelError> {
        let Ok(tool) = tool_index(&self.tools, opposite) else {
            if self.mesh.facet_group(opposite).is_ok() {
                return self.pair(surface, opposite, law, Pairing::default());
            }
            let tools = self.tools.iter().map(|t| t.name.as_str());
            let groups = self.mesh.group_names();
            let facets = groups.filter(|name| self.mesh.facet_group(name).is_ok());
            return Err(ModelError::UnknownOpposite {
                surface: surface.into(),
                name: opposite.into(),
                nearest: nearest(opposite, tools.chain(facets)).map(Into::into),
            });
        };
        self.touch(surface, opposite, law.into(), Some(tool))?;
        self.contacts.push(Contact {
            surface: surface.into(),
            opposite: opposite.into(),
            pairing: None,
            adjusted: None,
        });
        Ok(self)
    }

    /// Lets the surface of a body touch that of another, each a group of facets, with friction:
    /// `surface` is the non-mortar side, whose nodes are the contact points. It should be the finer
    /// one, or that of the softer body.
    ///
    /// The surfaces are paired where they are at the start of each increment, and sliding is small within it; under
    /// large strains they are paired where they are at its end, and slide as far as they like. There a surface may also
    /// be opposite to itself, as that of a part that folds: which of its facets are the non-mortar side follows
    /// from which face each other at the start of the increment ([`Mesh::fold`](moreau_mesh::Mesh::fold)).
    ///
    /// # Errors
    /// An unknown group; [`ModelError::SharedContactNode`] for a node of `surface` that is one of
    /// another contact with the same surface; [`ModelError::SharedSurfaceNode`]; [`ModelError::SmallSelfContact`].
    pub fn pair(
        mut self,
        surface: &str,
        opposite: &str,
        law: impl Into<Friction>,
        pairing: Pairing,
    ) -> Result<Self, ModelError> {
        let own = self.mesh.node_group(surface)?;
        self.mesh.facet_group(opposite)?;
        let other = self.mesh.node_group(opposite)?;
        let itself = surface == opposite && pairing == Pairing::Mortar;
        if itself && !self.large {
            return Err(ModelError::SmallSelfContact {
                surface: surface.into(),
            });
        }
        let shared = own.iter().find(|a| other.binary_search(a).is_ok());
        if let Some(&node) = shared.filter(|_| !itself) {
            return Err(ModelError::SharedSurfaceNode {
                surface: surface.into(),
                opposite: opposite.into(),
                node,
                position: self.mesh.nodes()[node].to_vec(),
            });
        }
        self.touch(surface, opposite, law.into(), None)?;
        self.contacts.push(Contact {
            surface: surface.into(),
            opposite: opposite.into(),
            pairing: Some(pairing),
            adjusted: None,
        });
        Ok(self)
    }

    /// Adds the contact points of a surface.
    pub(crate) fn touch(
        &mut self,
        surface: &str,
        opposite: &str,
        law: Friction,
        tool: Option<usize>,
    ) -> Result<(), ModelError> {
        let facets = self.mesh.facet_group(surface)?;
        let (mesh, hypothesis) = (&self.mesh, &self.hypothesis);
        let shares = match self.large && tool.is_some() {
            true => hypothesis.shares_on_tool(mesh, mesh.nodes(), facets),
            false => mesh.positive_shares(facets, hypothesis),
        };
        let meets = |p: &&ContactPoint<D>| self.contacts[p.contact].opposite == opposite;
        let taken: BTreeMap<usize, usize> = (self.points.iter().filter(meets))
            .map(|p| (p.node, p.contact))
            .collect();
        let twice = shares.iter().find_map(|s| {
            let other = taken.get(&s.share.node)?;
            Some((s.share.node, *other))
        });
        if let Some((node, other)) = twice {
            return Err(ModelError::SharedContactNode {
                node,
                position: self.mesh.nodes()[node].to_vec(),
                first: self.contacts[other].surface.clone(),
                second: surface.into(),
                opposite: opposite.into(),
            });
        }
        let parts = tool.map_or(0, |tool| self.tools[tool].parts.len()).max(1);
        let points = (0..parts).flat_map(|part| shares.iter().map(move |s| (part, s.clone())));
        for (part, PositiveShare { share, own }) in points {
            self.points.push(ContactPoint {
                node: share.node,
                tool,
                part,
                contact: self.contacts.len(),
                law,
                axis: None,
                offset: 0.0,
                // A node on the axis bears nothing, to rounding of either sign.
                area: share.area.max(0.0),
                kind: share.kind,
                own,
                tied: None,
            });
        }
        Ok(())
    }

    /// The contact added last, which a datum is about.
    fn expect_contact(&self, what: &str, value: f64) -> Result<&Contact, ModelError> {
        let last = self.contacts.last();
        last.ok_or_else(|| out_of_range(what, value, "a contact before it, which it is about"))
    }

    /// Lets the nodes of the contact added last touch at a distance from the tool \[mm\]: that of a
    /// coating, or of half a sheet; negative, to lie into it.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a number that is not finite, or before any contact.
    pub fn gap_offset(mut self, offset: f64) -> Result<Self, ModelError> {
        if !offset.is_finite() {
            return Err(out_of_range("gap offset", offset, "a finite number"));
        }
        self.expect_contact("gap offset", offset)?;
        let last = self.contacts.len();
        for point in self.points.iter_mut().filter(|p| p.contact + 1 == last) {
            point.offset += offset;
        }
        Ok(self)
    }

    /// Gives the friction of the contact added last a direction, in space: the first coefficient of an
    /// [`AnisotropicCoulomb`](moreau_laws::AnisotropicCoulomb) law holds along the projection of the
    /// axis on the surface, the second across. Without it they hold along the tangents of
    /// [`frame`](moreau_contact::frame).
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an axis of no length, or before any contact, [`ModelError::NormalAxis`] for one that is
    /// normal to the surface somewhere.
    pub fn along(mut self, axis: [f64; D]) -> Result<Self, ModelError> {
        let axis = SVector::from(axis);
        let length = axis.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(out_of_range(
                "length of the axis of friction",
                length,
                "a positive number",
            ));
        }
        let axis = axis / length;
        let last = self.expect_contact("axis of friction", length)?;
        let facets = self.mesh.facet_group(&last.surface)?;
        for share in self.mesh.facet_shares(facets, &self.hypothesis) {
            let normal = SVector::from(share.normal);
            let across = axis - normal * (normal.dot(&axis) / normal.norm_squared());
            if across.norm() <= ALONG_NORMAL {
                return Err(ModelError::NormalAxis {
                    surface: last.surface.clone(),
                    node: share.node,
                    position: self.mesh.nodes()[share.node].to_vec(),
                });
            }
        }
        let last = self.contacts.len();
        for point in self.points.iter_mut().filter(|p| p.contact + 1 == last) {
            point.axis = Some(axis);
        }
        Ok(self)
    }

    /// Takes the nodes of the contact added last, as far as their gap or penetration is at most the
    /// tolerance \[mm\], to touch where they are: each gets an offset of its own, and neither moves
    /// nor is strained. Between bodies the gap is that of the virgin state.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a tolerance that is negative or not finite, or before any contact.
    pub fn adjust(mut self, tolerance: f64) -> Result<Self, ModelError> {
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            let expected = "a non-negative number";
            return Err(out_of_range(
                "tolerance of adjusted gaps",
                tolerance,
                expected,
            ));
        }
        self.expect_contact("tolerance of adjusted gaps", tolerance)?;
        let count = self.contacts.len();
        let pair = self.contacts.last_mut().filter(|c| c.pairing.is_some());
        if let Some(contact) = pair {
            contact.adjusted = Some(tolerance);
        }
        for point in self.points.iter_mut().filter(|p| p.contact + 1 == count) {
            let Some(tool) = point.tool else { continue };
            let obstacle = self.tools[tool].opposite(point);
            let gap = point.gap(obstacle, |a| self.mesh.nodes()[a].into());
            if gap.abs() <= tolerance {
                point.offset += gap;
            }
        }
        Ok(self)
    }
}
