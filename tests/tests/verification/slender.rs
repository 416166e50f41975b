//! Slender bars under large rotations: the elastica of a cantilever, and Euler's load as a bifurcation; not
//! small strains, which know neither.
//!
//! Source of the elastica: K. E. Bisshopp, D. C. Drucker, *Quarterly of Applied Mathematics* 3 (1945) 272-275; here by
//! integration of its equation.

use crate::close;
use moreau::contact::Ball;
use moreau::driver::{Axis, Driver, IncrementError, Model, Seam, Settings, Step};
use moreau::laws::{Coulomb, Elastic};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use verification::problems::Fallible;

const YOUNG: f64 = 1000.0;

/// A strip without Poisson's effect, of unit thickness, along x.
fn strip(
    length: f64,
    height: f64,
    cells: usize,
    kind: (CellKind, Integration),
) -> Fallible<Driver<2>> {
    let (x, y) = (uniform(0.0, length, cells), uniform(0.0, height, 1));
    let mut mesh = block2("strip", kind.0, &x, &y)?;
    let end = move |x: &[f64; 2]| x[0] > length - 1e-9 && (x[1] - 0.5 * height).abs() < 1e-9;
    if mesh.node_group_where("tip", "strip.right", end).is_err() {
        mesh.node_group_where("tip", "strip.right", |x| x[1] == 0.0)?;
    }
    let model = Model::with_large_strains(mesh, PlaneStrain::default()).material(
        "strip",
        Elastic::new(YOUNG, 0.0)?,
        kind.1,
    )?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Where the tip of an elastica of unit length is under a dead load α = P L²/(E I) across it: along and across.
fn elastica(alpha: f64) -> [f64; 2] {
    const PIECES: usize = 4000;
    let h = 1.0 / PIECES as f64;
    // Angle, curvature and place at the end, of the curvature at the root: θ'' = −α cos θ.
    let end = |root: f64| {
        let slope = |s: [f64; 4]| [s[1], -alpha * s[0].cos(), s[0].cos(), s[0].sin()];
        let along = |s: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
        let step = |s: [f64; 4], _| {
            let k1 = slope(s);
            let k2 = slope(along(s, k1, 0.5 * h));
            let k3 = slope(along(s, k2, 0.5 * h));
            let k4 = slope(along(s, k3, h));
            std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
        };
        (0..PIECES).fold([0.0, root, 0.0, 0.0], step)
    };
    // No moment acts on the tip.
    let (mut low, mut high) = (0.0, alpha);
    for _ in 0..60 {
        let root = 0.5 * (low + high);
        match end(root)[1] > 0.0 {
            true => high = root,
            false => low = root,
        }
    }
    let [_, _, x, y] = end(0.5 * (low + high));
    [x, y]
}

#[test]
fn the_elastica_is_that_of_the_tables() {
    // Bisshopp and Drucker: deflection over length.
    close("α = 1", elastica(1.0)[1], 0.3017, 1e-3);
    close("α = 10", elastica(10.0)[1], 0.8106, 1e-3);
}

#[test]
fn a_cantilever_bends_as_the_elastica() -> Fallible {
    let (length, height) = (100.0f64, 1.0f64);
    let stiffness = YOUNG * height.powi(3) / 12.0;
    for kind in [
        (CellKind::Quad8, Integration::Reduced),
        (CellKind::Quad9, Integration::Full),
    ] {
        let mut driver = strip(length, height, 50, kind)?;
        for alpha in [1.0, 3.0, 10.0] {
            let load = alpha * stiffness / length.powi(2);
            let step = Step::new("bend")
                .fix("strip.left", &[Axis::X, Axis::Y])
                .traction("strip.right", [0.0, -load / height]);
            driver.run(&step, 8, |_, _| {})?;
            let node = driver.mesh().node_group("tip")?[0];
            let u = driver.displacement(node);
            let [along, across] = elastica(alpha);
            close("deflection", -u[1] / length, across, 5e-3);
            close("place of the tip", 1.0 + u[0] / length, along, 5e-3);
        }
    }
    Ok(())
}

/// A straight column goes on as a straight one: that it need not is told at Euler's load, with the curve in which it
/// would bend, 1 − cos(πx/2L).
#[test]
fn a_straight_column_is_unstable_from_eulers_load_on() -> Fallible {
    let (length, height) = (100.0f64, 2.0f64);
    let euler = PI.powi(2) * YOUNG * height.powi(3) / 12.0 / (4.0 * length.powi(2));
    let mut driver = strip(length, height, 40, (CellKind::Quad8, Integration::Reduced))?;
    let step = Step::new("compress")
        .fix("strip.left", &[Axis::X, Axis::Y])
        .traction("strip.right", [-1.1 * euler / height, 0.0]);
    let mut critical = None;
    driver.run(&step, 110, |driver, report| {
        if report.negative_eigenvalues > 0 && critical.is_none() {
            assert_eq!(report.negative_eigenvalues, 1);
            critical = Some((report.increment as f64 - 0.5) / 100.0 * euler);
            let mode = report.mode.as_ref().expect("a mode");
            let tip = driver.mesh().node_group("tip").expect("a group")[0];
            for (x, v) in driver.mesh().nodes().iter().zip(mode.chunks_exact(2)) {
                let curve = 1.0 - (0.5 * PI * x[0] / length).cos();
                let off = v[1] / mode[2 * tip + 1] - curve;
                assert!(off.abs() < 5e-3, "{x:?}: {off:.1e}");
            }
        } else {
            assert_eq!(report.mode, None);
        }
    })?;
    close("critical load", critical.ok_or("stable")?, euler, 2e-2);
    Ok(())
}

/// Half of a clamped arch of unit thickness in the shape of a cosine: half of its span, rise, height of the section.
const ARCH: [f64; 3] = [50.0, 2.5, 1.0];

/// Half of the load on the arch of which the crown has come down by so much, by E. Reissner's beam with what
/// stretches and shears it: integrated from the clamp, whose moment and forces are those with which the crown
/// arrives without a slope.
fn arch_load(down: f64, guess: &mut [f64; 3]) -> f64 {
    const PIECES: usize = 2000;
    let [span, rise, height] = ARCH;
    let bending = YOUNG * height.powi(3) / 12.0;
    let (stretching, shearing) = (YOUNG * height, 5.0 / 6.0 * 0.5 * YOUNG * height);
    let slope = |x: f64| 0.5 * rise * PI / span * (PI * x / span).sin();
    let turn = |x: f64| 0.5 * rise * (PI / span).powi(2) * (PI * x / span).cos();
    // Of x, y, angle and moment along the span.
    let rates = |x: f64, s: [f64; 4], h: f64, v: f64| {
        let arc = slope(x).hypot(1.0);
        let (sin, cos) = s[2].sin_cos();
        let (along, across) = (h * cos + v * sin, v * cos - h * sin);
        let (stretch, shear) = (1.0 + along / stretching, across / shearing);
        let (dx, dy) = (stretch * cos - shear * sin, stretch * sin + shear * cos);
        let curvature = turn(x) / arc.powi(3) + s[3] / bending;
        [dx, dy, curvature, dy * h - dx * v].map(|rate| rate * arc)
    };
    let arrives = |[moment, h, v]: [f64; 3]| {
        let step = span / PIECES as f64;
        let along = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
        let mut s = [0.0, 0.0, 0.0, moment];
        for k in 0..PIECES {
            let x = k as f64 * step;
            let k1 = rates(x, s, h, v);
            let k2 = rates(x + 0.5 * step, along(s, k1, 0.5 * step), h, v);
            let k3 = rates(x + 0.5 * step, along(s, k2, 0.5 * step), h, v);
            let k4 = rates(x + step, along(s, k3, step), h, v);
            let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            s = std::array::from_fn(|i| s[i] + step * mean(i));
        }
        Vector3::new(s[0] - span, s[1] - (rise - down), s[2])
    };
    for _ in 0..30 {
        let off = arrives(*guess);
        let column = |i: usize| {
            let mut other = *guess;
            other[i] += 1e-6;
            (arrives(other) - off) / 1e-6
        };
        let by = Matrix3::from_columns(&[column(0), column(1), column(2)])
            .lu()
            .solve(&off);
        let by = by.expect("regular");
        (0..3).for_each(|i| guess[i] -= by[i]);
        if by.norm() < 1e-10 {
            break;
        }
    }
    -guess[2]
}

/// Half of the arch, elastic.
fn arch() -> Fallible<Model<2, PlaneStrain>> {
    let [span, rise, height] = ARCH;
    let (x, y) = (
        uniform(0.0, span, 50),
        uniform(-0.5 * height, 0.5 * height, 1),
    );
    let mut mesh = block2("arch", CellKind::Quad8, &x, &y)?.map(|[x, y]| {
        let slope = 0.5 * rise * PI / span * (PI * x / span).sin();
        let centre = 0.5 * rise * (1.0 - (PI * x / span).cos());
        let long = slope.hypot(1.0);
        [x - y * slope / long, centre + y / long]
    })?;
    mesh.node_group_where("crown", "arch.right", |x| (x[1] - rise).abs() < 1e-9)?;
    let elastic = Elastic::new(YOUNG, 0.0)?;
    let model = Model::with_large_strains(mesh, PlaneStrain::default());
    Ok(model.material("arch", elastic, Integration::Reduced)?)
}

#[test]
fn a_shallow_arch_snaps_through() -> Fallible {
    let mut driver = Driver::new(arch()?, Settings::default())?;
    let node = driver.mesh().node_group("crown")?[0];
    let step = Step::new("press")
        .fix("arch.left", &[Axis::X, Axis::Y])
        .fix("arch.right", &[Axis::X])
        .force("crown", [0.0, -0.1]);
    let mut path = Vec::new();
    let mut limit = None;
    driver.run(&step, 20, |driver, report| {
        path.push([-driver.displacement(node)[1], 0.1 * report.fraction]);
        limit = limit.or(report.limit);
    })?;
    let mut guess = [0.0; 3];
    let peak = (1..=80)
        .map(|k| arch_load(0.02 * f64::from(k), &mut guess))
        .fold(0.0, f64::max);
    close("limit", 0.1 * limit.ok_or("none")?, peak, 5e-3);
    guess = [0.0; 3];
    let mut from = 0.0;
    for &[down, load] in &path {
        // In small steps, so that the shooting stays on its branch.
        let exact = (1..=10)
            .map(|k| arch_load(from + 0.1 * f64::from(k) * (down - from), &mut guess))
            .fold(0.0, |_, load| load);
        from = down;
        assert!(
            (load - exact).abs() < 5e-3 * peak.max(exact),
            "{down}: {load} {exact}"
        );
    }
    // On its way the load pulls, and in the end it is all there.
    assert!(path.iter().any(|[_, load]| *load < -0.004));
    assert_eq!(path[path.len() - 1][1], 0.1);
    Ok(())
}

/// The same arch under a roll that a force drives: beyond the limit of the load it leaves the roll, and nothing near is in
/// balance. That is told with the limit, in however few increments.
#[test]
fn a_shallow_arch_under_a_roll_snaps_away() -> Fallible {
    let [span, rise, height] = ARCH;
    let mut guess = [0.0; 3];
    let peak = (1..=80)
        .map(|k| arch_load(0.02 * f64::from(k), &mut guess))
        .fold(0.0, f64::max);
    for (seam, increments) in [(Seam::Condensed, 8), (Seam::Tied, 3)] {
        let radius = 2.0;
        let roll = Ball::new([span, rise + 0.5 * height + radius], radius)?;
        let model = arch()?
            .tool("roll", roll)?
            .contact("arch.top", "roll", Coulomb::new(0.0)?)?;
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings)?;
        let step = Step::new("press")
            .fix("arch.left", &[Axis::X, Axis::Y])
            .fix("arch.right", &[Axis::X])
            .tool("roll", [0.0, 0.0])
            .push("roll", Axis::Y, -0.1);
        match driver.run(&step, increments, |_, _| ()) {
            // The largest load that was in balance.
            Err(IncrementError::SnapsAway { limit, .. }) => {
                let part = 0.1 * limit / peak;
                assert!(
                    (0.9..1.001).contains(&part),
                    "{seam:?}, {increments}: {part}"
                );
            }
            other => panic!("{seam:?}, {increments}: {other:?}"),
        }
    }
    Ok(())
}
