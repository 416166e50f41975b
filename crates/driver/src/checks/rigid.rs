//! Rigid modes of the bodies, and the rank of what resists them; not whose conditions those are.

use crate::driver::Driver;
use crate::model::load::{Loading, axis_letter};
use crate::model::points::in_space;
use nalgebra::{DMatrix, DVector, DVectorView, SVector};
use std::collections::BTreeMap;

/// What stops a rigid motion of a body, in the order in which they are counted on: each together
/// with those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stopper {
    /// Prescribed displacements.
    Displacement,
    /// Ties to other bodies.
    Tie,
    /// Contact normals, which push and do not pull.
    Contact,
    /// Friction, as far as it reaches.
    Friction,
}

/// Who resists: a condition of a step along an axis, or a contact.
pub(crate) type Source = (Stopper, usize, usize);

/// Eigenvalues of Σ a aᵀ below this part of the largest are rounding.
const SINGULAR: f64 = 1e-10;
/// Components of unit vectors below this are rounding.
pub(crate) const NOTHING: f64 = 1e-6;

/// Terms of the series of a rotation, which leave rounding of one by a quarter turn.
const TERMS: usize = 20;

/// Rigid modes of all bodies and what resists them.
pub(crate) struct Rows {
    /// First cell of each body.
    pub(crate) cells: Vec<usize>,
    /// Tools that forces or moments drive, bodies of their own after those of cells.
    pub(crate) tools: Vec<usize>,
    /// Modes of a body, of which the first are translations.
    pub(crate) modes: usize,
    translations: usize,
    /// Σ a aᵀ of each kind.
    gram: [DMatrix<f64>; 4],
    /// Σ a² on every mode, by source.
    pub(crate) effect: BTreeMap<Source, DVector<f64>>,
}

impl Rows {
    /// Adds what resists: a motion that moves the row is stopped.
    pub(crate) fn add(&mut self, source: Source, row: &BTreeMap<usize, f64>) {
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
    pub(crate) fn up_to(&self, stopper: Stopper) -> DMatrix<f64> {
        let kinds = self.gram[..=stopper as usize].iter();
        kinds.fold(self.gram[0].clone() * 0.0, |sum, g| sum + g)
    }

    /// Whether the modes of a body are stopped where these motions are free. Of rotations only
    /// whether the body turns counts, of translations those without a turn: then it does not
    /// matter about which point a body is said to turn.
    pub(crate) fn stopped(&self, body: usize, free: &DMatrix<f64>) -> Vec<bool> {
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

    /// A mode in words.
    pub(crate) fn name(&self, mode: usize) -> String {
        match mode {
            _ if self.modes == 1 => "translation along y".into(),
            k if k < self.translations => format!("translation along {}", axis_letter(k)),
            k if self.modes == 6 => format!("rotation about {}", axis_letter(k - 3)),
            _ => "rotation in the plane".into(),
        }
    }

    /// Independent free motions, each with the body that moves most.
    pub(crate) fn free(&self) -> Vec<(usize, String)> {
        let basis = reduced(null_space(&self.up_to(Stopper::Friction)));
        let motion = |mode: DVectorView<'_, f64>| {
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

/// The rigid modes of the bodies and of the tools that forces or moments drive.
pub(crate) struct RigidModes<'a, const D: usize> {
    driver: &'a Driver<D>,
    loading: &'a Loading<D>,
    /// First cell of each body.
    cells: Vec<usize>,
    tools: Vec<usize>,
    /// Number of the body of a node, the tools' among them; `usize::MAX` of a tool that is held.
    body_of: Vec<usize>,
    /// Middle of each body \[mm\].
    middle: Vec<[f64; D]>,
    /// Modes of a body.
    count: usize,
}

impl<'a, const D: usize> RigidModes<'a, D> {
    /// Where a loading prescribes displacements.
    pub(crate) fn new(driver: &'a Driver<D>, loading: &'a Loading<D>) -> Self {
        let mesh = &driver.mesh;
        let bodies = mesh.bodies();
        let mut body_of = vec![0; mesh.nodes().len()];
        for (b, cells) in bodies.iter().enumerate() {
            for &cell in cells {
                mesh.cell_nodes(cell)
                    .iter()
                    .for_each(|&node| body_of[node] = b);
            }
        }
        let mut limits = vec![([f64::INFINITY; D], [f64::NEG_INFINITY; D]); bodies.len()];
        for (&b, x) in body_of.iter().zip(mesh.nodes()) {
            let (low, high) = &mut limits[b];
            for i in 0..D {
                (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i]));
            }
        }
        let middle = limits
            .iter()
            .map(|(low, high)| std::array::from_fn(|i| 0.5 * (low[i] + high[i])))
            .collect();
        let first = |tool: usize| D * driver.tool_node(tool);
        let is_held = |dof: usize| loading.displacement.contains_key(&dof);
        let driven = |&k: &usize| {
            loading.axle_of(k).is_some() || (first(k)..first(k) + D).any(|dof| !is_held(dof))
        };
        let tools: Vec<usize> = (0..driver.tools.len()).filter(driven).collect();
        body_of.resize(mesh.nodes().len() + driver.tools.len(), usize::MAX);
        for (k, &tool) in tools.iter().enumerate() {
            body_of[driver.tool_node(tool)] = bodies.len() + k;
        }
        Self {
            count: driver.measure.rigid_modes(&[0.0; D]).len(),
            cells: bodies.iter().map(|cells| cells[0]).collect(),
            driver,
            loading,
            tools,
            body_of,
            middle,
        }
    }

    /// Motions of a node in the modes of its body: about the middle of the body, in the size of the mesh,
    /// which makes numbers of order one.
    fn at(&self, node: usize) -> Vec<SVector<f64, D>> {
        let mesh = &self.driver.mesh;
        if node >= mesh.nodes().len() {
            return self.of_tool(node);
        }
        let (x, middle) = (mesh.nodes()[node], self.middle[self.body_of[node]]);
        let relative = std::array::from_fn(|i| (x[i] - middle[i]) / mesh.size());
        let modes = self.driver.measure.rigid_modes(&relative);
        modes.into_iter().map(SVector::from).collect()
    }

    /// Motions of a node of the mesh in combinations of the modes of all bodies, in columns.
    pub(crate) fn of_node(&self, node: usize, combinations: &DMatrix<f64>) -> Vec<SVector<f64, D>> {
        let modes = self.at(node);
        let first = self.count * self.body_of[node];
        let motion = |column: DVectorView<'_, f64>| {
            let all = modes.iter().enumerate();
            all.map(|(k, mode)| mode * column[first + k]).sum()
        };
        combinations.column_iter().map(motion).collect()
    }

    /// The way of a node of the mesh that is at a place now \[mm\], where a motion in the modes of all bodies turns them as
    /// far as it says: about the axis of its rotations, and not along its tangent.
    pub(crate) fn way(
        &self,
        node: usize,
        place: &SVector<f64, D>,
        motion: &DVector<f64>,
    ) -> SVector<f64, D> {
        let body = self.body_of[node];
        let own: Vec<f64> = (motion.rows(self.count * body, self.count).iter().copied()).collect();
        let arm = place - SVector::from(self.middle[body]);
        let modes = |x: &[f64; D]| self.driver.measure.rigid_modes(x);
        carried(&modes, &own, (arm, self.driver.mesh.size()))
    }

    /// The number of the mode in which a moment turns a tool, in place of the rotation about the nearest of the axes.
    fn turn_of(&self, tool: usize) -> Option<usize> {
        let axle = self.loading.axle_of(tool)?;
        let rotations = self
            .count
            .checked_sub(D)
            .filter(|&rotations| rotations > 0)?;
        Some(D + axle.iamax().min(rotations - 1))
    }

    /// What the turn of a tool by a moment moves a place of it along a direction, by the number of the mode; a place
    /// relative to where the tool has moved.
    pub(crate) fn turning(
        &self,
        tool: usize,
        place: &SVector<f64, D>,
        direction: &SVector<f64, D>,
    ) -> Option<(usize, f64)> {
        let body = self.tools.iter().position(|&k| k == tool)?;
        let (mode, axle) = (self.turn_of(tool)?, self.loading.axle_of(tool)?);
        let arm = in_space(&(place - self.driver.tools[tool].reference));
        let way = axle.cross(&arm) / self.driver.mesh.size();
        let number = self.count * (self.cells.len() + body) + mode;
        Some((number, way.dot(&in_space(direction))))
    }

    /// A tool moves only where it is driven, and its turn is that of no node.
    fn of_tool(&self, node: usize) -> Vec<SVector<f64, D>> {
        let is_held = |i: usize| self.loading.displacement.contains_key(&(D * node + i));
        let free = |i: usize, u: f64| if is_held(i) { 0.0 } else { u };
        let modes = self.driver.measure.rigid_modes(&[0.0; D]).into_iter();
        modes
            .map(|m| SVector::from_fn(|i, _| free(i, m[i])))
            .collect()
    }

    /// What a combination of nodes moves along a direction in each mode.
    pub(crate) fn row(
        &self,
        weights: &[(usize, f64)],
        direction: &SVector<f64, D>,
    ) -> BTreeMap<usize, f64> {
        let mut row = BTreeMap::new();
        let bodies = weights
            .iter()
            .map(|&(node, w)| (node, w, self.body_of[node]));
        for (node, weight, body) in bodies.filter(|b| b.2 != usize::MAX) {
            for (k, mode) in (self.count * body..).zip(self.at(node)) {
                *row.entry(k).or_insert(0.0) += weight * mode.dot(direction);
            }
        }
        row
    }

    /// Rows to begin with: they stop the modes that tools do not have.
    pub(crate) fn rows(&self) -> Rows {
        let all = self.count * (self.cells.len() + self.tools.len());
        let mut rows = Rows {
            cells: self.cells.clone(),
            tools: self.tools.clone(),
            modes: self.count,
            translations: self.count.min(D),
            gram: std::array::from_fn(|_| DMatrix::zeros(all, all)),
            effect: BTreeMap::new(),
        };
        for (k, &tool) in self.tools.iter().enumerate() {
            let first = self.count * (self.cells.len() + k);
            let modes = self.of_tool(self.driver.tool_node(tool));
            let turn = self.turn_of(tool);
            let has = |j: usize, m: &SVector<f64, D>| m.norm() > 0.0 || Some(j) == turn;
            for (j, _) in modes.iter().enumerate().filter(|(j, m)| !has(*j, m)) {
                let own = BTreeMap::from([(first + j, 1.0)]);
                rows.add((Stopper::Displacement, usize::MAX, 0), &own);
            }
        }
        rows
    }
}

/// The way of a place at the end of an arm from the middle of its body \[mm\] in a motion in the rigid modes, those of
/// arms over a size \[mm\], which turns the body as far as it says: about the axis of its rotations, and not along
/// its tangent.
fn carried<const D: usize>(
    modes: &dyn Fn(&[f64; D]) -> Vec<[f64; D]>,
    motion: &[f64],
    (arm, size): (SVector<f64, D>, f64),
) -> SVector<f64, D> {
    let sum = |arm: &SVector<f64, D>, own: std::ops::Range<usize>| -> SVector<f64, D> {
        let modes = modes(&(*arm).into());
        let own = own.start..own.end.min(modes.len());
        own.map(|k| SVector::from(modes[k]) * motion[k]).sum()
    };
    let mut arm = arm / size;
    let mut way = sum(&arm, 0..D);
    // exp(S) r = r + S r + S² r/2 + …, S r the rotation over the size.
    for order in 1..=TERMS {
        let turned = sum(&arm, D..usize::MAX) / order as f64;
        way += turned;
        arm = turned / size;
    }
    way
}

/// An orthonormal basis, in columns, of what a symmetric matrix with no negative eigenvalues takes
/// to zero.
pub(crate) fn null_space(matrix: &DMatrix<f64>) -> DMatrix<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_mesh::{Hypothesis, PlaneStrain, Solid};
    use proptest::prelude::*;

    /// Places of a body keep their distances, and go along the modes where the motion is small.
    fn check<const D: usize, H: Hypothesis<D>>(motion: &[f64]) -> Result<(), TestCaseError> {
        // The largest turn is little more than a quarter.
        let size = 3.0;
        let corner = |k: usize| SVector::from_fn(|i, _| ((k >> i) & 1) as f64 * (1.0 + i as f64));
        let places: Vec<SVector<f64, D>> = (0..1 << D).map(corner).collect();
        let moved = |part: f64| -> Vec<SVector<f64, D>> {
            let motion: Vec<f64> = motion.iter().map(|q| q * part).collect();
            let way = |arm: &SVector<f64, D>| carried(&H::rigid_modes, &motion, (*arm, size));
            places.iter().map(way).collect()
        };
        let (large, little) = (moved(1.0), moved(1e-6));
        for (a, x) in places.iter().enumerate() {
            let modes = H::rigid_modes(&(x / size).into());
            let along = modes.iter().zip(motion);
            let linear: SVector<f64, D> = along.map(|(mode, q)| SVector::from(*mode) * *q).sum();
            prop_assert!((little[a] / 1e-6 - linear).norm() < 1e-4, "{}", linear);
            for (b, y) in places.iter().enumerate() {
                let (before, after) = ((x - y).norm(), (x + large[a] - y - large[b]).norm());
                prop_assert!((before - after).abs() < 1e-12, "{before} {after}");
            }
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn a_body_is_carried_without_a_strain(q in prop::array::uniform6(-3.0..3.0f64)) {
            check::<2, PlaneStrain>(&q[..3])?;
            check::<3, Solid>(&q)?;
        }
    }
}
