//! The consistent systems of units in which a deck may be written; nothing is converted.

/// A consistent system of units: input and output are in it. The solver has no dimensional
/// constant, so no number is converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// Millimetre, newton, megapascal.
    MmNMpa,
    /// Metre, newton, pascal.
    MNPa,
    /// Inch, pound-force, pound per square inch.
    InLbfPsi,
}

impl Units {
    /// Names in a deck, in the order of the variants.
    pub const NAMES: [&'static str; 3] = ["mm-N-MPa", "m-N-Pa", "in-lbf-psi"];

    /// The system of that name.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::MmNMpa, Self::MNPa, Self::InLbfPsi];
        all.into_iter().find(|u| u.name() == name)
    }

    /// Name in a deck.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Unit of length.
    pub fn length(self) -> &'static str {
        ["mm", "m", "in"][self as usize]
    }

    /// Unit of force.
    pub fn force(self) -> &'static str {
        ["N", "N", "lbf"][self as usize]
    }

    /// Unit of stress.
    pub fn stress(self) -> &'static str {
        ["MPa", "Pa", "psi"][self as usize]
    }

    /// The unit of stress in pascals.
    pub fn pascal(self) -> f64 {
        [1e6, 1.0, 6894.757][self as usize]
    }

    /// Unit of energy.
    pub fn energy(self) -> &'static str {
        ["N·mm", "N·m", "lbf·in"][self as usize]
    }

    /// Unit of a force, moment or displacement by its column of `history.csv`.
    pub(crate) fn of_value(self, column: &str) -> &'static str {
        match column.split('.').next() {
            Some("force") => self.force(),
            Some("moment") => self.energy(),
            _ => self.length(),
        }
    }
}
