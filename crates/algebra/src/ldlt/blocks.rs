//! The columns of L and D that fronts leave, and solves with them; not how they are found.

use pulp::Arch;

use super::front::{Front, inverse};
use crate::panel::{Backward, Forward, Panel};

/// Columns of L with the same rows, and their part of D.
#[derive(Debug)]
struct Block {
    /// Where its unknowns begin: those of its columns, then those of the rows below.
    index: usize,
    width: usize,
    height: usize,
    /// Where its values begin.
    values: usize,
    /// Where its pivots begin.
    pivots: usize,
}

/// L and D, column by column in the order of elimination.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    blocks: Vec<Block>,
    index: Vec<u32>,
    values: Vec<f64>,
    /// Diagonal of D, and what is below it.
    pivots: Vec<[f64; 2]>,
    /// Unknowns of a block, and the rows below them, of all right-hand sides at once.
    own: Vec<f64>,
    below: Vec<f64>,
}

impl Blocks {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.index.clear();
        self.values.clear();
        self.pivots.clear();
    }

    /// Entries stored.
    pub(super) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Takes up what was eliminated in a front; `None` where there is no room.
    pub(super) fn push(&mut self, front: &Front) -> Option<()> {
        let (width, height) = (front.pivots.len(), front.size());
        if width == 0 {
            return Some(());
        }
        self.blocks.push(Block {
            index: self.index.len(),
            width,
            height,
            values: self.values.len(),
            pivots: self.pivots.len(),
        });
        self.index.extend_from_slice(&front.index);
        self.pivots.extend_from_slice(&front.pivots);
        let values = &front.entries[..width * height];
        self.values.try_reserve(values.len()).ok()?;
        self.values.extend_from_slice(values);
        Some(())
    }

    fn unknowns(&self, block: &Block) -> (&[u32], &[u32]) {
        self.index[block.index..block.index + block.height].split_at(block.width)
    }

    fn panel(&self, block: &Block) -> Panel<'_> {
        Panel {
            values: &self.values[block.values..][..block.width * block.height],
            stored: block.height,
            first: 0,
            width: block.width,
            rows: block.height - block.width,
            unit: true,
        }
    }

    /// x ← L⁻¹ x, of columns of so many unknowns.
    pub(super) fn forward(&mut self, x: &mut [f64], size: usize, arch: Arch) {
        let mut own = std::mem::take(&mut self.own);
        let mut below = std::mem::take(&mut self.below);
        for block in &self.blocks {
            let (columns, rows) = self.unknowns(block);
            gather(x, size, columns, &mut own);
            below.resize(rows.len() * (x.len() / size), 0.0);
            arch.dispatch(Forward {
                panel: self.panel(block),
                own: &mut own,
                below: &mut below,
            });
            scatter(&own, columns, x, size);
            if !rows.is_empty() {
                for (x, sums) in x.chunks_exact_mut(size).zip(below.chunks_exact(rows.len())) {
                    for (&i, sum) in rows.iter().zip(sums) {
                        x[i as usize] -= sum;
                    }
                }
            }
        }
        (self.own, self.below) = (own, below);
    }

    /// x ← D⁻¹ x.
    pub(super) fn divide(&self, x: &mut [f64], size: usize) {
        for block in &self.blocks {
            let (columns, _) = self.unknowns(block);
            let pivots = &self.pivots[block.pivots..][..block.width];
            for x in x.chunks_exact_mut(size) {
                let mut k = 0;
                while k < columns.len() {
                    let [a, b] = pivots[k];
                    let i = columns[k] as usize;
                    if b == 0.0 {
                        x[i] /= a;
                        k += 1;
                        continue;
                    }
                    let j = columns[k + 1] as usize;
                    let [p, q, r] = inverse(a, b, pivots[k + 1][0]);
                    (x[i], x[j]) = (p * x[i] + q * x[j], q * x[i] + r * x[j]);
                    k += 2;
                }
            }
        }
    }

    /// x ← L⁻ᵀ x.
    pub(super) fn backward(&mut self, x: &mut [f64], size: usize, arch: Arch) {
        let mut own = std::mem::take(&mut self.own);
        let mut below = std::mem::take(&mut self.below);
        for block in self.blocks.iter().rev() {
            let (columns, rows) = self.unknowns(block);
            gather(x, size, columns, &mut own);
            gather(x, size, rows, &mut below);
            arch.dispatch(Backward {
                panel: self.panel(block),
                own: &mut own,
                below: &below,
            });
            scatter(&own, columns, x, size);
        }
        (self.own, self.below) = (own, below);
    }
}

/// Some rows of every column of x, column by column.
fn gather(x: &[f64], size: usize, rows: &[u32], to: &mut Vec<f64>) {
    to.clear();
    for x in x.chunks_exact(size) {
        to.extend(rows.iter().map(|&i| x[i as usize]));
    }
}

/// And back.
fn scatter(own: &[f64], rows: &[u32], x: &mut [f64], size: usize) {
    for (x, own) in x.chunks_exact_mut(size).zip(own.chunks_exact(rows.len())) {
        for (&i, v) in rows.iter().zip(own) {
            x[i as usize] = *v;
        }
    }
}
