//! What every law must show, as a suite that the test of a law calls in one line; not proofs: it
//! draws samples, always the same.
//!
//! ```
//! use moreau_laws::{VonMises, contract};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let law = VonMises::new(210e3, 0.3, 300.0)?.with_isotropic(2e3)?;
//! contract::bulk(&law)?;
//! println!("{}", contract::isotropy(&law)?);
//! # Ok(())
//! # }
//! ```

mod bipotential;
mod bulk;
mod friction;
mod random;

pub use bipotential::{Departure, Samples, Space, bipotential};
pub use bulk::{bulk, bulk_from, isotropy};
pub use friction::friction;

use std::fmt;

/// What was checked, property by property.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    checks: Vec<Check>,
}

/// A property on the samples drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// The property.
    pub property: &'static str,
    /// Samples on which it was checked.
    pub count: usize,
    /// The largest violation found, in what rounding and differences are allowed; at most 1.
    pub worst: f64,
}

/// A property that does not hold, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("violated: {property}; found {found:e}, allowed {allowed:e}, {at}")]
pub struct Violation {
    /// The property.
    pub property: &'static str,
    /// By how much it is violated, in the unit of the quantity compared.
    pub found: f64,
    /// How much rounding and differences are allowed.
    pub allowed: f64,
    /// The sample.
    pub at: String,
}

impl Report {
    /// The properties in the order in which they were first checked.
    pub fn checks(&self) -> &[Check] {
        &self.checks
    }

    /// Samples on which a property was checked; 0 of one that the law does not promise.
    pub fn count(&self, property: &str) -> usize {
        let found = self.checks.iter().find(|c| c.property == property);
        found.map_or(0, |c| c.count)
    }

    /// Notes that `found` is at most `allowed`.
    ///
    /// # Errors
    /// [`Violation`] if it is not, or not a number; `at` describes the sample.
    fn at_most(
        &mut self,
        property: &'static str,
        (found, allowed): (f64, f64),
        at: impl Fn() -> String,
    ) -> Result<(), Violation> {
        if !found.le(&allowed) {
            return Err(Violation {
                property,
                found,
                allowed,
                at: at(),
            });
        }
        let worst = if allowed > 0.0 { found / allowed } else { 0.0 };
        self.note(property, worst);
        Ok(())
    }

    /// Notes a sample on which a property holds, and which part of what is allowed it took.
    fn note(&mut self, property: &'static str, worst: f64) {
        match self.checks.iter_mut().find(|c| c.property == property) {
            Some(check) => {
                check.count += 1;
                check.worst = check.worst.max(worst);
            }
            None => self.checks.push(Check {
                property,
                count: 1,
                worst: worst.max(0.0),
            }),
        }
    }

    /// Notes that a statement is true.
    ///
    /// # Errors
    /// [`Violation`] if it is not.
    fn holds(
        &mut self,
        property: &'static str,
        statement: bool,
        at: impl Fn() -> String,
    ) -> Result<(), Violation> {
        let found = f64::from(u8::from(!statement));
        self.at_most(property, (found, 0.0), at)
    }
}

/// A line a property: what, on how many samples, and the worst in what is allowed.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for check in &self.checks {
            let Check {
                property,
                count,
                worst,
            } = check;
            writeln!(f, "{property:60} {count:6} {worst:9.1e}")?;
        }
        Ok(())
    }
}
