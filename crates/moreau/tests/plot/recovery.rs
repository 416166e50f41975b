//! Stresses recovered at nodes: exact where they are linear, closer than the raw ones where they are
//! smooth, with the jumps between materials, and within the yield surface.

use moreau::driver::{Analysis, Driver, Model, PointField, PointState, Settings};
use moreau::driver::{Recovered, recover};
use moreau::laws::{BulkLaw, Elastic, VonMises};
use moreau::mandel::{Sym2, from_matrix, von_mises};
use moreau::mesh::{
    CellKind, Element, Hex8, Integration, Mesh, PlaneStrain, Quad4, Quad8, Solid, Tri6, block2,
    block3, uniform,
};
use nalgebra::Matrix3;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;

/// u = ∇φ of a harmonic φ: free of volume change and of body forces, with the stress 2G ∇∇φ.
/// φ = exp(a x) cos(y) cos(b z), a² = 1 + b².
fn harmonic<const D: usize>(x: &[f64; D]) -> ([f64; D], Sym2) {
    let b = if D == 3 { 1.0 } else { 0.0f64 };
    let a = (1.0 + b * b).sqrt();
    let z = if D == 3 { x[2] } else { 0.0 };
    let e = (a * x[0]).exp();
    let ((s, c), (t, k)) = (x[1].sin_cos(), (b * z).sin_cos());
    let phi = e * c * k;
    let gradient = [a * phi, -e * s * k, -b * e * c * t];
    let second = Matrix3::new(
        a * a * phi,
        -a * e * s * k,
        -a * b * e * c * t,
        -a * e * s * k,
        -phi,
        b * e * s * t,
        -a * b * e * c * t,
        b * e * s * t,
        -b * b * phi,
    );
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let u = std::array::from_fn(|i| gradient[i]);
    (u, from_matrix(&second) * (2.0 * shear))
}

/// A body whose boundary is displaced as a function says.
fn displaced<const D: usize, H: Analysis<D>, L: BulkLaw>(
    mesh: Mesh<D>,
    hypothesis: H,
    materials: &[(&str, L)],
    u: impl Fn(&[f64; D]) -> [f64; D],
) -> Driver<D> {
    let mut boundary: Vec<usize> = mesh
        .boundary_facets()
        .into_iter()
        .flat_map(|f| mesh.facet_nodes(f).collect::<Vec<_>>())
        .collect();
    boundary.sort_unstable();
    boundary.dedup();
    let places = mesh.nodes().to_vec();
    let mut model = Model::new(mesh, hypothesis);
    for (on, law) in materials {
        let rule = Integration::Reduced;
        model = model.material(on, law.clone(), rule).expect("a material");
    }
    let mut driver = Driver::new(model, Settings::default()).expect("a driver");
    let mut loading = driver.applied().clone();
    for node in boundary {
        let value = u(&places[node]);
        loading
            .displacement
            .extend((0..D).map(|i| (D * node + i, value[i])));
    }
    driver.advance(&loading).expect("converges");
    driver
}

fn recovered<const D: usize>(driver: &Driver<D>) -> Recovered {
    recover(
        driver.mesh(),
        driver.materials(),
        &driver.points(),
        &driver.fields(),
    )
}

/// Errors of the stress of the elements and of the recovered one, and how far these are from each
/// other, which estimates the first; in the mean square.
fn errors<E: Element<D, N>, const D: usize, const N: usize>(driver: &Driver<D>) -> [f64; 3] {
    let (mesh, found) = (driver.mesh(), recovered(driver));
    let law = Elastic::new(YOUNG, POISSON).expect("a law");
    let mut sums = [0.0; 3];
    for (cell, points) in found.cells.iter().enumerate() {
        let own: [usize; N] = std::array::from_fn(|a| mesh.cell_nodes(cell)[a]);
        let x = own.map(|n| mesh.nodes()[n]);
        for point in E::rule(Integration::Full).points {
            let map = E::map(&x, point.xi);
            let mut strain = Matrix3::zeros();
            for (a, &node) in own.iter().enumerate() {
                let u = driver.displacement(node);
                for i in 0..D {
                    for j in 0..D {
                        let half = 0.5 * u[i] * map.gradient[a][j];
                        strain[(i, j)] += half;
                        strain[(j, i)] += half;
                    }
                }
            }
            let raw = law
                .respond(&Default::default(), &from_matrix(&strain))
                .stress;
            let shape = E::shape(point.xi);
            let parts = points.iter().zip(shape).map(|(&p, n)| found.stress[p] * n);
            let smooth: Sym2 = parts.sum();
            let exact = harmonic(&map.x).1;
            let weight = point.weight * map.det;
            sums[0] += weight * (raw - exact).norm_squared();
            sums[1] += weight * (smooth - exact).norm_squared();
            sums[2] += weight * (smooth - raw).norm_squared();
        }
    }
    sums.map(f64::sqrt)
}

fn square(kind: CellKind, cells: usize) -> Mesh<2> {
    let lines = uniform(0.0, 1.0, cells);
    block2("b", kind, &lines, &lines).expect("a mesh")
}

/// Of a smooth stress, the recovered one has less than half of the error, and a higher order; what
/// it differs by from the raw one is the error of that, to a tenth.
#[test]
fn what_is_smooth_is_recovered_better_than_it_was() {
    fn ratios<E: Element<D, N>, const D: usize, const N: usize>(
        rows: [Driver<D>; 2],
    ) -> [[f64; 3]; 2] {
        rows.map(|driver| errors::<E, D, N>(&driver))
    }
    let law = [("b", Elastic::new(YOUNG, POISSON).expect("a law"))];
    let plane = |kind, cells| {
        let u = |x: &[f64; 2]| harmonic(x).0;
        displaced(square(kind, cells), PlaneStrain::default(), &law, u)
    };
    let space = |cells| {
        let lines = uniform(0.0, 1.0, cells);
        let mesh = block3("b", CellKind::Hex8, &lines, &lines, &lines).expect("a mesh");
        displaced(mesh, Solid, &law, |x: &[f64; 3]| harmonic(x).0)
    };
    let quad8 = ratios::<Quad8, 2, 8>([plane(CellKind::Quad8, 4), plane(CellKind::Quad8, 8)]);
    let tri6 = ratios::<Tri6, 2, 6>([plane(CellKind::Tri6, 4), plane(CellKind::Tri6, 8)]);
    let quad4 = ratios::<Quad4, 2, 4>([plane(CellKind::Quad4, 6), plane(CellKind::Quad4, 12)]);
    let hex8 = ratios::<Hex8, 3, 8>([space(4), space(8)]);
    for (name, [coarse, fine]) in [
        ("quad8", quad8),
        ("tri6", tri6),
        ("quad4", quad4),
        ("hex8", hex8),
    ] {
        let [raw, better] = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
        assert!(fine[1] < 0.5 * fine[0], "{name}: {coarse:?} {fine:?}");
        // On the boundary, where patches are one-sided, less than a whole order is gained.
        assert!(better > raw + 0.25, "{name}: {raw} {better}");
        let effectivity = fine[2] / fine[0];
        assert!((0.9..=1.1).contains(&effectivity), "{name}: {effectivity}");
    }
}

/// A linear stress on a skewed mesh of every kind, at every node, also where one cell is alone.
#[test]
fn a_linear_stress_is_exact() {
    let linear = |x: &[f64; 2]| Sym2::from_fn(|i, _| 1.0 + i as f64 + 2.0 * x[0] - 0.3 * x[1]);
    for kind in [
        CellKind::Tri6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        for cells in [1, 2, 3] {
            let mesh = square(kind, cells);
            let nodes: Vec<[f64; 2]> = mesh
                .nodes()
                .iter()
                .map(|x| [x[0] + 0.3 * x[1], x[1]])
                .collect();
            let own = (0..mesh.cell_count()).map(|c| (kind, mesh.cell_nodes(c).to_vec()));
            let mesh = Mesh::new(nodes, own.collect()).expect("a mesh");
            let point = |cell: usize, position: [f64; 2]| PointState {
                cell,
                position,
                weight: 1.0,
                stress: linear(&position),
                jacobian: 1.0,
                plastic_strain: 0.0,
            };
            // Points of a parallelogram: the middle, and a quarter of the way to the corners.
            let mut points = Vec::new();
            for cell in 0..mesh.cell_count() {
                let corners = &mesh.cell_nodes(cell)[..kind.corner_count()];
                let x: Vec<[f64; 2]> = corners.iter().map(|&n| mesh.nodes()[n]).collect();
                let middle = [0, 1].map(|i| x.iter().map(|x| x[i]).sum::<f64>() / x.len() as f64);
                points.extend(
                    x.iter().map(|x| {
                        point(cell, [0, 1].map(|i| middle[i] + 0.55 * (x[i] - middle[i])))
                    }),
                );
            }
            let field =
                |name: &str, components, of: &dyn Fn(&PointState<2>) -> Vec<f64>| PointField {
                    name: name.into(),
                    components,
                    values: points.iter().flat_map(of).collect(),
                };
            let fields = [
                field("height", 1, &|p| vec![p.position[1]]),
                field("twice", 6, &|p| (2.0 * p.stress).as_slice().to_vec()),
            ];
            let found = recover(&mesh, &vec![0; mesh.cell_count()], &points, &fields);
            if kind == CellKind::Quad4 && cells < 2 {
                continue; // One mean has no slope.
            }
            for (x, stress) in mesh.nodes().iter().zip(&found.stress) {
                let error = (stress - linear(x)).norm();
                assert!(error < 1e-10, "{kind} {cells}: {error} at {x:?}");
            }
            // A tensor like the stress; a scalar never beyond what the points around have.
            let [heights, twice] = &found.fields[..] else {
                panic!("two fields")
            };
            for (own, stress) in twice.values.chunks_exact(6).zip(&found.stress) {
                assert!((Sym2::from_column_slice(own) - 2.0 * stress).norm() < 1e-10);
            }
            let known = points.iter().map(|p| p.position[1]);
            let (low, high) = known.fold((1.0f64, 0.0f64), |(l, h), y| (l.min(y), h.max(y)));
            for (y, x) in heights.values.iter().zip(mesh.nodes()) {
                let expected = x[1].clamp(low, high);
                let inside = x[1] == expected;
                assert!((low..=high).contains(y), "{kind} {cells}: {y} at {x:?}");
                assert!(
                    !inside || (y - expected).abs() < 1e-10,
                    "{kind} {cells}: {y} at {x:?}"
                );
            }
        }
    }
}

/// Two materials in one body: each side of their line has its own stress, exactly.
#[test]
fn jumps_between_materials_are_kept() {
    let mut mesh = square(CellKind::Quad8, 4);
    let left = |c: &usize| {
        mesh.cell_nodes(*c)
            .iter()
            .all(|&n| mesh.nodes()[n][0] < 0.5 + 1e-9)
    };
    let (soft, hard): (Vec<usize>, Vec<usize>) = (0..mesh.cell_count()).partition(left);
    mesh.add_cell_group("soft", soft.clone()).expect("a group");
    mesh.add_cell_group("hard", hard).expect("a group");
    let law = |young| Elastic::new(young, 0.0).expect("a law");
    let laws = [("soft", law(100.0)), ("hard", law(1000.0))];
    let driver = displaced(mesh, PlaneStrain::default(), &laws, |x| [0.0, 0.01 * x[1]]);
    let found = recovered(&driver);
    assert_eq!(found.nodes.len(), driver.mesh().nodes().len() + 9);
    for (cell, points) in found.cells.iter().enumerate() {
        let expected = if soft.contains(&cell) { 1.0 } else { 10.0 };
        for &p in points {
            let stress = found.stress[p];
            assert!((stress[1] - expected).abs() < 1e-9, "cell {cell}: {stress}");
        }
    }
}

/// Perfect plasticity: no node is beyond the yield stress, and some are at it; plastic strains are
/// those of the points or between them.
#[test]
fn plastic_stresses_stay_within_the_yield_surface() {
    let law = [("b", VonMises::new(YOUNG, POISSON, 1.0).expect("a law"))];
    // A shear that grows along x: flow in a part of the body.
    let driver = displaced(
        square(CellKind::Quad8, 4),
        PlaneStrain::default(),
        &law,
        |x| [0.0, 2e-3 * x[0] * x[0]],
    );
    let flows = driver
        .points()
        .iter()
        .filter(|p| p.plastic_strain > 0.0)
        .count();
    assert!(flows > 0 && flows < driver.points().len());
    let found = recovered(&driver);
    let most = found.stress.iter().map(von_mises).fold(0.0, f64::max);
    assert!(most <= 1.0 + 1e-9 && most > 1.0 - 1e-9, "{most}");
    let highest = driver
        .points()
        .iter()
        .map(|p| p.plastic_strain)
        .fold(0.0, f64::max);
    let within = |p: &f64| (0.0..=highest).contains(p);
    assert!(found.plastic_strain.iter().all(within));
}
