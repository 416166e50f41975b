//! What one process has of a matrix in MUMPS, and how that is told what to do; not who asks for it.

use crate::calls::Instance;
use crate::options::Options;
use moreau_algebra::{Pattern, Share};
use std::ops::Range;

/// A pivot below this part of the scaled matrix is zero to rounding.
pub(crate) const SINGULAR: f64 = 1e-14;

/// Times that the working space is made larger where it was estimated too small.
const LARGER: usize = 6;

/// Errors of MUMPS: integer and real working space too small.
const SPACE: Range<i32> = -9..-7;

/// Controls of an instance, by their numbers in the manual of MUMPS 5.5.
fn prepare(instance: &mut Instance, sym: i32, options: Options) {
    // Nothing is printed.
    for (which, value) in [(1, -1), (2, -1), (3, -1), (4, 0)] {
        instance.set_integer(which, value);
    }
    // Entries by process, order as given or of METIS, analysed on the first process.
    let order = if options.metis { 5 } else { 1 };
    for (which, value) in [(18, 3), (7, order), (28, 1)] {
        instance.set_integer(which, value);
    }
    if sym == 2 {
        // Zero pivots are told and not divided by; the last front is not cut up, so that all signs are counted.
        instance.set_integer(24, 1);
        instance.set_integer(13, 1);
        instance.set_real(3, SINGULAR);
    }
    if let Some(spare) = options.spare {
        instance.set_integer(14, spare);
    }
    if let Some(error) = options.low_rank {
        instance.set_integer(35, 2);
        instance.set_real(7, error);
    }
}

/// What a process has of an engine.
#[derive(Debug)]
pub(crate) struct Part {
    /// None where nothing is to be eliminated, or there was no memory.
    pub(crate) instance: Option<Instance>,
    /// The first kept unknown.
    first: usize,
    /// By how much working space is larger than was estimated, in percent.
    spare: i32,
    /// How many times it is made larger still.
    larger: usize,
}

impl Part {
    /// Analyses the entries of a process, in an instance that all have.
    pub(crate) fn new(
        (size, kept, sym): (usize, usize, i32),
        options: Options,
        entries: impl Iterator<Item = (u32, u32)>,
    ) -> Self {
        let mut instance = match size > kept {
            true => Instance::new(sym),
            false => None,
        };
        if let Some(instance) = &mut instance {
            prepare(instance, sym, options);
            if kept > 0 {
                // S whole on the first process, by rows.
                instance.set_integer(19, 1);
            }
            instance.analyse(size, entries, kept, !options.metis);
        }
        Self {
            instance,
            first: size - kept,
            spare: options.spare.unwrap_or(20),
            larger: options.larger.unwrap_or(LARGER),
        }
    }

    /// Factorises, with more working space as long as there is too little: on all processes alike. S is written where the
    /// first process has room for it. False where the values are not as many as were analysed: other processes then wait
    /// for this one.
    pub(crate) fn factorise(&mut self, values: &[f64], mut schur: Option<&mut [f64]>) -> bool {
        let Some(instance) = &mut self.instance else {
            return true;
        };
        for times in 0..=self.larger {
            if !instance.factorise(values, schur.as_deref_mut()) {
                return false;
            }
            if !SPACE.contains(&instance.integer(1)) || times == self.larger {
                return true;
            }
            self.spare = 2 * self.spare.max(20);
            instance.set_integer(14, self.spare);
        }
        true
    }

    /// Entries in the rows of kept unknowns.
    pub(crate) fn coupling<'a>(
        &self,
        entries: impl Iterator<Item = (u32, u32)> + 'a,
        values: &'a [f64],
    ) -> impl Iterator<Item = (u32, u32, f64)> + 'a {
        let first = self.first;
        let all = entries.zip(values).map(|((i, j), k)| (i, j, *k));
        all.filter(move |&(i, _, k)| i as usize >= first && k != 0.0)
    }
}

/// Positions of the entries of a pattern.
pub(crate) fn places(pattern: &Pattern) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..pattern.size()).flat_map(|j| {
        let own = pattern.range(j).map(|k| pattern.rows()[k]);
        own.map(move |i| (i, j as u32))
    })
}

/// Positions of the entries of a share in the whole matrix, those of its own unknowns.
pub(crate) fn entries(share: Share<'_>) -> impl Iterator<Item = (u32, u32)> {
    let columns = (0..share.rows.len()).filter_map(move |j| Some((j, share.pattern?)));
    columns.flat_map(move |(j, pattern)| {
        let own = pattern.range(j).map(|k| pattern.rows()[k]);
        own.map(move |i| (share.rows[i as usize], share.rows[j]))
    })
}
