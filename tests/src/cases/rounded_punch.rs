//! Two elastic bodies of revolution: a steel punch with a rounded edge on a softer foundation.

use crate::problems::shapes::graded;
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::driver::{Axis, ContactRecord, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mandel::von_mises;
use moreau::mesh::{Axisymmetric, CellKind, Integration, Mesh, MeshError, block2, uniform};
use moreau::plot::{Chart, MeshPicture, Style, nodal_average};
use std::error::Error;
use std::f64::consts::PI;

/// The case.
pub(super) const CASE: Case = Case {
    name: "rounded-punch",
    chapter: Chapter::Beyond,
    title: "Punch with a rounded edge on a foundation (NAFEMS contact benchmark 2)",
    description: "A steel punch of radius 50 mm and height 100 mm, its edge rounded by 10 mm, is \
        pressed by 100 MPa on an elastic foundation of radius 100 mm and height 200 mm, one third \
        as stiff: two deformable bodies of revolution whose meshes do not match; the punch is held \
        along its axis by its contact alone, without and with friction. The published mean of \
        commercial codes is that of linear cells as coarse as theirs; finer linear cells and \
        quadratic ones agree on a displacement 2.5 % beyond it, with the multipliers on either \
        side.",
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

/// The two bodies under full pressure, after five increments.
fn pressed(
    kind: CellKind,
    n: usize,
    friction: f64,
    swapped: bool,
) -> Result<(Driver<2>, f64), Box<dyn Error>> {
    let rule = match kind {
        CellKind::Quad4 => Integration::Full,
        _ => Integration::Reduced,
    };
    let (own, other) = if swapped {
        ("seat", "sole")
    } else {
        ("sole", "seat")
    };
    let model = Model::new(mesh(kind, n)?, Axisymmetric)
        .material("punch", Elastic::new(210e3, 0.3)?, rule)?
        .material("foundation", Elastic::new(70e3, 0.3)?, rule)?
        .contact(own, other, Coulomb::new(friction)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("punch.left", &[Axis::X])
        .fix("foundation.left", &[Axis::X])
        .fix("foundation.bottom", &[Axis::X, Axis::Y])
        .pressure("punch.top", PRESSURE);
    let reports = driver.run(&step, 5, |_, _| {})?;
    let gap = reports.iter().map(|r| r.relative_gap().abs());
    Ok((driver, gap.fold(0.0, f64::max)))
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

/// Normal traction over the radius.
fn pressures(driver: &Driver<2>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = driver
        .contacts()
        .iter()
        .map(|c| [c.position[0], c.t[0] / c.area])
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut rows = Vec::new();
    let mut chart =
        Chart::new("Pressure under the punch", "radius [mm]", "pressure [MPa]").x_range(0.0, 45.0);
    let fine = if options.quick { 8 } else { 16 };
    for (friction, published, published_stress) in VALUES {
        let mut solve = |kind: CellKind, n: usize, swapped: bool| -> Result<_, Box<dyn Error>> {
            let side = if swapped { "foundation" } else { "punch" };
            let what = format!("{kind}, {n} cells along half the edge, multipliers on the {side}");
            (options.progress)(&format!("μ = {friction}: {what}"));
            let (driver, gap) = pressed(kind, n, friction, swapped)?;
            let (u, stress) = on_the_axis(&driver).ok_or("no node on the axis")?;
            let slip = |c: &&ContactRecord<2>| c.status == Status::Slip;
            rows.push(vec![
                friction.to_string(),
                what,
                format!("{u:.6}"),
                format!("{stress:.3}"),
                driver.contacts().iter().filter(slip).count().to_string(),
            ]);
            Ok((driver, gap, u, stress))
        };
        let coarse = solve(CellKind::Quad4, 3, false)?;
        let linear = solve(CellKind::Quad4, 16, false)?;
        let (driver, gap, u, stress) = solve(CellKind::Quad8, fine, false)?;
        let other = solve(CellKind::Quad8, fine, true)?;
        let mut check = |name: &str, value, kind, reference, source: &str| {
            let name = format!("μ = {friction}: {name}");
            outcome
                .checks
                .push(Check::new(name, value, kind, reference, source));
        };
        check(
            "displacement on the axis, coarse linear cells",
            (coarse.2, "mm"),
            Kind::Relative,
            (published, 1e-2),
            PUBLISHED,
        );
        check(
            "displacement on the axis, fine linear cells",
            (linear.2, "mm"),
            Kind::Relative,
            (u, 1e-2),
            "quadratic cells",
        );
        check(
            "displacement on the axis, multipliers on the foundation",
            (other.2, "mm"),
            Kind::Relative,
            (u, 1e-3),
            "multipliers on the punch",
        );
        check(
            "axial stress on the axis",
            (stress, "MPa"),
            Kind::Relative,
            (published_stress, 5e-2),
            PUBLISHED,
        );
        check(
            "force on the foundation",
            (-driver.contact_force("seat")?[1], "N"),
            Kind::Relative,
            (PI * RADIUS * RADIUS * PRESSURE, 1e-9),
            "equilibrium",
        );
        check(
            "bipotential gap over external work",
            (gap.max(other.1), "1"),
            Kind::AtMost,
            (1e-10, 0.0),
            "exact contact",
        );
        chart = chart.with(format!("μ = {friction}"), Style::Line, pressures(&driver));
        if friction > 0.0 {
            outcome.figures.push(field(&driver)?);
        }
    }
    outcome.figures.insert(
        0,
        Figure {
            name: "rounded-punch-pressure".into(),
            caption: "Pressure between punch and foundation: it peaks where the rounded edge \
                begins, at 40 mm."
                .into(),
            svg: chart.to_svg()?,
        },
    );
    let header = [
        "μ",
        "mesh",
        "displacement on the axis [mm]",
        "axial stress [MPa]",
        "points that slip",
    ];
    outcome.tables.push(Table {
        name: "rounded-punch".into(),
        title: "The foundation's surface on the axis".into(),
        header: header.map(String::from).to_vec(),
        rows,
    });
    Ok(outcome)
}

fn field(driver: &Driver<2>) -> Result<Figure, Box<dyn Error>> {
    let nodes = 0..driver.mesh().nodes().len();
    let displacement = nodes.map(|a| driver.displacement(a).into()).collect();
    let stress = nodal_average(driver.mesh(), &driver.points(), |s| {
        von_mises(&s.stress).min(300.0)
    });
    let picture = MeshPicture::new(driver.mesh(), "Von Mises stress, μ = 0.1")
        .deformed(displacement, 50.0)
        .field("von Mises stress, cut at 300 MPa [MPa]", stress)
        .outline();
    Ok(Figure {
        name: "rounded-punch-stress".into(),
        caption:
            "Half-section of the punch and the foundation, displacements fifty times enlarged."
                .into(),
        svg: picture.to_svg()?,
    })
}
