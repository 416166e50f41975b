//! A deck under way within a page: [`Course`] tells it as JSON, and `calls` hands that to JavaScript. What is seen is in
//! `page/`; nothing here draws, and nothing here knows which deck it is.
//!
//! ```
//! use moreau_browser::Course;
//!
//! let deck = include_str!("../../../docs/examples/punched-block.toml");
//! let mut course = Course::open(deck)?;
//! while let Some(increment) = course.advance() {
//!     assert!(increment.contains("\"bipotential_gap\""));
//! }
//! assert!(course.outcome().contains("\"status\": \"done\""));
//! # Ok::<(), String>(())
//! ```

mod calls;
mod course;

pub use course::Course;
