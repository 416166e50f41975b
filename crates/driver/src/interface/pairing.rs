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
        self.footing.multipliers.clear();
        self.footing.folds = self.folds()?;
        self.begin_grounds();
        self.turn_ties()?;
        self.pair_at(loading, &rest)?;
        if self.repairs() {
            self.footing.first.clone_from(&self.footing.rows);
        }
        Ok(())
    }

    /// What the contact points stand on after displacement increments, in the increment that [`Driver::pair`] has begun, where
    /// large strains move it.
    pub(crate) fn follow_surfaces(
        &mut self,
        loading: &Loading<D>,
        d_u: &[f64],
    ) -> Result<(), ModelError> {
        match self.repairs() {
            // As they are where a step has been followed to its end.
            true if self.footing.at == d_u => Ok(()),
            true => self.pair_at(loading, d_u),
            false => self.stretch_areas(d_u),
        }
    }

    /// Under large strains the areas that face tools are those of the surfaces as they are after displacement increments.
    fn stretch_areas(&mut self, d_u: &[f64]) -> Result<(), ModelError> {
        if !self.has_large_strains() || self.points.iter().all(|p| p.tool.is_none()) {
            return Ok(());
        }
        let positions = self.positions_after(d_u);
        for (k, contact) in self.contacts.iter().enumerate() {
            let faces_tool = |p: &ContactPoint<D>| p.contact == k && p.tool.is_some();
            let pairs = self.points.iter().zip(&mut self.footing.rows);
            let mut own = pairs.filter(|(p, _)| faces_tool(p)).peekable();
            if own.peek().is_none() {
                continue;
            }
            let facets = self.mesh.facet_group(&contact.surface)?;
            let shares = self.measure.shares_on_tool(&self.mesh, &positions, facets);
            let areas: BTreeMap<usize, f64> = (shares.iter())
                .map(|s| (s.share.node, s.share.area.max(0.0)))
                .collect();
            for (point, row) in own {
                row.area = areas.get(&point.node).copied().unwrap_or(row.area);
            }
        }
        Ok(())
    }

    /// The positions of all nodes after displacement increments \[mm\].
    fn positions_after(&self, d_u: &[f64]) -> Vec<[f64; D]> {
        let position = |a: usize| {
            let moved = SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
            (self.position(a) + moved).into()
        };
        (0..self.mesh.nodes().len()).map(position).collect()
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
            let positions = self.positions_after(d_u);
            for (k, contact) in self.contacts.iter().enumerate() {
                let Some(pairing) = contact.pairing else {
                    continue;
                };
                let mut kept = self.footing.multipliers.remove(&k).unwrap_or_default();
                let (mesh, sides) = (&self.mesh, self.sides(k)?);
                let mortar_rows =
                    (self.measure).mortar_rows(mesh, &positions, sides, pairing, &mut kept);
                self.footing.multipliers.insert(k, kept);
                let index = |p: &ContactPoint<D>| p.contact == k;
                let own = (0..self.points.len()).filter(|&i| index(&self.points[i]));
                let at: BTreeMap<usize, usize> = own.map(|i| (self.points[i].node, i)).collect();
                for mortar_row in mortar_rows {
                    if let Some(&point) = at.get(&mortar_row.node) {
                        rows[point] = RelativeMotionRow::on_surface(mortar_row, &positions);
                    }
                }
            }
            // The order in which points give way to others must not change with the iterates.
            if self.footing.first.is_empty() {
                let most = |row: &RelativeMotionRow<D>| {
                    row.opposite.iter().map(|o| o.1).fold(0.0, f64::max)
                };
                self.footing.opposite = rows.iter().map(most).collect();
            }
            for k in 0..self.contacts.len() {
                if let Ok((surface, _)) = self.sides(k) {
                    redistributed.extend(self.hand_over(&mut rows, (k, surface), loading));
                }
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
        self.stretch_areas(d_u)
    }

    /// The surfaces of a contact, the non-mortar side first; both sides of one that may meet itself.
    fn sides(&self, contact: usize) -> Result<(&[Facet], &[Facet]), ModelError> {
        if let Some(Fold { non_mortar, mortar }) = self.footing.folds.get(&contact) {
            return Ok((non_mortar, mortar));
        }
        let Contact {
            surface, opposite, ..
        } = &self.contacts[contact];
        let other = self.mesh.facet_group(opposite).unwrap_or(&[]);
        Ok((self.mesh.facet_group(surface)?, other))
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
