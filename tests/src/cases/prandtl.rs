//! Paper 8.1: indentation of a half-space by a smooth punch, against Prandtl's limit load; figures
//! 6 to 8.

use super::compare::{
    History, INDEPENDENT, certificate_row, certificate_table, column_check, digits,
    final_state_checks, gap_check, quadrature, record, scientific,
};
use super::pictures::deformed;
use crate::paper::{
    PRANDTL_INCREMENTS, PRANDTL_TRAVEL, prandtl, prandtl_load, prandtl_punch_load, prandtl_step,
    reference,
};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::contact::{ContactSolver, GaussSeidel, Penalty, SemismoothNewton, Uzawa};
use moreau::driver::{Driver, Settings};
use moreau::mesh::Integration;
use moreau::plot::{Chart, MeshPicture, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "prandtl",
    long: false,
    alone: false,
    chapter: Chapter::Paper,
    title: "Indentation of a half-space (paper 8.1, figures 6–8)",
    description: "A rigid, flat, smooth punch of 20 mm width is pressed 0.4 mm into an elastic \
        perfectly plastic block in plane strain, 40 increments, unilateral contact without \
        friction. The load is compared with Prandtl's and Hill's limit load \
        B σ_y/√3 (2 + π) = 17811 N/mm on the paper's mesh of 56 eight-node cells and on its \
        uniform refinements, with reduced (2×2) and full (3×3) quadrature, and with an independent \
        implementation digit by digit. At 0.4 mm the curve still creeps up: loads are compared at \
        equal travel, and the table says how steep the curve still is.",
    decks: &["examples/indentation-flat-punch.toml"],
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
    let cells = 56 * refinement * refinement;
    format!("{cells} cells, {}", quadrature(integration))
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

/// One mesh under one rule, pressed over the whole travel.
struct Indented {
    refinement: usize,
    integration: Integration,
    name: String,
    driver: Driver<2>,
    history: History,
}

impl Indented {
    /// By the exact method.
    fn new(refinement: usize, integration: Integration) -> Result<Self, Box<dyn Error>> {
        let solver = Box::new(SemismoothNewton::default());
        let (driver, history) = indent(refinement, integration, solver)?;
        Ok(Self {
            refinement,
            integration,
            name: name(refinement, integration),
            driver,
            history,
        })
    }

    /// Load over the limit load.
    fn ratio(&self) -> f64 {
        self.history.last_load() / prandtl_load()
    }

    fn error(&self) -> f64 {
        self.ratio() - 1.0
    }

    /// Slope of the last fifth of the curve over the elastic slope.
    fn slope(&self) -> f64 {
        let path = self.history.path(PRANDTL_TRAVEL);
        let slope = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]) / (b[0] - a[0]);
        let last = PRANDTL_INCREMENTS;
        slope(path[last - last / 5], path[last]) / slope(path[0], path[1])
    }

    /// Checks of the load at the end.
    fn load(&self, expected: f64) -> [Check; 2] {
        let what = format!("{}: P/P_Prandtl at 0.4 mm", self.name);
        let ratio = (self.ratio(), "1");
        [
            Check::relative(&*what, ratio, (expected, 2e-9), INDEPENDENT),
            Check::at_least(
                format!("{what} is not below the limit load"),
                ratio,
                1.0,
                "Prandtl 1921, Hill 1950: displacement methods tend to it from above",
            ),
        ]
    }

    /// Checks against the files of the independent implementation, where it has some.
    fn against_files(&self) -> Vec<Check> {
        let file = match (self.refinement, self.integration) {
            (1, Integration::Reduced) => "P_mesh56_g2_exact",
            (1, Integration::Full) => "P_mesh56_g3_exact",
            (2, Integration::Reduced) => "P_meshx2_g2_exact",
            _ => return Vec::new(),
        };
        let mut checks = vec![column_check(
            format!(
                "{}: load after every increment, largest relative difference",
                self.name
            ),
            &self.history.loads,
            &reference::column(&format!("{file}_load"), "P_full_N"),
        )];
        if self.refinement == 1 {
            let file = format!("{file}_contact_final");
            checks.extend(final_state_checks(&self.name, &self.driver, &file));
        }
        checks
    }

    /// Checks of the error against that of the mesh before, if there is one, and on its own.
    fn convergence(&self, coarser: Option<f64>) -> Vec<Check> {
        let mut checks = Vec::new();
        if let Some(coarser) = coarser {
            checks.push(Check::at_most(
                format!("{}: error over that of the mesh before", self.name),
                (self.error() / coarser, "1"),
                0.6,
                "first order in the cell size, less what the curve still creeps",
            ));
        }
        if self.refinement == 8 && self.integration == Integration::Reduced {
            checks.push(Check::at_most(
                "error at 3584 cells, 2×2",
                (self.error(), "1"),
                0.01,
                "Prandtl 1921, Hill 1950",
            ));
        }
        checks
    }

    /// Row of the table of convergence.
    fn row(&self, coarser: Option<f64>) -> [String; 7] {
        let order = |coarser: f64| digits((coarser / self.error()).log2(), 2);
        [
            self.name.clone(),
            self.driver.unknowns().to_string(),
            digits(self.ratio(), 9),
            digits(100.0 * self.error(), 3),
            coarser.map_or("—".into(), order),
            scientific(self.slope()),
            self.history.newton_iterations().to_string(),
        ]
    }
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let finest = if options.quick { 2 } else { 8 };
    let mut charts = [load_chart("2×2"), load_chart("3×3")];
    let mut rows = Vec::new();
    let mut coarser: Option<f64> = None;
    for (refinement, integration, expected) in LOADS.into_iter().filter(|l| l.0 <= finest) {
        (options.progress)(&name(refinement, integration));
        let run = Indented::new(refinement, integration)?;
        coarser = coarser.filter(|_| refinement > 1);
        outcome.checks.extend(run.load(expected));
        outcome.checks.extend(run.against_files());
        outcome.checks.extend(run.convergence(coarser));
        rows.push(run.row(coarser));
        coarser = Some(run.error());
        let chart = &mut charts[usize::from(integration == Integration::Full)];
        let curve = run.history.path(PRANDTL_TRAVEL);
        *chart = chart.clone().with(&run.name, Style::Line, curve);
        if refinement == 1 && integration == Integration::Reduced {
            outcome.figures.push(mesh_figure(&run.driver)?);
        }
        if refinement == finest.min(4) && integration == Integration::Reduced {
            outcome.figures.push(field_figure(&run.driver, &run.name)?);
        }
    }
    outcome.figures.extend(load_figures(charts)?);
    let header = [
        "mesh, quadrature",
        "unknowns",
        "P/P_Prandtl",
        "error [%]",
        "observed order",
        "slope of the last fifth over the elastic slope",
        "Newton iterations",
    ];
    let title = "Load at 0.4 mm against the limit load";
    outcome
        .tables
        .push(Table::new("prandtl-convergence", title, header, rows));
    exact_solvers(options, &mut outcome)?;
    Ok(outcome)
}

fn load_chart(rule: &str) -> Chart {
    Chart::new(
        format!("Load of the punch, {rule} quadrature"),
        "travel of the punch [mm]",
        "load [N per mm of thickness]",
    )
}

/// The charts of both rules, with the limit load.
fn load_figures([reduced, full]: [Chart; 2]) -> Result<Vec<Figure>, Box<dyn Error>> {
    let mut figures = Vec::new();
    for (chart, stem, rule) in [(reduced, "2x2", "reduced"), (full, "3x3", "full")] {
        let limit = prandtl_load();
        let line = vec![[0.0, limit], [PRANDTL_TRAVEL, limit]];
        let caption = format!(
            "Load against travel of the punch with {rule} quadrature, for the paper's figure 8. \
             All meshes lie above the limit load and tend to it."
        );
        figures.push(Figure::new(
            &format!("prandtl-load-{stem}"),
            caption,
            chart.with("Prandtl, Hill", Style::Dashed, line).to_svg()?,
        ));
    }
    Ok(figures)
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
        outcome.checks.push(gap_check(method, &history));
        let Some(newton) = &first else {
            first = Some(history);
            continue;
        };
        outcome.checks.push(Check::at_most(
            format!("{method}: contact forces against semismooth Newton"),
            (newton.force_difference(&history), "1"),
            1e-7,
            "the solution is unique",
        ));
        outcome.checks.push(Check::at_most(
            format!("{method}: statuses that differ"),
            (newton.status_differences(&history) as f64, "nodes"),
            0.0,
            "the solution is unique",
        ));
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
    let picture = MeshPicture::new(driver.mesh(), "56 eight-node cells");
    let caption = "The mesh of 56 eight-node cells, for the paper's figure 7.";
    Ok(Figure::new("prandtl-mesh", caption, picture.to_svg()?))
}

fn field_figure(driver: &Driver<2>, name: &str) -> Result<Figure, Box<dyn Error>> {
    // Around the edge of the punch the strain is singular and would hide all else.
    let picture = deformed(
        driver,
        format!("Equivalent plastic strain, {name}"),
        10.0,
        "equivalent plastic strain p, cut at 0.02 [–]",
        |s| s.plastic_strain.min(0.02),
    );
    let caption = format!(
        "Deformed mesh ({name}, displacements ten times enlarged) with the equivalent plastic \
         strain at 0.4 mm: Prandtl's wedge and fan."
    );
    Ok(Figure::new(
        "prandtl-plastic-strain",
        caption,
        picture.to_svg()?,
    ))
}
