//! A mark on a picture: a support, an arrow, a surface, a label; not how it is drawn, nor what it stands for.

/// A mark on a picture, at places of the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark<const D: usize = 2> {
    /// A point that is held along a direction, from the side that `from` points to.
    Support {
        /// Where \[mm\].
        at: [f64; D],
        /// Unit vector along it, out of the body.
        from: [f64; D],
    },
    /// A motion or a force.
    Arrow {
        /// Where \[mm\].
        at: [f64; D],
        /// Unit vector.
        along: [f64; D],
        /// Whether it ends there, as what presses, or begins.
        ends: bool,
        /// Colour, as `#1f5fbf`.
        colour: &'static str,
    },
    /// A line along a surface.
    Line {
        /// Its points \[mm\].
        points: Vec<[f64; D]>,
        /// Colour.
        colour: &'static str,
    },
    /// A text beside a point.
    Label {
        /// Where \[mm\].
        at: [f64; D],
        /// Unit vector from there to the text.
        towards: [f64; D],
        /// The text.
        text: String,
        /// Colour.
        colour: &'static str,
    },
    /// A dot.
    Dot {
        /// Where \[mm\].
        at: [f64; D],
        /// Colour.
        colour: &'static str,
    },
}

impl<const D: usize> Mark<D> {
    /// Where it is \[mm\]; a line in its middle.
    pub fn place(&self) -> [f64; D] {
        match self {
            Self::Support { at, .. }
            | Self::Arrow { at, .. }
            | Self::Label { at, .. }
            | Self::Dot { at, .. } => *at,
            Self::Line { points, .. } => {
                let count = points.len().max(1) as f64;
                std::array::from_fn(|i| points.iter().map(|x| x[i]).sum::<f64>() / count)
            }
        }
    }

    /// With all of its places and directions seen by a linear map.
    pub(super) fn map(&self, seen: impl Fn(&[f64; D]) -> [f64; 2]) -> Mark<2> {
        match self {
            Self::Support { at, from } => Mark::Support {
                at: seen(at),
                from: seen(from),
            },
            Self::Arrow {
                at,
                along,
                ends,
                colour,
            } => Mark::Arrow {
                at: seen(at),
                along: seen(along),
                ends: *ends,
                colour,
            },
            Self::Line { points, colour } => Mark::Line {
                points: points.iter().map(seen).collect(),
                colour,
            },
            Self::Label {
                at,
                towards,
                text,
                colour,
            } => Mark::Label {
                at: seen(at),
                towards: seen(towards),
                text: text.clone(),
                colour,
            },
            Self::Dot { at, colour } => Mark::Dot {
                at: seen(at),
                colour,
            },
        }
    }
}
