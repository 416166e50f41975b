//! Stiffness and internal forces of a system, added up cell by cell; not what is done with them.

use super::System;
use crate::assembly::block::{Block, points_of};
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::assembly::scatter::{FIXED, prescribed_columns};
use crate::assembly::turned::Turned;
use crate::timings::Clock;
use crate::vector::SparseVector;
use crate::vector::prescribed::{Prescribed, residual};

/// Internal forces of an assembly.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assembly {
    /// ∫ Bᵀσ dΩ at every degree of freedom, less the forces of pressures that follow their surface \[N\].
    pub(crate) internal: Vec<f64>,
    /// The largest of those \[N\].
    pub(crate) pressed: f64,
    /// Free strains of all points under which they are: [`Motion::free`].
    pub(crate) free: Vec<f64>,
    /// K times the prescribed displacements that are still missing \[N\]; empty if none are.
    pub(crate) prescribed_load: Vec<f64>,
    /// Whether plastic strain grows anywhere.
    pub(crate) flows: bool,
    /// Whether the system has the stiffness that belongs to these forces.
    pub(crate) stiffness: bool,
}

impl Assembly {
    /// The load of a Newton step under forces, at every degree of freedom \[N\].
    pub(crate) fn load(&self, forces: &[&SparseVector]) -> Vec<f64> {
        let mut load = residual(&self.internal, forces, &Prescribed::default());
        let pairs = load.iter_mut().zip(&self.prescribed_load);
        pairs.for_each(|(f, prescribed)| *f -= prescribed);
        load
    }
}

impl System {
    /// Internal forces at the end of a motion, and the stiffness if asked for.
    /// `missing` are the prescribed increments still to come, along the axes as all vectors are that are given or
    /// returned.
    pub(crate) fn assemble<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        mut motion: Motion<'_>,
        missing: &SparseVector,
        stiffness: Stiffness,
    ) -> Assembly {
        let clock = Clock::start();
        let stiffness = match stiffness {
            Stiffness::Plastic(part) if !self.keeps_elastic => Stiffness::Total(part),
            other => other,
        };
        let mut internal = vec![0.0; motion.by.len()];
        let mut flows = false;
        let with_stiffness = stiffness != Stiffness::None;
        if with_stiffness {
            self.matrix.reset();
        }
        let mut prescribed_load = Vec::new();
        let directions = &self.prescribed.directions;
        let missing = directions.components(missing);
        let missing = (!missing.is_zero()).then_some(&*missing);
        let mut turned = Turned::of(directions);
        if let Some(missing) = missing {
            prescribed_load.resize(motion.by.len(), 0.0);
            for &(unknown, prescribed, k) in &self.prescribed_columns {
                prescribed_load[unknown] += k * missing.at(prescribed);
            }
        }
        if let Some(others) = &mut self.others {
            others.reset(with_stiffness, missing);
        }
        let position = &self.position;
        let (pattern, values) = self.matrix.values_mut();
        for (block, scatter) in blocks.iter_mut().zip(&self.scatter) {
            let own = motion.split_off(points_of(block.as_ref()));
            flows |= block.evaluate(own, stiffness, &mut |cell| {
                for (&a, force) in cell.nodes.iter().zip(cell.force.chunks_exact(D)) {
                    let at = internal[D * a..D * a + D].iter_mut();
                    at.zip(force).for_each(|(sum, f)| *sum += f);
                }
                let cell = turned.cell::<D>(cell);
                scatter.add::<D>(&cell, position, pattern, values);
                if let Some(missing) = missing {
                    prescribed_columns::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        prescribed_load[unknown] += k * missing.at(prescribed);
                    });
                }
            });
        }
        if let (Some(others), true) = (&self.others, with_stiffness) {
            others.take_over(self.matrix.values_mut().1);
        }
        if let (Some(others), Some(_)) = (&self.others, missing) {
            others.add_prescribed(&self.dofs, &mut prescribed_load);
        }
        directions.restore(&mut prescribed_load);
        if with_stiffness {
            self.current = self.elastic_factor && !flows;
            let size = self.size();
            let tied = self.others.as_mut().filter(|_| self.tied.is_some());
            tied.into_iter()
                .for_each(|others| others.find_diagonal(size));
        }
        self.timings.assembly += clock.elapsed();
        Assembly {
            internal,
            pressed: 0.0,
            free: Vec::new(),
            prescribed_load,
            flows,
            stiffness: with_stiffness,
        }
    }

    /// Assembles the elastic stiffness, to which flow only adds, learns its size, and chooses σ: its
    /// largest diagonal on the interface, or zero if the bodies must be held without it.
    pub(crate) fn assemble_elastic<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        from: &[f64],
        shifted: bool,
    ) {
        let clock = Clock::start();
        let by = vec![0.0; from.len()];
        let keeps = self.keeps_elastic;
        if let Some(others) = &mut self.others {
            others.reset(true, None);
        }
        let (position, all) = (&self.position, &mut self.prescribed_columns);
        let mut turned = Turned::of(&self.prescribed.directions);
        let (pattern, values) = self.matrix.values_mut();
        for (block, scatter) in blocks.iter_mut().zip(&self.scatter) {
            block.evaluate(Motion::new(from, &by), Stiffness::Total(0.0), &mut |cell| {
                let cell = turned.cell::<D>(cell);
                scatter.add::<D>(&cell, position, pattern, values);
                if keeps {
                    prescribed_columns::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        all.push((unknown, prescribed, k));
                    });
                }
            });
        }
        if keeps {
            self.matrix.keep();
        }
        let first = self.size() - self.interface;
        if let Some(others) = &mut self.others {
            others.take_over(self.matrix.values_mut().1);
            others.find_diagonal(self.dofs.len());
        }
        let own = |p: usize| self.diagonal(p as u32);
        let stiffest = (0..self.size()).map(own).fold(0.0, f64::max);
        self.stiffest = stiffest;
        let diagonal = |p: usize| self.diagonal(p as u32);
        self.shift = match (shifted, &self.tied) {
            (false, _) => 0.0,
            (true, Some(_)) => self.stiffest,
            (true, None) => (first..self.size()).map(diagonal).fold(0.0, f64::max),
        };
        self.timings.assembly += clock.elapsed();
    }

    /// Adds entries (row, column) of a symmetric stiffness at degrees of freedom to K, those of its lower triangle
    /// and of unknowns that a cell or a contact couples.
    pub(crate) fn add(&mut self, entries: impl Iterator<Item = (usize, usize, f64)>) {
        let (pattern, values) = self.matrix.values_mut();
        let directions = &self.prescribed.directions;
        for (row, column, k) in entries {
            for (row, part) in directions.parts(row) {
                for (column, other) in directions.parts(column) {
                    let (row, column) = (self.position[row], self.position[column]);
                    if row < column || row == FIXED || column == FIXED {
                        continue;
                    }
                    if let Some(slot) = pattern.slot(row, column) {
                        values[slot as usize] += part * other * k;
                    }
                }
            }
        }
    }
}
