//! A model: mesh, materials, tools and contacts; not its loads, which are steps.

pub(crate) mod amplitude;
pub(crate) mod analysis;
pub(crate) mod contact;
pub(crate) mod footing;
pub(crate) mod grip;
pub(crate) mod load;
pub(crate) mod material;
pub(crate) mod motion_row;
pub(crate) mod points;
pub(crate) mod skin;
pub(crate) mod temperature;
pub(crate) mod ties;

use crate::assembly::block::Block;
use crate::assembly::spread::block::SpreadBlock;
use crate::assembly::spread::partition::partition;
use crate::error::ModelError;
use crate::model::analysis::Analysis;
use crate::model::contact::Contact;
use crate::model::points::{ContactPoint, Tool};
use moreau_algebra::SharedTeam;
use moreau_mesh::Mesh;
use std::sync::Arc;

fn out_of_range(what: &str, value: f64, expected: &'static str) -> ModelError {
    ModelError::OutOfRange {
        what: what.into(),
        value,
        expected,
    }
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

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }

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

    /// Whether every cell has a material, and no node is on the other side of an axis.
    ///
    /// # Errors
    /// [`ModelError::MissingMaterial`], [`ModelError::OutOfRange`].
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let beyond = |x: &[f64; D]| self.hypothesis.measure(x) < 0.0;
        if let Some(node) = self.mesh.nodes().iter().position(beyond) {
            let radius = self.mesh.nodes()[node][0];
            return Err(out_of_range(
                &format!("radius of node {node}"),
                radius,
                "one that is not negative: the axis is at x = 0",
            ));
        }
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
