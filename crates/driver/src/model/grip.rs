//! Whether a shear of given limit acts at a contact point; not how large it is.

use moreau_laws::Friction;

/// A law that bounds the shear by more than nothing where there is no pressure, as Tresca's, would shear what a tool does not
/// touch. It holds where bodies press: in an increment at the points that are closed at its start and at those that come to press in it,
/// less those that balance is found to leave open. What presses without its shear and opens under it, time and again,
/// presses without it: its shear is something between, and none acts across a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Grip {
    acts: bool,
    /// How often balance has left the point open.
    released: u8,
}

/// Times that a point is released in an increment.
const RELEASES: u8 = 3;

impl Grip {
    /// At the start of an increment, of a point that is closed there or not.
    pub(crate) fn start(closed: bool) -> Self {
        Self {
            acts: closed,
            released: 0,
        }
    }

    /// Of a point that presses.
    pub(crate) fn pressed(self) -> Self {
        Self {
            acts: self.released < RELEASES,
            ..self
        }
    }

    /// Of a point that balance leaves open.
    pub(crate) fn open(self) -> Self {
        match self.acts {
            true => Self {
                acts: false,
                released: self.released + 1,
            },
            false => self,
        }
    }

    /// Whether the law bounds the shear by more than nothing where there is no pressure, and that does not act.
    pub(crate) fn is_without(self, law: &Friction) -> bool {
        !self.acts && !law.is_tie() && law.bound(0.0) > 0.0
    }

    /// The area on which a limit of the shear acts, of that of the point.
    pub(crate) fn area(self, law: &Friction, area: f64) -> f64 {
        match self.is_without(law) {
            true => 0.0,
            false => area,
        }
    }
}
