//! The solvers of Siconos, where its library is installed, on the same problems in the same run; how
//! good their forces are is not for them to say.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;
use verification::siconos::Form;

use super::clock::REPEAT;
use verification::workspace;

/// What a solver of Siconos came to.
#[derive(Debug, Deserialize)]
pub struct Answer {
    /// Its name in Siconos.
    pub solver: String,
    /// Iterations, of the outer loop where there are two.
    pub iterations: usize,
    /// Processor seconds.
    pub seconds: f64,
    /// The forces, contact by contact.
    pub force: Vec<f64>,
}

/// The program that runs them.
pub struct Siconos {
    program: PathBuf,
}

/// Where the package of Debian and Ubuntu has the headers that include each other by short names.
const HEADERS: [&str; 2] = ["/usr/include/siconos", "/usr/include/siconos/numerics"];

impl Siconos {
    /// Compiles the program into a folder.
    pub fn new(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let source = workspace::root().join("xtask/peers/siconos.c");
        let program = folder.join("siconos");
        let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
        let out = Command::new(&compiler)
            .args(["-O2", "-w"])
            .args(HEADERS.map(|folder| format!("-I{folder}")))
            .arg(&source)
            .args(["-lsiconos_numerics", "-lm", "-o"])
            .arg(&program)
            .output()
            .map_err(|error| format!("{compiler}: {error}"))?;
        if !out.status.success() {
            let said = String::from_utf8_lossy(&out.stderr);
            let said = said
                .lines()
                .find(|line| line.contains("error"))
                .unwrap_or(&said);
            return Err(format!("no Siconos (package libsiconos-numerics-dev): {said}").into());
        }
        Ok(Self { program })
    }

    /// The answers of the solvers that end within `limit` processor seconds.
    pub fn solve(
        &self,
        file: &Path,
        form: Form,
        limit: f64,
    ) -> Result<Vec<Answer>, Box<dyn Error>> {
        let form = match form {
            Form::Local => "local",
            Form::Global => "global",
        };
        let out = Command::new(&self.program)
            .arg(form)
            .arg(file)
            .args([limit, REPEAT].map(|seconds| seconds.to_string()))
            // One thread, as ours.
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .output()?;
        if !out.status.success() {
            return Err(String::from_utf8_lossy(&out.stderr).trim().into());
        }
        let text = String::from_utf8(out.stdout)?;
        let answers: Result<_, _> = text.lines().map(serde_json::from_str).collect();
        Ok(answers?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::scratch::Scratch;

    /// Where Siconos is not installed the error says what to install.
    #[test]
    fn a_single_contact_is_solved_or_the_package_named() {
        let scratch = Scratch::new().unwrap();
        let siconos = match Siconos::new(scratch.path()) {
            Ok(siconos) => siconos,
            Err(error) => {
                let said = error.to_string();
                assert!(
                    said.contains("libsiconos") || said.starts_with("cc"),
                    "{said}"
                );
                return;
            }
        };
        // u = r + q, pressed by 1 and dragged by 0.1: it sticks.
        let text = "3\n1\n0\n3\n3\n3 3\n1 0 0\n0 1 0\n0 0 1\n-1 0.1 0\n0.3\n";
        scratch.write("one.dat", text).unwrap();
        let file = scratch.path().join("one.dat");
        let answers = siconos.solve(&file, Form::Local, 2.0).unwrap();
        let sweeps = answers
            .iter()
            .find(|answer| answer.solver == "NSGS")
            .unwrap();
        for (force, expected) in sweeps.force.iter().zip([1.0, -0.1, 0.0]) {
            assert!((force - expected).abs() < 1e-8, "{force}");
        }
    }
}
