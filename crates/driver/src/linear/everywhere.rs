//! K as conjugate gradients see it, wherever its entries are; not the iteration.

use crate::linear::others::Others;
use moreau_algebra::{Matrix, Operator};

/// The entries of this process, and what others hold.
///
/// A sweep is that of Gauss and Seidel in an order of its own: unknowns that one other process has alone, of all of them
/// at the same time, since no cell couples two such; then those that are left, here. So it is the same as on one process
/// but for the order.
pub(crate) struct Everywhere<'a> {
    pub(crate) matrix: &'a Matrix,
    pub(crate) others: Option<&'a Others>,
}

impl Operator for Everywhere<'_> {
    fn size(&self) -> usize {
        self.matrix.pattern.size()
    }

    fn subtract_product(&self, x: &[f64], r: &mut [f64]) {
        self.matrix.subtract_product(x, r);
        if let Some(others) = self.others {
            others.subtract_product(x, r);
        }
    }

    fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]) {
        let Some(others) = self.others else {
            return self.matrix.sweep_down(b, |row| row < rows, x, left);
        };
        let mut given = b.to_vec();
        let mut moved = vec![0.0; b.len()];
        others.sweep_down(b, rows, &mut moved, &mut given);
        let here = |row: usize| row < rows && others.is_here(row);
        self.matrix.sweep_down(&given, here, x, left);
        // What moved here acts on the others.
        others.subtract_product(x, left);
        for (row, moved) in moved.iter().enumerate() {
            if !others.is_here(row) {
                x[row] = *moved;
            }
        }
    }

    fn sweep_up(&self, b: &mut [f64], rows: usize, x: &mut [f64]) {
        let Some(others) = self.others else {
            return self.matrix.sweep_up(b, |row| row < rows, x);
        };
        let mut there = x.to_vec();
        let own = there.iter_mut().enumerate();
        own.for_each(|(row, u)| {
            if others.is_here(row) {
                *u = 0.0;
            }
        });
        let mut given = b.to_vec();
        others.subtract_product(&there, &mut given);
        let here = |row: usize| row < rows && others.is_here(row);
        self.matrix.sweep_up(&mut given, here, x);
        others.sweep_up(b, rows, x);
    }
}
