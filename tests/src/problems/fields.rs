//! Displacement fields given in closed form: as boundary data and as what an error is measured
//! against; not the fields themselves.

use moreau::driver::{Driver, Loading, ModelError, Step};
use moreau::laws::{BulkLaw, Elastic};
use moreau::mandel::Sym2;
use moreau::mesh::{CellKind, Element, Hypothesis, Mesh, Quad4, Quad8, Quad9, Rule, Tri3, Tri6};
use nalgebra::SVector;

/// The loading of a step, with all displacements of some nodes prescribed by a field besides.
///
/// # Errors
/// Those of [`Driver::loading`].
pub fn prescribed<const D: usize>(
    driver: &Driver<D>,
    step: &Step<D>,
    nodes: &[usize],
    field: impl Fn(&[f64; D]) -> [f64; D],
) -> Result<Loading<D>, ModelError> {
    let mut loading = driver.loading(step)?;
    for &node in nodes {
        let u = field(&driver.mesh().nodes()[node]);
        loading
            .displacement
            .extend((0..D).map(|i| (D * node + i, u[i])));
    }
    Ok(loading)
}

/// An exact solution: displacement and its gradient ∂u_i/∂x_j in the plane.
pub trait PlaneField {
    /// u(x) \[mm\].
    fn displacement(&self, x: &[f64; 2]) -> [f64; 2];

    /// ∂u_i/∂x_j \[–\].
    fn gradient(&self, x: &[f64; 2]) -> [[f64; 2]; 2];

    /// The Mandel strain in plane strain.
    fn strain(&self, x: &[f64; 2]) -> Sym2 {
        let g = self.gradient(x);
        let shear = (g[0][1] + g[1][0]) / 2f64.sqrt();
        Sym2::from_column_slice(&[g[0][0], g[1][1], 0.0, 0.0, 0.0, shear])
    }
}

/// Norms of the error of a plane strain solution: energy norm √∫ e·S·e dx and L² norm √∫ ‖e‖² dx.
pub fn error_norms<H: Hypothesis<2>>(
    driver: &Driver<2>,
    law: &Elastic,
    exact: &impl PlaneField,
) -> (f64, f64) {
    let mesh = driver.mesh();
    let mut sum = (0.0, 0.0);
    for cell in 0..mesh.cell_count() {
        let part = match mesh.kind(cell) {
            CellKind::Tri3 => {
                on_cell::<Tri3, H, 3>(driver, mesh, cell, law, exact, &Rule::triangle(5))
            }
            CellKind::Tri6 => {
                on_cell::<Tri6, H, 6>(driver, mesh, cell, law, exact, &Rule::triangle(5))
            }
            CellKind::Quad4 => on_cell::<Quad4, H, 4>(driver, mesh, cell, law, exact, &square()),
            CellKind::Quad8 => on_cell::<Quad8, H, 8>(driver, mesh, cell, law, exact, &square()),
            CellKind::Quad9 => on_cell::<Quad9, H, 9>(driver, mesh, cell, law, exact, &square()),
            kind => panic!("{kind} is no plane cell"),
        };
        sum = (sum.0 + part.0, sum.1 + part.1);
    }
    (sum.0.sqrt(), sum.1.sqrt())
}

fn square() -> Rule<2> {
    Rule::quadrilateral(4)
}

fn on_cell<E: Element<2, N>, H: Hypothesis<2>, const N: usize>(
    driver: &Driver<2>,
    mesh: &Mesh<2>,
    cell: usize,
    law: &Elastic,
    exact: &impl PlaneField,
    rule: &Rule<2>,
) -> (f64, f64) {
    let nodes: [usize; N] = std::array::from_fn(|a| mesh.cell_nodes(cell)[a]);
    let positions = nodes.map(|a| mesh.nodes()[a]);
    let mut sum = (0.0, 0.0);
    for point in &rule.points {
        let at = E::map(&positions, point.xi);
        let mut strain = -exact.strain(&at.x);
        let mut error = -SVector::from(exact.displacement(&at.x));
        for a in 0..N {
            let u = driver.displacement(nodes[a]);
            strain += H::strain_operator(at.shape[a], &at.gradient[a], &at.x) * u;
            error += at.shape[a] * u;
        }
        let weight = point.weight * at.det;
        sum.0 += weight * law.stress(&strain).dot(&strain);
        sum.1 += weight * error.norm_squared();
    }
    sum
}
