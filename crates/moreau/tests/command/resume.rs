//! Runs that were interrupted and go on from a checkpoint, to the bit.

use super::{directory, errors, examples, moreau, punched, run, text};
use std::fs;
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::Command;

/// Two steps, the second without the punch: plastic flow, friction, release.
fn pressed_and_released(increments: usize) -> String {
    let deck = punched().replace("increments = 20", &format!("increments = {increments}"));
    let head = deck.split("[expect]").next().expect("a deck").to_owned();
    head + "[[step]]\nname = \"release\"\nincrements = 4\n\
            fix = [{ on = \"block.left\", u = [\"x\"] }]\n[output]\ncheckpoint = 3\n"
}

fn copy(from: &Path, to: &Path) {
    // Nothing may be there yet.
    let _ = fs::remove_dir_all(to);
    fs::create_dir_all(to.join("checkpoint")).expect("a directory");
    for directory in [PathBuf::new(), "checkpoint".into()] {
        for entry in fs::read_dir(from.join(&directory)).expect("a directory") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                let name = path.file_name().expect("a name");
                fs::copy(&path, to.join(&directory).join(name)).expect("a copy");
            }
        }
    }
}

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).expect("a directory");
    let name = |e: fs::DirEntry| e.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries.map(|e| name(e.expect("an entry"))).collect();
    names.sort();
    names
}

/// All files of two directories are equal to the byte, but for times.
fn equal_but_for_times(a: &Path, b: &Path) {
    assert_eq!(names(a), names(b));
    for name in names(a) {
        let read = |d: &Path| fs::read(d.join(&name)).unwrap_or_default();
        let timeless = |text: &str| {
            let mut v: serde_json::Value = serde_json::from_str(text).expect("json");
            for key in ["seconds", "finished", "peak_memory_mb", "threads"] {
                v[key] = 0.into();
            }
            v
        };
        match name.as_str() {
            "checkpoint" | "report.html" | "run.lock" => {}
            "log.jsonl" => {
                let lines = |d: &Path| text(&read(d)).lines().map(timeless).collect::<Vec<_>>();
                assert_eq!(lines(a), lines(b));
            }
            "run.json" => assert_eq!(timeless(&text(&read(a))), timeless(&text(&read(b)))),
            _ => assert!(read(a) == read(b), "{name} differs"),
        }
    }
}

fn resume(at: &Path, more: &[&str]) -> (i32, String) {
    let mut arguments = vec!["resume", at.to_str().expect("a path"), "--quiet"];
    arguments.extend(more);
    let output = moreau(&arguments);
    (
        output.status.code().expect("a status"),
        errors(&output.stderr),
    )
}

/// From the last checkpoint, or from the one before a torn one, a run ends to the bit as if it had
/// never stopped.
#[test]
fn a_resumed_run_is_the_uninterrupted_one() {
    let (status, _, err, whole) = run("whole", &pressed_and_released(10), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let kept = names(&whole.join("checkpoint"));
    assert_eq!(kept, ["increment-000009.ckpt", "increment-000012.ckpt"]);

    // What a crash leaves: rows and files beyond the checkpoint, the last of them cut off.
    let crashed = whole.with_file_name("crashed");
    copy(&whole, &crashed);
    fs::remove_file(crashed.join("run.json")).expect("was there");
    let history = fs::read(crashed.join("history.csv")).expect("a history");
    fs::write(crashed.join("history.csv"), &history[..history.len() - 17]).expect("shorter");
    assert_eq!(resume(&crashed, &[]), (0, String::new()));
    equal_but_for_times(&whole, &crashed);

    // The newest checkpoint torn, or altered: the one before it, in the step before.
    for length in [1000, usize::MAX] {
        copy(&whole, &crashed);
        let newest = crashed.join("checkpoint").join(&kept[1]);
        let mut bytes = fs::read(&newest).expect("a checkpoint");
        bytes.truncate(length);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&newest, bytes).expect("written");
        assert_eq!(resume(&crashed, &["--threads", "1"]), (0, String::new()));
        equal_but_for_times(&whole, &crashed);
    }

    // None whole, or of another deck: told.
    for name in &kept {
        let path = crashed.join("checkpoint").join(name);
        fs::write(path, b"moreau checkpoint 9\n").expect("written");
    }
    let (status, err) = resume(&crashed, &[]);
    assert!(status == 1 && err.contains("torn"), "{status} {err}");
    copy(&whole, &crashed);
    let deck = fs::read_to_string(crashed.join("deck.resolved.toml")).expect("a deck");
    let other = deck.replace("poisson = 0.3", "poisson = 0.29");
    fs::write(crashed.join("deck.resolved.toml"), other).expect("written");
    let (status, err) = resume(&crashed, &[]);
    assert!(
        status == 1 && err.contains("another deck"),
        "{status} {err}"
    );
    assert_eq!(resume(&directory("empty"), &[]).0, 1);
}

/// Rows that were changed since are noticed: a run does not go on from results that are not its own.
#[test]
fn a_resumed_run_goes_on_from_results_as_they_were_written() {
    let (status, _, err, whole) = run("changed", &pressed_and_released(4), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let other = whole.with_file_name("other");
    for file in ["history.csv", "contact.csv", "log.jsonl", "result.pvd"] {
        copy(&whole, &other);
        let path = other.join(file);
        let mut bytes = fs::read(&path).expect("a file");
        bytes[150] ^= 1;
        fs::write(&path, &bytes).expect("written");
        let (status, err) = resume(&other, &[]);
        let words = [file, "not those that were written", "run the deck again"];
        assert!(
            status == 1 && words.iter().all(|w| err.contains(w)),
            "{status} {err}"
        );
        let after = fs::read(&path).expect("a file");
        assert!(bytes == after, "{file} was cut all the same");
    }
}

/// Killed at some moment, or asked to stop: it goes on from the last checkpoint.
#[cfg(unix)]
#[test]
fn a_run_that_is_killed_or_interrupted_goes_on() {
    let (status, _, err, whole) = run("long", &pressed_and_released(30), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let file = whole.with_file_name("deck.toml");
    for signal in ["-KILL", "-INT"] {
        let out = whole.with_file_name(&signal[1..]);
        let mut child = Command::new(env!("CARGO_BIN_EXE_moreau"))
            .args(["run", file.to_str().expect("a path"), "--quiet", "--out"])
            .arg(&out)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("it starts");
        let rows = || {
            let history = fs::read_to_string(out.join("history.csv"));
            history.map_or(0, |h| h.lines().count())
        };
        while rows() < 10 && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let number = child.id().to_string();
        let _ = Command::new("kill")
            .args([signal, number.as_str()])
            .status();
        let ended = child.wait_with_output().expect("it ends");
        if signal == "-INT" && ended.status.code() == Some(2) {
            let told = text(&ended.stderr);
            assert!(told.contains("moreau resume"), "{told}");
            let json = fs::read_to_string(out.join("run.json")).expect("a summary");
            assert!(json.contains("\"interrupted\""), "{json}");
        }
        assert_eq!(resume(&out, &[]), (0, String::new()));
        equal_but_for_times(&whole, &out);
    }
}

/// The results of a deck in several files hold all of it: they go on whatever has become of the files.
#[test]
fn results_need_no_included_file() {
    let at = directory("included");
    fs::create_dir_all(&at).expect("a directory");
    let punched = punched();
    let (head, tail) = punched.split_once("[[material]]").expect("a material");
    let (material, tail) = tail.split_once("[[tool]]").expect("a tool");
    let (deck, part) = (at.join("deck.toml"), at.join("steel.toml"));
    let output = "[output]\ncheckpoint = 3\n";
    let whole = format!("include = \"steel.toml\"\n{head}[[tool]]{tail}\n{output}");
    fs::write(&deck, whole).expect("a deck");
    fs::write(&part, format!("[[material]]{material}")).expect("a part");
    let out = at.join("out");
    let to = out.to_string_lossy();
    let run = moreau(&["run", &deck.to_string_lossy(), "--out", &to, "--verify"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let read = |name: &str| fs::read(out.join(name)).expect("a file");
    let before = ["history.csv", "deck.resolved.toml"].map(read);
    assert!(text(&before[1]).contains("yield-stress = 300.0"));
    fs::remove_file(&part).expect("removed");
    let run = moreau(&["resume", &to]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(["history.csv", "deck.resolved.toml"].map(read) == before);
    // The deck itself is no longer whole.
    let run = moreau(&["run", &deck.to_string_lossy(), "--out", &to]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("cannot read the included file"));
}

/// A run goes on, and is drawn again, with the mesh that it began with and with no other.
#[test]
fn results_belong_to_their_mesh() {
    let at = directory("remeshed");
    fs::create_dir_all(&at).expect("a directory");
    let read = |name: &str| fs::read_to_string(examples().join(name)).expect("an example");
    let deck = read("punch-on-gmsh-mesh.toml").replace("increments = 20", "increments = 2");
    let deck = deck.split("[expect]").next().expect("a deck").to_owned();
    let mesh = at.join("punch-on-gmsh-mesh.msh");
    fs::write(at.join("deck.toml"), deck + "[output]\ncheckpoint = 1\n").expect("a deck");
    fs::write(&mesh, read("punch-on-gmsh-mesh.msh")).expect("a mesh");
    let out = at.join("out");
    let to = out.to_string_lossy();
    let run = moreau(&["run", &at.join("deck.toml").to_string_lossy(), "--out", &to]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let history = || fs::read(out.join("history.csv")).expect("a history");
    let before = history();
    assert_eq!(moreau(&["plot", &to]).status.code(), Some(0));
    // As many nodes, elsewhere.
    let changed = read("punch-on-gmsh-mesh.msh").replacen("\n50 0 0\n", "\n51 0 0\n", 1);
    assert!(changed != read("punch-on-gmsh-mesh.msh"));
    fs::write(&mesh, changed).expect("a mesh");
    for command in ["resume", "plot"] {
        let other = moreau(&[command, &to]);
        assert_eq!(other.status.code(), Some(1), "{command}");
        let told = text(&other.stderr);
        assert!(
            told.contains("a mesh or the surface of a tool has changed"),
            "{told}"
        );
    }
    assert!(history() == before);
}
