//! Cholesky factors of a size that several threads make, and solves with them; small ones are in tests of all engines.

use super::branches::{Branches, LARGE, PART};
use crate::common::laplacian;
use crate::symbolic::Symbolic;
use crate::{Cholesky, Engine, EngineError, Pattern};

/// A x of the lower triangle of A.
fn product(pattern: &Pattern, values: &[f64], x: &[f64]) -> Vec<f64> {
    let mut b = vec![0.0; x.len()];
    for j in 0..x.len() {
        let range = pattern.range(j);
        for (&i, v) in pattern.rows()[range.clone()].iter().zip(&values[range]) {
            b[i as usize] += v * x[j];
            if i as usize != j {
                b[j] += v * x[i as usize];
            }
        }
    }
    b
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// A Laplacian of which the last unknowns are coupled to each other, all of them: a large supernode of the trunk.
fn with_dense_end(n: usize, dense: usize) -> (Pattern, Vec<f64>) {
    let (sparse, weights) = laplacian(n, 0.2);
    let size = sparse.size();
    let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..size {
        let range = sparse.range(j);
        let own = sparse.rows()[range.clone()].iter().zip(&weights[range]);
        let mut column: std::collections::BTreeMap<u32, f64> = own.map(|(&i, &v)| (i, v)).collect();
        if j >= size - dense {
            for i in j..size {
                let own = if i == j { 1.0 } else { -0.5 / dense as f64 };
                *column.entry(i as u32).or_default() += own;
            }
        }
        rows.extend(column.keys());
        values.extend(column.values());
        start.push(rows.len() as u32);
    }
    (Pattern::new(start, rows).expect("ascending"), values)
}

#[test]
fn branches_and_trunk_are_all_supernodes_once() {
    let (pattern, _) = laplacian(22, 0.2);
    let symbolic = Symbolic::new(&pattern.keeping(10).expect("so many"), None).expect("small");
    let Branches { ranges, trunk } = Branches::new(&symbolic);
    assert!(ranges.len() > 8, "{}", ranges.len());
    let mut all: Vec<usize> = ranges.iter().cloned().flatten().chain(trunk).collect();
    all.sort_unstable();
    assert!(all.iter().copied().eq(0..symbolic.count()));
    let first_kept = symbolic.pattern.size() - 10;
    for range in ranges {
        let root = symbolic.supernode(range.end - 1);
        assert!(root.start + root.width <= first_kept);
        let entries = range.map(|s| symbolic.supernode(s).values.len());
        assert!(entries.sum::<usize>() as f64 <= PART * symbolic.cost.entries);
    }
}

/// A solution solves, whatever else is solved with it, in one go or condensed and expanded.
#[test]
fn a_large_factor_solves_for_any_number_of_sides() {
    for (pattern, values) in [laplacian(22, 0.2), with_dense_end(20, 700)] {
        let n = pattern.size();
        let pattern = pattern.keeping(10).expect("so many");
        let mut engine = Cholesky::analyse(&pattern, None).expect("small");
        assert!(engine.cost().entries > LARGE);
        engine.factorise(&values).expect("definite");
        let known: Vec<f64> = (0..9 * n).map(|i| (i as f64).sin()).collect();
        let b: Vec<f64> = known
            .chunks(n)
            .flat_map(|x| product(&pattern, &values, x))
            .collect();
        let mut together = b.clone();
        engine.solve(&mut together).expect("factorised");
        assert!(largest(&together, &known) < 1e-11);
        for (k, together) in together.chunks(n).enumerate() {
            let mut alone = b[k * n..][..n].to_vec();
            engine.solve(&mut alone).expect("factorised");
            assert!(alone == together, "side {k}");
            let mut parted = b[k * n..][..n].to_vec();
            engine.condense(&mut parted).expect("factorised");
            parted[n - 10..].copy_from_slice(&known[k * n..][n - 10..n]);
            engine.expand(&mut parted).expect("factorised");
            assert!(largest(&parted, &known[k * n..][..n]) < 1e-11);
        }
    }
}

/// On `threads` of them.
fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().expect("threads").install(work)
}

/// One with supernodes of which several threads make parts.
#[test]
fn wide_supernodes_are_the_same_to_the_bit_on_any_number_of_threads() {
    let (pattern, values) = with_dense_end(20, 700);
    let factor = |threads| {
        on(threads, || {
            let mut engine = Cholesky::analyse(&pattern, None).expect("small");
            engine.factorise(&values).expect("definite");
            engine.factor
        })
    };
    let one = factor(1);
    for threads in [2, 3, 8] {
        assert!(factor(threads) == one, "{threads} threads");
    }
}

/// In a branch and in the trunk; the first is told, where there are several.
#[test]
fn a_pivot_that_is_not_positive_is_told_by_its_row() {
    let (pattern, values) = with_dense_end(20, 700);
    let mut engine = Cholesky::analyse(&pattern, None).expect("small");
    let n = engine.size();
    let branches = &engine.branches.ranges;
    let rows: Vec<usize> = [branches[2].start, branches[1].end - 1]
        .map(|s| engine.symbolic.supernode(s).start)
        .into_iter()
        .chain([n - 600, n - 1])
        .collect();
    for (bad, first) in [
        (&rows[..], rows[1].min(rows[0])),
        (&rows[..1], rows[0]),
        (&rows[2..], n - 600),
        (&rows[3..], n - 1),
    ] {
        let mut values = values.clone();
        for &row in bad {
            values[pattern.diagonal(row)] -= 1e3;
        }
        match engine.factorise(&values) {
            Err(EngineError::NotPositiveDefinite { row }) => assert_eq!(row, first),
            other => panic!("{other:?}"),
        }
    }
    engine.factorise(&values).expect("definite");
}
