//! What a system is made of: which unknowns come last, whether contacts are tied or condensed, and whether the
//! stiffness is factorised or a coarse space of it; not the numbers.

use super::System;
use crate::assembly::block::Block;
use crate::assembly::numbering::{Numbering, pattern_of};
use crate::assembly::scatter::{FIXED, Scatter};
use crate::error::ModelError;
use crate::linear::coarse::Coarse;
use crate::linear::others::Others;
use crate::settings::Seam;
use crate::timings::{Clock, Timings};
use crate::vector::directions::Directions;
use crate::vector::prescribed::Prescribed;
use moreau_algebra::{Cholesky, Cost, Either, Engine, Matrix, Pattern, SharedTeam, TooLarge};
use moreau_mesh::Mesh;
use std::collections::BTreeSet;

/// Entries of an elastic stiffness that is kept: 16 MB. A larger one would add a tenth to the memory
/// of the factor, which takes so long that to assemble it anew is little.
const KEPT: usize = 1 << 21;

/// Operations of a factorisation in the time in which a solve takes up an entry of the factor.
pub(super) const SOLVE: f64 = 60.0;

/// Operations of a factorisation in about the time of the conjugate gradients of a Newton step: ten
/// iterations, each of which reads the matrix five times and the factor of its coarse space twice; an
/// entry is read in the time of eighty operations.
fn conjugate_operations(entries: usize, coarse: f64) -> f64 {
    10.0 * 80.0 * (5.0 * entries as f64 + 2.0 * coarse)
}

/// What factorises a stiffness of a pattern, in so much memory \[bytes\], positive definite or of any sign: the
/// engine of a team, or of this process.
pub(super) fn engine(
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
    tied: impl Fn() -> Numbered,
    condensed: impl Fn() -> Numbered,
) -> Option<Numbered> {
    let dense = CONDENSED * 2.0 / 3.0 * (interface as f64).powi(3);
    let (solves, factorisations) = TIED;
    if dense < solves * SOLVE * entries as f64 {
        return None;
    }
    let tied = tied();
    let own = Cost::of(&tied.1);
    let through = factorisations * own.operations + solves * SOLVE * own.entries;
    let other = || {
        let (_, pattern) = condensed();
        let own = Cost::of(&pattern).operations;
        match D {
            3 => own.min(conjugate_operations(pattern.entries(), 0.0)),
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

/// A numbering, and which of its unknowns share a cell.
type Numbered = (Numbering, Pattern);

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
    /// Of all of K, on whatever process its entries are.
    whole: Whole,
}

/// What is to be known of all of K.
struct Whole {
    entries: usize,
    /// Operations of a factorisation.
    operations: f64,
    /// Where one process has it all.
    pattern: Option<Pattern>,
}

impl Whole {
    fn new(pattern: Pattern, is_of_one: bool) -> Self {
        Self {
            entries: pattern.entries(),
            operations: Cost::of(&pattern).operations,
            pattern: is_of_one.then_some(pattern),
        }
    }
}

impl<const D: usize, F: Fn(usize) -> bool> Choice<'_, D, F> {
    /// The factor of K itself, unless that of a coarse space is cheaper or the only one that has room.
    fn made(&self, others: &mut Option<Others>) -> Result<Chosen, TooLarge> {
        let &Whole {
            entries,
            operations: cost,
            ..
        } = &self.whole;
        // In the plane a factor is small, and linear cells in plastic flow are a poor coarse space.
        if D == 3 && !self.is_tied && conjugate_operations(entries, 0.0) < cost {
            let coarse = self.coarse(others).and_then(Result::ok);
            let is_cheaper = |chosen: &Chosen| {
                let own = chosen.engine.cost();
                own.operations + conjugate_operations(entries, own.entries) < cost
            };
            if let Some(chosen) = coarse.filter(is_cheaper) {
                return Ok(chosen);
            }
            others.iter_mut().for_each(Others::refine);
        }
        self.own()
            .or_else(|too_large| self.coarse(others).unwrap_or(Err(too_large)))
    }

    fn engine(&self, pattern: &Pattern) -> Result<Box<dyn Engine>, TooLarge> {
        engine(pattern, self.memory, self.is_definite)
    }

    fn own(&self) -> Result<Chosen, TooLarge> {
        let pattern = self.whole.pattern.clone();
        let pattern = pattern.unwrap_or_else(|| self.here(&[]).0);
        Ok(Chosen {
            engine: self.engine(&pattern)?,
            pattern,
            coarse: None,
        })
    }

    /// `None` if no node is between others.
    fn coarse(&self, others: &mut Option<Others>) -> Option<Result<Chosen, TooLarge>> {
        let dofs = &self.numbering.dofs;
        let shared = others.as_ref().map(|others| others.shared(dofs.len()));
        let (pattern, here) = match &self.whole.pattern {
            Some(pattern) => (pattern.clone(), Vec::new()),
            None => self.here(&shared.unwrap_or_default()),
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
        let condensed =
            || Numbering::with_pattern(mesh, &fixed, interface_nodes, pivot, tools, turned);
        let tied = coupled.and_then(|coupled| {
            let tied = || Numbering::with_pattern(mesh, &fixed, &[], None, tools, coupled);
            let room = bytes.map_or(f64::INFINITY, |b| b as f64 / size_of::<f64>() as f64);
            if seam == Seam::Tied {
                let tied = tied();
                return (Cost::of(&tied.1).entries <= room).then_some(tied);
            }
            let free = |a: &usize| (D * a..D * a + D).filter(|&dof| !fixed(dof)).count();
            let nodes: BTreeSet<usize> = interface_nodes.iter().copied().collect();
            let interface = nodes.iter().map(free).sum::<usize>();
            ties_are_cheaper::<D>(interface, (pairs(blocks) * D * D, room), tied, condensed)
        });
        let is_tied = tied.is_some();
        // Under large strains stresses add to the stiffness what may make it indefinite.
        let is_definite = blocks.iter().all(|b| b.keeps_elastic_stiffness());
        let (numbering, pattern) = tied.unwrap_or_else(condensed);
        let several = team.filter(|team| team.size() > 1);
        // On several processes it goes before they tell what is theirs.
        let whole = Whole::new(pattern, several.is_none());
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
            whole,
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
            has_lost_others: false,
            gave_up: None,
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
}
