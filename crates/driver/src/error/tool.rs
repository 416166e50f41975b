//! A tool driven by a force that touches nothing yet; not how that is found.

use std::fmt;

/// A tool driven by a force that touches nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolOutOfContact {
    /// The tool.
    pub tool: String,
    /// The force on it \[N\].
    pub force: Vec<f64>,
    /// The surface nearest to it.
    pub surface: String,
    /// Where the surface is nearest \[mm\].
    pub position: Vec<f64>,
    /// How far it is from there \[mm\].
    pub gap: f64,
    /// The motion along its force after which it touches, if there is one \[mm\].
    pub meets: Option<Vec<f64>>,
}

/// Numbers to six digits.
fn significant(values: &[f64]) -> Vec<f64> {
    let short = |v: &f64| format!("{v:.5e}").parse().unwrap_or(*v);
    values.iter().map(short).collect()
}

/// A force of length 1.
pub(super) fn direction(force: &[f64]) -> Vec<f64> {
    let size = force.iter().fold(0.0, |size: f64, f| size.hypot(*f));
    significant(&force.iter().map(|f| f / size).collect::<Vec<_>>())
}

impl fmt::Display for ToolOutOfContact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            tool,
            force,
            surface,
            ..
        } = self;
        let (gap, at) = (significant(&[self.gap])[0], significant(&self.position));
        write!(
            f,
            "tool {tool:?} is driven by the force {force:?} and nothing resists it: it touches nothing. \
             Nearest to it is {surface:?}, {gap} away at {at:?}; "
        )?;
        match &self.meets {
            Some(motion) => write!(
                f,
                "moved by {:?} it would touch: begin with a step that moves it there, and drive it from \
                 there",
                significant(motion)
            ),
            None => f.write_str(
                "on the way of its force it meets nothing: put it elsewhere, or turn the force",
            ),
        }
    }
}
