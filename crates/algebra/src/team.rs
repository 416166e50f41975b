//! Processes that hold one matrix together: what they tell each other, and who factorises it; no transport.

use std::fmt;
use std::sync::Arc;

use crate::engine::{Engine, TooLarge};
use crate::pattern::Pattern;

/// What a process holds of a matrix: entries of the lower triangle of some of its rows and columns. The matrix is
/// the sum over all processes.
#[derive(Debug, Clone, Copy)]
pub struct Share<'a> {
    /// Where its entries are, by numbers of its own; `None` of a process that holds nothing.
    pub pattern: Option<&'a Pattern>,
    /// Their values.
    pub values: &'a [f64],
    /// Row of the whole matrix of each own number, ascending.
    pub rows: &'a [u32],
}

impl Share<'_> {
    /// Of a process that holds nothing.
    pub const NONE: Self = Self {
        pattern: None,
        values: &[],
        rows: &[],
    };
}

/// Processes that do the same work together: one, of rank 0, leads, and the others do as they are told.
///
/// The one that leads sends an order to all others, by [`order`](Self::order); what follows is between the two ends
/// of each order. Those that begin with [`ENGINE`] are of the engine that the team has, and are passed to
/// [`assist`](Self::assist).
pub trait Team: fmt::Debug + Send + Sync {
    /// Number of this process, from 0.
    fn rank(&self) -> usize;

    /// Number of processes.
    fn size(&self) -> usize;

    /// Sends bytes to a process. There is no answer to a process that has gone: whoever carries the bytes then ends
    /// all of them.
    fn send(&self, to: usize, bytes: &[u8]);

    /// Waits for bytes from a process, as many as it has sent at once.
    fn receive(&self, from: usize) -> Vec<u8>;

    /// Analyses a matrix of which this process, the first, holds `pattern`, with all of its rows, and the others
    /// what they pass to [`assist`](Self::assist). Values that are factorised are those of this process, and those
    /// that the others hold by then. Whether it is positive definite decides on the factor.
    ///
    /// # Errors
    /// [`TooLarge`] where its factor takes more than `memory` \[bytes\] on a computer.
    fn engine(
        &self,
        pattern: &Pattern,
        memory: Option<u64>,
        is_definite: bool,
    ) -> Result<Box<dyn Engine>, TooLarge>;

    /// Does the part of another process than the first in an order that began with [`ENGINE`].
    fn assist(&self, order: &[u8], share: Share<'_>);

    /// Sends bytes to all processes but the first.
    fn order(&self, bytes: &[u8]) {
        (1..self.size()).for_each(|to| self.send(to, bytes));
    }
}

/// First byte of the orders of an engine.
pub const ENGINE: u8 = 255;

/// A team that several own.
pub type SharedTeam = Arc<dyn Team>;

/// Numbers on their way to another process, written one after the other.
#[derive(Debug, Clone, Default)]
pub struct Parcel(Vec<u8>);

impl Parcel {
    /// An order, by its first byte.
    pub fn order(kind: u8) -> Self {
        Self(vec![kind])
    }

    /// With a count.
    #[must_use]
    pub fn count(mut self, n: usize) -> Self {
        self.0.extend((n as u64).to_le_bytes());
        self
    }

    /// With real numbers, and how many they are.
    #[must_use]
    pub fn reals(mut self, all: &[f64]) -> Self {
        self = self.count(all.len());
        self.0.reserve_exact(8 * all.len());
        all.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
        self
    }

    /// With indices, and how many they are.
    #[must_use]
    pub fn indices(mut self, all: &[u32]) -> Self {
        self = self.count(all.len());
        self.0.reserve_exact(4 * all.len());
        all.iter().for_each(|i| self.0.extend(i.to_le_bytes()));
        self
    }

    /// With text.
    #[must_use]
    pub fn text(mut self, text: &str) -> Self {
        self = self.count(text.len());
        self.0.extend(text.as_bytes());
        self
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// A parcel as it is unpacked, in the order in which it was packed; beyond its end there is nothing.
#[derive(Debug, Clone, Copy)]
pub struct Unpacked<'a>(&'a [u8]);

impl<'a> Unpacked<'a> {
    /// Of bytes without the first, which is the kind of an order.
    pub fn order(bytes: &'a [u8]) -> (u8, Self) {
        match bytes.split_first() {
            Some((&kind, rest)) => (kind, Self(rest)),
            None => (0, Self(bytes)),
        }
    }

    /// Of bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    fn take(&mut self, bytes: usize) -> &'a [u8] {
        let (own, rest) = self.0.split_at(bytes.min(self.0.len()));
        self.0 = rest;
        own
    }

    /// A count.
    pub fn count(&mut self) -> usize {
        let word = self.take(8).try_into().unwrap_or_default();
        u64::from_le_bytes(word) as usize
    }

    /// Real numbers.
    pub fn reals(&mut self) -> Vec<f64> {
        let count = self.count();
        let words = self.take(count.saturating_mul(8)).chunks_exact(8);
        let real = |word: &[u8]| f64::from_le_bytes(word.try_into().unwrap_or_default());
        words.map(real).collect()
    }

    /// Indices.
    pub fn indices(&mut self) -> Vec<u32> {
        let count = self.count();
        let words = self.take(count.saturating_mul(4)).chunks_exact(4);
        let index = |word: &[u8]| u32::from_le_bytes(word.try_into().unwrap_or_default());
        words.map(index).collect()
    }

    /// Text.
    pub fn text(&mut self) -> String {
        let count = self.count();
        String::from_utf8_lossy(self.take(count)).into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_is_unpacked_and_nothing_more() {
        let parcel = Parcel::order(7).count(3).reals(&[1.5, -2.0]).indices(&[9]);
        let parcel = parcel.text("é");
        let (kind, mut unpacked) = Unpacked::order(parcel.bytes());
        assert_eq!((kind, unpacked.count()), (7, 3));
        assert_eq!(unpacked.reals(), [1.5, -2.0]);
        assert_eq!(unpacked.indices(), [9]);
        assert_eq!(unpacked.text(), "é");
        assert_eq!((unpacked.count(), unpacked.reals()), (0, Vec::new()));
        let mut torn = Unpacked::new(&parcel.bytes()[9..20]);
        assert_eq!(torn.reals(), [0.0; 0]);
        assert_eq!(Unpacked::order(&[]).0, 0);
    }
}
