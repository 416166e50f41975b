//! Times of a factorisation and of solves, by every engine, on cubes of springs.
//!
//! `cargo run --release -p moreau-algebra --example engines [NODES ALONG AN EDGE …]`
//!
//! Each node has three displacements and a spring to each of up to 26 neighbours, as a mesh of linear
//! hexahedra has. Of several runs the fastest counts.

// A program, not a library: it prints.
#![allow(clippy::print_stdout)]

use moreau_algebra::{Cholesky, Engine, Ldlt, Pattern, nested_dissection};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let edges: Result<Vec<usize>, _> = std::env::args().skip(1).map(|n| n.parse()).collect();
    let mut edges = edges?;
    if edges.is_empty() {
        edges = vec![8, 12, 16, 20, 24];
    }
    println!("milliseconds; of a solve, for one right-hand side where so many go together\n");
    print!(
        "{:<10}{:>9}{:>13}{:>13}",
        "engine", "unknowns", "entries of L", "factorise"
    );
    println!("{:>9}{:>9}{:>9}{:>9}{:>9}", "1", "2", "4", "8", "16");
    for n in edges {
        let (pattern, values) = springs(n)?;
        measure::<Cholesky>("Cholesky", &pattern, &values)?;
        measure::<Ldlt>("Ldlt", &pattern, &values)?;
    }
    Ok(())
}

fn measure<E: Engine>(name: &str, pattern: &Pattern, values: &[f64]) -> Result<(), Box<dyn Error>> {
    let mut engine = E::analyse(pattern, None)?;
    let factorise = fastest(3, || engine.factorise(black_box(values)).map(|_| ()))?;
    let (n, entries) = (engine.size(), engine.cost().entries);
    print!("{name:<10}{n:>9}{entries:>13.0}{:>13.2}", 1e3 * factorise);
    for sides in [1, 2, 4, 8, 16] {
        let b: Vec<f64> = (0..n * sides).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        let time = fastest(9, || {
            x.copy_from_slice(&b);
            engine.solve(black_box(&mut x))
        })?;
        print!("{:>9.3}", 1e3 * time / sides as f64);
    }
    println!();
    Ok(())
}

/// Seconds of the fastest of some runs.
fn fastest<T>(runs: usize, mut work: impl FnMut() -> Result<(), T>) -> Result<f64, T> {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let clock = Instant::now();
        work()?;
        least = least.min(clock.elapsed().as_secs_f64());
    }
    Ok(least)
}

/// A cube of so many nodes along an edge, held by soft springs at every node.
fn springs(n: usize) -> Result<(Pattern, Vec<f64>), Box<dyn Error>> {
    let at = |a: usize| [a % n, a / n % n, a / (n * n)];
    let points: Vec<[f64; 3]> = (0..n * n * n).map(|a| at(a).map(|i| i as f64)).collect();
    let near = |a: usize| -> Vec<usize> {
        let range = at(a).map(|i| i.saturating_sub(1)..(i + 2).min(n));
        let [x, y, z] = range;
        let all = z.flat_map(|k| {
            let x = x.clone();
            y.clone()
                .flat_map(move |j| x.clone().map(move |i| (k * n + j) * n + i))
        });
        all.filter(|&b| b != a).collect()
    };
    let adjacency: Vec<Vec<usize>> = (0..points.len()).map(near).collect();
    let all: Vec<usize> = (0..points.len()).collect();
    let order = nested_dissection(&all, &points, |a| &adjacency[a]);
    let mut position = vec![0; order.len()];
    for (k, &a) in order.iter().enumerate() {
        position[a] = k;
    }
    let spring = |a: usize, b: usize, i: usize, j: usize| {
        let d: [f64; 3] = std::array::from_fn(|k| points[b][k] - points[a][k]);
        let length = d.iter().map(|d| d * d).sum::<f64>();
        d[i] * d[j] / length.powf(1.5) + if i == j { 0.1 } else { 0.0 }
    };
    let (mut start, mut rows, mut values) = (vec![0u32], Vec::new(), Vec::new());
    for (k, &a) in order.iter().enumerate() {
        let mut later: Vec<usize> = adjacency[a].iter().map(|&b| position[b]).collect();
        later.retain(|&p| p > k);
        later.sort_unstable();
        for i in 0..3 {
            for j in i..3 {
                let own: f64 = adjacency[a].iter().map(|&b| spring(a, b, i, j)).sum();
                rows.push((3 * k + j) as u32);
                values.push(own + if i == j { 1e-3 } else { 0.0 });
            }
            for &p in &later {
                for j in 0..3 {
                    rows.push((3 * p + j) as u32);
                    values.push(-spring(a, order[p], i, j));
                }
            }
            start.push(rows.len() as u32);
        }
    }
    Ok((Pattern::new(start, rows)?, values))
}
