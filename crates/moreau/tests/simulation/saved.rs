//! States as bytes, and back.

use super::{DECK, advance, bits, finish, simulation};

#[test]
fn a_restored_simulation_goes_on_to_the_bit_with_its_whole_history() {
    let whole = finish(simulation(DECK));
    let mut stopped = simulation(DECK);
    (0..7).for_each(|_| assert!(advance(&mut stopped)));
    let state = stopped.save();
    let mut again = simulation(DECK);
    again.restore(&state).expect("of this deck");
    assert_eq!(bits(&again), bits(&stopped));
    assert_eq!(again.history().rows(), 7);
    assert_eq!(bits(&finish(again)), bits(&whole));
    // Back from the end.
    let mut back = finish(stopped);
    back.restore(&state).expect("of this deck");
    assert_eq!(back.history().rows(), 7);
    assert_eq!(bits(&finish(back)), bits(&whole));
}

#[test]
fn a_state_that_does_not_fit_changes_nothing() {
    let mut stopped = simulation(DECK);
    assert!(advance(&mut stopped));
    let (state, before) = (stopped.save(), bits(&stopped));
    let mut altered = state.clone();
    altered[200] ^= 1;
    for (bytes, word) in [
        (&state[..state.len() - 8], "torn"),
        (&altered[..], "torn"),
        (b"a picture", "not a checkpoint"),
    ] {
        let error = stopped.restore(bytes).expect_err("no state").to_string();
        assert!(error.contains(word), "{error}");
    }
    let mut other = simulation(&DECK.replace("poisson = 0.3", "poisson = 0.29"));
    let error = other.restore(&state).expect_err("another").to_string();
    assert!(error.contains("another deck"), "{error}");
    assert_eq!(bits(&stopped), before);
}
