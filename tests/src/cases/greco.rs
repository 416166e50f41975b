//! The block of the GRECO group: opening, slip and stick at once.
//!
//! Source: M. Raous, P. Chabrand and F. Lebon, *Journal de Mécanique Théorique et Appliquée*,
//! special issue (1988) 111-128; also SSNV128 of Code_Aster's validation manual.

use crate::problems::greco::{block, slip, squeeze};
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::driver::Settings;
use moreau::laws::Status;
use moreau::mesh::CellKind;
use moreau::plot::{Chart, Style};
use nalgebra::Vector2;
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "greco",
    chapter: Chapter::Beyond,
    title: "Block on a rigid floor, friction of one (GRECO)",
    description: "An elastic block is pressed on a rigid floor from above and, three times as hard, \
        from the side, with a coefficient of friction of one: the reference of two-dimensional \
        friction, where points are open, slip and stick at once and neither a step size nor a \
        penalty can influence the answer.",
    run,
};

const PUBLISHED: &str = "mean of codes (Raous, Chabrand, Lebon 1988; Code_Aster SSNV128)";
const CONVERGED: &str = "independent implementation, converged";

/// Position along the floor \[mm\] and slip \[µm\].
const MEANS: [(f64, f64); 5] = [
    (0.0, 28.6),
    (1.25, 27.2),
    (5.0, 22.8),
    (7.5, 19.8),
    (11.25, 15.0),
];
const SLIPS: [(f64, f64); 8] = [
    (0.0, 28.60),
    (1.25, 27.22),
    (5.0, 22.87),
    (7.5, 19.81),
    (10.0, 16.85),
    (11.25, 15.41),
    (15.0, 11.33),
    (20.0, 6.457),
];
/// Where points are open, from where they slip, from where they stick \[mm\].
const ZONES: [f64; 2] = [3.1, 29.5];

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let n = if options.quick { 16 } else { 64 };
    (options.progress)(&format!("{n} × {n} cells"));
    let mut driver = block(CellKind::Quad8, n, Settings::default())?;
    let reports = driver.run(&squeeze(), 1, |_, _| {})?;
    let mut add = |name: String, value: (f64, &str), kind, reference, source: &str| {
        outcome
            .checks
            .push(Check::new(name, value, kind, reference, source));
    };
    for (list, source, tolerance) in [(&MEANS[..], PUBLISHED, 5e-2), (&SLIPS[..], CONVERGED, 3e-3)]
    {
        for &(x, u) in list {
            let name = format!("slip: at {x} mm");
            add(
                name,
                (slip(&driver, x), "µm"),
                Kind::Relative,
                (u, tolerance),
                source,
            );
        }
    }
    let sum: Vector2<f64> = driver.contacts().iter().map(|c| c.t).sum();
    add(
        "normal force".into(),
        (sum[0], "N/mm"),
        Kind::Relative,
        (2000.0, 1e-10),
        "equilibrium",
    );
    add(
        "tangential force".into(),
        (sum[1], "N/mm"),
        Kind::Relative,
        (-1405.4, 3e-3),
        CONVERGED,
    );
    // Statuses beyond half an edge of the borders of the zones.
    let half = 20.0 / n as f64;
    let expected = |x: f64| match x {
        x if x < ZONES[0] - half => Some(Status::Open),
        x if x > ZONES[0] + half && x < ZONES[1] - half => Some(Status::Slip),
        x if x > ZONES[1] + half => Some(Status::Stick),
        _ => None,
    };
    let mut contacts = driver.contacts().to_vec();
    contacts.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
    let wrong = contacts
        .iter()
        .filter(|c| expected(c.position[0]).is_some_and(|s| s != c.status));
    add(
        "points whose status is not that of their zone".into(),
        (wrong.count() as f64, "points"),
        Kind::AtMost,
        (0.0, 0.0),
        CONVERGED,
    );
    let excess = contacts
        .iter()
        .map(|c| c.t[1].abs() - c.t[0])
        .fold(0.0, f64::max);
    add(
        "excess of friction over the cone".into(),
        (excess, "N/mm"),
        Kind::AtMost,
        (1e-9, 0.0),
        "Coulomb's law",
    );
    let gap = reports
        .iter()
        .map(|r| r.relative_gap().abs())
        .fold(0.0, f64::max);
    add(
        "bipotential gap over external work".into(),
        (gap, "1"),
        Kind::AtMost,
        (1e-10, 0.0),
        "exact contact",
    );

    let along = |value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        (0..contacts.len())
            .map(|i| [contacts[i].position[0], value(i)])
            .collect()
    };
    let tractions = Chart::new("Tractions on the floor", "position [mm]", "traction [MPa]")
        .with(
            "pressure",
            Style::Line,
            along(&|i| contacts[i].t[0] / contacts[i].area),
        )
        .with(
            "friction",
            Style::Line,
            along(&|i| contacts[i].t[1].abs() / contacts[i].area),
        );
    let slips = Chart::new("Slip on the floor", "position [mm]", "slip [µm]")
        .with(
            format!("{n} × {n} cells"),
            Style::Line,
            along(&|i| slip(&driver, contacts[i].position[0])),
        )
        .with(
            "mean of published codes",
            Style::Points,
            MEANS.map(|(x, u)| [x, u]),
        );
    for (name, caption, chart) in [
        (
            "greco-slip",
            "Slip of the block's side that lies on the floor.",
            slips,
        ),
        (
            "greco-tractions",
            "Pressure and friction: no contact up to 3 mm, slip where the two are equal, stick beyond 29 mm.",
            tractions,
        ),
    ] {
        let svg = chart.to_svg()?;
        outcome.figures.push(Figure {
            name: name.into(),
            caption: caption.into(),
            svg,
        });
    }
    outcome.tables.push(Table {
        name: "greco".into(),
        title: "Along the floor".into(),
        header: [
            "x [mm]",
            "slip [µm]",
            "normal force [N/mm]",
            "tangential force [N/mm]",
            "status",
        ]
        .map(String::from)
        .to_vec(),
        rows: contacts
            .iter()
            .map(|c| {
                vec![
                    format!("{:.3}", c.position[0]),
                    format!("{:.4}", slip(&driver, c.position[0])),
                    format!("{:.4}", c.t[0]),
                    format!("{:.4}", c.t[1]),
                    format!("{:?}", c.status).to_lowercase(),
                ]
            })
            .collect(),
    });
    Ok(outcome)
}
