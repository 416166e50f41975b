//! What is too much for one increment: tools that go farther over a surface than its facets, and strains.

use super::*;

/// The warning of a kind, if there is one, and how many increments it asks for.
fn asked(simulation: &Simulation, kind: &str) -> Option<usize> {
    let warnings = simulation.outcome().warnings;
    let told = warnings.iter().find(|w| w.contains(kind))?;
    let (_, rest) = told.split_once("use increments = ").expect("a number");
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    Some(digits.parse().expect("a number"))
}

fn last(simulation: &Simulation, column: &str) -> f64 {
    *simulation.history().numbers(column).last().expect("a row")
}

/// A tool that is pressed into a block, and then goes along it.
fn slid(shape: &str, yields: &str, [x, y]: [f64; 2], increments: usize) -> Simulation {
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad4"
x = [0, 12]
y = [0, 4]
cells = [24, 4]
[[material]]
on = "b"
young = 70e3
poisson = 0.33
{yields}
[[tool]]
name = "roll"
{shape}
[[contact]]
surface = "b.top"
against = "roll"
friction = 0.1
[[step]]
name = "press"
increments = 3
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [0, -0.1] }}]
[[step]]
name = "slide"
increments = {increments}
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [{x}, {y}] }}]
"#
    )))
}

const YIELDS: &str = "yield-stress = 100.0\nhardening = { linear = 500 }";
const ROLL: &str = "cylinder = { center = [4, 9], radius = 5 }";

/// A roll that irons a block in steps longer than a facet is told with how many would do, and is not with those; a plate that
/// slides is not, whose place of contact stays, nor a roll on a body that does not yield.
#[test]
fn a_tool_that_goes_farther_than_a_facet_is_told() {
    let told = "along \"b.top\" in increment";
    let coarse = slid(ROLL, YIELDS, [3.0, -0.1], 4);
    let enough = asked(&coarse, told).expect("told");
    assert!((20..=32).contains(&enough), "{enough}");
    assert_eq!(asked(&slid(ROLL, YIELDS, [3.0, -0.1], enough), told), None);
    assert_eq!(
        asked(&slid(ROLL, YIELDS, [-3.0, -0.1], 4), told).map(|n| n / 10),
        Some(enough / 10)
    );
    let plate = "plane = { point = [0, 4], normal = [0, -1] }";
    assert_eq!(asked(&slid(plate, YIELDS, [3.0, -0.1], 4), told), None);
    assert_eq!(asked(&slid(ROLL, "", [3.0, -0.1], 4), told), None);
}

/// A roll that comes down onto a block askew has gone over nothing of it.
#[test]
fn a_tool_that_comes_from_afar_has_gone_over_nothing() {
    let afar = "cylinder = { center = [4, 9.3], radius = 5 }";
    let come = slid(afar, YIELDS, [2.0, -0.4], 1);
    assert!(last(&come, "force.roll.y") < -100.0);
    assert_eq!(asked(&come, "along \"b.top\" in increment"), None);
}

/// A billet between platens, upset to half of its height.
fn upset(increments: usize, yields: &str, way: f64) -> Simulation {
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 5]
y = [0, 5]
cells = [5, 5]
[[material]]
on = "b"
young = 210e3
poisson = 0.3
{yields}
[[tool]]
name = "p"
plane = {{ point = [0, 5], normal = [0, -1] }}
[[contact]]
surface = ["b.top", "b.right"]
against = "p"
friction = 0.1
[[step]]
name = "upset"
increments = {increments}
fix = [{{ on = "b.bottom", u = ["y"] }}]
tools = [{{ name = "p", move = [0, -{way}] }}]
"#
    )))
}

/// Increments that strain a billet by as much as to make its force wrong by percents are told; those that it is told to take
/// make it right to a percent. One of elastic strains is not told, however large they are.
#[test]
fn strains_too_large_for_an_increment_are_told() {
    let told = "strains are large for one increment";
    let yields = "yield-stress = 300.0\nhardening = { linear = 500 }";
    let force = |run: &Simulation| last(run, "force.p.y");
    let (coarse, fine) = (upset(2, yields, 2.5), upset(50, yields, 2.5));
    let enough = asked(&coarse, told).expect("told");
    let right = upset(enough, yields, 2.5);
    let off = |run: &Simulation| (force(run) / force(&fine) - 1.0).abs();
    assert!(off(&coarse) > 0.05, "{}", off(&coarse));
    assert!(off(&right) < 0.01, "{enough}: {}", off(&right));
    assert_eq!((asked(&right, told), asked(&fine, told)), (None, None));
    assert_eq!(asked(&upset(2, "", 1.2), told), None);
}
