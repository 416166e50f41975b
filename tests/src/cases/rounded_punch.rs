//! Two elastic bodies of revolution: a steel punch with a rounded edge on a softer foundation.

use super::compare::largest_gap;
use super::pictures::{deformed, tractions};
use crate::problems::shapes::graded;
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mandel::von_mises;
use moreau::mesh::{Axisymmetric, CellKind, Integration, Mesh, MeshError, block2, uniform};
use moreau::plot::{Chart, Style, nodal_average};
use std::error::Error;
use std::f64::consts::PI;

/// The case.
pub(super) const CASE: Case = Case {
    name: "rounded-punch",
    long: false,
    alone: false,
    chapter: Chapter::Beyond,
    title: "Punch with a rounded edge on a foundation (NAFEMS contact benchmark 2)",
    description: "A steel punch of radius 50 mm and height 100 mm, its edge rounded by 10 mm, is \
        pressed by 100 MPa on an elastic foundation of radius 100 mm and height 200 mm, one third \
        as stiff: two deformable bodies of revolution whose meshes do not match; the punch is held \
        along its axis by its contact alone, without and with friction. The published mean of \
        commercial codes is that of linear cells as coarse as theirs; finer linear cells and \
        quadratic ones agree on a displacement 2.5 % beyond it, with the multipliers on either \
        side.",
    decks: &["examples/cylinder-pressed-into-block.toml"],
    run,
};

const RADIUS: f64 = 50.0;
const EDGE: f64 = 10.0;
const PRESSURE: f64 = 100.0;
/// Where the published values stand; its manual calls their uncertainty important.
const PUBLISHED: &str = "Code_Aster SSNA122, mean of codes (NAFEMS, Konter 2006)";
/// Coefficient of friction, published displacement \[mm\] and stress \[MPa\] on the axis.
const VALUES: [(f64, f64, f64); 2] = [(0.0, -0.1307341, -91.10), (0.1, -0.1285802, -88.67)];

/// The punch on y ≥ 0 with `n` cells along half of its rounded edge, and the foundation below.
fn mesh(kind: CellKind, n: usize) -> Result<Mesh<2>, MeshError> {
    let flat = RADIUS - EDGE;
    let h = EDGE / n as f64;
    // Fine on both sides of the beginning of the edge, from there towards the axis coarser.
    let inwards = |h: f64| {
        let lines = graded(0.0, flat, h, 1.3);
        lines.iter().rev().map(|x| flat - x).collect::<Vec<_>>()
    };
    let mut x = inwards(h);
    x.extend_from_slice(&uniform(flat, RADIUS, n)[1..]);
    let mut y = uniform(0.0, EDGE, n);
    y.extend_from_slice(&graded(EDGE, 100.0, h, 1.3)[1..]);
    // The square at the edge becomes a quarter of a disc. At 45°, where nothing touches, it bulges
    // by a twentieth so that the corner of the block remains one.
    let punch = block2("punch", kind, &x, &y)?.map(|[x, y]| {
        let (a, b) = (x - flat, EDGE - y);
        if a <= 0.0 || b <= 0.0 {
            return [x, y];
        }
        let scale = a.max(b) / a.hypot(b) * (1.0 + 0.05 * (a.min(b) / a.max(b)).powi(6));
        [flat + scale * a, EDGE - scale * b]
    })?;
    let h = 1.3 * h;
    let mut x = inwards(h);
    let last = flat + 0.5 * EDGE;
    x.extend_from_slice(&uniform(flat, last, n.div_ceil(2))[1..]);
    x.extend_from_slice(&graded(last, 100.0, h, 1.3)[1..]);
    let y: Vec<f64> = graded(0.0, 200.0, h, 1.3)
        .iter()
        .rev()
        .map(|y| -y)
        .collect();
    let mut mesh = punch.joined(block2("foundation", kind, &x, &y)?)?;
    let within = |x: &[f64; 2]| x[0] <= flat + 0.72 * EDGE && x[1] <= 0.5 * EDGE;
    mesh.facet_group_where("sole", "punch.bottom", within)?;
    mesh.facet_group_where("seat", "foundation.top", |x| x[0] <= RADIUS)?;
    Ok(mesh)
}

/// Mesh of the two bodies, and whose side has the multipliers.
#[derive(Clone, Copy)]
struct Discretisation {
    kind: CellKind,
    /// Cells along half of the rounded edge.
    n: usize,
    /// Multipliers on the foundation instead of the punch.
    swapped: bool,
}

/// The two bodies under full pressure.
struct Pressed {
    what: String,
    friction: f64,
    driver: Driver<2>,
    /// Displacement along the axis \[mm\] and axial stress \[MPa\] of the foundation's surface
    /// on the axis.
    displacement: f64,
    stress: f64,
    /// Largest bipotential gap over external work.
    gap: f64,
}

impl Discretisation {
    fn new(kind: CellKind, n: usize) -> Self {
        let swapped = false;
        Self { kind, n, swapped }
    }

    fn name(self) -> String {
        let Self { kind, n, swapped } = self;
        let side = if swapped { "foundation" } else { "punch" };
        format!("{kind}, {n} cells along half the edge, multipliers on the {side}")
    }

    fn model(self, friction: f64) -> Result<Model<2, Axisymmetric>, Box<dyn Error>> {
        let rule = match self.kind {
            CellKind::Quad4 => Integration::Full,
            _ => Integration::Reduced,
        };
        let (own, other) = if self.swapped {
            ("seat", "sole")
        } else {
            ("sole", "seat")
        };
        Ok(Model::new(mesh(self.kind, self.n)?, Axisymmetric)
            .material("punch", Elastic::new(210e3, 0.3)?, rule)?
            .material("foundation", Elastic::new(70e3, 0.3)?, rule)?
            .contact(own, other, Coulomb::new(friction)?)?)
    }

    /// The full pressure in five increments.
    fn pressed(self, options: &Options<'_>, friction: f64) -> Result<Pressed, Box<dyn Error>> {
        let what = self.name();
        (options.progress)(&format!("μ = {friction}: {what}"));
        let mut driver = Driver::new(self.model(friction)?, Settings::default())?;
        let step = Step::new("press")
            .fix("punch.left", &[Axis::X])
            .fix("foundation.left", &[Axis::X])
            .fix("foundation.bottom", &[Axis::X, Axis::Y])
            .pressure("punch.top", PRESSURE);
        let reports = driver.run(&step, 5, |_, _| {})?;
        let (displacement, stress) = on_the_axis(&driver).ok_or("no node on the axis")?;
        Ok(Pressed {
            what,
            friction,
            driver,
            displacement,
            stress,
            gap: largest_gap(&reports),
        })
    }
}

impl Pressed {
    /// Row of the table of all runs.
    fn row(&self) -> [String; 5] {
        let contacts = self.driver.contacts().iter();
        let slipping = contacts.filter(|c| c.status == Status::Slip);
        [
            self.friction.to_string(),
            self.what.clone(),
            format!("{:.6}", self.displacement),
            format!("{:.3}", self.stress),
            slipping.count().to_string(),
        ]
    }
}

/// The node of the foundation's surface on the axis.
fn centre(driver: &Driver<2>) -> Option<usize> {
    let nodes = driver.mesh().node_group("foundation.top").ok()?;
    nodes
        .into_iter()
        .find(|n| driver.mesh().nodes()[*n][0] == 0.0)
}

/// Displacement along the axis and axial stress of the foundation at its surface on the axis.
fn on_the_axis(driver: &Driver<2>) -> Option<(f64, f64)> {
    let node = centre(driver)?;
    // The punch has a node of its own there: an average over cells does not mix the bodies.
    let stress = nodal_average(driver.mesh(), &driver.points(), |p| p.stress[1]);
    Some((driver.displacement(node)[1], stress[node]))
}

/// One coefficient of friction on four meshes.
struct Runs {
    coarse: Pressed,
    linear: Pressed,
    quadratic: Pressed,
    /// Quadratic cells, multipliers on the other side.
    swapped: Pressed,
}

impl Runs {
    fn new(options: &Options<'_>, friction: f64) -> Result<Self, Box<dyn Error>> {
        let fine = if options.quick { 8 } else { 16 };
        let quadratic = Discretisation::new(CellKind::Quad8, fine);
        let swapped = Discretisation {
            swapped: true,
            ..quadratic
        };
        let run = |on: Discretisation| on.pressed(options, friction);
        Ok(Self {
            coarse: run(Discretisation::new(CellKind::Quad4, 3))?,
            linear: run(Discretisation::new(CellKind::Quad4, 16))?,
            quadratic: run(quadratic)?,
            swapped: run(swapped)?,
        })
    }

    fn all(&self) -> [&Pressed; 4] {
        [&self.coarse, &self.linear, &self.quadratic, &self.swapped]
    }

    /// Checks against the published displacement and stress, and of the meshes among themselves.
    fn checks(&self, published: f64, published_stress: f64) -> Result<[Check; 6], Box<dyn Error>> {
        let fine = &self.quadratic;
        let name = |what: &str| format!("μ = {}: {what}", fine.friction);
        let force = -fine.driver.contact_force("seat")?[1];
        Ok([
            Check::relative(
                name("displacement on the axis, coarse linear cells"),
                (self.coarse.displacement, "mm"),
                (published, 1e-2),
                PUBLISHED,
            ),
            Check::relative(
                name("displacement on the axis, fine linear cells"),
                (self.linear.displacement, "mm"),
                (fine.displacement, 1e-2),
                "quadratic cells",
            ),
            Check::relative(
                name("displacement on the axis, multipliers on the foundation"),
                (self.swapped.displacement, "mm"),
                (fine.displacement, 1e-3),
                "multipliers on the punch",
            ),
            Check::relative(
                name("axial stress on the axis"),
                (fine.stress, "MPa"),
                (published_stress, 5e-2),
                PUBLISHED,
            ),
            Check::relative(
                name("force on the foundation"),
                (force, "N"),
                (PI * RADIUS * RADIUS * PRESSURE, 1e-9),
                "equilibrium",
            ),
            Check::at_most(
                name("bipotential gap over external work"),
                (fine.gap.max(self.swapped.gap), "1"),
                1e-10,
                "exact contact",
            ),
        ])
    }
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut rows = Vec::new();
    let mut chart =
        Chart::new("Pressure under the punch", "radius [mm]", "pressure [MPa]").x_range(0.0, 45.0);
    let mut fields = Vec::new();
    for (friction, published, published_stress) in VALUES {
        let runs = Runs::new(options, friction)?;
        let checks = runs.checks(published, published_stress)?;
        outcome.checks.extend(checks);
        rows.extend(runs.all().map(Pressed::row));
        let driver = &runs.quadratic.driver;
        let pressures = tractions(driver, |c| c.t[0]);
        chart = chart.with(format!("μ = {friction}"), Style::Line, pressures);
        if friction > 0.0 {
            fields.push(field(driver)?);
        }
    }
    outcome.figures.push(Figure::new(
        "rounded-punch-pressure",
        "Pressure between punch and foundation: it peaks where the rounded edge begins, at 40 mm.",
        chart.to_svg()?,
    ));
    outcome.figures.extend(fields);
    let header = [
        "μ",
        "mesh",
        "displacement on the axis [mm]",
        "axial stress [MPa]",
        "points that slip",
    ];
    let title = "The foundation's surface on the axis";
    outcome
        .tables
        .push(Table::new("rounded-punch", title, header, rows));
    Ok(outcome)
}

fn field(driver: &Driver<2>) -> Result<Figure, Box<dyn Error>> {
    let picture = deformed(
        driver,
        "Von Mises stress, μ = 0.1",
        50.0,
        "von Mises stress, cut at 300 MPa [MPa]",
        |s| von_mises(&s.stress).min(300.0),
    );
    Ok(Figure::new(
        "rounded-punch-stress",
        "Half-section of the punch and the foundation, displacements fifty times enlarged.",
        picture.to_svg()?,
    ))
}
