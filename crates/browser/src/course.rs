//! A deck under way, told as JSON; numbers are read back exactly, and what is no number is `null`.

use moreau::deck::Given;
use moreau::simulation::{Array, Simulation};
use moreau::table::{Table, Values};
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use std::path::Path;

/// A deck under way.
pub struct Course {
    simulation: Simulation,
}

impl Course {
    /// Opens a deck that needs no file.
    ///
    /// # Errors
    /// What is wrong with it, as the command tells it.
    pub fn open(deck: &str) -> Result<Self, String> {
        let (simulation, findings) = Simulation::open(deck, Path::new(""), &Given::default());
        let refused = || findings.render("deck", deck, false);
        simulation
            .map(|simulation| Self { simulation })
            .ok_or_else(refused)
    }

    /// Applies the next increment, and tells of it: an object with
    ///
    /// - `done`: part of all steps that has been done;
    /// - `history`: the last row of the table of that name, by column;
    /// - `contacts`: the columns of the table of contact points;
    /// - `points`: where the points of the body were, three coordinates each \[length\];
    /// - `cells`: the points of each cell, in the order of VTK;
    /// - `fields`: values at the points by name, the components of the first point first; `displacement` is one.
    ///
    /// `None` where there is no next one: [`Course::outcome`] tells why.
    pub fn advance(&mut self) -> Option<String> {
        let simulation = &mut self.simulation;
        let next = simulation.advance(&mut |_, _| ControlFlow::Continue(()));
        let increment = next.ok().flatten()?;
        let history = simulation.history();
        let last = history.rows().checked_sub(1);
        let row = history.columns().iter().filter_map(|column| {
            let value = *column.values.numbers().get(last?)?;
            Some((column.name.clone(), json!(value)))
        });
        let row: Map<String, Value> = row.collect();
        let body = simulation.body();
        let cells: Vec<&[i64]> = body.cells.iter().map(|(cell, _)| cell.as_slice()).collect();
        let told = json!({
            "done": increment.done,
            "history": row,
            "contacts": columns(&simulation.contacts()),
            "points": body.points,
            "cells": cells,
            "fields": fields(&body.point_data),
        });
        Some(told.to_string())
    }

    /// How it stands, as in `run.json`.
    pub fn outcome(&self) -> String {
        self.simulation.outcome().json()
    }
}

fn columns(table: &Table) -> Map<String, Value> {
    let value = |values: &Values| match values {
        Values::Numbers(values) => json!(values),
        Values::Counts(values) => json!(values),
        Values::Texts(values) => json!(values),
    };
    let columns = table.columns().iter();
    columns
        .map(|column| (column.name.clone(), value(&column.values)))
        .collect()
}

fn fields(arrays: &[Array]) -> Map<String, Value> {
    let arrays = arrays.iter();
    arrays
        .map(|array| (array.name.clone(), json!(array.values)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: &str = include_str!("../../../docs/examples/punched-block.toml");

    #[test]
    fn every_increment_is_told_and_the_last_is_the_papers() {
        let mut course = Course::open(BLOCK).expect("a deck");
        let mut last = Value::Null;
        let mut count = 0;
        while let Some(told) = course.advance() {
            last = serde_json::from_str(&told).expect("JSON");
            count += 1;
        }
        assert_eq!((count, &last["done"]), (20, &json!(1.0)));
        let load = last["history"]["force.punch.y"].as_f64().expect("a load");
        assert!((load + 10519.53783).abs() < 1e-4, "{load}");
        let points = last["points"].as_array().expect("points").len();
        let moved = last["fields"]["displacement"].as_array().expect("a field");
        assert_eq!(moved.len(), 3 * points);
        let outcome: Value = serde_json::from_str(&course.outcome()).expect("JSON");
        assert_eq!(outcome["values"]["force.punch.y"], json!(load));
    }

    #[test]
    fn a_deck_with_errors_is_refused_with_its_findings() {
        let wrong = BLOCK.replace("friction = 0.1", "friction = -1");
        let refused = Course::open(&wrong).err().expect("refused");
        assert!(refused.contains("friction"), "{refused}");
    }
}
