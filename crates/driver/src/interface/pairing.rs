//! Surfaces paired where the bodies are: what the contact points stand on; not gaps and slips.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::contact::Contact;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::ContactPoint;
use moreau_mesh::{Facet, Fold};
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
        self.turn_ties()?;
        self.pair_at(loading, &rest)?;
        if self.repairs() {
            self.footing.first.clone_from(&self.footing.rows);
        }
        Ok(())
    }

    /// The same after displacement increments, in the increment that [`Driver::pair`] has begun.
    pub(crate) fn pair_at(&mut self, loading: &Loading<D>, d_u: &[f64]) -> Result<(), ModelError> {
        let on_tool = |p: &ContactPoint<D>| match p.tool {
            Some(tool) => RelativeMotionRow::on_tool(&p.own, p.area, self.tool_node(tool)),
            None => p.tied.clone().unwrap_or_default(),
        };
        let mut rows: Vec<RelativeMotionRow<D>> = self.points.iter().map(on_tool).collect();
        let mut redistributed = Vec::new();
        if self.points.iter().any(|p| p.tool.is_none()) {
            let position = |a: usize| {
                let moved = SVector::from_column_slice(&d_u[D * a..D * a + D]);
                (self.position(a) + moved).into()
            };
            let positions: Vec<[f64; D]> = (0..self.mesh.nodes().len()).map(position).collect();
            for (k, contact) in self.contacts.iter().enumerate() {
                let Some(pairing) = contact.pairing else {
                    if let Ok(surface) = self.mesh.facet_group(&contact.surface) {
                        redistributed.extend(self.hand_over(&mut rows, (k, surface), loading));
                    }
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
                redistributed.extend(self.hand_over(&mut rows, (k, surfaces.0), loading));
            }
            if self.repairs() {
                let pairs = rows.iter_mut().zip(&self.points).enumerate();
                for (i, (row, _)) in pairs.filter(|(_, (_, p))| p.tied.is_none()) {
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

    /// Hands over multipliers as [`Driver::redistribute_multipliers`]; the points that have given theirs.
    fn hand_over(
        &self,
        rows: &mut [RelativeMotionRow<D>],
        (contact, surface): (usize, &[Facet]),
        loading: &Loading<D>,
    ) -> Vec<usize> {
        let own = (0..rows.len()).filter(|&i| self.points[i].contact == contact);
        let met: Vec<usize> = own.filter(|&i| rows[i].area > 0.0).collect();
        self.redistribute_multipliers(rows, (contact, surface), loading);
        met.into_iter().filter(|&i| rows[i].area <= 0.0).collect()
    }

    /// Under large strains the frames of ties are those of their surfaces at the start of an increment.
    fn turn_ties(&mut self) -> Result<(), ModelError> {
        if !self.has_large_strains() || self.points.iter().all(|p| p.tied.is_none()) {
            return Ok(());
        }
        let nodes = 0..self.mesh.nodes().len();
        let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
        for (k, contact) in self.contacts.iter().enumerate() {
            let of_tie = |p: &&mut ContactPoint<D>| p.contact == k && p.tied.is_some();
            let mut points = self.points.iter_mut().filter(of_tie).peekable();
            if points.peek().is_none() {
                continue;
            }
            let surface = self.mesh.facet_group(&contact.surface)?;
            let normals = self.mesh.node_normals(&positions, surface);
            for point in points {
                if let (Some(row), Some(n)) = (&mut point.tied, normals.get(&point.node)) {
                    row.turn_to(-SVector::from(*n));
                }
            }
        }
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
