//! What stops the rigid motions of the bodies: a rank, not how forces answer.
//!
//! A body of modes r₁ … r_m is stopped by rows a: combinations of displacements that are prescribed,
//! that a contact normal closes on, or that friction resists. What is free is the null space of
//! Σ a aᵀ over all bodies, since contacts couple them.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::{Axis, Condition, Loading, Step, axis_letter};
use moreau_laws::Status;
use nalgebra::{DMatrix, DVector, SVector};
use std::collections::BTreeMap;

/// What stops a rigid motion of a body, in the order in which they are counted on: each together
/// with those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stopper {
    /// Prescribed displacements.
    Displacement,
    /// Contact normals, which push and do not pull.
    Contact,
    /// Friction, as far as it reaches.
    Friction,
}

/// A rigid motion of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// The motion in words, as in "translation along x".
    pub name: String,
    /// What it takes to stop it; `None` if nothing does.
    pub stopper: Option<Stopper>,
    /// Groups that resist it by prescribed displacements, with the directions.
    pub groups: Vec<(String, Vec<Axis>)>,
    /// Contacts that resist it, where displacements do not stop it by themselves.
    pub contacts: Vec<usize>,
}

/// The rigid motions of a body: translations, then rotations.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// First cell of the body.
    pub cell: usize,
    /// Its motions.
    pub motions: Vec<RigidMotion>,
    /// Independent motions that nothing resists, which may be combinations of these, in words.
    pub free: Vec<String>,
}

/// Who resists: a condition of a step along an axis, or a contact.
type Source = (Stopper, usize, usize);

/// Eigenvalues of Σ a aᵀ below this part of the largest are rounding.
const SINGULAR: f64 = 1e-10;
/// Components of unit vectors below this are rounding.
const NOTHING: f64 = 1e-6;

/// Rigid modes of all bodies and what resists them.
struct Rows {
    /// First cell of each body.
    cells: Vec<usize>,
    /// Tools that are driven by forces, bodies of their own after those of cells.
    tools: Vec<usize>,
    /// Modes of a body, of which the first are translations.
    modes: usize,
    translations: usize,
    /// Σ a aᵀ of each kind.
    gram: [DMatrix<f64>; 3],
    /// Σ a² on every mode, by source.
    effect: BTreeMap<Source, DVector<f64>>,
}

impl Rows {
    fn add(&mut self, source: Source, row: &BTreeMap<usize, f64>) {
        let gram = &mut self.gram[source.0 as usize];
        let size = gram.nrows();
        let effect = self.effect.entry(source);
        let effect = effect.or_insert_with(|| DVector::zeros(size));
        for (&i, a) in row {
            effect[i] += a * a;
            for (&j, b) in row {
                gram[(i, j)] += a * b;
            }
        }
    }

    /// Σ a aᵀ of everything up to a kind.
    fn up_to(&self, stopper: Stopper) -> DMatrix<f64> {
        let kinds = self.gram[..=stopper as usize].iter();
        kinds.fold(self.gram[0].clone() * 0.0, |sum, g| sum + g)
    }

    /// Whether the modes of a body are stopped where these motions are free. Of rotations only
    /// whether the body turns counts, of translations those without a turn: then it does not
    /// matter about which point a body is said to turn.
    fn stopped(&self, body: usize, free: &DMatrix<f64>) -> Vec<bool> {
        let own = free.rows(self.modes * body, self.modes);
        let turns = own.rows(self.translations, self.modes - self.translations);
        let straight = own * null_space(&(turns.transpose() * turns));
        let still = |rows: &DMatrix<f64>, k: usize| rows.row(k).amax() < NOTHING;
        let own = own.into_owned();
        (0..self.modes)
            .map(|k| match k < self.translations {
                true => straight.ncols() == 0 || still(&straight, k),
                false => own.ncols() == 0 || still(&own, k),
            })
            .collect()
    }

    fn name(&self, mode: usize) -> String {
        match mode {
            _ if self.modes == 1 => "translation along y".into(),
            k if k < self.translations => format!("translation along {}", axis_letter(k)),
            k if self.modes == 6 => format!("rotation about {}", axis_letter(k - 3)),
            _ => "rotation in the plane".into(),
        }
    }

    /// Independent free motions, each with the body that moves most.
    fn free(&self) -> Vec<(usize, String)> {
        let basis = reduced(null_space(&self.up_to(Stopper::Friction)));
        let motion = |mode: nalgebra::DVectorView<'_, f64>| {
            let part = |b: usize| mode.rows(self.modes * b, self.modes);
            let most = |a: &usize, b: &usize| part(*a).norm().total_cmp(&part(*b).norm());
            let body = (0..self.cells.len() + self.tools.len())
                .rev()
                .max_by(most)
                .unwrap_or(0);
            let own = part(body);
            let large = |k: &usize| own[*k].abs() > 0.1 * own.amax();
            let names: Vec<String> = (0..self.modes)
                .filter(large)
                .map(|k| self.name(k))
                .collect();
            (body, names.join(" with "))
        };
        basis.column_iter().map(motion).collect()
    }
}

/// An orthonormal basis, in columns, of what a symmetric matrix with no negative eigenvalues takes
/// to zero.
fn null_space(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        // Nothing is asked for: everything is left.
        return DMatrix::identity(matrix.nrows(), matrix.nrows());
    }
    let eigen = matrix.clone().symmetric_eigen();
    let least = SINGULAR * eigen.eigenvalues.amax().max(1.0);
    let null = |k: &usize| eigen.eigenvalues[*k] <= least;
    let columns: Vec<usize> = (0..matrix.nrows()).filter(null).collect();
    eigen.eigenvectors.select_columns(&columns)
}

/// The same space by columns with leading entries where the others have none: a translation is then
/// told from a rotation that is free as well.
fn reduced(mut basis: DMatrix<f64>) -> DMatrix<f64> {
    let mut done = 0;
    for row in 0..basis.nrows() {
        let pivot = (done..basis.ncols())
            .max_by(|&a, &b| basis[(row, a)].abs().total_cmp(&basis[(row, b)].abs()));
        let Some(pivot) = pivot.filter(|&k| basis[(row, k)].abs() > NOTHING) else {
            continue;
        };
        basis.swap_columns(done, pivot);
        let leading = basis.column(done) / basis[(row, done)];
        for k in 0..basis.ncols() {
            let share = basis[(row, k)];
            let column = match k == done {
                true => leading.clone(),
                false => basis.column(k) - &leading * share,
            };
            basis.set_column(k, &column);
        }
        done += 1;
    }
    basis
}

/// Components of a contact point that resist a motion.
fn resists<const D: usize>(status: Status) -> usize {
    match status {
        Status::Open => 0,
        Status::Slip => 1,
        Status::Stick => D,
    }
}

impl<const D: usize> Driver<D> {
    /// What stops every rigid motion of every body in a step; nothing is solved.
    ///
    /// # Errors
    /// Those of [`Driver::loading`].
    pub fn supports(&self, step: &Step<D>) -> Result<Vec<Support>, ModelError> {
        let loading = self.loading(step)?;
        let mut groups: Vec<&str> = Vec::new();
        let mut held = Vec::new();
        for condition in &step.conditions {
            let Condition::Displace { on, axis, .. } = condition else {
                continue;
            };
            let index = groups.iter().position(|g| g == on).unwrap_or_else(|| {
                groups.push(on);
                groups.len() - 1
            });
            let nodes = self.mesh().node_group(on)?;
            held.extend(nodes.iter().map(|n| (D * n + axis.index(), index)));
        }
        let rows = self.rows(held.into_iter(), &loading, Self::may_resist);
        let kinds = [Stopper::Displacement, Stopper::Contact, Stopper::Friction];
        let free = kinds.map(|kind| null_space(&rows.up_to(kind)));
        let motions = rows.free();
        let support = |body: usize| {
            let stopped = free.each_ref().map(|f| rows.stopped(body, f));
            let motion = |k: usize| {
                let stopper = kinds.into_iter().find(|&kind| stopped[kind as usize][k]);
                let mut motion = RigidMotion {
                    name: rows.name(k),
                    stopper,
                    groups: Vec::new(),
                    contacts: Vec::new(),
                };
                let mode = rows.modes * body + k;
                for (&(kind, index, axis), effect) in &rows.effect {
                    if Some(kind) > stopper || effect[mode] < NOTHING * NOTHING {
                        continue;
                    }
                    if kind == Stopper::Displacement {
                        let axis = [Axis::X, Axis::Y, Axis::Z][axis];
                        match motion.groups.last_mut() {
                            Some((name, axes)) if name == groups[index] => axes.push(axis),
                            _ => motion.groups.push((groups[index].to_owned(), vec![axis])),
                        }
                    } else if !motion.contacts.contains(&index) {
                        motion.contacts.push(index);
                    }
                }
                motion
            };
            Support {
                cell: rows.cells[body],
                motions: (0..rows.modes).map(motion).collect(),
                free: motions
                    .iter()
                    .filter(|(b, _)| *b == body)
                    .map(|(_, motion)| motion.clone())
                    .collect(),
            }
        };
        Ok((0..rows.cells.len()).map(support).collect())
    }

    /// Every rigid motion of the bodies must be resisted by a prescribed displacement, by a contact
    /// normal, or by friction.
    pub(crate) fn check_rigid_motions(&self, loading: &Loading<D>) -> Result<(), ModelError> {
        let rows = self.resisted(loading, Self::may_resist);
        match rows.free().into_iter().next() {
            None => Ok(()),
            Some((body, motion)) => Err(match body.checked_sub(rows.cells.len()) {
                Some(k) => ModelError::FreeTool {
                    tool: self.tools[rows.tools[k]].name.clone(),
                    motion,
                },
                None => ModelError::FreeRigidMotion {
                    cell: rows.cells[body],
                    motion,
                },
            }),
        }
    }

    /// Whether displacement conditions leave a rigid motion to the contacts.
    pub(crate) fn floats(&self, loading: &Loading<D>) -> bool {
        !self.resisted(loading, |_, _| 0).free().is_empty()
    }

    /// Whether contacts of these statuses resist every rigid motion: what touches by its normal, and by its
    /// tangents where it sticks.
    pub(crate) fn is_held(&self, loading: &Loading<D>, status: &[Status]) -> bool {
        self.resisted(loading, |_, k| resists::<D>(status[k]))
            .free()
            .is_empty()
    }

    fn resisted(&self, loading: &Loading<D>, components: impl Fn(&Self, usize) -> usize) -> Rows {
        let held = loading.displacement.range(..self.mesh_dofs());
        self.rows(held.map(|(&dof, _)| (dof, 0)), loading, components)
    }

    /// The rigid motions that nothing resists in the committed state, in words: of what touches, the
    /// normals, and the tangents where it sticks.
    pub fn free_motions(&self) -> Vec<String> {
        let status = |driver: &Self, k: usize| resists::<D>(driver.state.contacts[k].status);
        let rows = self.resisted(&self.state.loading, status);
        let whose = |body: usize| match body.checked_sub(rows.cells.len()) {
            Some(k) => format!("tool {:?}", self.tools[rows.tools[k]].name),
            None => format!("the body of cell {}", rows.cells[body]),
        };
        let motions = rows.free().into_iter();
        motions
            .map(|(body, motion)| format!("{motion} of {}", whose(body)))
            .collect()
    }

    /// Components in which a contact point may resist a motion: the normal, and the tangents where its
    /// law has friction.
    fn may_resist(&self, point: usize) -> usize {
        match self.points[point].law.resists_slip() {
            true => D,
            false => 1,
        }
    }

    /// What resists, with the degrees of freedom that are held and by which of the groups, and the number
    /// of components, the normal first, in which each contact point does.
    fn rows(
        &self,
        held: impl Iterator<Item = (usize, usize)>,
        loading: &Loading<D>,
        components: impl Fn(&Self, usize) -> usize,
    ) -> Rows {
        let size = self.mesh.size();
        let mut body_of = vec![0; self.mesh.nodes().len()];
        let bodies = self.mesh.bodies();
        for (b, cells) in bodies.iter().enumerate() {
            for &cell in cells {
                for &node in self.mesh.cell_nodes(cell) {
                    body_of[node] = b;
                }
            }
        }
        // Modes about the middle of the body, in the size of the mesh: numbers of order one.
        let mut limits = vec![([f64::INFINITY; D], [f64::NEG_INFINITY; D]); bodies.len()];
        for (&b, x) in body_of.iter().zip(self.mesh.nodes()) {
            let (low, high) = &mut limits[b];
            for i in 0..D {
                (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i]));
            }
        }
        let nodes = self.mesh.nodes().len();
        let is_held = |dof: usize| loading.displacement.contains_key(&dof);
        let driven = |&k: &usize| (0..D).any(|i| !is_held(D * self.tool_node(k) + i));
        let tools: Vec<usize> = (0..self.tools.len()).filter(driven).collect();
        body_of.resize(nodes + self.tools.len(), usize::MAX);
        for (k, &tool) in tools.iter().enumerate() {
            body_of[self.tool_node(tool)] = bodies.len() + k;
        }
        let modes = |node: usize| -> Vec<SVector<f64, D>> {
            if node >= nodes {
                // A tool does not turn, and moves only where it is driven.
                let modes = self.measure.rigid_modes(&[0.0; D]).into_iter();
                let free = |i: usize, u: f64| if is_held(D * node + i) { 0.0 } else { u };
                return modes
                    .map(|m| SVector::from_fn(|i, _| free(i, m[i])))
                    .collect();
            }
            let (x, (low, high)) = (self.mesh.nodes()[node], limits[body_of[node]]);
            let relative = std::array::from_fn(|i| (x[i] - 0.5 * (low[i] + high[i])) / size);
            let modes = self.measure.rigid_modes(&relative);
            modes.into_iter().map(SVector::from).collect()
        };
        let count = modes(0).len();
        let all = count * (bodies.len() + tools.len());
        let mut rows = Rows {
            cells: bodies.iter().map(|cells| cells[0]).collect(),
            tools,
            modes: count,
            translations: count.min(D),
            gram: std::array::from_fn(|_| DMatrix::zeros(all, all)),
            effect: BTreeMap::new(),
        };
        // Motions that move a combination of nodes along a direction are resisted there.
        let row = |weights: &[(usize, f64)], direction: &SVector<f64, D>| {
            let mut row = BTreeMap::new();
            for &(node, weight) in weights.iter().filter(|w| body_of[w.0] != usize::MAX) {
                for (k, mode) in (count * body_of[node]..).zip(modes(node)) {
                    *row.entry(k).or_insert(0.0) += weight * mode.dot(direction);
                }
            }
            row
        };
        for k in 0..rows.tools.len() {
            for (j, mode) in modes(self.tool_node(rows.tools[k])).iter().enumerate() {
                if mode.norm() == 0.0 {
                    let own = BTreeMap::from([(count * (bodies.len() + k) + j, 1.0)]);
                    rows.add((Stopper::Displacement, usize::MAX, 0), &own);
                }
            }
        }
        for (dof, group) in held {
            let axis = SVector::from_fn(|i, _| f64::from(u8::from(i == dof % D)));
            let source = (Stopper::Displacement, group, dof % D);
            rows.add(source, &row(&[(dof / D, 1.0)], &axis));
        }
        for (c, (point, footing)) in self.points.iter().zip(&self.footings).enumerate() {
            let normal = match point.tool {
                Some(tool) => {
                    let at = |a: usize| match a < nodes {
                        true => self.position(a),
                        false => self.displacement(a),
                    };
                    let x = footing.relative(at);
                    self.tools[tool].obstacle.normal(&x)
                }
                None => match footing.plane(&SVector::zeros()) {
                    Some((normal, _)) => normal,
                    None => continue,
                },
            };
            let weights: Vec<(usize, f64)> = footing.weights().collect();
            let q = moreau_contact::frame(&normal);
            for k in 0..components(self, c) {
                let kind = match k {
                    0 => Stopper::Contact,
                    _ => Stopper::Friction,
                };
                let row = row(&weights, &q.column(k).into_owned());
                rows.add((kind, point.contact, 0), &row);
            }
        }
        rows
    }
}
