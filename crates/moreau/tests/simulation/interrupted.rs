//! Increments that are broken off, in decks of all kinds.

use super::{bits, examples, finish, simulation};
use moreau::driver::IncrementError;
use moreau::simulation::{Simulation, StepError};
use std::fs;
use std::ops::ControlFlow;

/// Goes on to the end, and is broken off in every increment, after one more iterate each time.
fn disturbed(mut simulation: Simulation) -> Simulation {
    let mut allowed = 0;
    loop {
        let mut left = allowed;
        let outcome = simulation.advance(&mut |_, _| match left {
            0 => ControlFlow::Break(()),
            _ => {
                left -= 1;
                ControlFlow::Continue(())
            }
        });
        match outcome {
            Ok(Some(_)) => allowed = 0,
            Ok(None) => return simulation,
            Err(StepError::Increment(IncrementError::Interrupted)) => allowed += 1,
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn an_interruption_within_an_increment_changes_no_bit() {
    for (name, from, to) in [
        ("punched-block", "increments = 20", "increments = 5"),
        ("cylinder-to-collapse", "increments = 10", "increments = 5"),
        ("ring-squeezed", "increments = 50", "increments = 10"),
        (
            "block-dragged-on-block",
            "increments = 10",
            "increments = 2",
        ),
    ] {
        let text = fs::read_to_string(examples().join(name).with_extension("toml"));
        let text = text.expect("a deck").replace(from, to);
        let text = text.replace("cells = [12, 8]", "cells = [6, 4]");
        let (head, _) = text.split_once("[expect]").expect("two parts");
        let whole = finish(simulation(head));
        assert_eq!(bits(&disturbed(simulation(head))), bits(&whole), "{name}");
    }
}
