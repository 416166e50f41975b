//! Curves of the laws, drawn for the pages on them by the laws themselves.

use crate::Figure;
use crate::problems::Fallible;
use moreau::laws::{BulkLaw, Coulomb, Friction, Isotropic, LimitedCoulomb, Tresca, VonMises};
use moreau::plot::{Chart, Style};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Yield stress of all metals here \[MPa\].
const YIELD: f64 = 300.0;

/// All of them.
///
/// # Errors
/// None: parameters are in their ranges.
pub fn all() -> Fallible<Vec<Figure>> {
    Ok(vec![hardening()?, cycles()?, friction()?])
}

fn sampled(to: f64, of: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let points = (0..=100).map(|k| to * f64::from(k) / 100.0);
    points.map(|x| [x, of(x)]).collect()
}

fn hardening() -> Fallible<Figure> {
    let table = [[0.0, YIELD], [0.05, 380.0], [0.15, 440.0], [0.3, 480.0]];
    let laws = [
        ("linear = 500", Isotropic::linear(500.0)?),
        ("voce = [150, 20]", Isotropic::voce(150.0, 20.0)?),
        (
            "swift = [700, 0.014458, 0.2]",
            Isotropic::swift(700.0, 0.014_458, 0.2)?,
        ),
        (
            "table = [[0, 300], [0.05, 380], [0.15, 440], [0.3, 480]]",
            Isotropic::table(&table)?,
        ),
    ];
    let mut chart = Chart::new(
        "Isotropic hardening",
        "equivalent plastic strain p",
        "yield stress [MPa]",
    );
    for (name, law) in laws {
        let points = sampled(0.4, |p| YIELD + law.stress(p));
        chart = chart.with(name, Style::Line, points);
    }
    Ok(Figure::new(
        "hardening",
        "The yield stress over the plastic strain.",
        chart.to_svg()?,
    ))
}

/// √3 τ over γ/√3 of a point that is sheared forth, back and forth again: its uniaxial curve.
fn sheared<L: BulkLaw>(law: &L) -> Vec<[f64; 2]> {
    const STEPS: i32 = 100;
    const STRAIN: f64 = 0.02;
    let mut state = law.initial();
    let mut points = vec![[0.0, 0.0]];
    let (mut done, root) = (0.0, 3f64.sqrt());
    for (steps, sign) in [(STEPS, 1.0), (2 * STEPS, -1.0), (2 * STEPS, 1.0)] {
        for _ in 0..steps {
            let part = sign * STRAIN / f64::from(STEPS);
            let mut d_eps = moreau::mandel::Sym2::zeros();
            d_eps[5] = SQRT_2 * 0.5 * root * part;
            let response = law.respond(&state, &d_eps);
            state = response.state;
            done += part;
            points.push([done, root * FRAC_1_SQRT_2 * response.stress[5]]);
        }
    }
    points
}

fn cycles() -> Fallible<Figure> {
    let metal = || VonMises::new(210e3, 0.3, YIELD);
    let chart = Chart::new(
        "Forth, back and forth",
        "√3/3 of the shear strain",
        "√3 of the shear stress [MPa]",
    )
    .with("perfectly plastic", Style::Line, sheared(&metal()?))
    .with(
        "hardening = { linear = 5000 }",
        Style::Line,
        sheared(&metal()?.with_isotropic(5000.0)?),
    )
    .with(
        "kinematic = [{ modulus = 5000 }]",
        Style::Line,
        sheared(&metal()?.with_kinematic(5000.0)?),
    )
    .with(
        "kinematic = [{ modulus = 30000, recall = 200 }]",
        Style::Line,
        sheared(&metal()?.with_recall([(30e3, 200.0)])?),
    );
    Ok(Figure::new(
        "cycles",
        "Isotropic hardening widens the elastic range, kinematic hardening moves it.",
        chart.to_svg()?,
    ))
}

fn friction() -> Fallible<Figure> {
    let laws = [
        ("friction = 0.3", Friction::from(Coulomb::new(0.3)?)),
        ("friction = { tresca = 50 }", Tresca::new(50.0)?.into()),
        (
            "friction = { coulomb = 0.3, tau-max = 80 }",
            LimitedCoulomb::new(0.3, 80.0)?.into(),
        ),
    ];
    let mut chart = Chart::new("Friction", "pressure [MPa]", "largest shear [MPa]");
    for (name, law) in laws {
        chart = chart.with(name, Style::Line, sampled(400.0, |p| law.bound(p)));
    }
    Ok(Figure::new(
        "friction",
        "The largest shear over the pressure.",
        chart.to_svg()?,
    ))
}
