//! Any mesh: unknowns, entries of the factor, time of ordering and of one factorisation, of a body
//! that is held at its lowest nodes along x and pulled by its own weight.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::Elastic;
use moreau::mesh::{Integration, Mesh, PlaneStrain, Solid, read_gmsh};
use verification::paper;

/// Prints a line for every mesh, the fastest of so many runs.
pub(super) fn run(files: &[PathBuf], runs: usize) -> Result<bool, Box<dyn Error>> {
    println!(
        "{:<24} {:>9} {:>16} {:>12} {:>16}",
        "mesh", "unknowns", "entries of L", "ordering s", "factorisation s"
    );
    for file in files {
        let bytes = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
        // A plane mesh has no cells in space, and one in space is not plane.
        let figures = match read_gmsh::<2>(&bytes) {
            Ok(mesh) => fastest(&mesh, PlaneStrain::default(), &[Axis::X, Axis::Y], runs)?,
            Err(plane) => {
                let mesh = read_gmsh::<3>(&bytes)
                    .map_err(|space| format!("{}: {plane}; {space}", file.display()))?;
                fastest(&mesh, Solid, &[Axis::X, Axis::Y, Axis::Z], runs)?
            }
        };
        println!("{}", figures.line(file));
    }
    Ok(true)
}

/// Of one mesh; times in seconds.
struct Figures {
    unknowns: usize,
    entries: usize,
    ordering: f64,
    factorisation: f64,
}

impl Figures {
    fn line(&self, file: &Path) -> String {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        format!(
            "{name:<24} {:>9} {:>16} {:>12.3} {:>16.3}",
            self.unknowns, self.entries, self.ordering, self.factorisation
        )
    }
}

fn fastest<const D: usize, H: Analysis<D>>(
    mesh: &Mesh<D>,
    hypothesis: H,
    axes: &[Axis],
    runs: usize,
) -> Result<Figures, Box<dyn Error>> {
    let mut best = measure(mesh.clone(), hypothesis, axes)?;
    for _ in 1..runs {
        let new = measure(mesh.clone(), hypothesis, axes)?;
        best.ordering = best.ordering.min(new.ordering);
        best.factorisation = best.factorisation.min(new.factorisation);
    }
    Ok(best)
}

fn measure<const D: usize, H: Analysis<D>>(
    mut mesh: Mesh<D>,
    hypothesis: H,
    axes: &[Axis],
) -> Result<Figures, Box<dyn Error>> {
    let all = "every cell of the mesh";
    let held = "lowest nodes of the mesh along x";
    mesh.add_cell_group(all, (0..mesh.cell_count()).collect())?;
    let (low, high) = mesh
        .nodes()
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x[0]), h.max(x[0]))
        });
    let near = low + 1e-6 * (high - low);
    mesh.node_group_where(held, all, |x| x[0] <= near)?;
    let elastic = Elastic::new(paper::YOUNG, paper::POISSON)?;
    let model = Model::new(mesh, hypothesis).material(all, elastic, Integration::Full)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let weight = std::array::from_fn(|k| if k + 1 == D { -1e-3 } else { 0.0 });
    let step = Step::new("hang").fix(held, axes).body_force(all, weight);
    let reports = driver.run(&step, 1, |_, _| {})?;
    let count: usize = reports.iter().map(|r| r.factorisations).sum();
    let timings = driver.timings();
    Ok(Figures {
        unknowns: driver.unknowns(),
        entries: driver.factor_entries(),
        ordering: timings.ordering.as_secs_f64(),
        factorisation: timings.factorisation.as_secs_f64() / count.max(1) as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau::mesh::{CellKind, block2, uniform, write_gmsh};

    #[test]
    fn a_mesh_is_read_and_factorised() -> Result<(), Box<dyn Error>> {
        let line = uniform(0.0, 1.0, 4);
        let mesh = block2("block", CellKind::Quad4, &line, &line)?;
        let figures = fastest(&mesh, PlaneStrain::default(), &[Axis::X, Axis::Y], 2)?;
        // 25 nodes, of which five are held; a factor has at least its matrix's lower triangle.
        assert_eq!(figures.unknowns, 40);
        assert!(figures.entries > 40 && figures.entries < 40 * 40);
        let scratch = verification::scratch::Scratch::new().unwrap();
        let file = scratch.path().join("mesh.msh");
        fs::create_dir_all(scratch.path())?;
        fs::write(&file, write_gmsh(&mesh))?;
        assert!(run(std::slice::from_ref(&file), 1)?);
        fs::write(&file, "no mesh")?;
        assert!(run(&[file], 1).is_err());
        Ok(())
    }
}
