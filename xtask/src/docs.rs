//! `cargo xtask docs`: the pages and pictures that are written from what they describe, and the check that they are as
//! that is now; not the pages that people write.

mod command;
mod deck;
mod described;
mod results;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use verification::workspace;

/// Arguments of `docs`.
#[derive(clap::Args)]
pub struct Args {
    /// Write nothing; fail where a page is not what would be written
    #[arg(long)]
    check: bool,
    /// What `cargo run -p moreau --example reference` printed, where it is built already.
    #[arg(long, value_name = "FILE")]
    described: Option<PathBuf>,
}

/// A page, and what keeps it from being complete.
struct Page {
    /// The file, from the folder of the pages.
    name: String,
    text: String,
    /// What the page is written from, for whoever has to mend it.
    of: &'static str,
    lacks: Vec<String>,
}

/// Writes the pages, or checks them; `Ok(false)` where one is not as it should be.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let root = workspace::root();
    let folder = root.join("docs");
    let pages = pages(&root, args.described.as_deref())?;
    let mut good = true;
    for page in &pages {
        for lack in &page.lacks {
            println!("{}: {lack}", page.of);
            good = false;
        }
        let path = folder.join(&page.name);
        if !args.check {
            fs::create_dir_all(path.parent().unwrap_or(&folder))?;
            fs::write(&path, &page.text)?;
        } else if fs::read_to_string(&path).unwrap_or_default() != page.text {
            let (name, of) = (&page.name, page.of);
            println!("docs/{name} is not that of {of}: run `cargo xtask docs`");
            good = false;
        }
    }
    if good {
        println!("✓ docs: {} pages and pictures", pages.len());
    }
    Ok(good)
}

/// All pages.
fn pages(root: &Path, printed: Option<&Path>) -> Result<Vec<Page>, Box<dyn Error>> {
    let told = described::described(printed)?;
    let of_results = |name: &str,
                      of,
                      entries: &[described::Entry],
                      text: fn(&[described::Entry]) -> String| Page {
        name: format!("reference/{name}"),
        text: text(entries),
        of,
        lacks: results::lacks(entries),
    };
    let curves = verification::curves::all()?.into_iter().map(|figure| Page {
        name: format!("theory/{}.svg", figure.name),
        text: figure.svg,
        of: "the curves of the laws, tests/src/curves.rs",
        lacks: Vec::new(),
    });
    let mut pages = vec![
        of_deck(root)?,
        of_results(
            "history.md",
            "the table of history.csv",
            &told.history,
            results::history,
        ),
        of_results(
            "contact.md",
            "the table of contact.csv",
            &told.contact,
            results::contact,
        ),
        of_results(
            "run-json.md",
            "the table of run.json",
            &told.run,
            results::run,
        ),
        Page {
            name: "reference/command.md".to_owned(),
            text: command::page(&told.command),
            of: "the command line",
            lacks: command::lacks(&told.command),
        },
    ];
    pages.extend(curves);
    Ok(pages)
}

/// The page of the keys of decks.
fn of_deck(root: &Path) -> Result<Page, Box<dyn Error>> {
    let of = "docs/deck.schema.json";
    let schema = serde_json::from_str(&fs::read_to_string(root.join(of))?)?;
    let mut decks = Vec::new();
    for folder in ["docs/examples", "docs/large"] {
        for entry in fs::read_dir(root.join(folder))? {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "toml") {
                let name = path.file_name().unwrap_or_default();
                let text = fs::read_to_string(&path)?;
                decks.push((name.to_string_lossy().into_owned(), text.parse()?));
            }
        }
    }
    decks.sort_by(|a: &(String, toml::Table), b| a.0.cmp(&b.0));
    let keys = deck::keys(&schema, &decks);
    Ok(Page {
        name: "reference/deck.md".to_owned(),
        text: deck::page(&schema, &keys),
        of,
        lacks: deck::lacks(&keys),
    })
}
