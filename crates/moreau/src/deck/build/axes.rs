//! Laws of materials with axes; what their numbers must obey is for the laws to say.

use super::laws::{Law, hardening};
use crate::deck::entries::{AxesEntry, HillEntry, MaterialEntry};
use crate::laws::{Elastic, Hill, HillCoefficients, LawError, Orthotropic};
use nalgebra::Matrix3;
use std::ops::Range;

/// Von Mises' criterion, of what is given none.
const MISES: [f64; 6] = [0.5, 0.5, 0.5, 1.5, 1.5, 1.5];

/// The law of a material with axes; or what is wrong with it, and where.
pub(super) fn law(
    material: &MaterialEntry,
    axes: &AxesEntry,
) -> Result<Law, (Range<usize>, String)> {
    let at = |span: &Range<usize>| {
        let span = span.clone();
        move |error: LawError| (span, error.to_string())
    };
    let directions = axes.directions.as_ref();
    let turn: Matrix3<f64> = directions
        .and_then(|d| d.value.rotation())
        .unwrap_or_else(Matrix3::identity);
    let elastic = match &axes.elastic {
        Some(given) => {
            let [young, poisson, shear] = given.value;
            let law = Orthotropic::new(young, poisson, shear);
            law.map_err(at(&given.span))?.along(&turn)
        }
        None => Elastic::new(material.young.value, material.poisson.value)
            .map_err(|error| {
                let wrong = match &error {
                    LawError::PoissonOutOfRange { .. } => &material.poisson,
                    _ => &material.young,
                };
                (wrong.span.clone(), error.to_string())
            })?
            .into(),
    };
    let Some(yield_stress) = &material.yield_stress else {
        return Ok(Law::Orthotropic(elastic));
    };
    let criterion = match &axes.hill {
        None => HillCoefficients::new(MISES).map_err(at(&yield_stress.span))?,
        Some(given) => match given.value {
            HillEntry::Coefficients(all) => HillCoefficients::new(all),
            HillEntry::Lankford([r0, r45, r90]) => HillCoefficients::lankford(r0, r45, r90),
        }
        .map_err(at(&given.span))?,
    };
    let law = Hill::new(elastic, criterion.along(&turn), yield_stress.value);
    let law = law.map_err(at(&yield_stress.span))?;
    let law = match &material.isotropic {
        Some(given) => law.with_hardening(hardening(given, yield_stress)?),
        None => law,
    };
    Ok(Law::Hill(Box::new(law)))
}
