//! A limit of the shear that knows no pressure, where bodies come to press on each other and part again.

use super::*;

/// A block on a floor that sticks to it less and less as a punch with round corners presses it and goes up again.
fn stamped(strain: &str, law: &str) -> Simulation {
    simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh = {{ block = [{{ name = "block", element = "quad8", x = [-6, 6], y = [0, 3], cells = [9, 3] }}] }}
material = [{{ on = "block", young = 210e3, poisson = 0.0, yield-stress = 630.0 }}]
[[tool]]
name = "punch"
profile = {{ points = [[2.5, 6], [1.5, 3], [-1.8, 3], [-2.8, 6]], radii = [0.8, 0.8] }}
[[tool]]
name = "floor"
plane = {{ point = [0, 0], normal = [0, 1] }}
[[contact]]
surface = ["block.top", "block.right"]
against = "punch"
friction = {{ {law} }}
[[contact]]
surface = "block.bottom"
against = "floor"
friction = 0.2
[[step]]
name = "down"
increments = 6
fix = [{{ on = "block.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, -0.01] }}]
[[step]]
name = "less"
increments = {{ start = 0.05, min = 1e-5, max = 0.5 }}
fix = [{{ on = "block.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, -0.003] }}]
[[step]]
name = "up"
increments = 2
fix = [{{ on = "block.left", u = ["x"] }}, {{ on = "block.bottom", u = ["y"] }}]
tools = [{{ name = "punch", move = [0, 0.1] }}]
"#
    ))
}

/// What presses is sheared as far as the limit, what does not is not, after every increment; and a punch that is away has
/// no force. Where surfaces press by more than the limit the law is Coulomb's with that limit.
#[test]
fn shears_of_given_limits_act_where_bodies_press() {
    for strain in ["small", "finite"] {
        let mut block = stamped(strain, "tresca = 21.0");
        let mut slips = 0;
        while advance(&mut block) {
            let contacts = block.contacts();
            let surfaces = contacts.texts("contact");
            let [t_n, t_1, p_1, gap] = ["t_n", "t_1", "p_1", "gap"].map(|c| contacts.numbers(c));
            for i in (0..t_n.len()).filter(|&i| surfaces[i] != "block.bottom") {
                let what = format!("{strain}: {} N, {} MPa over {} mm", t_1[i], p_1[i], gap[i]);
                assert!(p_1[i].abs() < 21.0 + 1e-6, "{what}");
                assert!(
                    t_n[i] > 0.0 || gap[i] < 1e-9 || t_1[i].abs() < 1e-9,
                    "{what}"
                );
                slips += usize::from((p_1[i].abs() - 21.0).abs() < 1e-6);
            }
        }
        assert!(slips > 10, "{strain}: {slips}");
        let other = finish(stamped(strain, "coulomb = 1.0, tau-max = 21.0"));
        let [own, limited] = [&block, &other].map(|s| s.history().numbers("force.punch.y"));
        assert!(
            block.history().numbers("cuts").iter().all(|&n| n == 0.0),
            "{strain}"
        );
        assert_eq!(own.last(), Some(&0.0), "{strain}");
        // Where the pressure is below the limit they differ.
        for i in 0..6 {
            assert!(
                (own[i] - limited[i]).abs() < 2e-2 * limited[i].abs(),
                "{strain}: {own:?} {limited:?}"
            );
        }
    }
}

/// A cylinder on a floor under a ball that goes up again: as its rim is released, the iterate is in balance to the last
/// digit, and the law does not hold.
#[test]
fn what_is_released_in_balance_finds_its_place() {
    let block = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "axisymmetric"
mesh = { block = [{ name = "block", element = "quad9", x = [0, 6], y = [0, 6], cells = [6, 4] }] }
[[material]]
on = "block"
young = 210e3
poisson = 0.2
yield-stress = 210.0
hardening = { voce = [210.0, 10] }
hill = { f = 0.4, g = 0.6, h = 0.5, l = 1.5, m = 1.4, n = 1.3 }
[[tool]]
name = "ball"
sphere = { center = [0, 9], radius = 3 }
[[tool]]
name = "floor"
plane = { point = [0, 0], normal = [0, 1] }
[[contact]]
surface = "block.top"
against = "ball"
friction = 0.6
[[contact]]
surface = "block.bottom"
against = "floor"
friction = { tresca = 21.0 }
[[step]]
name = "down"
increments = 1
fix = [{ on = "block.left", u = ["x"] }]
tools = [{ name = "ball", move = [0, -0.06] }]
[[step]]
name = "up"
increments = { start = 0.05, min = 1e-5, max = 0.5 }
fix = [{ on = "block.left", u = ["x"] }]
tools = [{ name = "ball", move = [0, 0.1] }]
"#,
    ));
    let of = |name: &str| block.history().numbers(name);
    assert!(of("cuts").iter().all(|&n| n == 0.0));
    let [ball, floor] = ["ball", "floor"].map(|t| of(&format!("force.{t}.y")));
    assert!(ball[0] < -1e3, "{ball:?}");
    for (a, b) in ball.iter().zip(&floor) {
        assert!((a + b).abs() < 1e-6, "{ball:?} {floor:?}");
    }
    assert!(ball[ball.len() - 1].abs() < 1e-9, "{ball:?}");
}
