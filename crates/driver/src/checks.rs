//! What a model lacks and what an answer hides, told before or after it is solved; nothing that changes it.

pub(crate) mod ahead;
pub(crate) mod beside;
pub(crate) mod between;
pub(crate) mod gaps;
pub(crate) mod loose;
pub(crate) mod narrow;
pub(crate) mod passage;
pub(crate) mod rigid;
pub(crate) mod smallness;
pub(crate) mod strides;
pub(crate) mod supports;
pub(crate) mod swings;
pub(crate) mod unjoined;
pub(crate) mod untied;
