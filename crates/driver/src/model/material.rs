//! What the cells of a model are made of; not the laws.

use crate::assembly::block::Block;
use crate::assembly::panel::PanelBlock;
use crate::error::ModelError;
use crate::model::analysis::Analysis;
use crate::model::{Model, out_of_range};
use moreau_laws::{BulkLaw, PanelLaw};
use moreau_mandel::{Sym2, trace, von_mises};
use moreau_mesh::{CellKind, Integration};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most nodes of a cell.
const MOST_NODES: usize = 27;

impl<const D: usize, H: Analysis<D>> Model<D, H> {
    /// Gives the cells of a group a law and an integration rule. Under [`PlaneStress`](moreau_mesh::PlaneStress) the law is
    /// [`InPlaneStress`](moreau_laws::InPlaneStress), which is not to be asked for.
    ///
    /// # Errors
    /// Those of [`Model::material_from`].
    pub fn material<L: BulkLaw>(
        self,
        group: &str,
        law: L,
        integration: Integration,
    ) -> Result<Self, ModelError> {
        let initial = law.initial();
        self.with_material((group, integration), law, |_| initial)
    }

    /// Gives the cells of a group a law, an integration rule, and the state that every quadrature point
    /// starts from, by its position in the undeformed body \[mm\]: under a stress, or with axes that
    /// vary. Forces on the nodes hold the stresses at first, and are taken away as the first step applies its loads: where
    /// these balance the stresses nothing moves.
    ///
    /// # Errors
    /// An unknown group; [`ModelError::TwoMaterials`]; [`ModelError::PlaneStress`] under large strains, or with a mean
    /// dilatation; [`ModelError::Overstressed`] for a stress outside of the yield surface;
    /// [`ModelError::OutOfRange`] for a stress that is no number, or a negative plastic strain.
    pub fn material_from<L: BulkLaw>(
        self,
        group: &str,
        law: L,
        integration: Integration,
        state: impl Fn(&[f64; D]) -> L::State,
    ) -> Result<Self, ModelError> {
        // On every process of all cells, so that all say the same.
        let mut by_kind: BTreeMap<CellKind, Vec<usize>> = BTreeMap::new();
        for &cell in self.mesh.cell_group(group)? {
            by_kind.entry(self.mesh.kind(cell)).or_default().push(cell);
        }
        for (kind, members) in by_kind {
            let cells = self
                .hypothesis
                .cells(&self.mesh, kind, &members, integration);
            for point in cells
                .iter()
                .flat_map(|c| 0..c.count() * c.points_per_cell())
            {
                let Some(cells) = &cells else { continue };
                let cell = members[point / cells.points_per_cell()];
                check_start(&law, cell, &cells.position(point), &state)?;
            }
        }
        self.with_material((group, integration), law, state)
    }

    fn with_material<L: BulkLaw>(
        mut self,
        (group, integration): (&str, Integration),
        law: L,
        state: impl Fn(&[f64; D]) -> L::State,
    ) -> Result<Self, ModelError> {
        self.check_plane_stress(group, integration)?;
        let by_kind = self.claim(group)?;
        let rank = self.team.as_ref().map(|(team, _)| team.rank());
        for (kind, mut cells) in by_kind {
            if let (Some(rank), Some((_, process))) = (rank, &self.team) {
                self.members.push(Some(cells.clone()));
                cells.retain(|&c| process[c] as usize == rank);
            }
            let own = self.hypothesis.cells(&self.mesh, kind, &cells, integration);
            // A mesh of dimension D has no cells of another dimension.
            if let Some(own) = own {
                let block = H::solid_block(cells, own, law.clone(), self.large, &state);
                self.blocks.push(block);
            }
        }
        Ok(self)
    }

    /// Gives the cells of a group a law that answers for many points at once, and an integration rule. On a team they
    /// stay with the first process.
    ///
    /// # Errors
    /// An unknown group; [`ModelError::TwoMaterials`]; [`ModelError::SmallStrainsOnly`]; [`ModelError::Law`] for a law
    /// that is none at rest.
    pub fn panel_material(
        mut self,
        group: &str,
        law: &Arc<dyn PanelLaw>,
        integration: Integration,
    ) -> Result<Self, ModelError> {
        if self.large {
            return Err(ModelError::SmallStrainsOnly {
                group: group.into(),
            });
        }
        if H::IS_PLANE_STRESS {
            return Err(ModelError::PlaneStress {
                group: group.into(),
                problem: "a law that answers for panels of points: its stress through the thickness is its own",
            });
        }
        for (kind, cells) in self.claim(group)? {
            let own = self.hypothesis.cells(&self.mesh, kind, &cells, integration);
            let first = self.team.as_ref().is_none_or(|(team, _)| team.rank() == 0);
            if let Some(own) = own.filter(|_| first) {
                let block = PanelBlock::new(cells, own, law.clone())?;
                self.blocks.push(Box::new(block));
                self.members.push(None);
            }
        }
        Ok(self)
    }

    /// Has the cells of a group expand by a strain α in every direction for each kelvin that
    /// [`Step::temperature`](crate::Step::temperature) heats them \[1/K\]: nothing of it makes a stress. Under large strains it
    /// is logarithmic: they grow by the factor e^{α ΔT}. One that is negative shrinks.
    ///
    /// # Errors
    /// An unknown group, a number that is not finite, [`ModelError::TwoExpansions`].
    pub fn expansion(mut self, group: &str, per_kelvin: f64) -> Result<Self, ModelError> {
        if !per_kelvin.is_finite() {
            let what = format!("expansion of {group:?}");
            return Err(out_of_range(&what, per_kelvin, "a finite number"));
        }
        self.expansion.resize(self.mesh.cell_count(), 0.0);
        for &cell in self.mesh.cell_group(group)? {
            let own = &mut self.expansion[cell];
            if *own != 0.0 && *own != per_kelvin {
                return Err(ModelError::TwoExpansions {
                    cell,
                    group: group.into(),
                });
            }
            *own = per_kelvin;
        }
        Ok(self)
    }

    /// What plane stress does not go with.
    fn check_plane_stress(&self, group: &str, integration: Integration) -> Result<(), ModelError> {
        let problem = match (self.large, integration) {
            (true, _) => "large strains: its thickness is not followed",
            (false, Integration::BBar) => "a mean dilatation: no flow keeps an area",
            _ => return Ok(()),
        };
        match H::IS_PLANE_STRESS {
            true => Err(ModelError::PlaneStress {
                group: group.into(),
                problem,
            }),
            false => Ok(()),
        }
    }

    /// Takes the cells of a group for the next material, by their kind.
    fn claim(&mut self, group: &str) -> Result<BTreeMap<CellKind, Vec<usize>>, ModelError> {
        let mut by_kind: BTreeMap<CellKind, Vec<usize>> = BTreeMap::new();
        for &cell in self.mesh.cell_group(group)? {
            if self.material[cell].replace(self.materials).is_some() {
                return Err(ModelError::TwoMaterials {
                    cell,
                    group: group.into(),
                });
            }
            by_kind.entry(self.mesh.kind(cell)).or_default().push(cell);
        }
        self.materials += 1;
        Ok(by_kind)
    }

    /// Adds a block of cells of any element and law, [`SolidBlock`](crate::SolidBlock) or another: one material, with the
    /// nodes of each of its cells among those of the cell of the mesh.
    ///
    /// # Errors
    /// [`ModelError::TwoMaterials`], with the name of the block; [`ModelError::WrongElement`] for a cell
    /// that the mesh has not, or that has other nodes there, or elsewhere, or more than 27; [`ModelError::OutOfRange`] of a
    /// block that names more cells of the mesh than it has, or fewer.
    pub fn block(mut self, name: &str, block: impl Block<D> + 'static) -> Result<Self, ModelError> {
        if block.cells().len() != block.count() {
            let what = format!("cells of the mesh that block {name:?} names, their number");
            let value = block.cells().len() as f64;
            return Err(out_of_range(&what, value, "as many as it has itself"));
        }
        for (k, &cell) in block.cells().iter().enumerate() {
            let problem = |problem: &str| ModelError::WrongElement {
                cell,
                problem: format!("of block {name:?} {problem}"),
            };
            let Some(material) = self.material.get_mut(cell) else {
                return Err(problem("is none of the mesh"));
            };
            if material.replace(self.materials).is_some() {
                return Err(ModelError::TwoMaterials {
                    cell,
                    group: name.into(),
                });
            }
            let (nodes, all) = (block.nodes(k), self.mesh.cell_nodes(cell));
            if !nodes.iter().all(|a| all.contains(a)) {
                return Err(problem(
                    "has nodes that are not those of its cell in the mesh",
                ));
            }
            let places: Vec<_> = nodes.iter().map(|&a| self.mesh.nodes()[a]).collect();
            if !block.is_at(k, &places) {
                return Err(problem("has its nodes elsewhere than in the mesh"));
            }
            if nodes.len() > MOST_NODES || nodes.len() != block.nodes(0).len() {
                return Err(problem("has too many nodes, or not as many as the first"));
            }
        }
        self.materials += 1;
        if self.team.as_ref().is_none_or(|(team, _)| team.rank() == 0) {
            self.blocks.push(Box::new(block));
            self.members.push(None);
        }
        Ok(self)
    }
}

/// Part of the elastic strain that plastic flow at rest may be: what a stress on the yield surface rounds to.
const ON_SURFACE: f64 = 1e-9;

/// Whether a law bears the state that a point starts from.
fn check_start<L: BulkLaw, const D: usize>(
    law: &L,
    cell: usize,
    position: &[f64; D],
    state: &impl Fn(&[f64; D]) -> L::State,
) -> Result<(), ModelError> {
    let start = state(position);
    let (stress, p) = (law.stress(&start), law.equivalent_plastic_strain(&start));
    let wrong = |what: &str, value: f64, expected: &'static str| {
        out_of_range(
            &format!("{what} at the start of cell {cell}"),
            value,
            expected,
        )
    };
    if let Some(&value) = stress.iter().find(|s| !s.is_finite()) {
        return Err(wrong("stress", value, "a finite number"));
    }
    if !(p >= 0.0 && p.is_finite()) {
        return Err(wrong("equivalent plastic strain", p, "0 or more"));
    }
    let response = law.respond(&start, &Sym2::zeros());
    let flow = law.equivalent_plastic_strain(&response.state) - p;
    if flow <= ON_SURFACE * law.elastic_strain(&start).norm() {
        return Ok(());
    }
    let of = |s: &Sym2| [von_mises(s), trace(s) / 3.0];
    Err(ModelError::Overstressed {
        cell,
        position: position.to_vec(),
        stress: of(&stress),
        borne: of(&response.stress),
    })
}
