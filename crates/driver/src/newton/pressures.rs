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

    /// Adds what the skew part of the stiffness of pressures makes of a step v from displacement increments \[N\].
    pub(crate) fn add_turning_pressures(
        &self,
        pressures: &SparseVector,
        (d_u, v): (&[f64], &[f64]),
        forces: &mut [f64],
    ) {
        self.visit_pressed(pressures, d_u, &mut |pressed| {
            for (row, column, k) in turning::<D>(pressed) {
                forces[row] += k * v[column];
            }
        });
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

/// The symmetric part of −∂f/∂x times a factor, by degrees of freedom.
fn stiffening<const D: usize>(
    pressed: &Pressed,
    factor: f64,
) -> impl Iterator<Item = (usize, usize, f64)> {
    derivative::<D>(pressed, move |own, transposed| {
        -0.5 * factor * (own + transposed)
    })
}

/// The rest of −∂f/∂x. On the surface as a whole it belongs to its edge, and is of the size of the pressure: near a limit
/// of the load, where the symmetric part has hardly any stiffness, all the same as large as that.
fn turning<const D: usize>(pressed: &Pressed) -> impl Iterator<Item = (usize, usize, f64)> {
    derivative::<D>(pressed, |own, transposed| -0.5 * (own - transposed))
}

/// A matrix of the entries of ∂f/∂x and of its transpose, by degrees of freedom.
fn derivative<const D: usize>(
    pressed: &Pressed,
    entry: impl Fn(f64, f64) -> f64,
) -> impl Iterator<Item = (usize, usize, f64)> {
    let size = pressed.force.len();
    let dof = |k: usize| D * pressed.nodes[k / D] + k % D;
    let at = move |row: usize, column: usize| pressed.derivative[row * size + column];
    let of = move |(row, column): (usize, usize)| {
        let value = entry(at(row, column), at(column, row));
        (dof(row), dof(column), value)
    };
    let entries = (0..size * size).map(move |k| (k / size, k % size));
    entries.map(of)
}
