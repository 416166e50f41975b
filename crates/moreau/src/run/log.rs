//! `log.jsonl`: a line for each iteration.

use crate::driver::Iteration;

/// An iteration of a step as a line of JSON, so many seconds after the beginning.
pub(super) fn line(step: &str, i: &Iteration<'_>, seconds: f64) -> String {
    serde_json::json!({
        "step": step,
        "increment": i.increment,
        "cut": i.cuts,
        "iteration": i.newton,
        "residual": i.out_of_balance,
        "relative_residual": i.out_of_balance / i.scale,
        "contact_iterations": i.contact_iterations,
        "seconds": seconds,
    })
    .to_string()
}
