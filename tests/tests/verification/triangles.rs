//! Tools of triangles beside the round ones that they stand for; not the surface alone.

use moreau::contact::{Ball, Obstacle, Triangulated};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Isotropic, VonMises};
use moreau::mesh::{CellKind, Integration, Solid, block3, uniform};
use std::collections::HashMap;
use verification::problems::Fallible;

const CENTER: [f64; 3] = [0.0, 17.0, 0.0];
const RADIUS: f64 = 7.0;

/// A ball: an octahedron whose triangles are cut in four, so many times.
fn ball(times: usize) -> Fallible<Triangulated> {
    let axis = |k: usize, s: f64| std::array::from_fn(|i| if i == k { s } else { 0.0 });
    let mut directions: Vec<[f64; 3]> = [1.0, -1.0]
        .iter()
        .flat_map(|&s| [0, 1, 2].map(|k| axis(k, s)))
        .collect();
    // Corners k, k + 1 and k + 2 of the axes, round each octant.
    let octant = |signs: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| k + 3 * ((signs >> k) & 1));
        match signs.count_ones() % 2 {
            0 => [x, y, z],
            _ => [x, z, y],
        }
    };
    let mut faces: Vec<[usize; 3]> = (0..8).map(octant).collect();
    for _ in 0..times {
        let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
        let mut finer = Vec::new();
        for face in &faces {
            let middle = [0, 1, 2].map(|k| {
                let [a, b] = [face[k], face[(k + 1) % 3]];
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let sum: [f64; 3] =
                        std::array::from_fn(|i| directions[a][i] + directions[b][i]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    directions.push(sum.map(|x| x / length));
                    directions.len() - 1
                })
            });
            finer.extend((0..3).map(|k| [face[k], middle[k], middle[(k + 2) % 3]]));
            finer.push(middle);
        }
        faces = finer;
    }
    let place = |d: &[f64; 3]| std::array::from_fn(|i| CENTER[i] + RADIUS * d[i]);
    let points: Vec<[f64; 3]> = directions.iter().map(place).collect();
    Ok(Triangulated::new(&points, &faces, 0.5)?)
}

/// Force on a tool pressed into a quarter of a block, and the Newton iterations that it takes.
fn pressed(tool: impl Obstacle<3> + 'static) -> Fallible<(f64, usize)> {
    let lines = uniform(0.0, 10.0, 6);
    let mesh = block3("b", CellKind::Hex8, &lines, &lines, &lines)?;
    let law = VonMises::new(210e3, 0.3, 300.0)?.with_hardening(Isotropic::linear(500.0)?);
    let model = Model::with_large_strains(mesh, Solid)
        .material("b", law, Integration::BBar)?
        .tool("ball", tool)?
        .contact("b.top", "ball", Coulomb::new(0.2)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("b.left", &[Axis::X])
        .fix("b.bottom", &[Axis::Y])
        .fix("b.back", &[Axis::Z])
        .tool("ball", [0.0, -1.5, 0.0]);
    let reports = driver.run(&step, 5, |_, _| {})?;
    let iterations = reports.iter().map(|r| r.newton_iterations).sum();
    Ok((driver.tool_force("ball")?[1], iterations))
}

/// The same iterations, too: a normal that jumped from triangle to triangle would need more.
#[test]
fn a_ball_of_triangles_presses_as_a_ball() -> Fallible {
    let (exact, iterations) = pressed(Ball::new(CENTER, RADIUS)?)?;
    let (force, needed) = pressed(ball(2)?)?;
    let off = (force / exact - 1.0).abs();
    assert!(off < 1e-5, "{force} {exact}");
    assert_eq!(needed, iterations);
    Ok(())
}
