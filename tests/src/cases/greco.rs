//! The block of the GRECO group: opening, slip and stick at once.
//!
//! Source: M. Raous, P. Chabrand and F. Lebon, *Journal de Mécanique Théorique et Appliquée*,
//! special issue (1988) 111-128; also SSNV128 of Code_Aster's validation manual.

use super::compare::largest_gap;
use super::pictures::sorted;
use crate::problems::greco::{block, slip, squeeze};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::driver::{ContactRecord, Driver, Settings};
use moreau::laws::Status;
use moreau::mesh::CellKind;
use moreau::plot::{Chart, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "greco",
    long: false,
    alone: false,
    chapter: Chapter::Beyond,
    title: "Block on a rigid floor, friction of one (GRECO)",
    description: "An elastic block is pressed on a rigid floor from above and, three times as hard, \
        from the side, with a coefficient of friction of one: the reference of two-dimensional \
        friction, where points are open, slip and stick at once and neither a step size nor a \
        penalty can influence the answer.",
    decks: &["examples/block-opening-sliding-sticking.toml"],
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
    let n = if options.quick { 16 } else { 64 };
    (options.progress)(&format!("{n} × {n} cells"));
    let mut driver = block(CellKind::Quad8, n, Settings::default())?;
    let reports = driver.run(&squeeze(), 1, |_, _| {})?;
    let contacts = sorted(driver.contacts());
    let mut checks = slips(&driver);
    checks.extend(forces(driver.contacts()));
    checks.push(statuses(&contacts, n));
    checks.push(cone(&contacts));
    checks.push(Check::at_most(
        "bipotential gap over external work",
        (largest_gap(&reports), "1"),
        1e-10,
        "exact contact",
    ));
    Ok(Outcome {
        checks,
        tables: vec![table(&driver, &contacts)],
        figures: figures(&driver, &contacts, n)?,
        notes: Vec::new(),
    })
}

/// Checks of the slip where it is known.
fn slips(driver: &Driver<2>) -> Vec<Check> {
    let check = |source, tolerance| {
        move |&(x, expected): &(f64, f64)| {
            Check::relative(
                format!("slip: at {x} mm"),
                (slip(driver, x), "µm"),
                (expected, tolerance),
                source,
            )
        }
    };
    let published = MEANS.iter().map(check(PUBLISHED, 5e-2));
    published
        .chain(SLIPS.iter().map(check(CONVERGED, 3e-3)))
        .collect()
}

/// Checks of the resultants on the floor.
fn forces(contacts: &[ContactRecord<2>]) -> [Check; 2] {
    let sum = |k: usize| contacts.iter().map(|c| c.t[k]).sum::<f64>();
    [
        Check::relative(
            "normal force",
            (sum(0), "N/mm"),
            (2000.0, 1e-10),
            "equilibrium",
        ),
        Check::relative(
            "tangential force",
            (sum(1), "N/mm"),
            (-1405.4, 3e-3),
            CONVERGED,
        ),
    ]
}

/// Check of the statuses beyond half an edge of the borders of the zones.
fn statuses(contacts: &[ContactRecord<2>], n: usize) -> Check {
    let half = 20.0 / n as f64;
    let expected = |x: f64| match x {
        x if x < ZONES[0] - half => Some(Status::Open),
        x if x > ZONES[0] + half && x < ZONES[1] - half => Some(Status::Slip),
        x if x > ZONES[1] + half => Some(Status::Stick),
        _ => None,
    };
    let wrong = contacts
        .iter()
        .filter(|c| expected(c.position[0]).is_some_and(|s| s != c.status));
    Check::at_most(
        "points whose status is not that of their zone",
        (wrong.count() as f64, "points"),
        0.0,
        CONVERGED,
    )
}

/// Check that no force is outside of the cone of friction.
fn cone(contacts: &[ContactRecord<2>]) -> Check {
    let excess = contacts.iter().map(|c| c.t[1].abs() - c.t[0]);
    Check::at_most(
        "excess of friction over the cone",
        (excess.fold(0.0, f64::max), "N/mm"),
        1e-9,
        "Coulomb's law",
    )
}

fn figures(
    driver: &Driver<2>,
    contacts: &[ContactRecord<2>],
    n: usize,
) -> Result<Vec<Figure>, Box<dyn Error>> {
    let along = |value: &dyn Fn(&ContactRecord<2>) -> f64| -> Vec<[f64; 2]> {
        let point = |c: &ContactRecord<2>| [c.position[0], value(c)];
        contacts.iter().map(point).collect()
    };
    let pressure = along(&|c| c.t[0] / c.area);
    let friction = along(&|c| c.t[1].abs() / c.area);
    let tractions = Chart::new("Tractions on the floor", "position [mm]", "traction [MPa]")
        .with("pressure", Style::Line, pressure)
        .with("friction", Style::Line, friction);
    let slip = along(&|c| slip(driver, c.position[0]));
    let means = MEANS.map(|(x, u)| [x, u]);
    let slips = Chart::new("Slip on the floor", "position [mm]", "slip [µm]")
        .with(format!("{n} × {n} cells"), Style::Line, slip)
        .with("mean of published codes", Style::Points, means);
    Ok(vec![
        Figure::new(
            "greco-slip",
            "Slip of the block's side that lies on the floor.",
            slips.to_svg()?,
        ),
        Figure::new(
            "greco-tractions",
            "Pressure and friction: no contact up to 3 mm, slip where the two are equal, stick \
                beyond 29 mm.",
            tractions.to_svg()?,
        ),
    ])
}

fn table(driver: &Driver<2>, contacts: &[ContactRecord<2>]) -> Table {
    let header = [
        "x [mm]",
        "slip [µm]",
        "normal force [N/mm]",
        "tangential force [N/mm]",
        "status",
    ];
    let rows = contacts.iter().map(|c| {
        [
            format!("{:.3}", c.position[0]),
            format!("{:.4}", slip(driver, c.position[0])),
            format!("{:.4}", c.t[0]),
            format!("{:.4}", c.t[1]),
            format!("{:?}", c.status).to_lowercase(),
        ]
    });
    Table::new("greco", "Along the floor", header, rows)
}
