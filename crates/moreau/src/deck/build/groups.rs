//! The groups of a deck on its mesh: parts by limits and by nearness, and what they measure.

use super::{Body, GroupFacts};
use crate::deck::entries::{BlockEntry, Deck, FileEntry, GroupEntry, Part};
use crate::deck::finding::{At, Class, Findings, did_you_mean};
use crate::driver::{Analysis, Support};
use crate::mesh::{CellKind, Facet, Mesh};
use crate::numbers::shown;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Limits are inclusive within this part of the size of the model.
const INCLUSIVE: f64 = 1e-9;
/// Mark in the names of hidden groups: the nodes of a part whose limits cut facets or cells, the
/// cells of a material with one rule among several.
pub(super) const HIDDEN: &str = "~~";

/// A mesh with all groups of the deck.
pub(super) struct Groups<const D: usize> {
    /// The mesh.
    pub(super) mesh: Mesh<D>,
    /// Groups whose nodes are more than those of their facets or cells, and the group of these.
    nodes: BTreeMap<String, String>,
    /// Groups that could not be made: not to be complained about again.
    broken: Vec<String>,
}

impl<const D: usize> Groups<D> {
    pub(super) fn new(deck: &Deck, mesh: Mesh<D>, findings: &mut Findings) -> Self {
        let mut groups = Self {
            mesh,
            nodes: BTreeMap::new(),
            broken: Vec::new(),
        };
        for entry in &deck.groups {
            if groups.add(entry, findings).is_none() {
                groups.broken.push(entry.name.value.clone());
            }
        }
        let contacts = deck.contacts.iter().map(|c| (&c.surface.value, &c.parts));
        let ties = deck.ties.iter().map(|t| (&t.surface.value, &t.parts));
        for (name, parts) in contacts.chain(ties).filter(|(_, parts)| parts.len() > 1) {
            groups.join(name, parts);
        }
        groups
    }

    /// The facets of all parts of a surface as one group, each once; of parts that have some.
    fn join(&mut self, name: &str, parts: &[At<String>]) {
        let own = |part: &At<String>| self.mesh.facet_group(&part.value).unwrap_or_default();
        let facets: BTreeSet<Facet> = parts.iter().flat_map(own).copied().collect();
        if self.has(name) || facets.is_empty() {
            return;
        }
        let joined = self
            .mesh
            .add_facet_group(name, facets.into_iter().collect());
        if joined.is_err() {
            self.broken.push(name.to_owned());
        }
    }

    /// The box around some nodes, in words.
    fn extent(&self, nodes: &[usize]) -> String {
        let axis = |(i, name): (usize, &&str)| {
            let values = nodes.iter().map(|&n| self.mesh.nodes()[n][i]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(v), h.max(v))
            });
            format!("{name} = [{}, {}]", shown(low, 6), shown(high, 6))
        };
        let axes = ["x", "y", "z"];
        let all: Vec<String> = axes[..D].iter().enumerate().map(axis).collect();
        all.join(", ")
    }

    fn add(&mut self, entry: &GroupEntry, findings: &mut Findings) -> Option<()> {
        let (name, on) = (&entry.name.value, &entry.on.value);
        if self.has(name) {
            findings
                .error(
                    &entry.name.span,
                    format!("the group \"{name}\" exists already: the names of groups must differ"),
                    "used twice",
                )
                .about(Class::Names);
            return None;
        }
        if !self.has(on) {
            if !self.broken.contains(on) {
                findings
                    .error(
                        &entry.on.span,
                        format!(
                            "no group \"{on}\" before this one{}",
                            did_you_mean(on, self.names())
                        ),
                        "not a group",
                    )
                    .about(Class::Names);
            }
            return None;
        }
        let candidates = self.mesh.node_group(self.nodes_of(on)).ok()?;
        let added = match &entry.part.value {
            Part::Nearest(point) => {
                let distance = |node: &usize| -> f64 {
                    let x = &self.mesh.nodes()[*node];
                    x.iter().zip(point).map(|(a, b)| (a - b) * (a - b)).sum()
                };
                let node = candidates
                    .into_iter()
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
                self.mesh.add_node_group(name, vec![node])
            }
            Part::Box(limits) => {
                let margin = INCLUSIVE * self.mesh.size();
                let limits = limits.clone();
                let inside = move |x: &[f64; D]| {
                    x.iter().zip(&limits).all(|(x, limit)| match limit {
                        Some([low, high]) => (low - margin..=high + margin).contains(x),
                        None => true,
                    })
                };
                let extent = self.extent(&candidates);
                let mut nodes = candidates;
                nodes.retain(|&node| inside(&self.mesh.nodes()[node]));
                if nodes.is_empty() {
                    findings.error(
                        &entry.part.span,
                        format!(
                            "the group \"{name}\" is empty: no node of \"{on}\" lies within these \
                             limits, it extends over {extent}"
                        ),
                        "of this group",
                    ).about(Class::Groups);
                    return None;
                }
                self.add_box(entry, nodes, inside, findings)
            }
        };
        added
            .map_err(|error| {
                let span = &entry.name.span;
                findings
                    .error(span, error.to_string(), "of this group")
                    .about(Class::Groups);
            })
            .ok()
    }

    /// Facets or cells that lie inside as a whole, and all nodes that do; only the nodes, if no
    /// facet or cell does.
    fn add_box(
        &mut self,
        entry: &GroupEntry,
        nodes: Vec<usize>,
        inside: impl Fn(&[f64; D]) -> bool,
        findings: &mut Findings,
    ) -> Result<(), crate::mesh::MeshError> {
        let (name, on) = (&entry.name.value, &entry.on.value);
        let mesh = &mut self.mesh;
        let kept = |node: usize, mesh: &Mesh<D>| inside(&mesh.nodes()[node]);
        if let Ok(facets) = mesh.facet_group(on) {
            let whole = |f: &&Facet| mesh.facet_nodes(**f).all(|n| kept(n, mesh));
            let facets: Vec<Facet> = facets.iter().filter(whole).copied().collect();
            if facets.is_empty() {
                return mesh.add_node_group(name, nodes);
            }
            mesh.add_facet_group(name, facets)?;
        } else if let Ok(cells) = mesh.cell_group(on) {
            let whole = |c: &&usize| mesh.cell_nodes(**c).iter().all(|&n| kept(n, mesh));
            let cells: Vec<usize> = cells.iter().filter(whole).copied().collect();
            if cells.is_empty() {
                return mesh.add_node_group(name, nodes);
            }
            mesh.add_cell_group(name, cells)?;
        } else {
            return mesh.add_node_group(name, nodes);
        }
        let covered = mesh.node_group(name)?;
        if covered != nodes {
            let hidden = format!("{name}{HIDDEN}");
            findings.warning(
                &entry.part.span,
                format!(
                    "the limits of \"{name}\" cut through the mesh: pressure, traction, contact and \
                     material take what lies inside as a whole ({} nodes), displacements and \
                     forces all nodes inside ({})",
                    covered.len(),
                    nodes.len()
                ),
                "limits between the lines of the mesh",
            );
            mesh.add_node_group(&hidden, nodes)?;
            self.nodes.insert(name.clone(), hidden);
        }
        Ok(())
    }

    /// Whether there is such a group.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names().any(|n| n == name)
    }

    /// Whether such a group was to be made, but could not.
    pub(super) fn is_broken(&self, name: &str) -> bool {
        self.broken.iter().any(|n| n == name)
    }

    /// Names of all groups.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.mesh.group_names().filter(|n| !n.contains(HIDDEN))
    }

    /// The group that holds the nodes of a group.
    pub(super) fn nodes_of<'a>(&'a self, name: &'a str) -> &'a str {
        self.nodes.get(name).map_or(name, String::as_str)
    }

    /// Name of the smallest group with these cells, which are sorted.
    fn holder(&self, cells: &[usize]) -> Option<&str> {
        let holds = |group: &[usize]| cells.iter().all(|c| group.binary_search(c).is_ok());
        self.names()
            .filter_map(|name| Some((name, self.mesh.cell_group(name).ok()?)))
            .filter(|(_, group)| group.len() >= cells.len() && holds(group))
            .min_by_key(|(_, group)| group.len())
            .map(|(name, _)| name)
    }

    /// Name of the body of a cell, and where the deck asks for it.
    pub(super) fn origin(&self, deck: &Deck, cell: usize) -> (String, Range<usize>) {
        let own = |b: &&BlockEntry| {
            let cells = self.mesh.cell_group(&b.name.value);
            cells.is_ok_and(|cells| cells.binary_search(&cell).is_ok())
        };
        if let Some(block) = deck.blocks.iter().find(own) {
            return (block.name.value.clone(), block.name.span.clone());
        }
        let bodies = self.mesh.bodies();
        let body = bodies.iter().position(|b| b.binary_search(&cell).is_ok());
        let name = body.map_or_else(String::new, |k| self.body_name(k, &bodies[k]));
        // Of a part that has no name, the first of them.
        let holds = |part: &FileEntry| match &part.name {
            Some(name) => {
                let cells = self.mesh.cell_group(&name.value);
                cells.is_ok_and(|cells| cells.binary_search(&cell).is_ok())
            }
            None => false,
        };
        let named = deck.mesh_files.iter().find(|part| holds(part));
        let other = || deck.mesh_files.iter().find(|part| part.name.is_none());
        let part = named.or_else(other);
        let span = part.map_or(0..0, |part| part.file.span.clone());
        (name, span)
    }

    fn body_name(&self, index: usize, cells: &[usize]) -> String {
        let name = self.holder(cells).map(str::to_owned);
        name.unwrap_or_else(|| (index + 1).to_string())
    }

    /// Kinds of the cells of a group; none if it holds no cells.
    pub(super) fn kinds(&self, name: &str) -> Vec<CellKind> {
        let cells = self.mesh.cell_group(name).unwrap_or_default();
        let kinds: BTreeSet<CellKind> = cells.iter().map(|&c| self.mesh.kind(c)).collect();
        kinds.into_iter().collect()
    }

    /// The bodies, with what stops each of them, step by step.
    pub(super) fn bodies<H: Analysis<D>>(
        &self,
        hypothesis: &H,
        supports: &[Vec<Support>],
    ) -> Vec<Body> {
        let bodies = self.mesh.bodies();
        let body = |(k, cells): (usize, &Vec<usize>)| {
            let mut count: BTreeMap<CellKind, usize> = BTreeMap::new();
            for &cell in cells {
                *count.entry(self.mesh.kind(cell)).or_default() += 1;
            }
            let own = supports.iter().map(|step| {
                let own = step.iter().find(|s| s.cell == cells[0]);
                let mut motions = own.map_or_else(Vec::new, |s| s.motions.clone());
                for (group, _) in motions.iter_mut().flat_map(|m| &mut m.groups) {
                    // A hidden group has the nodes of one of the deck.
                    group.truncate(group.find(HIDDEN).unwrap_or(group.len()));
                }
                motions
            });
            Body {
                name: self.body_name(k, cells),
                cells: count.into_iter().collect(),
                volume: self.mesh.measure(cells, hypothesis),
                motions: own.collect(),
            }
        };
        bodies.iter().enumerate().map(body).collect()
    }

    /// What the groups measure.
    pub(super) fn facts<H: Analysis<D>>(&self, hypothesis: &H) -> Vec<GroupFacts> {
        let facts = |name: &str| {
            let nodes = self.mesh.node_group(self.nodes_of(name));
            let nodes = nodes.map_or(0, |n| n.len());
            let (kind, members, measure) = if let Ok(cells) = self.mesh.cell_group(name) {
                let volume = self.mesh.measure(cells, hypothesis);
                ("cells", cells.len(), Some(volume))
            } else if let Ok(facets) = self.mesh.facet_group(name) {
                let shares = self.mesh.facet_shares(facets, hypothesis);
                let area = shares.iter().map(|s| s.area).sum();
                ("facets", facets.len(), Some(area))
            } else {
                ("nodes", nodes, None)
            };
            GroupFacts {
                name: name.to_owned(),
                kind,
                members,
                nodes,
                measure,
            }
        };
        self.names().map(facts).collect()
    }
}
