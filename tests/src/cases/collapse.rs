//! Loads beyond collapse against exact limit loads, and who locks on the way there.

use crate::paper::{prandtl, prandtl_load, prandtl_step};
use crate::problems::Fallible;
use crate::problems::collapsing::{cylinder, notch, sphere, strip};
use crate::problems::shapes::{Hole, PLANE_ELEMENTS};
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::driver::{Axis, Collapse, Driver, IncrementError, Settings, Step};
use moreau::laws::VonMises;
use moreau::mesh::{CellKind, Integration};
use moreau::plot::{Chart, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "collapse",
    long: false,
    alone: false,
    chapter: Chapter::Beyond,
    title: "Loads beyond collapse, and the elements that lock",
    description: "Five bodies of an elastic perfectly plastic material are given loads that they \
        cannot carry: a strip with a hole, a plate with deep notches, a thick cylinder, a hollow \
        sphere, and Prandtl's punch driven by a force. The load factor becomes an unknown, the path \
        is followed along the plateau, and its mechanism yields a kinematic bound: load and bound \
        enclose the limit load of the mesh, which tends to the exact one from above. A table shows \
        the limit loads of every plane element under every rule.",
    decks: &[
        "examples/cylinder-to-collapse.toml",
        "examples/strip-between-rough-platens.toml",
        "gallery/limit-load.py",
    ],
    run,
};

const HILL: &str = "Hill 1950, chapter V: exact";
const ENCLOSED: &str = "limit analysis: the load is the least of all kinematic bounds";

/// A body under more than it carries.
struct Overloaded {
    name: &'static str,
    driver: Driver<2>,
    step: Step<2>,
    /// Load of the step over the exact limit load.
    overload: f64,
    /// Least and largest load over the exact one.
    range: (f64, f64),
    /// Largest growth of the load while its work doubled, at the end.
    flat: f64,
    source: &'static str,
    /// Displacement that the load does work on \[mm\].
    motion: Box<dyn Fn(&Driver<2>) -> f64>,
}

/// Mean displacement of a group along an axis, in magnitude.
fn mean(group: &'static str, axis: Axis) -> Box<dyn Fn(&Driver<2>) -> f64> {
    Box::new(move |driver| {
        let nodes = driver.mesh().node_group(group).unwrap_or_default();
        let sum: f64 = nodes
            .iter()
            .map(|&n| driver.displacement(n)[axis.index()])
            .sum();
        sum.abs() / nodes.len() as f64
    })
}

fn bodies(quick: bool) -> Result<Vec<Overloaded>, Box<dyn Error>> {
    use CellKind::Quad8;
    use Integration::Reduced;
    let fine = if quick { 1 } else { 2 };
    let steel = VonMises::new(sphere::E, sphere::NU, sphere::YIELD)?;
    let punch = 1.25;
    Ok(vec![
        Overloaded {
            name: "strip with a round hole",
            driver: strip::body(Hole::Round, 3.0 * strip::WIDTH, Quad8, Reduced, 8 * fine)?,
            step: strip::held("pull").pressure("plate.top", -1.2 * strip::EXACT * strip::YIELD),
            overload: 1.2,
            range: (1.0 - 1e-4, 1.0 + 1.2e-2 / fine as f64),
            flat: 1e-4,
            source: "net section, exact",
            motion: mean("plate.top", Axis::Y),
        },
        Overloaded {
            name: "deep notches",
            driver: notch::body(Quad8, Reduced, 4 * fine)?,
            step: notch::held("pull").pressure("body.top", -1.5 * notch::exact() / 5.0),
            overload: 1.5,
            range: (1.0, 1.0 + 5e-2 / fine as f64),
            flat: 1e-2,
            source: "Nagtegaal, Parks and Rice 1974: (2 + π) k, exact",
            motion: mean("body.top", Axis::Y),
        },
        Overloaded {
            name: "thick cylinder",
            driver: cylinder::body(Quad8, Reduced, 8 * fine, 0.3)?,
            step: cylinder::held("press").pressure("body.left", 1.25 * cylinder::limit()),
            overload: 1.25,
            range: (1.0 - 1e-5, 1.0 + 1e-5),
            flat: Collapse::FLAT,
            source: HILL,
            motion: mean("body.left", Axis::X),
        },
        Overloaded {
            name: "hollow sphere",
            driver: sphere::body(steel)?,
            step: sphere::held("press").pressure("body.left", 2.0 * sphere::limit()),
            overload: 2.0,
            range: (1.0 - 2e-4, 1.0 + 2e-4),
            flat: Collapse::FLAT,
            source: HILL,
            motion: mean("body.left", Axis::X),
        },
        Overloaded {
            name: "Prandtl's punch, driven by a force",
            driver: prandtl(fine, Reduced, Settings::default())?,
            step: prandtl_step(0.0).push("punch", Axis::Y, -0.5 * punch * prandtl_load()),
            overload: punch,
            range: (1.0, 1.0 + 0.12 / fine as f64),
            flat: 1e-2,
            source: "Prandtl 1921, Hill 1950: exact",
            motion: Box::new(|driver| {
                driver
                    .tool_displacement("punch")
                    .map_or(f64::NAN, |u| -u[1])
            }),
        },
    ])
}

/// The collapse of a body, and its load over the exact one against its displacement over that of
/// the elastic body at the exact load.
fn loaded(body: &mut Overloaded) -> Fallible<(Collapse, Vec<[f64; 2]>)> {
    let mut curve = vec![[0.0, 0.0]];
    let ended = body.driver.run(&body.step, 20, |driver, report| {
        curve.push([(body.motion)(driver), body.overload * report.fraction]);
    });
    let collapse = match ended {
        Err(IncrementError::Collapse { collapse, .. }) => collapse,
        Err(error) => return Err(error.into()),
        Ok(_) => return Err(format!("{} carried its load", body.name).into()),
    };
    let elastic = curve[1][0] / curve[1][1];
    for point in &mut curve {
        point[0] /= elastic;
    }
    Ok((collapse, curve))
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut chart = Chart::new(
        "Loads that grow beyond collapse",
        "displacement over that of the elastic body at the limit load [–]",
        "load over the exact limit load [–]",
    );
    let mut rows = Vec::new();
    for mut body in bodies(options.quick)? {
        (options.progress)(body.name);
        let (collapse, curve) = loaded(&mut body)?;
        let load = body.overload * collapse.load_factor;
        let bound = collapse.upper_bound.ok_or("von Mises has a bound")?;
        let upper = body.overload * bound.load_factor;
        outcome.checks.extend(checks(&body, &collapse, load, upper));
        rows.push([
            body.name.into(),
            body.driver.mesh().cell_count().to_string(),
            format!("{load:.6}"),
            format!("{upper:.6}"),
            format!("{:.1e}", bound.elastic_share),
            format!("{:.1e}", collapse.growth),
            (curve.len() - 1).to_string(),
        ]);
        // Past the knee; the plateau goes on to displacements of the size of the body.
        let shown = curve.iter().position(|p| p[0] > SHOWN);
        let shown = curve[..shown.map_or(curve.len(), |k| k + 1)].to_vec();
        chart = chart.with(body.name, Style::Line, cut(shown));
    }
    let header = [
        "body",
        "cells",
        "load",
        "kinematic bound",
        "elastic share of the bound",
        "growth over the last doubling",
        "increments",
    ];
    let title = "Loads at collapse over the exact limit loads";
    outcome
        .tables
        .push(Table::new("collapse", title, header, rows));
    chart = chart.with("exact", Style::Dashed, vec![[0.0, 1.0], [SHOWN, 1.0]]);
    outcome.figures.push(Figure::new(
        "collapse-loads",
        "Loads over displacements to beyond the knee. Increments of the load up to it, along the \
            plateau increments of the path.",
        chart.to_svg()?,
    ));
    locking(options, &mut outcome)?;
    Ok(outcome)
}

/// Checks of the load over the exact one, of the bound over the load, and of the plateau.
fn checks(body: &Overloaded, collapse: &Collapse, load: f64, upper: f64) -> [Check; 5] {
    let name = |what: &str| format!("{}: {what}", body.name);
    let ratio = || name("load over the exact limit load");
    let bound = || name("bound over the load");
    [
        Check::at_least(ratio(), (load, "1"), body.range.0, body.source),
        Check::at_most(ratio(), (load, "1"), body.range.1, body.source),
        Check::at_least(bound(), (upper / load, "1"), 1.0 - 1e-9, ENCLOSED),
        Check::at_most(bound(), (upper / load, "1"), 1.0 + 1e-3, ENCLOSED),
        Check::at_most(
            name("growth of the load while its work doubled"),
            (collapse.growth.abs(), "1"),
            body.flat,
            "a plateau; where the mesh keeps creeping, as far as displacements of its size show it",
        ),
    ]
}

/// End of the axis of the figure.
const SHOWN: f64 = 10.0;

/// A curve ended at [`SHOWN`] on its last chord.
fn cut(mut curve: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let n = curve.len();
    if n > 1 && curve[n - 1][0] > SHOWN {
        let (a, b) = (curve[n - 2], curve[n - 1]);
        let part = (SHOWN - a[0]) / (b[0] - a[0]);
        curve[n - 1] = [SHOWN, a[1] + part * (b[1] - a[1])];
    }
    curve
}

/// Limit loads of the cylinder and the notch by every plane element, with the displacement given.
fn locking(options: &Options<'_>, outcome: &mut Outcome) -> Result<(), Box<dyn Error>> {
    use CellKind::{Quad4, Quad8};
    use Integration::{BBar, Full, Reduced};
    // The tests compare all of them on coarse meshes.
    let brief = |(kind, rule): &(CellKind, Integration)| {
        !options.quick || matches!((kind, rule), (Quad4, _) | (Quad8, Reduced))
    };
    let cells: &[usize] = if options.quick { &[2] } else { &[2, 4, 8] };
    let mut rows = Vec::new();
    for (kind, rule) in PLANE_ELEMENTS.into_iter().filter(brief) {
        let rule_name = match rule {
            Reduced => "reduced",
            Full => "full",
            BBar => "b-bar",
        };
        let default = rule == kind.integration();
        let name = format!("{kind}, {rule_name}");
        (options.progress)(&name);
        for &n in cells {
            let (pressure, _) = cylinder::collapse(kind, rule, 2 * n)?;
            let (stress, slope) = notch::net_stress(kind, rule, n)?;
            let mut add = |what: &str, value: f64, bound, limit| {
                let name = format!("{name}, {n}: {what}");
                let source = "exact limit load, from above, on a plateau; or locking";
                outcome
                    .checks
                    .push(Check::new(name, (value, "1"), bound, (limit, 0.0), source));
            };
            let net = "net stress at the notch over the exact one";
            // What flows is below this on every mesh, what locks is above.
            let between = 1.0 + 0.24 / n as f64;
            if kind.locks(rule) {
                add(net, stress, Kind::AtLeast, between);
            } else {
                add(net, stress, Kind::AtLeast, 1.0);
                add(net, stress, Kind::AtMost, between);
                add("final slope at the notch", slope, Kind::AtMost, 1e-3);
            }
            rows.push([
                name.clone(),
                if default { "default" } else { "on demand" }.into(),
                if kind.locks(rule) { "locks" } else { "flows" }.into(),
                n.to_string(),
                format!("{pressure:.6}"),
                format!("{stress:.4}"),
                format!("{slope:.1e}"),
            ]);
        }
    }
    let header = [
        "element, quadrature",
        "rule",
        "in flow",
        "cells in half the ligament, half of those in the wall",
        "pressure of the cylinder",
        "net stress at the notch",
        "final slope at the notch over the elastic one",
    ];
    let title = "Limit loads over the exact ones by element and rule";
    outcome
        .tables
        .push(Table::new("collapse-locking", title, header, rows));
    Ok(())
}
