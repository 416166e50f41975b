//! The JSON schema of decks against the keys that the reader knows.

use super::{DECK, folder};
use moreau::deck::{SCHEMA, open};
use serde_json::Value;
use std::collections::BTreeSet;

fn schema() -> Value {
    serde_json::from_str(SCHEMA).expect("json")
}

/// Keys that the schema has for an object; the root is "".
fn written(name: &str) -> BTreeSet<String> {
    let schema = schema();
    let object = if name.is_empty() {
        &schema
    } else {
        &schema["$defs"][name]
    };
    let keys = object["properties"].as_object().expect("an object").keys();
    keys.cloned().collect()
}

/// Keys that the reader asks for in tables, as it says when it meets one that it does not know.
fn known(deck: &str) -> BTreeSet<String> {
    let (_, _, findings) = open(deck);
    let mut keys = BTreeSet::new();
    for finding in findings.iter().filter(|f| f.message.contains("\"zzz\"")) {
        let help = finding.help.as_deref().expect("a help");
        let list = help.split_once(" has the keys ").expect("a list").1;
        keys.extend(list.split(", ").map(str::to_owned));
    }
    keys
}

/// Every key that the reader accepts is in the schema, and vice versa.
#[test]
fn the_schema_has_the_keys_of_the_reader() {
    let solid = DECK.replace("analysis = \"plane-strain\"", "analysis = \"solid\"");
    let tool = "plane = { point = [0, 0], normal = [0, 1] }";
    let with = |from: &str, to: &str| {
        assert!(DECK.contains(from), "{from}");
        DECK.replace(from, to)
    };
    let appended = |text: &str| format!("{DECK}{text}\n");
    let step = |key: &str, item: &str| {
        let text = format!("[[step]]\nname = \"b\"\nincrements = 1\n{key} = [{item}]\n");
        with("[expect]", &format!("{text}[expect]"))
    };
    for (name, decks) in [
        ("", vec![with("title =", "zzz = 1\ntitle =")]),
        (
            "mesh",
            vec![with("[[mesh.block]]", "[mesh]\nzzz = 1\n[[mesh.block]]")],
        ),
        (
            "block",
            vec![
                with("element =", "zzz = 1\nelement ="),
                solid.replace("element =", "zzz = 1\nelement ="),
            ],
        ),
        (
            "lines",
            vec![with("x = [0, 50]", "x = { lines = [0, 1], zzz = 1 }")],
        ),
        (
            "group",
            vec![with("on = \"block.top\"", "on = \"block.top\"\nzzz = 1")],
        ),
        ("material", vec![with("young =", "zzz = 1\nyoung =")]),
        (
            "plane",
            vec![with("normal = [0, 1]", "normal = [0, 1], zzz = 1")],
        ),
        (
            "cylinder",
            ["", "solid"]
                .map(|analysis| {
                    let deck = if analysis.is_empty() { DECK } else { &solid };
                    let zero = if analysis.is_empty() {
                        "[0, 0]"
                    } else {
                        "[0, 0, 0]"
                    };
                    let axis = if analysis.is_empty() {
                        ""
                    } else {
                        "axis = [0, 0, 1],"
                    };
                    deck.replace(
                        tool,
                        &format!("cylinder = {{ center = {zero}, {axis} radius = 1, zzz = 1 }}"),
                    )
                })
                .into(),
        ),
        (
            "sphere",
            vec![solid.replace(tool, "sphere = { center = [0, 0, 0], radius = 1, zzz = 1 }")],
        ),
        ("tool", vec![with("[[contact]]", "zzz = 1\n[[contact]]")]),
        (
            "contact",
            vec![with("friction = 0.1", "friction = 0.1\nzzz = 1")],
        ),
        (
            "friction",
            vec![with(
                "friction = 0.1",
                "friction = { coulomb = 0.1, zzz = 1 }",
            )],
        ),
        (
            "step",
            vec![with("increments = 20", "increments = 20\nzzz = 1")],
        ),
        (
            "increments",
            vec![with(
                "increments = 20",
                "increments = { start = 0.1, min = 0.1, max = 0.1, zzz = 1 }",
            )],
        ),
        (
            "fix",
            vec![step("fix", "{ on = \"block\", u = [\"x\"], zzz = 1 }")],
        ),
        (
            "move",
            vec![step("move", "{ on = \"block\", u = { x = 1 }, zzz = 1 }")],
        ),
        (
            "components",
            vec![
                step("move", "{ on = \"block\", u = { x = 1, zzz = 1 } }"),
                solid.replace("u = { y = -0.2 }", "u = { x = 1, zzz = 1 }"),
            ],
        ),
        (
            "load",
            vec![step(
                "load",
                "{ on = \"block.top\", pressure = 1, zzz = 1 }",
            )],
        ),
        (
            "motion",
            vec![step(
                "tools",
                "{ name = \"foundation\", move = [0, 1], zzz = 1 }",
            )],
        ),
        ("solver", vec![appended("[solver]\nzzz = 1")]),
        (
            "method",
            vec![appended(
                "[solver]\ncontact = { penalty = { normal = 1, tangent = 1 }, zzz = 1 }",
            )],
        ),
        (
            "penalty",
            vec![appended(
                "[solver]\ncontact = { penalty = { normal = 1, tangent = 1, zzz = 1 } }",
            )],
        ),
        ("output", vec![appended("[output]\nzzz = 1")]),
        (
            "expectation",
            vec![appended(
                "\"u.punch.y\" = { value = 1, absolute = 1, zzz = 1 }",
            )],
        ),
        (
            "hardening",
            vec![with("300.0", "300.0\nhardening = { linear = 1, zzz = 1 }")],
        ),
        (
            "kinematic",
            vec![with(
                "300.0",
                "300.0\nkinematic = [{ modulus = 1, zzz = 1 }]",
            )],
        ),
    ] {
        let known: BTreeSet<String> = decks.iter().flat_map(|deck| known(deck)).collect();
        assert_eq!(known, written(name), "{name:?}");
    }
}

/// Whether a value is as a part of the schema says: types, keys, references, choices.
fn fits(value: &Value, part: &Value, root: &Value) -> Result<(), String> {
    if let Some(name) = part["$ref"]
        .as_str()
        .and_then(|r| r.strip_prefix("#/$defs/"))
    {
        return fits(value, &root["$defs"][name], root);
    }
    let wrong = || Err(format!("{value} is not {part}"));
    if let Some(choices) = part["enum"].as_array()
        && !choices.contains(value)
    {
        return wrong();
    }
    let typed = match part["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_u64() || value.is_i64(),
        Some("boolean") => value.is_boolean(),
        _ => true,
    };
    if !typed {
        return wrong();
    }
    if let Some(options) = part["oneOf"].as_array() {
        // Alternatives of keys are about which are there, the others about what a value is.
        let there = |o: &Value| {
            o["required"].as_array().is_some_and(|r| {
                r.iter()
                    .all(|k| k.as_str().is_some_and(|k| value.get(k).is_some()))
            })
        };
        let fitting = options
            .iter()
            .filter(|o| match part["properties"].is_object() {
                true => there(o),
                false => fits(value, o, root).is_ok(),
            });
        if fitting.count() != 1 {
            return wrong();
        }
    }
    for key in part["required"].as_array().into_iter().flatten() {
        if key.as_str().is_some_and(|key| value.get(key).is_none()) {
            return Err(format!("{value} has no {key}"));
        }
    }
    for (key, inner) in value.as_object().into_iter().flatten() {
        let rest = &part["additionalProperties"];
        match (&part["properties"][key], rest) {
            (Value::Null, Value::Object(_)) => fits(inner, rest, root)?,
            (Value::Null, Value::Bool(false)) => return Err(format!("unknown key {key}")),
            (own, _) => fits(inner, own, root)?,
        }
    }
    for inner in value.as_array().into_iter().flatten() {
        fits(inner, &part["items"], root)?;
    }
    Ok(())
}

#[test]
fn the_examples_fit_the_schema() {
    let root = schema();
    let read = |text: &str| -> Value {
        let table: toml::Table = text.parse().expect("toml");
        serde_json::to_value(table).expect("json")
    };
    let mut count = 0;
    for entry in std::fs::read_dir(folder("docs/examples")).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "toml") {
            let deck = read(&std::fs::read_to_string(&path).expect("a deck"));
            fits(&deck, &root, &root).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            count += 1;
        }
    }
    assert!(count >= 6);
    for (from, to) in [
        ("quad8", "quad7"),
        ("poisson", "poison"),
        ("increments = 20", "increments = \"20\""),
        ("y = -0.2", "w = -0.2"),
        ("plane =", "inside = true #"),
    ] {
        assert!(DECK.contains(from));
        assert!(
            fits(&read(&DECK.replace(from, to)), &root, &root).is_err(),
            "{to}"
        );
    }
}
