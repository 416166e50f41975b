//! What every engine promises, of MUMPS on one process and on several, which this program starts itself: where
//! there is no `mpirun` it says so and tests one.

#[path = "../../algebra/tests/algebra/common/mod.rs"]
mod common;

use common::promises::*;
use common::{Sample, definite, indefinite, laplacian, saddle};
use moreau_algebra::{Engine, EngineError, Inertia, Share, Team};
use moreau_mumps::{Definite, Indefinite, Options, Processes, serve};
use nalgebra::DMatrix;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::io::Write;
use std::process::{Command, ExitCode};

/// That this is one of several already.
const STARTED: &str = "MOREAU_TEST_PROCESSES";
/// That the second of them loses its entries before they are factorised.
const LOSES: &str = "MOREAU_TEST_LOSES";

fn main() -> ExitCode {
    let several = std::env::var_os(STARTED).is_some();
    let team = Processes::begin(Options::default()).expect("MPI");
    if std::env::var_os(LOSES).is_some() {
        return lose_entries(&team);
    }
    if team.rank() > 0 {
        serve(&team);
        team.end();
        return ExitCode::SUCCESS;
    }
    keep_promises();
    team.order(&[]);
    team.end();
    if several {
        return ExitCode::SUCCESS;
    }
    for processes in ["2", "3"] {
        match on("mpirun", processes).env(STARTED, processes).status() {
            Ok(status) if status.success() => {}
            Ok(status) => panic!("{processes} processes: {status}"),
            Err(error) => tell(&format!(
                "skipped on {processes} processes: mpirun: {error}"
            )),
        }
    }
    ends_all_where_entries_are_lost();
    ExitCode::SUCCESS
}

/// This program on several processes.
fn on(launcher: &str, processes: &str) -> Command {
    let mut command = Command::new(launcher);
    if launcher == "timeout" {
        command.args(["60", "mpirun"]);
    }
    command
        .args(["--oversubscribe", "-n", processes])
        .arg(std::env::current_exe().expect("this program"))
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        // Those of the process that starts it are not its own.
        .env_clear_of_mpi();
    command
}

/// The first process is within MUMPS by then, and would wait there.
fn ends_all_where_entries_are_lost() {
    let Ok(told) = on("timeout", "2").env(LOSES, "1").output() else {
        return;
    };
    let text = String::from_utf8_lossy(&told.stderr);
    if told.status.code() == Some(127) {
        return tell("skipped: entries that are lost, as there is no mpirun");
    }
    assert_eq!(told.status.code(), Some(1), "{text}");
    assert!(
        text.contains("process 1: asked for a factorisation"),
        "{text}"
    );
}

fn lose_entries(team: &Processes) -> ExitCode {
    let (pattern, values) = laplacian(3, 1.0);
    if team.rank() > 0 {
        let rows: Vec<u32> = (0..pattern.size() as u32).collect();
        let share = Share {
            pattern: Some(&pattern),
            values: &values,
            rows: &rows,
        };
        team.assist(&team.receive(0), share);
        team.assist(&team.receive(0), Share::NONE);
        serve(team);
    } else {
        let mut engine = Indefinite::analyse(&pattern, None).expect("small");
        let _ = engine.factorise(&values);
    }
    ExitCode::SUCCESS
}

trait ClearOfMpi {
    fn env_clear_of_mpi(&mut self) -> &mut Self;
}

impl ClearOfMpi for Command {
    fn env_clear_of_mpi(&mut self) -> &mut Self {
        let marks = ["OMPI_", "PMIX_", "PMI_", "ORTE_"];
        for (name, _) in std::env::vars_os() {
            let text = name.to_string_lossy();
            let allowed = text.starts_with("OMPI_ALLOW") || text.starts_with("OMPI_MCA");
            if !allowed && marks.iter().any(|m| text.starts_with(m)) {
                self.env_remove(&name);
            }
        }
        self
    }
}

fn tell(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Runs a promise over samples.
fn over<S: Strategy>(samples: &S, promise: impl Fn(S::Value)) {
    let mut runner = TestRunner::new(Config {
        failure_persistence: None,
        ..Config::with_cases(48)
    });
    let outcome = runner.run(samples, |sample| {
        promise(sample);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

fn keep_promises() {
    over(&definite(1..40), |sample| {
        solves::<Definite>(&sample, 1e-14);
        solves::<Indefinite>(&sample, 1e-14);
    });
    over(&(definite(1..40), 0..40usize), |(sample, kept)| {
        let kept = kept.min(sample.size());
        let sample = sample.keeping(kept);
        condenses::<Definite>(&sample);
        condenses::<Indefinite>(&sample);
    });
    over(&indefinite(1..40), |sample| {
        if is_regular(&sample) {
            let mut engine = engine::<Indefinite>(&sample);
            assert_eq!(engine.factorise(&sample.values), Ok(inertia_of(&sample)));
            solves::<Indefinite>(&sample, 1e-12);
        }
    });
    over(&saddle(2..30), |(sample, rows)| {
        let expected = Inertia {
            positive: sample.size() - rows,
            negative: rows,
            zero: 0,
        };
        let mut engine = engine::<Indefinite>(&sample);
        assert_eq!(engine.factorise(&sample.values), Ok(expected));
        solves::<Indefinite>(&sample, 1e-12);
    });
    over(&(indefinite(2..30), 1..10usize), |(sample, kept)| {
        let kept = kept.min(sample.size() - 1);
        let m = sample.size() - kept;
        let inner = Sample::new(sample.dense.view((0, 0), (m, m)).into_owned());
        if inner.eigenvalues().iter().all(|v| v.abs() > 1e-3) && inner.dense.amax() > 0.1 {
            condenses::<Indefinite>(&sample.keeping(kept));
        }
    });
    tell("samples");
    refuses_other_sizes::<Definite>();
    refuses_other_sizes::<Indefinite>();
    solves_the_extremes::<Definite>();
    solves_the_extremes::<Indefinite>();
    factorises_again::<Definite>();
    factorises_again::<Indefinite>();
    solves_with_large_fronts::<Definite>();
    solves_with_large_fronts::<Indefinite>();
    tell("large");
    tells_what_is_singular();
    refuses_what_has_no_room();
}

/// The Laplacian leaves one motion free.
fn tells_what_is_singular() {
    for n in [3, 6, 10] {
        let (pattern, values) = laplacian(n, 0.0);
        let mut engine = Indefinite::analyse(&pattern, None).expect("small");
        let found = engine.factorise(&values);
        let Err(EngineError::Singular { inertia, .. }) = found else {
            panic!("{n}: {found:?}, least pivot {:e}", engine.least_pivot());
        };
        let size = n * n * n;
        let expected = Inertia {
            positive: size - 1,
            negative: 0,
            zero: 1,
        };
        assert_eq!(inertia, expected);
        assert_eq!(
            engine.solve(&mut vec![1.0; size]),
            Err(EngineError::NotFactorised)
        );
        let (_, values) = laplacian(n, 1e-9);
        engine.factorise(&values).expect("regular");
        let least = engine.least_pivot();
        assert!(least > 1e-13 && least < 1e-5, "{least:e}");
        let (_, values) = laplacian(n, -0.01);
        let mut engine = Definite::analyse(&pattern, None).expect("small");
        let found = engine.factorise(&values);
        assert!(
            matches!(found, Err(EngineError::NotPositiveDefinite { .. })),
            "{found:?}"
        );
    }
    let none = Sample::new(DMatrix::zeros(0, 0));
    assert_eq!(factorised::<Definite>(&none).least_pivot(), f64::INFINITY);
}

fn refuses_what_has_no_room() {
    let (pattern, _) = laplacian(12, 1.0);
    let no = Definite::analyse(&pattern, Some(1000)).expect_err("too large");
    assert!(no.entries > no.room && no.room == 125.0);
    assert!(Definite::analyse(&pattern, Some(1 << 40)).is_ok());
}
