//! `[[step]]`: increments and conditions as they are given.

use crate::deck::entries::{Action, ConditionEntry, MomentEntry, StepEntry, TurnEntry};
use crate::deck::finding::At;
use crate::deck::reader::{self, Log, Table, Value};
use crate::driver::Increments;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Most increments of a step.
const MOST: usize = 100_000;

pub(super) fn read(table: Table<'_>, dimension: usize) -> Option<StepEntry> {
    let name = table.name("name");
    let increments = table.need("increments", "a positive integer");
    let increments = increments.and_then(|v| increments_of(v, &table));
    let until_collapse = table.choice_if("until", &["collapse"]).is_some();
    let mut conditions = Vec::new();
    type Read = fn(&Table<'_>, usize) -> Vec<ConditionEntry>;
    let kinds: [(&str, Read); 4] = [
        ("fix", |t, d| fix(t, d).into_iter().collect()),
        ("move", |t, d| shift(t, d).into_iter().collect()),
        ("load", |t, d| load(t, d).into_iter().collect()),
        ("tools", tool),
    ];
    for (key, read) in kinds {
        let list = table.tables(key, &format!("{key} of a step"));
        conditions.extend(list.into_iter().flat_map(|t| {
            // What is fixed is at rest.
            let value = if key == "fix" { None } else { t.get("table") };
            let table = value.and_then(|v| amplitude(v, t.log()));
            let mut read = read(&t, dimension);
            t.finish();
            read.iter_mut().for_each(|c| c.table.clone_from(&table));
            read
        }));
    }
    told_once(&conditions, table.log());
    let span = table.span.clone();
    table.finish();
    // A stand-in for what was refused, so that the conditions are still checked.
    let increments = increments.unwrap_or(Increments::equal(1));
    Some(StepEntry {
        name: name?,
        increments,
        until_collapse,
        conditions,
        span,
    })
}

/// What moves or drives a tool does not add up: it is told once in a step.
fn told_once(conditions: &[ConditionEntry], log: &Log) {
    let told = |c: &ConditionEntry| match &c.action {
        Action::Tool(motion, turn) => [motion.as_ref().map(|_| "motion"), turn.map(|_| "turn")],
        Action::Push(_, motion) => [motion.as_ref().map(|_| "motion"), Some("force")],
        Action::Moment(_) => [Some("turn"), None],
        _ => [None, None],
    };
    for (k, c) in conditions.iter().enumerate() {
        let own = conditions[..k].iter().filter(|b| b.on.value == c.on.value);
        let before: Vec<&str> = own.flat_map(told).flatten().collect();
        if let Some(what) = told(c).into_iter().flatten().find(|w| before.contains(w)) {
            let message = format!(
                "the {what} of \"{}\" is told already in this step",
                c.on.value
            );
            log.borrow_mut().error(&c.span, message, "expected once");
        }
    }
}

/// A number of equal increments, or their lengths.
fn increments_of(value: Value<'_>, table: &Table<'_>) -> Option<Increments> {
    let log = table.log();
    if !value.get_ref().is_table() {
        let count = reader::integer(value, "increments", 1..=MOST, log)?;
        return Some(Increments::equal(count.value));
    }
    let inner = reader::table(value, "increments", "increments", log)?;
    let (start, min, max) = (
        inner.number("start"),
        inner.number("min"),
        inner.number("max"),
    );
    inner.finish();
    let (start, min, max) = (start?.value, min?.value, max?.value);
    if !(1.0 / MOST as f64 <= start && 0.0 < min && min <= start && start <= max && max <= 1.0) {
        log.borrow_mut().error(
            &value.span(),
            format!(
                "increments start with {start} of the step, are at least {min} and at most {max}"
            ),
            "expected 0 < min ≤ start ≤ max ≤ 1, and start at least 1e-5",
        );
        return None;
    }
    Some(Increments {
        start,
        min: Some(min),
        max,
    })
}

fn condition(on: Option<At<String>>, action: Action, table: &Table<'_>) -> Option<ConditionEntry> {
    Some(ConditionEntry {
        on: on?,
        action,
        table: None,
        span: table.span.clone(),
    })
}

/// Rows of time and share, of which the times rise from 0 to 1.
fn amplitude(value: Value<'_>, log: &Log) -> Option<At<Vec<[f64; 2]>>> {
    const ROWS: &str = "rows of time and share, as in [[0, 0], [0.5, 1], [1, 0]]";
    let rows = reader::items(value, "table", ROWS, log)?;
    let row = |value: Value<'_>| {
        let row = reader::vector(value, "row of the table", 2, log)?.value;
        Some([row[0], row[1]])
    };
    let rows: Vec<[f64; 2]> = rows.into_iter().map(row).collect::<Option<_>>()?;
    let times = || rows.iter().map(|row| row[0]);
    let rises = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    if rows.len() < 2 || !rises || [times().next(), times().next_back()] != [Some(0.0), Some(1.0)] {
        let given: Vec<String> = times().map(|time| time.to_string()).collect();
        log.borrow_mut().error(
            &value.span(),
            format!("times of the table are {}", given.join(", ")),
            "expected times in the step that rise from 0 to 1",
        );
        return None;
    }
    Some(At::new(rows, value.span()))
}

/// The components of a direction, which has a length.
fn direction(value: Value<'_>, dimension: usize, log: &Log) -> Option<Vec<f64>> {
    let direction = reader::vector(value, "along", dimension, log)?.value;
    match direction.iter().any(|x| *x != 0.0) {
        true => Some(direction),
        false => reader::wrong(value, "along", "a direction, with a length", log),
    }
}

fn fix(table: &Table<'_>, dimension: usize) -> Option<ConditionEntry> {
    let log = table.log();
    let on = table.text("on");
    if let Some(value) = table.get("along") {
        if let Some(u) = table.get("u") {
            let expected = "u or along, not both: along is the direction in which u is zero";
            return reader::wrong(u, "u", expected, log);
        }
        let direction = direction(value, dimension, log)?;
        return condition(on, Action::FixAlong(direction), table);
    }
    let value = table.need("u", "[\"x\", …]")?;
    let axes: Option<Vec<usize>> = reader::items(value, "u", "[\"x\", …]", log)?
        .into_iter()
        .map(|v| {
            let axis = reader::choice(v, "a direction", &AXES[..dimension], log)?;
            AXES.iter().position(|a| *a == axis.value)
        })
        .collect();
    let axes = axes?;
    if axes.is_empty() {
        return reader::wrong(value, "u", "at least one direction", log);
    }
    if (1..axes.len()).any(|k| axes[..k].contains(&axes[k])) {
        return reader::wrong(value, "u", "each direction once", log);
    }
    condition(on, Action::Fix(axes), table)
}

fn shift(table: &Table<'_>, dimension: usize) -> Option<ConditionEntry> {
    let log = table.log();
    let on = table.text("on");
    let along = table.get("along");
    let value = table.need("u", "{ x = …, y = … }")?;
    if let Some(along) = along {
        let direction = direction(along, dimension, log);
        if value.get_ref().is_table() {
            let expected = "the displacement along that direction, a number";
            return reader::wrong(value, "u", expected, log);
        }
        let u = reader::number(value, "u", log)?.value;
        return condition(on, Action::MoveAlong(direction?, u), table);
    }
    if !value.get_ref().is_table() {
        let expected = "the components, as in { y = -0.2 }, or a number beside along = [ … ]";
        return reader::wrong(value, "u", expected, log);
    }
    let inner = reader::table(value, "u", "u", log)?;
    let components: Vec<(usize, f64)> = AXES[..dimension]
        .iter()
        .enumerate()
        .filter_map(|(axis, key)| Some((axis, inner.number_if(key)?.value)))
        .collect();
    let empty = inner.entries().is_empty();
    inner.finish();
    if empty {
        return reader::wrong(value, "u", "at least one component", log);
    }
    condition(on, Action::Move(components), table)
}

fn load(table: &Table<'_>, dimension: usize) -> Option<ConditionEntry> {
    const KINDS: [&str; 5] = ["pressure", "traction", "force", "body-force", "temperature"];
    let log = table.log();
    let on = table.text("on");
    let given = table.given(&KINDS);
    let [(key, value)] = given[..] else {
        log.borrow_mut().error(
            &table.span,
            format!(
                "a load has {} of {}, expected one",
                given.len(),
                KINDS.join(", ")
            ),
            "one kind of load each",
        );
        return None;
    };
    let vector = || Some(reader::vector(value, key, dimension, log)?.value);
    let action = match key {
        "pressure" => Action::Pressure(reader::number(value, key, log)?.value),
        "traction" => Action::Traction(vector()?),
        "force" => Action::Force(vector()?),
        "temperature" => Action::Temperature(reader::field(value, key, dimension, log)?),
        _ => Action::BodyForce(vector()?),
    };
    condition(on, action, table)
}

/// What moves and presses a tool, and the moment that turns it.
fn tool(table: &Table<'_>, dimension: usize) -> Vec<ConditionEntry> {
    let log = table.log();
    let name = table.text("name");
    let given = table.get("moment");
    if let Some(value) = given.filter(|_| table.get("turn").is_some()) {
        log.borrow_mut().error(
            &value.span(),
            "a tool with a moment and a turn, expected one of both",
            "what the moment turns is not told how far",
        );
        return Vec::new();
    }
    let moment = given.and_then(|value| moment(value, dimension, log));
    let moment = moment.and_then(|m| condition(name.clone(), Action::Moment(m), table));
    let moves = ["move", "force"].iter().any(|key| table.get(key).is_some());
    let motion = match given.is_none() || moves {
        true => motion(name.clone(), table, dimension),
        false => None,
    };
    // Beside a force, which moves it.
    let turned = table.get("force").and(table.get("turn"));
    let turned = turned.and_then(|value| turn(value, dimension, log));
    let turned = turned.and_then(|t| condition(name, Action::Tool(None, Some(t)), table));
    motion.into_iter().chain(turned).chain(moment).collect()
}

fn motion(name: Option<At<String>>, table: &Table<'_>, dimension: usize) -> Option<ConditionEntry> {
    let log = table.log();
    let motion = |value| Some(reader::vector(value, "move", dimension, log)?.value);
    if let Some(force) = table.get("force") {
        let force = reader::vector(force, "force", dimension, log)?.value;
        let motion = match table.get("move") {
            Some(value) => {
                let motion = motion(value)?;
                let both = (force.iter().zip(&motion)).position(|(f, u)| *f != 0.0 && *u != 0.0);
                if let Some(i) = both {
                    log.borrow_mut().error(
                        &value.span(),
                        format!(
                            "a tool with a force and a motion along {}, expected one of both",
                            ["x", "y", "z"][i]
                        ),
                        "the force decides how far it goes: put 0 there, or move the tool in a step before",
                    );
                    return None;
                }
                Some(motion)
            }
            None => None,
        };
        return condition(name, Action::Push(force, motion), table);
    }
    let turn = match table.get("turn") {
        Some(value) => Some(turn(value, dimension, log)?),
        None => None,
    };
    let given = match turn {
        None => Some(table.need("move", "[ … ]")?),
        Some(_) => table.get("move"),
    };
    let motion = match given {
        Some(value) => Some(motion(value)?),
        None => None,
    };
    condition(name, Action::Tool(motion, turn), table)
}

/// A number in the plane, `{ axis = [x, y, z], value = … }` in space.
fn moment(value: Value<'_>, dimension: usize, log: &Log) -> Option<MomentEntry> {
    let forms = (
        "moment",
        "value",
        "{ axis = [x, y, z], value = … } in a solid",
    );
    let (axis, value) = about(value, dimension, forms, log)?;
    Some(MomentEntry { axis, value })
}

/// Degrees in the plane, `{ axis = [x, y, z], angle = … }` in space.
pub(super) fn turn(value: Value<'_>, dimension: usize, log: &Log) -> Option<TurnEntry> {
    let forms = (
        "turn",
        "angle",
        "{ axis = [x, y, z], angle = degrees } in a solid",
    );
    let (axis, angle) = about(value, dimension, forms, log)?;
    Some(TurnEntry { axis, angle })
}

/// An axis and a number about it: in the plane the number alone.
fn about(
    value: Value<'_>,
    dimension: usize,
    (key, number, expected): (&'static str, &'static str, &'static str),
    log: &Log,
) -> Option<([f64; 3], f64)> {
    if dimension == 2 {
        let number = reader::number(value, key, log)?.value;
        return Some(([0.0, 0.0, 1.0], number));
    }
    if !value.get_ref().is_table() {
        return reader::wrong(value, key, expected, log);
    }
    let inner = reader::table(value, key, key, log)?;
    let axis = inner.need("axis", "[x, y, z]");
    let axis = axis.and_then(|v| reader::vector(v, "axis", 3, log));
    let number = inner.number(number);
    inner.finish();
    let axis = axis?.value;
    Some(([axis[0], axis[1], axis[2]], number?.value))
}
