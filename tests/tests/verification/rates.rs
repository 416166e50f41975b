//! Rates of convergence on a smooth elastic solution: 1 and 2 for linear, 2 and 3 for quadratic
//! cells, in the energy norm and in L²; not on solutions with singularities.

use moreau::driver::{Driver, Model, Settings, Step};
use moreau::laws::Elastic;
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use verification::problems::Fallible;
use verification::problems::fields::{PlaneField, error_norms, prescribed};

/// The gradient of the harmonic function eˣ sin y: without divergence and harmonic itself, it is in
/// equilibrium without body forces, whatever the elastic constants.
struct Harmonic;

impl PlaneField for Harmonic {
    fn displacement(&self, &[x, y]: &[f64; 2]) -> [f64; 2] {
        [1e-3 * x.exp() * y.sin(), 1e-3 * x.exp() * y.cos()]
    }

    fn gradient(&self, &[x, y]: &[f64; 2]) -> [[f64; 2]; 2] {
        let (s, c) = (1e-3 * x.exp() * y.sin(), 1e-3 * x.exp() * y.cos());
        [[s, c], [c, -s]]
    }
}

fn norms(kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
    let lines = uniform(0.0, 1.0, n);
    let mesh = block2("body", kind, &lines, &lines)?.map(|[x, y]| [x + 0.2 * y, y + 0.1 * x])?;
    let law = Elastic::new(210e3, 0.3)?;
    let model = Model::new(mesh, PlaneStrain::default()).material("body", law, rule)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let mut outline: Vec<usize> = Vec::new();
    for side in ["body.left", "body.right", "body.bottom", "body.top"] {
        outline.extend(driver.mesh().node_group(side)?);
    }
    let loading = prescribed(&driver, &Step::new("stretch"), &outline, |x| {
        Harmonic.displacement(x)
    })?;
    driver.advance(&loading)?;
    Ok(error_norms::<PlaneStrain>(&driver, &law, &Harmonic))
}

#[test]
fn smooth_elastic_solution_converges_at_the_optimal_rates() -> Fallible {
    use CellKind::{Quad4, Quad8, Quad9, Tri3, Tri6};
    use Integration::{Full, Reduced};
    let kinds = [
        (Tri3, Full, 1.0),
        (Quad4, Full, 1.0),
        (Tri6, Full, 2.0),
        (Tri6, Reduced, 2.0),
        (Quad8, Full, 2.0),
        (Quad8, Reduced, 2.0),
        (Quad9, Full, 2.0),
    ];
    for (kind, rule, degree) in kinds {
        let (coarse, fine) = (norms(kind, rule, 8)?, norms(kind, rule, 16)?);
        let energy = (coarse.0 / fine.0).log2();
        let l2 = (coarse.1 / fine.1).log2();
        assert!(
            (energy - degree).abs() < 0.1,
            "{kind} {rule:?}: energy norm {energy}"
        );
        assert!(
            (l2 - degree - 1.0).abs() < 0.1,
            "{kind} {rule:?}: L2 norm {l2}"
        );
    }
    Ok(())
}
