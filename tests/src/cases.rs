//! The cases of `cargo xtask verify`, in the order of the report; one file each.

mod algorithms;
mod block;
mod cattaneo;
mod collapse;
mod compare;
mod forming;
mod greco;
mod large;
mod penalty;
mod pictures;
mod prandtl;
mod punch_in_space;
mod ring;
mod rounded_punch;

pub use compare::{History, record};

use crate::Case;

/// All cases.
pub fn all() -> Vec<Case> {
    vec![
        prandtl::CASE,
        block::CASE,
        penalty::CASE,
        algorithms::CASE,
        algorithms::TIMES,
        greco::CASE,
        cattaneo::CASE,
        rounded_punch::CASE,
        ring::CASE,
        collapse::CASE,
        punch_in_space::CASE,
        large::UPSETTING,
        large::RING,
        large::NECK,
        large::INDENTATION,
        large::TURNING,
        forming::ROLLING,
        forming::DRAWING,
        forming::HARDNESS,
    ]
}
