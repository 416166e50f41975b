//! A browser without a window, which opens a page from disk and hands back what the page has become.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

/// Names that Chromium goes by.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Time that a page may take, of its own clock \[ms\].
const PATIENCE: &str = "120000";

/// A browser that was found.
pub(super) struct Browser(PathBuf);

impl Browser {
    /// The one that `CHROMIUM` names, or the first on the path.
    pub(super) fn found() -> Option<Self> {
        if let Some(named) = env::var_os("CHROMIUM") {
            return Some(Self(named.into()));
        }
        let path = env::var_os("PATH")?;
        let folders: Vec<PathBuf> = env::split_paths(&path).collect();
        let all = NAMES
            .iter()
            .flat_map(|name| folders.iter().map(move |f| f.join(name)));
        all.into_iter().find(|file| file.is_file()).map(Self)
    }

    /// The elements of a page on disk once its scripts have rested; `choice` is the end of its address.
    ///
    /// # Errors
    /// That of the system; what the browser says where it fails.
    pub(super) fn opened(&self, page: &Path, choice: &str, own: &Path) -> io::Result<String> {
        fs::create_dir_all(own)?;
        let output = Command::new(&self.0)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
            .arg(format!("--user-data-dir={}", own.display()))
            .arg(format!("--virtual-time-budget={PATIENCE}"))
            .arg(format!("file://{}#{choice}", page.display()))
            .stdin(Stdio::null())
            .output()?;
        match output.status.success() {
            true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            false => Err(io::Error::other(
                String::from_utf8_lossy(&output.stderr).into_owned(),
            )),
        }
    }
}
