//! The linear system of a mesh: numbering, pattern, assembly and static condensation on the
//! interface; not the iteration that uses it.

use crate::ModelError;
use crate::block::{Block, Stiffness};
use crate::cholesky::{Cholesky, NotPositiveDefinite, Pattern, TooLarge};
use crate::coarse::Coarse;
use crate::conjugate::{Conjugate, Interface};
use crate::dense::square;
use crate::iterate::imbalance;
use crate::matrix::Matrix;
use crate::norm::largest;
use crate::numbering::Numbering;
use crate::scatter::{FIXED, Scatter, couplings};
use crate::sparse::Sparse;
use crate::timings::{Timings, timed};
use moreau_mesh::Mesh;
use nalgebra::{DMatrix, DVector};
use std::time::Instant;

/// K of the free degrees of freedom, ordered so that those of the interface come last.
///
/// K + σE is what is factorised, with E the identity on the interface: it is positive definite as
/// soon as holding the interface holds the bodies, and the Schur complement of K itself is
/// L_cc L_ccᵀ − σ 1 exactly, even where only contact holds a body and K is singular.
///
/// Where that factor has no room, or would take longer than conjugate gradients, the stiffness of a
/// coarse space takes its place: S is then that of the coarse space, and so are the condensed loads,
/// and what they give is brought to the solution of K itself by conjugate gradients.
#[derive(Debug)]
pub(crate) struct System {
    /// Position of a degree of freedom in the system, or [`FIXED`].
    position: Vec<u32>,
    /// Degree of freedom at a position.
    dofs: Vec<usize>,
    /// Number of interface unknowns: the last of the system.
    interface: usize,
    /// A node of the interface that no contact point needs.
    pub(crate) pivot: Option<usize>,
    /// Where the cells of every block go.
    scatter: Vec<Scatter>,
    /// Entries of the elastic K that is kept between an unknown and a prescribed displacement: their
    /// degrees of freedom.
    couplings: Vec<(usize, usize, f64)>,
    /// Whether the elastic stiffness is kept, so that only what flow adds to it is assembled anew.
    keeps_elastic: bool,
    /// K.
    matrix: Matrix,
    /// What is factorised instead where the factor of K is too large.
    coarse: Option<Coarse>,
    shift: f64,
    stiffest: f64,
    cholesky: Cholesky,
    /// Whether the factor held is that of the elastic stiffness.
    elastic_factor: bool,
    /// Whether the values are those that the factor was made of.
    current: bool,
    /// Factorisations done since the system was set up.
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients since then.
    pub(crate) conjugate: usize,
    pub(crate) timings: Timings,
}

/// Internal forces of an assembly.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assembly {
    /// ∫ Bᵀσ dΩ at every degree of freedom \[N\].
    pub(crate) internal: Vec<f64>,
    /// K times the prescribed displacements that are still missing \[N\]; empty if none are.
    pub(crate) coupling: Vec<f64>,
    /// Whether plastic strain grows anywhere.
    pub(crate) flows: bool,
    /// Whether the system has the stiffness that belongs to these forces.
    pub(crate) stiffness: bool,
}

impl Assembly {
    /// The load of a Newton step under forces, at every degree of freedom \[N\].
    pub(crate) fn load(&self, forces: &[&Sparse]) -> Vec<f64> {
        let mut load = imbalance(&self.internal, forces, &[]);
        let pairs = load.iter_mut().zip(&self.coupling);
        pairs.for_each(|(f, coupling)| *f -= coupling);
        load
    }
}

/// Residual of a solve with the factor, over the size of the terms that it is a difference of, up
/// to which the factor is right: a thousand times what rounding leaves.
const ACCURATE: f64 = 1e-12;

/// Entries of an elastic stiffness that is kept: 16 MB. A larger one would add a tenth to the memory
/// of the factor, which takes so long that to assemble it anew is little.
const KEPT: usize = 1 << 21;

/// Operations of a factorisation in the time in which a step takes up an entry of the factor.
const OPERATIONS: f64 = 200.0;

/// Operations of a factorisation in about the time of the conjugate gradients of a Newton step: ten
/// iterations, each of which reads the matrix five times and the factor of its coarse space twice; an
/// entry is read in the time of eighty operations.
fn conjugate_operations(pattern: &Pattern, coarse: usize) -> f64 {
    10.0 * 80.0 * (5.0 * pattern.entries() as f64 + 2.0 * coarse as f64)
}

/// A factor that does not solve the system it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inaccurate {
    /// Largest residual \[N\].
    pub(crate) found: f64,
    /// The largest that rounding explains \[N\].
    pub(crate) expected: f64,
}

/// A load q of unknown factor in a condensed system, and the equation that decides it:
/// q·u + c λ = m.
#[derive(Debug)]
pub(crate) struct Border {
    /// q at the unknowns \[N\].
    applied: Vec<f64>,
    /// L⁻¹ q.
    forward: Vec<f64>,
    /// q̃, q condensed on the interface \[N\].
    load: DVector<f64>,
    /// c + q·u of the interior under q alone, the interface held \[N·mm\].
    compliance: f64,
    /// m less what the interior does under the other loads, the interface held \[N·mm\].
    missing: f64,
}

/// The system condensed on its interface: S = L_cc L_ccᵀ − σ 1 and the condensed load.
#[derive(Debug)]
pub(crate) struct Condensed {
    /// S \[N/mm\], in the order of the interface unknowns.
    pub(crate) stiffness: DMatrix<f64>,
    /// f̃ \[N\].
    pub(crate) load: DVector<f64>,
    /// The load of the system \[N\].
    applied: Vec<f64>,
    /// L⁻¹ of the load of the system.
    forward: Vec<f64>,
}

impl System {
    /// Numbers the free degrees of freedom, orders them and does the symbolic factorisation. The
    /// interface is that of the contact points, the node `pivot` if there is one, and the tools: they
    /// are nodes after those of the mesh, without stiffness. The factor may take `memory` \[bytes\].
    ///
    /// # Errors
    /// [`ModelError::TooLarge`] where neither its own factor nor that of a coarse space has room.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        blocks: &[Box<dyn Block<D>>],
        fixed: impl Fn(usize) -> bool,
        interface_nodes: &[usize],
        pivot: Option<usize>,
        tools: usize,
        memory: Option<u64>,
    ) -> Result<Self, ModelError> {
        let clock = Instant::now();
        let Numbering {
            position,
            dofs,
            interface,
            pattern,
        } = Numbering::new(mesh, &fixed, interface_nodes, pivot, tools);
        let scatter = blocks
            .iter()
            .map(|b| Scatter::new(b.as_ref(), &position, &pattern))
            .collect();
        let coarse = || {
            let space = (interface_nodes, pivot, tools);
            let coarse = Coarse::new(mesh, blocks, &fixed, space, &dofs)?;
            let factor = Cholesky::analyse(&coarse.matrix.pattern, memory, |_| true);
            Some(factor.map(|factor| (factor, Some(coarse))))
        };
        let mut other = None;
        let own = Cholesky::analyse(&pattern, memory, |cost| {
            // In the plane a factor is small, and linear cells in plastic flow are a poor coarse space.
            if D == 3 && conjugate_operations(&pattern, 0) < cost.operations {
                other = coarse().filter(|other| {
                    other.as_ref().is_ok_and(|(factor, _)| {
                        let solution = conjugate_operations(&pattern, factor.entries());
                        factor.operations() + solution < cost.operations
                    })
                });
            }
            other.is_none()
        });
        let chosen = match own {
            Ok(factor) => Ok((factor, None)),
            Err(too_large) => other.or_else(coarse).unwrap_or(Err(too_large)),
        };
        let gigabytes = |entries: f64| entries * size_of::<f64>() as f64 / 1e9;
        let (cholesky, coarse) =
            chosen.map_err(|TooLarge { entries, room }| ModelError::TooLarge {
                unknowns: dofs.len(),
                needed: gigabytes(entries),
                room: gigabytes(room),
            })?;
        Ok(Self {
            position,
            dofs,
            interface,
            pivot,
            scatter,
            couplings: Vec::new(),
            keeps_elastic: pattern.entries() <= KEPT,
            matrix: Matrix::new(pattern),
            coarse,
            shift: 0.0,
            stiffest: 0.0,
            cholesky,
            elastic_factor: false,
            current: false,
            factorisations: 0,
            conjugate: 0,
            timings: Timings {
                ordering: clock.elapsed(),
                ..Timings::default()
            },
        })
    }

    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Entries stored of the factor.
    pub(crate) fn factor_entries(&self) -> usize {
        self.cholesky.entries()
    }

    /// Whether a displacement is unknown.
    pub(crate) fn is_free(&self, dof: usize) -> bool {
        self.position[dof] != FIXED
    }

    /// Index of a degree of freedom among the interface unknowns; `None` if it is prescribed.
    pub(crate) fn interface_index(&self, dof: usize) -> Option<usize> {
        let first = self.size() - self.interface;
        self.is_free(dof)
            .then(|| self.position[dof] as usize - first)
    }

    /// The degrees of freedom that are prescribed, ascending.
    pub(crate) fn held_dofs(&self) -> Vec<usize> {
        (0..self.position.len())
            .filter(|&dof| !self.is_free(dof))
            .collect()
    }

    /// σ \[N/mm\]: of the size of the elastic stiffness of an interface node.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// Internal forces under the displacement increments `d_u`, and the stiffness if asked for.
    /// `missing` are the prescribed increments still to come.
    pub(crate) fn assemble<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        d_u: &[f64],
        missing: &Sparse,
        stiffness: Stiffness,
    ) -> Assembly {
        let clock = Instant::now();
        let stiffness = match stiffness {
            Stiffness::Plastic(part) if !self.keeps_elastic => Stiffness::Total(part),
            other => other,
        };
        let mut internal = vec![0.0; d_u.len()];
        let mut flows = false;
        let with_stiffness = stiffness != Stiffness::None;
        if with_stiffness {
            self.matrix.reset();
            self.coarse.iter_mut().for_each(|c| c.matrix.reset());
        }
        let mut coupling = Vec::new();
        let missing = (!missing.is_zero()).then_some(missing);
        if let Some(missing) = missing {
            coupling.resize(d_u.len(), 0.0);
            for &(unknown, prescribed, k) in &self.couplings {
                coupling[unknown] += k * missing.at(prescribed);
            }
        }
        let (position, coarse) = (&self.position, &mut self.coarse);
        let (pattern, values) = self.matrix.values_mut();
        for (k, (block, scatter)) in blocks.iter_mut().zip(&self.scatter).enumerate() {
            flows |= block.evaluate(d_u, stiffness, &mut |cell| {
                for (&a, force) in cell.nodes.iter().zip(cell.force.chunks_exact(D)) {
                    let at = internal[D * a..D * a + D].iter_mut();
                    at.zip(force).for_each(|(sum, f)| *sum += f);
                }
                scatter.add::<D>(&cell, position, pattern, values);
                if let Some(coarse) = coarse {
                    coarse.add(k, &cell);
                }
                if let Some(missing) = missing {
                    couplings::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        coupling[unknown] += k * missing.at(prescribed);
                    });
                }
            });
        }
        if with_stiffness {
            self.current = self.elastic_factor && !flows;
        }
        self.timings.assembly += clock.elapsed();
        Assembly {
            internal,
            coupling,
            flows,
            stiffness: with_stiffness,
        }
    }

    /// Assembles the elastic stiffness, to which flow only adds, learns its size, and chooses σ: its
    /// largest diagonal on the interface, or zero if the bodies must be held without it.
    pub(crate) fn learn<const D: usize>(
        &mut self,
        blocks: &mut [Box<dyn Block<D>>],
        shifted: bool,
    ) {
        let clock = Instant::now();
        let rest = vec![0.0; self.position.len()];
        let keeps = self.keeps_elastic;
        let (position, all) = (&self.position, &mut self.couplings);
        let (coarse, (pattern, values)) = (&mut self.coarse, self.matrix.values_mut());
        for (k, (block, scatter)) in blocks.iter_mut().zip(&self.scatter).enumerate() {
            block.evaluate(&rest, Stiffness::Total(0.0), &mut |cell| {
                scatter.add::<D>(&cell, position, pattern, values);
                if keeps {
                    couplings::<D>(&cell, position, &mut |unknown, prescribed, k| {
                        all.push((unknown, prescribed, k));
                    });
                }
                if let Some(coarse) = coarse {
                    coarse.add(k, &cell);
                }
            });
        }
        if keeps {
            self.matrix.keep();
            self.coarse.iter_mut().for_each(|c| c.matrix.keep());
        }
        let first = self.size() - self.interface;
        let diagonal = |p: usize| self.matrix.diagonal(p);
        self.stiffest = (0..self.size()).map(diagonal).fold(0.0, f64::max);
        self.shift = if shifted {
            (first..self.size()).map(diagonal).fold(0.0, f64::max)
        } else {
            0.0
        };
        self.timings.assembly += clock.elapsed();
    }

    /// Whether the factor held is that of the elastic stiffness.
    pub(crate) fn holds_elastic_factor(&self) -> bool {
        self.elastic_factor
    }

    /// How many steps without a factorisation take about as long as one: operations of the one over
    /// what the others read of the factor.
    pub(crate) fn steps_per_factorisation(&self) -> f64 {
        self.cholesky.operations() / (OPERATIONS * self.cholesky.entries() as f64)
    }

    /// Largest diagonal of the elastic stiffness \[N/mm\].
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// Factorises the assembled K + σE, unless the factor held is already that of the elastic
    /// stiffness and the stiffness assembled is elastic too.
    ///
    /// # Errors
    /// The degree of freedom at which K + σE is not positive definite.
    pub(crate) fn factorise(&mut self, elastic: bool) -> Result<(), usize> {
        if elastic && self.elastic_factor {
            return Ok(());
        }
        let (matrix, dofs) = match &mut self.coarse {
            Some(coarse) => (&mut coarse.matrix, &coarse.dofs),
            None => (&mut self.matrix, &self.dofs),
        };
        matrix.shift(self.interface, self.shift);
        self.elastic_factor = false;
        self.factorisations += 1;
        timed(&mut self.timings.factorisation, || {
            self.cholesky.factorise(&matrix.pattern, matrix.values())
        })
        .map_err(|NotPositiveDefinite { row }| dofs[row])?;
        self.elastic_factor = elastic;
        self.current = true;
        Ok(())
    }

    /// Condenses the factorised system under a load given at every degree of freedom \[N\].
    pub(crate) fn condense(&mut self, load: &[f64]) -> Condensed {
        let applied: Vec<f64> = self.dofs.iter().map(|&dof| load[dof]).collect();
        let mut forward = self.restricted(&applied);
        timed(&mut self.timings.solution, || {
            self.cholesky.forward(&mut forward)
        });
        let clock = Instant::now();
        let first = forward.len() - self.interface;
        let mut stiffness = square(&self.cholesky.trailing(self.interface));
        for i in 0..self.interface {
            stiffness[(i, i)] -= self.shift;
        }
        let load = self.cholesky.trailing_times(&forward[first..]);
        self.timings.contact += clock.elapsed();
        Condensed {
            stiffness,
            load,
            applied,
            forward,
        }
    }

    /// Borders the condensed system with the load q of unknown factor λ and the equation
    /// q·u + c λ = m; λ is eliminated, which leaves the system as symmetric as it was:
    /// S + q̃ q̃ᵀ / (c + κ) with κ = q_i·K_ii⁻¹ q_i.
    pub(crate) fn border(
        &mut self,
        condensed: &mut Condensed,
        load: &Sparse,
        (compliance, missing): (f64, f64),
    ) -> Border {
        let applied: Vec<f64> = self.dofs.iter().map(|&dof| load.at(dof)).collect();
        let mut forward = self.restricted(&applied);
        timed(&mut self.timings.solution, || {
            self.cholesky.forward(&mut forward)
        });
        let first = forward.len() - self.interface;
        let interior = |a: &[f64], b: &[f64]| -> f64 {
            let pairs = a[..first].iter().zip(&b[..first]);
            pairs.map(|(a, b)| a * b).sum()
        };
        let border = Border {
            load: self.cholesky.trailing_times(&forward[first..]),
            compliance: compliance + interior(&forward, &forward),
            missing: missing - interior(&forward, &condensed.forward),
            applied,
            forward,
        };
        let scale = 1.0 / border.compliance;
        condensed
            .stiffness
            .ger(scale, &border.load, &border.load, 1.0);
        condensed
            .load
            .axpy(scale * border.missing, &border.load, 1.0);
        border
    }

    /// The factor of the load of a bordered system for the interface displacements x; the load
    /// takes its part in what [`System::expand`] makes of them.
    pub(crate) fn factor(
        &self,
        border: &Border,
        condensed: &mut Condensed,
        x: &DVector<f64>,
    ) -> f64 {
        let factor = (border.missing - border.load.dot(x)) / border.compliance;
        let interior = condensed.forward.len() - self.interface;
        let pairs = condensed.forward.iter_mut().zip(&border.forward);
        pairs.take(interior).for_each(|(f, w)| *f += factor * w);
        let pairs = condensed.applied.iter_mut().zip(&border.applied);
        pairs.for_each(|(f, q)| *f += factor * q);
        factor
    }

    /// Solves the factorised system, without a shift, for a load at every degree of freedom \[N\];
    /// prescribed displacements in `d_u` are left as they are.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn solve(&mut self, load: &[f64], d_u: &mut [f64]) -> Result<(), Inaccurate> {
        let applied: Vec<f64> = self.dofs.iter().map(|&dof| load[dof]).collect();
        let mut solution = self.restricted(&applied);
        let clock = Instant::now();
        self.cholesky.forward(&mut solution);
        self.cholesky.backward(&mut solution);
        let mut solution = self.prolonged(solution);
        let outcome = self.improve(&applied, &mut solution, Interface::Free);
        self.timings.solution += clock.elapsed();
        for (&dof, u) in self.dofs.iter().zip(solution) {
            d_u[dof] = u;
        }
        outcome
    }

    /// Displacement of all free degrees of freedom for the interface displacements x, written to
    /// `d_u` at every degree of freedom; prescribed ones are left as they are. `contact` are the
    /// contact forces \[N\], under which the interface may do what it does.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn expand(
        &mut self,
        condensed: Condensed,
        x: &DVector<f64>,
        (contact, interface): (&Sparse, Interface<'_>),
        d_u: &mut [f64],
    ) -> Result<(), Inaccurate> {
        let mut solution = condensed.forward;
        let first = solution.len() - self.interface;
        // (K + σE) u = f + t + σx has L⁻¹ of its right-hand side equal to L_ccᵀ x down here.
        let tail = self.cholesky.trailing_transposed_times(x.as_slice());
        solution[first..].copy_from_slice(tail.as_slice());
        let clock = Instant::now();
        self.cholesky.backward(&mut solution);
        let mut solution = self.prolonged(solution);
        let mut applied = condensed.applied;
        for (dof, f) in contact.iter().filter(|&(dof, _)| self.is_free(dof)) {
            applied[self.position[dof] as usize] += f;
        }
        let outcome = self.improve(&applied, &mut solution, interface);
        self.timings.solution += clock.elapsed();
        for (&dof, u) in self.dofs.iter().zip(solution) {
            d_u[dof] = u;
        }
        outcome
    }

    /// A load on the unknowns that are factorised.
    fn restricted(&self, load: &[f64]) -> Vec<f64> {
        let coarse = self.coarse.as_ref();
        coarse.map_or_else(|| load.to_vec(), |c| c.restrict(load))
    }

    /// Displacements of all unknowns by those that are factorised.
    fn prolonged(&self, solution: Vec<f64>) -> Vec<f64> {
        let Some(coarse) = &self.coarse else {
            return solution;
        };
        let mut all = vec![0.0; self.size()];
        coarse.prolong(&solution, &mut all);
        all
    }

    /// Whether the factor is one of K itself.
    pub(crate) fn is_direct(&self) -> bool {
        self.coarse.is_none()
    }

    /// Makes u solve K u = f but for what the factor lacks: rounding, or what the coarse space does
    /// not have.
    fn improve(
        &mut self,
        f: &[f64],
        u: &mut [f64],
        interface: Interface<'_>,
    ) -> Result<(), Inaccurate> {
        let Some(coarse) = &self.coarse else {
            let rows = match interface {
                Interface::Free => self.size(),
                // Down there x is given, and the forces are those of the contact problem.
                Interface::Held | Interface::Yields(_) => self.size() - self.interface,
            };
            return self.refine(f, u, rows);
        };
        let mut system = Conjugate {
            matrix: &self.matrix,
            coarse,
            cholesky: &mut self.cholesky,
            interface,
            size: self.interface,
        };
        self.conjugate += system.improve(f, u);
        Ok(())
    }

    /// Checks the first `rows` rows of K u = f, with the others of u given, and corrects u once
    /// where they do not hold: faults of memory and of kernels corrupt a factor silently. The first
    /// solve with a factor tells; later ones are of another matrix.
    fn refine(&mut self, f: &[f64], u: &mut [f64], rows: usize) -> Result<(), Inaccurate> {
        if !self.current {
            return Ok(());
        }
        let mut refined = false;
        loop {
            let mut residual = self.matrix.residual(u, f);
            residual[rows..].fill(0.0);
            let found = largest(residual.iter().copied());
            let motion = largest(u.iter().copied());
            let expected = ACCURATE * (largest(f.iter().copied()) + self.stiffest * motion);
            // A displacement that is not finite has no bound.
            if found.is_finite() && found <= expected {
                return Ok(());
            }
            if refined {
                self.elastic_factor = false;
                return Err(Inaccurate { found, expected });
            }
            self.cholesky.forward(&mut residual);
            residual[rows..].fill(0.0);
            self.cholesky.backward(&mut residual);
            for (u, correction) in u.iter_mut().zip(residual) {
                *u += correction;
            }
            refined = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Driver, Model, Settings, Step};
    use moreau_laws::{Elastic, VonMises};
    use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

    /// A block held at its left side and pulled at the other, factorised, with its load.
    fn pulled(memory: Option<u64>) -> (System, Vec<f64>) {
        let (x, y) = (uniform(0.0, 10.0, 6), uniform(0.0, 5.0, 3));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material(
                "block",
                Elastic::new(210e3, 0.3).expect("valid"),
                Integration::Reduced,
            )
            .expect("valid");
        let settings = Settings {
            memory,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let step = Step::new("pull")
            .fix("block.left", &[Axis::X, Axis::Y])
            .pressure("block.right", -100.0);
        let end = driver.loading(&step).expect("valid");
        let mut system = driver.prepare(&end, None).expect("held");
        system.factorise(true).expect("definite");
        let mut load = vec![0.0; 2 * driver.mesh.nodes().len()];
        end.force.add_to(&mut load, 1.0);
        (system, load)
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
        system.cholesky.corrupt(100, 1.0 + 1e-8);
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
            coarse.prolong(&unit, &mut v);
            DVector::from_vec(v)
        };
        let p = DMatrix::from_columns(&(0..m).map(column).collect::<Vec<_>>());
        let k = dense(&system.matrix);
        let difference = dense(&coarse.matrix) - p.transpose() * &k * &p;
        assert!(difference.amax() < 1e-12 * k.amax());
        let f = DVector::from_fn(fine, |i, _| (i as f64).sin());
        let restricted = DVector::from_vec(coarse.restrict(f.as_slice()));
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

    /// Whether the elastic stiffness is kept or assembled anew.
    #[test]
    fn the_stiffness_is_the_same_whatever_is_kept() {
        let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
        let (x, y) = (uniform(0.0, 10.0, 6), uniform(0.0, 5.0, 3));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("block", steel, Integration::Reduced)
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("pull")
            .fix("block.left", &[Axis::X, Axis::Y])
            .displace("block.right", Axis::X, 0.05);
        let end = driver.loading(&step).expect("valid");
        let mut system = driver.prepare(&end, None).expect("held");
        let nodes = driver.mesh.nodes().iter();
        let stretched = |x: &[f64; 2]| [1e-3 * x[0] * x[1], -1e-3 * x[1]];
        let d_u: Vec<f64> = nodes.flat_map(stretched).collect();
        let missing = end.displacement.iter().map(|(&dof, &u)| (dof, u)).collect();
        let mut assembled = |system: &mut System, part: f64| {
            let stiffness = Stiffness::Plastic(part);
            let assembly = system.assemble(&mut driver.blocks, &d_u, &missing, stiffness);
            assert!(assembly.flows);
            (system.matrix.values().to_vec(), assembly)
        };
        assert!(system.keeps_elastic);
        let kept = [1.0, 0.3].map(|part| assembled(&mut system, part));
        system.keeps_elastic = false;
        system.couplings.clear();
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
            close(&assembly.coupling, &other.coupling);
        }
    }

    #[test]
    fn a_corrupt_factor_is_told_and_not_used_again() {
        for by in [1.5, -1.0, f64::NAN, f64::INFINITY] {
            let (mut system, load) = pulled(None);
            system.cholesky.corrupt(0, by);
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
}
