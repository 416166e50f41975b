//! Pressures on surfaces that move: forces, and how these change with positions; not what moves them.

use super::{Facet, Mesh};
use crate::Hypothesis;
use crate::sample::facet_samples;
use std::collections::BTreeMap;

/// A facet under pressure: forces on its nodes, and their derivatives.
#[derive(Debug, Clone, Default)]
pub struct Pressed {
    /// The nodes.
    pub nodes: Vec<usize>,
    /// f_a = −p ∫ N_a n dS, node by node, coordinate by coordinate \[N\].
    pub force: Vec<f64>,
    /// ∂f/∂x, row by row \[N/mm\]. It is not symmetric: over a surface, what is not belongs to its edge, and
    /// vanishes where that is held, or on another surface under the same pressure.
    pub derivative: Vec<f64>,
}

impl<const D: usize> Mesh<D> {
    /// Visits the facets under pressures \[MPa\], positive towards the body, with the nodes at other positions
    /// \[mm\] than those of the mesh: of the area and the normal that the surface has there.
    pub fn press<H: Hypothesis<D>>(
        &self,
        pressures: impl Iterator<Item = (Facet, f64)>,
        position: &dyn Fn(usize) -> [f64; D],
        hypothesis: &H,
        visit: &mut dyn FnMut(&Pressed),
    ) {
        let mut samples = BTreeMap::new();
        let mut pressed = Pressed::default();
        let mut positions = Vec::new();
        for (facet, pressure) in pressures {
            let kind = self.facet_kind(facet);
            let samples = samples.entry(kind).or_insert_with(|| facet_samples(kind));
            pressed.nodes.clear();
            pressed.nodes.extend(self.facet_nodes(facet));
            positions.clear();
            positions.extend(pressed.nodes.iter().map(|&node| position(node)));
            let size = D * positions.len();
            pressed.force.clear();
            pressed.force.resize(size, 0.0);
            pressed.derivative.clear();
            pressed.derivative.resize(size * size, 0.0);
            for sample in samples {
                let vector = sample.area_vector(&positions);
                let measure = hypothesis.measure(&sample.position(&positions));
                let widens = hypothesis.measure_gradient();
                let factor = |a: usize| -pressure * sample.weight * sample.shape[a];
                for (row, force) in pressed.force.iter_mut().enumerate() {
                    *force += factor(row / D) * measure * vector[row % D];
                }
                for b in 0..positions.len() {
                    let by = sample.area_vector_by(&positions, b);
                    for (row, j) in (0..size).flat_map(|row| (0..D).map(move |j| (row, j))) {
                        let (a, i) = (row / D, row % D);
                        let turns = measure * by[j][i];
                        let grows = sample.shape[b] * widens[j] * vector[i];
                        pressed.derivative[row * size + D * b + j] += factor(a) * (turns + grows);
                    }
                }
            }
            visit(&pressed);
        }
    }
}
