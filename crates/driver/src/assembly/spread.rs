//! Cells that several processes hold: who holds which, the block that stands for all of them, and what the others
//! do for it; not the factor of what they add up.

pub(crate) mod block;
pub(crate) mod coarsened;
pub(crate) mod partition;
pub(crate) mod serve;
pub(crate) mod share;

/// What the first process asks of the others: the first byte of an order. There are more from the engine.
pub(crate) mod ask {
    /// Forces of the cells of a block at the end of a motion, with their stiffness added to the share or without.
    pub(crate) const EVALUATE: u8 = 1;
    /// What their tangents lack of being those of the forces.
    pub(crate) const LACKING: u8 = 2;
    /// The potential of a motion.
    pub(crate) const POTENTIAL: u8 = 3;
    /// Energies of the candidate.
    pub(crate) const ENERGY: u8 = 4;
    /// The power of plastic flow.
    pub(crate) const FLOW_POWER: u8 = 5;
    /// The candidate is the state.
    pub(crate) const COMMIT: u8 = 6;
    /// States at quadrature points, with gradients.
    pub(crate) const GRADIENTS: u8 = 7;
    /// Fields of laws.
    pub(crate) const FIELDS: u8 = 8;
    /// What the stiffness of stresses makes of displacements.
    pub(crate) const STRESS_STIFFNESS: u8 = 9;
    /// Numbers of the states.
    pub(crate) const STATE: u8 = 10;
    /// States from numbers.
    pub(crate) const RESTORE: u8 = 11;
    /// Which displacement is which unknown, and along which direction.
    pub(crate) const NUMBER: u8 = 12;
    /// The share is zero again, and so much is missing of prescribed displacements.
    pub(crate) const RESET: u8 = 13;
    /// What the share makes of what is missing.
    pub(crate) const PRESCRIBED: u8 = 14;
    /// What it makes of displacements.
    pub(crate) const PRODUCT: u8 = 15;
    /// Its diagonal.
    pub(crate) const DIAGONAL: u8 = 16;
    /// What its unknowns follow in a coarse space, whose share takes the place of its own.
    pub(crate) const COARSEN: u8 = 17;
    /// Entries between unknowns that the first process sweeps: they are there from then on.
    pub(crate) const HAND_OVER: u8 = 18;
    /// The share of the coarse space is that of the entries.
    pub(crate) const PROJECT: u8 = 19;
    /// A sweep down over the unknowns that no other process has.
    pub(crate) const SWEEP_DOWN: u8 = 20;
    /// The sweep back.
    pub(crate) const SWEEP_UP: u8 = 21;
}
