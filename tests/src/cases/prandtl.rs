//! Paper 8.1: indentation of a half-space by a smooth punch, against Prandtl's limit load; figures
//! 6 to 8.

use super::compare::{
    History, INDEPENDENT, certificate_row, certificate_table, digits, final_state_checks,
    largest_difference, record, scientific,
};
use crate::paper::{
    PRANDTL_INCREMENTS, PRANDTL_TRAVEL, prandtl, prandtl_load, prandtl_punch_load, prandtl_step,
    reference,
};
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::contact::{ContactSolver, GaussSeidel, Penalty, SemismoothNewton, Uzawa};
use moreau::driver::{Driver, Settings};
use moreau::mesh::Integration;
use moreau::plot::{Chart, MeshPicture, Style, nodal_average};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "prandtl",
    chapter: Chapter::Paper,
    title: "Indentation of a half-space (paper 8.1, figures 6–8)",
    description: "A rigid, flat, smooth punch of 20 mm width is pressed 0.4 mm into an elastic \
        perfectly plastic block in plane strain, 40 increments, unilateral contact without \
        friction. The load is compared with Prandtl's and Hill's limit load \
        B σ_y/√3 (2 + π) = 17811 N/mm on the paper's mesh of 56 eight-node cells and on its \
        uniform refinements, with reduced (2×2) and full (3×3) quadrature, and with an independent \
        implementation digit by digit. At 0.4 mm the curve still creeps up: loads are compared at \
        equal travel, and the table says how steep the curve still is.",
    run,
};

/// P/P_Prandtl at 0.4 mm: refinement, rule, value of the independent implementation.
const LOADS: [(usize, Integration, f64); 8] = [
    (1, Integration::Reduced, 1.068046824),
    (2, Integration::Reduced, 1.033657791),
    (4, Integration::Reduced, 1.01750582),
    (8, Integration::Reduced, 1.00920234),
    (1, Integration::Full, 1.124531545),
    (2, Integration::Full, 1.061999008),
    (4, Integration::Full, 1.031577517),
    (8, Integration::Full, 1.016100967),
];

fn name(refinement: usize, integration: Integration) -> String {
    let rule = match integration {
        Integration::Reduced => "2×2",
        Integration::Full | Integration::BBar => "3×3",
    };
    format!("{} cells, {rule}", 56 * refinement * refinement)
}

/// A run over the whole travel.
fn indent(
    refinement: usize,
    integration: Integration,
    contact: Box<dyn ContactSolver<2>>,
) -> Result<(Driver<2>, History), Box<dyn Error>> {
    let settings = Settings {
        contact,
        ..Settings::default()
    };
    let mut driver = prandtl(refinement, integration, settings)?;
    let mut history = History::default();
    let step = prandtl_step(PRANDTL_TRAVEL);
    record(
        &mut driver,
        &step,
        PRANDTL_INCREMENTS,
        prandtl_punch_load,
        &mut history,
    )?;
    Ok((driver, history))
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let limit = prandtl_load();
    let travel = |i: usize| (i + 1) as f64 * PRANDTL_TRAVEL / PRANDTL_INCREMENTS as f64;
    let finest = if options.quick { 2 } else { 8 };
    let empty = |rule: &str| {
        Chart::new(
            format!("Load of the punch, {rule} quadrature"),
            "travel of the punch [mm]",
            "load [N per mm of thickness]",
        )
    };
    let mut charts = [empty("2×2"), empty("3×3")];
    let mut rows = Vec::new();
    let mut coarser: Option<f64> = None;
    for (refinement, integration, expected) in LOADS.into_iter().filter(|l| l.0 <= finest) {
        let name = name(refinement, integration);
        (options.progress)(&name);
        let (driver, history) = indent(
            refinement,
            integration,
            Box::new(SemismoothNewton::default()),
        )?;
        let ratio = history.last_load() / limit;
        outcome.checks.push(Check::new(
            format!("{name}: P/P_Prandtl at 0.4 mm"),
            (ratio, "1"),
            Kind::Relative,
            (expected, 2e-9),
            INDEPENDENT,
        ));
        outcome.checks.push(Check::new(
            format!("{name}: P/P_Prandtl at 0.4 mm is not below the limit load"),
            (ratio, "1"),
            Kind::AtLeast,
            (1.0, 0.0),
            "Prandtl 1921, Hill 1950: displacement methods tend to it from above",
        ));
        let file = match (refinement, integration) {
            (1, Integration::Reduced) => Some("P_mesh56_g2_exact"),
            (1, Integration::Full) => Some("P_mesh56_g3_exact"),
            (2, Integration::Reduced) => Some("P_meshx2_g2_exact"),
            _ => None,
        };
        if let Some(file) = file {
            let expected = reference::column(&format!("{file}_load"), "P_full_N");
            outcome.checks.push(Check::new(
                format!("{name}: load after every increment, largest relative difference"),
                (largest_difference(&history.loads, &expected), "1"),
                Kind::AtMost,
                (1e-8, 0.0),
                INDEPENDENT,
            ));
            if refinement == 1 {
                let checks = final_state_checks(&name, &driver, &format!("{file}_contact_final"));
                outcome.checks.extend(checks);
            }
        }
        let error = ratio - 1.0;
        let order = match coarser.filter(|_| refinement > 1) {
            Some(before) => digits((before / error).log2(), 2),
            None => "—".into(),
        };
        if let Some(before) = coarser.filter(|_| refinement > 1) {
            outcome.checks.push(Check::new(
                format!("{name}: error over that of the mesh before"),
                (error / before, "1"),
                Kind::AtMost,
                (0.6, 0.0),
                "first order in the cell size, less what the curve still creeps",
            ));
        }
        coarser = Some(error);
        let last = PRANDTL_INCREMENTS - 1;
        let tail = PRANDTL_INCREMENTS / 5;
        let slope = (history.loads[last] - history.loads[last - tail])
            / (travel(last) - travel(last - tail));
        let elastic = history.loads[0] / travel(0);
        rows.push(vec![
            name.clone(),
            driver.unknowns().to_string(),
            digits(ratio, 9),
            digits(100.0 * error, 3),
            order,
            scientific(slope / elastic),
            history.newton_iterations().to_string(),
        ]);
        if refinement == 8 && integration == Integration::Reduced {
            outcome.checks.push(Check::new(
                "error at 3584 cells, 2×2",
                (error, "1"),
                Kind::AtMost,
                (0.01, 0.0),
                "Prandtl 1921, Hill 1950",
            ));
        }
        let points = history
            .loads
            .iter()
            .enumerate()
            .map(|(i, &p)| [travel(i), p]);
        let curve: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(points).collect();
        let chart = &mut charts[usize::from(integration == Integration::Full)];
        *chart = chart.clone().with(&name, Style::Line, curve);
        if refinement == 1 && integration == Integration::Reduced {
            outcome.figures.push(mesh_figure(&driver)?);
        }
        if refinement == finest.min(4) && integration == Integration::Reduced {
            outcome.figures.push(field_figure(&driver, &name)?);
        }
    }
    for (chart, (stem, rule)) in charts
        .into_iter()
        .zip([("2x2", "reduced"), ("3x3", "full")])
    {
        let line = vec![[0.0, limit], [PRANDTL_TRAVEL, limit]];
        outcome.figures.push(Figure {
            name: format!("prandtl-load-{stem}"),
            caption: format!(
                "Load against travel of the punch with {rule} quadrature, for the paper's figure 8. \
                 All meshes lie above the limit load and tend to it."
            ),
            svg: chart.with("Prandtl, Hill", Style::Dashed, line).to_svg()?,
        });
    }
    outcome.tables.push(Table {
        name: "prandtl-convergence".into(),
        title: "Load at 0.4 mm against the limit load".into(),
        header: [
            "mesh, quadrature",
            "unknowns",
            "P/P_Prandtl",
            "error [%]",
            "observed order",
            "slope of the last fifth over the elastic slope",
            "Newton iterations",
        ]
        .map(Into::into)
        .to_vec(),
        rows,
    });
    exact_solvers(options, &mut outcome)?;
    Ok(outcome)
}

/// All exact methods on the paper's mesh.
fn exact_solvers(options: &Options<'_>, outcome: &mut Outcome) -> Result<(), Box<dyn Error>> {
    let methods: [(&str, Box<dyn ContactSolver<2>>); 3] = [
        ("semismooth Newton", Box::new(SemismoothNewton::default())),
        ("Gauss–Seidel", Box::new(GaussSeidel::default())),
        ("Uzawa inside", Box::new(Uzawa::default())),
    ];
    let mut first: Option<History> = None;
    let mut rows = Vec::new();
    for (method, solver) in methods {
        (options.progress)(&format!("{}, {method}", name(1, Integration::Reduced)));
        let (_, history) = indent(1, Integration::Reduced, solver)?;
        rows.push(certificate_row(method, &history));
        outcome.checks.push(Check::new(
            format!("{method}: largest bipotential gap over the external work"),
            (history.largest_gap(), "1"),
            Kind::AtMost,
            (1e-10, 0.0),
            "zero exactly at the law, [39]",
        ));
        match &first {
            None => first = Some(history),
            Some(newton) => {
                outcome.checks.push(Check::new(
                    format!("{method}: contact forces against semismooth Newton"),
                    (newton.force_difference(&history), "1"),
                    Kind::AtMost,
                    (1e-7, 0.0),
                    "the solution is unique",
                ));
                outcome.checks.push(Check::new(
                    format!("{method}: statuses that differ"),
                    (newton.status_differences(&history) as f64, "nodes"),
                    Kind::AtMost,
                    (0.0, 0.0),
                    "the solution is unique",
                ));
            }
        }
    }
    let penalty = Penalty::new(1e8, 1e8)?;
    let (_, history) = indent(1, Integration::Reduced, Box::new(penalty))?;
    rows.push(certificate_row("regularisation, k = 1e8 N/mm", &history));
    outcome
        .tables
        .push(certificate_table("prandtl-certificate", rows));
    Ok(())
}

fn mesh_figure(driver: &Driver<2>) -> Result<Figure, Box<dyn Error>> {
    Ok(Figure {
        name: "prandtl-mesh".into(),
        caption: "The mesh of 56 eight-node cells, for the paper's figure 7.".into(),
        svg: MeshPicture::new(driver.mesh(), "56 eight-node cells").to_svg()?,
    })
}

fn field_figure(driver: &Driver<2>, name: &str) -> Result<Figure, Box<dyn Error>> {
    let nodes = 0..driver.mesh().nodes().len();
    let displacement = nodes.map(|a| driver.displacement(a).into()).collect();
    // Around the edge of the punch the strain is singular and would hide all else.
    let p = nodal_average(driver.mesh(), &driver.points(), |s| {
        s.plastic_strain.min(0.02)
    });
    let picture = MeshPicture::new(driver.mesh(), format!("Equivalent plastic strain, {name}"))
        .deformed(displacement, 10.0)
        .field("equivalent plastic strain p, cut at 0.02 [–]", p)
        .outline();
    Ok(Figure {
        name: "prandtl-plastic-strain".into(),
        caption: format!(
            "Deformed mesh ({name}, displacements ten times enlarged) with the equivalent plastic \
             strain at 0.4 mm: Prandtl's wedge and fan."
        ),
        svg: picture.to_svg()?,
    })
}
