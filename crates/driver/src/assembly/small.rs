//! Cells under small strains: the law sees what the operators B make of the increments; not how cells are
//! put together.

use crate::assembly::cell_law::{CellLaw, CellOutput, Motion, Stiffness};
use crate::assembly::cells::{Cells, MAX_POINTS};
use moreau_laws::{BulkLaw, FlowPower};
use moreau_mandel::{Sym2, Sym4};
use nalgebra::Matrix3;

/// What the points of a cell hand from the law to the forces and the stiffness. Of 27 points it is 10 kB: cleared for
/// every cell, it would cost as much as the elastic law.
pub struct Points {
    strains: [Sym2; MAX_POINTS],
    stresses: [Sym2; MAX_POINTS],
    tangents: [Sym4; MAX_POINTS],
}

impl Default for Points {
    fn default() -> Self {
        Self {
            strains: [Sym2::zeros(); MAX_POINTS],
            stresses: [Sym2::zeros(); MAX_POINTS],
            tangents: [Sym4::zeros(); MAX_POINTS],
        }
    }
}

/// A law under small strains and rotations.
#[derive(Debug, Clone)]
pub struct Small<L>(pub L);

impl<L: BulkLaw, const D: usize> CellLaw<D> for Small<L> {
    type Law = L;
    type State = L::State;
    type Room = Points;

    fn law(&self) -> &L {
        &self.0
    }

    fn start(material: L::State) -> L::State {
        material
    }

    fn material(state: &L::State) -> &L::State {
        state
    }

    fn respond(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[L::State],
        motion: Motion<'_>,
        kind: Stiffness,
        out: CellOutput<'_, L::State>,
        room: &mut Points,
    ) -> bool {
        let (law, count) = (&self.0, old.len());
        let elastic = law.elastic_tangent();
        let strains = &mut room.strains[..count];
        let (stresses, tangents) = (&mut room.stresses[..count], &mut room.tangents[..count]);
        cells.strain(k, motion.by, strains);
        motion.relieve((cells, k), strains);
        let mut flows = false;
        for g in 0..count {
            let response = law.respond(&old[g], &strains[g]);
            flows |= response.flows;
            out.new[g] = response.state;
            stresses[g] = response.stress;
            tangents[g] = match kind {
                Stiffness::None => continue,
                Stiffness::Total(0.0) => elastic,
                Stiffness::Total(part) => elastic + (response.tangent - elastic) * part,
                Stiffness::Plastic(part) => (response.tangent - elastic) * part,
            };
        }
        cells.force(k, stresses, out.force);
        if kind.is_given(flows) {
            cells.stiffness(k, tangents, out.stiffness);
        }
        flows
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric()
    }

    fn keeps_elastic_stiffness(&self) -> bool {
        true
    }

    fn lacking(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[L::State],
        motion: Motion<'_>,
        v: &[f64],
        force: &mut [f64],
    ) {
        let count = old.len();
        let mut d_eps = [Sym2::zeros(); MAX_POINTS];
        let mut rate = [Sym2::zeros(); MAX_POINTS];
        cells.strain(k, motion.by, &mut d_eps[..count]);
        motion.relieve((cells, k), &mut d_eps[..count]);
        cells.strain(k, v, &mut rate[..count]);
        for (g, rate) in rate[..count].iter_mut().enumerate() {
            *rate = self.0.lacking(&old[g], &d_eps[g]) * *rate;
        }
        cells.force(k, &rate[..count], force);
    }

    fn potential(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[L::State],
        motion: Motion<'_>,
    ) -> Option<f64> {
        let mut d_eps = [Sym2::zeros(); MAX_POINTS];
        cells.strain(k, motion.by, &mut d_eps[..old.len()]);
        motion.relieve((cells, k), &mut d_eps[..old.len()]);
        let mut sum = 0.0;
        for (g, (old, d_eps)) in old.iter().zip(&d_eps).enumerate() {
            // ΔV leaves out the linear part σ₀·Δε, [48]: it is what equilibrium held before.
            let linear = self.0.stress(old).dot(d_eps);
            sum += cells.weight(k * cells.points_per_cell() + g)
                * (self.0.potential(old, d_eps)? + linear);
        }
        Some(sum)
    }

    fn flow_power(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        old: &[L::State],
        v: &[f64],
    ) -> Option<FlowPower> {
        let mut rates = [Sym2::zeros(); MAX_POINTS];
        cells.strain(k, v, &mut rates[..old.len()]);
        let mut sum = FlowPower::default();
        for (g, (old, rate)) in old.iter().zip(&rates).enumerate() {
            let weight = cells.weight(k * cells.points_per_cell() + g);
            sum = sum.with(weight, self.0.flow_power(old, rate)?);
        }
        Some(sum)
    }

    fn stress(&self, state: &L::State) -> Sym2 {
        self.0.stress(state)
    }

    fn frame(_: &L::State) -> Option<Matrix3<f64>> {
        None
    }
}
