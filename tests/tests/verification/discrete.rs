//! Discrete frictional contact problems from other programs: the default setting of the contact suite
//! solves them all, by the measures that their collection defines.

use moreau::contact::{Auto, Certificate, LocalProblem, LocalSolution, Residual};
use std::path::Path;
use verification::problems::Fallible;
use verification::siconos::{Form, Global, Problem, read};

/// The files committed here, and the whole open collection where it lies beside the workspace.
const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/siconos");
const COLLECTION: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../shared/data/frictional-contact/open"
);

fn local<const D: usize>(problem: &LocalProblem<D>) -> Fallible<LocalSolution<D>> {
    use moreau::contact::LocalSolver;
    let solution = Auto::default().solve(problem, None)?;
    let (u, r) = (&solution.displacement, &solution.force);
    let certificate = Certificate::new(problem.laws(), u, r);
    let norm =
        |v: &[moreau::laws::Local<D>]| v.iter().map(|v| v.norm_squared()).sum::<f64>().sqrt();
    // Between the work of the forces and the bipotential, of the products of which they are made.
    let scale = norm(r) * norm(u).max(norm(problem.free()));
    let gap = certificate.bipotential_gap.abs();
    if gap > 1e-8 * scale {
        return Err(format!("bipotential gap {gap:e} of {scale:e}").into());
    }
    Ok(solution)
}

fn global<const D: usize>(parts: Global<D>) -> Fallible<Residual> {
    let mut problem = parts.problem()?;
    let solution = local(problem.local())?;
    let expanded = problem.expand(solution);
    Ok(Residual {
        unscaled: expanded.residual.unscaled + expanded.balance,
        ..expanded.residual
    })
}

/// Solves the problems of a folder; how many.
fn solve_all(folder: &Path) -> Fallible<usize> {
    let mut solved = 0;
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if !name.ends_with(".dat") {
            continue;
        }
        let problem = read(&std::fs::read_to_string(&path)?, Form::of_name(&name))?;
        let residual = match problem {
            Problem::Local2(problem) => local(&problem).map(|s| s.residual),
            Problem::Local3(problem) => local(&problem).map(|s| s.residual),
            Problem::Global2(problem) => global(problem),
            Problem::Global3(problem) => global(problem),
        };
        let residual = residual.map_err(|error| format!("{name}: {error}"))?;
        if !(residual.unscaled <= 1e-8 && residual.scaled <= 1e-6) {
            return Err(format!("{name}: {residual:?}").into());
        }
        solved += 1;
    }
    Ok(solved)
}

#[test]
fn the_committed_problems_are_solved() -> Fallible {
    assert_eq!(solve_all(Path::new(COMMITTED))?, 6);
    Ok(())
}

#[test]
#[expect(clippy::print_stderr, reason = "says that it was skipped")]
fn the_open_collection_is_solved() -> Fallible {
    let folder = Path::new(COLLECTION);
    if !folder.exists() {
        eprintln!("skipped: no collection of problems beside the workspace");
        return Ok(());
    }
    assert_eq!(solve_all(folder)?, 46);
    Ok(())
}
