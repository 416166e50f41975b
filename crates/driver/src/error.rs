//! Errors of the driver: of setting up a model and of a step; facts with numbers.

mod law;
mod tool;

pub use law::{LawFault, Place};
pub use tool::ToolOutOfContact;
use tool::direction;

use crate::report::collapse::Collapse;
use moreau_contact::ContactError;
use moreau_mesh::MeshError;

/// A model or a step that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Of the mesh or a group.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Of an obstacle or the contact problem.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Cells without a material.
    #[error("{count} cells have no material, the first is cell {first}: give one to every cell")]
    MissingMaterial {
        /// Number of such cells.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// A cell with two materials.
    #[error("cell {cell} of group {group:?} has a material already: groups must not overlap")]
    TwoMaterials {
        /// The cell.
        cell: usize,
        /// Group of the second material.
        group: String,
    },
    /// A cell that expands in two ways.
    #[error("cell {cell} of group {group:?} has an expansion already, and another")]
    TwoExpansions {
        /// The cell.
        cell: usize,
        /// Group of the second expansion.
        group: String,
    },
    /// A stress at the start that a law does not bear.
    #[error(
        "cell {cell} starts at {position:?} outside of its yield surface{}",
        overstress(stress, borne)
    )]
    Overstressed {
        /// The cell.
        cell: usize,
        /// The quadrature point \[mm\].
        position: Vec<f64>,
        /// Von Mises' stress and the mean stress, tension positive \[MPa\].
        stress: [f64; 2],
        /// What the law makes of them.
        borne: [f64; 2],
    },
    /// A cell with two temperatures.
    #[error(
        "cell {cell} of group {group:?} has a temperature already in step {step:?}: groups must not overlap"
    )]
    TwoTemperatures {
        /// The step.
        step: String,
        /// The cell.
        cell: usize,
        /// Group of the second temperature.
        group: String,
    },
    /// A cell that an element or a block does not fit.
    #[error("cell {cell} {problem}")]
    WrongElement {
        /// The cell.
        cell: usize,
        /// What is wrong.
        problem: String,
    },
    /// A tool that does not exist.
    #[error("no tool is named {name:?}{}", nearest_hint(.nearest))]
    UnknownTool {
        /// The name asked for.
        name: String,
        /// The nearest name that exists.
        nearest: Option<String>,
    },
    /// Two tools of one name.
    #[error("a tool named {name:?} exists already: names must differ")]
    DuplicateTool {
        /// The name.
        name: String,
    },
    /// A contact with something that is neither a tool nor a group of facets.
    #[error(
        "{surface:?} cannot touch {name:?}: no tool and no group of facets has that name{}",
        nearest_hint(.nearest)
    )]
    UnknownOpposite {
        /// The surface.
        surface: String,
        /// The name asked for.
        name: String,
        /// The nearest tool or group of facets.
        nearest: Option<String>,
    },
    /// A node of two surfaces that touch the same.
    #[error(
        "node {node} at {position:?} belongs to {first:?} and to {second:?}, which both touch {opposite:?}: \
         make one group of both surfaces, or leave the node out of one"
    )]
    SharedContactNode {
        /// The node.
        node: usize,
        /// Its position \[mm\].
        position: Vec<f64>,
        /// Surface of the first contact.
        first: String,
        /// Of the second.
        second: String,
        /// What both touch.
        opposite: String,
    },
    /// An axis of friction that has no direction on a surface.
    #[error(
        "the axis of friction is normal to {surface:?} at node {node} at {position:?}: expected a \
         direction along the surface"
    )]
    NormalAxis {
        /// The surface.
        surface: String,
        /// The node.
        node: usize,
        /// Its position \[mm\].
        position: Vec<f64>,
    },
    /// Two surfaces that share a node.
    #[error(
        "{surface:?} and {opposite:?} share node {node} at {position:?}: \
         bodies in contact must have nodes of their own"
    )]
    SharedSurfaceNode {
        /// First surface.
        surface: String,
        /// The surface opposite.
        opposite: String,
        /// The node.
        node: usize,
        /// Its position \[mm\].
        position: Vec<f64>,
    },
    /// A surface against itself under small strains.
    #[error(
        "{surface:?} against itself under small strains: a part has to bend far to touch itself, which large strains \
         alone follow"
    )]
    SmallSelfContact {
        /// The surface.
        surface: String,
    },
    /// A facet that two ties have.
    #[error(
        "{group:?} is tied already where it is at {position:?}, by the tie of {surface:?} to {to:?}: \
         expected surfaces that no other tie has"
    )]
    TiedTwice {
        /// The group with the facet.
        group: String,
        /// The surface of the tie before.
        surface: String,
        /// What that is tied to.
        to: String,
        /// A node of the facet \[mm\].
        position: Vec<f64>,
    },
    /// Surfaces that are not opposite to each other anywhere.
    #[error(
        "nothing of {surface:?} is opposite to {to:?}: expected surfaces that lie on each other, with their outsides \
         together"
    )]
    NothingToTie {
        /// The surface.
        surface: String,
        /// What it should be tied to.
        to: String,
    },
    /// Surfaces too far apart, or too deep within each other, to be tied.
    #[error(
        "{surface:?} and {to:?} are {apart} apart opposite to node {node} at {position:?}: expected at most {bridged}, a \
         quarter of a facet"
    )]
    TiedApart {
        /// The surface.
        surface: String,
        /// What it should be tied to.
        to: String,
        /// The node.
        node: usize,
        /// Its position \[mm\].
        position: Vec<f64>,
        /// The distance \[mm\].
        apart: f64,
        /// The largest that is bridged \[mm\].
        bridged: f64,
    },
    /// A body that could move without resistance.
    #[error(
        "{body} is free to move: nothing resists {motion}. \
         Fix displacements, or add a contact (with friction, if the motion is along its surface)"
    )]
    FreeRigidMotion {
        /// The body in words, see [`Driver::body_in_words`](crate::Driver::body_in_words).
        body: String,
        /// The motion in words.
        motion: String,
    },
    /// A tool driven by a force or a moment that could move without resistance.
    #[error(
        "tool {tool:?} is driven and free to move: nothing resists {motion}. \
         Prescribe its motion there, or give it a contact (with friction, if the motion is along its \
         surface)"
    )]
    FreeTool {
        /// The tool.
        tool: String,
        /// The motion in words.
        motion: String,
    },
    /// A tool driven away from all that it may touch.
    #[error(
        "tool {tool:?} is driven by a force along {:?}, away from every surface that it may touch: \
         nothing can stand up to that; turn the force round, or prescribe the tool's motion",
        direction(force)
    )]
    PulledTool {
        /// The tool.
        tool: String,
        /// The force on it at the end of the increment \[N\].
        force: Vec<f64>,
    },
    /// A tool driven by a force or a moment that no contact has.
    #[error(
        "tool {tool:?} is driven, but no contact is against it: nothing can stand up to its force or \
         moment; add the contact, or prescribe the tool's motion"
    )]
    UntouchedTool {
        /// The tool.
        tool: String,
    },
    /// A tool driven by a force that touches nothing.
    #[error("{0}")]
    ToolOutOfContact(Box<ToolOutOfContact>),
    /// A moment about an axis that a tool has turned across.
    #[error(
        "a moment turns tool {tool:?} about {axis:?}, and it has turned about {turned:?} before: expected the same axis"
    )]
    TiltedAxle {
        /// The tool.
        tool: String,
        /// Axis of the moment.
        axis: Vec<f64>,
        /// How far it has turned, along the axis of that \[rad\].
        turned: Vec<f64>,
    },
    /// A moment that nothing carries.
    #[error(
        "the moment of {moment} N·mm on tool {tool:?} is more than friction carries, by which alone it is held: it spins. \
         In the last equilibrium the moment was {carried:.6e} N·mm. Press it harder, give it more friction or a smaller moment, or prescribe its turn"
    )]
    SpinningTool {
        /// The tool.
        tool: String,
        /// The moment \[N·mm\].
        moment: f64,
        /// The moment in the last equilibrium \[N·mm\].
        carried: f64,
    },
    /// A tool whose moment is nearly all that friction carries.
    #[error(
        "friction alone holds tool {tool:?} against its moment, and carries hardly more: in the last equilibrium, under \
         {carried:.6e} N·mm, nearly all that touches the tool slipped. While the moment is there, on its way to {moment} N·mm, \
         hardly anything decides how far the tool turns. Let it go first in a step of its own in which nothing moves, press it \
         harder, give it a smaller moment, or prescribe its turn"
    )]
    SlippingTool {
        /// The tool.
        tool: String,
        /// The moment at the end of the step \[N·mm\].
        moment: f64,
        /// The moment in the last equilibrium \[N·mm\].
        carried: f64,
    },
    /// A moment that turns a tool away from all that it may touch.
    #[error(
        "tool {tool:?} is turned by the moment {moment} N·mm away from every surface that it may touch: nothing can stand \
         up to that; turn the moment round, or prescribe the tool's turn"
    )]
    TurnedAwayTool {
        /// The tool.
        tool: String,
        /// The moment \[N·mm\].
        moment: f64,
    },
    /// Two conditions that prescribe one displacement differently.
    #[error(
        "step {step:?} prescribes u_{axis} of node {node} as {first} and as {second} mm: remove one"
    )]
    TwoDisplacements {
        /// The step.
        step: String,
        /// The node.
        node: usize,
        /// The component, x, y or z.
        axis: char,
        /// The first value \[mm\].
        first: f64,
        /// The second value \[mm\].
        second: f64,
    },
    /// Two conditions that say how far a tool moves or turns.
    #[error("step {step:?} says twice how far tool {tool:?} {what}: both are totals, remove one")]
    TwoMotions {
        /// The step.
        step: String,
        /// The tool.
        tool: String,
        /// What it does: moves or turns.
        what: &'static str,
    },
    /// Conditions at a node that prescribe its displacement along a direction differently.
    #[error(
        "step {step:?} prescribes the displacement of node {node} along {} as {first} and as {second} mm, by the \
         conditions on {}: remove one",
        list(direction),
        names(groups)
    )]
    ContradictingDisplacements {
        /// The step.
        step: String,
        /// The node.
        node: usize,
        /// The unit vector of the last of these conditions.
        direction: Vec<f64>,
        /// What the others make of it \[mm\].
        first: f64,
        /// What it prescribes \[mm\].
        second: f64,
        /// Groups of the node whose displacements are prescribed.
        groups: Vec<String>,
    },
    /// A node that is moved off the axis of symmetry.
    #[error(
        "step {step:?} moves node {node} by {value} mm across the axis of symmetry, by the conditions on {}: a body of \
         revolution stays there without being held; keep the node out of the group",
        names(groups)
    )]
    LeavesAxis {
        /// The step.
        step: String,
        /// Groups that have the node and that the step moves.
        groups: Vec<String>,
        /// The node.
        node: usize,
        /// The displacement \[mm\].
        value: f64,
    },
    /// A load that needs an area on the axis of symmetry, which has none.
    #[error(
        "step {step:?} loads {group:?}, which is on the axis of symmetry: it has no area, and nothing there moves across it"
    )]
    LoadOnAxis {
        /// The step.
        step: String,
        /// The group.
        group: String,
    },
    /// A direction at the axis of symmetry, where nothing moves but along that.
    #[error(
        "step {step:?} prescribes the displacement of {group:?} along {}, but its node {node} is on the axis of \
         symmetry, where nothing moves across it: prescribe x and y there, and keep the node out of the group",
        list(direction)
    )]
    DirectionAtAxis {
        /// The step.
        step: String,
        /// The group.
        group: String,
        /// The node.
        node: usize,
        /// The unit vector.
        direction: Vec<f64>,
    },
    /// Of a law that is given from outside.
    #[error(transparent)]
    Law(#[from] LawFault),
    /// A material that plane stress does not go with.
    #[error("plane stress of {group:?} does not go with {problem}")]
    PlaneStress {
        /// Its group.
        group: String,
        /// What it does not go with, and why.
        problem: &'static str,
    },
    /// A law of panels where strains and rotations are large.
    #[error(
        "the law of {group:?} answers for small strains only, and the strains of this model are large: take a law \
         of points, or small strains"
    )]
    SmallStrainsOnly {
        /// Its group of cells.
        group: String,
    },
    /// A number that is NaN or infinite, or outside of its range.
    #[error("{what} is {value}, expected {expected}")]
    OutOfRange {
        /// The datum.
        what: String,
        /// Its value.
        value: f64,
        /// The admissible range in words.
        expected: &'static str,
    },
    /// A saved state of another model.
    #[error("the saved state has {found} {what}, the model {expected}: it is of another model")]
    Saved {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// The factor does not fit into memory or a 32-bit index; where cells have nodes between their
    /// corners, nor does that of the coarse space.
    #[error(
        "the factor of {unknowns} unknowns takes {}, and there is room for {}; \
         larger cells away from the contact, or a plane of symmetry, take less",
        memory(*needed),
        memory(*room)
    )]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Size of the factor \[GB\].
        needed: f64,
        /// What there is room for \[GB\]: the memory that is free, or what the index counts.
        room: f64,
    },
}

/// A vector as people write one: what is beyond this many digits is rounding.
pub(crate) fn list(vector: &[f64]) -> String {
    let rounded = |x: &f64| format!("{x:.11e}").parse().unwrap_or(*x);
    let all: Vec<String> = vector.iter().map(|x| format!("{:?}", rounded(x))).collect();
    format!("({})", all.join(", "))
}

/// A size in gigabytes, in the unit in which it is not next to nothing.
fn memory(gigabytes: f64) -> String {
    let units = [(1.0, "GB"), (1e3, "MB"), (1e6, "kB")];
    let unit = units.iter().find(|(parts, _)| gigabytes * parts >= 1.0);
    let (parts, unit) = unit.unwrap_or(&units[2]);
    format!("{:.3} {unit}", gigabytes * parts)
}

fn names(names: &[String]) -> String {
    let all: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    all.join(" and ")
}

fn nearest_hint(nearest: &Option<String>) -> String {
    nearest
        .as_ref()
        .map_or_else(String::new, |n| format!("; did you mean {n:?}?"))
}

/// A node out of balance.
#[derive(Debug, Clone, PartialEq)]
pub struct Imbalance {
    /// The node.
    pub node: usize,
    /// Its position in the undeformed body \[mm\].
    pub position: Vec<f64>,
    /// Norm of the force that nothing balances \[N\].
    pub force: f64,
}

/// An increment that failed. The state is what it was before.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IncrementError {
    /// The model does not admit this increment.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The contact problem of an iteration has no solution that was found.
    #[error("in iteration {iteration}: {source}")]
    Contact {
        /// Newton iteration.
        iteration: usize,
        /// What the contact solver says.
        source: ContactError,
    },
    /// Newton's iteration ended above its tolerance.
    #[error(
        "Newton left {out_of_balance:.3e} N out of balance after {iterations} iterations, \
         expected at most {tolerance:.3e} N; worst at {}; {:.0} % of the volume flows plastically",
        worst_nodes(.worst), 100.0 * .plastic_fraction
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Largest nodal force that nothing balances \[N\].
        out_of_balance: f64,
        /// What was asked for \[N\].
        tolerance: f64,
        /// Up to five nodes with the largest imbalance.
        worst: Vec<Imbalance>,
        /// Part of the volume in which plastic strain grew.
        plastic_fraction: f64,
    },
    /// A tool went through a contact point, in and out again, in one increment.
    #[error(
        "in one increment tool {tool:?} went through node {node} at {position:?}, {depth:.3e} mm deep on the \
         way: the increment is too large for contact to follow"
    )]
    Passage {
        /// The tool.
        tool: String,
        /// Node of the contact point.
        node: usize,
        /// Its position in the undeformed body \[mm\].
        position: Vec<f64>,
        /// How deep it was in the tool \[mm\].
        depth: f64,
    },
    /// A tool turned by more than a quarter turn: the increment is too large.
    #[error(
        "in one increment tool {tool:?} turned by {:.1}°: the increment is too large for contact to follow, which is found \
         up to a quarter turn", angle.to_degrees()
    )]
    Turn {
        /// The tool.
        tool: String,
        /// By how much \[rad\].
        angle: f64,
    },
    /// A body went into another one where no contact was found: the increment is too large.
    #[error(
        "in one increment {surface:?} and {opposite:?} went {depth:.3e} mm into each other at node {node} at \
         {position:?}: the increment is too large for contact to follow"
    )]
    Within {
        /// The surface.
        surface: String,
        /// The surface opposite.
        opposite: String,
        /// Node that is deepest.
        node: usize,
        /// Its position in the undeformed body \[mm\].
        position: Vec<f64>,
        /// How deep \[mm\].
        depth: f64,
    },
    /// A stable equilibrium was left for another one, across unstable ones or none.
    #[error(
        "the body snaps: it moves by {moved:.3e} mm at once, far from the equilibrium before: loads have passed \
         their limit, or tools have lost their hold"
    )]
    Snap {
        /// Largest displacement of the increment \[mm\].
        moved: f64,
    },
    /// The load of a step has passed a limit on the path of equilibria, and falls along it until the body leaves what
    /// pushes it: there is no equilibrium near under a larger load.
    #[error(
        "step {step:?} passes the limit of its load at {:.4} % of it: beyond that the body snaps away from what pushes \
         it, and finds no balance near; prescribe the motion of the tool to see more of it, or load less",
        100.0 * .limit
    )]
    SnapsAway {
        /// Name of the step.
        step: String,
        /// The largest load that was in balance, in parts of that of the step.
        limit: f64,
    },
    /// The structure has moved by its own size under the loads of a step, and carries ever more: there is no limit load
    /// on the way. The state is in equilibrium.
    #[error(
        "step {step:?} has no limit load up to load factor {factor:.6}: the structure has moved by its own size there, and \
         still carries {:.3} % more where the work of its loads doubles, because it hardens or is elastic. Load less, to at \
         most what small displacements bear; for a limit load let it be perfectly plastic, at the stress that hardening \
         reaches at strains that matter",
        100.0 * .growth
    )]
    RunsAway {
        /// Name of the step.
        step: String,
        /// The load factor, of the way from the loads at the start of the step to its own.
        factor: f64,
        /// Its growth, over itself, while the work of the loads doubled.
        growth: f64,
    },
    /// The tangent is not positive definite: a mechanism.
    #[error(
        "the stiffness is not positive definite at node {node}, u_{axis} ({position:?}): \
         the structure is a mechanism there, or collapses"
    )]
    Mechanism {
        /// Node of the bad pivot.
        node: usize,
        /// The component, x, y or z.
        axis: char,
        /// Position of the node \[mm\].
        position: Vec<f64>,
    },
    /// A solve with the factor left more than rounding, also after a correction: memory or the
    /// library of kernels is at fault, or a stiffness that is all but singular.
    #[error(
        "the factorised stiffness leaves {found:.3e} N of a linear solve, expected at most \
         {expected:.3e} N. Where contacts or ties alone hold a body it is all but singular: take a penalty nearer to the \
         stiffness of the bodies, or the exact law, or hold what may move freely. Where displacements hold every \
         body memory or the machine is at fault: run it again, or on another one"
    )]
    Inaccurate {
        /// Largest residual \[N\].
        found: f64,
        /// The largest that rounding explains \[N\].
        expected: f64,
    },
    /// The solver of the linear system has no factor, for reasons of its own.
    #[error("no factor of the stiffness: {problem}")]
    Solver {
        /// What the solver tells.
        problem: String,
    },
    /// A state that numbers do not hold: forces, displacements or energies beyond all bounds.
    #[error(
        "the {what} at the end of the increment is {value}: what is prescribed is beyond anything that \
         can be computed; compare it with the size of the model, and the units"
    )]
    NotFinite {
        /// What overflows.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Of a law that is given from outside.
    #[error(transparent)]
    Law(#[from] LawFault),
    /// Whoever watched the iterates broke off.
    #[error("the increment was interrupted")]
    Interrupted,
    /// The structure does not carry the loads of the step: an answer, not a failure. The state is
    /// that of the mechanism, in equilibrium with what the structure carries.
    #[error("step {step:?}: {collapse}: the structure does not carry more")]
    Collapse {
        /// Name of the step.
        step: String,
        /// The load factor and its bound.
        collapse: Collapse,
    },
    /// No balance where something begins within something else, which shorter increments make no less.
    #[error(
        "{surface:?} and {opposite:?} are within each other before anything moves, by {depth:.3} mm at node {node} at \
         {position:?}, {inside} nodes in all: that is more than the body can be pushed apart at once, and shorter \
         increments make it no less. Of the attempt: {cause}"
    )]
    Overlap {
        /// The surface of the contact.
        surface: String,
        /// The tool or the surface that it is against.
        opposite: String,
        /// How deep one is in the other \[mm\].
        depth: f64,
        /// The node where that is.
        node: usize,
        /// Its position \[mm\].
        position: Vec<f64>,
        /// Nodes that are within what they are in contact with.
        inside: usize,
        /// Why the attempt failed.
        cause: Box<IncrementError>,
    },
    /// The step was cut as far as allowed.
    #[error(
        "step {step:?} stopped at {:.4} % of its load: {}{cause}",
        100.0 * .reached,
        last_attempt(.cause, *.smallest, &collapse_hint(.cause, *.plastic_fraction, *.limit, (*.moves, *.reached)))
    )]
    Stopped {
        /// Name of the step.
        step: String,
        /// Part of the step that converged, in [0, 1); its state is kept.
        reached: f64,
        /// Length of the last attempt, in parts of the step.
        smallest: f64,
        /// Part of the volume that flowed plastically in the last attempt that tells, or in the
        /// last converged increment.
        plastic_fraction: f64,
        /// Estimate of the load factor at collapse from the last two increments, λ∞ of a hyperbola over
        /// the work of the loads; `None` where only part of what is applied are loads, or the
        /// structure does not soften.
        limit: Option<f64>,
        /// Whether the step moves something that it prescribes.
        moves: bool,
        /// Why the last attempt failed.
        cause: Box<IncrementError>,
    },
}

impl IncrementError {
    /// Whether no closed contact holds a body.
    pub(crate) fn is_singular(&self) -> bool {
        let singular = ContactError::Singular;
        matches!(self, Self::Contact { source, .. } if *source == singular)
    }

    /// Whether the increment was broken off from outside, by whoever watched it or by a law: the next one begins as if
    /// it had not.
    pub fn is_broken_off(&self) -> bool {
        match self {
            Self::Interrupted => true,
            Self::Law(fault) => fault.breaks_off(),
            _ => false,
        }
    }

    /// Whether a smaller increment is none of the ways out: it was broken off, or the model makes no sense.
    pub(crate) fn is_final(&self) -> bool {
        matches!(self, Self::Model(_)) || self.is_broken_off()
    }
}

/// A factor that does not solve the system it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inaccurate {
    /// Largest residual \[N\].
    pub(crate) found: f64,
    /// The largest that rounding explains \[N\].
    pub(crate) expected: f64,
}

impl From<Inaccurate> for IncrementError {
    fn from(Inaccurate { found, expected }: Inaccurate) -> Self {
        Self::Inaccurate { found, expected }
    }
}

fn worst_nodes(worst: &[Imbalance]) -> String {
    let one = |w: &Imbalance| format!("node {} {:?} ({:.1e} N)", w.node, w.position, w.force);
    worst.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// To six digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Part of a stress that is rounding, as what is left of von Mises' stress at the apex of a cone.
const NO_STRESS: f64 = 1e-9;

/// Von Mises' stress and the mean stress, and what a law bears of them, in words.
fn overstress(stress: &[f64; 2], borne: &[f64; 2]) -> String {
    let largest = stress[0].max(stress[1].abs());
    let clean = |v: f64| match v.abs() <= NO_STRESS * largest {
        true => 0.0,
        false => rounded(v),
    };
    let [q, mean, q_borne, mean_borne] = [stress[0], stress[1], borne[0], borne[1]].map(clean);
    let is_beyond_apex = q_borne == 0.0 && mean_borne < mean;
    let apex = match is_beyond_apex {
        true => ", beyond the apex of its cone",
        false => "",
    };
    format!(
        "{apex}: von Mises' stress is {q:?} and the mean stress {mean:?}, of which the law bears {q_borne:?} and {mean_borne:?}"
    )
}

/// What comes before the cause: how short the last attempt was, and a hint. None of an overlap, which no shorter one was
/// tried for.
fn last_attempt(cause: &IncrementError, smallest: f64, hint: &str) -> String {
    match cause {
        IncrementError::Overlap { .. } => String::new(),
        _ => format!("increments were cut to {smallest:.2e} of the step. {hint}Last attempt: "),
    }
}

/// What to look for, and a space; nothing where the cause says it.
fn collapse_hint(
    cause: &IncrementError,
    plastic_fraction: f64,
    limit: Option<f64>,
    (moves, reached): (bool, f64),
) -> String {
    if matches!(
        cause,
        IncrementError::Passage { .. }
            | IncrementError::Turn { .. }
            | IncrementError::Within { .. }
            | IncrementError::Overlap { .. }
            | IncrementError::NotFinite { .. }
            | IncrementError::Law(_)
            | IncrementError::Snap { .. }
            | IncrementError::Contact {
                source: ContactError::Floating { .. },
                ..
            }
    ) {
        return String::new();
    }
    if let IncrementError::Contact {
        source: ContactError::NotConverged { .. },
        ..
    } = cause
    {
        return "The contact problem was not solved, which tells nothing of the load: take the method \"exact\" \
                inside of each iteration (semismooth Newton), if it is another one, or allow smaller increments. "
            .into();
    }
    if plastic_fraction <= 0.02 {
        return "Hardly anything flows plastically: look for a contact that opens or a missing support. "
            .into();
    }
    if moves && reached == 0.0 {
        return "Plastic flow is widespread in the first increment, however short it is: what begins inside of a body \
                pushes that apart at once, and what moves farther than the body is large leaves it no room; look where \
                tools begin and how far they go. "
            .into();
    }
    if moves {
        return "Plastic flow is widespread under motions that are prescribed: the load has probably passed its limit, and \
                the path of equilibria turns back or breaks off where flow gathers in bands, or the motions leave the \
                body no room, as in a die that is full; allow smaller increments, and compare with another mesh. "
            .into();
    }
    let estimate = limit.map_or_else(String::new, |limit| {
        format!(", which the last increments put at {:.1} %", 100.0 * limit)
    });
    format!(
        "Plastic flow is widespread: the load is probably at the limit load{estimate}; prescribe \
         displacements to pass it. "
    )
}

#[cfg(test)]
mod tests {
    use super::list;

    #[test]
    fn a_vector_has_the_digits_that_it_was_given() {
        let given = [0.1 + 0.2, -12_345.678_901, 1.0, 1e-50, f64::MAX];
        assert_eq!(
            list(&given),
            "(0.3, -12345.678901, 1.0, 1e-50, 1.79769313486e308)"
        );
        assert_eq!(list(&[f64::NAN, f64::INFINITY]), "(NaN, inf)");
    }
}
