//! The loads of the page beside those of the command for the decks that the page says it ran: equal in all digits.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

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

/// Time that a page may take for its load.
const PATIENCE: Duration = Duration::from_secs(120);
/// Between two looks at it.
const PAUSE: Duration = Duration::from_millis(50);
/// Windows that pictures are taken of \[pixels\].
const WINDOWS: [(u32, u32); 2] = [(1280, 900), (420, 900)];

/// Compares, and takes pictures of the first choice into a folder; `Ok(false)` where a load differs.
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
        if state != "done" {
            println!("✗ page #{choice}: {state}");
            good = false;
            continue;
        }
        let told = browser.value(&opened, "document.getElementById('load').dataset.value")?;
        let deck = browser.value(&opened, "document.getElementById('deck').textContent")?;
        scratch.write(&format!("{k}.toml"), &deck)?;
        let native = native(root, scratch.path(), k)?;
        let equal = told.parse::<f64>()?.to_bits() == native.to_bits();
        let sign = if equal { '✓' } else { '✗' };
        println!("{sign} page #{choice}: load {told}, of the command {native}");
        good &= equal;
    }
    for (folder, window) in pictures.into_iter().flat_map(|f| WINDOWS.map(|w| (f, w))) {
        let opened = browser.open(&address(CHOICES[0]), window)?;
        rested(&mut browser, &opened)?;
        let picture = base64::decoded(&browser.picture(&opened)?);
        fs::create_dir_all(folder)?;
        fs::write(folder.join(format!("page-{}.png", window.0)), picture)?;
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

/// The load that the command finds for a deck.
fn native(root: &Path, folder: &Path, k: usize) -> Result<f64, Box<dyn Error>> {
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
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let history = fs::read_to_string(out.join("history.csv"))?;
    let mut lines = history.lines();
    let names = lines.next().unwrap_or_default().split(',');
    let at = names
        .into_iter()
        .position(|name| name.starts_with("force.punch.y"));
    let value = at.and_then(|at| lines.last()?.split(',').nth(at));
    Ok(value.ok_or("the command shows no load")?.parse()?)
}
