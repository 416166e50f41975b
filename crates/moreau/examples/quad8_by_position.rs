//! An element from outside: a quadrilateral of eight nodes that keeps quadratic fields on distorted
//! cells too, with the patch test that tells it from the serendipity one; not a kind of cell in files.

use moreau::driver::{Driver, ElementCells, Model, Settings, SolidBlock};
use moreau::laws::Elastic;
use moreau::mesh::{
    CellKind, Element, Integration, Mapped, PlaneStrain, Quad8, Quad9, Rule, block2,
};
use nalgebra::{SMatrix, SVector, Vector2};
use std::{array::from_fn, error::Error};

/// [`Quad9`] with Σ c_a u_a for the value of its middle node, where c is the nearest to (−¼, ½) of the
/// serendipity element that is exact for quadratic functions of the position.
struct Quad8ByPosition;

impl Element<2, 8> for Quad8ByPosition {
    const NODES: [[f64; 2]; 8] = Quad8::NODES;
    const FACETS: &'static [&'static [usize]] = Quad8::FACETS;
    fn shape(xi: [f64; 2]) -> [f64; 8] {
        Quad8::shape(xi)
    }
    fn shape_gradient(xi: [f64; 2]) -> [[f64; 2]; 8] {
        Quad8::shape_gradient(xi)
    }
    fn rule(integration: Integration) -> Rule<2> {
        Quad8::rule(integration)
    }
    fn map(nodes: &[[f64; 2]; 8], xi: [f64; 2]) -> Mapped<2, 8> {
        let usual = SVector::<f64, 8>::from_fn(|a, _| if a < 4 { -0.25 } else { 0.5 });
        let middle = from_fn(|i| (0..8).map(|a| usual[a] * nodes[a][i]).sum());
        let size = (Vector2::from(nodes[2]) - Vector2::from(nodes[0])).norm();
        let terms = |x: &[f64; 2]| {
            let d = (Vector2::from(*x) - Vector2::from(middle)) / size;
            SVector::from([1.0, d.x, d.y, d.x * d.x, d.x * d.y, d.y * d.y])
        };
        let known = SMatrix::<f64, 6, 8>::from_fn(|k, a| terms(&nodes[a])[k]);
        let moments = (known * known.transpose()).try_inverse();
        let lacking = moments.unwrap_or_default() * (terms(&middle) - known * usual);
        let c = usual + known.transpose() * lacking;
        let of = Quad9::map(&from_fn(|a| *nodes.get(a).unwrap_or(&middle)), xi);
        let mut mapped = Quad8::map(nodes, xi);
        mapped.shape = from_fn(|a| of.shape[a] + c[a] * of.shape[8]);
        mapped.gradient = from_fn(|a| from_fn(|i| of.gradient[a][i] + c[a] * of.gradient[8][i]));
        mapped
    }
}

/// Largest error in four distorted cells whose border is displaced as a function says.
fn patch<E: Element<2, 8>>(exact: impl Fn(f64, f64) -> [f64; 2]) -> Result<f64, Box<dyn Error>> {
    let mesh = block2("patch", CellKind::Quad8, &[0.0, 2.0, 4.0], &[0.0, 1.0, 2.0])?;
    let hat = |x: f64, y: f64| (1.0 - 0.5 * (x - 2.0).abs()) * (1.0 - (y - 1.0).abs());
    let mesh = mesh.map(|[x, y]| [x + 0.6 * hat(x, y), y - 0.3 * hat(x, y)])?;
    let (all, rule): (Vec<usize>, _) = ((0..mesh.cell_count()).collect(), Integration::Full);
    let cells = ElementCells::new::<E, _>(&mesh, &all, &PlaneStrain::default(), rule)?;
    let block = SolidBlock::new(all, Box::new(cells), Elastic::new(210e3, 0.3)?);
    let model = Model::new(mesh, PlaneStrain::default()).block("patch", block)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let mut loading = driver.applied().clone();
    let places = driver.mesh().nodes().to_vec();
    for (n, &[x, y]) in places.iter().enumerate() {
        if x == 0.0 || x == 4.0 || y == 0.0 || y == 2.0 {
            let [u, v] = exact(x, y);
            let held = [(2 * n, u), (2 * n + 1, v)];
            loading.displacement.extend(held);
        }
    }
    driver.advance(&loading)?;
    let exact = |n: usize| Vector2::from(exact(places[n][0], places[n][1]));
    let errors = (0..places.len()).map(|n| (driver.displacement(n) - exact(n)).norm());
    Ok(errors.fold(0.0, f64::max))
}

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let stretched = |x: f64, y: f64| [2e-3 * x + 1e-3 * y, 5e-4 * x - 1e-3 * y];
    assert!(patch::<Quad8ByPosition>(stretched)? < 1e-15);
    // Pure bending in plane strain: σ_x = E κ y/(1 − ν²) alone.
    let bent = |x: f64, y: f64| [1e-3 * x * y, -5e-4 * (x * x + 3.0 / 7.0 * y * y)];
    assert!(patch::<Quad8ByPosition>(bent)? < 1e-15 && patch::<Quad8>(bent)? > 1e-5);
    Ok(())
}
