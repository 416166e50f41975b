//! Pressures that follow a surface with a free edge, whose stiffness is not symmetric.

use super::*;

/// A strip that is clamped at its left end and bent by a pressure on a patch near its free one.
fn bent(pressure: f64) -> Simulation {
    simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "s"
element = "quad8"
x = [0, 20]
y = [-0.5, 0.5]
cells = [10, 2]
[[mesh.group]]
name = "patch"
on = "s.top"
x = [16, 18]
[[material]]
on = "s"
young = 1000.0
poisson = 0.3
[[step]]
name = "bend"
increments = 4
fix = [{{ on = "s.left", u = ["x", "y"] }}]
load = [{{ on = "patch", pressure = {pressure} }}]
"#
    ))
}

/// Imbalances of all iterations of the last increment of a simulation, each over the largest.
fn last_ways(mut simulation: Simulation) -> Vec<f64> {
    let mut ways = Vec::new();
    while let Some(converged) = simulation
        .advance(&mut |_, _| ControlFlow::Continue(()))
        .expect("converges")
    {
        ways = converged.report.residuals;
    }
    let most = ways.iter().copied().fold(0.0, f64::max);
    ways.iter().map(|left| left / most).collect()
}

/// A large bend under a patch whose ends are free: with the symmetric part of its stiffness alone every step leaves a
/// part of the imbalance, with all of it the square.
#[test]
fn newtons_method_is_quadratic_under_pressures_with_a_free_edge() {
    let ways = last_ways(bent(0.3));
    let near = ways
        .iter()
        .position(|left| *left < 1e-5)
        .expect("converges");
    let left: Vec<f64> = ways[near..].to_vec();
    assert!(left.len() <= 2, "{ways:?}");
    assert!(ways.len() <= 6, "{ways:?}");
}
