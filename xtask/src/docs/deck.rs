//! The reference of all keys of decks, from their schema and from the decks of the repository; not the schema's own
//! correctness, which is a test of the crate that reads decks.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The tables of a deck in the order of the page: the name of the definition, and how a deck writes it.
const TABLES: [(&str, &str); 33] = [
    ("", "The deck"),
    ("mesh", "[mesh]"),
    ("part", "[[mesh.part]]"),
    ("block", "[[mesh.block]]"),
    ("lines", "x = { … } of a block"),
    ("group", "[[mesh.group]]"),
    ("material", "[[material]]"),
    ("hardening", "hardening = { … }"),
    ("kinematic", "kinematic = [{ … }]"),
    ("orthotropic", "orthotropic = { … }"),
    ("hill", "hill = { … }"),
    ("initial", "[[initial]]"),
    ("tool", "[[tool]]"),
    ("plane", "plane = { … }"),
    ("cylinder", "cylinder = { … }"),
    ("sphere", "sphere = { … }"),
    ("profile", "profile = { … }"),
    ("surface", "surface = { … } of a tool"),
    ("contact", "[[contact]]"),
    ("friction", "friction = { … }"),
    ("tie", "[[tie]]"),
    ("step", "[[step]]"),
    ("increments", "increments = { … }"),
    ("fix", "fix = [{ … }]"),
    ("move", "move = [{ … }]"),
    ("components", "u = { … } of move"),
    ("load", "load = [{ … }]"),
    ("motion", "tools = [{ … }]"),
    ("solver", "[solver]"),
    ("method", "contact = { … } of the solver"),
    ("penalty", "penalty = { … }"),
    ("output", "[output]"),
    ("expectation", "[expect]"),
];

/// Definitions that add conditions to others and keys to none.
const CONDITIONS: [&str; 2] = ["in-the-plane", "in-space"];

/// A key of a table.
pub struct Key {
    table: String,
    name: String,
    required: bool,
    kind: String,
    default: Option<String>,
    description: String,
    equation: Option<String>,
    /// As some deck has it, the shortest; with the name of that deck, if it is one of the repository.
    example: Option<(String, Option<String>)>,
}

/// All keys, table by table.
pub fn keys(schema: &Value, decks: &[(String, toml::Table)]) -> Vec<Key> {
    let mut examples = BTreeMap::new();
    for (name, deck) in decks {
        let deck = toml::Value::Table(deck.clone());
        collect(schema, schema, "", &deck, name, &mut examples);
    }
    let mut keys = Vec::new();
    for (table, part) in parts(schema) {
        for (name, key) in part["properties"].as_object().into_iter().flatten() {
            let text = |keyword: &str| key[keyword].as_str().map(str::to_owned);
            // Of the deck where it includes nothing.
            let given = [&part["required"], &part["then"]["required"]];
            let mut required = given.into_iter().filter_map(Value::as_array).flatten();
            let own = key["examples"].as_array().and_then(|list| list.first());
            let own = own.and_then(|value| toml::Value::try_from(value).ok());
            let own = own.map(|value| (inline(&value), None));
            let found = examples.remove(&(table.clone(), name.clone()));
            keys.push(Key {
                required: required.any(|r| r == name.as_str()),
                kind: kind(key),
                default: key.get("default").map(json),
                description: text("description").unwrap_or_default(),
                equation: text("x-equation"),
                example: found.map(|(value, deck)| (value, Some(deck))).or(own),
                table: table.clone(),
                name: name.clone(),
            });
        }
    }
    keys
}

/// The tables of the schema with their definitions, in the order of the page, and after them any that it does not know.
fn parts(schema: &Value) -> Vec<(String, &Value)> {
    let known = TABLES.iter().map(|(name, _)| (*name).to_owned());
    let all = schema["$defs"].as_object().into_iter().flatten();
    let unknown = all.filter(|(name, part)| {
        let known = TABLES.iter().any(|(known, _)| known == name);
        !known && !CONDITIONS.contains(&name.as_str()) && part["properties"].is_object()
    });
    let unknown: Vec<String> = unknown.map(|(name, _)| name.clone()).collect();
    let part = |name: String| match name.as_str() {
        "" => (name, schema),
        _ => {
            let part = &schema["$defs"][&name];
            (name, part)
        }
    };
    known.chain(unknown).map(part).collect()
}

/// What keys lack.
pub fn lacks(keys: &[Key]) -> Vec<String> {
    let mut lacks = Vec::new();
    for key in keys {
        let name = match key.table.as_str() {
            "" => key.name.clone(),
            table => format!("{table}.{}", key.name),
        };
        if key.description.is_empty() {
            lacks.push(format!("{name} has no description"));
        }
        if key.example.is_none() {
            lacks.push(format!(
                "{name} is in no deck of docs/examples or docs/large, and has no \"examples\""
            ));
        }
        if !TABLES.iter().any(|(table, _)| *table == key.table) {
            lacks.push(format!("{name} is in a table that the page does not know"));
        }
    }
    lacks
}

/// The page.
pub fn page(schema: &Value, keys: &[Key]) -> String {
    let mut page = String::from(
        "# All keys of a deck\n\nWritten by `cargo xtask docs` from the [schema](../deck.schema.json), with examples from the \
         decks of [docs/examples](../examples). Lengths, forces and stresses are in the units of the deck. Any number may be a \
         formula of `[parameters]`, as in `\"= mu / 2\"`.\n",
    );
    for (table, title) in TABLES {
        let own: Vec<&Key> = keys.iter().filter(|key| key.table == table).collect();
        if own.is_empty() {
            continue;
        }
        let part = match table {
            "" => schema,
            _ => &schema["$defs"][table],
        };
        let _ = write!(page, "\n<a id=\"{}\"></a>\n\n## {title}\n", of_table(table));
        if let Some(about) = part["description"].as_str() {
            let _ = write!(page, "\n{about}\n");
        }
        page.push_str("\n| key | value | default | meaning | example |\n|---|---|---|---|---|\n");
        for key in own {
            let _ = writeln!(page, "{}", row(key));
        }
    }
    page
}

/// Where a table is on the page.
fn of_table(table: &str) -> String {
    format!("table-{}", if table.is_empty() { "deck" } else { table })
}

/// Where a key is on the page.
fn anchor(table: &str, key: &str) -> String {
    let parts = ["deck", table, key]
        .into_iter()
        .filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-")
}

fn row(key: &Key) -> String {
    let default = match (&key.default, key.required) {
        (_, true) => "needed".to_owned(),
        (Some(value), _) => format!("`{value}`"),
        (None, _) => String::new(),
    };
    let equation = key.equation.as_deref();
    let equation = equation.map_or(String::new(), |e| format!(" `{}`", e.replace('|', "\\|")));
    let example = match &key.example {
        Some((value, Some(deck))) => {
            let stem = deck.trim_end_matches(".toml");
            format!("`{} = {value}` ({stem})", key.name)
        }
        Some((value, None)) => format!("`{} = {value}`", key.name),
        None => String::new(),
    };
    format!(
        "| <a id=\"{}\"></a>`{}` | {} | {default} | {}{equation} | {} |",
        anchor(&key.table, &key.name),
        key.name,
        key.kind,
        key.description.replace('|', "\\|"),
        example.replace('|', "\\|"),
    )
}

/// What a value is, in words.
fn kind(part: &Value) -> String {
    if let Some(name) = part["$ref"].as_str() {
        let name = name.trim_start_matches("#/$defs/");
        return match TABLES.iter().find(|(table, _)| *table == name) {
            Some(_) => format!("[table](#{})", of_table(name)),
            None => match name {
                "vector" | "direction" => "2 or 3 numbers".into(),
                "range" => "[from, to]".into(),
                "grid" => "[from, to] or table".into(),
                "turn" => "number or table".into(),
                "amplitude" => "list of [time, share]".into(),
                other => other.to_owned(),
            },
        };
    }
    if let Some(choices) = part["enum"].as_array() {
        let all: Vec<String> = choices.iter().map(|c| format!("`{}`", json(c))).collect();
        return all.join(", ");
    }
    for several in ["oneOf", "anyOf"] {
        if let Some(all) = part[several].as_array() {
            let all: Vec<String> = all.iter().map(kind).collect();
            return all.join(" or ");
        }
    }
    let types = match &part["type"] {
        Value::Array(list) => list.first().and_then(Value::as_str),
        one => one.as_str(),
    };
    match types {
        Some("array") => format!("list of {}", kind(&part["items"])),
        Some("string") => "text".into(),
        Some("boolean") => "true or false".into(),
        Some("integer") => format!("integer{}", bounds(part)),
        Some("number") => format!("number{}", bounds(part)),
        Some("object") => "table".into(),
        _ => "value".into(),
    }
}

fn bounds(part: &Value) -> String {
    let bound = |keyword: &str, sign: &str| {
        let value = part[keyword].as_f64()?;
        Some(format!("{sign} {value}"))
    };
    let all = [
        bound("minimum", "≥"),
        bound("exclusiveMinimum", ">"),
        bound("maximum", "≤"),
        bound("exclusiveMaximum", "<"),
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    match all.is_empty() {
        true => String::new(),
        false => format!(" {}", all.join(", ")),
    }
}

/// Examples by table and key: the shortest value of each, with the deck that it is from.
type Examples = BTreeMap<(String, String), (String, String)>;

/// Takes the keys of a value that a part of the schema describes as examples.
fn collect(
    schema: &Value,
    part: &Value,
    table: &str,
    value: &toml::Value,
    deck: &str,
    examples: &mut Examples,
) {
    if let Some(name) = part["$ref"].as_str() {
        let name = name.trim_start_matches("#/$defs/");
        collect(schema, &schema["$defs"][name], name, value, deck, examples);
    }
    for several in ["oneOf", "anyOf"] {
        for part in part[several].as_array().into_iter().flatten() {
            collect(schema, part, table, value, deck, examples);
        }
    }
    match value {
        toml::Value::Array(list) => {
            for item in list {
                collect(schema, &part["items"], table, item, deck, examples);
            }
        }
        toml::Value::Table(own) => {
            for (key, value) in own {
                let inner = match part["properties"].get(key) {
                    Some(inner) => {
                        let shown = (inline(value), deck.to_owned());
                        let at = (table.to_owned(), key.clone());
                        let kept = examples.entry(at).or_insert_with(|| shown.clone());
                        if shown.0.len() < kept.0.len() {
                            *kept = shown;
                        }
                        inner
                    }
                    None => &part["additionalProperties"],
                };
                collect(schema, inner, table, value, deck, examples);
            }
        }
        _ => {}
    }
}

/// A value on one line.
fn inline(value: &toml::Value) -> String {
    match value {
        toml::Value::Array(list) => {
            let items: Vec<String> = list.iter().map(inline).collect();
            format!("[{}]", items.join(", "))
        }
        toml::Value::Table(table) => {
            let items = table.iter().map(|(key, value)| {
                let plain = key.chars().all(|c| c.is_alphanumeric() || "-_".contains(c));
                let key = if plain {
                    key.clone()
                } else {
                    format!("\"{key}\"")
                };
                format!("{key} = {}", inline(value))
            });
            format!("{{ {} }}", items.collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// A value of the schema as a deck writes it.
fn json(value: &Value) -> String {
    value.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn schema() -> Value {
        json!({
            "properties": {
                "tool": { "type": "array", "items": { "$ref": "#/$defs/tool" }, "description": "Tools." },
            },
            "required": ["tool"],
            "$defs": { "tool": { "properties": {
                "name": { "type": "string", "description": "Name." },
                "radius": { "type": ["number", "string"], "minimum": 0, "description": "Radius |r|." },
            }}},
        })
    }

    fn of(deck: &str) -> Vec<Key> {
        keys(
            &schema(),
            &[("a.toml".into(), deck.parse().expect("a deck"))],
        )
    }

    #[test]
    fn keys_have_the_shortest_example() {
        let keys = of("tool = [{ name = \"long\", radius = 10 }, { name = \"b\", radius = 2.5 }]");
        assert!(lacks(&keys).is_empty());
        let page = page(&schema(), &keys);
        assert!(page.contains("`name = \"b\"` (a)"), "{page}");
        assert!(
            page.contains("| number ≥ 0 |  | Radius \\|r\\|. | `radius = 10` (a) |"),
            "{page}"
        );
        assert!(
            page.contains("| list of [table](#table-tool) | needed |"),
            "{page}"
        );
    }

    #[test]
    fn what_lacks_is_told() {
        let keys = of("tool = [{ name = \"b\" }]");
        let lacks = lacks(&keys);
        assert_eq!(lacks.len(), 1);
        assert!(lacks[0].starts_with("tool.radius is in no deck"));
    }
}
