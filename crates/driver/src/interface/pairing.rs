//! Surfaces paired where the bodies are: what the contact points stand on; not gaps and slips.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::Contact;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::ContactPoint;
use moreau_mesh::Fold;
use nalgebra::SVector;
use std::collections::BTreeMap;

impl<const D: usize> Driver<D> {
    /// Whether surfaces are paired where the bodies are at the end of an increment.
    pub(crate) fn repairs(&self) -> bool {
        self.has_large_strains() && self.contacts.iter().any(|c| c.pairing.is_some())
    }

    /// Finds what the contact points stand on, at the committed positions, under the displacement
    /// conditions of a loading.
    pub(crate) fn pair(&mut self, loading: &Loading<D>) -> Result<(), ModelError> {
        let rest = vec![0.0; self.state.displacement.len()];
        self.footing.first.clear();
        self.footing.folds = self.folds()?;
        self.pair_at(loading, &rest)?;
        if self.repairs() {
            self.footing.first.clone_from(&self.footing.rows);
        }
        Ok(())
    }

    /// The same after displacement increments, in the increment that [`Driver::pair`] has begun.
    pub(crate) fn pair_at(&mut self, loading: &Loading<D>, d_u: &[f64]) -> Result<(), ModelError> {
        let on_tool = |p: &ContactPoint<D>| match p.tool {
            Some(tool) => RelativeMotionRow::on_tool(p, self.tool_node(tool)),
            None => RelativeMotionRow::default(),
        };
        let mut rows: Vec<RelativeMotionRow<D>> = self.points.iter().map(on_tool).collect();
        let mut redistributed = Vec::new();
        if self.contacts.iter().any(|c| c.pairing.is_some()) {
            let position = |a: usize| {
                let moved = SVector::from_column_slice(&d_u[D * a..D * a + D]);
                (self.position(a) + moved).into()
            };
            let positions: Vec<[f64; D]> = (0..self.mesh.nodes().len()).map(position).collect();
            for (k, contact) in self.contacts.iter().enumerate() {
                let Some(pairing) = contact.pairing else {
                    continue;
                };
                let surfaces = match self.footing.folds.get(&k) {
                    Some(Fold { non_mortar, mortar }) => (non_mortar.as_slice(), mortar.as_slice()),
                    None => (
                        self.mesh.facet_group(&contact.surface)?,
                        self.mesh.facet_group(&contact.opposite)?,
                    ),
                };
                let mortar_rows = self
                    .measure
                    .mortar_rows(&self.mesh, &positions, surfaces, pairing);
                let index = |p: &ContactPoint<D>| p.contact == k;
                let own = (0..self.points.len()).filter(|&i| index(&self.points[i]));
                let at: BTreeMap<usize, usize> = own.map(|i| (self.points[i].node, i)).collect();
                for mortar_row in mortar_rows {
                    if let Some(&point) = at.get(&mortar_row.node) {
                        rows[point] = RelativeMotionRow::on_surface(mortar_row, &positions);
                    }
                }
                let met = at.into_values().filter(|&i| rows[i].area > 0.0);
                let met: Vec<usize> = met.collect();
                self.redistribute_multipliers(&mut rows, (k, surfaces.0), loading);
                redistributed.extend(met.into_iter().filter(|&i| rows[i].area <= 0.0));
            }
            if self.repairs() {
                for (i, row) in rows.iter_mut().enumerate() {
                    row.settle(&positions);
                    if let Some(first) = self.footing.first.get(i) {
                        row.slide(first, &positions, d_u);
                    }
                }
            }
        }
        self.footing.rows = rows;
        self.footing.redistributed = redistributed;
        self.footing.at = d_u.to_vec();
        Ok(())
    }

    /// The two sides of the surfaces that may meet themselves, at the committed positions.
    fn folds(&self) -> Result<BTreeMap<usize, Fold>, ModelError> {
        let of_itself = |c: &Contact| c.pairing.is_some() && c.surface == c.opposite;
        let all = self.contacts.iter().enumerate();
        let mut folds = BTreeMap::new();
        for (k, contact) in all.filter(|(_, c)| of_itself(c)) {
            let nodes = 0..self.mesh.nodes().len();
            let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
            let surface = self.mesh.facet_group(&contact.surface)?;
            folds.insert(k, self.mesh.fold(&positions, surface));
        }
        Ok(folds)
    }
}
