//! A model: mesh, materials, tools and contacts; not its loads, which are steps.

use crate::ModelError;
use crate::block::{Block, SolidBlock};
use crate::interface::{ContactPoint, Tool};
use moreau_contact::Obstacle;
use moreau_laws::{BulkLaw, Friction};
use moreau_mesh::{
    Axisymmetric, CellKind, Facet, Hex8, Hypothesis, Integration, Mesh, PlaneStrain, Quad4, Quad8,
    Quad9, Share, Solid, Tet4, Tri3, Tri6,
};
use std::collections::BTreeMap;

/// A hypothesis together with the elements that it can be used with.
pub trait Analysis<const D: usize>: Hypothesis<D> {
    /// A block of cells of one kind; `None` if the hypothesis has no such cells.
    fn block<L: BulkLaw>(
        &self,
        mesh: &Mesh<D>,
        kind: CellKind,
        cells: Vec<usize>,
        law: L,
        integration: Integration,
    ) -> Option<Box<dyn Block<D>>>;
}

fn plane<H: Hypothesis<2>, L: BulkLaw>(
    hypothesis: &H,
    mesh: &Mesh<2>,
    kind: CellKind,
    cells: Vec<usize>,
    law: L,
    rule: Integration,
) -> Option<Box<dyn Block<2>>> {
    Some(match kind {
        CellKind::Tri3 => Box::new(SolidBlock::<Tri3, H, L, 2, 3>::new(
            mesh, cells, hypothesis, law, rule,
        )),
        CellKind::Tri6 => Box::new(SolidBlock::<Tri6, H, L, 2, 6>::new(
            mesh, cells, hypothesis, law, rule,
        )),
        CellKind::Quad4 => Box::new(SolidBlock::<Quad4, H, L, 2, 4>::new(
            mesh, cells, hypothesis, law, rule,
        )),
        CellKind::Quad8 => Box::new(SolidBlock::<Quad8, H, L, 2, 8>::new(
            mesh, cells, hypothesis, law, rule,
        )),
        CellKind::Quad9 => Box::new(SolidBlock::<Quad9, H, L, 2, 9>::new(
            mesh, cells, hypothesis, law, rule,
        )),
        CellKind::Tet4 | CellKind::Hex8 => return None,
    })
}

impl Analysis<2> for PlaneStrain {
    fn block<L: BulkLaw>(
        &self,
        mesh: &Mesh<2>,
        kind: CellKind,
        cells: Vec<usize>,
        law: L,
        rule: Integration,
    ) -> Option<Box<dyn Block<2>>> {
        plane(self, mesh, kind, cells, law, rule)
    }
}

impl Analysis<2> for Axisymmetric {
    fn block<L: BulkLaw>(
        &self,
        mesh: &Mesh<2>,
        kind: CellKind,
        cells: Vec<usize>,
        law: L,
        rule: Integration,
    ) -> Option<Box<dyn Block<2>>> {
        plane(self, mesh, kind, cells, law, rule)
    }
}

impl Analysis<3> for Solid {
    fn block<L: BulkLaw>(
        &self,
        mesh: &Mesh<3>,
        kind: CellKind,
        cells: Vec<usize>,
        law: L,
        rule: Integration,
    ) -> Option<Box<dyn Block<3>>> {
        Some(match kind {
            CellKind::Tet4 => Box::new(SolidBlock::<Tet4, Self, L, 3, 4>::new(
                mesh, cells, self, law, rule,
            )),
            CellKind::Hex8 => Box::new(SolidBlock::<Hex8, Self, L, 3, 8>::new(
                mesh, cells, self, law, rule,
            )),
            _ => return None,
        })
    }
}

/// What the driver still asks of the hypothesis once the blocks are built.
pub(crate) trait Measure<const D: usize>: Send + Sync {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>>;
    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)>;
    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]>;
}

impl<const D: usize, H: Hypothesis<D>> Measure<D> for H {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>> {
        mesh.facet_shares(facets, self)
    }

    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)> {
        mesh.volume_shares(cells, self)
    }

    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]> {
        H::rigid_modes(x)
    }
}

/// Surface and tool of a contact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContactName {
    pub(crate) surface: String,
    pub(crate) tool: String,
}

/// Mesh, materials, tools and contacts of a problem.
pub struct Model<const D: usize, H> {
    pub(crate) mesh: Mesh<D>,
    pub(crate) hypothesis: H,
    pub(crate) blocks: Vec<Box<dyn Block<D>>>,
    pub(crate) tools: Vec<Tool<D>>,
    pub(crate) contacts: Vec<ContactName>,
    pub(crate) points: Vec<ContactPoint<D>>,
    has_material: Vec<bool>,
}

impl<const D: usize, H: Analysis<D>> Model<D, H> {
    /// A model of a mesh under a hypothesis, without materials.
    pub fn new(mesh: Mesh<D>, hypothesis: H) -> Self {
        Self {
            has_material: vec![false; mesh.cell_count()],
            mesh,
            hypothesis,
            blocks: Vec::new(),
            tools: Vec::new(),
            contacts: Vec::new(),
            points: Vec::new(),
        }
    }

    /// Gives the cells of a group a law and an integration rule.
    ///
    /// # Errors
    /// An unknown group; [`ModelError::TwoMaterials`].
    pub fn material<L: BulkLaw>(
        mut self,
        group: &str,
        law: L,
        integration: Integration,
    ) -> Result<Self, ModelError> {
        let mut by_kind: BTreeMap<CellKind, Vec<usize>> = BTreeMap::new();
        for &cell in self.mesh.cell_group(group)? {
            if std::mem::replace(&mut self.has_material[cell], true) {
                return Err(ModelError::TwoMaterials {
                    cell,
                    group: group.into(),
                });
            }
            by_kind.entry(self.mesh.kind(cell)).or_default().push(cell);
        }
        for (kind, cells) in by_kind {
            // A mesh of dimension D has no cells of another dimension.
            let block = self
                .hypothesis
                .block(&self.mesh, kind, cells, law.clone(), integration);
            self.blocks.extend(block);
        }
        Ok(self)
    }

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
            obstacle: Box::new(obstacle),
        });
        Ok(self)
    }

    /// Lets the nodes of a group of facets touch a tool, with friction; limits of the shear are
    /// tractions \[MPa\].
    ///
    /// # Errors
    /// An unknown group or tool; [`ModelError::SharedContactNode`].
    pub fn contact(
        mut self,
        surface: &str,
        tool: &str,
        law: impl Into<Friction>,
    ) -> Result<Self, ModelError> {
        let law: Friction = law.into();
        let facets = self.mesh.facet_group(surface)?;
        let index = self.tool_index(tool)?;
        let shares = self.mesh.facet_shares(facets, &self.hypothesis);
        for share in shares {
            if let Some(other) = self.points.iter().find(|p| p.node == share.node) {
                return Err(ModelError::SharedContactNode {
                    node: share.node,
                    position: self.mesh.nodes()[share.node].to_vec(),
                    first: self.tools[other.tool].name.clone(),
                    second: tool.into(),
                });
            }
            self.points.push(ContactPoint {
                node: share.node,
                tool: index,
                contact: self.contacts.len(),
                law: law.scaled(share.area),
                area: share.area,
                kind: share.kind,
            });
        }
        self.contacts.push(ContactName {
            surface: surface.into(),
            tool: tool.into(),
        });
        Ok(self)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }

    pub(crate) fn tool_index(&self, name: &str) -> Result<usize, ModelError> {
        let names = || self.tools.iter().map(|t| t.name.as_str());
        names()
            .position(|n| n == name)
            .ok_or_else(|| ModelError::UnknownTool {
                name: name.into(),
                nearest: moreau_mesh::nearest(name, names()).map(Into::into),
            })
    }

    /// # Errors
    /// [`ModelError::MissingMaterial`].
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let mut bare = (0..self.has_material.len()).filter(|&c| !self.has_material[c]);
        match bare.next() {
            Some(first) => Err(ModelError::MissingMaterial {
                count: 1 + bare.count(),
                first,
            }),
            None => Ok(()),
        }
    }
}
