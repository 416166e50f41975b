//! Laws of the textbook: what is said of potentials on the smallest examples and on laws that no body
//! here is made of. Tests and documents use them; models do not, and none is integrated over a step in a
//! body.

mod armstrong_frederick;
mod cam_clay;
mod lemaitre;
mod regularised;
mod rigid_von_mises;
mod signorini;
mod uniaxial;

pub use armstrong_frederick::{ArmstrongFrederick, Generalised};
pub use cam_clay::CamClay;
pub use lemaitre::{Damaging, Lemaitre};
pub use regularised::{RegularisedCoulomb, RegularisedResponse};
pub use rigid_von_mises::VonMisesDissipation;
pub use signorini::Signorini;
pub use uniaxial::{Uniaxial, UniaxialResponse};
