//! A law of points that is asked for panels says what it says point by point, to the bit; not structures.

use crate::contract::for_all;
use crate::samples::vector;
use moreau_laws::{
    BulkLaw, DruckerPrager, ElasticDruckerPrager, LawError, Numbers, Panel, PanelLaw, PointByPoint,
    VonMises,
};
use moreau_mandel::{Sym2, Sym4};
use proptest::prelude::*;
use std::fmt::Debug;

fn numbers<S: Numbers>(mut state: S) -> Vec<f64> {
    let mut numbers = Vec::new();
    state.visit(&mut |x| numbers.push(*x));
    numbers
}

/// Two steps of several points.
fn same_to_the_bit<L: BulkLaw + Debug>(law: &L) {
    let panels = PointByPoint(law.clone());
    let steps = prop::collection::vec((vector::<6>(4e-3), vector::<6>(4e-3)), 0..6);
    for_all(&steps, |steps| {
        let (first, second): (Vec<Sym2>, Vec<Sym2>) = steps.into_iter().unzip();
        let mut states: Vec<L::State> = vec![law.initial(); first.len()];
        let mut old = panels.initial().repeat(first.len());
        for d_eps in [first, second] {
            let mut stress = vec![Sym2::zeros(); d_eps.len()];
            let mut tangent = vec![Sym4::zeros(); d_eps.len()];
            let mut new = vec![0.0; old.len()];
            let panel = Panel {
                d_eps: &d_eps,
                old: &old,
                stress: &mut stress,
                tangent: &mut tangent,
                new: &mut new,
            };
            panels.respond(panel).expect("an answer");
            for (k, state) in states.iter_mut().enumerate() {
                let response = law.respond(state, &d_eps[k]);
                let lacking = law.lacking(state, &d_eps[k]);
                prop_assert_eq!(stress[k], response.stress);
                prop_assert_eq!(tangent[k], response.tangent + lacking);
                *state = response.state;
            }
            let expected: Vec<f64> = states.iter().flat_map(|&s| numbers(s)).collect();
            prop_assert_eq!(&new, &expected);
            old = new;
        }
        Ok(())
    });
}

#[test]
fn a_panel_is_its_points() -> Result<(), LawError> {
    same_to_the_bit(&VonMises::new(210e3, 0.3, 300.0)?.with_isotropic(2e3)?);
    let soil = DruckerPrager::mohr_coulomb(10.0, 30.0, 5.0)?;
    let soil = ElasticDruckerPrager::new(2e4, 0.3, soil)?;
    assert!(!PointByPoint(soil).is_symmetric());
    same_to_the_bit(&soil);
    Ok(())
}
