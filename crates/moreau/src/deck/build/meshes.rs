//! The mesh of a deck: its files and its blocks in one mesh, no node merged; no groups of the deck.

use crate::deck::entries::{Analysis, BlockEntry, Deck, FileEntry};
use crate::deck::finding::{Class, Findings};
use crate::files::{mesh_of, read_mesh};
use crate::mesh::{Loss, Mesh, MeshError, block2, block3};
use std::array;
use std::collections::BTreeMap;
use std::ops::Range;

/// The contents of the mesh files of a deck that are at hand.
pub(super) type Files<'a> = &'a [Option<&'a [u8]>];

/// The mesh of a plane analysis.
pub(super) fn plane(deck: &Deck, files: Files<'_>, findings: &mut Findings) -> Option<Mesh<2>> {
    joined(deck, files, findings, |block| {
        let [x, y] = [0, 1].map(|i| block.grid[i].value.lines());
        block2(&block.name.value, block.element.value, &x, &y)
    })
}

/// The mesh of a half-plane beside the axis.
pub(super) fn meridian(deck: &Deck, files: Files<'_>, findings: &mut Findings) -> Option<Mesh<2>> {
    let blocks = deck.blocks.iter().map(|b| &b.grid[0]);
    for x in blocks.filter(|x| x.value.first() < 0.0) {
        beyond(findings, &x.span, "block", x.value.first());
    }
    plane(deck, files, findings)
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
pub(super) fn solid(deck: &Deck, files: Files<'_>, findings: &mut Findings) -> Option<Mesh<3>> {
    joined(deck, files, findings, |block| {
        let [x, y, z] = [0, 1, 2].map(|i| block.grid[i].value.lines());
        block3(&block.name.value, block.element.value, &x, &y, &z)
    })
}

/// A mesh of a deck, and where the deck asks for it.
type Asked<const D: usize> = (Mesh<D>, Range<usize>);

fn joined<const D: usize>(
    deck: &Deck,
    files: Files<'_>,
    findings: &mut Findings,
    make: impl Fn(&BlockEntry) -> Result<Mesh<D>, MeshError>,
) -> Option<Mesh<D>> {
    if !deck.mesh_understood {
        return None;
    }
    let mut all: Vec<Option<Asked<D>>> = Vec::new();
    for (part, bytes) in deck.mesh_files.iter().zip(files) {
        let mesh = part_of(deck, part, *bytes, findings);
        all.push(mesh.map(|mesh| (mesh, part.file.span.clone())));
    }
    for block in &deck.blocks {
        match make(block) {
            Ok(mesh) => all.push(Some((mesh, block.name.span.clone()))),
            Err(error) => {
                let of = "of this block";
                let finding = findings.error(&block.name.span, error.to_string(), of);
                finding.about(Class::Meshes);
                all.push(None);
            }
        }
    }
    let all: Vec<Asked<D>> = all.into_iter().collect::<Option<_>>()?;
    differ(&all, findings);
    let mut all = all.into_iter().map(|(mesh, _)| mesh);
    let first = all.next()?;
    all.try_fold(first, Mesh::joined).ok()
}

/// Groups of one name in several meshes are errors, one for each mesh.
fn differ<const D: usize>(all: &[Asked<D>], findings: &mut Findings) {
    let mut known: BTreeMap<&str, &Range<usize>> = BTreeMap::new();
    for (mesh, span) in all {
        let twice = mesh.group_names().find(|name| known.contains_key(name));
        if let Some(name) = twice {
            let message = MeshError::DuplicateGroup { name: name.into() }.to_string();
            let help = "[[mesh.part]] with name = \"part\" calls its groups \"part.GROUP\"";
            let finding = findings.error_with(span, message, "has it as well", help);
            finding.and_at(known[name], "has this group");
            finding.about(Class::Meshes);
        }
        known.extend(mesh.group_names().map(|name| (name, span)));
    }
}

/// The mesh of a file where it is put; what is wrong with it is noted.
fn part_of<const D: usize>(
    deck: &Deck,
    part: &FileEntry,
    bytes: Option<&[u8]>,
    findings: &mut Findings,
) -> Option<Mesh<D>> {
    let file = &part.file;
    let read = match bytes {
        Some(bytes) => mesh_of(&file.value, bytes),
        None => read_mesh(&file.value),
    };
    let (mesh, losses) = match read {
        Ok(read) => read,
        Err(error) => {
            let message = error.to_string();
            match error.help() {
                Some(help) => findings.error_with(&file.span, message, "this file", help),
                None => findings.error(&file.span, message, "this file"),
            }
            .about(Class::Meshes);
            return None;
        }
    };
    let is_meant = |loss: &Loss| {
        let of_type = matches!(loss, Loss::PlaneStress { .. });
        of_type && deck.analysis == Analysis::PlaneStress
    };
    for loss in losses.iter().filter(|loss| !is_meant(loss)) {
        findings.warning(&file.span, loss.to_string(), "not all of this file");
    }
    match put(mesh, part) {
        Ok(mesh) => {
            let least = mesh.bounds().0[0];
            if deck.analysis == Analysis::Axisymmetric && least < 0.0 {
                beyond(findings, &file.span, "mesh", least);
            }
            Some(mesh)
        }
        Err(error) => {
            let finding = findings.error(&file.span, error.to_string(), "where it is put");
            finding.about(Class::Meshes);
            None
        }
    }
}

/// A mesh that is stretched, turned and moved, and whose groups have the name of the part.
fn put<const D: usize>(mesh: Mesh<D>, part: &FileEntry) -> Result<Mesh<D>, MeshError> {
    let is_plain = *part
        == FileEntry {
            name: part.name.clone(),
            ..FileEntry::plain(part.file.clone(), D)
        };
    let mesh = match is_plain {
        true => mesh,
        false => {
            let turn = part.turn.and_then(|turn| turn.rotation());
            let turned = |x: [f64; D]| match &turn {
                Some(r) => array::from_fn(|i| (0..D).map(|j| r[(i, j)] * x[j]).sum()),
                None => x,
            };
            mesh.map(|x| {
                let x: [f64; D] = turned(x.map(|x| part.scale * x));
                array::from_fn(|i| part.position[i] + x[i])
            })?
        }
    };
    Ok(match &part.name {
        Some(name) => mesh.named(&name.value),
        None => mesh,
    })
}
