//! Bodies that move into each other, or are pushed, where nothing is in their way.

use super::*;

fn warned(simulation: &Simulation, what: &str) -> bool {
    let warnings = simulation.outcome().warnings;
    warnings.iter().any(|said| said.contains(what))
}

/// A block pushed through a gap of 0.1 mm into another: the run says so where no contact is between them.
#[test]
fn bodies_that_pass_through_each_other_are_told() {
    let pushed = |strain: &str, by: f64, between: &str| {
        let pushed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
{between}
[[mesh.block]]
name = "l"
element = "quad8"
x = [0, 20]
y = [0, 10]
cells = [4, 2]
[[mesh.block]]
name = "r"
element = "quad4"
x = [20.1, 40.1]
y = [0, 10]
cells = [3, 3]
[[material]]
on = ["l", "r"]
young = 1000
poisson = 0.3
[[step]]
name = "p"
increments = 2
fix = [{{ on = "r.right", u = ["x", "y"] }}]
move = [{{ on = "l.left", u = {{ x = {by:?}, y = 0 }} }}]
"#
        )));
        warned(
            &pushed,
            "nodes have moved into another body at the end of step \"p\"",
        )
    };
    let contact = "contact = [{ surface = \"l.right\", against = \"r.left\", friction = 0 }]";
    for strain in ["small", "finite"] {
        assert!(pushed(strain, 3.0, ""), "{strain}");
        assert!(!pushed(strain, 0.09, ""), "{strain}");
        assert!(!pushed(strain, 0.5, contact), "{strain}");
    }
}
