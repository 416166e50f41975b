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

/// Relative difference of a yield stress and that at which a curve starts: what is rounded off in a
/// deck, not another material.
const SAME_YIELD: f64 = 0.01;

/// Isotropic hardening, which must start at the yield stress; or what is wrong with it, and where.
pub(super) fn hardening(
    given: &At<Hardening>,
    yield_stress: &At<f64>,
) -> Result<Isotropic, (Range<usize>, String)> {
    let wrong = |error: LawError| (given.span.clone(), error.to_string());
    let start = |stress: f64, span: &Range<usize>| match (stress / yield_stress.value - 1.0).abs() {
        difference if difference <= SAME_YIELD => Ok(()),
        _ => Err((
            span.clone(),
            format!(
                "hardening starts at a stress of {stress:.6}, but yield-stress is {}",
                yield_stress.value
            ),
        )),
    };
    let linear = given.value.linear;
    let Some(curve) = &given.value.curve else {
        return Isotropic::linear(linear).map_err(wrong);
    };
    let law = match curve {
        Curve::Voce([saturation, rate]) => Isotropic::voce(*saturation, *rate).map_err(wrong),
        Curve::Swift([strength, offset, exponent]) => {
            let law = Isotropic::swift(*strength, *offset, *exponent).map_err(wrong)?;
            // k e0ⁿ is the yield stress.
            let fits = (yield_stress.value / strength).powf(1.0 / exponent);
            let told = |(at, what): (Range<usize>, String)| match fits.is_finite() {
                true => (
                    at,
                    format!("{what}, which it does with e0 = {}", shown(fits, 6)),
                ),
                false => (at, what),
            };
            law.initial()
                .map_or(Ok(()), |s| start(s, &given.span))
                .map_err(told)?;
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
                Some(&[_, stress]) => start(stress, &rows[0].span)?,
                None => {}
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
