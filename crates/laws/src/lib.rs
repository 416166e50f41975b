//! Constitutive laws as pure functions, derived from superpotentials and bipotentials; not
//! meshes, fields or solvers.
//!
//! A dissipative law relates a flux x (a rate, or an increment over a step) to the force y
//! conjugate to it. A *standard* law derives from a convex [`Superpotential`]: y ∈ ∂V(x), \[28\].
//! Contact with friction is not standard: it derives from a [`Bipotential`], a function of both,
//! convex in each, with b(x, y) ≥ x·y, and the law is where equality holds, \[29\]-\[34\]. Numbers
//! in brackets are the equations of Fihri Fassi, Bousshine, de Saxcé, El Harif and Kouam, *Analyse du
//! problème d'évolution élastoplastique en présence d'une loi non associée de contact avec
//! frottement*.
//!
//! ```
//! use moreau_laws::{Bipotential, Coulomb, Local};
//!
//! # fn main() -> Result<(), moreau_laws::LawError> {
//! // A contact of friction 0.5 pressed by 10 N, that slips 1 mm along the first tangent.
//! let law = Coulomb::new(0.5)?;
//! let u = Local::<3>::new(0.0, 1.0, 0.0);
//! let gap = |t: &Local<3>| law.b(&-u, t) + t.dot(&u); // b(−u, t) − (−u)·t ≥ 0
//!
//! // Friction on the cone and against the slip: the pair obeys the law, the gap is zero.
//! assert_eq!(gap(&Local::<3>::new(10.0, -5.0, 0.0)), 0.0);
//! // Too little friction: the gap is what is missing in dissipation, in N·mm.
//! assert_eq!(gap(&Local::<3>::new(10.0, -3.0, 0.0)), 2.0);
//! // Friction outside the cone is not admissible.
//! assert_eq!(gap(&Local::<3>::new(10.0, -6.0, 0.0)), f64::INFINITY);
//!
//! // The same law as an equation, for any α > 0: t = proj(t − αũ).
//! let t = Local::<3>::new(10.0, -5.0, 0.0);
//! assert!(law.natural_map(&u, &t, 7.0).norm() < 1e-14);
//! # Ok(())
//! # }
//! ```
//!
//! | law | type | kind |
//! |---|---|---|
//! | isotropic elasticity | [`Elastic`] | bulk |
//! | von Mises, isotropic and kinematic hardening | [`VonMises`] | bulk |
//! | its isotropic hardening | [`Isotropic`] | stored energy |
//! | elasticity of three axes | [`Orthotropic`] | bulk |
//! | its plasticity after Hill | [`Hill`] | bulk |
//! | soils | [`ElasticDruckerPrager`] | bulk |
//! | their plastic part | [`DruckerPrager`] | bipotential |
//! | any of these under plane stress | [`InPlaneStress`] | bulk |
//! | contact with Tresca friction | [`Tresca`] | superpotential |
//! | contact with Coulomb friction | [`Coulomb`], [`AnisotropicCoulomb`] | bipotential |
//! | contact with friction limited by a shear | [`LimitedCoulomb`] | neither |
//! | contact with friction of any bound | [`ShearBound`] | neither |
//! | surfaces held together | [`Tie`] | superpotential |
//! | any of these, as a structure sees it | [`Friction`] | as an equation |
//! | of tests and documents only | [`textbook`] | all |
//!
//! A law of your own is a [`BulkLaw`] or a [`ShearBound`]; [`contract`] tests it in one line. One of another language
//! is a [`PanelLaw`].
//!
//! Tensors are in Mandel notation, see `moreau_mandel`; units are N, mm and MPa. Constructors
//! return [`LawError`] for data that define no law; past them nothing fails, and data that are not
//! numbers come out as NaN, or as +∞ of a function that is +∞ outside of its domain.

mod bulk;
pub mod contract;
mod drucker_prager;
mod duality;
mod elastic;
mod elastic_drucker_prager;
mod error;
mod friction;
mod isotropic;
mod large;
mod local;
mod orthotropic;
mod panel;
mod plane_stress;
pub mod textbook;
mod von_mises;

pub use bulk::{BulkLaw, COMMON_FIELDS, FlowPower, Numbers, ON_SURFACE, Response};
pub use drucker_prager::DruckerPrager;
pub use duality::{Bipotential, Superpotential};
pub use elastic::Elastic;
pub use elastic_drucker_prager::{DruckerPragerState, ElasticDruckerPrager};
pub use error::{LawError, Parameter, non_negative, positive};
pub use friction::Friction;
pub use friction::anisotropic::AnisotropicCoulomb;
pub use friction::bounded::{Bounded, ShearBound};
pub use friction::coulomb::Coulomb;
pub use friction::limited::LimitedCoulomb;
pub use friction::table::ShearTable;
pub use friction::tie::Tie;
pub use friction::tresca::Tresca;
pub use isotropic::Isotropic;
pub use large::{LargeResponse, Turned, respond_large, volume_change};
pub use local::{Local, Status};
pub use orthotropic::Orthotropic;
pub use orthotropic::hill::{Hill, HillCoefficients, HillState};
pub use panel::{NoAnswer, Panel, PanelLaw, PointByPoint};
pub use plane_stress::{InPlaneStress, PlaneStressState};
pub use von_mises::{VonMises, VonMisesState};
