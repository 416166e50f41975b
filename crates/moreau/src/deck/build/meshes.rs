//! The mesh of a deck: its file and its blocks in one mesh, no node merged; no groups of the deck.

use crate::deck::entries::{Analysis, BlockEntry, Deck};
use crate::deck::finding::{Class, Findings};
use crate::files::{mesh_of, read_mesh};
use crate::mesh::{Loss, Mesh, MeshError, block2, block3};
use std::ops::Range;

/// The mesh of a plane analysis.
pub(super) fn plane(deck: &Deck, given: Option<&[u8]>, findings: &mut Findings) -> Option<Mesh<2>> {
    joined(deck, given, findings, |block| {
        let [x, y] = [0, 1].map(|i| block.grid[i].value.lines());
        block2(&block.name.value, block.element.value, &x, &y)
    })
}

/// The mesh of a half-plane beside the axis.
pub(super) fn meridian(
    deck: &Deck,
    given: Option<&[u8]>,
    findings: &mut Findings,
) -> Option<Mesh<2>> {
    let blocks = deck.blocks.iter().map(|b| &b.grid[0]);
    let crossing: Vec<_> = blocks.filter(|x| x.value.first() < 0.0).collect();
    for x in &crossing {
        beyond(findings, &x.span, "block", x.value.first());
    }
    let mesh = plane(deck, given, findings)?;
    let least = mesh.bounds().0[0];
    if let (Some(file), true) = (&deck.mesh_file, least < 0.0 && crossing.is_empty()) {
        beyond(findings, &file.span, "mesh", least);
    }
    Some(mesh)
}

fn beyond(findings: &mut Findings, span: &Range<usize>, what: &str, least: f64) {
    findings
        .error(
            span,
            format!("the {what} reaches the radius {least}, expected x ≥ 0"),
            "x is the radius, y the axis",
        )
        .about(Class::Meshes);
}

/// The mesh of a solid.
pub(super) fn solid(deck: &Deck, given: Option<&[u8]>, findings: &mut Findings) -> Option<Mesh<3>> {
    joined(deck, given, findings, |block| {
        let [x, y, z] = [0, 1, 2].map(|i| block.grid[i].value.lines());
        block3(&block.name.value, block.element.value, &x, &y, &z)
    })
}

fn joined<const D: usize>(
    deck: &Deck,
    given: Option<&[u8]>,
    findings: &mut Findings,
    make: impl Fn(&BlockEntry) -> Result<Mesh<D>, MeshError>,
) -> Option<Mesh<D>> {
    if !deck.mesh_understood {
        return None;
    }
    let mut mesh: Option<Mesh<D>> = None;
    if let Some(file) = &deck.mesh_file {
        let read = match given {
            Some(bytes) => mesh_of(&file.value, bytes),
            None => read_mesh(&file.value),
        };
        match read {
            Ok((read, losses)) => {
                let is_meant = |loss: &Loss| {
                    let of_type = matches!(loss, Loss::PlaneStress { .. });
                    of_type && deck.analysis == Analysis::PlaneStress
                };
                for loss in losses.iter().filter(|loss| !is_meant(loss)) {
                    let label = "not all of this file";
                    findings.warning(&file.span, loss.to_string(), label);
                }
                mesh = Some(read);
            }
            Err(error) => {
                let message = error.to_string();
                match error.help() {
                    Some(help) => findings.error_with(&file.span, message, "this file", help),
                    None => findings.error(&file.span, message, "this file"),
                }
                .about(Class::Meshes);
                return None;
            }
        }
    }
    for block in &deck.blocks {
        let joined = make(block).and_then(|new| match mesh.take() {
            Some(old) => old.joined(new),
            None => Ok(new),
        });
        match joined {
            Ok(joined) => mesh = Some(joined),
            Err(error) => {
                findings
                    .error(&block.name.span, error.to_string(), "of this block")
                    .about(Class::Meshes);
                return None;
            }
        }
    }
    mesh
}
