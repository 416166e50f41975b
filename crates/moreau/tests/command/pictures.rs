//! Pictures and the report, drawn from the files of a run.

use super::{BALL, moreau, punched, run, text};
use std::fs;
use std::path::Path;

/// From files alone: the same pictures, others on demand, and a report that needs no network.
#[test]
fn a_run_is_drawn_again_from_its_files() {
    let (status, _, err, results) = run("draw", &punched(), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let usual = || {
        ["history.svg", "contact.svg", "deformed.svg", "report.html"]
            .map(|f| fs::read(results.join(f)).expect("a picture"))
    };
    let before = usual();
    let at = results.to_str().expect("a path");
    assert_eq!(moreau(&["plot", at]).status.code(), Some(0));
    assert!(before == usual());
    let one = "--field displacement.y --increment 7 --scale 3";
    let one: Vec<&str> = ["plot", at].into_iter().chain(one.split(' ')).collect();
    let output = moreau(&one);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let svg = fs::read_to_string(results.join("deformed-displacement.y-7.svg"));
    assert!(svg.expect("a picture").contains("displacement.y [mm]"));
    assert!(results.join("contact-7.svg").exists());
    let output = moreau(&["plot", at, "--png"]);
    if cfg!(feature = "png") {
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        for name in ["history.png", "contact.png", "deformed.png"] {
            let png = fs::read(results.join(name)).expect("a picture");
            assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n", "{name}");
        }
    } else {
        assert_eq!(output.status.code(), Some(1));
        let told = text(&output.stderr);
        assert!(told.contains("feature `png`") && told.contains("--features png"));
    }
    for (key, value, named) in [
        ("--field", "vonmises", "did you mean von_mises?"),
        ("--increment", "21", "1 to 20"),
    ] {
        let output = moreau(&["plot", at, key, value]);
        assert_eq!(output.status.code(), Some(1));
        let told = text(&output.stderr);
        assert!(told.contains(value) && told.contains(named), "{told}");
    }

    // Nothing to take a field from.
    let bare = punched().replace("[[step]]", "[output]\nvtu = \"none\"\n[[step]]");
    let (status, _, err, results) = run("draw-bare", &bare, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let output = moreau(&["plot", results.to_str().expect("a path"), "--field", "nope"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("nope") && told.contains("vtu = \"none\""),
        "{told}"
    );

    let page = text(&before[3]);
    let outside = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!outside.contains("http") && !outside.contains("src="));
    let data = page.split("id=\"data\">").nth(1);
    let data = data.and_then(|d| d.split("</script>").next());
    let data: serde_json::Value = serde_json::from_str(data.expect("data")).expect("json");
    assert_eq!(data["frames"].as_array().map(Vec::len), Some(20));
    assert_eq!(data["faces"].as_array().map(Vec::len), Some(20));
    let punch = data["frames"][19]["values"]["displacement.y"]["low"].as_f64();
    assert!((punch.expect("a number") + 0.2).abs() < 1e-12);
    // The contact line of every frame: pressures and shears of the floor at 21 points.
    let contact = &data["contact"];
    assert_eq!(contact["frames"].as_array().map(Vec::len), Some(20));
    assert_eq!(contact["surfaces"][0]["name"], "block.bottom");
    let most = |frame: usize| contact["frames"][frame][0][0]["high"].as_f64();
    let rows = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    for frame in [0, 19] {
        let field = |line: &str, k: usize| line.split(',').nth(k).map(str::to_owned);
        let own = (frame + 1).to_string();
        let found = rows.lines().filter(|l| field(l, 1) == Some(own.clone()));
        let pressures = found.filter_map(|l| field(l, 15)?.parse::<f64>().ok());
        let found = pressures.reduce(f64::max).expect("a pressure");
        let shown = most(frame).expect("a number");
        assert!((shown / found - 1.0).abs() < 1e-12, "{shown} {found}");
    }
    assert!(page.contains("Certificate of every increment") && page.contains("force.punch.y"));
    assert!(page.contains("[[mesh.block]]"));
}

/// The contact surface of a body in space: every facet and every point of it in each frame, with the
/// values of `contact.csv`; the run is drawn again from its files.
#[test]
fn a_contact_surface_in_space_is_in_the_report() {
    let (status, _, err, results) = run("face", BALL, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let page = fs::read(results.join("report.html")).expect("a report");
    let output = moreau(&["plot", results.to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(page == fs::read(results.join("report.html")).expect("a report"));
    let page = text(&page);
    let drawn = |name: &str| fs::read_to_string(results.join(name)).expect("a picture");
    let (body, touched) = (drawn("deformed.svg"), drawn("contact.svg"));
    assert!(page.contains(&body) && page.contains(&touched));
    assert!(body.contains("von Mises stress [MPa]") || body.contains("equivalent plastic strain"));
    // A dot for every point, and how many of each status.
    let dots = touched.matches("<circle").count();
    let keys = ["open: ", "stick: ", "slip: "].map(|k| {
        let count = touched.split(&format!(">{k}")).nth(1);
        count.map_or(0, |c| {
            c.split('<')
                .next()
                .and_then(|c| c.parse().ok())
                .unwrap_or(0)
        })
    });
    let shown = keys.iter().filter(|k| **k > 0).count();
    assert_eq!(keys.iter().sum::<usize>(), 25);
    assert_eq!(dots, 25 + shown);
    let data = page.split("id=\"data\">").nth(1);
    let data = data.and_then(|d| d.split("</script>").next());
    let data: serde_json::Value = serde_json::from_str(data.expect("data")).expect("json");
    let contact = &data["contact"];
    let count = |key: &str| contact[key].as_array().map(Vec::len);
    // 4 × 4 faces on the top of the block.
    assert_eq!((count("faces"), count("points")), (Some(16), Some(25)));
    assert_eq!((count("frames"), count("statuses")), (Some(2), Some(3)));
    let rows = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    let of = |frame: usize, value: &dyn Fn(&[&str]) -> f64| -> [f64; 2] {
        let rows = rows.lines().map(|l| l.split(',').collect::<Vec<_>>());
        let own = rows.filter(|r| r[1] == (frame + 1).to_string());
        let values = own.map(|r| value(&r));
        values.fold([f64::INFINITY, -f64::INFINITY], |[l, h], v| {
            [l.min(v), h.max(v)]
        })
    };
    let number = |row: &[&str], k: usize| row[k].parse::<f64>().expect("a number");
    for frame in 0..2 {
        let shown = |name: &str| {
            let field = &contact["frames"][frame][name];
            ["low", "high"].map(|key| field[key].as_f64().expect("a number"))
        };
        let shear = |r: &[&str]| number(r, 16).hypot(number(r, 17));
        for (name, found) in [
            ("gap", of(frame, &|r| number(r, 9))),
            ("pressure", of(frame, &|r| number(r, 15))),
            ("shear", of(frame, &shear)),
        ] {
            for (shown, found) in shown(name).into_iter().zip(found) {
                assert!(
                    (shown - found).abs() <= 1e-12 * found.abs(),
                    "{name}: {shown} {found}"
                );
            }
        }
        // Open beside the ball, closed below it.
        let [low, high] = shown("status");
        assert!(low == 0.0 && high >= 1.0, "{low} {high}");
        assert!(shown("pressure")[1] > 0.0 && shown("shear")[1] > 0.0);
    }
}

/// Under loads alone what holds a body may be nothing but the rounding of forces in balance: what is
/// drawn is how far it goes.
#[test]
fn rounding_is_not_drawn_as_a_force() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "axisymmetric"
mesh.block = [{ name = "wall", element = "quad8", x = [1, 2], y = [0, 1], cells = [4, 1] }]
material = [{ on = "wall", young = 1000.0, poisson = 0.3 }]
step = [{ name = "press", increments = 2, fix = [{ on = "wall", u = ["y"] }], load = LOAD }]
"#;
    let drawn = |name: &str, load: &str| {
        let (status, _, err, results) = run(name, &deck.replace("LOAD", load), &["--quiet"]);
        assert_eq!(status, 0, "{err}");
        fs::read_to_string(results.join("history.svg")).expect("a picture")
    };
    let pressed = drawn("rounding", "[{ on = \"wall.left\", pressure = 5 }]");
    assert!(pressed.contains("mean displacement [mm]") && !pressed.contains("force [N]"));
    let pulled = drawn("force", "[{ on = \"wall\", body-force = [0, 1] }]");
    assert!(pulled.contains("force [N]") && pulled.contains("wall.y"));
}

/// The corner of a pad that is held has no multiplier of its own: what is shown there is what its
/// neighbours carry, not a gap and not zero; the nodal forces are as they are.
#[test]
fn a_held_corner_is_no_hole_in_the_pressure() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [
  { name = "pad", element = "quad4", x = [0, 4], y = [2, 3], cells = [4, 1] },
  { name = "base", element = "quad4", x = [0, 4], y = [0, 2], cells = [4, 2] },
]
material = [
  { on = "pad", young = 1000.0, poisson = 0.0 },
  { on = "base", young = 1000.0, poisson = 0.0 },
]
contact = [{ surface = "pad.bottom", against = "base.top", friction = 0.3 }]
[[step]]
name = "press"
increments = 1
fix = [{ on = "base.bottom", u = ["x", "y"] }]
move = [
  { on = "pad.top", u = { x = 0, y = -0.03 } },
  { on = "corner", u = { x = 0, y = -0.02 } },
]
[[mesh.group]]
name = "corner"
on = "pad.bottom"
nearest = [0, 2]
"#;
    // The corner goes where it would go by itself: pad and base are squeezed alike, 1000 · 0.03 / 3.
    let (status, _, err, results) = run("held", deck, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let table = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    let at = |name: &str| {
        rows[0]
            .iter()
            .position(|n| n.split(' ').next() == Some(name))
    };
    let [gap, pressure, status] = ["gap", "p_n", "status"].map(|n| at(n).expect("a column"));
    assert_eq!(rows.len(), 1 + 5);
    let force = at("t_n").expect("a column");
    assert!(rows[1..].iter().any(|r| r[force] == "0"), "one is held");
    for row in &rows[1..] {
        let number = |k: usize| row[k].parse::<f64>().expect("a number");
        assert!((number(pressure) - 10.0).abs() < 1e-9, "{row:?}");
        assert!(
            number(gap).abs() < 1e-12 && row[status] != "open",
            "{row:?}"
        );
    }
}

/// Before anything is computed: a picture of every step, with what is held, moved, pressed and touched.
#[test]
fn a_deck_is_drawn_before_it_is_run() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("planned");
    fs::create_dir_all(&folder).expect("a folder");
    let drawn = |deck: &str| {
        let deck = format!(
            "{}/../../docs/examples/{deck}.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        let picture = folder.join("plan.svg");
        let output = moreau(&[
            "check",
            &deck,
            "--picture",
            picture.to_str().expect("a path"),
        ]);
        (output.status.code(), text(&output.stderr))
    };
    assert_eq!(drawn("block-under-driven-roll").0, Some(0));
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("a picture");
    let (first, second) = (read("plan.svg"), read("plan-2.svg"));
    for (svg, words) in [
        (
            &first,
            [">roll: (0, −1000) N<", ">roll: touches, friction 0.1<"],
        ),
        (&second, [">roll: (0, −250) N<", ": step relax<"]),
    ] {
        for word in words {
            assert!(svg.contains(word), "{word} in {svg}");
        }
    }
    assert_eq!(drawn("tube-blown-up").0, Some(0));
    assert!(read("plan.svg").contains(">pressure 400 MPa<"));
    // The base of a support is across its direction, (−1/2, √3/2); on paper y points downwards.
    assert_eq!(drawn("sector-of-tube").0, Some(0));
    let svg = read("plan.svg");
    let across = |path: &&str| {
        let path = path.split(" d=\"m").nth(1).expect("a path");
        let path = path.split('z').next().expect("an end");
        let path = path.replace('-', " -").replace('l', " ");
        let x: Vec<f64> = path
            .split_whitespace()
            .filter_map(|x| x.parse().ok())
            .collect();
        // Each from the place before.
        let base = [x[4], x[5]];
        (base[1] + base[0] / 3f64.sqrt()).abs() < 0.05 * base[0].abs()
    };
    let supports = || svg.split("<path").filter(|path| path.contains("#1a7f4b"));
    let skew = supports().filter(across).count();
    assert!(skew > 3 && skew < supports().count(), "{skew} in {svg}");
    // A solid: tools as veils, its contact and what moves, and supports that it hides faint.
    assert_eq!(drawn("punch-in-space").0, Some(0));
    let svg = read("plan.svg");
    for word in [
        ">punch: (0, 0, −0.1) mm<",
        ">punch: touches, friction 0.2<",
        "fill-opacity",
        "opacity=\"0.3\"",
    ] {
        assert!(svg.contains(word), "{word} in {svg}");
    }
    assert_eq!(drawn("pad-dragged-over-plate").0, Some(0));
    assert!(read("plan.svg").contains(">pressure 10 MPa<"));
    let second = read("plan-2.svg");
    assert!(second.contains(">(0.3, 0, 0.4) mm<") && second.contains(": step drag<"));
}

/// Files of a run that somebody removed are not drawn, and keep none of the others from it.
#[test]
fn what_was_removed_is_not_drawn() {
    let (status, _, err, results) = run("removed", &punched(), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    fs::remove_file(results.join("body_00007.vtu")).expect("a body");
    let at = results.to_str().expect("a path");
    let output = moreau(&["plot", at]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let output = moreau(&["plot", at, "--increment", "7"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains("the body of increment 7"), "{told}");
}
