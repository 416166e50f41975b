//! The JSON schema of decks against the keys that the reader knows.

use super::{DECK, folder};
use moreau::deck::{SCHEMA, open};
use serde_json::Value;
use std::collections::BTreeSet;

pub(super) fn schema() -> Value {
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

/// The deck of the tests with one text in the place of another.
fn with(from: &str, to: &str) -> String {
    assert!(DECK.contains(from), "{from}");
    DECK.replace(from, to)
}

/// [`with`], of a deck in space.
fn solid_with(from: &str, to: &str) -> String {
    assert!(DECK.contains(from), "{from}");
    with("analysis = \"plane-strain\"", "analysis = \"solid\"").replace(from, to)
}

fn appended(text: &str) -> String {
    format!("{DECK}{text}\n")
}

/// Decks with a key that nobody knows in a table of the bodies and the tools.
fn unknown_key_in_model(table: &str) -> Option<Vec<String>> {
    let tool = "plane = { point = [0, 0], normal = [0, 1] }";
    Some(match table {
        "" => vec![with("title =", "zzz = 1\ntitle =")],
        "mesh" => vec![with("[[mesh.block]]", "[mesh]\nzzz = 1\n[[mesh.block]]")],
        "part" => vec![with(
            "[[mesh.block]]",
            "[[mesh.part]]\nfile = \"none.msh\"\nzzz = 1\n[[mesh.block]]",
        )],
        "block" => vec![
            with("element =", "zzz = 1\nelement ="),
            solid_with("element =", "zzz = 1\nelement ="),
        ],
        "lines" => vec![with("x = [0, 50]", "x = { lines = [0, 1], zzz = 1 }")],
        "group" => vec![with("on = \"block.top\"", "on = \"block.top\"\nzzz = 1")],
        "material" => vec![with("young =", "zzz = 1\nyoung =")],
        "orthotropic" => vec![with(
            "young = 210000.0",
            "orthotropic = { young = [1, 1, 1], poisson = [0, 0, 0], shear = [1, 1, 1], zzz = 1 }",
        )],
        "hill" => vec![with("300.0", "300.0\nhill = { f = 1, zzz = 1 }")],
        "hardening" => vec![with("300.0", "300.0\nhardening = { linear = 1, zzz = 1 }")],
        "kinematic" => vec![with(
            "300.0",
            "300.0\nkinematic = [{ modulus = 1, zzz = 1 }]",
        )],
        "initial" => vec![with(
            "[[contact]]",
            "[[initial]]\non = \"block\"\np = 0\nzzz = 1\n[[contact]]",
        )],
        "tool" => vec![with("[[contact]]", "zzz = 1\n[[contact]]")],
        "plane" => vec![with("normal = [0, 1]", "normal = [0, 1], zzz = 1")],
        "cylinder" => vec![
            with(tool, "cylinder = { center = [0, 0], radius = 1, zzz = 1 }"),
            solid_with(
                tool,
                "cylinder = { center = [0, 0, 0], axis = [0, 0, 1], radius = 1, zzz = 1 }",
            ),
        ],
        "profile" => vec![with(
            tool,
            "profile = { points = [[9, 0], [0, 0]], radii = [], zzz = 1 }",
        )],
        "surface" => vec![solid_with(
            tool,
            "surface = { file = \"none.stl\", zzz = 1 }",
        )],
        "sphere" => vec![solid_with(
            tool,
            "sphere = { center = [0, 0, 0], radius = 1, zzz = 1 }",
        )],
        "contact" => vec![with("friction = 0.1", "friction = 0.1\nzzz = 1")],
        "tie" => vec![with(
            "[[contact]]",
            "[[tie]]\nsurface = \"a\"\nto = \"b\"\nzzz = 1\n[[contact]]",
        )],
        "friction" => vec![with(
            "friction = 0.1",
            "friction = { coulomb = 0.1, zzz = 1 }",
        )],
        _ => return None,
    })
}

/// Decks with a key that nobody knows in a table of the steps.
fn unknown_key_in_steps(table: &str) -> Option<Vec<String>> {
    let step = |key: &str, item: &str| {
        let text = format!("[[step]]\nname = \"b\"\nincrements = 1\n{key} = [{item}]\n");
        with("[expect]", &format!("{text}[expect]"))
    };
    Some(match table {
        "step" => vec![with("increments = 20", "increments = 20\nzzz = 1")],
        "increments" => vec![with(
            "increments = 20",
            "increments = { start = 0.1, min = 0.1, max = 0.1, zzz = 1 }",
        )],
        "fix" => vec![step("fix", "{ on = \"block\", u = [\"x\"], zzz = 1 }")],
        "move" => vec![step("move", "{ on = \"block\", u = { x = 1 }, zzz = 1 }")],
        "components" => vec![
            step("move", "{ on = \"block\", u = { x = 1, zzz = 1 } }"),
            solid_with("u = { y = -0.2 }", "u = { x = 1, zzz = 1 }"),
        ],
        "load" => vec![step(
            "load",
            "{ on = \"block.top\", pressure = 1, zzz = 1 }",
        )],
        "motion" => vec![step(
            "tools",
            "{ name = \"foundation\", move = [0, 1], zzz = 1 }",
        )],
        _ => return None,
    })
}

/// Decks with a key that nobody knows in a table of the solver, the output and what is expected.
fn unknown_key_in_settings(table: &str) -> Option<Vec<String>> {
    let text = match table {
        "solver" => "[solver]\nzzz = 1",
        "method" => "[solver]\ncontact = { penalty = { normal = 1, tangent = 1 }, zzz = 1 }",
        "penalty" => "[solver]\ncontact = { penalty = { normal = 1, tangent = 1, zzz = 1 } }",
        "output" => "[output]\nzzz = 1",
        "expectation" => "\"u.punch.y\" = { value = 1, absolute = 1, zzz = 1 }",
        _ => return None,
    };
    Some(vec![appended(text)])
}

/// Every key that the reader accepts is in the schema, and vice versa.
#[test]
fn the_schema_has_the_keys_of_the_reader() {
    let schema = schema();
    let objects = schema["$defs"].as_object().expect("definitions").iter();
    let objects = objects.filter(|(_, part)| part["additionalProperties"] == false);
    for table in objects.map(|(name, _)| name.as_str()).chain([""]) {
        let decks = unknown_key_in_model(table)
            .or_else(|| unknown_key_in_steps(table))
            .or_else(|| unknown_key_in_settings(table))
            .unwrap_or_else(|| panic!("no deck for the table {table:?}"));
        let known: BTreeSet<String> = decks.iter().flat_map(|deck| known(deck)).collect();
        assert_eq!(known, written(table), "{table:?}");
    }
}

/// What tells, and asks for nothing.
const ABOUT: [&str; 7] = [
    "default",
    "$schema",
    "$defs",
    "title",
    "description",
    "examples",
    "x-equation",
];
/// The patterns: those of names, of formulas, and of the names of parameters.
const NAME: &str = "^[^\\s!-,/:-@\\[-^`{-~]+$";
const FORMULA: &str = "^=";
const PARAMETER: &str = "^\\p{L}[\\p{L}\\p{N}_]*$";

/// Whether a value is as a part of the schema says: every keyword in it, as draft 2020-12 has them.
pub(super) fn fits(value: &Value, part: &Value, root: &Value) -> Result<(), String> {
    let keywords = part.as_object().into_iter().flatten();
    for (keyword, asked) in keywords.filter(|(k, _)| !ABOUT.contains(&k.as_str())) {
        let holds = match value {
            _ if ANY.contains(&keyword.as_str()) => of_any(value, (keyword, asked), part, root),
            Value::Object(_) => of_object(value, (keyword, asked), part, root),
            Value::Array(_) => of_array(value, (keyword, asked), part, root),
            Value::Number(_) => Ok(of_number(value, (keyword, asked))),
            Value::String(text) if keyword == "pattern" => Ok(matches(text, asked)),
            _ => Ok(true),
        };
        if !holds? {
            return Err(format!("{value} is not of {keyword}: {asked}"));
        }
    }
    Ok(())
}

/// Keywords that ask something of values of every kind.
const ANY: [&str; 11] = [
    "$ref", "type", "enum", "const", "allOf", "anyOf", "oneOf", "not", "if", "then", "else",
];

type Keyword<'a> = (&'a String, &'a Value);

fn of_any(
    value: &Value,
    (keyword, asked): Keyword<'_>,
    part: &Value,
    root: &Value,
) -> Result<bool, String> {
    let fit = |part: &Value| fits(value, part, root).is_ok();
    let list = || asked.as_array().into_iter().flatten();
    // Numbers are equal if their values are.
    let equal = |a: &Value| a == value || a.is_number() && a.as_f64() == value.as_f64();
    Ok(match keyword.as_str() {
        "$ref" => {
            let name = asked.as_str().and_then(|r| r.strip_prefix("#/$defs/"));
            return fits(value, &root["$defs"][name.expect("a reference")], root).map(|()| true);
        }
        "type" if asked.is_array() => list().any(|asked| is_of(value, asked)),
        "type" => is_of(value, asked),
        "enum" => list().any(equal),
        "const" => equal(asked),
        "allOf" => {
            for part in list() {
                fits(value, part, root)?;
            }
            true
        }
        "anyOf" => list().any(fit),
        "oneOf" => list().filter(|part| fit(part)).count() == 1,
        "not" => !fit(asked),
        "if" => {
            let then = if fit(asked) { "then" } else { "else" };
            return part
                .get(then)
                .map_or(Ok(true), |t| fits(value, t, root).map(|()| true));
        }
        _ => true,
    })
}

fn is_of(value: &Value, asked: &Value) -> bool {
    match asked.as_str().expect("a type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        other => panic!("the type {other}"),
    }
}

fn of_object(
    value: &Value,
    (keyword, asked): Keyword<'_>,
    part: &Value,
    root: &Value,
) -> Result<bool, String> {
    let object = value.as_object().expect("an object");
    let all = |keys: &Value| {
        let keys = keys.as_array().into_iter().flatten();
        keys.filter_map(Value::as_str)
            .all(|k| object.contains_key(k))
    };
    let count = asked.as_u64().unwrap_or_default();
    Ok(match keyword.as_str() {
        "required" => all(asked),
        "dependentRequired" => {
            let mut rules = asked.as_object().expect("rules").iter();
            rules.all(|(key, needs)| !object.contains_key(key) || all(needs))
        }
        "minProperties" => object.len() as u64 >= count,
        "maxProperties" => object.len() as u64 <= count,
        "propertyNames" => {
            let mut names = object.keys();
            names.all(|name| fits(&Value::from(name.as_str()), asked, root).is_ok())
        }
        "properties" => {
            for (key, inner) in object {
                fits(inner, &asked[key], root).map_err(|e| format!("{key}: {e}"))?;
            }
            true
        }
        "additionalProperties" => {
            for (key, inner) in object
                .iter()
                .filter(|(k, _)| part["properties"][k].is_null())
            {
                if asked == &Value::Bool(false) {
                    return Err(format!("unknown key {key}"));
                }
                fits(inner, asked, root)?;
            }
            true
        }
        other => of_another_kind(other),
    })
}

fn of_array(
    value: &Value,
    (keyword, asked): Keyword<'_>,
    part: &Value,
    root: &Value,
) -> Result<bool, String> {
    let list = value.as_array().expect("an array");
    let count = asked.as_u64().unwrap_or_default();
    let first = |part: &Value| part.as_array().map_or(0, Vec::len);
    Ok(match keyword.as_str() {
        "minItems" => list.len() as u64 >= count,
        "uniqueItems" => (1..list.len()).all(|k| !list[..k].contains(&list[k])),
        "maxItems" => list.len() as u64 <= count,
        "items" => {
            for inner in list.iter().skip(first(&part["prefixItems"])) {
                fits(inner, asked, root)?;
            }
            true
        }
        "prefixItems" => {
            for (inner, part) in list.iter().zip(asked.as_array().expect("parts")) {
                fits(inner, part, root)?;
            }
            true
        }
        "contains" => {
            let found = list.iter().filter(|v| fits(v, asked, root).is_ok()).count() as u64;
            let bound = |key: &str, default| part[key].as_u64().unwrap_or(default);
            (bound("minContains", 1)..=bound("maxContains", u64::MAX)).contains(&found)
        }
        "minContains" | "maxContains" => true,
        other => of_another_kind(other),
    })
}

fn of_number(value: &Value, (keyword, asked): Keyword<'_>) -> bool {
    let value = value.as_f64().expect("a number");
    let bound = || asked.as_f64().expect("a bound");
    match keyword.as_str() {
        "minimum" => value >= bound(),
        "maximum" => value <= bound(),
        "exclusiveMinimum" => value > bound(),
        "exclusiveMaximum" => value < bound(),
        other => of_another_kind(other),
    }
}

fn matches(text: &str, pattern: &Value) -> bool {
    let sign = |c: char| c.is_ascii_punctuation() && !"-_.".contains(c);
    match pattern.as_str().expect("a pattern") {
        NAME => !text.is_empty() && !text.chars().any(|c| c.is_whitespace() || sign(c)),
        FORMULA => text.starts_with('='),
        PARAMETER => {
            let of_name = |c: char| c.is_alphanumeric() || c == '_';
            text.starts_with(char::is_alphabetic) && text.chars().all(of_name)
        }
        other => panic!("a pattern that this test does not know: {other}"),
    }
}

/// A keyword that asks nothing of a value of this kind. One that is not known here would pass unseen.
fn of_another_kind(keyword: &str) -> bool {
    const KNOWN: [&str; 20] = [
        "required",
        "dependentRequired",
        "minProperties",
        "maxProperties",
        "properties",
        "additionalProperties",
        "minItems",
        "maxItems",
        "uniqueItems",
        "items",
        "prefixItems",
        "contains",
        "minContains",
        "maxContains",
        "minimum",
        "maximum",
        "exclusiveMinimum",
        "exclusiveMaximum",
        "pattern",
        "$comment",
    ];
    assert!(KNOWN.contains(&keyword), "the keyword {keyword}");
    true
}

/// A deck as a schema sees it.
pub(super) fn read(text: &str) -> Value {
    let table: toml::Table = text.parse().expect("toml");
    serde_json::to_value(table).expect("json")
}

/// Every example and default in a part of the schema is as it says itself.
fn examples_fit(part: &Value, root: &Value) {
    let given = part["examples"].as_array().into_iter().flatten();
    for example in given.chain(part.get("default")) {
        fits(example, part, root).unwrap_or_else(|e| panic!("{example}: {e}"));
    }
    let inner = part.as_object().into_iter().flat_map(|o| o.values());
    for part in inner.chain(part.as_array().into_iter().flatten()) {
        examples_fit(part, root);
    }
}

#[test]
fn the_examples_fit_the_schema() {
    let root = schema();
    examples_fit(&root, &root);
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
