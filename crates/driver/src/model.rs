//! A model: mesh, materials, tools and contacts; not its loads, which are steps.

pub(crate) mod amplitude;
pub(crate) mod footing;
pub(crate) mod load;
pub(crate) mod motion_row;
pub(crate) mod points;
pub(crate) mod temperature;
pub(crate) mod ties;

use crate::assembly::block::{Block, SolidBlock};
use crate::assembly::cells::{Cells, ElementCells};
use crate::assembly::panel::PanelBlock;
use crate::assembly::spread::block::SpreadBlock;
use crate::assembly::spread::partition::partition;
use crate::error::ModelError;
use crate::model::load::facet_of;
use crate::model::points::{ALONG_NORMAL, ContactPoint, Tool, tool_index};
use crate::vector::SparseVector;
use moreau_algebra::SharedTeam;
use moreau_contact::Obstacle;
use moreau_laws::{BulkLaw, Friction, InPlaneStress, PanelLaw};
use moreau_mandel::{Sym2, trace, von_mises};
use moreau_mesh::{
    Axisymmetric, CellKind, Element, Facet, Hex8, Hex20, Hex27, Hypothesis, Integration, Mesh,
    MortarRow, Pairing, PlaneStrain, PlaneStress, PositiveShare, Pressed, Quad4, Quad8, Quad9,
    Share, Solid, Tet4, Tet10, Tri3, Tri6, nearest,
};
use nalgebra::SVector;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most nodes of a cell.
const MOST_NODES: usize = 27;

/// A hypothesis together with the elements that it can be used with.
pub trait Analysis<const D: usize>: Hypothesis<D> {
    /// Cells of one kind; `None` if the hypothesis has no such cells.
    fn cells(
        &self,
        mesh: &Mesh<D>,
        kind: CellKind,
        cells: &[usize],
        integration: Integration,
    ) -> Option<Box<dyn Cells<D>>>;

    /// Cells of the mesh, `members`, under a law at small or at `large` strains, with the state that every quadrature
    /// point starts from by its position in the undeformed body \[mm\].
    fn solid_block<L: BulkLaw>(
        members: Vec<usize>,
        cells: Box<dyn Cells<D>>,
        law: L,
        large: bool,
        state: &impl Fn(&[f64; D]) -> L::State,
    ) -> Box<dyn Block<D>>;
}

fn cells<E, H, const D: usize, const N: usize>(
    hypothesis: &H,
    mesh: &Mesh<D>,
    cells: &[usize],
    integration: Integration,
) -> Option<Box<dyn Cells<D>>>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
{
    let cells = ElementCells::<D, N>::new::<E, H>(mesh, cells, hypothesis, integration).ok()?;
    Some(Box::new(cells))
}

/// The elements of the plane.
fn plane<H: Hypothesis<2>>(
    h: &H,
    mesh: &Mesh<2>,
    kind: CellKind,
    of: &[usize],
    rule: Integration,
) -> Option<Box<dyn Cells<2>>> {
    match kind {
        CellKind::Tri3 => cells::<Tri3, H, 2, 3>(h, mesh, of, rule),
        CellKind::Tri6 => cells::<Tri6, H, 2, 6>(h, mesh, of, rule),
        CellKind::Quad4 => cells::<Quad4, H, 2, 4>(h, mesh, of, rule),
        CellKind::Quad8 => cells::<Quad8, H, 2, 8>(h, mesh, of, rule),
        CellKind::Quad9 => cells::<Quad9, H, 2, 9>(h, mesh, of, rule),
        _ => None,
    }
}

/// The elements of space.
fn space<H: Hypothesis<3>>(
    h: &H,
    mesh: &Mesh<3>,
    kind: CellKind,
    of: &[usize],
    rule: Integration,
) -> Option<Box<dyn Cells<3>>> {
    match kind {
        CellKind::Tet4 => cells::<Tet4, H, 3, 4>(h, mesh, of, rule),
        CellKind::Tet10 => cells::<Tet10, H, 3, 10>(h, mesh, of, rule),
        CellKind::Hex8 => cells::<Hex8, H, 3, 8>(h, mesh, of, rule),
        CellKind::Hex20 => cells::<Hex20, H, 3, 20>(h, mesh, of, rule),
        CellKind::Hex27 => cells::<Hex27, H, 3, 27>(h, mesh, of, rule),
        _ => None,
    }
}

/// A law as it is.
fn solid<L: BulkLaw, const D: usize>(
    members: Vec<usize>,
    cells: Box<dyn Cells<D>>,
    law: L,
    large: bool,
    state: &impl Fn(&[f64; D]) -> L::State,
) -> Box<dyn Block<D>> {
    match large {
        true => Box::new(SolidBlock::large(members, cells, law).with_states(state)),
        false => Box::new(SolidBlock::new(members, cells, law).with_states(state)),
    }
}

/// A law in plane stress, which is not compiled where there is none; at small strains, as is checked before.
fn plate<L: BulkLaw>(
    members: Vec<usize>,
    cells: Box<dyn Cells<2>>,
    law: L,
    _large: bool,
    state: &impl Fn(&[f64; 2]) -> L::State,
) -> Box<dyn Block<2>> {
    let plate = SolidBlock::new(members, cells, InPlaneStress(law));
    Box::new(plate.with_states(|x| state(x).into()))
}

macro_rules! analysis {
    ($hypothesis:ty, $dimension:literal, $elements:ident, $block:ident) => {
        impl Analysis<$dimension> for $hypothesis {
            fn cells(
                &self,
                mesh: &Mesh<$dimension>,
                kind: CellKind,
                cells: &[usize],
                integration: Integration,
            ) -> Option<Box<dyn Cells<$dimension>>> {
                $elements(self, mesh, kind, cells, integration)
            }

            fn solid_block<L: BulkLaw>(
                members: Vec<usize>,
                cells: Box<dyn Cells<$dimension>>,
                law: L,
                large: bool,
                state: &impl Fn(&[f64; $dimension]) -> L::State,
            ) -> Box<dyn Block<$dimension>> {
                $block(members, cells, law, large, state)
            }
        }
    };
}

analysis!(PlaneStrain, 2, plane, solid);
analysis!(PlaneStress, 2, plane, plate);
analysis!(Axisymmetric, 2, plane, solid);
analysis!(Solid, 3, space, solid);

/// What the driver still asks of the hypothesis once the blocks are built.
pub(crate) trait Measure<const D: usize>: Send + Sync {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>>;
    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)>;
    /// [`Mesh::press`] of the entries of [`Loading::pressure`](crate::Loading::pressure).
    fn press(
        &self,
        mesh: &Mesh<D>,
        pressures: &SparseVector,
        position: &dyn Fn(usize) -> [f64; D],
        visit: &mut dyn FnMut(&Pressed),
    );
    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]>;
    fn mortar_rows(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        surfaces: (&[Facet], &[Facet]),
        pairing: Pairing,
    ) -> Vec<MortarRow<D>>;
}

impl<const D: usize, H: Hypothesis<D>> Measure<D> for H {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>> {
        mesh.facet_shares(facets, self)
    }

    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)> {
        mesh.volume_shares(cells, self)
    }

    fn press(
        &self,
        mesh: &Mesh<D>,
        pressures: &SparseVector,
        position: &dyn Fn(usize) -> [f64; D],
        visit: &mut dyn FnMut(&Pressed),
    ) {
        let facets = pressures.iter().map(|(k, p)| (facet_of(k), p));
        mesh.press(facets, position, self, visit);
    }

    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]> {
        H::rigid_modes(x)
    }

    fn mortar_rows(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        surfaces: (&[Facet], &[Facet]),
        pairing: Pairing,
    ) -> Vec<MortarRow<D>> {
        mesh.mortar_rows(positions, surfaces, pairing, self)
    }
}

fn out_of_range(what: &str, value: f64, expected: &'static str) -> ModelError {
    ModelError::OutOfRange {
        what: what.into(),
        value,
        expected,
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

/// A surface and what is opposite to it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    pub(crate) surface: String,
    /// Name of a tool or of a surface.
    pub(crate) opposite: String,
    /// How the surfaces of two bodies are paired; `None` on a tool, and of a tie.
    pub(crate) pairing: Option<Pairing>,
}

/// Mesh, materials, tools and contacts of a problem.
pub struct Model<const D: usize, H> {
    pub(crate) mesh: Mesh<D>,
    pub(crate) hypothesis: H,
    pub(crate) blocks: Vec<Box<dyn Block<D>>>,
    pub(crate) tools: Vec<Tool<D>>,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) points: Vec<ContactPoint<D>>,
    /// Number of the material of every cell, in the order in which they were given.
    pub(crate) material: Vec<Option<usize>>,
    materials: usize,
    /// Strain of every cell by a kelvin \[1/K\]; empty where none expands.
    pub(crate) expansion: Vec<f64>,
    /// Whether strains and rotations of materials are large.
    large: bool,
    /// Processes that hold the cells together, and which holds which.
    pub(crate) team: Option<(SharedTeam, Vec<u32>)>,
    /// Cells of all processes in each block; `None` of one that the first holds alone.
    members: Vec<Option<Vec<usize>>>,
}

impl<const D: usize, H: Analysis<D>> Model<D, H> {
    /// A model of a mesh under a hypothesis, without materials.
    pub fn new(mesh: Mesh<D>, hypothesis: H) -> Self {
        Self {
            material: vec![None; mesh.cell_count()],
            materials: 0,
            expansion: Vec::new(),
            large: false,
            team: None,
            members: Vec::new(),
            mesh,
            hypothesis,
            blocks: Vec::new(),
            tools: Vec::new(),
            contacts: Vec::new(),
            points: Vec::new(),
        }
    }

    /// A model whose materials bear large strains and rotations: their laws see logarithmic strains, and
    /// equilibrium is where the body is.
    pub fn with_large_strains(mesh: Mesh<D>, hypothesis: H) -> Self {
        Self {
            large: true,
            ..Self::new(mesh, hypothesis)
        }
    }

    /// The same with its cells on several processes, each of which makes the same model: the first goes on with
    /// [`Driver`](crate::Driver) as if it were alone, the others with [`Driver::serve`](crate::Driver::serve). Materials come
    /// after this; blocks of other cells than those of materials stay with the first.
    pub fn on_team(mut self, team: SharedTeam) -> Self {
        let process = partition(&self.mesh, team.size());
        self.team = Some((team, process));
        self
    }

    /// Gives the cells of a group a law and an integration rule. Under [`PlaneStress`] the law is
    /// [`InPlaneStress`], which is not to be asked for.
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
    /// An unknown group, a number that is not finite.
    pub fn expansion(mut self, group: &str, per_kelvin: f64) -> Result<Self, ModelError> {
        if !per_kelvin.is_finite() {
            let what = format!("expansion of {group:?}");
            return Err(out_of_range(&what, per_kelvin, "a finite number"));
        }
        self.expansion.resize(self.mesh.cell_count(), 0.0);
        for &cell in self.mesh.cell_group(group)? {
            self.expansion[cell] = per_kelvin;
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

    /// Adds a block of cells of any element and law, [`SolidBlock`] or another: one material, with the
    /// nodes of each of its cells among those of the cell of the mesh.
    ///
    /// # Errors
    /// [`ModelError::TwoMaterials`], with the name of the block; [`ModelError::WrongElement`] for a cell
    /// that the mesh has not, or that has other nodes there, or more than 27.
    pub fn block(mut self, name: &str, block: impl Block<D> + 'static) -> Result<Self, ModelError> {
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
    /// from which face each other at the start of the increment ([`Mesh::fold`]).
    ///
    /// # Errors
    /// An unknown group; [`ModelError::SharedContactNode`] for a node of `surface` that is one of
    /// another contact with the same surface; [`ModelError::SharedSurfaceNode`].
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
        let itself = self.large && surface == opposite && pairing == Pairing::Mortar;
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
        let mut shares = self.mesh.positive_shares(facets, &self.hypothesis);
        if self.large && D == 2 && tool.is_some() {
            // At nodes themselves, whose places are what large strains ask of: on the axis one may bear nothing.
            let nodal = self.mesh.facet_shares(facets, &self.hypothesis);
            shares = nodal.into_iter().map(PositiveShare::of_node).collect();
        }
        let meets = |p: &&ContactPoint<D>| self.contacts[p.contact].opposite == opposite;
        let taken: BTreeMap<usize, usize> = (self.points.iter().filter(meets))
            .map(|p| (p.node, p.contact))
            .collect();
        for PositiveShare { share, own } in shares {
            if let Some(&other) = taken.get(&share.node) {
                return Err(ModelError::SharedContactNode {
                    node: share.node,
                    position: self.mesh.nodes()[share.node].to_vec(),
                    first: self.contacts[other].surface.clone(),
                    second: surface.into(),
                    opposite: opposite.into(),
                });
            }
            self.points.push(ContactPoint {
                node: share.node,
                tool,
                contact: self.contacts.len(),
                law,
                axis: None,
                offset: 0.0,
                area: share.area,
                kind: share.kind,
                own,
                tied: None,
            });
        }
        Ok(())
    }

    /// Lets the nodes of the contact added last touch at a distance from the tool \[mm\]: that of a
    /// coating, or of half a sheet; negative, to lie into it.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a number that is not finite.
    pub fn gap_offset(mut self, offset: f64) -> Result<Self, ModelError> {
        if !offset.is_finite() {
            return Err(out_of_range("gap offset", offset, "a finite number"));
        }
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
    /// [`ModelError::OutOfRange`] for an axis of no length, [`ModelError::NormalAxis`] for one that is
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
        let Some(last) = self.contacts.last() else {
            return Ok(self);
        };
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
    /// nor is strained.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a tolerance that is negative or not finite.
    pub fn adjust(mut self, tolerance: f64) -> Result<Self, ModelError> {
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            let expected = "a non-negative number";
            return Err(out_of_range(
                "tolerance of adjusted gaps",
                tolerance,
                expected,
            ));
        }
        let last = self.contacts.len();
        for point in self.points.iter_mut().filter(|p| p.contact + 1 == last) {
            let Some(tool) = point.tool else { continue };
            let obstacle = self.tools[tool].obstacle.as_ref();
            let gap = point.gap(obstacle, |a| self.mesh.nodes()[a].into());
            if gap.abs() <= tolerance {
                point.offset += gap;
            }
        }
        Ok(self)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }

    /// # Errors
    /// [`ModelError::MissingMaterial`].
    /// The blocks, with those of a team that it holds together in place of the part of this process.
    pub(crate) fn take_blocks(&mut self) -> Vec<Box<dyn Block<D>>> {
        let blocks = std::mem::take(&mut self.blocks);
        let Some((team, process)) = self
            .team
            .as_ref()
            .filter(|(t, _)| t.rank() == 0 && t.size() > 1)
        else {
            return blocks;
        };
        let mut nodes_of = vec![vec![false; self.mesh.nodes().len()]; team.size()];
        for &cell in self.members.iter().flatten().flatten() {
            let own = &mut nodes_of[process[cell] as usize];
            self.mesh
                .cell_nodes(cell)
                .iter()
                .for_each(|&a| own[a] = true);
        }
        let listed = |own: Vec<bool>| -> Vec<u32> {
            (0..own.len() as u32).filter(|&a| own[a as usize]).collect()
        };
        let nodes_of: Arc<Vec<Vec<u32>>> = Arc::new(nodes_of.into_iter().map(listed).collect());
        let mut number = 0;
        let wrapped = |(own, members): (Box<dyn Block<D>>, Option<Vec<usize>>)| {
            let Some(members) = members else { return own };
            let process = members.iter().map(|&c| process[c]).collect();
            let nodes: Vec<usize> = (members.iter())
                .flat_map(|&c| self.mesh.cell_nodes(c).iter().copied())
                .collect();
            let per_cell = nodes.len() / members.len().max(1);
            let at = (team.clone(), number);
            number += 1;
            let nodes = (nodes, per_cell);
            Box::new(SpreadBlock::new(
                at,
                own,
                members,
                nodes,
                process,
                nodes_of.clone(),
            )) as _
        };
        let members = self.members.clone();
        blocks.into_iter().zip(members).map(wrapped).collect()
    }

    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let mut bare = (0..self.material.len()).filter(|&c| self.material[c].is_none());
        match bare.next() {
            Some(first) => Err(ModelError::MissingMaterial {
                count: 1 + bare.count(),
                first,
            }),
            None => Ok(()),
        }
    }
}
