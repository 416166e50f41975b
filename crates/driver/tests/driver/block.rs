//! Contract of a block: its forces are the gradient of its potential, its stiffness that of its
//! forces, whatever element, hypothesis and law.

use moreau_driver::{Analysis, Block, SolidBlock, Stiffness};
use moreau_laws::{BulkLaw, Elastic, VonMises};
use moreau_mesh::{Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3};
use nalgebra::DMatrix;

struct Evaluated {
    force: Vec<f64>,
    stiffness: DMatrix<f64>,
}

/// Forces and stiffness assembled densely.
fn evaluate<const D: usize>(block: &mut dyn Block<D>, d_u: &[f64], kind: Stiffness) -> Evaluated {
    let dofs = d_u.len();
    let cells: Vec<Vec<usize>> = (0..block.cells().len())
        .map(|k| {
            block
                .nodes(k)
                .iter()
                .flat_map(|&a| D * a..D * a + D)
                .collect()
        })
        .collect();
    let mut out = Evaluated {
        force: vec![0.0; dofs],
        stiffness: DMatrix::zeros(dofs, dofs),
    };
    block.evaluate(d_u, kind, &mut |result| {
        let own = &cells[result.cell];
        let mut entries = result.stiffness.iter();
        for (i, &a) in own.iter().enumerate() {
            out.force[a] += result.force[i];
            for (&b, k) in own[i..].iter().zip(entries.by_ref()) {
                out.stiffness[(a, b)] += k;
                if a != b {
                    out.stiffness[(b, a)] += k;
                }
            }
        }
    });
    out
}

/// A displacement that strains everywhere by about `size`, differently from point to point.
fn displacement<const D: usize>(mesh: &Mesh<D>, size: f64, phase: f64) -> Vec<f64> {
    let wave = |x: &[f64; D], i: usize| {
        let s: f64 = x
            .iter()
            .enumerate()
            .map(|(k, v)| v * (0.7 + 0.2 * k as f64))
            .sum();
        size * ((s + phase + 2.0 * i as f64).sin() + 0.3 * x[i])
    };
    mesh.nodes()
        .iter()
        .flat_map(|x| (0..D).map(move |i| wave(x, i)))
        .collect()
}

fn contract<H: Analysis<D>, L: BulkLaw, const D: usize>(mesh: &Mesh<D>, hypothesis: H, law: L) {
    obeys(mesh, &hypothesis, Integration::Full, law.clone());
    obeys(mesh, &hypothesis, mesh.kind(0).integration(), law);
}

fn obeys<H: Analysis<D>, L: BulkLaw, const D: usize>(
    mesh: &Mesh<D>,
    hypothesis: &H,
    rule: Integration,
    law: L,
) {
    let members: Vec<usize> = (0..mesh.cell_count()).collect();
    let cells = hypothesis
        .cells(mesh, mesh.kind(0), &members, rule)
        .expect("an element of this dimension");
    let mut block = SolidBlock::new(members, cells, law);
    // From a plastic state on, with a step that loads some points and unloads others.
    let first = displacement(mesh, 4e-3, 0.0);
    evaluate(&mut block, &first, Stiffness::None);
    block.commit();
    let d_u = displacement(mesh, 1.5e-3, 2.0);
    let mut at = evaluate(&mut block, &d_u, Stiffness::Plastic(1.0));
    let elastic = evaluate(&mut block, &d_u, Stiffness::Total(0.0)).stiffness;
    let stiffness_size = elastic.amax();
    let half = evaluate(&mut block, &d_u, Stiffness::Total(0.5)).stiffness;
    let blended = &elastic + 0.5 * &at.stiffness;
    assert!((half - blended).amax() < 1e-14 * stiffness_size);
    at.stiffness += elastic;
    let force_size = at.force.iter().fold(0.0f64, |a, f| a.max(f.abs()));
    let h = 1e-7;
    for k in 0..d_u.len() {
        let moved = |sign: f64| {
            let mut v = d_u.clone();
            v[k] += sign * h;
            v
        };
        let potential = |side: f64| block.potential(&moved(side)).expect("a potential");
        let slope = (potential(1.0) - potential(-1.0)) / (2.0 * h);
        assert!(
            (slope - at.force[k]).abs() < 1e-6 * force_size,
            "force {k}: {slope}"
        );
        let ahead = evaluate(&mut block, &moved(1.0), Stiffness::None).force;
        let behind = evaluate(&mut block, &moved(-1.0), Stiffness::None).force;
        for l in 0..d_u.len() {
            let slope = (ahead[l] - behind[l]) / (2.0 * h);
            let k_lk = at.stiffness[(l, k)];
            assert!(
                (slope - k_lk).abs() < 1e-5 * stiffness_size,
                "stiffness {l} {k}: {slope} {k_lk}"
            );
        }
    }
    // Forces alone are the same forces.
    assert_eq!(evaluate(&mut block, &d_u, Stiffness::None).force, at.force);
}

/// Cells that stay elastic hand on no stiffness but the elastic one.
#[test]
fn flow_adds_to_the_stiffness_of_cells_that_flow() {
    let x = [0.0, 1.0, 2.0];
    let mesh = block2("b", CellKind::Quad8, &x, &[0.0, 1.0]).expect("valid");
    let cells = PlaneStrain::default()
        .cells(&mesh, CellKind::Quad8, &[0, 1], Integration::Reduced)
        .expect("an element of the plane");
    let mut block = SolidBlock::new(vec![0, 1], cells, steel());
    let pulled = |x: &[f64; 2]| [1e-2 * (x[0] - 1.0).max(0.0), 0.0];
    let d_u: Vec<f64> = mesh.nodes().iter().flat_map(pulled).collect();
    let entries = |block: &mut dyn Block<2>, kind, d_u: &[f64]| {
        let mut counts = Vec::new();
        let flows = block.evaluate(d_u, kind, &mut |cell| counts.push(cell.stiffness.len()));
        (flows, counts)
    };
    let rest = vec![0.0; d_u.len()];
    let plastic = Stiffness::Plastic(1.0);
    assert_eq!(entries(&mut block, plastic, &rest), (false, vec![0, 0]));
    assert_eq!(entries(&mut block, plastic, &d_u), (true, vec![0, 136]));
    assert_eq!(
        entries(&mut block, Stiffness::None, &d_u),
        (true, vec![0, 0])
    );
    assert_eq!(
        entries(&mut block, Stiffness::Total(0.0), &d_u),
        (true, vec![136, 136])
    );
}

fn steel() -> VonMises {
    VonMises::new(210e3, 0.3, 300.0)
        .expect("valid")
        .with_isotropic(500.0)
        .expect("valid")
}

fn plane(kind: CellKind) -> Mesh<2> {
    let mesh = block2("b", kind, &[1.0, 2.1], &[0.0, 0.9]).expect("valid");
    // A slight distortion, so that nothing holds by symmetry alone.
    mesh.map(|x| [x[0] + 0.1 * x[1], x[1] + 0.05 * x[0] * x[1]])
        .expect("valid")
}

#[test]
fn plane_strain_blocks() {
    let h = PlaneStrain::new(2.0).expect("valid");
    contract(&plane(CellKind::Tri3), h, steel());
    contract(&plane(CellKind::Tri6), h, steel());
    contract(&plane(CellKind::Quad4), h, steel());
    contract(&plane(CellKind::Quad8), h, steel());
    contract(&plane(CellKind::Quad9), h, steel());
}

#[test]
fn axisymmetric_blocks() {
    contract(&plane(CellKind::Quad8), Axisymmetric, steel());
    contract(&plane(CellKind::Quad4), Axisymmetric, steel());
    let elastic = Elastic::new(210e3, 0.3).expect("valid");
    contract(&plane(CellKind::Tri6), Axisymmetric, elastic);
}

#[test]
fn solid_blocks() {
    let mesh = |kind| {
        let mesh = block3("b", kind, &[0.0, 1.0], &[0.0, 1.2], &[0.0, 0.8]).expect("valid");
        mesh.map(|x| [x[0] + 0.1 * x[1] * x[2], x[1] + 0.05 * x[0], x[2]])
            .expect("valid")
    };
    contract(&mesh(CellKind::Hex8), Solid, steel());
    contract(&mesh(CellKind::Tet4), Solid, steel());
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        contract(&mesh(kind), Solid, steel());
    }
}
