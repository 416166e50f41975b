//! `mpirun -n N moreau run`: the results of one process on several, and what is left where one of them dies, a disk
//! is full or MUMPS lacks room. Where there is no `mpirun` these tests say so and test nothing.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const MOREAU: &str = env!("CARGO_BIN_EXE_moreau");

/// A body of several materials' worth of cells that flows under a rough punch, small enough for a test.
fn deck(cells: [usize; 3], increments: usize, head: &str, contact: &str) -> String {
    let [x, y, z] = cells;
    format!(
        r#"units = "mm-N-MPa"
analysis = "solid"
{head}
mesh.block = [{{ name = "block", element = "hex20", x = [0, 20], y = [0, 20], z = [0, 10], cells = [{x}, {y}, {z}] }}]
material = [{{ on = "block", young = 210000.0, poisson = 0.3, yield-stress = 300.0, hardening = {{ linear = 1000.0 }} }}]
tool = [{{ name = "punch", sphere = {{ center = [0, 0, 40], radius = 30 }} }}]
contact = [{{ surface = "{contact}", against = "punch", friction = 0.2 }}]
[[step]]
name = "indent"
increments = {increments}
fix = [
  {{ on = "block.left", u = ["x"] }},
  {{ on = "block.bottom", u = ["y"] }},
  {{ on = "block.back", u = ["x", "y", "z"] }},
]
tools = [{{ name = "punch", move = [0, 0, -0.3] }}]
[output]
vtu = "last"
checkpoint = 1
"#
    )
}

/// A folder of a test, with a deck in it.
struct Place(PathBuf);

impl Place {
    fn new(name: &str, deck: &str) -> Self {
        let path = std::env::temp_dir().join(format!("moreau-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder");
        fs::write(path.join("deck.toml"), deck).expect("a file");
        Self(path)
    }

    fn alone(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(MOREAU);
        command.args(arguments).current_dir(&self.0);
        command.output().expect("the command")
    }

    fn on(&self, processes: usize, arguments: &[&str]) -> Command {
        let mut command = Command::new("mpirun");
        command
            .args(["--oversubscribe", "-n", &processes.to_string(), MOREAU])
            .args(arguments)
            .current_dir(&self.0)
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        command
    }

    fn history(&self, out: &str) -> Vec<Vec<f64>> {
        let text = fs::read_to_string(self.0.join(out).join("history.csv")).expect("a history");
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
        let told = |name: &&str| name.trim_matches('"').starts_with("force.");
        let columns: Vec<usize> = (0..names.len()).filter(|&c| told(&names[c])).collect();
        let row = |line: &str| {
            let all: Vec<&str> = line.split(',').collect();
            let own = columns.iter().map(|&c| all[c].parse().expect("a number"));
            own.collect()
        };
        lines.map(row).collect()
    }

    fn statuses(&self, out: &str) -> Vec<String> {
        let text = fs::read_to_string(self.0.join(out).join("contact.csv")).expect("contacts");
        let head = text.lines().next().unwrap_or_default().split(',');
        let at = head
            .clone()
            .position(|name| name == "status")
            .expect("a column");
        let status = |line: &str| line.split(',').nth(at).unwrap_or_default().to_owned();
        text.lines().skip(1).map(status).collect()
    }

    /// Forces to 1e-9 of the largest, and all statuses.
    fn assert_alike(&self, one: &str, two: &str) {
        let (a, b) = (self.history(one), self.history(two));
        assert_eq!(a.len(), b.len(), "{two}");
        let largest = a.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((x - y).abs() < 1e-9 * largest, "{two}: {x} and {y}");
        }
        assert_eq!(self.statuses(one), self.statuses(two), "{two}");
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Whether there is MPI; if not, that is said.
fn has_mpi(test: &str) -> bool {
    let there = Command::new("mpirun").arg("--version").output().is_ok();
    if !there {
        let _ = writeln!(std::io::stderr(), "skipped, as there is no mpirun: {test}");
    }
    there
}

fn same_on_all(name: &str, deck: &str) {
    if !has_mpi(name) {
        return;
    }
    let place = Place::new(name, deck);
    let run = ["run", "deck.toml", "--quiet", "--out"];
    let told = place.alone(&[&run[..], &["one"]].concat());
    assert!(told.status.success(), "{told:?}");
    let out = |n: usize| format!("on-{n}");
    for n in [1, 2, 3] {
        let own = out(n);
        let told = place.on(n, &[&run[..], &[&own]].concat()).output();
        let told = told.expect("mpirun");
        assert!(told.status.success(), "{n}: {told:?}");
        place.assert_alike("one", &own);
    }
    // The same files, those of several processes in pieces that have all cells between them.
    let read = |n: usize, file: &str| {
        let bytes = fs::read(place.0.join(out(n)).join(file)).expect("a file");
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let cells = |text: &str| {
        let (_, after) = text.split_once("NumberOfCells=\"").expect("a piece");
        let number = after.split('"').next().expect("a number");
        number.parse::<usize>().expect("a number")
    };
    assert!(!read(1, "result.pvd").contains(".pvtu"));
    let list = read(3, "result.pvd");
    assert_eq!(read(1, "result.pvd"), list.replace(".pvtu", ".vtu"));
    let name = list.split('"').find(|file| file.starts_with("body_"));
    let name = name.expect("a body").trim_end_matches(".pvtu");
    let whole = read(3, &format!("{name}.pvtu"));
    let pieces: Vec<usize> = (0..3)
        .map(|p| format!("{name}_{p}.vtu"))
        .inspect(|piece| assert!(whole.contains(&format!("<Piece Source=\"{piece}\"/>"))))
        .map(|piece| cells(&read(3, &piece)))
        .collect();
    assert!(pieces.iter().all(|&count| count > 0), "{pieces:?}");
    assert_eq!(
        pieces.iter().sum::<usize>(),
        cells(&read(1, &format!("{name}.vtu")))
    );
}

#[test]
fn results_do_not_depend_on_the_number_of_processes() {
    same_on_all("condensed", &deck([4, 4, 2], 3, "", "block.front"));
}

#[test]
fn large_strains_do_not_either() {
    let head = "strain = \"finite\"";
    same_on_all("large", &deck([3, 3, 2], 3, head, "block.front"));
}

#[test]
fn nor_do_contacts_that_are_tied() {
    same_on_all("tied", &deck([8, 8, 1], 2, "", "block.front"));
}

#[test]
fn a_checkpoint_is_one_of_any_number_of_processes() {
    if !has_mpi("a checkpoint is one of any number of processes") {
        return;
    }
    let place = Place::new("resumed", &deck([4, 4, 2], 4, "", "block.front"));
    let run = ["run", "deck.toml", "--quiet", "--out"];
    assert!(place.alone(&[&run[..], &["one"]].concat()).status.success());
    let ended = place.on(3, &[&run[..], &["other"]].concat()).output();
    assert!(ended.expect("mpirun").status.success());
    // As if it had ended after its third increment.
    fs::remove_file(place.0.join("other/checkpoint/increment-000004.ckpt")).expect("the last");
    let told = place.on(2, &["resume", "other", "--quiet"]).output();
    let told = told.expect("mpirun");
    assert!(told.status.success(), "{told:?}");
    place.assert_alike("one", "other");
}

/// The processes of a run by their rank.
fn process(deck: &Path, rank: &str) -> Option<u32> {
    let entries = fs::read_dir("/proc").ok()?.flatten();
    let mut numbers = entries.filter_map(|e| e.file_name().to_str()?.parse::<u32>().ok());
    numbers.find(|n| {
        let of = |file: &str| fs::read(format!("/proc/{n}/{file}")).unwrap_or_default();
        let place = fs::read_link(format!("/proc/{n}/cwd"));
        let rank = format!("OMPI_COMM_WORLD_RANK={rank}");
        place.is_ok_and(|at| at == deck)
            && of("environ")
                .split(|b| *b == 0)
                .any(|v| v == rank.as_bytes())
    })
}

/// A run of many increments on three processes, of which the first has converged.
fn under_way(place: &Place) -> Child {
    let mut command = place.on(3, &["run", "deck.toml", "--out", "out"]);
    let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = piped.spawn().expect("mpirun");
    let first = place.0.join("out/checkpoint/increment-000001.ckpt");
    let started = Instant::now();
    while !first.exists() && started.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(50));
    }
    child
}

fn call(program: &str, arguments: &[&str]) {
    let status = Command::new(program).args(arguments).status();
    assert!(status.expect(program).success(), "{program} {arguments:?}");
}

/// What is in a folder goes on: here on one process, for another increment; until then its history is whole.
fn goes_on(place: &Place) {
    let before = place.history("out").len();
    assert!(before >= 1);
    let mut child = Command::new(MOREAU)
        .args(["resume", "out", "--quiet"])
        .current_dir(&place.0)
        .spawn()
        .expect("the command");
    let started = Instant::now();
    while place.history("out").len() < before + 1 && started.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(100));
    }
    child.kill().expect("running");
    let _ = child.wait();
    assert!(place.history("out").len() > before);
}

/// How a run ended that something happened to: its status, and what it told. No process is left.
fn end(place: &Place, child: Child) -> (Option<i32>, String) {
    let told = child.wait_with_output().expect("mpirun");
    let at = fs::canonicalize(&place.0).expect("a folder");
    assert_eq!(process(&at, "0"), None);
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    (told.status.code(), text)
}

#[test]
fn a_process_that_dies_ends_all_and_leaves_the_last_checkpoint() {
    if !has_mpi("a process that dies ends all") {
        return;
    }
    // The first one writes all files.
    for rank in ["2", "0"] {
        let place = Place::new(
            &format!("killed-{rank}"),
            &deck([7, 7, 4], 40, "", "block.front"),
        );
        let child = under_way(&place);
        let at = fs::canonicalize(&place.0).expect("a folder");
        let victim = process(&at, rank).expect("a process of the rank");
        call("kill", &["-9", &victim.to_string()]);
        let (status, text) = end(&place, child);
        assert_ne!(status, Some(0), "rank {rank}");
        assert!(
            text.contains("signal 9") || text.contains("Killed"),
            "rank {rank}: {text}"
        );
        goes_on(&place);
    }
}

/// The first process writes all files: none of them may be longer than some kilobytes any more.
#[test]
fn a_full_disk_is_told_with_the_file_and_ends_all() {
    if !has_mpi("a full disk") || Command::new("prlimit").arg("--version").output().is_err() {
        return;
    }
    let place = Place::new("full", &deck([7, 7, 4], 40, "", "block.front"));
    let child = under_way(&place);
    let at = fs::canonicalize(&place.0).expect("a folder");
    let first = process(&at, "0").expect("a process of rank 0").to_string();
    call("prlimit", &["--fsize=20000", "--pid", &first]);
    let (status, text) = end(&place, child);
    assert_eq!(status, Some(2), "{text}");
    // That is the first of its files that grows.
    assert!(text.contains("out/"), "{text}");
    assert!(text.contains("File too large"), "{text}");
    goes_on(&place);
}

#[test]
fn an_interrupt_writes_where_it_is() {
    if !has_mpi("an interrupt") {
        return;
    }
    let place = Place::new("interrupted", &deck([7, 7, 4], 40, "", "block.front"));
    let child = under_way(&place);
    call("kill", &["-INT", &child.id().to_string()]);
    let (status, text) = end(&place, child);
    assert_ne!(status, Some(0));
    assert!(text.contains("interrupted after increment"), "{text}");
    goes_on(&place);
}

#[test]
fn too_little_space_of_mumps_is_made_larger() {
    if !has_mpi("too little space of MUMPS") {
        return;
    }
    let place = Place::new(
        "space",
        &deck([4, 4, 2], 2, "strain = \"finite\"", "block.front"),
    );
    let run = ["run", "deck.toml", "--quiet", "--out"];
    assert!(place.alone(&[&run[..], &["one"]].concat()).status.success());
    let mut command = place.on(2, &[&run[..], &["two"]].concat());
    let told = command.env("MOREAU_SPARE", "-60").output().expect("mpirun");
    assert!(told.status.success(), "{told:?}");
    place.assert_alike("one", "two");
}

/// Where no larger working space helps, the increment fails with the number of the error, what has converged stays, and
/// a run that has the room goes on from it.
#[test]
fn an_error_of_mumps_that_stays_is_told_and_nothing_is_lost() {
    if !has_mpi("an error of MUMPS that stays") {
        return;
    }
    let place = Place::new(
        "gave-up",
        &deck([4, 4, 2], 3, "strain = \"finite\"", "block.front"),
    );
    let run = ["run", "deck.toml", "--quiet", "--out"];
    assert!(place.alone(&[&run[..], &["one"]].concat()).status.success());
    let ended = place.on(2, &[&run[..], &["out"]].concat()).output();
    assert!(ended.expect("mpirun").status.success());
    // As if it had ended after its second increment.
    let last = |n: usize| {
        place
            .0
            .join(format!("out/checkpoint/increment-{n:06}.ckpt"))
    };
    fs::remove_file(last(3)).expect("the last");
    let resume = ["resume", "out", "--quiet"];
    let mut command = place.on(2, &resume);
    let tight = command.env("MOREAU_SPARE", "-60").env("MOREAU_LARGER", "0");
    let told = tight.output().expect("mpirun");
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert_eq!(told.status.code(), Some(2), "{text}");
    assert!(text.contains("gave up with its error -9"), "{text}");
    assert!(last(2).exists() && !last(3).exists());
    assert_eq!(place.history("out").len(), 2);
    let told = place.on(2, &resume).output().expect("mpirun");
    assert!(told.status.success(), "{told:?}");
    place.assert_alike("one", "out");
}

#[test]
fn a_deck_with_errors_is_told_once_and_ends_all() {
    if !has_mpi("a deck with errors") {
        return;
    }
    let place = Place::new("wrong", "units = \"mm-N-MPa\"\nanalysis = \"sold\"\n");
    let told = place.on(3, &["run", "deck.toml"]).output().expect("mpirun");
    assert_eq!(told.status.code(), Some(1), "{told:?}");
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert_eq!(text.matches("deck.toml:2").count(), 1, "{text}");
}

/// A body that only its contact holds upwards, which the second step lifts off: no increment of that has a balance, with
/// contacts condensed or tied.
const LIFTED: &str = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "a", element = "quad4", x = [0, 20], y = [0, 10], cells = [4, 2] }]
material = [{ on = "a", young = 210000.0, poisson = 0.3 }]
tool = [{ name = "floor", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "a.bottom", against = "floor", friction = 0.2 }]
[[step]]
name = "press"
increments = 1
fix = [{ on = "a.left", u = ["x"] }]
load = [{ on = "a.top", pressure = 10 }]
[[step]]
name = "pull"
increments = 1
fix = [{ on = "a.left", u = ["x"] }]
load = [{ on = "a.top", pressure = -10 }]
"#;

/// The same body under a strip load that is cut to its limit, again and again.
const COLLAPSING: &str = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "a", element = "quad4", x = [0, 20], y = [0, 10], cells = [4, 2] }]
mesh.group = [{ name = "strip", on = "a.top", x = [0, 5] }]
material = [{ on = "a", young = 210000.0, poisson = 0.3, yield-stress = 300.0 }]
tool = [{ name = "floor", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "a.bottom", against = "floor", friction = 0.2 }]
[[step]]
name = "press"
increments = 2
fix = [{ on = "a.left", u = ["x"] }]
load = [{ on = "strip", pressure = 5000 }]
until = "collapse"
"#;

/// As where both ways of seeing contacts have failed, and the increment is cut.
#[test]
fn increments_that_failed_both_ways_are_cut_as_alone() {
    if !has_mpi("increments that failed both ways") {
        return;
    }
    for (name, deck, status) in [("lifted", LIFTED, 2), ("collapsing", COLLAPSING, 0)] {
        let place = Place::new(name, deck);
        let run = ["run", "deck.toml", "--quiet", "--out"];
        let alone = place.alone(&[&run[..], &["one"]].concat());
        assert_eq!(alone.status.code(), Some(status), "{alone:?}");
        let told = place.on(2, &[&run[..], &["two"]].concat()).output();
        let told = told.expect("mpirun");
        assert_eq!(told.status.code(), Some(status), "{told:?}");
        let [one, two] = [alone, told].map(|t| String::from_utf8_lossy(&t.stderr).into_owned());
        assert!(two.contains(one.trim()), "{name}: {two} alone: {one}");
        place.assert_alike("one", "two");
    }
}

/// A square in the plane, by what is done with it.
fn square(steps: &str) -> String {
    format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{{ name = "a", element = "quad4", x = [0, 10], y = [0, 10], cells = [2, 2] }}]
material = [{{ on = "a", young = 210000.0, poisson = 0.3 }}]
[[step]]
name = "one"
increments = 1
{steps}
"#
    )
}

/// As `mpirun` without what it says itself of a process that ends so.
fn told_by(command: &mut Command) -> (Option<i32>, String) {
    let told = command.output().expect("mpirun");
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(!text.contains("panicked"), "{text}");
    (told.status.code(), text)
}

/// What is found only after the first process has asked the others for the stresses at the start.
#[test]
fn an_error_that_only_the_driver_finds_is_told_once_as_well() {
    if !has_mpi("an error that only the driver finds") {
        return;
    }
    let up = "move = [{ on = \"a.top\", u = { y = -0.1 } }]";
    let wrong = [
        ("unheld", format!("fix = [{{ on = \"a.bottom\", u = [\"y\"] }}]\n{up}")),
        (
            "conflict",
            "fix = [{ on = \"a.bottom\", u = [\"x\", \"y\"] }]\nmove = [{ on = \"a.bottom\", u = { y = -0.1 } }]"
                .into(),
        ),
        (
            "no-column",
            format!(
                "fix = [{{ on = \"a.bottom\", u = [\"x\", \"y\"] }}]\n{up}\n[[expect]]\ncolumn = \"fonce.a\"\nvalue = 1\ntolerance = 1"
            ),
        ),
    ];
    for (name, steps) in wrong {
        let place = Place::new(name, &square(&steps));
        let alone = place.alone(&["run", "deck.toml"]);
        assert_eq!(alone.status.code(), Some(1), "{name}: {alone:?}");
        let alone = String::from_utf8_lossy(&alone.stderr).into_owned();
        assert!(alone.contains("error"), "{name}: {alone}");
        for n in [2, 3] {
            let (status, text) = told_by(&mut place.on(n, &["run", "deck.toml"]));
            assert_eq!(status, Some(1), "{name}: {text}");
            assert_eq!(text.matches(alone.trim()).count(), 1, "{name}: {text}");
            assert!(!text.contains("MPI_ABORT"), "{name}: {text}");
        }
    }
}

/// One process in a folder of its own, with the same names of files in it.
#[test]
fn a_process_that_reads_another_file_is_named() {
    if !has_mpi("a process that reads another file") {
        return;
    }
    let block = |n: usize| {
        format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{{ name = "a", element = "quad4", x = [0, 10], y = [0, 10], cells = [{n}, 2] }}]
material = [{{ on = "a", young = 210000.0, poisson = 0.3 }}]
"#
        )
    };
    let held = r#"[[step]]
name = "one"
increments = 1
fix = [{ on = "a.bottom", u = ["x", "y"] }]
move = [{ on = "a.top", u = { y = -0.1 } }]
"#;
    let from_file = "units = \"mm-N-MPa\"\nanalysis = \"plane-strain\"\nmesh.file = \"a.inp\"\n\
        material = [{ on = \"a\", young = 210000.0, poisson = 0.3 }]\n";
    let mesh = |y: f64| {
        format!(
            "*NODE, NSET=a.bottom\n1, 0.0, 0.0\n2, 10.0, 0.0\n*NODE, NSET=a.top\n3, 10.0, {y:.1}\n4, 0.0, {y:.1}\n\
             *ELEMENT, TYPE=CPE4, ELSET=a\n1, 1, 2, 3, 4\n"
        )
    };
    let own = |place: &Place, files: &[(&str, String)]| {
        for (folder, text) in files {
            let path = place.0.join(folder);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, text).expect("a file");
        }
    };
    let cases = [
        (
            "deck",
            vec![
                ("0/deck.toml", block(2) + held),
                ("1/deck.toml", block(3) + held),
            ],
            "process 1 reads another deck than the first",
        ),
        (
            "included",
            vec![
                (
                    "0/deck.toml",
                    format!("include = \"rest.toml\"\n{}", block(2)),
                ),
                (
                    "1/deck.toml",
                    format!("include = \"rest.toml\"\n{}", block(2)),
                ),
                ("0/rest.toml", held.into()),
                ("1/rest.toml", held.replace("0.1", "0.2")),
            ],
            "process 1 reads another deck than the first",
        ),
        (
            "mesh",
            vec![
                ("0/deck.toml", from_file.to_owned() + held),
                ("1/deck.toml", from_file.to_owned() + held),
                ("0/a.inp", mesh(10.0)),
                ("1/a.inp", mesh(11.0)),
            ],
            "process 1 reads another mesh file",
        ),
        (
            "no-deck",
            vec![("0/deck.toml", block(2) + held), ("1/other.toml", block(2))],
            "process 1 does not find the deck of the first",
        ),
    ];
    for (name, files, expected) in cases {
        let place = Place::new(&format!("differs-{name}"), "");
        own(&place, &files);
        let there = "cd $OMPI_COMM_WORLD_RANK && exec \"$0\" run deck.toml --quiet --out ../out";
        let mut command = Command::new("mpirun");
        command
            .args(["--oversubscribe", "-n", "2", "sh", "-c", there, MOREAU])
            .current_dir(&place.0)
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        let (status, text) = told_by(&mut command);
        assert_eq!(status, Some(1), "{name}: {text}");
        assert_eq!(text.matches(expected).count(), 1, "{name}: {text}");
        assert!(!text.contains("MPI_ABORT"), "{name}: {text}");
        assert!(!place.0.join("out").exists(), "{name}");
    }
}

/// How much address space that is depends on the machine: limits are tried until one is met there.
#[test]
fn a_process_without_room_for_threads_ends_all() {
    if !has_mpi("a process without room for threads") {
        return;
    }
    let held = "fix = [{ on = \"a.bottom\", u = [\"x\", \"y\"] }]\nmove = [{ on = \"a.top\", u = { y = -0.1 } }]";
    let place = Place::new("threads", &square(held));
    let limited = "test $OMPI_COMM_WORLD_RANK = 0 || ulimit -v $1; exec \"$0\" run deck.toml --quiet --out out";
    for limit in (6..30).map(|k| 100_000 * k) {
        let mut command = Command::new("timeout");
        command
            .args(["60", "mpirun", "--oversubscribe", "-n", "2", "sh", "-c"])
            .args([limited, MOREAU, &limit.to_string()])
            .current_dir(&place.0)
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        let told = command.output().expect("mpirun");
        let text = String::from_utf8_lossy(&told.stderr);
        assert_ne!(told.status.code(), Some(124), "{limit}: {text}");
        if text.contains("cannot start threads") {
            assert_eq!(told.status.code(), Some(1), "{text}");
            return;
        }
        if told.status.success() {
            break;
        }
    }
    let _ = writeln!(
        std::io::stderr(),
        "skipped, as no limit leaves room for all but threads"
    );
}

#[test]
fn what_is_no_run_is_done_by_the_first_process_alone() {
    if !has_mpi("what is no run") {
        return;
    }
    let held = "fix = [{ on = \"a.bottom\", u = [\"x\", \"y\"] }]\nmove = [{ on = \"a.top\", u = { y = -0.1 } }]";
    let place = Place::new("no-run", &square(held));
    let alone = place.alone(&["check", "deck.toml"]);
    let told = place.on(3, &["check", "deck.toml"]).output();
    let told = told.expect("mpirun");
    assert!(told.status.success(), "{told:?}");
    assert_eq!(told.stdout, alone.stdout);
    let (status, text) = told_by(&mut place.on(3, &["check", "dock.toml"]));
    assert_eq!(status, Some(1), "{text}");
    assert_eq!(text.matches("cannot read the deck").count(), 1, "{text}");
    let (_, text) = told_by(&mut place.on(3, &["rum", "deck.toml"]));
    assert_eq!(text.matches("unrecognized subcommand").count(), 1, "{text}");
}
