//! Assembly and solves of small systems against dense ones.

use super::choice::engine;
use super::*;
use crate::Model;
use crate::assembly::block::Block;
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::error::Inaccurate;
use crate::model::load::Loading;
use crate::newton::iterate::Iterate;
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use crate::vector::largest;
use moreau_algebra::{Cholesky, Cost, Inertia, Interface, Pattern, TooLarge};
use moreau_laws::{BulkLaw, Elastic, VonMises};
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain, block2, uniform};
use nalgebra::{DMatrix, DVector};

/// A body whose system is made without a driver: with one all of Newton's iteration would be compiled for these tests.
struct Body {
    mesh: Mesh<2>,
    blocks: Vec<Box<dyn Block<2>>>,
}

impl Body {
    fn new(mesh: Mesh<2>, law: impl BulkLaw + 'static) -> Self {
        let model = Model::new(mesh, PlaneStrain::default());
        let model = model.material("block", law, Integration::Reduced);
        let mut model = model.expect("valid");
        Self {
            blocks: model.take_blocks(),
            mesh: model.mesh,
        }
    }

    /// Of so many cells along each axis.
    fn block(cells: [usize; 2], law: impl BulkLaw + 'static) -> Self {
        let (x, y) = (uniform(0.0, 10.0, cells[0]), uniform(0.0, 5.0, cells[1]));
        Self::new(
            block2("block", CellKind::Quad8, &x, &y).expect("valid"),
            law,
        )
    }

    /// Nothing at every degree of freedom.
    fn rest(&self) -> Vec<f64> {
        vec![0.0; 2 * self.mesh.nodes().len()]
    }

    /// Degrees of freedom of a group along axes.
    fn along(&self, group: &str, axes: &[usize]) -> Vec<usize> {
        let nodes = self.mesh.node_group(group).expect("a group");
        let of = |a: usize| axes.iter().map(move |axis| 2 * a + axis);
        nodes.into_iter().flat_map(of).collect()
    }

    /// With its elastic stiffness.
    fn system(&mut self, held: &[usize], memory: Option<u64>, pivot: Option<usize>) -> System {
        let contacts = Contacts {
            nodes: &[],
            pivot,
            tools: 0,
            seam: Seam::Cheaper,
            coupled: None,
            turned: &[],
        };
        let fixed = (|dof: usize| held.contains(&dof), &Directions::default());
        let system = System::new(&self.mesh, &self.blocks, fixed, &contacts, (memory, None));
        let mut system = system.expect("held");
        let rest = self.rest();
        system.assemble_elastic(&mut self.blocks, &rest, true);
        system
    }
}

fn steel() -> Elastic {
    Elastic::new(210e3, 0.3).expect("valid")
}

/// A block held at its left side and pulled at the other, factorised, with its load.
fn pulled(memory: Option<u64>) -> (System, Vec<f64>) {
    pulled_about(memory, None)
}

/// With a node on the interface, if one is given.
fn pulled_about(memory: Option<u64>, pivot: Option<usize>) -> (System, Vec<f64>) {
    let mut body = Body::block([6, 3], steel());
    let held = body.along("block.left", &[0, 1]);
    let mut system = body.system(&held, memory, pivot);
    system.factorise(true).expect("definite");
    let mut load = body.rest();
    for dof in body.along("block.right", &[0]) {
        load[dof] = 70.0;
    }
    (system, load)
}

/// An engine whose solutions are wrong by a factor in one unknown until it factorises again, as by the faults that
/// memory and kernels make.
#[derive(Debug)]
struct Faulty {
    engine: Box<dyn Engine>,
    factor: f64,
}

impl Faulty {
    fn in_place_of(engine: &mut Box<dyn Engine>, factor: f64) {
        let none = Pattern::new(vec![0], Vec::new()).expect("empty");
        let none = Box::new(Cholesky::analyse(&none, None).expect("empty"));
        let engine_of = std::mem::replace(engine, none);
        *engine = Box::new(Self {
            engine: engine_of,
            factor,
        });
    }
}

impl Engine for Faulty {
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        let (engine, factor) = (engine(pattern, (memory, None), true)?, 1.0);
        Ok(Self { engine, factor })
    }
    fn size(&self) -> usize {
        self.engine.size()
    }
    fn kept(&self) -> usize {
        self.engine.kept()
    }
    fn cost(&self) -> Cost {
        self.engine.cost()
    }
    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.factor = 1.0;
        self.engine.factorise(values)
    }
    fn least_pivot(&self) -> f64 {
        self.engine.least_pivot()
    }
    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine.solve(x)?;
        x[0] *= self.factor;
        Ok(())
    }
    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine.condense(x)
    }
    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine.expand(x)?;
        x[0] *= self.factor;
        Ok(())
    }
    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        self.engine.schur()
    }
}

#[test]
fn a_factor_that_is_a_little_wrong_is_corrected() {
    let (mut system, load) = pulled(None);
    let solve = |system: &mut System| {
        let mut u = vec![0.0; load.len()];
        let outcome = system.solve(&load, &mut u);
        (u, outcome)
    };
    let (right, outcome) = solve(&mut system);
    assert_eq!(outcome, Ok(()));
    Faulty::in_place_of(&mut system.engine, 1.0 + 1e-8);
    let (u, outcome) = solve(&mut system);
    assert_eq!(outcome, Ok(()));
    let largest_error = largest(u.iter().zip(&right).map(|(u, v)| u - v));
    assert!(largest_error < 1e-11 * largest(right.iter().copied()));
}

/// A symmetric matrix from what it does to every unknown.
fn dense(matrix: &Matrix) -> DMatrix<f64> {
    let n = matrix.pattern.size();
    let column = |k: usize| {
        let mut unit = vec![0.0; n];
        unit[k] = -1.0;
        DVector::from_vec(matrix.residual(&unit, &vec![0.0; n]))
    };
    DMatrix::from_columns(&(0..n).map(column).collect::<Vec<_>>())
}

#[test]
fn the_coarse_stiffness_is_that_of_its_displacements() {
    let (own, load) = pulled(None);
    let (mut system, _) = pulled(Some(8 * own.factor_entries() as u64 - 8));
    let coarse = system.coarse.as_ref().expect("no room");
    let (fine, m) = (system.size(), coarse.dofs.len());
    assert!(m < fine);
    let column = |k: usize| {
        let (mut unit, mut v) = (vec![0.0; m], vec![0.0; fine]);
        unit[k] = 1.0;
        coarse.space.prolong(&unit, &mut v);
        DVector::from_vec(v)
    };
    let p = DMatrix::from_columns(&(0..m).map(column).collect::<Vec<_>>());
    let k = dense(&system.matrix);
    let difference = dense(coarse.space.matrix()) - p.transpose() * &k * &p;
    assert!(difference.amax() < 1e-12 * k.amax());
    let f = DVector::from_fn(fine, |i, _| (i as f64).sin());
    let restricted = DVector::from_vec(coarse.space.restrict(f.as_slice()));
    assert!((restricted - p.transpose() * f).norm() < 1e-12);
    // Brought to the solution of K itself, though not at once.
    let mut u = vec![0.0; load.len()];
    let mut exact = u.clone();
    let mut own = own;
    own.solve(&load, &mut exact).expect("accurate");
    let mut left = load.clone();
    for _ in 0..5 {
        let mut more = vec![0.0; load.len()];
        system.solve(&left, &mut more).expect("accurate");
        u.iter_mut().zip(more).for_each(|(u, v)| *u += v);
        let known: Vec<f64> = system.dofs.iter().map(|&dof| u[dof]).collect();
        let f: Vec<f64> = system.dofs.iter().map(|&dof| load[dof]).collect();
        let r = system.matrix.residual(&known, &f);
        system
            .dofs
            .iter()
            .zip(r)
            .for_each(|(&dof, r)| left[dof] = r);
    }
    assert!(system.conjugate > 5);
    let size = largest(exact.iter().copied());
    let error = largest(u.iter().zip(&exact).map(|(a, b)| a - b));
    assert!(error < 1e-8 * size, "{error:e} of {size:e}");
}

/// With nodes that are held in one direction, in both and in none: against a sum over the cells that
/// knows nothing of numbers or orders.
#[test]
fn the_stiffness_is_the_sum_of_those_of_the_cells() {
    let (x, y) = (uniform(0.0, 10.0, 5), uniform(0.0, 5.0, 4));
    let mesh = block2("block", CellKind::Quad8, &x, &y)
        .expect("valid")
        .map(|[x, y]| [x + 0.05 * y * y, y + 0.02 * x * y])
        .expect("valid");
    let mut body = Body::new(mesh, steel());
    let held = [("left", &[0, 1][..]), ("bottom", &[1]), ("right", &[0])];
    let held = held.map(|(side, axes)| body.along(&format!("block.{side}"), axes));
    let system = body.system(&held.concat(), None, None);
    let dofs = body.rest().len();
    let mut sum: DMatrix<f64> = DMatrix::zeros(dofs, dofs);
    for block in &mut body.blocks {
        let rest = vec![0.0; dofs];
        let rest = Motion::new(&rest, &rest);
        block.evaluate(rest, Stiffness::Total(0.0), &mut |cell| {
            let own: Vec<usize> = cell
                .nodes
                .iter()
                .flat_map(|&a| [2 * a, 2 * a + 1])
                .collect();
            let mut entries = cell.stiffness.iter();
            for (i, &p) in own.iter().enumerate() {
                for &q in &own[i..] {
                    let k = entries.next().expect("a triangle");
                    sum[(p, q)] += k;
                    if p != q {
                        sum[(q, p)] += k;
                    }
                }
            }
        });
    }
    assert!(system.size() < dofs - 20);
    let own = &system.dofs;
    let expected = DMatrix::from_fn(own.len(), own.len(), |i, j| sum[(own[i], own[j])]);
    let difference = (dense(&system.matrix) - &expected).amax();
    assert!(difference < 1e-14 * expected.amax(), "{difference:e}");
    // And what couples the unknowns to what is held.
    let mut coupled: DMatrix<f64> = DMatrix::zeros(dofs, dofs);
    for &(unknown, held, k) in &system.prescribed_columns {
        assert!(system.is_free(unknown) && !system.is_free(held));
        coupled[(unknown, held)] += k;
    }
    for &p in own {
        for q in (0..dofs).filter(|&q| !system.is_free(q)) {
            assert!((coupled[(p, q)] - sum[(p, q)]).abs() < 1e-14 * expected.amax());
        }
    }
}

/// Whether the elastic stiffness is kept or assembled anew.
#[test]
fn the_stiffness_is_the_same_whatever_is_kept() {
    let mut body = Body::block([6, 3], VonMises::new(210e3, 0.3, 300.0).expect("valid"));
    let (left, right) = (
        body.along("block.left", &[0, 1]),
        body.along("block.right", &[0]),
    );
    let mut system = body.system(&[left, right.clone()].concat(), None, None);
    let stretched = |x: &[f64; 2]| [1e-3 * x[0] * x[1], -1e-3 * x[1]];
    let d_u: Vec<f64> = body.mesh.nodes().iter().flat_map(stretched).collect();
    let missing = right.into_iter().map(|dof| (dof, 0.05)).collect();
    let rest = body.rest();
    let mut assembled = |system: &mut System, part: f64| {
        let (motion, stiffness) = (Motion::new(&rest, &d_u), Stiffness::Plastic(part));
        let assembly = system.assemble(&mut body.blocks, motion, &missing, stiffness);
        assert!(assembly.flows);
        (system.matrix.values().to_vec(), assembly)
    };
    assert!(system.keeps_elastic);
    let kept = [1.0, 0.3].map(|part| assembled(&mut system, part));
    system.keeps_elastic = false;
    system.prescribed_columns.clear();
    system.matrix = Matrix::new(system.matrix.pattern.clone());
    for ((values, assembly), part) in kept.into_iter().zip([1.0, 0.3]) {
        let (again, other) = assembled(&mut system, part);
        assert_eq!(assembly.internal, other.internal);
        let close = |a: &[f64], b: &[f64]| {
            let size = largest(a.iter().copied());
            assert!(size > 0.0);
            assert!(largest(a.iter().zip(b).map(|(a, b)| a - b)) < 1e-14 * size);
        };
        close(&values, &again);
        close(&assembly.prescribed_load, &other.prescribed_load);
    }
}

#[test]
fn a_corrupt_factor_is_told_and_not_used_again() {
    for by in [1.5, -1.0, f64::NAN, f64::INFINITY] {
        let (mut system, load) = pulled(None);
        Faulty::in_place_of(&mut system.engine, by);
        let mut u = vec![0.0; load.len()];
        let outcome = system.solve(&load, &mut u);
        let Err(Inaccurate { found, expected }) = outcome else {
            panic!("a factor wrong by {by} passes");
        };
        assert!(
            found > expected || !found.is_finite(),
            "{by}: {found} {expected}"
        );
        assert!(!system.holds_elastic_factor());
        // What is assembled still is the stiffness: another factor of it is right.
        system.factorise(true).expect("definite");
        assert_eq!(system.solve(&load, &mut u), Ok(()));
    }
}

/// K u − λ q = f and q·u + c λ = m against dense algebra.
#[test]
fn a_load_of_unknown_factor_is_solved_for_as_by_dense_algebra() {
    let (mut system, f) = pulled_about(None, Some(45));
    assert!(system.interface > 0);
    let mut q = SparseVector::default();
    let own = system.dofs.clone();
    own.iter()
        .step_by(3)
        .for_each(|&dof| q.add(dof, 1.0 + (dof as f64).sin()));
    let (compliance, missing) = (2.0, 0.3);
    let mut condensed = system.condense(f.clone());
    let mut stiffness = system.schur();
    let border = system.border((&mut stiffness, &mut condensed), &q, (compliance, missing));
    stiffness.fill_upper_triangle_with_lower_triangle();
    let x = stiffness.lu().solve(&condensed.load).expect("regular");
    let factor = system.factor(&border, &mut condensed, &x);
    let n = own.len();
    let mut bordered = DMatrix::zeros(n + 1, n + 1);
    bordered
        .view_mut((0, 0), (n, n))
        .copy_from(&dense(&system.matrix));
    // What is factorised has σ on the interface, which comes last.
    for i in n - system.interface..n {
        bordered[(i, i)] -= system.shift();
    }
    let mut right = DVector::zeros(n + 1);
    for (i, &dof) in own.iter().enumerate() {
        (bordered[(i, n)], bordered[(n, i)]) = (-q.at(dof), q.at(dof));
        right[i] = f[dof];
    }
    (bordered[(n, n)], right[n]) = (compliance, missing);
    let exact = bordered.lu().solve(&right).expect("regular");
    assert!(
        (factor / exact[n] - 1.0).abs() < 1e-9,
        "{factor} {}",
        exact[n]
    );
    let mut u = vec![0.0; f.len()];
    let free = (&SparseVector::default(), Interface::Held);
    system.expand(condensed, &x, free, &mut u).expect("solves");
    let size = largest(u.iter().copied());
    let off = own
        .iter()
        .zip(exact.iter())
        .map(|(&dof, exact)| u[dof] - exact);
    assert!(largest(off) < 1e-9 * size);
}

/// In an elastic body the forces of the tangent on what is missing are those that its motion makes.
#[test]
fn missing_displacements_are_out_of_balance_by_the_forces_that_they_make() {
    // Pulled up by a force and to the side by a displacement.
    let mut body = Body::block([6, 3], steel());
    let (left, right) = (
        body.along("block.left", &[0, 1]),
        body.along("block.right", &[0]),
    );
    let mut system = body.system(&[left, right.clone()].concat(), None, None);
    let missing: SparseVector = right.into_iter().map(|dof| (dof, 0.01)).collect();
    let mut end = Loading::<2>::default();
    for dof in body.along("block.right", &[1]) {
        end.force.add(dof, 1.5e3);
    }
    let rest = body.rest();
    let mut at = |d_u: Vec<f64>, missing: &SparseVector| {
        let motion = Motion::new(&rest, &d_u);
        let stiffness = Stiffness::Plastic(1.0);
        Iterate {
            assembly: system.assemble(&mut body.blocks, motion, missing, stiffness),
            d_u,
            contact: SparseVector::default(),
            heated: 0.0,
            part: 0.0,
        }
    };
    let first = at(rest.clone(), &missing);
    let mut moved = rest.clone();
    missing.add_to(&mut moved, 1.0);
    let arrived = at(moved, &SparseVector::default());
    let residual = first.residual(&end, system.prescribed());
    let found = first.once_arrived(&residual);
    let left = arrived.residual(&end, system.prescribed());
    let exact = largest(left.into_iter());
    assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    assert!(exact > 1.01 * largest(residual.into_iter()));
}
