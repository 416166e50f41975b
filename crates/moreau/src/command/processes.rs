//! The processes that a command runs on: this one alone, or those that `mpirun` has started; what they do is the
//! library's affair.

use crate::algebra::SharedTeam;
#[cfg(not(feature = "distributed"))]
use crate::deck::Meshes;
#[cfg(not(feature = "distributed"))]
use std::path::Path;

/// What solves the linear systems.
#[cfg(feature = "distributed")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Solver {
    /// That of this program.
    Embedded,
    /// MUMPS, on all processes.
    Mumps,
}

#[cfg(feature = "distributed")]
mod several {
    use super::super::{INPUT_ERROR, tell};
    use super::{SharedTeam, Solver};
    use crate::algebra::{Parcel, Team, Unpacked};
    use crate::deck::{Meshes, sums};
    use moreau_mumps::{Options, Processes};
    use signal_hook::{consts, flag};
    use std::path::Path;
    use std::sync::Arc;

    /// What processes must read the same of, in the order of its checksums.
    const READ: [&str; 2] = ["deck", "mesh file, or surface of a tool,"];

    /// Whether `mpirun` has started this process as another than its first; MPI need not have begun.
    pub(in super::super) fn is_another() -> bool {
        let told = ["OMPI_COMM_WORLD_RANK", "PMI_RANK"].map(std::env::var);
        told.into_iter().flatten().any(|rank| rank != "0")
    }

    /// The processes of a command, until it is dropped.
    pub(in super::super) struct Started(Option<Processes>);

    impl Started {
        /// Those that `mpirun` has started, on which MUMPS solves unless there is but one and another engine is asked
        /// for; this one alone without `mpirun`.
        pub(in super::super) fn begin(solver: Option<Solver>) -> Result<Self, u8> {
            let told = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"].map(std::env::var);
            let told = told.into_iter().flatten().find_map(|n| n.parse().ok());
            let several = told.is_some_and(|n: usize| n > 1);
            let solver = solver.unwrap_or(match told {
                Some(_) => Solver::Mumps,
                None => Solver::Embedded,
            });
            match solver {
                Solver::Embedded if several => {
                    tell!(
                        "the embedded engine is one of a single process: run without mpirun, or with --engine mumps"
                    );
                    Err(INPUT_ERROR)
                }
                Solver::Embedded => Ok(Self(None)),
                Solver::Mumps => match Processes::begin(options()) {
                    Some(processes) => {
                        let started = Self(Some(processes));
                        if !started.is_first() {
                            // The first ends all.
                            for signal in [consts::SIGINT, consts::SIGTERM] {
                                let _ = flag::register(signal, Arc::default());
                            }
                        }
                        Ok(started)
                    }
                    None => {
                        tell!("MPI gives no leave to call it from threads in turn");
                        Err(INPUT_ERROR)
                    }
                },
            }
        }

        pub(in super::super) fn team(&self) -> Option<SharedTeam> {
            let processes = self.0.clone()?;
            Some(Arc::new(processes))
        }

        pub(in super::super) fn is_first(&self) -> bool {
            self.0.as_ref().is_none_or(|team| team.rank() == 0)
        }

        /// Number of processes.
        pub(in super::super) fn size(&self) -> usize {
            self.0.as_ref().map_or(1, |team| team.size())
        }

        /// Whether all processes read the same of a deck and its files; the first tells which one does not. They would mix
        /// two problems in silence, or not understand each other.
        pub(in super::super) fn agree(&self, deck: Option<(&str, &Path)>, meshes: &Meshes) -> bool {
            let Some(team) = self.0.as_ref().filter(|team| team.size() > 1) else {
                return true;
            };
            let own = deck.map(|(text, folder)| sums(text, folder, meshes));
            let own = own.unwrap_or_default();
            if team.rank() > 0 {
                let [text, files] = &own;
                team.send(0, Parcel::default().text(text).text(files).bytes());
                return true;
            }
            let mut agree = true;
            for from in 1..team.size() {
                let parcel = team.receive(from);
                let mut parcel = Unpacked::new(&parcel);
                let theirs = [parcel.text(), parcel.text()];
                // What the first cannot read it tells itself.
                let is_other = |&k: &usize| !own[k].is_empty() && own[k] != theirs[k];
                if let Some(k) = (0..READ.len()).find(is_other) {
                    agree = false;
                    match theirs[k].is_empty() {
                        true => tell!("process {from} does not find the {} of the first", READ[k]),
                        false => tell!("process {from} reads another {} than the first", READ[k]),
                    }
                }
            }
            agree
        }

        /// Ends all processes where this one cannot do what the first will ask.
        pub(in super::super) fn give_up(&self) -> u8 {
            if self.size() > 1 {
                Processes::abort(INPUT_ERROR);
            }
            INPUT_ERROR
        }

        /// Another process than the first that has no simulation: what has been told by the first is not told again,
        /// but where that has one, all end.
        pub(in super::super) fn stand_by(&self, what: &str) -> u8 {
            if let Some(team) = &self.0
                && !team.receive(0).is_empty()
            {
                tell!("process {}: {what} as the first process does", team.rank());
                Processes::abort(INPUT_ERROR);
            }
            INPUT_ERROR
        }
    }

    /// Settings of MUMPS that are for tests and measurements.
    fn options() -> Options {
        let real = |name: &str| std::env::var(name).ok()?.parse::<f64>().ok();
        Options {
            metis: std::env::var_os("MOREAU_METIS").is_some(),
            spare: real("MOREAU_SPARE").map(|x| x as i32),
            larger: real("MOREAU_LARGER").map(|x| x as usize),
            ..Options::default()
        }
    }

    impl Drop for Started {
        fn drop(&mut self) {
            let Some(team) = self.0.take() else { return };
            if std::thread::panicking() {
                Processes::abort(INPUT_ERROR);
            }
            if team.rank() == 0 {
                team.order(&[]);
            }
            team.end();
        }
    }
}

#[cfg(feature = "distributed")]
pub(super) use several::{Started, is_another};

/// Whether this process is another than the first of several.
#[cfg(not(feature = "distributed"))]
pub(super) fn is_another() -> bool {
    false
}

/// This process alone.
#[cfg(not(feature = "distributed"))]
pub(super) struct Started;

#[cfg(not(feature = "distributed"))]
impl Started {
    pub(super) fn team(&self) -> Option<SharedTeam> {
        None
    }

    pub(super) fn is_first(&self) -> bool {
        true
    }

    pub(super) fn size(&self) -> usize {
        1
    }

    pub(super) fn agree(&self, _: Option<(&str, &Path)>, _: &Meshes) -> bool {
        true
    }

    pub(super) fn give_up(&self) -> u8 {
        super::INPUT_ERROR
    }

    pub(super) fn stand_by(&self, _: &str) -> u8 {
        super::INPUT_ERROR
    }
}
