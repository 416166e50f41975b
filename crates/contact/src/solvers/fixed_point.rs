//! The fixed-point iteration t ← T(t) on u = W t + q, extrapolated; not the maps.

use super::Anderson;
use crate::LocalProblem;
use crate::problem::{split, stack};
use moreau_laws::Local;

/// Iterates from `start` until `judge` says what has come of it, from the number of images before this
/// one, the forces and their displacements.
pub(super) fn fixed_point<const D: usize, E>(
    problem: &LocalProblem<D>,
    start: Vec<Local<D>>,
    mut map: impl FnMut(Vec<Local<D>>) -> Vec<Local<D>>,
    mut judge: impl FnMut(usize, &[Local<D>], &[Local<D>]) -> Option<E>,
) -> E {
    let mut anderson = Anderson::default();
    let mut t = stack(&start);
    let mut iterations = 0;
    loop {
        let image = map(split(&t));
        let u = problem.displacement(&image);
        if let Some(end) = judge(iterations, &image, &u) {
            return end;
        }
        t = anderson.next(&t, stack(&image));
        iterations += 1;
    }
}
