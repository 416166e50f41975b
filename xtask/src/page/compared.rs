//! The loads of the page beside those of the command for the decks that the page says it ran: equal in all digits.

use std::error::Error;
use std::fs;
use std::path::Path;

use super::browser::Browser;
use verification::scratch::Scratch;

/// Choices, as the address of the page has them: the paper's, and one for each way that differs.
const CHOICES: [&str; 4] = [
    "",
    "friction=0.25&cells=3",
    "cells=2&algorithm=gauss-seidel",
    "friction=0.3&algorithm=outside",
];

/// Compares; `Ok(false)` where a load differs.
pub(super) fn run(root: &Path, page: &Path) -> Result<bool, Box<dyn Error>> {
    let Some(browser) = Browser::found() else {
        println!(
            "– page: not opened, there is no Chromium; CHROMIUM names one that is not on the path"
        );
        return Ok(true);
    };
    let scratch = Scratch::new()?;
    let mut good = true;
    for (k, choice) in CHOICES.into_iter().enumerate() {
        let dom = browser.opened(page, choice, &scratch.path().join(format!("browser-{k}")))?;
        let state = between(&dom, "data-state=\"", "\"").unwrap_or("not begun");
        if state != "done" {
            println!("✗ page #{choice}: {state}");
            good = false;
            continue;
        }
        let told = between(&dom, "id=\"load\" data-value=\"", "\"");
        let deck = between(&dom, "<pre id=\"deck\">", "</pre>");
        let (told, deck) = told.zip(deck).ok_or("the page shows no load")?;
        scratch.write(&format!("{k}.toml"), &unescaped(deck))?;
        let native = native(root, scratch.path(), k)?;
        let equal = told.parse::<f64>()?.to_bits() == native.to_bits();
        let sign = if equal { '✓' } else { '✗' };
        println!("{sign} page #{choice}: load {told}, of the command {native}");
        good &= equal;
    }
    Ok(good)
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

/// What stands between two texts.
fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let rest = text.split_once(before)?.1;
    Some(rest.split_once(after)?.0)
}

/// Text as it was before it became that of an element.
fn unescaped(text: &str) -> String {
    let signs = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&nbsp;", "\u{a0}"),
        ("&amp;", "&"),
    ];
    let replaced = |text: String, (name, sign): (&str, &str)| text.replace(name, sign);
    signs.into_iter().fold(text.to_owned(), replaced)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_taken_out_of_elements() {
        let dom = "<pre id=\"deck\">a &lt; b &amp;amp; c</pre>";
        let deck = between(dom, "<pre id=\"deck\">", "</pre>").map(unescaped);
        assert_eq!(deck.as_deref(), Some("a < b &amp; c"));
        assert_eq!(between(dom, "<p>", "</p>"), None);
    }
}
