//! Rates of convergence: 1 and 2 for linear, 2 and 3 for quadratic cells on smooth elastic
//! solutions, in the energy norm and in L²; what contact, singularities and flow leave of them; and
//! in time.

use moreau::contact::{Ball, Plane};
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform};
use verification::problems::Fallible;
use verification::problems::collapsing::cylinder;
use verification::problems::fields::{Field, Meshed, error_norms, prescribed};

use CellKind::{Hex8, Hex20, Hex27, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6};
use Integration::{BBar, Full, Reduced};

/// The gradient of a harmonic function: without divergence and harmonic itself, it is in equilibrium
/// without body forces, whatever the elastic constants. In the plane of eˣ sin y.
struct Harmonic;

impl Field<2> for Harmonic {
    fn displacement(&self, &[x, y]: &[f64; 2]) -> [f64; 2] {
        [1e-3 * x.exp() * y.sin(), 1e-3 * x.exp() * y.cos()]
    }

    fn gradient(&self, &[x, y]: &[f64; 2]) -> [[f64; 2]; 2] {
        let (s, c) = (1e-3 * x.exp() * y.sin(), 1e-3 * x.exp() * y.cos());
        [[s, c], [c, -s]]
    }
}

/// Of eˣ sin(0.6 y) cos(0.8 z).
impl Field<3> for Harmonic {
    fn displacement(&self, &[x, y, z]: &[f64; 3]) -> [f64; 3] {
        let (e, (s, c), (t, d)) = (1e-3 * x.exp(), (0.6 * y).sin_cos(), (0.8 * z).sin_cos());
        [e * s * d, 0.6 * e * c * d, -0.8 * e * s * t]
    }

    fn gradient(&self, &[x, y, z]: &[f64; 3]) -> [[f64; 3]; 3] {
        let (e, (s, c), (t, d)) = (1e-3 * x.exp(), (0.6 * y).sin_cos(), (0.8 * z).sin_cos());
        let (xx, xy, xz) = (e * s * d, 0.6 * e * c * d, -0.8 * e * s * t);
        let (yy, yz, zz) = (-0.36 * e * s * d, -0.48 * e * c * t, -0.64 * e * s * d);
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }
}

fn norms<const D: usize, H: Meshed<D> + Analysis<D>>(
    mesh: Mesh<D>,
    hypothesis: H,
    rule: Integration,
) -> Fallible<(f64, f64)>
where
    Harmonic: Field<D>,
{
    let law = Elastic::new(210e3, 0.3)?;
    let model = Model::new(mesh, hypothesis).material("body", law, rule)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let mut outline: Vec<usize> = Vec::new();
    for facet in driver.mesh().boundary_facets() {
        outline.extend(driver.mesh().facet_nodes(facet));
    }
    outline.sort_unstable();
    outline.dedup();
    let loading = prescribed(&driver, &Step::new("stretch"), &outline, |x| {
        Harmonic.displacement(x)
    })?;
    driver.advance(&loading)?;
    Ok(error_norms::<D, H>(&driver, &law, &Harmonic))
}

/// Slopes between two meshes, one of cells of half the size, against the degree of the cells.
fn optimal(name: &str, degree: f64, coarse: (f64, f64), fine: (f64, f64)) {
    let (energy, l2) = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
    assert!(
        (energy - degree).abs() < 0.1,
        "{name}: energy norm {energy}"
    );
    assert!((l2 - degree - 1.0).abs() < 0.1, "{name}: L2 norm {l2}");
}

#[test]
fn smooth_elastic_solution_converges_at_the_optimal_rates() -> Fallible {
    let kinds = [
        (Tri3, Full, 1.0),
        (Quad4, Full, 1.0),
        (Quad4, BBar, 1.0),
        (Tri6, Full, 2.0),
        (Tri6, Reduced, 2.0),
        (Quad8, Full, 2.0),
        (Quad8, Reduced, 2.0),
        (Quad9, Full, 2.0),
    ];
    for (kind, rule, degree) in kinds {
        let at = |n| {
            let lines = uniform(0.0, 1.0, n);
            let mesh = block2("body", kind, &lines, &lines)?;
            let mesh = mesh.map(|[x, y]| [x + 0.2 * y, y + 0.1 * x])?;
            norms(mesh, PlaneStrain::default(), rule)
        };
        optimal(&format!("{kind} {rule:?}"), degree, at(8)?, at(16)?);
    }
    Ok(())
}

#[test]
fn smooth_elastic_solution_converges_at_the_optimal_rates_in_space() -> Fallible {
    let kinds = [
        (Tet4, Full, 1.0, 6),
        (Hex8, Full, 1.0, 6),
        (Hex8, BBar, 1.0, 6),
        (Tet10, Reduced, 2.0, 3),
        (Hex20, Reduced, 2.0, 3),
        (Hex20, Full, 2.0, 3),
        (Hex27, Full, 2.0, 3),
    ];
    for (kind, rule, degree, n) in kinds {
        let at = |n| {
            let lines = uniform(0.0, 1.0, n);
            let mesh = block3("body", kind, &lines, &lines, &lines)?;
            let mesh = mesh.map(|[x, y, z]| [x + 0.2 * y, y + 0.1 * z, z + 0.1 * x])?;
            norms(mesh, Solid, rule)
        };
        optimal(&format!("{kind} {rule:?}"), degree, at(n)?, at(2 * n)?);
    }
    Ok(())
}

/// Half of a block pressed by a tool over a part of its top, clamped elsewhere, cut into n cells each
/// way: the energy that this takes. It is the least for these displacements, so that its error is the
/// square of that in the energy norm.
fn pressed(kind: CellKind, n: usize, cylinder: bool) -> Fallible<f64> {
    let lines = uniform(0.0, 1.0, n);
    let mut mesh = block2("block", kind, &lines, &lines)?;
    mesh.facet_group_where("zone", "block.top", |x| x[0] <= 0.5 + 1e-9)?;
    let law = Elastic::new(1e3, 0.3)?;
    let model =
        Model::new(mesh, PlaneStrain::default()).material("block", law, kind.integration())?;
    let model = match cylinder {
        true => model.tool("tool", Ball::new([0.0, 11.0], 10.0)?)?,
        false => model.tool("tool", Plane::new([0.0, 1.0], [0.0, -1.0])?)?,
    };
    let model = model.contact("zone", "tool", Coulomb::new(0.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .fix("block.right", &[Axis::X])
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .tool("tool", [0.0, -1e-2]);
    driver.run(&step, 1, |_, _| {})?;
    Ok(driver.energies().stored)
}

/// Rate in the energy norm, from energies on four meshes, each twice as fine as that before: the
/// mean of what the differences of neighbours say.
fn rate(energies: &[f64]) -> f64 {
    let d: Vec<f64> = energies.windows(2).map(|e| (e[0] - e[1]).abs()).collect();
    0.5 * (d[0] / d[d.len() - 1]).log2() / (d.len() - 1) as f64
}

#[test]
fn contact_and_singularities_limit_the_rates() -> Fallible {
    let measured = |kind, cylinder| -> Fallible<f64> {
        let at = |n| pressed(kind, n, cylinder);
        Ok(rate(&[at(8)?, at(16)?, at(32)?, at(64)?]))
    };
    // The edge of the contact leaves 5/2 derivatives of the displacement, that of the punch 3/2.
    for (kind, cylinder, expected) in [
        (Quad4, true, 1.0),
        (Quad8, true, 1.5),
        (Quad4, false, 0.5),
        (Quad8, false, 0.5),
    ] {
        let rate = measured(kind, cylinder)?;
        let off = (rate - expected).abs();
        assert!(off < 0.1, "{kind}, cylinder {cylinder}: {rate}");
    }
    Ok(())
}

/// The bore of a thick cylinder that hardens, moved outwards in one increment: what is stored and
/// dissipated is a minimum again, and the front of plastic flow within cells limits its rate.
#[test]
fn hardening_converges_at_the_rates_that_its_front_leaves() -> Fallible {
    let energy = |kind: CellKind, n: usize, moved: f64| -> Fallible<f64> {
        let elastic = cylinder::body(kind, kind.integration(), n, 0.3)?;
        let law = VonMises::new(cylinder::E, 0.3, cylinder::YIELD)?.with_isotropic(21e3)?;
        let model = Model::new(elastic.mesh().clone(), moreau::mesh::Axisymmetric).material(
            "body",
            law,
            kind.integration(),
        )?;
        let mut driver = Driver::new(model, Settings::default())?;
        let step = cylinder::held("grow").displace("body.left", Axis::X, moved);
        driver.run(&step, 1, |_, _| {})?;
        let energies = driver.energies();
        Ok(energies.stored + energies.plastic_dissipation)
    };
    // Where in a cell the front is decides the error of one mesh: the mean square over some fronts.
    let fronts: Vec<f64> = (0..8).map(|k| 0.16 + 0.01 * f64::from(k)).collect();
    for (kind, expected) in [(Quad4, 1.0), (Quad8, 1.5)] {
        let energies = |n: usize| -> Fallible<Vec<f64>> {
            fronts.iter().map(|&moved| energy(kind, n, moved)).collect()
        };
        let difference = |n: usize| -> Fallible<f64> {
            let [coarse, fine] = [energies(n)?, energies(2 * n)?];
            let square = coarse.iter().zip(&fine).map(|(a, b)| (a - b).powi(2));
            Ok(square.sum::<f64>().sqrt())
        };
        let rate = 0.5 * (difference(8)? / difference(64)?).log2() / 3.0;
        assert!((rate - expected).abs() < 0.1, "{kind}: {rate}");
    }
    Ok(())
}

/// Pulled, then sheared while the pull is held: a path of strains that turns. Implicit Euler is of
/// the first order in its increments.
#[test]
fn paths_that_turn_converge_in_time_at_first_order() -> Fallible {
    let lines = uniform(0.0, 1.0, 2);
    let load = |increments: usize| -> Fallible<f64> {
        let mesh = block2("body", Quad8, &lines, &lines)?;
        let law = VonMises::new(210e3, 0.3, 300.0)?.with_isotropic(2e3)?;
        let model = Model::new(mesh, PlaneStrain::default()).material("body", law, Reduced)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let held = Step::new("pull").fix("body.bottom", &[Axis::X, Axis::Y]);
        let pull = held.clone().displace("body.top", Axis::Y, 4e-3);
        driver.run(&pull, increments, |_, _| {})?;
        let shear = pull.displace("body.top", Axis::X, 8e-3);
        driver.run(&shear, increments, |_, _| {})?;
        Ok(driver.reaction("body.top")?[1])
    };
    let loads: Vec<f64> = [8, 16, 32, 64]
        .into_iter()
        .map(load)
        .collect::<Fallible<_>>()?;
    for three in loads.windows(3) {
        let order = ((three[0] - three[1]) / (three[1] - three[2])).log2();
        assert!((order - 1.0).abs() < 0.1, "{loads:?}: {order}");
    }
    Ok(())
}
