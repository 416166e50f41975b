//! The states that materials start from; what a law bears is for the driver to say.

use super::groups::{Groups, HIDDEN};
use super::laws::{Law, RECALLED};
use crate::deck::Laws;
use crate::deck::entries::{Deck, InitialEntry};
use crate::deck::finding::{At, Findings};
use crate::driver::{Analysis, Model, ModelError};
use crate::laws::{BulkLaw, DruckerPragerState, HillState, VonMisesState};
use crate::mandel::{Sym2, Sym4, from_matrix};
use crate::mesh::{Integration, Mesh, MeshError};
use nalgebra::Matrix3;
use std::collections::BTreeMap;

impl InitialEntry {
    /// The stress at a position.
    fn stress_at(&self, x: &[f64]) -> Sym2 {
        let of = |k: usize| match self.stress.get(k) {
            Some(Some(field)) => field.value.at(x),
            _ => 0.0,
        };
        let [xx, yy, zz, xy, yz, xz] = [0, 1, 2, 3, 4, 5].map(of);
        from_matrix(&Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }

    fn plastic_strain_at(&self, x: &[f64]) -> f64 {
        self.p.as_ref().map_or(0.0, |p| p.value.at(x))
    }
}

/// Cells that two entries name, plastic strains of what has none, and laws of one's own.
pub(super) fn check<const D: usize>(
    (deck, laws): (&Deck, &Laws),
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    let cells = |on: &At<String>| groups.mesh.cell_group(&on.value).unwrap_or_default();
    let mut of_cell: BTreeMap<usize, &str> = BTreeMap::new();
    for entry in &deck.initial {
        let before = cells(&entry.on).iter();
        let before = before.filter_map(|&cell| of_cell.insert(cell, &entry.on.value));
        if let Some(before) = before.last() {
            let message = format!(
                "cells of \"{}\" start as \"{before}\" does already: groups must not overlap",
                entry.on.value
            );
            findings.error(&entry.on.span, message, "starts twice");
        }
        let touches = |on: &At<String>| {
            let own = cells(on);
            cells(&entry.on).iter().any(|cell| own.contains(cell))
        };
        let mut given = deck.materials.iter().map(|m| &m.on);
        if let Some(on) = given.find(|on| laws.contains_key(&on.value) && touches(on)) {
            let message = format!(
                "\"{}\" starts with what [[initial]] says, and the law of \"{}\" is one of one's own",
                entry.on.value, on.value
            );
            let label = "its own initial state says where it starts";
            findings.error(&entry.span, message, label);
        }
        let Some(p) = &entry.p else { continue };
        for material in deck.materials.iter().filter(|m| m.yields().is_none()) {
            if touches(&material.on) {
                let message = format!(
                    "p on \"{}\", and the material of \"{}\" does not yield",
                    entry.on.value, material.on.value
                );
                findings.error(&p.span, message, "what is elastic has no plastic strain");
            }
        }
    }
}

/// A piece of a material by what its cells start with: itself where that is the same for all, else hidden groups.
pub(super) fn pieces<const D: usize>(
    deck: &Deck,
    mesh: &mut Mesh<D>,
    name: &str,
) -> Result<Vec<(String, Option<InitialEntry>)>, MeshError> {
    let mut of_cell: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, entry) in deck.initial.iter().enumerate() {
        let own = mesh.cell_group(&entry.on.value)?;
        of_cell.extend(own.iter().map(|&cell| (cell, k)));
    }
    let mut cells: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for &cell in mesh.cell_group(name)? {
        let start = of_cell.get(&cell).copied();
        cells.entry(start).or_default().push(cell);
    }
    let entry = |start: &Option<usize>| start.map(|k| deck.initial[k].clone());
    if cells.len() < 2 {
        let start = cells.keys().next().and_then(entry);
        return Ok(vec![(name.to_owned(), start)]);
    }
    let mut pieces = Vec::new();
    for (k, (start, cells)) in cells.into_iter().enumerate() {
        let piece = format!("{name}{HIDDEN}start{k}");
        // A mesh that was written with it has it.
        if mesh.cell_group(&piece).ok() != Some(cells.as_slice()) {
            mesh.add_cell_group(&piece, cells)?;
        }
        pieces.push((piece, entry(&start)));
    }
    Ok(pieces)
}

/// Adds a piece of a material to a model, from what its cells start with.
pub(super) fn add<const D: usize, H: Analysis<D>>(
    model: Model<D, H>,
    (name, rule): (&str, Integration),
    law: Law,
    start: Option<&InitialEntry>,
) -> Result<Model<D, H>, ModelError> {
    let Some(start) = start else {
        return match law {
            Law::Elastic(law) => model.material(name, law, rule),
            Law::VonMises(law) => model.material(name, law, rule),
            Law::Chaboche(law) => model.material(name, law, rule),
            Law::DruckerPrager(law) => model.material(name, law, rule),
            Law::Orthotropic(law) => model.material(name, law, rule),
            Law::Hill(law) => model.material(name, *law, rule),
            Law::Given(law) => model.panel_material(name, &law, rule),
        };
    };
    let p = |x: &[f64; D]| start.plastic_strain_at(x);
    match law {
        Law::Elastic(law) => {
            let strain = elastic_strain(&law, start);
            model.material_from(name, law, rule, |x| strain(x))
        }
        Law::VonMises(law) => {
            let strain = elastic_strain(&law, start);
            model.material_from(name, law, rule, |x| VonMisesState {
                elastic_strain: strain(x),
                p: p(x),
                ..VonMisesState::default()
            })
        }
        Law::Chaboche(law) => {
            let strain = elastic_strain(&law, start);
            model.material_from(name, law, rule, |x| VonMisesState::<RECALLED> {
                elastic_strain: strain(x),
                p: p(x),
                ..VonMisesState::default()
            })
        }
        Law::DruckerPrager(law) => {
            let strain = elastic_strain(&law, start);
            model.material_from(name, law, rule, |x| DruckerPragerState {
                elastic_strain: strain(x),
                p: p(x),
                ..DruckerPragerState::default()
            })
        }
        Law::Orthotropic(law) => {
            let strain = elastic_strain(&law, start);
            model.material_from(name, law, rule, |x| strain(x))
        }
        Law::Hill(law) => {
            let strain = elastic_strain(law.as_ref(), start);
            model.material_from(name, *law, rule, |x| HillState {
                elastic_strain: strain(x),
                hardening_strain: p(x),
                p: p(x),
            })
        }
        // Refused before.
        Law::Given(law) => model.panel_material(name, &law, rule),
    }
}

/// The elastic strain of the stress at a position.
fn elastic_strain<'a, L: BulkLaw, const D: usize>(
    law: &L,
    start: &'a InitialEntry,
) -> impl Fn(&[f64; D]) -> Sym2 + use<'a, L, D> {
    // The tangent of a law is positive definite.
    let inverse = law.elastic_tangent().try_inverse();
    let compliance = inverse.unwrap_or_else(|| Sym4::repeat(f64::NAN));
    move |x| compliance * start.stress_at(x)
}
