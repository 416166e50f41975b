//! What a column or a key of the results is called, measured in, and means; not its values.

use super::units::Units;

/// What a column is measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// Nothing: a whole number.
    Count,
    /// Nothing: a ratio, a text, or what a law has of its own.
    None,
    Length,
    Force,
    Stress,
    Energy,
    Degree,
    Second,
    Mebibyte,
}

impl Unit {
    /// How it is written; empty for a number without one.
    pub(crate) fn symbol(self, units: Units) -> &'static str {
        match self {
            Self::Count | Self::None => "",
            Self::Length => units.length(),
            Self::Force => units.force(),
            Self::Stress => units.stress(),
            Self::Energy => units.energy(),
            Self::Degree => "°",
            Self::Second => "s",
            Self::Mebibyte => "MiB",
        }
    }
}

/// A column or a key, or those of one kind.
#[derive(Debug)]
pub(crate) struct Described {
    /// Name; of those of one kind with words in capitals for what is named elsewhere.
    pub(crate) name: &'static str,
    pub(crate) unit: Unit,
    /// What it is, in a sentence or two.
    pub(crate) meaning: &'static str,
    /// When it is there; empty for always.
    pub(crate) when: &'static str,
}

impl Described {
    /// What is always there.
    pub(crate) const fn new(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self {
            name,
            unit,
            meaning,
            when: "",
        }
    }

    /// The same, there only in some cases.
    pub(crate) const fn when(self, when: &'static str) -> Self {
        Self { when, ..self }
    }
}
