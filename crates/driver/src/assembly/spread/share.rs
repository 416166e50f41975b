//! The stiffness that the cells of one process add up to, on the unknowns that they have; not who asks for it.

use crate::assembly::block::{Block, CellResult};
use crate::assembly::numbering::pattern_of;
use crate::assembly::scatter::{FIXED, Scatter, prescribed_columns};
use crate::assembly::spread::coarsened::Coarsened;
use crate::assembly::turned::Turned;
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use moreau_algebra::{Matrix, Share, Unpacked};

/// Entries of the cells of this process.
#[derive(Debug)]
pub(crate) struct Entries {
    /// Own number of a degree of freedom, or [`FIXED`].
    position: Vec<u32>,
    /// Unknown of the whole system of each own number, ascending.
    rows: Vec<u32>,
    directions: Directions,
    scatter: Vec<Scatter>,
    matrix: Matrix,
    /// Its part of a coarse space, where there is one.
    coarsened: Option<Coarsened>,
    missing: SparseVector,
    /// What the prescribed displacements that are missing do, at every degree of freedom of the mesh \[N\].
    prescribed_load: Vec<f64>,
}

impl Entries {
    /// Of the cells of some blocks, by the unknown of every degree of freedom and its direction.
    pub(crate) fn new<const D: usize>(
        blocks: &[Box<dyn Block<D>>],
        (unknown, directions): (&[u32], Directions),
    ) -> Self {
        let of = |b: &'_ dyn Block<D>| 0..b.cells().len();
        let groups: Vec<&[usize]> = blocks
            .iter()
            .flat_map(|b| of(b.as_ref()).map(|k| b.nodes(k)))
            .collect();
        let mut own = vec![false; unknown.len() / D];
        (groups.iter().copied().flatten()).for_each(|&a| own[a] = true);
        let dofs = (0..unknown.len()).filter(|&d| own[d / D] && unknown[d] != FIXED);
        let mut dofs: Vec<usize> = dofs.collect();
        dofs.sort_unstable_by_key(|&d| unknown[d]);
        let mut position = vec![FIXED; unknown.len()];
        for (own, &dof) in dofs.iter().enumerate() {
            position[dof] = own as u32;
        }
        let pattern = pattern_of::<D>(&position, &dofs, 0, &groups);
        let scatter = blocks.iter();
        Self {
            rows: dofs.iter().map(|&dof| unknown[dof]).collect(),
            scatter: scatter
                .map(|b| Scatter::new(b.as_ref(), &position, &pattern))
                .collect(),
            position,
            directions,
            matrix: Matrix::new(pattern),
            coarsened: None,
            missing: SparseVector::default(),
            prescribed_load: Vec::new(),
        }
    }

    /// Unknowns of the whole system.
    pub(crate) fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Begins a new sum.
    pub(crate) fn reset(&mut self, stiffness: bool, missing: SparseVector) {
        if stiffness {
            self.matrix.reset();
        }
        let load = if missing.is_zero() {
            0
        } else {
            self.position.len()
        };
        self.prescribed_load.clear();
        self.prescribed_load.resize(load, 0.0);
        self.missing = missing;
    }

    /// Adds a cell of a block.
    pub(crate) fn add<const D: usize>(&mut self, block: usize, cell: CellResult<'_>) {
        let (pattern, values) = self.matrix.values_mut();
        let mut turned = Turned::of(&self.directions);
        let cell = &turned.cell::<D>(cell);
        self.scatter[block].add::<D>(cell, &self.position, pattern, values);
        if !self.prescribed_load.is_empty() {
            let (load, missing) = (&mut self.prescribed_load, &self.missing);
            prescribed_columns::<D>(cell, &self.position, &mut |unknown, prescribed, k| {
                load[unknown] += k * missing.at(prescribed);
            });
        }
    }

    /// K times the prescribed displacements that are missing, at own numbers \[N\].
    pub(crate) fn prescribed(&self, dofs: usize) -> Vec<f64> {
        let mut load = vec![0.0; self.rows.len()];
        for (dof, f) in self.prescribed_load.iter().enumerate().take(dofs) {
            if self.position[dof] != FIXED {
                load[self.position[dof] as usize] = *f;
            }
        }
        load
    }

    /// K u at own numbers.
    pub(crate) fn product(&self, u: &[f64]) -> Vec<f64> {
        let mut r = vec![0.0; self.rows.len()];
        if u.len() == r.len() {
            self.matrix.subtract_product(u, &mut r);
        }
        r.iter_mut().for_each(|r| *r = -*r);
        r
    }

    /// The diagonal of K at own numbers.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        (0..self.rows.len())
            .map(|i| self.matrix.diagonal(i))
            .collect()
    }

    /// As a part of the whole matrix that is factorised: that of the coarse space, where there is one.
    pub(crate) fn share(&self) -> Share<'_> {
        let own = Share {
            pattern: Some(&self.matrix.pattern),
            values: self.matrix.values(),
            rows: &self.rows,
        };
        self.coarsened.as_ref().map_or(own, Coarsened::share)
    }

    /// A coarse space takes the place of the unknowns; what goes to the first process is told.
    pub(crate) fn coarsen(&mut self, order: &mut Unpacked<'_>) -> Vec<u32> {
        self.coarsened = match order.count() {
            1 => Coarsened::new(&self.matrix, order),
            _ => None,
        };
        let places = |c: &Coarsened| c.places(&self.matrix, &self.rows);
        self.coarsened.as_ref().map_or(Vec::new(), places)
    }

    /// Entries that go to the first process.
    pub(crate) fn hand_over(&mut self) -> Vec<f64> {
        let Self {
            coarsened, matrix, ..
        } = self;
        let coarsened = coarsened.as_ref();
        coarsened.map_or(Vec::new(), |c| c.hand_over(matrix))
    }

    /// The coarse space is that of the entries as they are now.
    pub(crate) fn project(&mut self) {
        if let Some(coarsened) = &mut self.coarsened {
            // Both are of this process: they fit.
            let _ = coarsened.project(&self.matrix);
        }
    }

    /// Own numbers of the unknowns before one of the whole system.
    fn before(&self, row: usize) -> usize {
        self.rows.partition_point(|&own| (own as usize) < row)
    }

    /// A sweep down: what the unknowns do that this process has alone, and what that leaves at all of its own.
    pub(crate) fn sweep_down(&self, rows: usize, load: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let coarsened = self.coarsened.as_ref();
        coarsened.map_or((Vec::new(), Vec::new()), |c| {
            c.sweep_down(&self.matrix, self.before(rows), load)
        })
    }

    /// The sweep back.
    pub(crate) fn sweep_up(&self, rows: usize, load: &[f64], x: Vec<f64>) -> Vec<f64> {
        let coarsened = self.coarsened.as_ref();
        coarsened.map_or(Vec::new(), |c| {
            c.sweep_up(&self.matrix, self.before(rows), load, x)
        })
    }
}
