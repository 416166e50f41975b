//! The laws of materials that a deck can have, and their isotropic hardening.

use crate::deck::entries::{Curve, Hardening};
use crate::deck::finding::At;
use crate::laws::{
    Elastic, ElasticDruckerPrager, Hill, Isotropic, LawError, Orthotropic, PanelLaw, VonMises,
};
use crate::numbers::shown;
use std::ops::Range;
use std::sync::Arc;

/// Most terms of kinematic hardening with recall; those without are as many as there are. Fits of
/// cyclic tests take two or three.
pub(super) const RECALLED: usize = 4;

/// A bulk law.
#[derive(Debug, Clone)]
pub(super) enum Law {
    Elastic(Elastic),
    VonMises(VonMises),
    Chaboche(VonMises<RECALLED>),
    DruckerPrager(ElasticDruckerPrager),
    Orthotropic(Orthotropic),
    Hill(Box<Hill>),
    Given(Arc<dyn PanelLaw>),
}

/// Relative difference of a yield stress and the first stress of a table: what six digits round off. The table begins at
/// the yield stress, so that more would shift all of it.
const SAME_STRESS: f64 = 1e-5;

/// The same of Swift's curve, which starts at k e₀ⁿ: what an e₀ of two digits rounds off.
const SAME_YIELD: f64 = 0.01;

/// Isotropic hardening, which must start at the yield stress; or what is wrong with it, and where.
pub(super) fn hardening(
    given: &At<Hardening>,
    yield_stress: &At<f64>,
) -> Result<Isotropic, (Range<usize>, String)> {
    let wrong = |error: LawError| (given.span.clone(), error.to_string());
    let is_start = |stress: f64, part: f64| (stress / yield_stress.value - 1.0).abs() <= part;
    let linear = given.value.linear;
    let Some(curve) = &given.value.curve else {
        return Isotropic::linear(linear).map_err(wrong);
    };
    let law = match curve {
        Curve::Voce([saturation, rate]) => Isotropic::voce(*saturation, *rate).map_err(wrong),
        Curve::Swift([strength, offset, exponent]) => {
            let law = Isotropic::swift(*strength, *offset, *exponent).map_err(wrong)?;
            let start = law.initial().filter(|&s| !is_start(s, SAME_YIELD));
            if let Some(stress) = start {
                // k e0ⁿ is the yield stress.
                let fits = (yield_stress.value / strength).powf(1.0 / exponent);
                let remedy = match fits.is_finite() {
                    true => format!(", which it does with e0 = {}", shown(fits, 6)),
                    false => String::new(),
                };
                let message = format!(
                    "hardening starts at a stress of {stress:.6}, but yield-stress is {}{remedy}",
                    yield_stress.value
                );
                return Err((given.span.clone(), message));
            }
            Ok(law)
        }
        Curve::Table(rows) => {
            let mut points: Vec<[f64; 2]> = rows.iter().map(|row| row.value).collect();
            let mut added = 0;
            match points.first() {
                // The yield stress is the point that a table without one starts at.
                Some(&[p, _]) if p > 0.0 => {
                    points.insert(0, [0.0, yield_stress.value]);
                    added = 1;
                }
                Some(&[_, stress]) if !is_start(stress, SAME_STRESS) => {
                    let message = format!(
                        "the hardening table starts at a stress of {stress:?}, but yield-stress is {:?}: let both be the same \
                         number",
                        yield_stress.value
                    );
                    return Err((rows[0].span.clone(), message));
                }
                _ => {}
            }
            Isotropic::table(&points).map_err(|error| match error {
                LawError::Table { row, problem } if row > added && row - added <= rows.len() => {
                    let row = row - added;
                    let error = LawError::Table { row, problem };
                    (rows[row - 1].span.clone(), error.to_string())
                }
                error => wrong(error),
            })
        }
    };
    law?.with_linear(linear).map_err(wrong)
}
