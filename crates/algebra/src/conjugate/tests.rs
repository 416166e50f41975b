//! The two-level operator and the iteration, on grids of springs and their coarse grids.

use super::*;
use crate::{Cholesky, CoarseError, Ldlt, Pattern};
use nalgebra::DMatrix;

const STOP: Stop = Stop {
    part: 1e-2,
    limit: 400,
};

/// Springs between n×n nodes and to the ground outside, n odd: every second node along each axis is one of the
/// coarse grid, and the others follow it linearly. The last `kept` nodes of the last line are kept: they are
/// coarse unknowns, all of them.
fn grid(n: usize, kept: usize) -> (Matrix, CoarseSpace) {
    let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for k in 0..n * n {
        rows.push(k as u32);
        values.push(4.0);
        if k % n + 1 < n {
            rows.push(k as u32 + 1);
            values.push(-1.0);
        }
        if k / n + 1 < n {
            rows.push((k + n) as u32);
            values.push(-1.0);
        }
        start.push(rows.len() as u32);
    }
    let pattern = Pattern::new(start, rows).and_then(|pattern| pattern.keeping(kept));
    let mut matrix = Matrix::new(pattern.expect("ascending"));
    matrix.values_mut().1.copy_from_slice(&values);
    let first = n * n - kept;
    let mut number = vec![None; n * n];
    let mut count = 0;
    for k in 0..n * n {
        if k >= first || (k % n % 2 == 1 && k / n % 2 == 1) {
            number[k] = Some(count);
            count += 1;
        }
    }
    let follow = |k: usize| {
        if let Some(own) = number[k] {
            return vec![(own, 1.0)];
        }
        let (i, j) = (k % n, k / n);
        let ends = |i: usize| match i % 2 {
            1 => vec![(i, 1.0)],
            _ => [i.wrapping_sub(1), i + 1].map(|i| (i, 0.5)).to_vec(),
        };
        let pairs = ends(j)
            .into_iter()
            .flat_map(|(j, b)| ends(i).into_iter().map(move |(i, a)| (i, j, a * b)));
        let inside = pairs.filter(|&(i, j, _)| i < n && j < n);
        inside
            .filter_map(|(i, j, part)| Some((number[j * n + i]?, part)))
            .collect()
    };
    let parents: Vec<Vec<(u32, f64)>> = (0..n * n).map(follow).collect();
    let mut space = CoarseSpace::new(&matrix.pattern, count as usize, &parents).expect("fits");
    space.project(&matrix).expect("fits");
    (matrix, space)
}

fn dense(n: usize, mut apply: impl FnMut(&[f64]) -> Vec<f64>) -> DMatrix<f64> {
    let column = |k: usize| {
        let mut unit = vec![0.0; n];
        unit[k] = 1.0;
        DVector::from_vec(apply(&unit))
    };
    DMatrix::from_columns(&(0..n).map(column).collect::<Vec<_>>())
}

fn dense_matrix(matrix: &Matrix) -> DMatrix<f64> {
    let n = matrix.pattern.size();
    -dense(n, |x| matrix.residual(x, &vec![0.0; n]))
}

fn engine<E: Engine>(space: &CoarseSpace) -> E {
    let mut engine = E::analyse(&space.matrix().pattern, None).expect("small");
    engine.factorise(space.matrix().values()).expect("definite");
    engine
}

#[test]
fn the_coarse_matrix_is_that_of_its_vectors() {
    for (n, kept) in [(7, 0), (7, 4), (9, 9)] {
        let (matrix, space) = grid(n, kept);
        assert!(space.size() < space.fine_size());
        let p = dense(space.size(), |w| {
            let mut v = vec![0.0; n * n];
            space.prolong(w, &mut v);
            v
        });
        let difference = dense_matrix(space.matrix()) - p.transpose() * dense_matrix(&matrix) * &p;
        assert!(difference.amax() < 1e-14, "{:e}", difference.amax());
        let transposed = dense(n * n, |f| space.restrict(f));
        assert_eq!(transposed, p.transpose());
        assert_eq!(space.matrix().pattern.kept(), kept);
    }
}

#[test]
fn rows_that_do_not_fit_are_told() {
    let (matrix, mut space) = grid(3, 0);
    let pattern = &matrix.pattern;
    let new = |size, rows: &[Vec<(u32, f64)>]| CoarseSpace::new(pattern, size, rows).err();
    let (rows, unknowns) = (8, 9);
    assert_eq!(
        new(2, &vec![vec![]; 8]),
        Some(CoarseError::Rows { rows, unknowns })
    );
    let mut parents = vec![vec![]; 9];
    parents[4] = vec![(1, 1.0), (2, 1.0)];
    let (row, unknown, size) = (4, 2, 2);
    assert_eq!(
        new(2, &parents),
        Some(CoarseError::Unknown { row, unknown, size })
    );
    assert_eq!(new(3, &parents), None);
    let keeping = pattern.clone().keeping(4).expect("nine");
    let (kept, size) = (4, 3);
    let found = CoarseSpace::new(&keeping, 3, &parents).err();
    assert_eq!(found, Some(CoarseError::Kept { kept, size }));
    let (other, _) = grid(5, 0);
    let (what, found, expected) = ("rows of a matrix", 25, 9);
    let length = EngineError::Length {
        what,
        found,
        expected,
    };
    assert_eq!(space.project(&other), Err(length));
    let mut engine = engine::<Cholesky>(&space);
    let mut iteration = ConjugateGradients {
        matrix: &matrix,
        space: &space,
        engine: &mut engine,
        interface: Interface::Free,
        stop: STOP,
    };
    for (f, u) in [(8, 9), (9, 8), (25, 25)] {
        let outcome = iteration.improve(&vec![1.0; f], &mut vec![0.0; u]);
        assert!(
            matches!(outcome, Err(EngineError::Length { .. })),
            "{f} {u}"
        );
    }
    let mut none = Cholesky::analyse(&space.matrix().pattern, None).expect("small");
    iteration.engine = &mut none;
    let outcome = iteration.improve(&[1.0; 9], &mut [0.0; 9]);
    assert_eq!(outcome, Err(EngineError::NotFactorised));
}

/// What the unknowns see that may move, interface held or free.
fn two_level<E: Engine>(n: usize, kept: usize, free: bool) {
    let (matrix, space) = grid(n, kept);
    let mut engine = engine::<E>(&space);
    let interface = if free {
        Interface::Free
    } else {
        Interface::Held
    };
    let mut iteration = ConjugateGradients {
        matrix: &matrix,
        space: &space,
        engine: &mut engine,
        interface,
        stop: STOP,
    };
    let all = n * n;
    let mut room = vec![0.0; all];
    let mut operator = dense(all, |r| {
        let mut z = vec![f64::NAN; all];
        iteration.precondition(r, &mut z, &mut room).expect("fits");
        z
    });
    let moving = if free { all } else { all - kept };
    assert!(
        operator
            .rows(moving, all - moving)
            .iter()
            .all(|&v| v == 0.0)
    );
    operator = operator.view((0, 0), (moving, moving)).into_owned();
    let skew = (&operator - operator.transpose()).amax();
    assert!(skew < 1e-14 * operator.amax(), "{skew:e}");
    let least = operator.clone().symmetric_eigenvalues().min();
    assert!(least > 0.0, "{least:e}");
    // It is an inverse but for little: errors shrink by less than a half of themselves.
    let own = dense_matrix(&matrix)
        .view((0, 0), (moving, moving))
        .into_owned();
    let root = own.cholesky().expect("definite").l();
    let spectrum = (root.transpose() * operator * root).symmetric_eigenvalues();
    assert!(
        spectrum.min() > 0.5 && spectrum.max() < 1.0 + 1e-12,
        "{spectrum}"
    );
}

#[test]
fn the_two_level_operator_is_symmetric_and_positive_definite() {
    for kept in [0, 5] {
        for free in [true, false] {
            two_level::<Cholesky>(9, kept, free);
            two_level::<Ldlt>(9, kept, free);
        }
    }
}

/// Solutions as a direct one, in as many iterations on any grid.
#[test]
fn iterations_lead_to_the_direct_solution_and_are_few_on_any_grid() {
    let stop = Stop {
        part: 1e-10,
        limit: 100,
    };
    let mut counts = Vec::new();
    for n in [7, 15, 31, 63] {
        let (matrix, space) = grid(n, 0);
        let mut engine = engine::<Cholesky>(&space);
        let f: Vec<f64> = (0..n * n).map(|k| (k as f64).sin() + 0.2).collect();
        let mut u = vec![0.0; n * n];
        let mut iteration = ConjugateGradients {
            matrix: &matrix,
            space: &space,
            engine: &mut engine,
            interface: Interface::Free,
            stop,
        };
        counts.push(iteration.improve(&f, &mut u).expect("fits"));
        // The solution is one already.
        assert!(iteration.improve(&f, &mut u.clone()).expect("fits") <= stop.limit);
        let mut direct = Cholesky::analyse(&matrix.pattern, None).expect("small");
        direct.factorise(matrix.values()).expect("definite");
        let mut exact = f.clone();
        direct.solve(&mut exact).expect("definite");
        let (u, exact) = (DVector::from_vec(u), DVector::from_vec(exact));
        let error = (u - &exact).norm() / exact.norm();
        assert!(error < 1e-9, "{error:e} at {n}");
    }
    assert!(
        counts.iter().all(|&count| (8..=16).contains(&count)),
        "{counts:?}"
    );
    assert!(counts[3] <= counts[1] + 2, "{counts:?}");
}

/// Without a coarse space sweeps alone precondition, badly: directions that are conjugate need no more steps than the
/// Chebyshev bound on the spectrum says, those of steepest descent some hundred.
#[test]
fn directions_are_conjugate() {
    let n = 15;
    let (matrix, _) = grid(n, 0);
    let none = vec![Vec::<(u32, f64)>::new(); n * n];
    let space = CoarseSpace::new(&matrix.pattern, 0, none).expect("fits");
    let mut engine = engine::<Cholesky>(&space);
    let stop = Stop {
        part: 1e-10,
        limit: 400,
    };
    let mut iteration = ConjugateGradients {
        matrix: &matrix,
        space: &space,
        engine: &mut engine,
        interface: Interface::Free,
        stop,
    };
    let mut room = vec![0.0; n * n];
    let operator = dense(n * n, |r| {
        let mut z = vec![0.0; n * n];
        iteration.precondition(r, &mut z, &mut room).expect("fits");
        z
    });
    let root = dense_matrix(&matrix).cholesky().expect("definite").l();
    let spectrum = (root.transpose() * operator * root).symmetric_eigenvalues();
    let condition = spectrum.max() / spectrum.min();
    assert!(condition > 10.0, "{condition}");
    let bound = 0.5 * condition.sqrt() * (2.0 * condition.sqrt() / stop.part).ln() + 1.0;
    let f: Vec<f64> = (0..n * n).map(|k| (k as f64).sin() + 0.2).collect();
    let count = iteration.improve(&f, &mut vec![0.0; n * n]).expect("fits");
    assert!((count as f64) < bound, "{count} {bound}");
}

/// An interface that is held, and one on springs to the ground, against dense algebra.
#[test]
fn an_interface_stays_or_yields_as_it_is_told() {
    let (n, kept, spring) = (9, 5, 0.7);
    let first = n * n - kept;
    let (matrix, space) = grid(n, kept);
    let a = dense_matrix(&matrix);
    let f = DVector::from_fn(n * n, |k, _| (k as f64).cos());
    let given = DVector::from_fn(kept, |k, _| 0.3 * k as f64);
    let mut engine = engine::<Cholesky>(&space);
    let schur = engine.schur().expect("factorised");
    let springs = DMatrix::identity(kept, kept) * spring;
    let softened = (schur + &springs).lu();
    let yields = |g: &DVector<f64>| softened.solve(g).expect("definite");
    for held in [true, false] {
        let mut u = vec![0.0; n * n];
        let (mut sprung, mut load) = (a.clone(), f.clone());
        let mut total = u.clone();
        if held {
            total[first..].copy_from_slice(given.as_slice());
        } else {
            let corner = sprung.view((first, first), (kept, kept)) + &springs;
            sprung
                .view_mut((first, first), (kept, kept))
                .copy_from(&corner);
        }
        u.copy_from_slice(&total);
        // With springs the matrix of the iteration has them, too.
        let mut with_springs = Matrix::new(matrix.pattern.clone());
        with_springs.values_mut().1.copy_from_slice(matrix.values());
        if !held {
            with_springs.shift(kept, spring);
        }
        let interface = if held {
            Interface::Held
        } else {
            Interface::Yields(&yields)
        };
        let mut iteration = ConjugateGradients {
            matrix: &with_springs,
            space: &space,
            engine: &mut engine,
            interface,
            stop: Stop {
                part: 1e-10,
                limit: 200,
            },
        };
        let count = iteration.improve(f.as_slice(), &mut u).expect("fits");
        assert!(count < 40, "{count}");
        if held {
            assert_eq!(u[first..], *given.as_slice());
            let inner = a.view((0, 0), (first, first)).into_owned();
            load = load.rows(0, first) - a.view((0, first), (first, kept)) * &given;
            let exact = inner.lu().solve(&load).expect("definite");
            assert!((DVector::from_column_slice(&u[..first]) - exact).norm() < 1e-8);
        } else {
            let exact = sprung.lu().solve(&load).expect("definite");
            assert!((DVector::from_column_slice(&u) - exact).norm() < 1e-8);
        }
    }
}
