//! Pressures that follow their surface, beside the internal forces; not the integral over a facet.

use crate::assembly::cell_law::{Motion, Stiffness};
use crate::driver::Driver;
use crate::linear::system::{Assembly, System};
use crate::model::load::Loading;
use crate::vector::SparseVector;
use moreau_mesh::Pressed;
use nalgebra::SVector;

impl<const D: usize> Driver<D> {
    /// [`System::assemble`] under displacement increments, and the pressures and temperatures of a loading.
    pub(crate) fn assemble(
        &mut self,
        system: &mut System,
        loading: &Loading<D>,
        (d_u, missing): (&[f64], &SparseVector),
        stiffness: Stiffness,
    ) -> Assembly {
        let free = self.free_strains(loading);
        let motion = Motion {
            from: &self.state.displacement,
            by: d_u,
            free: &free,
        };
        let mut assembly = system.assemble(&mut self.blocks, motion, missing, stiffness);
        assembly.free = free;
        let part = match stiffness {
            Stiffness::None => 0.0,
            Stiffness::Total(part) | Stiffness::Plastic(part) => part,
        };
        self.visit_pressed(&loading.pressure, d_u, &mut |pressed| {
            for (dof, force) in forces::<D>(pressed) {
                assembly.internal[dof] -= force;
                assembly.pressed = assembly.pressed.max(force.abs());
            }
            if part > 0.0 {
                system.add(stiffening::<D>(pressed, part));
            }
        });
        assembly
    }

    /// Forces of the pressures of a loading on the surface as it is after displacement increments \[N\].
    pub(crate) fn pressure_force(&self, loading: &Loading<D>, d_u: &[f64]) -> SparseVector {
        let mut sum = SparseVector::default();
        self.visit_pressed(&loading.pressure, d_u, &mut |pressed| {
            forces::<D>(pressed).for_each(|(dof, force)| sum.add(dof, force));
        });
        sum
    }

    /// Visits the facets under pressures after displacement increments.
    fn visit_pressed(
        &self,
        pressures: &SparseVector,
        d_u: &[f64],
        visit: &mut dyn FnMut(&Pressed),
    ) {
        let moved = |node: usize| SVector::from_column_slice(&d_u[D * node..D * node + D]);
        let position = |node: usize| (self.position(node) + moved(node)).into();
        self.measure.press(&self.mesh, pressures, &position, visit);
    }
}

/// The forces on a facet by their degrees of freedom.
fn forces<const D: usize>(pressed: &Pressed) -> impl Iterator<Item = (usize, f64)> {
    let of = |(k, force): (usize, &f64)| (D * pressed.nodes[k / D] + k % D, *force);
    pressed.force.iter().enumerate().map(of)
}

/// The symmetric part of −∂f/∂x times a factor, by degrees of freedom. What it leaves out belongs to the edge
/// of the surface, is of the size of the pressure and not of the stiffness, and hardly slows Newton down.
fn stiffening<const D: usize>(
    pressed: &Pressed,
    factor: f64,
) -> impl Iterator<Item = (usize, usize, f64)> {
    let size = pressed.force.len();
    let dof = |k: usize| D * pressed.nodes[k / D] + k % D;
    let of = move |(row, column): (usize, usize)| {
        let at = |row: usize, column: usize| pressed.derivative[row * size + column];
        let entry = -0.5 * factor * (at(row, column) + at(column, row));
        (dof(row), dof(column), entry)
    };
    let entries = (0..size).flat_map(move |row| (0..size).map(move |column| (row, column)));
    entries.map(of)
}
