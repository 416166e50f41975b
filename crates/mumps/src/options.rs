//! What MUMPS is told beyond what it decides itself; not what it is asked.

use moreau_algebra::{Parcel, Unpacked};

/// How MUMPS factorises, beyond what it decides itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// Error that blocks of low rank may leave of those that they stand for; `None` without them.
    pub low_rank: Option<f64>,
    /// Whether unknowns are eliminated in the order that METIS finds, and not in that of the pattern, which is of
    /// nested dissection of the nodes.
    pub metis: bool,
    /// Part by which working space is larger than was estimated, in percent; `None` as MUMPS has it.
    pub spare: Option<i32>,
    /// How many times working space that turns out too small is doubled; `None` as this crate has it, six times.
    pub larger: Option<usize>,
}

impl Options {
    pub(crate) fn packed(self, parcel: Parcel) -> Parcel {
        let spare = self.spare.map_or(-1.0, f64::from);
        let numbers = [
            self.low_rank.unwrap_or(-1.0),
            f64::from(u8::from(self.metis)),
            spare,
            self.larger.map_or(-1.0, |n| n as f64),
        ];
        parcel.reals(&numbers)
    }

    pub(crate) fn unpacked(parcel: &mut Unpacked<'_>) -> Self {
        let numbers = parcel.reals();
        let at = |k: usize| numbers.get(k).copied().filter(|&x| x >= 0.0);
        Self {
            low_rank: at(0),
            metis: at(1) == Some(1.0),
            spare: at(2).map(|x| x as i32),
            larger: at(3).map(|x| x as usize),
        }
    }
}
