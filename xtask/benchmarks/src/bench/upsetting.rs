//! Upsetting of a block with friction on finer and finer meshes, under small strains and under large ones: the
//! time of a Newton iteration.

use std::error::Error;
use std::time::Instant;

use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::Coulomb;
use moreau::mesh::{CellKind, Integration, Mesh, PlaneStrain, block2, uniform};
use verification::problems::large::steel;

/// Coefficient of friction of the platen.
pub(super) const FRICTION: f64 = 0.3;

/// Increments of a third of a cell: strains of the cell in the corner are of the order of one, on every mesh.
pub(super) const INCREMENTS: usize = 5;

/// What a Newton iteration took \[s\].
struct Iteration {
    total: f64,
    assembly: f64,
    factorisation: f64,
    contact: f64,
    solution: f64,
    /// Iterations of the run.
    count: usize,
    /// The load in the end \[N\].
    load: f64,
}

/// A quarter of the block, its top and its side before the platen.
fn block(size: [usize; 2]) -> Result<Mesh<2>, Box<dyn Error>> {
    let [x, y] = size.map(|n| uniform(0.0, 10.0, n));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    let sides = ["block.top", "block.right"].map(|s| mesh.facet_group(s).map(<[_]>::to_vec));
    let facets = sides.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    mesh.add_facet_group("surface", facets)?;
    Ok(mesh)
}

fn upset(
    size: [usize; 2],
    is_large: bool,
    load: (f64, usize),
) -> Result<Iteration, Box<dyn Error>> {
    let (friction, increments) = load;
    let new = match is_large {
        true => Model::with_large_strains,
        false => Model::new,
    };
    let model = new(block(size)?, PlaneStrain::default())
        .material("block", steel(500.0)?, Integration::Reduced)?
        .tool("platen", Plane::new([0.0, 10.0], [0.0, -1.0])?)?
        .contact("surface", "platen", Coulomb::new(friction)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("upset")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::Y])
        .tool(
            "platen",
            [0.0, -10.0 / 3.0 * increments as f64 / size[1] as f64],
        );
    let clock = Instant::now();
    let reports = driver.run(&step, increments, |_, _| {})?;
    let count = reports.iter().map(|r| r.newton_iterations).sum::<usize>();
    let each = |seconds: f64| seconds / count as f64;
    let total = each((clock.elapsed() - driver.timings().ordering).as_secs_f64());
    let t = driver.timings();
    Ok(Iteration {
        total,
        assembly: each(t.assembly.as_secs_f64()),
        factorisation: each(t.factorisation.as_secs_f64()),
        contact: each(t.contact.as_secs_f64()),
        solution: each(t.solution.as_secs_f64()),
        count,
        load: driver.tool_force("platen")?[1],
    })
}

/// Both, size by size.
pub(super) fn run(
    sizes: &[[usize; 2]],
    load: (f64, usize),
    runs: usize,
) -> Result<bool, Box<dyn Error>> {
    println!("seconds of a Newton iteration, and what of it");
    println!(
        "{:>9} {:>7} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>13} {:>6}",
        "cells",
        "strains",
        "iter.",
        "total",
        "assembly",
        "factor",
        "contact",
        "solves",
        "load [N]",
        "ratio"
    );
    for &size in sizes {
        let mut least: [Option<Iteration>; 2] = [None, None];
        for _ in 0..runs.max(1) {
            for (is_large, least) in [false, true].into_iter().zip(&mut least) {
                let new = upset(size, is_large, load)?;
                if least.as_ref().is_none_or(|l| new.total < l.total) {
                    *least = Some(new);
                }
            }
        }
        let [Some(small), Some(large)] = least else {
            continue;
        };
        for (name, own) in [("small", &small), ("large", &large)] {
            println!(
                "{:>9} {name:>7} {:>6} {:>9.5} {:>9.5} {:>9.5} {:>9.5} {:>9.5} {:>13.4} {:>6.2}",
                format!("{}x{}", size[0], size[1]),
                own.count,
                own.total,
                own.assembly,
                own.factorisation,
                own.contact,
                own.solution,
                own.load,
                own.total / small.total,
            );
        }
    }
    Ok(true)
}
