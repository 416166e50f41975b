//! What comes of the page beside what comes of the command, for the decks that the page says it ran: how they end, and
//! their loads. Equal bits are not asked for: libraries of dense algebra choose their instructions by the processor.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::base64;
use super::browser::{self, Browser};
use verification::scratch::Scratch;

/// Choices, as the address of the page has them: the paper's, and one for each way that differs.
const CHOICES: [&str; 4] = [
    "",
    "friction=0.25&cells=3",
    "cells=2&algorithm=gauss-seidel",
    "friction=0.3&algorithm=outside",
];

/// Part of the load by which it may differ: more than iterations leave that end at their tolerance.
const APART: f64 = 1e-9;
/// Time that a page may take for its load.
const PATIENCE: Duration = Duration::from_secs(120);
/// Between two looks at it.
const PAUSE: Duration = Duration::from_millis(50);
/// Windows that pictures are taken of \[pixels\].
const WINDOWS: [(u32, u32); 2] = [(1280, 900), (420, 900)];

/// Compares, and takes pictures of the first choice and of the last, which stops, into a folder; `Ok(false)` where it ends otherwise or a load differs.
pub(super) fn run(
    root: &Path,
    page: &Path,
    pictures: Option<&Path>,
) -> Result<bool, Box<dyn Error>> {
    let Some(program) = browser::found() else {
        println!(
            "– page: not opened, there is no Chromium; CHROMIUM names one that is not on the path"
        );
        return Ok(true);
    };
    let scratch = Scratch::new()?;
    let mut browser = Browser::start(&program, &scratch.path().join("browser"))?;
    let address = |choice: &str| format!("file://{}#{choice}", page.display());
    let mut good = true;
    for (k, choice) in CHOICES.into_iter().enumerate() {
        let opened = browser.open(&address(choice), WINDOWS[0])?;
        let state = rested(&mut browser, &opened)?;
        let deck = browser.value(&opened, "document.getElementById('deck').textContent")?;
        let load = browser.value(&opened, "document.getElementById('load').dataset.value")?;
        scratch.write(&format!("{k}.toml"), &deck)?;
        let native = native(root, scratch.path(), k)?;
        // How far one comes that stops is decided by the last bits.
        let off = match state == "done" {
            true => (load.parse::<f64>()? / native.load - 1.0).abs(),
            false => 0.0,
        };
        let equal = state == native.status && off <= APART;
        let sign = if equal { '✓' } else { '✗' };
        println!(
            "{sign} page #{choice}: {state}, load {load}; the command: {}, {}",
            native.status, native.load
        );
        good &= equal;
    }
    let views = [
        ("page", CHOICES[0]),
        ("stopped", CHOICES[CHOICES.len() - 1]),
    ];
    let all = views.iter().flat_map(|view| WINDOWS.map(|w| (view, w)));
    for (folder, ((name, choice), window)) in pictures
        .into_iter()
        .flat_map(|f| all.clone().map(move |v| (f, v)))
    {
        let opened = browser.open(&address(choice), window)?;
        rested(&mut browser, &opened)?;
        let picture = base64::decoded(&browser.picture(&opened)?);
        fs::create_dir_all(folder)?;
        fs::write(folder.join(format!("{name}-{}.png", window.0)), picture)?;
    }
    Ok(good)
}

/// Waits until a page has computed and drawn; how that ended.
fn rested(browser: &mut Browser, page: &browser::Page) -> Result<String, Box<dyn Error>> {
    let start = Instant::now();
    loop {
        thread::sleep(PAUSE);
        let state = browser.value(page, "document.documentElement.dataset.state")?;
        if !["", "running"].contains(&state.as_str()) {
            // What is told last is drawn a little later.
            thread::sleep(4 * PAUSE);
            return Ok(state);
        }
        if start.elapsed() > PATIENCE {
            return Ok("not done in time".to_owned());
        }
    }
}

/// What comes of a run of the command.
struct Native {
    status: String,
    load: f64,
}

/// Runs the command with a deck.
fn native(root: &Path, folder: &Path, k: usize) -> Result<Native, Box<dyn Error>> {
    let (deck, out) = (
        folder.join(format!("{k}.toml")),
        folder.join(format!("{k}")),
    );
    let output = super::cargo()
        .args(["run", "--release", "--quiet", "--package", "moreau"])
        .arg("--manifest-path")
        .arg(root.join("Cargo.toml"))
        .args(["--", "run", "--out"])
        .args([&out, &deck])
        .output()?;
    let Ok(run) = fs::read(out.join("run.json")) else {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    };
    let run: Value = serde_json::from_slice(&run)?;
    let load = run["values"]["force.punch.y"].as_f64();
    let status = run["status"].as_str();
    let (load, status) = load.zip(status).ok_or("the command tells no load")?;
    let status = status.to_owned();
    Ok(Native { status, load })
}
