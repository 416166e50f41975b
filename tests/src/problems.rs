//! Problems that several verification tests share, as models ready to be loaded; not the numbers
//! they are compared with, which stand in the tests.

pub mod collapsing;
pub mod disguise;
pub mod fields;
pub mod forming;
pub mod greco;
pub mod large;
pub mod limit;
pub mod patches;
pub mod punched;
pub mod shapes;

/// What a test returns: any error is a failure.
pub type Fallible<T = ()> = Result<T, Box<dyn std::error::Error>>;
