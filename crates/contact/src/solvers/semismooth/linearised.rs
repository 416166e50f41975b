//! The linear equations of a Newton step on the natural map; not the map.

use crate::CondensedProblem;
use moreau_algebra::{DenseCholesky, Lu, transposed_product};
use moreau_laws::Local;
use nalgebra::{DMatrix, DVector, SMatrix};

/// The linearised map of one contact: E S_i du + A du_i = −G_i, with the D rows S_i of the stiffness.
pub(super) struct Row<const D: usize> {
    /// E, dimensionless.
    pub(super) elastic: SMatrix<f64, D, D>,
    /// A \[N/mm\].
    pub(super) shift: SMatrix<f64, D, D>,
    /// −G \[N\].
    pub(super) value: Local<D>,
}

/// Pivots below this part of the largest are rounding of a stiffness that was condensed, and a rigid
/// motion.
const RIGID: f64 = 1e-13;

/// Part of an E at most 1 below which it is rounding.
const NONE: f64 = 1e-14;

/// The step du \[mm\] that solves the rows of all contacts; `None` where they are singular.
///
/// Where a contact sticks E is zero, and where it slips E has not full rank: some combinations of its
/// rows bind its own components only. They are answered first; what is left is as small as the open
/// contacts with all, and the slipping ones with their tangential components, make it.
pub(super) fn solve<const D: usize>(
    problem: &CondensedProblem<D>,
    rows: Vec<Row<D>>,
) -> Option<DVector<f64>> {
    let s = problem.stiffness();
    let n = s.nrows();
    let own: Vec<Own<D>> = rows.into_iter().map(Own::new).collect::<Option<_>>()?;
    let fixed = DVector::from_iterator(n, own.iter().flat_map(|o| (0..D).map(|k| o.fixed[k])));
    // What the rows see of the components that are known.
    let mut known = DVector::zeros(n);
    for (column, &u) in s.column_iter().zip(&fixed).filter(|(_, u)| **u != 0.0) {
        known.axpy(u, &column, 1.0);
    }
    // Contacts whose rows are those of S along their own directions first: their block is symmetric.
    let (symmetric, others): (Vec<usize>, Vec<usize>) =
        (0..own.len()).partition(|&i| own[i].is_symmetric());
    let order: Vec<usize> = symmetric.iter().chain(&others).copied().collect();
    let first = symmetric.iter().map(|&i| own[i].left).sum();
    let equations = || Equations::new(s, &own, (&order, first));
    let mut value = DVector::zeros(own.iter().map(|o| o.left).sum());
    let mut row = 0;
    for &i in &order {
        let (o, known) = (&own[i], known.fixed_rows::<D>(D * i));
        for r in 0..o.left {
            let seen = (0..D).map(|k| o.elastic[(r, k)] * known[k] + o.shift[(r, k)] * o.fixed[k]);
            value[row] = o.value[r] - seen.sum::<f64>();
            row += 1;
        }
    }
    let solved = (first > 0).then(|| equations().eliminated(&value));
    let solved = solved.flatten().or_else(|| {
        let mut lu = Lu::new(equations().whole()).filter(|lu| lu.least_pivot > RIGID)?;
        Some(lu.solve(value))
    })?;
    let mut step = fixed;
    let mut next = 0;
    for &i in &order {
        let o = &own[i];
        let mut own = step.fixed_rows_mut::<D>(D * i);
        for direction in o.free.column_iter().take(o.left) {
            own.axpy(solved[next], &direction, 1.0);
            next += 1;
        }
    }
    step.iter().all(|v| v.is_finite()).then_some(step)
}

/// The matrix of the rows that are left, contact by contact in an order, in the unknowns of the same.
struct Equations {
    /// That of the first unknowns, which is symmetric: its lower triangle.
    block: DMatrix<f64>,
    /// That of the first unknowns in the rows of the others, transposed.
    down: DMatrix<f64>,
    /// That of the others, in all rows.
    others: DMatrix<f64>,
}

impl Equations {
    /// Of contacts in an order, of which the first with so many unknowns are symmetric.
    fn new<const D: usize>(
        s: &DMatrix<f64>,
        own: &[Own<D>],
        (order, first): (&[usize], usize),
    ) -> Self {
        // E of every row and where its contact is, or where the one component of which it is.
        let row = |i: usize| {
            (0..own[i].left).map(move |r| {
                let e: [f64; D] = std::array::from_fn(|k| own[i].elastic[(r, k)]);
                match only(&e) {
                    Some(k) => (D * i + k, None),
                    None => (D * i, Some(e)),
                }
            })
        };
        let rows: Vec<_> = order.iter().flat_map(|&i| row(i)).collect();
        let mut new = Self {
            block: DMatrix::zeros(first, first),
            down: DMatrix::zeros(first, rows.len() - first),
            others: DMatrix::zeros(rows.len(), rows.len() - first),
        };
        let mut combined = DVector::zeros(s.nrows());
        let entries = |k: usize| &s.as_slice()[k * s.nrows()..][..s.nrows()];
        let mut column = 0;
        for &j in order {
            let (o, begin) = (&own[j], column);
            for direction in o.free.column_iter().take(o.left) {
                let answer = match only(direction.as_slice()) {
                    Some(k) => entries(D * j + k),
                    None => {
                        combined.copy_from(&s.column(D * j));
                        combined *= direction[0];
                        for k in (1..D).filter(|&k| direction[k] != 0.0) {
                            combined.axpy(direction[k], &s.column(D * j + k), 1.0);
                        }
                        combined.as_slice()
                    }
                };
                let seen = |(at, e): &(usize, Option<[f64; D]>)| -> f64 {
                    match e {
                        None => answer[*at],
                        Some(e) => e.iter().zip(&answer[*at..]).map(|(e, s)| e * s).sum(),
                    }
                };
                if column < first {
                    let mut block = new.block.column_mut(column);
                    let entries = block.iter_mut().zip(&rows[..first]);
                    entries
                        .skip(column)
                        .for_each(|(entry, row)| *entry = seen(row));
                    let mut down = new.down.row_mut(column);
                    let entries = down.iter_mut().zip(&rows[first..]);
                    entries.for_each(|(entry, row)| *entry = seen(row));
                } else {
                    let mut others = new.others.column_mut(column - first);
                    let entries = others.iter_mut().zip(&rows);
                    entries.for_each(|(entry, row)| *entry = seen(row));
                    let alone = o.shift * direction;
                    for r in 0..o.left {
                        others[begin + r] += alone[r];
                    }
                }
                column += 1;
            }
        }
        new
    }

    fn whole(&self) -> DMatrix<f64> {
        let (size, first) = (self.others.nrows(), self.block.nrows());
        DMatrix::from_fn(size, size, |i, j| match (i < first, j < first) {
            (_, false) => self.others[(i, j - first)],
            (true, true) => self.block[(i.max(j), i.min(j))],
            (false, true) => self.down[(j, i - first)],
        })
    }

    /// x by Cholesky's factor of the symmetric block and the L U of what it leaves of the others; `None` if there is none,
    /// or if what is left is singular beside it.
    fn eliminated(self, b: &DVector<f64>) -> Option<DVector<f64>> {
        let first = self.block.nrows();
        let rest = b.len() - first;
        let stiffest = self.block.diagonal().amax();
        let factor = DenseCholesky::new(self.block).filter(|f| f.holds(stiffest))?;
        let mut x = b.rows(0, first).into_owned();
        factor.forward_one(&mut x);
        if rest == 0 {
            factor.backward_one(&mut x);
            return Some(x);
        }
        let mut across = self.others.rows(0, first).into_owned();
        let mut down = self.down;
        factor.forward(&mut across);
        factor.forward(&mut down);
        let left = self.others.rows(first, rest) - transposed_product(&down, &across);
        let mut lu = Lu::new(left).filter(|lu| {
            let least = lu.least_pivot * lu.largest_pivot;
            least > RIGID * stiffest.max(lu.largest_pivot)
        })?;
        let y = lu.solve(b.rows(first, rest) - down.tr_mul(&x));
        x -= across * &y;
        factor.backward_one(&mut x);
        let all = x.iter().chain(y.iter()).copied();
        Some(DVector::from_iterator(first + rest, all))
    }
}

/// The component that a vector is the unit vector of, if it is one.
fn only(vector: &[f64]) -> Option<usize> {
    let mut others = vector.iter().enumerate().filter(|(_, x)| **x != 0.0);
    let (k, x) = others.next()?;
    (*x == 1.0 && others.next().is_none()).then_some(k)
}

/// Components of a contact at most, in the plane and in space.
const MOST: usize = 3;

/// A row E | A | −G of a contact, with room for [`MOST`] components of each.
type Wide = [f64; 2 * MOST + 1];

/// The rows of a contact that need the others, in front, and its displacement as
/// du = fixed + Σ free · unknown.
struct Own<const D: usize> {
    elastic: SMatrix<f64, D, D>,
    shift: SMatrix<f64, D, D>,
    value: Local<D>,
    /// How many rows are left, and unknowns.
    left: usize,
    fixed: Local<D>,
    /// Directions of the unknowns, in the first columns.
    free: SMatrix<f64, D, D>,
}

impl<const D: usize> Own<D> {
    /// `None` if the rows that bind the contact alone are singular.
    fn new(row: Row<D>) -> Option<Self> {
        let mut rows: [Wide; D] = std::array::from_fn(|i| {
            let mut wide = [0.0; 2 * MOST + 1];
            for j in 0..D {
                wide[j] = row.elastic[(i, j)];
                wide[MOST + j] = row.shift[(i, j)];
            }
            wide[2 * MOST] = row.value[i];
            wide
        });
        let pivots = eliminate(&mut rows, 0, NONE, false);
        let left = pivots.len();
        let (rest, alone) = rows.split_at_mut(left);
        // In the order of the components, as the unknowns are.
        let mut order: Vec<usize> = (0..left).collect();
        order.sort_by_key(|&i| pivots[i]);
        let bound = eliminate(alone, MOST, NONE * row.shift.amax(), true);
        if bound.len() < alone.len() {
            return None;
        }
        let mut fixed = Local::zeros();
        let mut free = SMatrix::zeros();
        let mut next = 0;
        for j in 0..D {
            if !bound.contains(&(MOST + j)) {
                free[(j, next)] = 1.0;
                for (row, &pivot) in alone.iter().zip(&bound) {
                    free[(pivot - MOST, next)] = -row[MOST + j] / row[pivot];
                }
                next += 1;
            }
        }
        for (row, &pivot) in alone.iter().zip(&bound) {
            fixed[pivot - MOST] = row[2 * MOST] / row[pivot];
        }
        let entry = |i: usize, column: usize| order.get(i).map_or(0.0, |&i| rest[i][column]);
        Some(Self {
            elastic: SMatrix::from_fn(entry),
            shift: SMatrix::from_fn(|i, j| entry(i, MOST + j)),
            value: Local::from_fn(|i, _| entry(i, 2 * MOST)),
            left,
            fixed,
            free,
        })
    }

    /// Whether its rows are those of the stiffness along its own unknowns, as where it is open or slips without
    /// friction.
    fn is_symmetric(&self) -> bool {
        let own = |r: usize| {
            (0..D).all(|k| self.elastic[(r, k)] == self.free[(k, r)] && self.shift[(r, k)] == 0.0)
        };
        (0..self.left).all(own)
    }
}

/// Gaussian elimination in the [`MOST`] columns from `first` on, each time by the largest entry left
/// until none is above `none`; in the rows before, too, if asked for. Returns the columns of the
/// pivots, row by row.
fn eliminate(rows: &mut [Wide], first: usize, none: f64, before: bool) -> Vec<usize> {
    let mut pivots = Vec::with_capacity(rows.len());
    for step in 0..rows.len() {
        let entries = (step..rows.len()).flat_map(|i| (first..first + MOST).map(move |j| (i, j)));
        let size = |&(i, j): &(usize, usize)| rows[i][j].abs();
        let Some((i, pivot)) = entries.max_by(|a, b| size(a).total_cmp(&size(b))) else {
            break;
        };
        if size(&(i, pivot)) <= none {
            break;
        }
        rows.swap(step, i);
        let own = rows[step];
        for (k, row) in rows.iter_mut().enumerate() {
            if k > step || (before && k < step) {
                let c = row[pivot] / own[pivot];
                for (entry, own) in row.iter_mut().zip(&own) {
                    *entry -= c * own;
                }
                row[pivot] = 0.0;
            }
        }
        pivots.push(pivot);
    }
    pivots
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::Coulomb;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the ranks: the step is that of the whole matrix.
        #[test]
        fn the_step_solves_all_rows(
            kinds in prop::collection::vec(0usize..4, 5), seed in prop::collection::vec(-1.0..1.0f64, 31),
        ) {
            let n = 3 * kinds.len();
            let random = |k: usize| seed[k % seed.len()];
            let b = DMatrix::from_fn(n, n, |i, j| random(7 * i + 3 * j));
            let s = &b * b.transpose() + DMatrix::identity(n, n);
            let zero = vec![Local::<3>::zeros(); kinds.len()];
            let law = vec![Coulomb::new(0.3).expect("valid"); kinds.len()];
            let problem =
                CondensedProblem::new(s.clone(), DVector::zeros(n), zero.clone(), law, zero)
                    .expect("valid");
            // E a projector of rank 0 to 3, A the rest, both turned.
            let row = |(c, &rank): (usize, &usize)| {
                let t = Local::<3>::from_fn(|k, _| random(11 * c + k) + 0.1);
                let q = along(&t);
                let d = |kept: f64, other: f64| {
                    let entry = |k: usize| if k < rank { kept } else { other };
                    SMatrix::<f64, 3, 3>::from_diagonal(&Local::from_fn(|k, _| entry(k)))
                };
                Row {
                    elastic: q * d(1.0, 0.0) * q.transpose(),
                    shift: q * d(0.0, 2.0) * q.transpose() * (SMatrix::identity() + 0.2 * q),
                    value: Local::from_fn(|k, _| random(5 * c + k)),
                }
            };
            let rows: Vec<_> = kinds.iter().enumerate().map(row).collect();
            let mut whole = DMatrix::zeros(n, n);
            let mut value = DVector::zeros(n);
            for (i, r) in rows.iter().enumerate() {
                let all = r.elastic * s.fixed_rows::<3>(3 * i);
                whole.fixed_rows_mut::<3>(3 * i).copy_from(&all);
                let mut own = whole.fixed_view_mut::<3, 3>(3 * i, 3 * i);
                own += r.shift;
                value.fixed_rows_mut::<3>(3 * i).copy_from(&r.value);
            }
            let expected = whole.clone().lu().solve(&value);
            let step = solve(&problem, rows);
            if let (Some(x), Some(y)) = (expected, step) {
                prop_assert!((&whole * &y - &value).amax() < 1e-8 * (1.0 + y.amax() * whole.amax()));
                prop_assert!((&x - &y).amax() < 1e-6 * (1.0 + x.amax()));
            }
        }
    }

    /// Open contacts, some that slip with friction and some that stick: one answer by Cholesky's factor and by L U, also
    /// of a structure that is not stable.
    #[test]
    fn open_contacts_are_eliminated_by_cholesky() {
        let n = 24;
        let b = DMatrix::from_fn(n, n, |i, j| ((7 * i * i + 3 * j * j + i * j) as f64).sin());
        let stable = &b * b.transpose() + DMatrix::identity(n, n);
        let mut unstable = stable.clone();
        unstable[(0, 0)] -= 40.0;
        for (s, is_stable) in [(stable, true), (unstable, false)] {
            let open = |i: usize| Row {
                elastic: SMatrix::<f64, 2, 2>::identity(),
                shift: SMatrix::zeros(),
                value: Local::<2>::new((i as f64).sin(), 0.3),
            };
            let rubs = |i: usize| Row {
                elastic: SMatrix::<f64, 2, 2>::new(0.0, 0.0, -0.3, 1.0),
                shift: SMatrix::<f64, 2, 2>::new(2.0, 0.0, 0.6, 0.0),
                value: Local::<2>::new(0.1, (i as f64).cos()),
            };
            let rows = || (0..n / 2).map(|i| if i % 4 == 1 { rubs(i) } else { open(i) });
            let own: Vec<_> = rows().map(|row| Own::new(row).expect("regular")).collect();
            assert_eq!(own.iter().filter(|o| o.is_symmetric()).count(), 9);
            let zero = vec![Local::<2>::zeros(); n / 2];
            let law = vec![Coulomb::new(0.3).expect("valid"); n / 2];
            let load = DVector::zeros(n);
            let problem = CondensedProblem::new(s.clone(), load, zero.clone(), law, zero);
            let step = solve(&problem.expect("valid"), rows().collect()).expect("regular");
            for (i, row) in rows().enumerate() {
                let seen = row.elastic * (s.fixed_rows::<2>(2 * i) * &step)
                    + row.shift * step.fixed_rows::<2>(2 * i);
                assert!((seen - row.value).amax() < 1e-10);
            }
            let order: Vec<usize> = (0..n / 2).filter(|i| i % 4 != 1).collect();
            let order: Vec<usize> = order
                .into_iter()
                .chain((0..n / 2).filter(|i| i % 4 == 1))
                .collect();
            let equations = || Equations::new(&s, &own, (&order, 18));
            let value = DVector::from_fn(21, |i, _| (i as f64).cos());
            let found = equations().eliminated(&value);
            assert_eq!(found.is_some(), is_stable);
            if let Some(x) = found {
                assert!((equations().whole() * x - value).amax() < 1e-10);
            }
        }
    }

    /// A rotation whose first column is along t.
    fn along(t: &Local<3>) -> SMatrix<f64, 3, 3> {
        crate::frame(&(t / t.norm()))
    }

    #[test]
    fn stuck_contacts_leave_no_equations_and_rows_of_zeros_no_step() {
        let zero = vec![Local::<2>::zeros()];
        let law = vec![Coulomb::new(0.3).expect("valid")];
        let problem = CondensedProblem::new(
            DMatrix::identity(2, 2),
            DVector::zeros(2),
            zero.clone(),
            law,
            zero,
        )
        .expect("valid");
        let row = |shift| Row {
            elastic: SMatrix::zeros(),
            shift,
            value: Local::<2>::new(3.0, -1.0),
        };
        let step = solve(&problem, vec![row(SMatrix::identity() * 2.0)]).expect("regular");
        assert_eq!(step, DVector::from_row_slice(&[1.5, -0.5]));
        assert!(solve(&problem, vec![row(SMatrix::zeros())]).is_none());
    }
}
