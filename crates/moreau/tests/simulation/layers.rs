//! Strips of few rows of cells with the mean dilatation, bent.

use super::*;

/// Length of a strip over its depth.
const LENGTH: f64 = 20.0;

/// The force at the tip of a cantilever of so many rows over that of Euler's beam, 3 E I/L³ of its way, with E/(1 − ν²) in plane
/// strain.
fn stiffness(element: &str, rule: &str, rows: usize, poisson: f64) -> f64 {
    let (analysis, z, row, foot) = match element {
        // Held across: plane strain.
        "hex8" => ("solid", "z = [0, 0.25]", ", 1", r#""x", "y", "z""#),
        _ => ("plane-strain", "", "", r#""x", "y""#),
    };
    let sides = match z {
        "" => "",
        _ => r#", { on = "s.front", u = ["z"] }, { on = "s.back", u = ["z"] }"#,
    };
    let bent = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "{analysis}"
[[mesh.block]]
name = "s"
element = "{element}"
x = [0, {LENGTH:?}]
y = [0, 1]
{z}
cells = [300, {rows}{row}]
[[material]]
on = "s"
young = 200000.0
poisson = {poisson:?}
{rule}
[[step]]
name = "bend"
increments = 1
fix = [{{ on = "s.left", u = [{foot}] }}{sides}]
move = [{{ on = "s.right", u = {{ y = -0.01 }} }}]
"#
    )));
    let force = bent.history().numbers("force.s.right.y");
    let width = if z.is_empty() { 1.0 } else { 0.25 };
    let modulus = 200000.0 / (1.0 - poisson * poisson);
    let beam = 3.0 * modulus / 12.0 / LENGTH.powi(3) * 0.01 * width;
    force.last().expect("an increment").abs() / beam
}

/// The table of docs/theory/elements.md. In a row of its own the dilatation of a bent cell has no mean, and what is left of its stiffness are the deviators: 2 (1 − ν)/3.
/// Of n rows that is so of what varies within each, a part 1/n² of the whole.
#[test]
fn strips_of_few_rows_bend_with_a_part_of_their_stiffness() {
    for poisson in [0.0, 0.3] {
        for (element, rows) in [
            ("quad4", 1),
            ("quad4", 2),
            ("quad4", 4),
            ("hex8", 1),
            ("hex8", 2),
        ] {
            let lost = (1.0 - 2.0 * (1.0 - poisson) / 3.0) / (rows * rows) as f64;
            let found = stiffness(element, "", rows, poisson);
            assert!(
                (found - (1.0 - lost)).abs() < 5e-3,
                "{element} {rows} {poisson}: {found}"
            );
        }
        // Of all points linear cells lack the strain across, which bending makes vary.
        let full = stiffness("quad4", "quadrature = \"full\"", 1, poisson);
        let quadratic = stiffness("quad8", "", 1, poisson);
        assert!((quadratic - 1.0).abs() < 5e-3, "{quadratic}");
        let held = (1.0 - poisson) * (1.0 - poisson) / (1.0 - 2.0 * poisson);
        assert!((full - held).abs() < 5e-3, "{full}");
    }
}
