//! Files and processes: one writer at a time, nothing overwritten that is not the run's own, runs that
//! are ended or limited by the system, results that cannot be written.

use super::{BALL, directory, errors, examples, last, moreau, run, text};
use moreau::run::Directory;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

fn shown(path: &Path) -> &str {
    path.to_str().expect("a path")
}

fn start(arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_moreau"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts")
}

/// Runs of one deck started at once into one directory: one writes it, the other says who does.
fn two_writers(name: &str, times: usize) {
    let (status, _, err, alone) = run(name, BALL, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let deck = alone.with_file_name("deck.toml");
    let both = alone.with_file_name("both");
    for time in 0..times {
        // Nothing may be there yet.
        let _ = fs::remove_dir_all(&both);
        let arguments = ["run", shown(&deck), "--out", shown(&both), "--quiet"];
        let ended = [start(&arguments), start(&arguments)]
            .map(|child| child.wait_with_output().expect("it ends"));
        let mut told = ended.map(|e| (e.status.code(), errors(&e.stderr)));
        told.sort();
        assert_eq!(told[0], (Some(0), String::new()), "time {time}");
        let (status, err) = &told[1];
        let words = [shown(&both), "is being written by process ", "--out"];
        assert_eq!(*status, Some(1), "time {time}: {err}");
        assert!(words.iter().all(|w| err.contains(w)), "{err}");
        for file in ["history.csv", "contact.csv", "body_00002.vtu", "result.pvd"] {
            let read = |at: &Path| fs::read(at.join(file)).expect("a file");
            assert!(read(&alone) == read(&both), "time {time}: {file} differs");
        }
    }
}

/// Twenty times: `WRITERS=20 cargo test -p moreau --test command writers`
#[test]
fn of_two_writers_at_once_one_writes_and_the_other_is_refused() {
    let times = std::env::var("WRITERS").map_or(3, |n| n.parse().expect("a number"));
    two_writers("writers", times);
}

#[test]
fn a_directory_at_work_can_be_drawn_but_not_written() {
    let (status, _, err, results) = run("at-work", BALL, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let deck = results.with_file_name("deck.toml");
    let held = Directory::take(&results).expect("free");
    let command = |arguments: &[&str]| {
        let output = moreau(arguments);
        (output.status.code(), text(&output.stderr))
    };
    let own = format!("process {}", std::process::id());
    for arguments in [
        vec!["resume", shown(&results)],
        vec!["run", shown(&deck), "--out", shown(&results)],
        vec!["run", shown(&deck), "--out", shown(&results), "--force"],
    ] {
        let (status, err) = command(&arguments);
        assert!(status == Some(1) && err.contains(&own), "{status:?} {err}");
    }
    assert_eq!(command(&["plot", shown(&results)]).0, Some(0));
    drop(held);
    assert_eq!(command(&["resume", shown(&results), "--quiet"]).0, Some(0));
}

#[test]
fn only_results_of_the_deck_itself_are_overwritten() {
    let (status, _, err, results) = run("overwritten", BALL, &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let deck = results.with_file_name("deck.toml");
    let other = results.with_file_name("other.toml");
    fs::copy(&deck, &other).expect("a copy");
    let to = |deck: &Path, out: &Path, more: &[&str]| {
        let mut arguments = vec!["run", shown(deck), "--out", shown(out), "--quiet"];
        arguments.extend(more);
        let output = moreau(&arguments);
        (output.status.code(), errors(&output.stderr))
    };
    // Edited, and run again.
    fs::write(&deck, BALL.replace("friction = 0.3", "friction = 0.2")).expect("written");
    assert_eq!(to(&deck, &results, &[]), (Some(0), String::new()));
    let history = fs::read(results.join("history.csv")).expect("a history");
    let (status, err) = to(&other, &results, &[]);
    let words = ["deck.toml", "--out", "--force"];
    assert!(
        status == Some(1) && words.iter().all(|w| err.contains(w)),
        "{err}"
    );
    let after = fs::read(results.join("history.csv")).expect("a history");
    assert!(history == after, "changed");
    assert_eq!(to(&other, &results, &["--force"]).0, Some(0));
    assert_eq!(to(&deck, &results, &[]).0, Some(1), "it is the other's now");

    let foreign = results.with_file_name("foreign");
    fs::create_dir_all(&foreign).expect("a directory");
    fs::write(foreign.join("report.html"), "a year of work").expect("written");
    let (status, err) = to(&deck, &foreign, &[]);
    assert!(status == Some(1) && err.contains("report.html"), "{err}");
    let files = fs::read_dir(&foreign).expect("a directory").count();
    assert_eq!(files, 1, "something is left behind");
}

#[test]
fn convert_overwrites_nothing_unasked() {
    let at = directory("convert-over");
    let mesh = at.join("mesh.msh");
    fs::copy(examples().join("punch-on-gmsh-mesh.msh"), &mesh).expect("a copy");
    let before = fs::read(&mesh).expect("a mesh");
    let convert = |more: &[&str]| {
        let mut arguments = vec!["convert", shown(&mesh), shown(&mesh)];
        arguments.extend(more);
        let output = moreau(&arguments);
        (output.status.code(), text(&output.stderr))
    };
    let (status, err) = convert(&[]);
    assert!(status == Some(1) && err.contains("--force"), "{err}");
    assert!(before == fs::read(&mesh).expect("a mesh"), "changed");
    assert_eq!(convert(&["--force"]).0, Some(0));
}

/// Names that a deck cannot give but a mesh file can.
#[test]
fn names_with_commas_are_quoted_and_read_back() {
    let at = directory("commas");
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"block\"\n\
                1 2 \"floor, rough\"\n1 3 \"top, [mm] high\"\n$EndPhysicalNames\n\
                $Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n\
                $Elements\n6\n1 3 2 1 1 1 2 5 4\n2 3 2 1 1 2 3 6 5\n3 1 2 2 2 1 2\n\
                4 1 2 2 2 2 3\n5 1 2 3 3 4 5\n6 1 2 3 3 5 6\n$EndElements\n";
    fs::write(at.join("mesh.msh"), mesh).expect("written");
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = "mesh.msh"
material = [{ on = "block", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "plate", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "floor, rough", against = "plate", friction = 0.3 }]
step = [{ name = "press", increments = 1, move = [{ on = "top, [mm] high", u = { x = 0, y = -0.01 } }] }]
"#;
    let file = at.join("deck.toml");
    fs::write(&file, deck).expect("written");
    let out = at.join("results");
    let output = moreau(&["run", shown(&file), "--out", shown(&out), "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let read = |name: &str| fs::read_to_string(out.join(name)).expect("a file");
    assert!(read("history.csv").contains(",\"force.top, [mm] high.y [N]\","));
    assert!(read("contact.csv").contains("\n1,1,\"floor, rough\",plate,0,"));
    // Drawn from the files: the force over time, and the pressure along the surface.
    assert!(read("history.svg").contains("top, [mm] high.y"));
    assert!(
        read("contact.svg").contains("floor, rough") || read("contact.svg").contains("pressure")
    );
    assert!(read("report.html").contains("floor, rough"));
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::time::{Duration, Instant};

    fn signal(child: &Child, name: &str) {
        let number = child.id().to_string();
        let _ = Command::new("kill").args([name, &number]).status();
    }

    /// A factorisation of seconds in the first increment.
    fn solid() -> String {
        BALL.replace("\"hex8\"", "\"hex20\"")
            .replace("[4, 4, 4]", "[8, 8, 8]")
            .replace("increments = 2", "increments = 1")
    }

    /// The increment under way would take seconds: it is given up, and made up for by `resume`.
    #[test]
    fn a_run_is_ended_within_a_long_increment_and_goes_on_to_the_bit() {
        let (status, _, err, whole) = run("undisturbed", &solid(), &["--quiet"]);
        assert_eq!(status, 0, "{err}");
        let deck = whole.with_file_name("deck.toml");
        let out = whole.with_file_name("ended");
        let child = start(&["run", shown(&deck), "--quiet", "--out", shown(&out)]);
        let first = out.join("checkpoint").join("increment-000000.ckpt");
        while !first.exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(100));
        // As `timeout` sends it, to the process and to its group.
        signal(&child, "-TERM");
        signal(&child, "-TERM");
        let clock = Instant::now();
        let ended = child.wait_with_output().expect("it ends");
        let (taken, err) = (clock.elapsed(), text(&ended.stderr));
        assert_eq!(ended.status.code(), Some(2), "{err}");
        assert!(
            err.contains("after increment 0") && err.contains("moreau resume"),
            "{err}"
        );
        // A second, and as much as a busy machine may take.
        assert!(taken < Duration::from_secs(3), "{taken:?}");
        let json = fs::read_to_string(out.join("run.json")).expect("a summary");
        let json: serde_json::Value = serde_json::from_str(&json).expect("json");
        assert_eq!(json["status"], "interrupted");
        assert_eq!(json["increments"], 0);
        let output = moreau(&["resume", shown(&out), "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        for file in ["history.csv", "contact.csv", "body_00001.vtu", "result.pvd"] {
            let read = |at: &Path| fs::read(at.join(file)).expect("a file");
            assert!(read(&whole) == read(&out), "{file} differs");
        }
    }

    /// Runs a deck in a shell after a command that limits it.
    fn limited(limit: &str, deck: &Path, out: &Path) -> (Option<i32>, String) {
        let command = "exec \"$0\" run \"$1\" --out \"$2\" --quiet";
        let output = Command::new("sh")
            .args(["-c", &format!("{limit} && {command}")])
            .args([env!("CARGO_BIN_EXE_moreau"), shown(deck), shown(out)])
            .output()
            .expect("a shell");
        (output.status.code(), text(&output.stderr))
    }

    /// Whatever the address space is limited to, it is enough or that is said.
    #[test]
    fn a_run_in_a_limited_address_space_ends_or_says_what_it_needs() {
        let at = directory("limited");
        let deck = at.join("deck.toml");
        fs::write(&deck, BALL).expect("written");
        for megabytes in [100, 150, 200, 250, 300, 400, 600, 2000, 8000] {
            let limit = format!("ulimit -v {}", megabytes << 10);
            let (status, err) = limited(&limit, &deck, &at.join("results"));
            let told = err.contains("ulimit -v") && err.contains("needs");
            let well = status == Some(0) || status == Some(1) && told;
            assert!(well, "{megabytes} MB: {status:?} {err}");
            assert!(status == Some(0) || megabytes < 8000, "{err}");
        }
    }

    /// A disk without room, here a limit of the size of a file: a message, and what converged is kept.
    #[test]
    fn results_that_cannot_be_written_are_told_and_the_run_goes_on_elsewhere() {
        let at = directory("no-room");
        let deck = at.join("deck.toml");
        let many = BALL.replace("increments = 2", "increments = 12");
        // One layer: rows of contacts soon take more than a checkpoint.
        let many =
            many.replace("[4, 4, 4]", "[4, 1, 4]") + "[output]\nvtu = \"none\"\ncheckpoint = 1\n";
        fs::write(&deck, many).expect("written");
        let whole = at.join("whole");
        let run = |out: &Path| moreau(&["run", shown(&deck), "--out", shown(out), "--quiet"]);
        assert_eq!(run(&whole).status.code(), Some(0));
        let out = at.join("cut");
        for blocks in [0, 1, 40] {
            let (status, err) = limited(&format!("ulimit -f {blocks}"), &deck, &out);
            let told = err.contains("cannot write") && err.contains(shown(&out));
            assert!(matches!(status, Some(1 | 2)) && told, "{status:?} {err}");
            assert!(!err.contains("panicked"), "{err}");
        }
        let kept = fs::read_dir(out.join("checkpoint")).expect("a directory");
        let kept = kept.map(|e| e.expect("an entry").file_name());
        assert!(kept.max().is_some_and(|k| k > *"increment-000003.ckpt"));
        let resumed = moreau(&["resume", shown(&out), "--quiet"]);
        assert_eq!(resumed.status.code(), Some(0), "{}", text(&resumed.stderr));
        assert_eq!(last(&whole, "force.ball.y"), last(&out, "force.ball.y"));
        let full = Path::new("/dev/full");
        if full.exists() {
            let history = out.join("history.csv");
            fs::remove_file(&history).expect("was there");
            std::os::unix::fs::symlink(full, &history).expect("a link");
            let output = run(&out);
            let err = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{err}");
            assert!(err.contains("history.csv"), "{err}");
            let json = fs::read_to_string(out.join("run.json")).expect("a summary");
            assert!(json.contains("not written"), "{json}");
        }
        // A folder of the system in which nothing can be made.
        let output = run(Path::new("/proc/no-such"));
        let err = text(&output.stderr);
        assert!(
            output.status.code() == Some(1) && err.contains("/proc/no-such"),
            "{err}"
        );
    }
}
