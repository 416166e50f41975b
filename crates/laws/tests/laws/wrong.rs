//! Laws that are wrong in one place each, which the contract refuses, and those of the house, which it
//! does not.

use moreau_laws::contract::{Report, Violation, bulk, friction, isotropy};
use moreau_laws::{
    AnisotropicCoulomb, BulkLaw, Coulomb, DruckerPrager, DruckerPragerState, Elastic,
    ElasticDruckerPrager, FlowPower, Friction, Isotropic, LawError, LimitedCoulomb, Local, Numbers,
    Response, ShearBound, Tresca, VonMises,
};
use moreau_mandel::{Sym2, Sym4};

/// What is wrong with a law.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// 1 % in the tangent of flow.
    Tangent,
    /// 10⁻⁶ of the elastic stiffness in the tangent of flow.
    Slightly,
    /// As much in the tangent everywhere.
    Elastic,
    /// An unsymmetric entry of 10⁻⁶ of it.
    Unsymmetric,
    /// Flow that is not told.
    Silent,
    /// p falls.
    Sign,
    /// p = ∫ ‖ε̇ᵖ‖.
    Norm,
    /// 1 % of the dissipation is forgotten.
    Dissipation,
    /// As much is gained.
    Gain,
    /// The potential without its linear part.
    Linear,
    /// A potential 1 % too large.
    Potential,
    /// D(ε̇) 1 % too small.
    Power,
    /// What is lacking is forgotten.
    Lacking,
    /// p is not written.
    Memory,
    /// A field that comes with flow.
    Fields,
    /// A strain that is not a number counts as none.
    Number,
    /// Stress along the first axis only.
    Axis,
}

/// A state that may forget a number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State<S>(S, bool);

impl<S: Numbers> Numbers for State<S> {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let (mut count, mut index) = (0, 0);
        self.0.visit(&mut |_| count += 1);
        let forgets = self.1;
        self.0.visit(&mut |x| {
            index += 1;
            if !forgets || index < count {
                each(x);
            }
        });
    }
}

/// A law with a fault.
#[derive(Debug, Clone)]
struct Wrong<L>(L, Fault);

impl<L: BulkLaw> Wrong<L> {
    /// 10⁻⁶ of the elastic stiffness, alike in all components.
    fn excess(&self) -> Sym4 {
        let share = 1e-6 * self.0.elastic_tangent().norm() / Sym4::identity().norm();
        share * Sym4::identity()
    }
}

impl<L: BulkLaw> BulkLaw for Wrong<L>
where
    L::State: 'static,
{
    type State = State<L::State>;

    fn initial(&self) -> Self::State {
        State(self.0.initial(), false)
    }

    fn fields(&self, state: &Self::State, each: &mut dyn FnMut(&str, &[f64])) {
        if self.1 != Fault::Fields || self.0.equivalent_plastic_strain(&state.0) > 0.0 {
            self.0.fields(&state.0, each);
        }
    }

    fn respond(&self, old: &Self::State, d_eps: &Sym2) -> Response<Self::State> {
        let mut d_eps = *d_eps;
        if self.1 == Fault::Number {
            d_eps = d_eps.map(|c| if c.is_nan() { 0.0 } else { c });
        }
        if self.1 == Fault::Axis {
            d_eps[0] *= 1.001;
        }
        let of = self.0.respond(&old.0, &d_eps);
        let mut tangent = of.tangent;
        match self.1 {
            Fault::Tangent if of.flows => tangent *= 1.01,
            Fault::Slightly if of.flows => tangent += self.excess(),
            Fault::Elastic => tangent += self.excess(),
            Fault::Unsymmetric => tangent[(0, 1)] *= 1.0 + 1e-6,
            _ => {}
        }
        Response {
            stress: of.stress,
            tangent,
            flows: of.flows && self.1 != Fault::Silent,
            state: State(of.state, self.1 == Fault::Memory),
        }
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric()
    }

    fn lacking(&self, old: &Self::State, d_eps: &Sym2) -> Sym4 {
        match self.1 {
            Fault::Lacking => Sym4::zeros(),
            _ => self.0.lacking(&old.0, d_eps),
        }
    }

    fn stress(&self, state: &Self::State) -> Sym2 {
        self.0.stress(&state.0)
    }

    fn elastic_tangent(&self) -> Sym4 {
        let of = self.0.elastic_tangent();
        match self.1 {
            Fault::Elastic => of + self.excess(),
            _ => of,
        }
    }

    fn stored_energy(&self, state: &Self::State) -> f64 {
        self.0.stored_energy(&state.0)
    }

    fn dissipation(&self, old: &Self::State, new: &Self::State) -> f64 {
        let of = self.0.dissipation(&old.0, &new.0);
        match self.1 {
            Fault::Dissipation => 0.99 * of,
            Fault::Gain => -of,
            _ => of,
        }
    }

    fn equivalent_plastic_strain(&self, state: &Self::State) -> f64 {
        let p = self.0.equivalent_plastic_strain(&state.0);
        match self.1 {
            Fault::Sign => -p,
            Fault::Norm => 1.5f64.sqrt() * p,
            _ => p,
        }
    }

    fn potential(&self, old: &Self::State, d_eps: &Sym2) -> Option<f64> {
        let of = self.0.potential(&old.0, d_eps)?;
        Some(match self.1 {
            Fault::Linear => of + self.stress(old).dot(d_eps),
            Fault::Potential => 1.01 * of,
            _ => of,
        })
    }

    fn flow_power(&self, state: &Self::State, rate: &Sym2) -> Option<FlowPower> {
        let mut of = self.0.flow_power(&state.0, rate)?;
        if self.1 == Fault::Power {
            of.total *= 0.99;
        }
        Some(of)
    }
}

fn steel() -> Result<VonMises, LawError> {
    VonMises::new(210e3, 0.3, 300.0)?
        .with_isotropic(2e3)?
        .with_kinematic(5e3)
}

fn soil(dilatancy: f64) -> Result<ElasticDruckerPrager, LawError> {
    ElasticDruckerPrager::new(50.0, 0.3, DruckerPrager::new(0.7, dilatancy, 1.3)?)
}

/// The property that a fault violates.
fn refused(result: Result<Report, Violation>, fault: Fault) -> &'static str {
    match result {
        Ok(report) => panic!("{fault:?} is not noticed:\n{report}"),
        Err(violation) => violation.property,
    }
}

#[test]
fn a_law_with_one_fault_is_refused() -> Result<(), LawError> {
    let of_flow = "the tangent of flow is the derivative of the stress";
    let potential = "the potential is what is stored and dissipated";
    let p = "p is ∫ √(2/3) ‖ε̇ᵖ‖";
    bulk(&Wrong(steel()?, Fault::None)).expect("a law");
    bulk(&Wrong(soil(0.2)?, Fault::None)).expect("a law");
    for (fault, property) in [
        (Fault::Tangent, of_flow),
        (Fault::Slightly, of_flow),
        (Fault::Elastic, p),
        (Fault::Unsymmetric, "the tangent is symmetric"),
        (Fault::Silent, "where nothing flows the tangent is elastic"),
        (Fault::Sign, "p does not fall"),
        (Fault::Norm, p),
        (Fault::Dissipation, potential),
        (Fault::Gain, "dissipation is not negative"),
        (Fault::Linear, "the gradient of the potential is Δσ"),
        (Fault::Potential, "the gradient of the potential is Δσ"),
        (Fault::Power, "D(ε̇) is σ : ε̇ at the flow"),
        (Fault::Memory, "a state is its numbers"),
        (Fault::Fields, "fields are the same in every state"),
        (Fault::Number, "what is not a number comes out"),
    ] {
        assert_eq!(
            refused(bulk(&Wrong(steel()?, fault)), fault),
            property,
            "{fault:?}"
        );
    }
    for (fault, property) in [
        (Fault::Tangent, of_flow),
        (Fault::Norm, p),
        (Fault::Sign, "p does not fall"),
        (Fault::Lacking, of_flow),
        (
            Fault::Dissipation,
            "work is stored or dissipated, to the second order",
        ),
    ] {
        assert_eq!(
            refused(bulk(&Wrong(soil(0.2)?, fault)), fault),
            property,
            "{fault:?}"
        );
    }
    let axis = refused(isotropy(&Wrong(steel()?, Fault::Axis)), Fault::Axis);
    assert_eq!(axis, "a rotated path has the rotated stress");
    Ok(())
}

/// A law whose softest direction is far softer than its norm obeys: what is allowed is of the size of what differs there.
#[test]
fn a_law_that_hardly_changes_its_volume_obeys_the_contract() -> Result<(), LawError> {
    let of_flow = "the tangent of flow is the derivative of the stress";
    for nu in [0.499, 0.4999, 0.49999, 0.499_999, 0.499_999_99, -0.999] {
        let law = VonMises::new(210e3, nu, 300.0)?.with_isotropic(2e3)?;
        for report in [bulk(&law), bulk(&Elastic::new(210e3, nu)?), isotropy(&law)] {
            report.unwrap_or_else(|violation| panic!("{nu}: {violation}"));
        }
        assert!(bulk(&law).is_ok_and(|report| report.count(of_flow) > 100));
        let soil = ElasticDruckerPrager::new(50.0, nu, DruckerPrager::new(0.7, 0.7, 1.3)?)?;
        bulk(&soil).unwrap_or_else(|violation| panic!("{nu}: {violation}"));
    }
    Ok(())
}

/// A violation says where: the law, the step and the path to it.
#[test]
fn a_violation_tells_the_sample() -> Result<(), LawError> {
    let violation = bulk(&Wrong(steel()?, Fault::Norm)).expect_err("a fault");
    let text = violation.to_string();
    assert!(
        text.starts_with("violated: p is ∫ √(2/3) ‖ε̇ᵖ‖; found "),
        "{text}"
    );
    assert!(
        text.contains("in the step [") && text.contains("] after ["),
        "{text}"
    );
    assert!(violation.found > violation.allowed);
    Ok(())
}

/// Every law of the bulk, of every kind: elastic, with a potential or none, with recall.
#[test]
fn the_laws_of_the_bulk_obey_the_contract() -> Result<(), Box<dyn std::error::Error>> {
    let tangent = "the tangent of flow is the derivative of the stress";
    assert_eq!(bulk(&Elastic::new(210e3, 0.3)?)?.count(tangent), 0);
    assert!(bulk(&steel()?)?.count(tangent) > 100);
    for dilatancy in [0.0, 0.25, 0.7] {
        assert!(bulk(&soil(dilatancy)?)?.count(tangent) > 50);
        isotropy(&soil(dilatancy)?)?;
    }
    let chaboche = VonMises::new(210e3, 0.3, 300.0)?
        .with_hardening(Isotropic::voce(60.0, 30.0)?)
        .with_kinematic(2e3)?
        .with_recall([(60e3, 400.0), (15e3, 80.0)])?;
    assert!(bulk(&chaboche)?.count(tangent) > 100);
    isotropy(&chaboche)?;
    Ok(())
}

#[test]
fn the_laws_of_friction_obey_the_contract() -> Result<(), Box<dyn std::error::Error>> {
    for mu in [0.0, 0.1, 1.0, 3.0] {
        friction::<2>(Coulomb::new(mu)?)?;
        friction::<3>(Coulomb::new(mu)?)?;
    }
    for limit in [0.0, 1.0, 300.0] {
        friction::<2>(Tresca::new(limit)?)?;
        friction::<3>(Tresca::new(limit)?)?;
        friction::<2>(LimitedCoulomb::new(0.4, limit)?)?;
        friction::<3>(LimitedCoulomb::new(0.4, limit)?)?;
    }
    friction::<3>(AnisotropicCoulomb::new(0.2, 0.6)?)?;
    Ok(())
}

/// g = g₀ (1 − exp(−μ t_n/g₀)), with a fault.
#[derive(Debug)]
struct Saturating(Kind);

/// What is wrong with a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Right,
    /// 1 % in the slope.
    Slope,
    /// A bound that falls in the end.
    Falls,
    /// A bound that is not concave: its forces are not convex.
    Convex,
    /// A slope that is infinite at no pressure.
    Steep,
    /// A bound that is negative.
    Negative,
}

impl ShearBound for Saturating {
    fn bound(&self, t_n: f64) -> f64 {
        let g = -30.0 * (-0.4 * t_n / 30.0).exp_m1();
        match self.0 {
            Kind::Falls => 0.4 * t_n * (1.0 - t_n / 2e4),
            Kind::Convex => 0.4 * t_n + 1e-6 * t_n * t_n,
            Kind::Steep => t_n.sqrt(),
            Kind::Negative => -g,
            _ => g,
        }
    }

    fn slope(&self, t_n: f64) -> f64 {
        let slope = 0.4 * (-0.4 * t_n / 30.0).exp();
        match self.0 {
            Kind::Slope => 1.01 * slope,
            Kind::Falls => 0.4 * (1.0 - t_n / 1e4),
            Kind::Convex => 0.4 + 2e-6 * t_n,
            Kind::Steep => 0.5 / t_n.sqrt(),
            Kind::Negative => -slope,
            Kind::Right => slope,
        }
    }
}

/// Coulomb's law as a bound.
#[derive(Debug)]
struct Cone;

impl ShearBound for Cone {
    fn bound(&self, t_n: f64) -> f64 {
        0.3 * t_n
    }

    fn slope(&self, _: f64) -> f64 {
        0.3
    }
}

#[test]
fn a_bound_of_a_user_is_a_law_of_friction() -> Result<(), Box<dyn std::error::Error>> {
    static RIGHT: Saturating = Saturating(Kind::Right);
    for report in [friction::<2>(&RIGHT)?, friction::<3>(&RIGHT)?] {
        assert!(report.count("the derivatives of the correction") > 1000);
    }
    static WRONG: [(Saturating, &str); 5] = [
        (Saturating(Kind::Slope), "the derivatives of the correction"),
        (Saturating(Kind::Falls), "the bound does not fall"),
        (Saturating(Kind::Convex), "the bound is concave"),
        (
            Saturating(Kind::Steep),
            "the slope is finite at no pressure",
        ),
        (Saturating(Kind::Negative), "the bound is not negative"),
    ];
    for (law, property) in &WRONG {
        match friction::<3>(law) {
            Ok(report) => panic!("{law:?} is not noticed:\n{report}"),
            Err(violation) => assert_eq!(violation.property, *property, "{violation}"),
        }
    }
    // A cone as a bound projects as the cone does.
    static CONE: Cone = Cone;
    let (bounded, coulomb) = (Friction::from(&CONE), Friction::from(Coulomb::new(0.3)?));
    for q in [
        [1.0, 0.2, 0.1],
        [1.0, 3.0, -4.0],
        [-1.0, 5.0, 1.0],
        [-5.0, 1.0, 0.0],
    ] {
        let q = Local::<3>::from(q);
        let error = (bounded.scaled(3.0).project(&q) - coulomb.project(&q)).norm();
        assert!(error < 1e-12, "{error:e} at {q}");
    }
    assert_eq!(bounded.coefficient(), 0.3);
    assert!(bounded.resists_slip() && bounded == Friction::from(&CONE));
    assert!(bounded != bounded.scaled(2.0));
    Ok(())
}

/// A soil starts at the state that its type has by default.
#[test]
fn a_report_lists_what_was_checked() -> Result<(), Box<dyn std::error::Error>> {
    assert_eq!(
        soil(0.0)?.stress(&DruckerPragerState::default()),
        Sym2::zeros()
    );
    let report = bulk(&soil(0.0)?)?;
    assert_eq!(report.count("the potential is convex"), 0);
    assert_eq!(report.count("dissipation is not negative"), 512);
    assert!(
        report
            .checks()
            .iter()
            .all(|c| c.worst <= 1.0 && c.count > 0)
    );
    assert_eq!(report.to_string().lines().count(), report.checks().len());
    Ok(())
}
