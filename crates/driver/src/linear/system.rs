//! The linear system of a mesh: numbering, pattern, assembly and factorisation; not the iteration that
//! uses it.

use crate::assembly::block::{Block, points_of};
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::assembly::numbering::{Numbering, pattern_of};
use crate::assembly::scatter::{FIXED, Scatter, prescribed_columns};
use crate::assembly::turned::Turned;
use crate::error::ModelError;
use crate::linear::coarse::Coarse;
use crate::linear::others::Others;
use crate::settings::Seam;
use crate::timings::{Clock, Timings, timed};
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use crate::vector::prescribed::{Prescribed, residual};
use crate::vector::subspace::Subspace;
use moreau_algebra::{
    Cholesky, Cost, Either, Engine, EngineError, Matrix, Pattern, SharedTeam, TooLarge,
};
use moreau_mesh::Mesh;
use std::collections::BTreeSet;

mod solve;

/// K of the free degrees of freedom, ordered so that those of the interface come last.
///
/// K + σE is what is factorised, with E the identity on the interface: it is positive definite as
/// soon as holding the interface holds the bodies, and the Schur complement of K itself is
/// L_cc L_ccᵀ − σ 1 exactly, even where only contact holds a body and K is singular.
///
/// Where that factor has no room, or would take longer than conjugate gradients, the stiffness of a
/// coarse space takes its place: S is then that of the coarse space, and so are the condensed loads,
/// and what they give is brought to the solution of K itself by conjugate gradients.
#[derive(Debug)]
pub(crate) struct System {
    /// Position of a degree of freedom in the system, or [`FIXED`].
    position: Vec<u32>,
    /// Degree of freedom at a position.
    dofs: Vec<usize>,
    /// The degrees of freedom without one.
    prescribed: Prescribed,
    /// Number of interface unknowns: the last of the system.
    interface: usize,
    /// A node of the interface that no contact point needs.
    pub(crate) pivot: Option<usize>,
    /// Where the cells of every block go.
    scatter: Vec<Scatter>,
    /// Entries of the elastic K that is kept between an unknown and a prescribed displacement: their
    /// degrees of freedom.
    prescribed_columns: Vec<(usize, usize, f64)>,
    /// Whether the elastic stiffness is kept, so that only what flow adds to it is assembled anew.
    keeps_elastic: bool,
    /// K.
    matrix: Matrix,
    /// What is factorised instead where the factor of K is too large.
    coarse: Option<Coarse>,
    /// Where contacts are tied in the factor instead of condensed: the values of K that went into the factor at
    /// hand; empty where there is none.
    tied: Option<Vec<f64>>,
    shift: f64,
    stiffest: f64,
    engine: Box<dyn Engine>,
    /// What other processes hold of K.
    others: Option<Others>,
    /// Why the engine of a team has no factor, where that is no fault of the matrix.
    gave_up: Option<EngineError>,
    is_of_a_team: bool,
    /// Whether the factor held is that of the elastic stiffness.
    elastic_factor: bool,
    /// Whether the values are those that the factor was made of.
    current: bool,
    /// Negative eigenvalues of the matrix that the factor was made of, where its engine tells.
    negative: usize,
    /// Whether that of some factor of the increment had any.
    unstable: bool,
    /// Factorisations done since the system was set up.
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients since then.
    pub(crate) conjugate: usize,
    pub(crate) timings: Timings,
    /// Whether only contact holds some rigid motion.
    pub(crate) floats: bool,
    /// The nodes that each contact point between bodies couples, where contacts are tied.
    pub(crate) paired: Vec<Vec<usize>>,
}

/// Internal forces of an assembly.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assembly {
    /// ∫ Bᵀσ dΩ at every degree of freedom, less the forces of pressures that follow their surface \[N\].
    pub(crate) internal: Vec<f64>,
    /// The largest of those \[N\].
    pub(crate) pressed: f64,
    /// Free strains of all points under which they are: [`Motion::free`].
    pub(crate) free: Vec<f64>,
    /// K times the prescribed displacements that are still missing \[N\]; empty if none are.
    pub(crate) prescribed_load: Vec<f64>,
    /// Whether plastic strain grows anywhere.
    pub(crate) flows: bool,
    /// Whether the system has the stiffness that belongs to these forces.
    pub(crate) stiffness: bool,
}

impl Assembly {
    /// The load of a Newton step under forces, at every degree of freedom \[N\].
    pub(crate) fn load(&self, forces: &[&SparseVector]) -> Vec<f64> {
        let mut load = residual(&self.internal, forces, &Prescribed::default());
        let pairs = load.iter_mut().zip(&self.prescribed_load);
        pairs.for_each(|(f, prescribed)| *f -= prescribed);
        load
    }
}

/// Entries of an elastic stiffness that is kept: 16 MB. A larger one would add a tenth to the memory
/// of the factor, which takes so long that to assemble it anew is little.
const KEPT: usize = 1 << 21;

/// Operations of a factorisation in the time in which a step takes up an entry of the factor.
const OPERATIONS: f64 = 200.0;

/// Operations of a factorisation in the time in which a solve takes up an entry of the factor.
const SOLVE: f64 = 60.0;

/// Operations of a factorisation in about the time of the conjugate gradients of a Newton step: ten
/// iterations, each of which reads the matrix five times and the factor of its coarse space twice; an
/// entry is read in the time of eighty operations.
fn conjugate_operations(pattern: &Pattern, coarse: f64) -> f64 {
    10.0 * 80.0 * (5.0 * pattern.entries() as f64 + 2.0 * coarse)
}

/// What factorises a stiffness of a pattern, in so much memory \[bytes\], positive definite or of any sign: the
/// engine of a team, or of this process.
fn engine(
    pattern: &Pattern,
    memory: (Option<u64>, Option<&SharedTeam>),
    is_definite: bool,
) -> Result<Box<dyn Engine>, TooLarge> {
    let (memory, team) = memory;
    if let Some(team) = team {
        return team.engine(pattern, memory, is_definite);
    }
    Ok(match is_definite {
        true => Box::new(Cholesky::analyse(pattern, memory)?),
        false => Box::new(Either::analyse(pattern, memory)?),
    })
}

/// Time since a clock was started, of the ordering.
fn ordered(clock: Clock) -> Timings {
    Timings {
        ordering: clock.elapsed(),
        ..Timings::default()
    }
}

/// That there is no room for the factor of so many unknowns.
fn no_room(unknowns: usize, TooLarge { entries, room }: TooLarge) -> ModelError {
    let gigabytes = |entries: f64| entries * size_of::<f64>() as f64 / 1e9;
    ModelError::TooLarge {
        unknowns,
        needed: gigabytes(entries),
        room: gigabytes(room),
    }
}

/// Pivots below this part of the diagonal are rounding, and a motion without stiffness.
const RIGID: f64 = 1e-14;

/// Solves of a contact problem through the factor, and factorisations.
const TIED: (f64, f64) = (25.0, 1.5);

/// Newton iterations of a contact problem that is condensed, each of which factorises its matrix.
const CONDENSED: f64 = 6.0;

/// The numbering of a system in which contacts are tied, where their problem costs less so than condensed:
/// by operations, and where its factor has room. `interface` are its unknowns, `entries` about as many as
/// the matrix has, or more.
fn ties_are_cheaper<const D: usize>(
    interface: usize,
    (entries, room): (usize, f64),
    tied: impl Fn() -> Numbering,
    condensed: impl Fn() -> Numbering,
) -> Option<Numbering> {
    let dense = CONDENSED * 2.0 / 3.0 * (interface as f64).powi(3);
    let (solves, factorisations) = TIED;
    if dense < solves * SOLVE * entries as f64 {
        return None;
    }
    let tied = tied();
    let own = Cost::of(&tied.pattern);
    let through = factorisations * own.operations + solves * SOLVE * own.entries;
    let other = || {
        let condensed = condensed();
        let own = Cost::of(&condensed.pattern).operations;
        match D {
            3 => own.min(conjugate_operations(&condensed.pattern, 0.0)),
            _ => own,
        }
    };
    let cheaper = own.entries <= room && (through < dense || through < dense + other());
    cheaper.then_some(tied)
}

/// Pairs of nodes of all cells, each node with itself among them.
fn pairs<const D: usize>(blocks: &[Box<dyn Block<D>>]) -> usize {
    let of = |b: &dyn Block<D>| match b.cells().len() {
        0 => 0,
        cells => cells * b.nodes(0).len() * (b.nodes(0).len() + 1) / 2,
    };
    blocks.iter().map(|b| of(b.as_ref())).sum()
}

/// What is chosen to be factorised, and on which of its own entries this process adds K up.
struct Chosen {
    pattern: Pattern,
    engine: Box<dyn Engine>,
    coarse: Option<Coarse>,
}

/// What the choice depends on.
struct Choice<'a, const D: usize, F> {
    mesh: &'a Mesh<D>,
    blocks: &'a [Box<dyn Block<D>>],
    held: (F, &'a Directions),
    contacts: &'a Contacts<'a>,
    memory: (Option<u64>, Option<&'a SharedTeam>),
    numbering: &'a Numbering,
    is_tied: bool,
    is_definite: bool,
}

impl<const D: usize, F: Fn(usize) -> bool> Choice<'_, D, F> {
    /// The factor of K itself, unless that of a coarse space is cheaper or the only one that has room.
    fn made(&self, others: &mut Option<Others>) -> Result<Chosen, TooLarge> {
        let pattern = &self.numbering.pattern;
        let cost = Cost::of(pattern).operations;
        // In the plane a factor is small, and linear cells in plastic flow are a poor coarse space.
        if D == 3 && !self.is_tied && conjugate_operations(pattern, 0.0) < cost {
            let coarse = self.coarse(others).and_then(Result::ok);
            let is_cheaper = |chosen: &Chosen| {
                let own = chosen.engine.cost();
                own.operations + conjugate_operations(pattern, own.entries) < cost
            };
            if let Some(chosen) = coarse.filter(is_cheaper) {
                return Ok(chosen);
            }
            others.iter_mut().for_each(Others::refine);
        }
        self.own(others.as_ref())
            .or_else(|too_large| self.coarse(others).unwrap_or(Err(too_large)))
    }

    fn engine(&self, pattern: &Pattern) -> Result<Box<dyn Engine>, TooLarge> {
        engine(pattern, self.memory, self.is_definite)
    }

    fn own(&self, others: Option<&Others>) -> Result<Chosen, TooLarge> {
        let pattern = match others {
            None => self.numbering.pattern.clone(),
            Some(_) => self.here(&[]).0,
        };
        Ok(Chosen {
            engine: self.engine(&pattern)?,
            pattern,
            coarse: None,
        })
    }

    /// `None` if no node is between others.
    fn coarse(&self, others: &mut Option<Others>) -> Option<Result<Chosen, TooLarge>> {
        let Numbering { dofs, pattern, .. } = self.numbering;
        let (pattern, here) = match others {
            None => (pattern.clone(), Vec::new()),
            Some(others) => self.here(&others.shared(dofs.len())),
        };
        let &Contacts {
            nodes,
            pivot,
            tools,
            ..
        } = self.contacts;
        let (fixed, directions) = &self.held;
        let space = (nodes, pivot, tools);
        let coarse = Coarse::new(self.mesh, (fixed, directions), space, (dofs, &pattern))?;
        if let Some(others) = others {
            others.coarsen(&coarse.space, &pattern, here);
        }
        let engine = self.engine(&coarse.space.matrix().pattern);
        Some(engine.map(|engine| Chosen {
            pattern,
            engine,
            coarse: Some(coarse),
        }))
    }

    /// Where this process has entries of K: of the cells that it holds, and of what contacts and pressures may couple, on
    /// which it adds them up. With the unknowns that are `shared` by others it has all entries among these and its own,
    /// and tells which they are.
    fn here(&self, shared: &[bool]) -> (Pattern, Vec<bool>) {
        let Numbering {
            position,
            dofs,
            interface,
            ..
        } = self.numbering;
        let cells = |held: bool| {
            let of = self.blocks.iter().flat_map(move |b| {
                let own = (0..b.cells().len()).filter(move |&k| b.holds(k) == held);
                own.map(move |k| b.nodes(k))
            });
            of.collect::<Vec<&[usize]>>()
        };
        let mut groups = cells(true);
        let mesh = self.mesh;
        let facets = mesh
            .group_names()
            .filter_map(|name| mesh.facet_group(name).ok());
        let facets = facets.flatten().map(|&f| mesh.facet_nodes(f).collect());
        let facets: BTreeSet<Vec<usize>> = facets.collect();
        groups.extend(facets.iter().map(Vec::as_slice));
        let coupled = self.contacts.coupled.unwrap_or(self.contacts.turned).iter();
        groups.extend(coupled.map(Vec::as_slice));
        let mut own = vec![false; position.len() / D];
        groups
            .iter()
            .for_each(|nodes| nodes.iter().for_each(|&a| own[a] = true));
        let all = dofs.iter().zip(shared);
        all.for_each(|(&dof, &shared)| own[dof / D] |= shared);
        let mut between: Vec<Vec<usize>> = Vec::new();
        if !shared.is_empty() {
            let of = |nodes: &[usize]| nodes.iter().copied().filter(|&a| own[a]).collect();
            between.extend(cells(false).into_iter().map(of));
        }
        groups.extend(between.iter().map(Vec::as_slice));
        let pattern = pattern_of::<D>(position, dofs, *interface, &groups);
        (pattern, dofs.iter().map(|&dof| own[dof / D]).collect())
    }
}

/// What a system has to know of contacts.
pub(crate) struct Contacts<'a> {
    /// Nodes that may touch, on both sides.
    pub(crate) nodes: &'a [usize],
    /// A node that no contact needs and that is treated as they are.
    pub(crate) pivot: Option<usize>,
    /// Number of nodes of tools: after those of the mesh, without stiffness.
    pub(crate) tools: usize,
    pub(crate) seam: Seam,
    /// The nodes that each contact couples, where it may be tied.
    pub(crate) coupled: Option<&'a [Vec<usize>]>,
    /// The nodes that contact forces couple which turn with tools, where these are driven.
    pub(crate) turned: &'a [Vec<usize>],
}

impl System {
    /// Numbers the free degrees of freedom, along their directions, orders them and does the symbolic factorisation. The
    /// interface is that of the contacts, the pivot if there is one, and the tools. The factor may take
    /// `memory` \[bytes\].
    ///
    /// # Errors
    /// [`ModelError::TooLarge`] where neither its own factor nor that of a coarse space has room.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        blocks: &[Box<dyn Block<D>>],
        (fixed, directions): (impl Fn(usize) -> bool, &Directions),
        contacts: &Contacts<'_>,
        memory: (Option<u64>, Option<&SharedTeam>),
    ) -> Result<Self, ModelError> {
        let (bytes, team) = memory;
        let clock = Clock::start();
        let &Contacts {
            nodes: interface_nodes,
            pivot,
            tools,
            seam,
            coupled,
            turned,
        } = contacts;
        let condensed = || Numbering::new(mesh, &fixed, interface_nodes, pivot, tools, turned);
        let tied = coupled.and_then(|coupled| {
            let tied = || Numbering::new(mesh, &fixed, &[], None, tools, coupled);
            let room = bytes.map_or(f64::INFINITY, |b| b as f64 / size_of::<f64>() as f64);
            if seam == Seam::Tied {
                let tied = tied();
                return (Cost::of(&tied.pattern).entries <= room).then_some(tied);
            }
            let free = |a: &usize| (D * a..D * a + D).filter(|&dof| !fixed(dof)).count();
            let nodes: BTreeSet<usize> = interface_nodes.iter().copied().collect();
            let interface = nodes.iter().map(free).sum::<usize>();
            ties_are_cheaper::<D>(interface, (pairs(blocks) * D * D, room), tied, condensed)
        });
        let is_tied = tied.is_some();
        // Under large strains stresses add to the stiffness what may make it indefinite.
        let is_definite = blocks.iter().all(|b| b.keeps_elastic_stiffness());
        let numbering = tied.unwrap_or_else(condensed);
        let several = team.filter(|team| team.size() > 1);
        let mut others = several.map(|team| Others::new(team, (&numbering.position, directions)));
        let choice = Choice {
            mesh,
            blocks,
            held: (&fixed, directions),
            contacts,
            memory,
            numbering: &numbering,
            is_tied,
            is_definite,
        };
        let chosen = choice.made(&mut others);
        let Chosen {
            pattern,
            engine,
            coarse,
        } = chosen.map_err(|error| no_room(numbering.dofs.len(), error))?;
        let Numbering {
            position,
            dofs,
            interface,
            ..
        } = numbering;
        let scatter = blocks
            .iter()
            .map(|b| Scatter::new(b.as_ref(), &position, &pattern))
            .collect();
        Ok(Self {
            prescribed: Prescribed {
                dofs: (0..position.len())
                    .filter(|&dof| position[dof] == FIXED)
                    .collect(),
                directions: directions.clone(),
            },
            position,
            dofs,
            interface,
            pivot,
            scatter,
            prescribed_columns: Vec::new(),
            keeps_elastic: is_definite && others.is_none() && pattern.entries() <= KEPT,
            others,
            gave_up: None,
            is_of_a_team: team.is_some(),
            matrix: Matrix::new(pattern),
            coarse,
            tied: is_tied.then(Vec::new),
            shift: 0.0,
            stiffest: 0.0,
            engine,
            elastic_factor: false,
            current: false,
            negative: 0,
            unstable: false,
            factorisations: 0,
            conjugate: 0,
            floats: false,
            paired: Vec::new(),
            timings: ordered(clock),
        })
    }

    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Entries stored of the factor.
    pub(crate) fn factor_entries(&self) -> usize {
        self.engine.cost().entries as usize
    }

    /// Whether a displacement is unknown.
    pub(crate) fn is_free(&self, dof: usize) -> bool {
        self.position[dof] != FIXED
    }

    /// Directions in which a node is free.
    pub(crate) fn free_at<const D: usize>(&self, node: usize) -> Subspace<D> {
        Subspace::of_node(node, &self.prescribed.directions, |dof| self.is_free(dof))
    }

    /// Index of a degree of freedom among the interface unknowns; `None` if it is prescribed.
    pub(crate) fn interface_index(&self, dof: usize) -> Option<usize> {
        let first = self.size() - self.interface;
        self.is_free(dof)
            .then(|| self.position[dof] as usize - first)
    }

    /// The degrees of freedom that are prescribed, with the directions of all.
    pub(crate) fn prescribed(&self) -> &Prescribed {
        &self.prescribed
    }

    /// σ \[N/mm\]: of the size of the elastic stiffness of an interface node.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// Internal forces at the end of a motion, and the stiffness if asked for.
    /// `missing` are the prescribed increments still to come, along the axes as all vectors are that are given or
    /// returned.
    pub(crate) fn assemble<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        mut motion: Motion<'_>,
        missing: &SparseVector,
        stiffness: Stiffness,
    ) -> Assembly {
        let clock = Clock::start();
        let stiffness = match stiffness {
            Stiffness::Plastic(part) if !self.keeps_elastic => Stiffness::Total(part),
            other => other,
        };
        let mut internal = vec![0.0; motion.by.len()];
        let mut flows = false;
        let with_stiffness = stiffness != Stiffness::None;
        if with_stiffness {
            self.matrix.reset();
        }
        let mut prescribed_load = Vec::new();
        let directions = &self.prescribed.directions;
        let missing = directions.components(missing);
        let missing = (!missing.is_zero()).then_some(&*missing);
        let mut turned = Turned::of(directions);
        if let Some(missing) = missing {
            prescribed_load.resize(motion.by.len(), 0.0);
            for &(unknown, prescribed, k) in &self.prescribed_columns {
                prescribed_load[unknown] += k * missing.at(prescribed);
            }
        }
        if let Some(others) = &mut self.others {
            others.reset(with_stiffness, missing);
        }
        let position = &self.position;
        let (pattern, values) = self.matrix.values_mut();
        for (block, scatter) in blocks.iter_mut().zip(&self.scatter) {
            let own = motion.split_off(points_of(block.as_ref()));
            flows |= block.evaluate(own, stiffness, &mut |cell| {
                for (&a, force) in cell.nodes.iter().zip(cell.force.chunks_exact(D)) {
                    let at = internal[D * a..D * a + D].iter_mut();
                    at.zip(force).for_each(|(sum, f)| *sum += f);
                }
                let cell = turned.cell::<D>(cell);
                scatter.add::<D>(&cell, position, pattern, values);
                if let Some(missing) = missing {
                    prescribed_columns::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        prescribed_load[unknown] += k * missing.at(prescribed);
                    });
                }
            });
        }
        if let (Some(others), true) = (&self.others, with_stiffness) {
            others.take_over(self.matrix.values_mut().1);
        }
        if let (Some(others), Some(_)) = (&self.others, missing) {
            others.add_prescribed(&self.dofs, &mut prescribed_load);
        }
        directions.restore(&mut prescribed_load);
        if with_stiffness {
            self.current = self.elastic_factor && !flows;
            let size = self.size();
            let tied = self.others.as_mut().filter(|_| self.tied.is_some());
            tied.into_iter()
                .for_each(|others| others.find_diagonal(size));
        }
        self.timings.assembly += clock.elapsed();
        Assembly {
            internal,
            pressed: 0.0,
            free: Vec::new(),
            prescribed_load,
            flows,
            stiffness: with_stiffness,
        }
    }

    /// Assembles the elastic stiffness, to which flow only adds, learns its size, and chooses σ: its
    /// largest diagonal on the interface, or zero if the bodies must be held without it.
    pub(crate) fn assemble_elastic<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        from: &[f64],
        shifted: bool,
    ) {
        let clock = Clock::start();
        let by = vec![0.0; from.len()];
        let keeps = self.keeps_elastic;
        if let Some(others) = &mut self.others {
            others.reset(true, None);
        }
        let (position, all) = (&self.position, &mut self.prescribed_columns);
        let mut turned = Turned::of(&self.prescribed.directions);
        let (pattern, values) = self.matrix.values_mut();
        for (block, scatter) in blocks.iter_mut().zip(&self.scatter) {
            block.evaluate(Motion::new(from, &by), Stiffness::Total(0.0), &mut |cell| {
                let cell = turned.cell::<D>(cell);
                scatter.add::<D>(&cell, position, pattern, values);
                if keeps {
                    prescribed_columns::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        all.push((unknown, prescribed, k));
                    });
                }
            });
        }
        if keeps {
            self.matrix.keep();
        }
        let first = self.size() - self.interface;
        if let Some(others) = &mut self.others {
            others.take_over(self.matrix.values_mut().1);
            others.find_diagonal(self.dofs.len());
        }
        let own = |p: usize| self.diagonal(p as u32);
        let stiffest = (0..self.size()).map(own).fold(0.0, f64::max);
        self.stiffest = stiffest;
        let diagonal = |p: usize| self.diagonal(p as u32);
        self.shift = match (shifted, &self.tied) {
            (false, _) => 0.0,
            (true, Some(_)) => self.stiffest,
            (true, None) => (first..self.size()).map(diagonal).fold(0.0, f64::max),
        };
        self.timings.assembly += clock.elapsed();
    }

    /// Whether the factor held is that of the elastic stiffness.
    pub(crate) fn holds_elastic_factor(&self) -> bool {
        self.elastic_factor
    }

    /// How many steps without a factorisation take about as long as one: operations of the one over
    /// what the others read of the factor.
    pub(crate) fn steps_per_factorisation(&self) -> f64 {
        let cost = self.engine.cost();
        cost.operations / (OPERATIONS * cost.entries)
    }

    /// How many solves take about as long as a factorisation.
    pub(crate) fn solves_per_factorisation(&self) -> f64 {
        let cost = self.engine.cost();
        cost.operations / (SOLVE * cost.entries)
    }

    /// Largest diagonal of the elastic stiffness \[N/mm\].
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// Factorises the assembled K + σE, unless the factor held is already that of the elastic
    /// stiffness and the stiffness assembled is elastic too.
    ///
    /// # Errors
    /// The degree of freedom at which K + σE is not positive definite.
    pub(crate) fn factorise(&mut self, elastic: bool) -> Result<(), usize> {
        if elastic && self.elastic_factor {
            return Ok(());
        }
        self.elastic_factor = false;
        self.gave_up = None;
        self.factorisations += 1;
        let (interface, shift) = (self.interface, self.shift);
        let inertia = timed(&mut self.timings.factorisation, || {
            let matrix = match &mut self.coarse {
                Some(coarse) => {
                    self.others.iter().for_each(Others::project);
                    coarse.space.project(&self.matrix)?;
                    coarse.space.matrix_mut()
                }
                None => &mut self.matrix,
            };
            matrix.shift(interface, shift);
            self.engine.factorise(matrix.values())
        })
        .inspect_err(|error| {
            let is_of_the_matrix = matches!(
                error,
                EngineError::NotPositiveDefinite { .. } | EngineError::Singular { .. }
            );
            self.gave_up = (!is_of_the_matrix && self.is_of_a_team).then_some(*error);
        })
        .map_err(|error| {
            let dofs = self.coarse.as_ref().map_or(&self.dofs, |c| &c.dofs);
            match error {
                EngineError::NotPositiveDefinite { row } | EngineError::Singular { row, .. } => {
                    dofs[row]
                }
                EngineError::NotFinite { column } => dofs[column],
                _ => dofs.last().copied().unwrap_or(0),
            }
        })?;
        self.negative = inertia.negative;
        self.unstable |= self.is_indefinite();
        self.elastic_factor = elastic;
        self.current = true;
        Ok(())
    }

    /// Why the engine of a team has no factor, where that is no fault of the matrix.
    pub(crate) fn gave_up(&self) -> Option<EngineError> {
        self.gave_up
    }

    /// Whether the matrix that the factor was made of has negative eigenvalues, its kept unknowns aside.
    pub(crate) fn is_indefinite(&self) -> bool {
        self.negative > 0
    }

    /// Whether some matrix of the increment had.
    pub(crate) fn was_indefinite(&self) -> bool {
        self.unstable
    }

    /// How many it has.
    pub(crate) fn negative(&self) -> usize {
        self.negative
    }

    /// Adds entries (row, column) of a symmetric stiffness at degrees of freedom to K, those of its lower triangle
    /// and of unknowns that a cell or a contact couples.
    pub(crate) fn add(&mut self, entries: impl Iterator<Item = (usize, usize, f64)>) {
        let (pattern, values) = self.matrix.values_mut();
        let directions = &self.prescribed.directions;
        for (row, column, k) in entries {
            for (row, part) in directions.parts(row) {
                for (column, other) in directions.parts(column) {
                    let (row, column) = (self.position[row], self.position[column]);
                    if row < column || row == FIXED || column == FIXED {
                        continue;
                    }
                    if let Some(slot) = pattern.slot(row, column) {
                        values[slot as usize] += part * other * k;
                    }
                }
            }
        }
    }

    /// Whether contacts are tied in the factor.
    pub(crate) fn is_tied(&self) -> bool {
        self.tied.is_some()
    }

    /// Factorises K and what `ties` adds to its values; false where the sum leaves a motion without
    /// stiffness.
    pub(crate) fn tie(&mut self, ties: impl FnOnce(&Pattern, &mut [f64])) -> bool {
        let mut sum = self.tied.take().unwrap_or_default();
        sum.clear();
        sum.extend_from_slice(self.matrix.values());
        ties(&self.matrix.pattern, &mut sum);
        self.elastic_factor = false;
        self.factorisations += 1;
        let outcome = timed(&mut self.timings.factorisation, || {
            self.engine.factorise(&sum)
        });
        let holds = outcome.is_ok() && self.engine.least_pivot() > RIGID;
        if let Some(others) = &mut self.others {
            others.factorised(holds);
        }
        match holds {
            true => sum.copy_from_slice(self.matrix.values()),
            false => sum.clear(),
        }
        self.tied = Some(sum);
        holds
    }

    /// Whether the factor at hand is that of K and of ties.
    pub(crate) fn holds_ties(&self) -> bool {
        let others = self.others.as_ref().is_none_or(Others::is_factorised);
        others && self.tied.as_deref() == Some(self.matrix.values())
    }

    /// Begins an increment, which does the same whatever factor the last one has left.
    pub(crate) fn begin(&mut self) {
        self.tied.iter_mut().for_each(Vec::clear);
        self.unstable = false;
    }

    /// What a vector has along the unknowns, by its entries at degrees of freedom.
    pub(crate) fn at_unknowns(&self, at: impl Fn(usize) -> f64) -> Vec<f64> {
        let directions = &self.prescribed.directions;
        let own = self.dofs.iter();
        own.map(|&dof| directions.component(dof, &at)).collect()
    }

    /// Position of a degree of freedom among the unknowns; `None` if it is prescribed.
    pub(crate) fn unknown(&self, dof: usize) -> Option<u32> {
        Some(self.position[dof]).filter(|&p| p != FIXED)
    }

    /// Entry of K on the diagonal of an unknown \[N/mm\].
    pub(crate) fn diagonal(&self, unknown: u32) -> f64 {
        let others = self
            .others
            .as_ref()
            .map_or(0.0, |o| o.diagonal(unknown as usize));
        self.matrix.diagonal(unknown as usize) + others
    }

    /// f − K u.
    fn residual(&self, u: &[f64], f: &[f64]) -> Vec<f64> {
        let mut r = self.matrix.residual(u, f);
        if let Some(others) = &self.others {
            others.subtract_product(u, &mut r);
        }
        r
    }

    /// The factor held is of no use to the next increment.
    pub(crate) fn forget_factor(&mut self) {
        self.elastic_factor = false;
    }

    /// Whether the factor is one of K itself.
    pub(crate) fn is_direct(&self) -> bool {
        self.coarse.is_none()
    }
}

#[cfg(test)]
mod tests;
