//! `cargo xtask page`: the page that computes the punched block by itself, as one file, and the test that it computes what
//! the command does; not what is on it, which is `crates/browser/page`.

mod base64;
mod browser;
mod compared;

use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use verification::workspace;

/// What the module is compiled for.
const TARGET: &str = "wasm32-unknown-unknown";

/// Arguments of `page`.
#[derive(clap::Args)]
pub struct Args {
    /// Where the page is written [default: moreau.html in the folder of what is built]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Open it from disk in a browser without a window, and compare its loads with those of the command, to 1e-9 of them
    #[arg(long)]
    test: bool,
    /// With --test: pictures of the page in a wide and in a narrow window, as files in this folder
    #[arg(long, value_name = "DIR", requires = "test")]
    pictures: Option<PathBuf>,
}

/// Builds the page, and tests it if that is asked for; `Ok(false)` where a load differs. A test is left out, and says so,
/// where the target or a browser is missing.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let root = workspace::root();
    if !has_target()? {
        let lack = format!("the target {TARGET} is not installed: `rustup target add {TARGET}`");
        if args.test {
            println!("– page: skipped, {lack}");
            return Ok(true);
        }
        return Err(lack.into());
    }
    let built = built(&root);
    let default = || built.join("moreau.html");
    let out = args.out.clone().unwrap_or_else(default);
    let page = assembled(&root, &module(&root, &built)?)?;
    fs::write(&out, &page)?;
    println!(
        "✓ page: {}, {:.2} MB",
        workspace::shown(&out),
        page.len() as f64 / 1e6
    );
    match args.test {
        true => compared::run(&root, &fs::canonicalize(&out)?, args.pictures.as_deref()),
        false => Ok(true),
    }
}

/// Cargo, as it runs this.
fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// The folder of what is built.
fn built(root: &Path) -> PathBuf {
    let given = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    given.unwrap_or_else(|| root.join("target"))
}

fn has_target() -> Result<bool, Box<dyn Error>> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let told = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .output()?;
    let folder = String::from_utf8(told.stdout)?;
    Ok(told.status.success() && Path::new(folder.trim()).is_dir())
}

/// Compiles the module.
fn module(root: &Path, built: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let built = built.join("page");
    let status = cargo()
        .args(["build", "--release", "--locked", "--target", TARGET])
        .arg("--manifest-path")
        .arg(root.join("crates/browser/Cargo.toml"))
        .arg("--target-dir")
        .arg(&built)
        .status()?;
    match status.success() {
        true => Ok(fs::read(
            built.join(TARGET).join("release/moreau_browser.wasm"),
        )?),
        false => Err("the module does not build".into()),
    }
}

/// Bytes as gzip has them, which browsers take apart by themselves.
fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut writer = GzEncoder::new(Vec::new(), Compression::best());
    writer.write_all(bytes)?;
    writer.finish()
}

/// The page with all its parts in it.
fn assembled(root: &Path, module: &[u8]) -> Result<String, Box<dyn Error>> {
    let folder = root.join("crates/browser/page");
    let part = |name: &str| fs::read_to_string(folder.join(name));
    let deck = fs::read_to_string(root.join("docs/examples/punched-block.toml"))?;
    let parts = [
        ("{{style}}", part("style.css")?),
        ("{{module}}", base64::encoded(&compressed(module)?)),
        ("{{worker}}", part("worker.js")?),
        ("{{deck}}", deck),
        ("{{page}}", part("page.js")?),
    ];
    let mut page = part("page.html")?;
    for (place, text) in parts {
        if place != "{{style}}" && text.contains("</script") {
            return Err(format!("what goes to {place} ends its own element").into());
        }
        page = page.replacen(place, &text, 1);
    }
    Ok(page)
}
