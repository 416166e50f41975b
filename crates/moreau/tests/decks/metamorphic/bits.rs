//! What does not even round.

use super::*;

/// On one thread or two, and with a pause after the first increment: the same to the bit.
#[test]
fn threads_and_pauses_change_no_bit() {
    let beside = folder("docs/examples");
    for (name, deck) in examples() {
        beside_itself(&name, &deck, |two| {
            let one = on_threads(1, &name, &deck);
            assert!(one.text == two.text, "{name}: threads");
            let paused = history(&deck, &beside, &format!("{name}-paused"), true);
            assert!(one.text == paused.text, "{name}: a pause");
        });
    }
}
