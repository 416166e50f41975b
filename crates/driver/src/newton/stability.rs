//! Whether an equilibrium is stable: the signs of the eigenvalues of its tangent on what the statuses of its
//! contacts leave free; not how the structure gives way.

use crate::driver::Driver;
use crate::interface::condensation::{InFrames, gives_way};
use crate::interface::elimination;
use crate::interface::free::Free;
use crate::interface::tied::{Held, Tied};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::{Kinematics, in_space};
use moreau_laws::{Local, Status};
use nalgebra::{DMatrix, DVector, SVector, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// A negative pivot below this part of the largest diagonal is rounding, and a motion without stiffness: of a body that
/// is held, and of one that may move as a rigid one, whose motions all terms of the stiffness cancel in.
const NONE: [f64; 2] = [1e-12, 1e-9];

/// Stiffness against a rigid motion, in parts of that of a node, below which it is rounding where nothing resists it.
const NEUTRAL: f64 = 1e-6;

impl<const D: usize> Driver<D> {
    /// Negative eigenvalues of the factorised tangent K on the displacements that statuses leave free: what is open
    /// moves as it will, what slips along its surface, what sticks not at all but by the spring of a penalty. By
    /// Haynsworth's law they are those of K_ii and those of S on the free directions of the interface, with S the
    /// stiffness condensed on it.
    ///
    /// Slip under friction has no symmetric tangent. Shears are taken for forces that stay what they are, which
    /// resist nothing: the tangent is that of a surface without friction that is loaded by them. But shears are opposite
    /// to the slip, which a surface that spins about its normal carries along. See [`Driver::spinning`].
    ///
    /// Where contacts are tied in the factor that counts itself, if its ties are those of the statuses; else they are
    /// made so, by one factorisation. Where that leaves a motion without stiffness, none is known and none is counted.
    pub(crate) fn negative_eigenvalues(
        &self,
        system: &mut System,
        loading: &Loading<D>,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
        held: &mut Held<D>,
    ) -> usize {
        if !self.has_large_strains() {
            return 0;
        }
        let moves_rigidly = system.floats && !self.is_held(loading, status);
        let (free, negative) = match system.is_tied() {
            true => {
                let holds = held.factor.holds_just(status)
                    || self.hold_statuses(system, (kinematics, status), held);
                (None, if holds { system.negative() } else { 0 })
            }
            false => {
                let free = self.free(system, kinematics, status);
                let none = NONE[usize::from(moves_rigidly)];
                let own = free.as_ref().map_or(0, |free| free.negative(none));
                (free, system.negative() + own)
            }
        };
        let negative = match moves_rigidly {
            true => self.not_rigid(system, free.as_ref(), negative),
            false => negative,
        };
        self.not_spinning(system, (kinematics, status), free.as_ref(), negative)
    }

    /// Negative eigenvalues of so many that are left where no body moves as a rigid one without stiffness: less those of
    /// rᵢ·K⁻¹ rⱼ, r the rigid motions, that are of rounding, by Haynsworth's law. What nothing resists is neutral, and of a
    /// body that is thin and bent its stiffness rounds to more than the least of those that are; in the factor that ties
    /// contacts it may round to just more than what counts as none.
    fn not_rigid(&self, system: &mut System, free: Option<&Free>, negative: usize) -> usize {
        let rows = match negative {
            0 => Vec::new(),
            _ => self.rigid_motions(),
        };
        let values = self.compliances_along(system, free, &rows);
        let softest = -1.0 / (NEUTRAL * system.shift());
        let neutral = values.map_or(0, |values| values.iter().filter(|c| **c < softest).count());
        negative.saturating_sub(neutral)
    }

    /// Translations and rotations of every body where it is now, each of unit length at all degrees of freedom.
    fn rigid_motions(&self) -> Vec<Vec<f64>> {
        let turns = [Vector3::z(), Vector3::x(), Vector3::y()];
        let mut all = Vec::new();
        for cells in self.mesh.bodies() {
            let nodes = cells.iter().flat_map(|&cell| self.mesh.cell_nodes(cell));
            let nodes: BTreeSet<usize> = nodes.copied().collect();
            let middle: SVector<f64, D> = nodes.iter().map(|&a| self.position(a)).sum();
            let middle = middle / nodes.len() as f64;
            let mut add = |motion: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>| {
                let mut row = DVector::zeros(self.state.displacement.len());
                for &a in &nodes {
                    let v = motion(&(self.position(a) - middle));
                    (0..D).for_each(|i| row[D * a + i] = v[i]);
                }
                all.extend(row.try_normalize(0.0).map(|row| row.as_slice().to_vec()));
            };
            for i in 0..D {
                add(&|_| SVector::from_fn(|k, _| f64::from(u8::from(k == i))));
            }
            for turn in &turns[..2 * D - 3] {
                add(&|x| {
                    let v = turn.cross(&in_space(x));
                    SVector::from_fn(|k, _| v[k])
                });
            }
        }
        all
    }

    /// Eigenvalues of rᵢ·K⁻¹ rⱼ, of rows r at every degree of freedom \[mm/N\]; `None` where there are no numbers.
    fn compliances_along(
        &self,
        system: &mut System,
        free: Option<&Free>,
        rows: &[Vec<f64>],
    ) -> Option<DVector<f64>> {
        if rows.is_empty() {
            return None;
        }
        let factor = free.and_then(Free::factor);
        let interface = free.zip(factor.as_ref());
        let answers = rows
            .iter()
            .map(|row| self.compliance(system, interface, row.clone()));
        let answers = answers.collect::<Option<Vec<_>>>()?;
        let entry = |i: usize, j: usize| answers[j].dot(&DVector::from_column_slice(&rows[i]));
        let compliance = DMatrix::from_fn(rows.len(), rows.len(), entry);
        Some(compliance.symmetric_eigen().eigenvalues)
    }

    /// Negative eigenvalues of so many that are left where no surface that slips under friction spins: less those of
    /// sᵢ·K⁻¹ sⱼ, s the spins, by Haynsworth's law again. With shears that do not turn with it a spin is unstable, however
    /// short the body; with those that do it is neutral, and friction resists it.
    fn not_spinning(
        &self,
        system: &mut System,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
        free: Option<&Free>,
        negative: usize,
    ) -> usize {
        if negative == 0 {
            return 0;
        }
        let spins = self.spins(system, (kinematics, status));
        let values = self.compliances_along(system, free, &spins);
        let unstable = values.map_or(0, |values| values.iter().filter(|c| **c < 0.0).count());
        negative.saturating_sub(unstable)
    }

    /// Of every contact in space, at every degree of freedom, the row that tells how far what slips of it under friction
    /// spins about its mean normal.
    pub(crate) fn spins(
        &self,
        system: &System,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
    ) -> Vec<Vec<f64>> {
        let mut contacts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, k) in kinematics.iter().enumerate() {
            if D == 3 && status[i] == Status::Slip && k.law.resists_slip() {
                contacts.entry(self.points[i].contact).or_default().push(i);
            }
        }
        let place = |i: usize| -> SVector<f64, D> {
            let own = self.footing.rows[i].own.iter();
            own.map(|&(a, w)| self.position(a) * w).sum()
        };
        let directions = &system.prescribed().directions;
        let spin = |slipping: Vec<usize>| {
            let normal: SVector<f64, D> = slipping
                .iter()
                .map(|&i| kinematics[i].axes.column(0).into_owned())
                .sum();
            let middle: SVector<f64, D> = slipping.iter().map(|&i| place(i)).sum();
            let middle = middle / slipping.len() as f64;
            let mut row = vec![0.0; self.state.displacement.len()];
            for i in slipping {
                let way = in_space(&normal).cross(&in_space(&(place(i) - middle)));
                let way = kinematics[i].local_force(&SVector::from_fn(|k, _| way[k]));
                for j in (1..D).filter(|&j| kinematics[i].active[j]) {
                    let own = (&self.footing.rows[i], directions);
                    for (dof, coefficient) in elimination::row(own, &kinematics[i], j, Some) {
                        row[dof] += way[j] * coefficient;
                    }
                }
            }
            row
        };
        let rows = contacts.into_values().map(spin);
        rows.filter(|row| row.iter().any(|s| *s != 0.0)).collect()
    }

    /// Ties the contacts as the statuses tell, springs of a penalty in series; false where that leaves a motion
    /// without stiffness.
    fn hold_statuses(
        &self,
        system: &mut System,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
        Held { rows, factor }: &mut Held<D>,
    ) -> bool {
        let rest = vec![0.0; self.state.displacement.len()];
        let springs = self.compliances(kinematics);
        let mut tied = Tied::new(self, system, kinematics, &rest, None, (rows, factor));
        tied.hold_statuses(status, |i| springs[i])
    }

    /// Compliances of the springs of a penalty in series with every contact, which ties have not \[mm/N\].
    pub(crate) fn compliances(&self, kinematics: &[Kinematics<D>]) -> Vec<Local<D>> {
        let method = self.settings.contact.springs();
        let compliance = method.map_or_else(Local::zeros, |(compliance, _)| compliance);
        let of = |k: &Kinematics<D>| match k.law.is_tie() {
            true => Local::zeros(),
            false => compliance,
        };
        kinematics.iter().map(of).collect()
    }

    /// What statuses leave free of a factorised system that is condensed; `None` without an interface.
    pub(crate) fn free(
        &self,
        system: &mut System,
        kinematics: &[Kinematics<D>],
        status: &[Status],
    ) -> Option<Free> {
        let stiffness = system.schur();
        if stiffness.is_empty() {
            return None;
        }
        let load = DVector::zeros(stiffness.nrows());
        let contacts = (self.points.as_slice(), self.footing.rows.as_slice());
        let rest = vec![Local::zeros(); kinematics.len()];
        let springs = self.compliances(kinematics);
        let given = (rest.as_slice(), springs.as_slice());
        let frames = InFrames::new(system, (stiffness, &load), contacts, kinematics, given).ok()?;
        let gives = |k: usize| {
            let (i, j) = (k / D, k % D);
            match kinematics[i].active[j] {
                true if gives_way(status[i], j) => Some(0.0),
                true if springs[i][j] > 0.0 => Some(1.0 / springs[i][j]),
                _ => None,
            }
        };
        Some(Free::new(frames, D * kinematics.len(), gives))
    }
}
