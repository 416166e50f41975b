//! Displacements that a step prescribes along directions of groups, put together node by node; not those along axes
//! alone.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::{Condition, Step, unit};
use crate::vector::directions::Directions;
use crate::vector::subspace::{PARALLEL, Subspace};
use nalgebra::SVector;
use std::collections::BTreeMap;

/// What is prescribed of the displacement u of a node: u·n for unit vectors n.
type Along<const D: usize> = Vec<(SVector<f64, D>, f64)>;

impl<const D: usize> Driver<D> {
    /// Prescribes the displacements of a step along directions, beside those `moved` along axes, by degree of freedom;
    /// returns the directions of nodes where these are not the axes.
    ///
    /// # Errors
    /// An unknown group, a direction without length; [`ModelError::DirectionAtAxis`];
    /// [`ModelError::ContradictingDisplacements`].
    pub(crate) fn displace_along(
        &self,
        step: &Step<D>,
        moved: &mut BTreeMap<usize, f64>,
    ) -> Result<Directions, ModelError> {
        let mut nodes: BTreeMap<usize, Along<D>> = BTreeMap::new();
        for condition in &step.conditions {
            let Condition::DisplaceAlong {
                on,
                direction,
                value,
            } = condition
            else {
                continue;
            };
            let n = unit(on, direction)?;
            for node in self.mesh.node_group(on)? {
                self.check_axis(step, (on, node), &n)?;
                nodes.entry(node).or_default().push((n, *value));
            }
        }
        let mut directions = Directions::default();
        for (node, along) in nodes {
            let held = (0..D).filter_map(|i| Some((axis(i), *moved.get(&(D * node + i))?)));
            let all: Along<D> = held.chain(along).collect();
            let (space, values) = combined(&all).map_err(|(n, first, second)| {
                ModelError::ContradictingDisplacements {
                    step: step.name.clone(),
                    node,
                    direction: n.iter().copied().collect(),
                    first,
                    second,
                    groups: self.prescribing(step, node),
                }
            })?;
            prescribe(node, &space, &values, (&mut directions, moved));
        }
        Ok(directions)
    }

    /// Groups whose displacements a step prescribes and that have a node, each once.
    pub(super) fn prescribing(&self, step: &Step<D>, node: usize) -> Vec<String> {
        let mut groups: Vec<String> = Vec::new();
        for condition in &step.conditions {
            let (Condition::Displace { on, .. } | Condition::DisplaceAlong { on, .. }) = condition
            else {
                continue;
            };
            let nodes = self.mesh.node_group(on).unwrap_or_default();
            if nodes.contains(&node) && !groups.contains(on) {
                groups.push(on.clone());
            }
        }
        groups
    }
}

fn axis<const D: usize>(i: usize) -> SVector<f64, D> {
    SVector::from_fn(|j, _| f64::from(u8::from(i == j)))
}

/// A vector that follows from others, the component of u along it that they make, and the one that it prescribes.
type Contradiction<const D: usize> = (SVector<f64, D>, f64, f64);

/// The space that unit vectors span, and the components of u along its basis; those along vectors that follow from others
/// must agree.
pub(super) fn is_axis<const D: usize>(n: &SVector<f64, D>) -> bool {
    n.iter().filter(|x| **x != 0.0).count() == 1
}

fn combined<const D: usize>(all: &Along<D>) -> Result<(Subspace<D>, Vec<f64>), Contradiction<D>> {
    let vectors: Vec<SVector<f64, D>> = all.iter().map(|(n, _)| *n).collect();
    let space = Subspace::spanned(&vectors);
    let largest = all.iter().fold(0.0, |m: f64, (_, u)| m.max(u.abs()));
    let mut values: Vec<f64> = Vec::new();
    for (n, u) in all {
        let known = space.vectors().zip(&values);
        let known: f64 = known.map(|(q, value)| q.dot(n) * value).sum();
        let next = space.vectors().nth(values.len()).map(|q| q.dot(n));
        match next.filter(|part| *part > PARALLEL) {
            Some(part) => values.push((u - known) / part),
            None if (u - known).abs() <= PARALLEL * largest => {}
            None => return Err((*n, known, *u)),
        }
    }
    Ok((space, values))
}

/// Prescribes the components of a node along the basis of a space: along axes where that is the same.
fn prescribe<const D: usize>(
    node: usize,
    space: &Subspace<D>,
    values: &[f64],
    (directions, moved): (&mut Directions, &mut BTreeMap<usize, f64>),
) {
    let known = || space.vectors().zip(values);
    if values.len() == D || space.vectors().all(|q| is_axis(&q)) {
        let u: SVector<f64, D> = known().map(|(q, value)| q * *value).sum();
        let held = |i: &usize| values.len() == D || known().any(|(q, _)| q[*i] != 0.0);
        moved.extend((0..D).filter(held).map(|i| (D * node + i, u[i])));
        return;
    }
    (0..D).for_each(|i| _ = moved.remove(&(D * node + i)));
    moved.extend(values.iter().enumerate().map(|(k, u)| (D * node + k, *u)));
    directions.turn(node, &space.basis);
}

#[cfg(test)]
mod tests {
    use super::*;

    type V = SVector<f64, 3>;

    #[test]
    fn independent_directions_in_space_say_all_and_others_must_agree() {
        let u = V::new(0.1, -0.2, 0.3);
        let along = |n: V| (n.normalize(), n.normalize().dot(&u));
        let mut all = vec![
            along(V::new(1.0, 1.0, 0.0)),
            along(V::new(0.0, 1.0, -2.0)),
            along(V::new(1.0, 2.0, -2.0)),
        ];
        let (space, values) = combined(&all).expect("the third follows from the others");
        assert_eq!((space.dimension(), values.len()), (2, 2));
        all.push(along(V::new(0.3, 0.0, 1.0)));
        let (space, values) = combined(&all).expect("agree");
        let mut moved = BTreeMap::new();
        let mut directions = Directions::default();
        prescribe(2, &space, &values, (&mut directions, &mut moved));
        assert_eq!(directions, Directions::default());
        assert!((0..3).all(|i| (moved[&(6 + i)] - u[i]).abs() < 1e-15));
        all[2].1 += 0.01;
        let (n, first, second) = combined(&all).expect_err("contradict");
        assert_eq!((n, second), (all[2].0, all[2].1));
        assert!((first - n.dot(&u)).abs() < 1e-15);
    }

    #[test]
    fn what_is_along_axes_is_that_of_axes() {
        let mut moved = BTreeMap::from([(3, 0.5)]);
        let mut directions = Directions::default();
        // Along x, and in the plane of x and y.
        let all = vec![(V::x(), 0.5), (V::new(-0.6, -0.8, 0.0), 0.1)];
        let (space, values) = combined(&all).expect("agree");
        prescribe(1, &space, &values, (&mut directions, &mut moved));
        assert_eq!(directions, Directions::default());
        assert_eq!(moved.keys().copied().collect::<Vec<_>>(), [3, 4]);
        assert!(moved[&3] == 0.5 && (moved[&4] + 0.5).abs() < 1e-15);
        // Turned round.
        let (space, values) = combined(&vec![(-V::z(), 0.25)]).expect("agree");
        prescribe(0, &space, &values, (&mut directions, &mut moved));
        assert_eq!((directions, moved[&2]), (Directions::default(), -0.25));
    }
}
