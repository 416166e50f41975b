//! Data that define no law; not numerical failures.

use moreau_laws::textbook::*;
use moreau_laws::*;

const NOT_POSITIVE: [f64; 5] = [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
const NEGATIVE: [f64; 4] = [-1e-300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];

fn refuses_not_positive<T: std::fmt::Debug>(new: impl Fn(f64) -> Result<T, LawError>) {
    for bad in NOT_POSITIVE {
        let refused = match new(bad) {
            Err(LawError::NotPositive { value, .. }) => value.to_bits() == bad.to_bits(),
            _ => false,
        };
        assert!(refused, "{bad}");
    }
    assert!(new(0.3).is_ok());
}

fn refuses_negative<T: std::fmt::Debug>(new: impl Fn(f64) -> Result<T, LawError>) {
    for bad in NEGATIVE {
        let refused = match new(bad) {
            Err(LawError::Negative { value, .. }) => value.to_bits() == bad.to_bits(),
            Err(LawError::NegativeFriction { friction }) => friction.to_bits() == bad.to_bits(),
            _ => false,
        };
        assert!(refused, "{bad}");
    }
    assert!(new(0.0).is_ok() && new(0.3).is_ok());
}

#[test]
fn moduli_and_limits() {
    refuses_not_positive(|x| Elastic::new(x, 0.3));
    refuses_not_positive(|x| Uniaxial::new(x, 1.0));
    refuses_not_positive(|x| Uniaxial::new(1.0, x));
    refuses_not_positive(|x| VonMises::new(x, 0.3, 1.0));
    refuses_not_positive(|x| VonMises::new(1.0, 0.3, x));
    refuses_not_positive(VonMisesDissipation::new);
    refuses_not_positive(|x| RegularisedCoulomb::new(0.3, x, 1.0));
    refuses_not_positive(|x| RegularisedCoulomb::new(0.3, 1.0, x));
    refuses_not_positive(|x| AnisotropicCoulomb::new(x, 1.0));
    refuses_not_positive(|x| AnisotropicCoulomb::new(1.0, x));
    refuses_not_positive(|x| DruckerPrager::new(0.5, 0.2, x));
    refuses_not_positive(|x| ArmstrongFrederick::new(x, 1.0, 1.0));
    refuses_not_positive(|x| ArmstrongFrederick::new(1.0, x, 1.0));
    refuses_not_positive(|x| ArmstrongFrederick::new(1.0, 1.0, x));
    refuses_not_positive(CamClay::new);
    refuses_not_positive(|x| Lemaitre::new(x, 1.0, 1.0, 0.1));
    refuses_not_positive(|x| Lemaitre::new(1.0, x, 1.0, 0.1));
    refuses_not_positive(|x| Lemaitre::new(1.0, 1.0, x, 0.1));
}

#[test]
fn hardening_and_friction() {
    let von_mises = |x: f64| VonMises::new(1.0, 0.3, 1.0).map(|law| (law, x));
    refuses_negative(|x| von_mises(x).and_then(|(law, x)| law.with_isotropic(x)));
    refuses_negative(|x| von_mises(x).and_then(|(law, x)| law.with_kinematic(x)));
    refuses_negative(|x| von_mises(x).and_then(|(law, x)| law.with_recall([(x, 1.0)])));
    refuses_negative(|x| von_mises(x).and_then(|(law, x)| law.with_recall([(1.0, x)])));
    refuses_negative(|x| Isotropic::voce(x, 1.0));
    refuses_negative(|x| Isotropic::voce(1.0, x));
    refuses_negative(|x| Isotropic::swift(x, 0.1, 0.2));
    refuses_not_positive(|x| Isotropic::swift(1.0, x, 0.2));
    refuses_negative(|x| Isotropic::swift(1.0, 0.1, x));
    refuses_negative(|x| LimitedCoulomb::new(x, 1.0));
    refuses_negative(|x| LimitedCoulomb::new(0.3, x));
    refuses_negative(Tresca::new);
    refuses_negative(Coulomb::new);
    refuses_negative(|x| RegularisedCoulomb::new(x, 1.0, 1.0));
    refuses_negative(|x| DruckerPrager::new(x, 0.0, 1.0));
}

#[test]
fn tables_and_terms() -> Result<(), LawError> {
    let tables: [(&[[f64; 2]], &str); 5] = [
        (&[], "row 1 of the hardening table is missing"),
        (
            &[[0.1, 300.0]],
            "row 1 of the hardening table does not start at no plastic strain",
        ),
        (
            &[[0.0, 300.0], [0.1, 310.0], [0.1, 320.0]],
            "row 3 of the hardening table does not have more plastic strain than the one before",
        ),
        (
            &[[0.0, 300.0], [0.1, 290.0]],
            "row 2 of the hardening table softens: its stress is below the one before, or the yield stress",
        ),
        (
            &[[0.0, 300.0], [0.1, f64::NAN]],
            "row 2 of the hardening table is not finite",
        ),
    ];
    for (points, message) in tables {
        let error = Isotropic::table(points).expect_err(message);
        assert_eq!(error.to_string(), message);
    }
    Ok(())
}

#[test]
fn intervals() {
    for poisson in [
        0.5,
        -1.0,
        0.6,
        0.5 - 1e-12,
        1e-12 - 1.0,
        f64::NAN,
        f64::INFINITY,
    ] {
        let refused = matches!(
            Elastic::new(1.0, poisson),
            Err(LawError::PoissonOutOfRange { poisson: p }) if p.to_bits() == poisson.to_bits()
        );
        assert!(refused, "{poisson}");
    }
    assert!(Elastic::new(1.0, 0.4999).is_ok() && Elastic::new(1.0, -0.99).is_ok());

    for dilatancy in [-0.1, 0.51, f64::NAN] {
        assert!(matches!(
            DruckerPrager::new(0.5, dilatancy, 1.0),
            Err(LawError::DilatancyOutOfRange { friction: 0.5, .. })
        ));
    }
    for damage in [-0.1, 1.0, f64::NAN] {
        assert!(matches!(
            Lemaitre::new(1.0, 1.0, 1.0, damage),
            Err(LawError::DamageOutOfRange { .. })
        ));
    }
}

#[test]
fn messages_state_the_facts() {
    let message = |result: Result<VonMises, LawError>| result.unwrap_err().to_string();
    assert_eq!(
        message(VonMises::new(210e3, 0.5, 300.0)),
        "Poisson's ratio must lie in ]-1, 0.5[, no nearer to its ends than 1e-9, got 0.5"
    );
    assert_eq!(
        message(VonMises::new(210e3, 0.3, -300.0)),
        "yield stress must be positive and finite, got -300"
    );
}

#[test]
fn getters_return_what_was_given() -> Result<(), LawError> {
    let law = VonMises::new(210e3, 0.3, 300.0)?
        .with_isotropic(1e3)?
        .with_kinematic(2e3)?;
    assert_eq!(
        (law.elastic().young(), law.elastic().poisson()),
        (210e3, 0.3)
    );
    assert_eq!(law.yield_stress(), 300.0);
    assert_eq!(
        (law.isotropic().modulus(7.0), law.kinematic_modulus()),
        (1e3, 2e3)
    );

    let contact = RegularisedCoulomb::new(0.3, 1e5, 1e4)?;
    assert_eq!(contact.coulomb().friction(), 0.3);
    assert_eq!(
        (contact.normal_stiffness(), contact.tangent_stiffness()),
        (1e5, 1e4)
    );
    Ok(())
}
