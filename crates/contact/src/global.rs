//! The discrete frictional contact problem in its global form, reduced to the local one; no solver of
//! its own.

use crate::error::{expect_finite, expect_sizes};
use crate::problem::{BlockMatrix, Factor, LocalProblem, Residual, over};
use crate::{ContactError, LocalSolution, LocalSolver, Unsolved};
use moreau_laws::{Friction, Local};

/// An entry of a sparse matrix: row, column, value. Those at the same place are added.
type Entry = (usize, usize, f64);

/// The discrete frictional contact problem in global form: find v, r and u with
///
/// ```text
/// M v = H r + f,   u = Hᵀ v + w,   (−u, r) extremal for [38] at every contact.
/// ```
///
/// v are the displacements \[mm\] (or velocities) of the bodies, M their stiffness \[N/mm\] (or mass),
/// f their load. W = Hᵀ M⁻¹ H and q = Hᵀ M⁻¹ f + w give the local form.
#[derive(Debug)]
pub struct GlobalProblem<const D: usize> {
    stiffness: Vec<Entry>,
    directions: Vec<Entry>,
    load: Vec<f64>,
    free: Vec<Local<D>>,
    bodies: Vec<Body>,
    local: LocalProblem<D>,
}

/// A connected part of the unknowns: M couples none of them with any other.
struct Body {
    unknowns: Vec<usize>,
    factor: Factor,
}

impl std::fmt::Debug for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "body of {} unknowns", self.unknowns.len())
    }
}

/// Solution of a global problem.
#[derive(Debug, Clone, PartialEq)]
pub struct GlobalSolution<const D: usize> {
    /// Displacements or velocities v of the bodies.
    pub bodies: Vec<f64>,
    /// Forces and displacements at the contacts, u computed as Hᵀ v + w.
    pub local: LocalSolution<D>,
    /// |M v − H r − f| / max(|f|, |M v|, |H r|).
    pub balance: f64,
    /// |F_1| / max(|u|, |r|), and |F_ρ| / |r| with ρ = 1/|W_ii|₂.
    pub residual: Residual,
}

impl<const D: usize> GlobalProblem<D> {
    /// A problem from the entries of M and H, the loads f, the free displacements w and the laws.
    ///
    /// # Errors
    /// [`ContactError::Dimension`] for entries beyond the unknowns or contacts,
    /// [`ContactError::NotFinite`], [`ContactError::Indefinite`] if M is singular, and those of
    /// [`LocalProblem::new`].
    pub fn new(
        stiffness: Vec<Entry>,
        directions: Vec<Entry>,
        load: Vec<f64>,
        free: Vec<Local<D>>,
        laws: Vec<impl Into<Friction>>,
    ) -> Result<Self, ContactError> {
        let (n, contacts) = (load.len(), laws.len());
        for (what, entries, rows, columns) in [
            ("matrix M", &stiffness, n, n),
            ("matrix H", &directions, n, D * contacts),
        ] {
            let outside = |&&(i, j, _): &&Entry| i >= rows || j >= columns;
            if let Some(&(i, j, _)) = entries.iter().find(outside) {
                let beyond_rows = i >= rows;
                return Err(ContactError::Dimension {
                    what,
                    found: if beyond_rows { i } else { j } + 1,
                    expected: if beyond_rows { rows } else { columns },
                });
            }
            expect_finite(what, entries.iter().map(|(.., v)| v))?;
        }
        expect_finite("load", &load)?;
        expect_sizes([("free displacements", free.len(), contacts)])?;
        let mut bodies = bodies(n, &stiffness)?;
        let operator = delassus(contacts, &mut bodies, &directions)?;
        let at_rest = solve(&mut bodies, &load)?;
        let mut q = free.clone();
        for &(i, j, h) in &directions {
            q[j / D][j % D] += h * at_rest[i];
        }
        Ok(Self {
            local: LocalProblem::new(operator, q, laws)?,
            stiffness,
            directions,
            load,
            free,
            bodies,
        })
    }

    /// The local form.
    pub fn local(&self) -> &LocalProblem<D> {
        &self.local
    }

    /// Solves the local form with a method and expands the solution.
    ///
    /// # Errors
    /// [`Unsolved`] as the method says.
    pub fn solve(&mut self, solver: &dyn LocalSolver<D>) -> Result<GlobalSolution<D>, Unsolved<D>> {
        let local = solver.solve(&self.local, None)?;
        Ok(self.expand(local))
    }

    /// The solution of the bodies under contact forces, and how good it is.
    ///
    /// # Panics
    /// If there are not as many forces as contacts.
    pub fn expand(&mut self, mut local: LocalSolution<D>) -> GlobalSolution<D> {
        assert_eq!(local.force.len(), self.free.len(), "a force a contact");
        let mut forces = vec![0.0; self.load.len()];
        for &(i, j, h) in &self.directions {
            forces[i] += h * local.force[j / D][j % D];
        }
        let total: Vec<f64> = forces.iter().zip(&self.load).map(|(h, f)| h + f).collect();
        // The bodies were solved for before: they are regular.
        let v = solve(&mut self.bodies, &total).unwrap_or_else(|_| vec![f64::NAN; total.len()]);
        let mut internal = vec![0.0; v.len()];
        for &(i, j, m) in &self.stiffness {
            internal[i] += m * v[j];
        }
        let missing: Vec<f64> = internal.iter().zip(&total).map(|(m, t)| m - t).collect();
        let scale = norm(&self.load).max(norm(&internal)).max(norm(&forces));
        local.displacement.clone_from(&self.free);
        for &(i, j, h) in &self.directions {
            local.displacement[j / D][j % D] += h * v[i];
        }
        let norms = self.local.norms(&local.force, &local.displacement);
        GlobalSolution {
            balance: over(norm(&missing), scale),
            bodies: v,
            local,
            residual: Residual {
                scaled: over(norms.scaled, norms.forces),
                of_load: over(norms.scaled, norms.scaled_loads),
                unscaled: over(norms.unscaled, norms.forces.max(norms.displacements)),
            },
        }
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The connected parts of M, factorised.
fn bodies(n: usize, stiffness: &[Entry]) -> Result<Vec<Body>, ContactError> {
    // Every unknown points towards the first of its body.
    let mut parent: Vec<usize> = (0..n).collect();
    let root = |parent: &mut Vec<usize>, mut i: usize| {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    };
    for &(i, j, value) in stiffness {
        if value != 0.0 {
            let (a, b) = (root(&mut parent, i), root(&mut parent, j));
            let (first, other) = (a.min(b), a.max(b));
            parent[other] = first;
        }
    }
    let mut body_of = vec![usize::MAX; n];
    let mut unknowns: Vec<Vec<usize>> = Vec::new();
    let mut place = vec![0; n];
    for i in 0..n {
        let first = root(&mut parent, i);
        if first == i {
            body_of[i] = unknowns.len();
            unknowns.push(Vec::new());
        }
        body_of[i] = body_of[first];
        place[i] = unknowns[body_of[i]].len();
        unknowns[body_of[i]].push(i);
    }
    let mut entries: Vec<Vec<Entry>> = vec![Vec::new(); unknowns.len()];
    for &(i, j, value) in stiffness {
        if value != 0.0 {
            entries[body_of[i]].push((place[i], place[j], value));
        }
    }
    let factorise = |(unknowns, entries): (Vec<usize>, Vec<Entry>)| {
        let matrix = BlockMatrix::<1>::from_entries(unknowns.len(), entries);
        match Factor::new(&matrix) {
            Some(factor) => Ok(Body { unknowns, factor }),
            None => Err(indefinite(&unknowns)),
        }
    };
    unknowns.into_iter().zip(entries).map(factorise).collect()
}

fn indefinite(unknowns: &[usize]) -> ContactError {
    ContactError::Indefinite {
        what: "matrix M",
        component: unknowns.first().copied().unwrap_or(0),
    }
}

/// M⁻¹ b, body by body.
fn solve(bodies: &mut [Body], b: &[f64]) -> Result<Vec<f64>, ContactError> {
    let mut x = vec![0.0; b.len()];
    for body in bodies {
        let rhs: Vec<Local<1>> = body
            .unknowns
            .iter()
            .map(|&i| Local::<1>::new(b[i]))
            .collect();
        let own = body
            .factor
            .solve(&rhs)
            .ok_or_else(|| indefinite(&body.unknowns))?;
        for (&i, own) in body.unknowns.iter().zip(own) {
            x[i] = own[0];
        }
    }
    Ok(x)
}

/// Hᵀ M⁻¹ H: every body couples the contacts that it takes part in, and no others.
fn delassus<const D: usize>(
    contacts: usize,
    bodies: &mut [Body],
    directions: &[Entry],
) -> Result<BlockMatrix<D>, ContactError> {
    let n = bodies.iter().map(|body| body.unknowns.len()).sum();
    let mut place = vec![(0, 0); n];
    for (b, body) in bodies.iter().enumerate() {
        for (k, &i) in body.unknowns.iter().enumerate() {
            place[i] = (b, k);
        }
    }
    // Columns of H by body: (column, unknown within the body, value).
    let mut columns: Vec<Vec<Entry>> = vec![Vec::new(); bodies.len()];
    for &(i, j, value) in directions {
        if value != 0.0 {
            columns[place[i].0].push((j, place[i].1, value));
        }
    }
    let mut entries = Vec::new();
    for (body, columns) in bodies.iter_mut().zip(&mut columns) {
        columns.sort_by_key(|&(column, unknown, _)| (column, unknown));
        let mut rhs = vec![Local::<1>::zeros(); body.unknowns.len()];
        for column in columns.chunk_by(|a, b| a.0 == b.0) {
            rhs.fill(Local::zeros());
            for &(_, k, h) in column {
                rhs[k][0] += h;
            }
            let x = body
                .factor
                .solve(&rhs)
                .ok_or_else(|| indefinite(&body.unknowns))?;
            for &(i, k, h) in columns.iter() {
                entries.push((i, column[0].0, h * x[k][0]));
            }
        }
    }
    Ok(BlockMatrix::from_entries(contacts, entries))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GaussSeidel;
    use moreau_laws::Coulomb;

    /// Of bodies that are not the ones factorised: 2 v = 1 is solved where 3 v = 1 is asked for.
    #[test]
    fn bodies_that_are_not_in_balance_are_said_to_be() {
        let law = vec![Coulomb::new(0.3).expect("valid")];
        let open = vec![Local::<2>::new(1.0, 0.0)];
        let stiffness = vec![(0, 0, 2.0)];
        let mut global = GlobalProblem::new(
            stiffness,
            vec![(0, 0, 1.0), (0, 1, 1.0)],
            vec![1.0],
            open,
            law,
        )
        .expect("valid");
        let solution = global.solve(&GaussSeidel::default()).expect("open");
        assert_eq!((solution.bodies[0], solution.balance), (0.5, 0.0));
        global.stiffness[0].2 = 3.0;
        // 1.5 against 1, over the larger.
        let solution = global.expand(solution.local);
        assert!(
            (solution.balance - 1.0 / 3.0).abs() < 1e-15,
            "{}",
            solution.balance
        );
    }
}
