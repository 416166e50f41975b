//! Which contacts may bear in a linearised increment; the others are left out of its problem and looked at
//! afterwards, so that what is found is a solution of all.

use crate::model::points::Kinematics;
use moreau_contact::ContactSolution;
use moreau_laws::{Local, Status};

/// How many of the others are kept for each contact that bears: those with the smallest gaps.
const BESIDE: usize = 2;

/// How many are kept besides, where few bear.
const AT_LEAST: usize = 16;

/// Part of the contacts from which on none is left out: to look at the others would cost more than it saves.
const MOST: f64 = 0.5;

/// Contacts that bore at the start of the step or in the last solution, that overlap or are tied, and those with the smallest
/// gaps beside them; `None` if that is most of them.
pub(crate) fn nearby<const D: usize>(
    kinematics: &[Kinematics<D>],
    (previous, last): (&[Local<D>], &[Local<D>]),
) -> Option<Vec<usize>> {
    let presses = |t: &Local<D>| t.amax() > 0.0;
    let bears = |c: usize| {
        let k = &kinematics[c];
        let is_tied = k.law.status(&k.u, &Local::zeros(), 1.0) == Status::Tied;
        is_tied
            || k.known_slip.is_some()
            || presses(&previous[c])
            || presses(&last[c])
            || k.u[0] <= 0.0
    };
    let (mut kept, mut others): (Vec<usize>, Vec<usize>) =
        (0..kinematics.len()).partition(|&c| bears(c));
    let beside = BESIDE * kept.len() + AT_LEAST;
    if !are_few(kept.len() + beside, kinematics.len()) {
        return None;
    }
    others.sort_by(|&a, &b| kinematics[a].u[0].total_cmp(&kinematics[b].u[0]));
    kept.extend(others.into_iter().take(beside));
    kept.sort_unstable();
    Some(kept)
}

/// Whether the problem of so many of all contacts is worth being solved alone.
pub(crate) fn are_few(kept: usize, all: usize) -> bool {
    (kept as f64) < MOST * all as f64
}

/// Contacts that are left out, by their motions u − u_now, for which being without force is no solution; forces and
/// displacements are compared by a stiffness \[N/mm\].
pub(crate) fn closing<const D: usize>(
    kinematics: &[Kinematics<D>],
    left_out: &[(usize, Local<D>)],
    stiffness: f64,
) -> Vec<usize> {
    let closes = |(c, motion): &(usize, Local<D>)| {
        let k = &kinematics[*c];
        let map = k
            .law
            .natural_map(&(k.u + motion), &Local::zeros(), stiffness);
        // What is no number closes too.
        map.iter().any(|&m| m != 0.0).then_some(*c)
    };
    left_out.iter().filter_map(closes).collect()
}

/// The part of a solution that is of some contacts.
pub(crate) fn part<const D: usize>(
    solution: &ContactSolution<D>,
    among: &[usize],
) -> ContactSolution<D> {
    let of = |all: &[Local<D>]| among.iter().map(|&c| all[c]).collect();
    ContactSolution {
        displacement: of(&solution.displacement),
        motion: of(&solution.motion),
        irreversible: of(&solution.irreversible),
        force: of(&solution.force),
        status: among.iter().map(|&c| solution.status[c]).collect(),
        ..*solution
    }
}

/// The solution of all contacts: of those of the problem, and of those that are left out, by their motions.
pub(crate) fn whole<const D: usize>(
    kinematics: &[Kinematics<D>],
    (among, own): (&[usize], &ContactSolution<D>),
    left_out: &[(usize, Local<D>)],
) -> ContactSolution<D> {
    let zero = || vec![Local::zeros(); kinematics.len()];
    let mut all = ContactSolution {
        displacement: zero(),
        motion: zero(),
        irreversible: zero(),
        force: zero(),
        status: vec![Status::Open; kinematics.len()],
        ..*own
    };
    for (i, &c) in among.iter().enumerate() {
        all.displacement[c] = own.displacement[i];
        all.motion[c] = own.motion[i];
        all.irreversible[c] = own.irreversible[i];
        all.force[c] = own.force[i];
        all.status[c] = own.status[i];
    }
    for &(c, motion) in left_out {
        all.motion[c] = motion;
        all.displacement[c] = kinematics[c].u + motion;
        all.irreversible[c] = all.displacement[c];
    }
    all
}
