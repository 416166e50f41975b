//! A browser without a window: pages in it are asked by the protocol of its developers' tools, over pipes; not what is
//! asked.

use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use std::{env, thread};

use serde_json::{Value, json};

/// Names that Chromium goes by.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Time that an answer may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// The one that `CHROMIUM` names, or the first on the path; `None` where there is none, or no shell to start it by.
pub(super) fn found() -> Option<PathBuf> {
    if cfg!(not(unix)) {
        return None;
    }
    if let Some(named) = env::var_os("CHROMIUM") {
        return Some(named.into());
    }
    let path = env::var_os("PATH")?;
    let folders: Vec<PathBuf> = env::split_paths(&path).collect();
    let mut all = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    all.find(|file| file.is_file())
}

/// A browser that runs, until this is dropped.
pub(super) struct Browser {
    child: Child,
    to: ChildStdin,
    /// Messages, which a thread reads.
    from: Receiver<Value>,
    last: u64,
}

/// A page in it.
pub(super) struct Page {
    session: String,
}

impl Browser {
    /// Starts it, with a folder for what it keeps.
    ///
    /// # Errors
    /// That of the system.
    pub(super) fn start(program: &Path, own: &Path) -> Result<Self, Box<dyn Error>> {
        // It reads from 3 and writes to 4.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 >/dev/null 2>&1", "sh"])
            .arg(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--hide-scrollbars",
            ])
            .arg("--remote-debugging-pipe")
            .arg(format!("--user-data-dir={}", own.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (to, out) = (child.stdin.take(), child.stdout.take());
        let (to, out) = to.zip(out).ok_or("no pipes to the browser")?;
        let (sender, from) = channel();
        thread::spawn(move || {
            for message in BufReader::new(out).split(0).map_while(Result::ok) {
                let told = serde_json::from_slice(&message).unwrap_or(Value::Null);
                if sender.send(told).is_err() {
                    return;
                }
            }
        });
        Ok(Self {
            child,
            to,
            from,
            last: 0,
        })
    }

    /// Asks for what a method has for an answer.
    fn ask(
        &mut self,
        method: &str,
        with: Value,
        page: Option<&Page>,
    ) -> Result<Value, Box<dyn Error>> {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": with });
        if let Some(page) = page {
            message["sessionId"] = json!(page.session);
        }
        self.to.write_all(format!("{message}\0").as_bytes())?;
        loop {
            let mut told = self
                .from
                .recv_timeout(PATIENCE)
                .map_err(|_| format!("no answer of the browser to {method}"))?;
            if told["id"] == json!(self.last) {
                return match told["error"].take() {
                    Value::Null => Ok(told["result"].take()),
                    error => Err(format!("{method}: {error}").into()),
                };
            }
        }
    }

    /// Opens an address, in a window of so many pixels.
    ///
    /// # Errors
    /// Where the browser refuses, or does not answer.
    pub(super) fn open(
        &mut self,
        address: &str,
        (width, height): (u32, u32),
    ) -> Result<Page, Box<dyn Error>> {
        let target = self.ask("Target.createTarget", json!({ "url": "about:blank" }), None)?;
        let with = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.ask("Target.attachToTarget", with, None)?;
        let session = attached["sessionId"].as_str().ok_or("no page")?.to_owned();
        let page = Page { session };
        let with =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.ask("Emulation.setDeviceMetricsOverride", with, Some(&page))?;
        self.ask("Page.navigate", json!({ "url": address }), Some(&page))?;
        Ok(page)
    }

    /// The value of an expression within a page, as text; empty where it has none yet.
    ///
    /// # Errors
    /// As [`Browser::open`].
    pub(super) fn value(
        &mut self,
        page: &Page,
        expression: &str,
    ) -> Result<String, Box<dyn Error>> {
        let with = json!({ "expression": expression, "returnByValue": true });
        let told = self.ask("Runtime.evaluate", with, Some(page))?;
        Ok(told["result"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned())
    }

    /// The whole page as PNG, in base 64.
    ///
    /// # Errors
    /// As [`Browser::open`].
    pub(super) fn picture(&mut self, page: &Page) -> Result<String, Box<dyn Error>> {
        let size = &self.ask("Page.getLayoutMetrics", json!({}), Some(page))?["cssContentSize"];
        let (width, height) = (&size["width"], &size["height"]);
        let clip = json!({ "x": 0, "y": 0, "width": width, "height": height, "scale": 1 });
        let with = json!({ "captureBeyondViewport": true, "clip": clip });
        let told = self.ask("Page.captureScreenshot", with, Some(page))?;
        Ok(told["data"].as_str().ok_or("no picture")?.to_owned())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It ends by itself when asked; what has ended already cannot be asked.
        if self.ask("Browser.close", json!({}), None).is_err() {
            let _ = self.child.kill();
        }
        let _ = self.child.wait();
    }
}
