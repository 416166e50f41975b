//! Contract of a block: its forces are the gradient of its potential, its stiffness that of its
//! forces, whatever element, hypothesis and law.

use moreau_driver::{Analysis, Block, Cells, Motion, SolidBlock, Stiffness};
use moreau_laws::{BulkLaw, DruckerPrager, Elastic, ElasticDruckerPrager, VonMises};
use moreau_mesh::{Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3};
use nalgebra::DMatrix;

struct Evaluated {
    force: Vec<f64>,
    stiffness: DMatrix<f64>,
}

/// Forces and stiffness assembled densely.
fn evaluate<const D: usize>(
    block: &mut dyn Block<D>,
    motion: Motion<'_>,
    kind: Stiffness,
) -> Evaluated {
    let dofs = motion.by.len();
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
    block.evaluate(motion, kind, &mut |result| {
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

/// Free strains of about `size`, differently from point to point.
fn free_strains<const D: usize>(block: &dyn Block<D>, size: f64) -> Vec<f64> {
    let points = block.cells().len() * block.points_per_cell();
    (0..points).map(|k| size * (k as f64).cos()).collect()
}

/// The cells of a mesh under its full rule and under that of its kind.
fn rules<H: Analysis<D>, const D: usize>(
    mesh: &Mesh<D>,
    hypothesis: H,
) -> [(Vec<usize>, Box<dyn Cells<D>>); 2] {
    [Integration::Full, mesh.kind(0).integration()].map(|rule| {
        let members: Vec<usize> = (0..mesh.cell_count()).collect();
        let cells = hypothesis.cells(mesh, mesh.kind(0), &members, rule);
        (members, cells.expect("an element of this dimension"))
    })
}

fn contract<H: Analysis<D> + Copy, L: BulkLaw, const D: usize>(
    mesh: &Mesh<D>,
    hypothesis: H,
    law: L,
) {
    for (members, cells) in rules(mesh, hypothesis) {
        obeys_small_strains(mesh, &mut SolidBlock::new(members, cells, law.clone()));
    }
    contract_of_large_strains(mesh, hypothesis, law);
}

fn contract_of_large_strains<H: Analysis<D>, L: BulkLaw, const D: usize>(
    mesh: &Mesh<D>,
    hypothesis: H,
    law: L,
) {
    for (members, cells) in rules(mesh, hypothesis) {
        obeys_large_strains(mesh, &mut SolidBlock::large(members, cells, law.clone()));
    }
}

/// The slope of all forces at a motion along its k-th increment.
fn slopes<const D: usize>(
    block: &mut dyn Block<D>,
    motion: Motion<'_>,
    k: usize,
    h: f64,
) -> Vec<f64> {
    let mut at = |sign: f64| {
        let mut by = motion.by.to_vec();
        by[k] += sign * h;
        let moved = Motion { by: &by, ..motion };
        evaluate(block, moved, Stiffness::None).force
    };
    let (ahead, behind) = (at(1.0), at(-1.0));
    let of = |(a, b)| (a - b) / (2.0 * h);
    ahead.iter().zip(&behind).map(of).collect()
}

fn obeys_small_strains<const D: usize>(mesh: &Mesh<D>, block: &mut dyn Block<D>) {
    // From a plastic state on, with a step that loads some points and unloads others.
    let first = displacement(mesh, 4e-3, 0.0);
    let rest = vec![0.0; first.len()];
    let free = free_strains(block, 1e-3);
    let by = |by| Motion {
        free: &free,
        ..Motion::new(&rest, by)
    };
    evaluate(block, by(&first), Stiffness::None);
    block.commit();
    let d_u = displacement(mesh, 1.5e-3, 2.0);
    let mut at = evaluate(block, by(&d_u), Stiffness::Plastic(1.0));
    let elastic = evaluate(block, by(&d_u), Stiffness::Total(0.0)).stiffness;
    let stiffness_size = elastic.amax();
    let half = evaluate(block, by(&d_u), Stiffness::Total(0.5)).stiffness;
    let blended = &elastic + 0.5 * &at.stiffness;
    assert!((half - blended).amax() < 1e-14 * stiffness_size);
    at.stiffness += elastic;
    let force_size = at.force.iter().fold(0.0f64, |a, f| a.max(f.abs()));
    let h = 1e-7;
    for k in 0..d_u.len() {
        let potential = |side: f64| {
            let mut v = d_u.clone();
            v[k] += side * h;
            let moved = Motion {
                free: &free,
                ..Motion::new(&rest, &v)
            };
            block.potential(moved).expect("a potential")
        };
        let slope = (potential(1.0) - potential(-1.0)) / (2.0 * h);
        assert!(
            (slope - at.force[k]).abs() < 1e-6 * force_size,
            "force {k}: {slope}"
        );
        let slopes = slopes(block, by(&d_u), k, h);
        for (l, slope) in slopes.into_iter().enumerate() {
            let k_lk = at.stiffness[(l, k)];
            assert!(
                (slope - k_lk).abs() < 1e-5 * stiffness_size,
                "stiffness {l} {k}: {slope} {k_lk}"
            );
        }
    }
    // Forces alone are the same forces.
    assert_eq!(evaluate(block, by(&d_u), Stiffness::None).force, at.force);
}

fn obeys_large_strains<const D: usize>(mesh: &Mesh<D>, block: &mut dyn Block<D>) {
    let (before, by) = (displacement(mesh, 0.1, 0.0), displacement(mesh, 0.04, 2.0));
    let rest = vec![0.0; by.len()];
    let free = free_strains(block, 0.02);
    let first = Motion {
        free: &free,
        ..Motion::new(&rest, &before)
    };
    evaluate(block, first, Stiffness::None);
    block.commit();
    let motion = Motion {
        free: &free,
        ..Motion::new(&before, &by)
    };
    let at = evaluate(block, motion, Stiffness::Total(1.0));
    let size = at.stiffness.amax();
    assert!(at.force.iter().all(|f| f.is_finite()) && size > 0.0);
    for k in 0..by.len() {
        let mut along = rest.clone();
        along[k] = 1.0;
        let mut column: Vec<f64> = at.stiffness.column(k).iter().copied().collect();
        block.lacking(motion, &along, &mut |nodes, force| {
            for (&a, own) in nodes.iter().zip(force.chunks_exact(D)) {
                (0..D).for_each(|i| column[D * a + i] += own[i]);
            }
        });
        for (l, slope) in slopes(block, motion, k, 1e-6).into_iter().enumerate() {
            assert!(
                (slope - column[l]).abs() < 1e-6 * size,
                "stiffness {l} {k}: {slope} {}",
                column[l]
            );
        }
    }
    assert_eq!(evaluate(block, motion, Stiffness::None).force, at.force);
}

/// What the tangents of a flow that is not associated lack is lacking under free strains too.
#[test]
fn flow_that_is_not_associated_lacks_what_its_slopes_tell() {
    let cone = DruckerPrager::mohr_coulomb(5.0, 30.0, 5.0).expect("valid");
    let law = ElasticDruckerPrager::new(1e4, 0.3, cone).expect("valid");
    let mesh = plane(CellKind::Quad8);
    for (members, cells) in rules(&mesh, PlaneStrain::default()) {
        let block = &mut SolidBlock::new(members, cells, law);
        let by = displacement(&mesh, 4e-3, 0.5);
        let (rest, free) = (vec![0.0; by.len()], free_strains(block, 2e-3));
        let motion = Motion {
            free: &free,
            ..Motion::new(&rest, &by)
        };
        let at = evaluate(block, motion, Stiffness::Total(1.0));
        let (size, mut lacks) = (at.stiffness.amax(), 0.0f64);
        for k in 0..by.len() {
            let mut along = rest.clone();
            along[k] = 1.0;
            let mut column: Vec<f64> = at.stiffness.column(k).iter().copied().collect();
            block.lacking(motion, &along, &mut |nodes, force| {
                for (&a, own) in nodes.iter().zip(force.chunks_exact(2)) {
                    (0..2).for_each(|i| column[2 * a + i] += own[i]);
                    lacks = own.iter().fold(lacks, |m, f| m.max(f.abs()));
                }
            });
            for (l, slope) in slopes(block, motion, k, 1e-8).into_iter().enumerate() {
                let found = column[l];
                assert!(
                    (slope - found).abs() < 1e-5 * size,
                    "{l} {k}: {slope} {found}"
                );
            }
        }
        assert!(lacks > 1e-3 * size);
    }
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
    let rest = vec![0.0; d_u.len()];
    let entries = |block: &mut dyn Block<2>, kind, by: &[f64]| {
        let mut counts = Vec::new();
        let motion = Motion::new(&rest, by);
        let flows = block.evaluate(motion, kind, &mut |cell| counts.push(cell.stiffness.len()));
        (flows, counts)
    };
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
    let kinematic = steel().with_kinematic(2e4).expect("valid");
    contract_of_large_strains(&mesh(CellKind::Hex8), Solid, kinematic);
    contract(&mesh(CellKind::Tet4), Solid, steel());
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        contract(&mesh(kind), Solid, steel());
    }
}
