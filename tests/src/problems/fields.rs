//! Displacement fields given in closed form: as boundary data and as what an error is measured
//! against; not the fields themselves.

use moreau::driver::{Driver, Loading, ModelError, Step};
use moreau::laws::{BulkLaw, Elastic};
use moreau::mandel::{Sym2, from_matrix};
use moreau::mesh::{
    CellKind, Element, Hex8, Hex20, Hex27, Hypothesis, PlaneStrain, Quad4, Quad8, Quad9, Rule,
    Solid, Tet4, Tet10, Tri3, Tri6,
};
use nalgebra::{Matrix3, SVector};

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

/// An exact solution: displacement and its gradient ∂u_i/∂x_j, in space or in plane strain.
pub trait Field<const D: usize> {
    /// u(x) \[mm\].
    fn displacement(&self, x: &[f64; D]) -> [f64; D];

    /// ∂u_i/∂x_j \[–\].
    fn gradient(&self, x: &[f64; D]) -> [[f64; D]; D];

    /// The Mandel strain.
    fn strain(&self, x: &[f64; D]) -> Sym2 {
        let g = self.gradient(x);
        from_matrix(&Matrix3::from_fn(|i, j| {
            if i.max(j) < D {
                0.5 * (g[i][j] + g[j][i])
            } else {
                0.0
            }
        }))
    }
}

/// Norms of the error of a solution: energy norm √∫ e·S·e dx and L² norm √∫ ‖e‖² dx, of the
/// strains that the displacements have, whatever the elements make of them.
pub fn error_norms<const D: usize, H: Meshed<D>>(
    driver: &Driver<D>,
    law: &Elastic,
    exact: &impl Field<D>,
) -> (f64, f64) {
    let cells = 0..driver.mesh().cell_count();
    let parts = cells.map(|cell| H::on_cell(driver, cell, law, exact));
    let sum = parts.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    (sum.0.sqrt(), sum.1.sqrt())
}

/// A hypothesis with the cells that it has, each with a rule that is finer than its own.
pub trait Meshed<const D: usize>: Hypothesis<D> {
    /// Squares of the norms on one cell.
    fn on_cell(driver: &Driver<D>, cell: usize, law: &Elastic, exact: &impl Field<D>)
    -> (f64, f64);
}

impl Meshed<2> for PlaneStrain {
    fn on_cell(
        driver: &Driver<2>,
        cell: usize,
        law: &Elastic,
        exact: &impl Field<2>,
    ) -> (f64, f64) {
        let (triangle, square) = (Rule::triangle(5), Rule::quadrilateral(4));
        match driver.mesh().kind(cell) {
            CellKind::Tri3 => squares::<Tri3, Self, 2, 3>(driver, cell, law, exact, &triangle),
            CellKind::Tri6 => squares::<Tri6, Self, 2, 6>(driver, cell, law, exact, &triangle),
            CellKind::Quad4 => squares::<Quad4, Self, 2, 4>(driver, cell, law, exact, &square),
            CellKind::Quad8 => squares::<Quad8, Self, 2, 8>(driver, cell, law, exact, &square),
            CellKind::Quad9 => squares::<Quad9, Self, 2, 9>(driver, cell, law, exact, &square),
            kind => panic!("{kind} is no plane cell"),
        }
    }
}

impl Meshed<3> for Solid {
    fn on_cell(
        driver: &Driver<3>,
        cell: usize,
        law: &Elastic,
        exact: &impl Field<3>,
    ) -> (f64, f64) {
        let (tetrahedron, cube) = (Rule::tetrahedron(5), Rule::hexahedron(4));
        match driver.mesh().kind(cell) {
            CellKind::Tet4 => squares::<Tet4, Self, 3, 4>(driver, cell, law, exact, &tetrahedron),
            CellKind::Tet10 => {
                squares::<Tet10, Self, 3, 10>(driver, cell, law, exact, &tetrahedron)
            }
            CellKind::Hex8 => squares::<Hex8, Self, 3, 8>(driver, cell, law, exact, &cube),
            CellKind::Hex20 => squares::<Hex20, Self, 3, 20>(driver, cell, law, exact, &cube),
            CellKind::Hex27 => squares::<Hex27, Self, 3, 27>(driver, cell, law, exact, &cube),
            kind => panic!("{kind} is no solid cell"),
        }
    }
}

fn squares<E: Element<D, N>, H: Hypothesis<D>, const D: usize, const N: usize>(
    driver: &Driver<D>,
    cell: usize,
    law: &Elastic,
    exact: &impl Field<D>,
    rule: &Rule<D>,
) -> (f64, f64) {
    let mesh = driver.mesh();
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
