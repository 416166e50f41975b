//! `cargo xtask docs`: the pages that are written from what they describe, and the check that they are as that is now; not
//! the pages that people write.

mod deck;

use std::error::Error;
use std::fs;

use verification::workspace;

/// Arguments of `docs`.
#[derive(clap::Args)]
pub struct Args {
    /// Write nothing; fail where a page is not what would be written
    #[arg(long)]
    check: bool,
}

/// Writes the pages, or checks them; `Ok(false)` where one is not as it should be.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let root = workspace::root();
    let schema = serde_json::from_str(&fs::read_to_string(root.join("docs/deck.schema.json"))?)?;
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
    let mut good = true;
    for lack in deck::lacks(&keys) {
        println!("docs/deck.schema.json: {lack}");
        good = false;
    }
    let path = root.join("docs/reference/deck.md");
    let page = deck::page(&schema, &keys);
    if args.check {
        if fs::read_to_string(&path).unwrap_or_default() != page {
            println!("docs/reference/deck.md is not that of the schema: run `cargo xtask docs`");
            good = false;
        }
    } else {
        fs::create_dir_all(path.parent().unwrap_or(&root))?;
        fs::write(&path, page)?;
    }
    if good {
        println!("✓ docs: {} keys", keys.len());
    }
    Ok(good)
}
