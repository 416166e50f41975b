//! Where the axes of a material point: forces of a body against the stiffness and the strength of its laminate.

use moreau::deck::Given;
use moreau::simulation::Simulation;
use std::ops::ControlFlow;

const STRAIN: f64 = 1e-3;
const YOUNG: [f64; 3] = [12e4, 9e3, 5e3];
const POISSON: [f64; 3] = [0.4, 0.45, 0.6];
const SHEAR: [f64; 3] = [8e3, 7e3, 6e2];

/// Forces at the end of the only step, by the names of their columns.
fn forces<const N: usize>(deck: &str, columns: [&str; N]) -> [f64; N] {
    let (simulation, findings) = Simulation::open(deck, ".".as_ref(), &Given::default());
    let shown = || findings.render("deck.toml", deck, false);
    let mut simulation = simulation.unwrap_or_else(|| panic!("{}", shown()));
    let mut advance = || simulation.advance(&mut |_, _| ControlFlow::Continue(()));
    while advance().expect("an increment").is_some() {}
    columns.map(|name| {
        let numbers = simulation.history().numbers(name);
        *numbers.last().unwrap_or_else(|| panic!("no column {name}"))
    })
}

/// A sheet of unit width and thickness, twice as long, stretched along x by 1 ‰ and more.
fn sheet(material: &str, held: &str, more: f64) -> String {
    format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-stress"
mesh.block = [{{ name = "b", element = "quad4", x = [0, 2], y = [0, 1], cells = [1, 1] }}]
[[material]]
on = "b"
{material}
[[step]]
name = "pull"
increments = 2
fix = [{{ on = "b.left", u = ["x"] }}, {{ on = "b.bottom", u = ["y"] }}{held}]
move = [{{ on = "b.right", u = {{ x = {} }} }}]
"#,
        2.0 * more * STRAIN
    )
}

fn close(found: f64, expected: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= 1e-9 * expected.abs(), "{what}: {found} {expected}");
}

/// Q̄₁₁ and Q̄₁₆ of a layer at an angle, counter-clockwise from x (R. M. Jones, *Mechanics of Composite Materials*, 2.6).
#[test]
fn a_layer_at_an_angle_has_the_stiffness_of_its_laminate() {
    let ([e1, e2, _], nu12, q66) = (YOUNG, POISSON[0], SHEAR[0]);
    let whole = 1.0 - nu12 * nu12 * e2 / e1;
    let (q11, q22, q12) = (e1 / whole, e2 / whole, nu12 * e2 / whole);
    for degrees in [0.0f64, 30.0, -50.0, 90.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let q_11 = q11 * c.powi(4) + 2.0 * (q12 + 2.0 * q66) * (s * c).powi(2) + q22 * s.powi(4);
        let q_16 =
            (q11 - q12 - 2.0 * q66) * s * c.powi(3) + (q12 - q22 + 2.0 * q66) * s.powi(3) * c;
        let material = format!(
            "orthotropic = {{ young = {YOUNG:?}, poisson = {POISSON:?}, shear = {SHEAR:?} }}\naxes = {degrees:?}"
        );
        let held = ", { on = \"b.top\", u = [\"y\"] }, { on = \"b.right\", u = [\"y\"] }";
        let columns = ["force.b.right.x", "force.b.right.y"];
        let [along, across] = forces(&sheet(&material, held, 1.0), columns);
        close(along, q_11 * STRAIN, &format!("{degrees}°"));
        let off = (across - q_16 * STRAIN).abs();
        assert!(off <= 1e-9 * along, "{degrees}°: {across}");
    }
}

/// In space, with the first axis along y, the second along z and the third along x: C₃₃, C₁₃ and C₂₃.
#[test]
fn axes_in_space_are_those_of_the_moduli() {
    let ([e1, e2, e3], [nu12, nu13, nu23]) = (YOUNG, POISSON);
    let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
    let whole = 1.0 - nu12 * nu21 - nu23 * nu32 - nu31 * nu13 - 2.0 * nu21 * nu32 * nu13;
    let c33 = (1.0 - nu12 * nu21) * e3 / whole;
    let c13 = (nu31 + nu21 * nu32) * e1 / whole;
    let c23 = (nu32 + nu12 * nu31) * e2 / whole;
    let deck = format!(
        r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{{ name = "b", element = "hex8", x = [0, 1], y = [0, 1], z = [0, 1], cells = [1, 1, 1] }}]
[[material]]
on = "b"
orthotropic = {{ young = {YOUNG:?}, poisson = {POISSON:?}, shear = {SHEAR:?} }}
axes = [[0, 2, 0], [0, 1, 3]]
[[step]]
name = "pull"
increments = 1
fix = [
  {{ on = "b.left", u = ["x"] }},
  {{ on = "b.bottom", u = ["y"] }},
  {{ on = "b.top", u = ["y"] }},
  {{ on = "b.back", u = ["z"] }},
  {{ on = "b.front", u = ["z"] }},
]
move = [{{ on = "b.right", u = {{ x = {STRAIN} }} }}]
"#
    );
    let columns = ["force.b.right.x", "force.b.top.y", "force.b.front.z"];
    let found = forces(&deck, columns);
    for ((found, expected), name) in found.into_iter().zip([c33, c13, c23]).zip(columns) {
        close(found, expected * STRAIN, name);
    }
}

/// Along and across the direction in which a sheet was rolled: σ_y, and σ_y √((G + H)/(F + H)) = σ_y √(r₉₀ (1 + r₀)/(r₀ (1 + r₉₀))).
#[test]
fn a_rolled_sheet_is_as_strong_as_its_ratios_say() {
    let (r0, r90) = (1.8f64, 2.3f64);
    let across = (r90 * (1.0 + r0) / (r0 * (1.0 + r90))).sqrt();
    for (degrees, factor) in [(0, 1.0), (90, across), (180, 1.0)] {
        let material = format!(
            "young = 210000.0\npoisson = 0.3\nyield-stress = 300.0\n\
             hill = {{ r0 = {r0}, r45 = 1.2, r90 = {r90} }}\naxes = {degrees}"
        );
        let [force] = forces(&sheet(&material, "", 10.0), ["force.b.right.x"]);
        close(force, 300.0 * factor, &format!("{degrees}°"));
    }
}
