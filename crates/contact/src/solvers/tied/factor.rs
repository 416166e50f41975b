//! The factor that an iteration goes through: its ties, the answers it has given, and when a new one pays.

use super::recycled::Recycled;
use super::{At, Guess, Tied};
use crate::ContactError;
use crate::problem::{split, stack};
use moreau_laws::{Local, Status};
use nalgebra::{DVector, SMatrix};
use std::collections::BTreeSet;

/// Ties over the stiffness of a contact: from here to a million times an iteration takes nearly the same
/// steps, and forces round off in proportion.
const TIGHT: f64 = 1e3;

/// Part of a solve since the factorisation that counts against the factor: it tells that the ties are not
/// those of the statuses, but its answer is there.
const SPENT: f64 = 0.3;

/// Ties of a factor, and the answers it has given. Nothing of both by default.
#[derive(Debug)]
pub struct TiedFactor<const D: usize> {
    pub(super) ties: Vec<SMatrix<f64, D, D>>,
    /// The statuses that the ties are of.
    status: Vec<Status>,
    /// What is tied beyond its status.
    pub(super) propped: Vec<usize>,
    /// Solves since the factorisation, other than those of units.
    pub(super) used: usize,
    pub(super) pairs: Recycled,
    /// Components of which the answer to a unit is among the pairs.
    units: BTreeSet<usize>,
}

impl<const D: usize> Default for TiedFactor<D> {
    fn default() -> Self {
        Self {
            ties: Vec::new(),
            status: Vec::new(),
            propped: Vec::new(),
            used: 0,
            pairs: Recycled::default(),
            units: BTreeSet::new(),
        }
    }
}

impl<const D: usize> TiedFactor<D> {
    /// The ties R of every contact; empty where nothing is factorised.
    pub fn ties(&self) -> &[SMatrix<f64, D, D>] {
        &self.ties
    }

    /// Whether its ties are those of statuses.
    fn serves(&self, status: &[Status]) -> bool {
        !self.ties.is_empty() && self.status == status
    }

    /// Whether its ties hold what statuses hold, and nothing else: not across the direction of slip either.
    pub fn holds_just(&self, status: &[Status]) -> bool {
        let along = |(tie, status): (&SMatrix<f64, D, D>, &Status)| match status {
            Status::Slip => tie.fixed_columns::<1>(0).norm() == tie.norm(),
            _ => true,
        };
        let mut pairs = self.ties.iter().zip(status);
        self.serves(status) && self.propped.is_empty() && pairs.all(along)
    }

    /// Whether it has answered anything since it was made.
    pub(super) fn is_used(&self) -> bool {
        self.pairs.len() > 0
    }
}

impl<const D: usize> Tied<'_, '_, D> {
    /// The ties of a status at (u, t).
    fn tie(&self, i: usize, status: Status, u: &Local<D>, t: &Local<D>) -> SMatrix<f64, D, D> {
        let tight = TIGHT * self.problem.structure.stiffness(i);
        let mut tie = match status {
            Status::Open => return SMatrix::zeros(),
            Status::Stick | Status::Tied => SMatrix::identity() * tight,
            Status::Slip => {
                let mut across = SMatrix::<f64, D, D>::zeros();
                across[(0, 0)] = tight;
                let (mut slip, mut shear) = (*u, *t);
                (slip[0], shear[0]) = (0.0, 0.0);
                let (length, force) = (slip.norm(), shear.norm());
                if D == 3 && force > 0.0 && length > 0.0 {
                    let d = slip / length;
                    let stiffness = (force / length).min(tight);
                    for j in 1..D {
                        for k in 1..D {
                            let one = f64::from(u8::from(j == k));
                            across[(j, k)] += stiffness * (one - d[j] * d[k]);
                        }
                    }
                }
                across
            }
        };
        let compliance = &self.problem.springs[i].compliance;
        if compliance.amax() > 0.0 {
            // In series with the springs: R (1 + C R)⁻¹.
            let series = SMatrix::identity() + SMatrix::from_diagonal(compliance) * tie;
            tie = series.try_inverse().map_or(tie, |inverse| tie * inverse);
            tie = (tie + tie.transpose()) * 0.5;
        }
        tie
    }

    /// Factorises with the ties of statuses at (u, t). Where that leaves the structure free to move, what
    /// slips and the smallest gaps are tied as what sticks.
    fn factorise(
        &mut self,
        status: &[Status],
        (u, t): (&[Local<D>], &[Local<D>]),
    ) -> Result<(), ContactError> {
        let count = status.len();
        self.factor = TiedFactor {
            ties: (0..count)
                .map(|i| self.tie(i, status[i], &u[i], &t[i]))
                .collect(),
            status: status.to_vec(),
            ..TiedFactor::default()
        };
        let is_loose = |&i: &usize| !matches!(status[i], Status::Stick | Status::Tied);
        let mut loose: Vec<usize> = (0..count).filter(is_loose).collect();
        loose.sort_by(|&a, &b| u[a][0].total_cmp(&u[b][0]));
        let mut more = 3 * D;
        let mut loose = loose.into_iter();
        self.solves += self.problem.structure.worth() as usize;
        while !self.problem.structure.tie(&self.factor.ties) {
            let mut some = loose.by_ref().take(more).peekable();
            if some.peek().is_none() {
                return Err(ContactError::Singular);
            }
            for i in some {
                let tight = TIGHT * self.problem.structure.stiffness(i);
                self.factor.ties[i] = SMatrix::identity() * tight;
                self.factor.propped.push(i);
            }
            more *= 4;
        }
        Ok(())
    }

    /// Where the ties of a guess lead, through the factor at hand where that has them; what had to be tied beyond
    /// the guess is closed in it as well.
    pub(super) fn begin(&mut self, guess: &mut Guess<D>) -> Result<At<D>, ContactError> {
        let (u, t) = (&guess.irreversible, &guess.t);
        let status: Vec<Status> = (0..u.len())
            .map(|i| self.problem.friction[i].status(&u[i], &t[i], self.alpha(i)))
            .collect();
        if self.factor.serves(&status) {
            self.factor.used = 0;
        } else {
            self.factorise(&status, (u, t))?;
        }
        for &i in &self.factor.propped {
            if status[i] == Status::Open {
                guess.close(i);
            }
        }
        let moved = guess.u.iter().zip(&self.problem.origin);
        let moved: Vec<Local<D>> = moved.map(|(u, g)| u - g).collect();
        Ok(self.follow(&guess.t, &moved))
    }

    /// A new factor, with the ties of now.
    pub(super) fn renew(&mut self, now: At<D>, status: &[Status]) -> Result<At<D>, ContactError> {
        self.factorise(status, (&now.u, &now.t))?;
        Ok(self.follow(&now.t, &split::<D>(&now.v)))
    }

    /// Where z = t + R v leads.
    fn follow(&mut self, t: &[Local<D>], v: &[Local<D>]) -> At<D> {
        let pairs = t.iter().zip(v).zip(&self.factor.ties);
        let z: Vec<Local<D>> = pairs.map(|((t, v), tie)| t + tie * v).collect();
        self.answered(stack(&z))
    }

    /// The iterate at z, solved for.
    pub(super) fn answered(&mut self, z: DVector<f64>) -> At<D> {
        self.factor.used += 1;
        self.solves += 1;
        let v = self.problem.structure.displacement(&z, true);
        self.at(z, v)
    }

    /// How many statuses are not those of the ties.
    pub(super) fn stale(&self, status: &[Status]) -> usize {
        let pairs = status.iter().zip(&self.factor.status);
        pairs.filter(|(a, b)| a != b).count()
    }

    /// Makes up for what the ties lack of statuses: by the answers to unit forces where they lack it, which the
    /// equations of a step then make the best of, or by a new factor where that costs less.
    pub(super) fn serve(&mut self, now: At<D>, status: &[Status]) -> Result<At<D>, ContactError> {
        if self.stale(status) == 0 {
            return Ok(now);
        }
        let lacking = self.lacking(&now, status);
        let structure = &self.problem.structure;
        let units = (self.factor.units.len() + lacking.len()) as f64;
        let spent = SPENT * self.factor.used as f64 + units * structure.together();
        if spent >= structure.worth() {
            return self.renew(now, status);
        }
        let size = D * status.len();
        let unit = |&k: &usize| DVector::from_fn(size, |i, _| f64::from(u8::from(i == k)));
        let forces: Vec<DVector<f64>> = lacking.iter().map(unit).collect();
        self.solves += forces.len();
        let answers = self.problem.structure.displacements(&forces);
        for (force, answer) in forces.into_iter().zip(answers) {
            self.factor.pairs.add(force, answer);
        }
        self.factor.units.extend(lacking);
        Ok(now)
    }

    /// Components in which the ties are not those of statuses, and of which no unit is answered.
    fn lacking(&self, now: &At<D>, status: &[Status]) -> Vec<usize> {
        let factor = &self.factor;
        let stale = (0..status.len()).filter(|&i| status[i] != factor.status[i]);
        let components = stale.flat_map(|i| {
            let tie = self.tie(i, status[i], &now.irreversible[i], &now.t[i]);
            let change = tie - factor.ties[i];
            (0..D).filter_map(move |k| (change.row(k).amax() > 0.0).then_some(D * i + k))
        });
        components.filter(|k| !factor.units.contains(k)).collect()
    }
}
