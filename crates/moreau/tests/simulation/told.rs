//! Contact points whose force is rounding: none of them sticks or slips.

use super::*;

/// A block is squeezed and let go: what touches it then bears nothing, and is open in all that is told.
#[test]
fn what_bears_nothing_is_told_as_open() {
    let mut freed = simulation(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 2]
y = [0, 2]
z = [0, 1]
cells = [3, 3, 2]
[[material]]
on = "b"
young = 1000
poisson = 0.3
[[tool]]
name = "lo"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[tool]]
name = "up"
plane = { point = [0, 0, 1], normal = [0, 0, -1] }
[[contact]]
surface = "b.back"
against = "lo"
friction = 0.3
[[contact]]
surface = "b.front"
against = "up"
friction = 0.3
[[step]]
name = "press"
increments = 2
fix = [{ on = "b.left", u = ["x"] }, { on = "b.bottom", u = ["y"] }]
tools = [{ name = "up", move = [0, 0, -0.01] }]
[[step]]
name = "let-go"
increments = 2
fix = [{ on = "b.left", u = ["x"] }, { on = "b.bottom", u = ["y"] }]
tools = [{ name = "up", move = [0, 0, 0.02] }]
"#,
    );
    let mut told = Vec::new();
    while advance(&mut freed) {
        let contacts = freed.contacts();
        let grid = freed.surface().expect("contacts");
        let drawn = grid.point_data.iter().find(|a| a.name == "status");
        let drawn = &drawn.expect("a field").values;
        let counts = ["open", "stick", "slip"].map(|status| {
            let listed = contacts.texts("status");
            let listed = listed.iter().filter(|s| **s == status).count();
            // The corner of both sides is held along the surface, and not counted as sticking.
            let held = if status == "stick" { listed.min(2) } else { 0 };
            let counted = freed.history().numbers(status).last().copied();
            assert_eq!(counted, Some((listed - held) as f64), "{status}");
            listed
        });
        let code = |code: f64| drawn.iter().filter(|s| **s == code).count();
        assert_eq!(counts, [code(0.0), code(1.0), code(2.0)]);
        told.push(counts);
    }
    assert!(told[..2].iter().all(|[open, ..]| *open == 0), "{told:?}");
    assert!(told[2..].iter().all(|t| *t == [32, 0, 0]), "{told:?}");
    assert_eq!(freed.outcome().contacts, [32, 0, 0]);
}
