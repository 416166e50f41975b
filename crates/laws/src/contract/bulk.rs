//! The contract of laws of the bulk; not paths with known answers, which only their author knows.

use super::random::Random;
use super::{Report, Violation};
use crate::bulk::{BulkLaw, COMMON_FIELDS, Numbers, Response};
use moreau_mandel::{Sym2, Sym4, equivalent_strain};

/// Steps that are drawn.
const SAMPLES: usize = 512;
/// Round-off allowed, relative to the size of the terms.
const ROUND_OFF: f64 = 1e-12;
/// Step of the differences, in strains at yield.
const STEP: f64 = 1e-4;
/// Difference between the slopes at one step and at two beyond which there is a kink between, in the
/// elastic stiffness. The onset of flow is told by what flows: slopes across it differ the less the nearer it is, and where
/// a law hardly changes its volume all that flow takes away is small beside the norm.
const KINK: f64 = 1e-6;

/// Checks a law of the bulk from its initial state; the sizes of its strains are found by the way. A law under plane
/// stress, which has a [`BulkLaw::thickness_strain`], is strained in all other components.
///
/// On random paths up to some fifteen times the strain at yield and steps from there:
///
/// - the tangent, with what it lacks, is ∂σ₁/∂Δε by differences, or its symmetric part of a law that
///   has no potential and calls itself symmetric; it is symmetric, and elastic where nothing flows;
/// - the potential's gradient is Δσ, \[65\]; it is convex, nothing at no step, and the energy that is
///   stored and dissipated beyond σ₀ : Δε, \[48\]; tangents lie between 0 and the elastic one;
/// - dissipation and stored energy are not negative, and the work done is both of them up to the second
///   order of the step;
/// - p never falls and is ∫ √(2/3) ‖ε̇ᵖ‖, \[60\], with ε̇ᵖ = ε̇ − C⁻¹ σ̇;
/// - D(ε̇) is convex, homogeneous, at least σ : ε̇ and equal to it at the flow of σ;
/// - no step changes nothing; where nothing flows two halves of a step are the step;
/// - a state is the numbers that it hands on, and has the same fields as any other; what is not a
///   number comes out.
///
/// # Errors
/// The first [`Violation`].
pub fn bulk<L: BulkLaw>(law: &L) -> Result<Report, Violation> {
    bulk_from(law, &law.initial())
}

/// [`bulk`] from another initial state.
///
/// # Errors
/// The first [`Violation`].
pub fn bulk_from<L: BulkLaw>(law: &L, initial: &L::State) -> Result<Report, Violation> {
    let mut random = Random::new();
    let mut report = Report::default();
    let suite = Suite::new(law, initial, &mut random, &mut report)?;
    for _ in 0..SAMPLES {
        let point = suite.draw(&mut random);
        suite.response(&point, &mut report)?;
        suite.energies(&point, &mut report)?;
        suite.flow(&point, &mut report)?;
        suite.power(&point, &mut random, &mut report)?;
        suite.tangent(&point, &mut report)?;
        suite.potential(&point, &mut random, &mut report)?;
        suite.rest(&point, &mut report)?;
        suite.memory(&point, &mut report)?;
    }
    suite.not_a_number(&mut report)?;
    suite.coverage(&mut report)?;
    Ok(report)
}

/// Checks that a law has no axes: a rotated path has the rotated stress and the same energies. For laws
/// that are isotropic, from their initial state.
///
/// # Errors
/// The first [`Violation`].
pub fn isotropy<L: BulkLaw>(law: &L) -> Result<Report, Violation> {
    let mut random = Random::new();
    let mut report = Report::default();
    let initial = law.initial();
    let suite = Suite::new(law, &initial, &mut random, &mut report)?;
    for _ in 0..SAMPLES {
        let point = suite.draw(&mut random);
        let rotated = random.rotation();
        let path: Vec<Sym2> = point.path.iter().map(&rotated).collect();
        let turned = suite.point(path, rotated(&point.d_eps));
        let at = || point.to_string();
        let (a, b) = (&point.response, &turned.response);
        let size = 100.0 * ROUND_OFF * point.reach;
        let stress = (rotated(&a.stress) - b.stress).norm();
        let allowed = size * suite.stiffness;
        report.at_most(
            "a rotated path has the rotated stress",
            (stress, allowed),
            at,
        )?;
        let energies = |p: &Point<L>| {
            let spent = law.dissipation(&p.old, &p.response.state);
            [law.stored_energy(&p.response.state), spent]
        };
        for (a, b) in energies(&point).into_iter().zip(energies(&turned)) {
            let allowed = allowed * point.reach;
            report.at_most(
                "a rotated path has the same energies",
                ((a - b).abs(), allowed),
                at,
            )?;
        }
    }
    Ok(report)
}

/// A law and its sizes.
struct Suite<'a, L: BulkLaw> {
    law: &'a L,
    initial: &'a L::State,
    elastic: Sym4,
    compliance: Sym4,
    /// Norm of the elastic stiffness \[MPa\].
    stiffness: f64,
    /// Strain at yield, or what stands for it where nothing yields.
    strain: f64,
    yields: bool,
    /// Whether the law finds ε₃₃.
    finds_thickness: bool,
}

/// A step of a path.
struct Point<L: BulkLaw> {
    path: Vec<Sym2>,
    old: L::State,
    d_eps: Sym2,
    response: Response<L::State>,
    /// Size of the strains up to here.
    reach: f64,
}

impl<L: BulkLaw> std::fmt::Display for Point<L> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (step, path): (_, Vec<_>) = (self.d_eps.as_slice(), self.path.iter().collect());
        write!(f, "in the step {step:?} after {path:?}")
    }
}

impl<'a, L: BulkLaw> Suite<'a, L> {
    fn new(
        law: &'a L,
        initial: &'a L::State,
        random: &mut Random,
        report: &mut Report,
    ) -> Result<Self, Violation> {
        let elastic = law.elastic_tangent();
        let stiffness = elastic.norm();
        let at = || format!("of {elastic}");
        let unsymmetric = (elastic - elastic.transpose()).norm();
        let property = "the elastic tangent is symmetric";
        report.at_most(property, (unsymmetric, ROUND_OFF * stiffness), at)?;
        let finds_thickness = law.thickness_strain(initial).is_some();
        let mut resisting = elastic;
        if finds_thickness {
            // Nothing resists it: a number in its place leaves the inverse of the others.
            resisting[(2, 2)] += stiffness;
        }
        let least = resisting.symmetric_eigenvalues().min();
        let compliance = resisting.try_inverse().filter(|_| least > 0.0);
        let property = "the elastic tangent is positive definite";
        report.holds(property, compliance.is_some(), at)?;
        // The median over directions of the strain at which something flows.
        let mut sizes: Vec<f64> = (0..33)
            .filter_map(|_| {
                yield_strain(law, initial, &strained(random.direction(), finds_thickness))
            })
            .collect();
        sizes.sort_by(f64::total_cmp);
        Ok(Self {
            law,
            initial,
            elastic,
            compliance: compliance.unwrap_or_default(),
            stiffness,
            strain: sizes.get(sizes.len() / 2).copied().unwrap_or(1e-3),
            yields: !sizes.is_empty(),
            finds_thickness,
        })
    }

    /// A path of up to three steps and a step, some of them small.
    fn draw(&self, random: &mut Random) -> Point<L> {
        let path = (0..random.below(4)).map(|_| self.random(random, 3.0));
        let path: Vec<Sym2> = path.collect();
        let size = [1e-3, 0.3, 5.0, 5.0][random.below(4)];
        self.point(path, self.random(random, size))
    }

    /// A strain of components up to so many times that at yield.
    fn random(&self, random: &mut Random, size: f64) -> Sym2 {
        strained(random.vector(size * self.strain), self.finds_thickness)
    }

    /// The components of a strain that the law does not find itself.
    fn components(&self) -> impl Iterator<Item = usize> + use<L> {
        let finds_thickness = self.finds_thickness;
        (0..6).filter(move |&k| !(finds_thickness && k == 2))
    }

    fn point(&self, path: Vec<Sym2>, d_eps: Sym2) -> Point<L> {
        let step = |state, d_eps| self.law.respond(&state, d_eps).state;
        let old = path.iter().fold(*self.initial, step);
        let walked: f64 = path.iter().map(|d| d.norm()).sum();
        Point {
            response: self.law.respond(&old, &d_eps),
            reach: self.strain + walked + d_eps.norm(),
            path,
            old,
            d_eps,
        }
    }

    /// Round-off of a stress \[MPa\].
    fn stress_error(&self, point: &Point<L>) -> f64 {
        let initial = self.law.stress(self.initial).norm();
        ROUND_OFF * (self.stiffness * point.reach + initial)
    }

    /// Round-off of [`Suite::plastic`].
    fn flow_error(&self, point: &Point<L>) -> f64 {
        10.0 * self.stress_error(point) * self.compliance.norm()
    }

    /// Plastic strain of the step, Δε − C⁻¹ Δσ.
    fn plastic(&self, point: &Point<L>) -> Sym2 {
        let (law, old, new) = (self.law, &point.old, &point.response.state);
        if let [Some(from), Some(to)] = [old, new].map(|s| law.thickness_strain(s)) {
            let mut flow = point.d_eps - (law.elastic_strain(new) - law.elastic_strain(old));
            flow[2] += to - from;
            return flow;
        }
        point.d_eps - self.compliance * (point.response.stress - law.stress(old))
    }

    fn response(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let (law, response, at) = (self.law, &point.response, || point.to_string());
        let error = (law.stress(&response.state) - response.stress).norm();
        let property = "the stress of the response is that of its state";
        report.at_most(property, (error, self.stress_error(point)), at)?;
        let unsymmetric = (response.tangent - response.tangent.transpose()).norm();
        let allowed = ROUND_OFF * self.stiffness;
        report.at_most("the tangent is symmetric", (unsymmetric, allowed), at)?;
        if !response.flows {
            let error = (response.tangent - self.elastic).norm();
            let property = "where nothing flows the tangent is elastic";
            report.at_most(property, (error, allowed), at)?;
        }
        Ok(())
    }

    fn energies(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let (old, new) = (&point.old, &point.response.state);
        let (stored, dissipated) = (law.stored_energy(new), law.dissipation(old, new));
        let round_off = self.stress_error(point) * point.reach;
        report.at_most("dissipation is not negative", (-dissipated, round_off), at)?;
        report.at_most("stored energy is not negative", (-stored, round_off), at)?;
        let work = point.response.stress.dot(&point.d_eps);
        let rest = work - (stored - law.stored_energy(old)) - dissipated;
        let second_order = 4.0 * (self.elastic * point.d_eps).dot(&point.d_eps);
        let property = "work is stored or dissipated, to the second order";
        report.at_most(property, (rest.abs(), second_order + round_off), at)
    }

    fn flow(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let p = |state: &L::State| law.equivalent_plastic_strain(state);
        let d_p = p(&point.response.state) - p(&point.old);
        report.holds("p does not fall", d_p >= 0.0, at)?;
        report.holds(
            "p grows only where it flows",
            point.response.flows || d_p == 0.0,
            at,
        )?;
        let error = (d_p - equivalent_strain(&self.plastic(point))).abs();
        report.at_most("p is ∫ √(2/3) ‖ε̇ᵖ‖", (error, self.flow_error(point)), at)
    }

    fn power(
        &self,
        point: &Point<L>,
        random: &mut Random,
        report: &mut Report,
    ) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let stress = point.response.stress;
        let power = |rate: &Sym2| Some(law.flow_power(&point.response.state, rate)?.total);
        let [a, b] = [0, 1].map(|_| self.random(random, 1.0));
        let (Some(of_a), Some(of_b)) = (power(&a), power(&b)) else {
            return Ok(());
        };
        let round_off = 10.0 * self.stress_error(point) * (self.strain + point.d_eps.norm());
        let [of_mean, of_twice] = [0.5 * (a + b), 2.0 * a].map(|r| power(&r).unwrap_or(f64::NAN));
        let short = stress.dot(&a) - of_a;
        report.at_most("D(ε̇) is at least σ : ε̇", (short, round_off), at)?;
        let error = (of_twice - 2.0 * of_a).abs();
        report.at_most("D(ε̇) is homogeneous", (error, round_off), at)?;
        let above = of_mean - 0.5 * (of_a + of_b);
        report.at_most("D(ε̇) is convex", (above, round_off), at)?;
        let flow = self.plastic(point);
        let error = (power(&flow).unwrap_or(f64::NAN) - stress.dot(&flow)).abs();
        // The flow is found with the inverse of the elastic tangent.
        let allowed = round_off + self.flow_error(point) * stress.norm();
        report.at_most("D(ε̇) is σ : ε̇ at the flow", (error, allowed), at)
    }

    /// By differences of fourth order in every column, off the kinks.
    fn tangent(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let lacking = law.lacking(&point.old, &point.d_eps);
        if law.is_symmetric() {
            let property = "a symmetric law lacks nothing";
            report.at_most(property, (lacking.norm(), 0.0), at)?;
        }
        let skew = law.skew(&point.old, &point.d_eps);
        let error = (skew + skew.transpose()).norm();
        report.at_most("the skew part of the tangent is skew", (error, 0.0), at)?;
        let h = STEP * self.strain;
        let (mut near, mut far) = (Sym4::zeros(), Sym4::zeros());
        let mut alike = true;
        for k in self.components() {
            let mut slope = |h: f64| {
                let mut step = Sym2::zeros();
                step[k] = h;
                let ends = [point.d_eps + step, point.d_eps - step];
                let [to, from] = ends.map(|d_eps| law.respond(&point.old, &d_eps));
                alike &= [&to, &from].iter().all(|r| r.flows == point.response.flows);
                (to.stress - from.stress) / (2.0 * h)
            };
            near.set_column(k, &slope(h));
            far.set_column(k, &slope(2.0 * h));
        }
        let kink = (near - far).norm();
        if !alike || kink > KINK * self.stiffness {
            return Ok(());
        }
        let mut derivative = (4.0 * near - far) / 3.0;
        let has_potential = law.potential(&point.old, &point.d_eps).is_some();
        if law.is_symmetric() && !has_potential && skew.norm() == 0.0 {
            derivative = 0.5 * (derivative + derivative.transpose());
        }
        let error = (point.response.tangent + lacking + skew - derivative).norm();
        let property = if point.response.flows {
            FLOWING
        } else {
            ELASTIC
        };
        report.at_most(property, (error, 1e-7 * self.stiffness + kink), at)
    }

    fn potential(
        &self,
        point: &Point<L>,
        random: &mut Random,
        report: &mut Report,
    ) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let Point { old, d_eps, .. } = point;
        let potential = |d_eps: &Sym2| law.potential(old, d_eps).unwrap_or(f64::NAN);
        let Some(value) = law.potential(old, d_eps) else {
            return Ok(());
        };
        let (new, stress, before) = (
            &point.response.state,
            point.response.stress,
            law.stress(old),
        );
        let round_off = self.stress_error(point) * point.reach;
        // The potential is C¹: a kink of the tangent costs no more than C h.
        let h = 0.1 * STEP * self.strain;
        let d = strained(random.direction(), self.finds_thickness);
        let slope = (potential(&(d_eps + h * d)) - potential(&(d_eps - h * d))) / (2.0 * h);
        let error = (slope - (stress - before).dot(&d)).abs();
        let allowed = 2.0 * self.stiffness * h + round_off / h * 1e-3;
        report.at_most("the gradient of the potential is Δσ", (error, allowed), at)?;
        let other = self.random(random, 3.0);
        let above = potential(&(0.5 * (d_eps + other))) - 0.5 * (value + potential(&other));
        report.at_most("the potential is convex", (above, 10.0 * round_off), at)?;
        let spent = law.stored_energy(new) - law.stored_energy(old) + law.dissipation(old, new);
        let error = (value - spent + before.dot(d_eps)).abs();
        let property = "the potential is what is stored and dissipated";
        report.at_most(property, (error, 10.0 * round_off), at)?;
        let tangent = point.response.tangent;
        for (property, part) in [
            ("tangents are not negative", tangent),
            ("tangents are below the elastic one", self.elastic - tangent),
        ] {
            let least = part.symmetric_eigenvalues().min();
            report.at_most(property, (-least, 10.0 * ROUND_OFF * self.stiffness), at)?;
        }
        Ok(())
    }

    fn rest(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let (law, at) = (self.law, || point.to_string());
        let (new, none) = (&point.response.state, Sym2::zeros());
        let still = law.respond(new, &none);
        let p = |state: &L::State| law.equivalent_plastic_strain(state);
        let error = (still.stress - point.response.stress).norm();
        let round_off = self.stress_error(point);
        report.at_most("no step leaves the stress", (error, round_off), at)?;
        let error = (p(&still.state) - p(new)).abs();
        report.at_most("no step leaves p", (error, ROUND_OFF * point.reach), at)?;
        let lost = law.dissipation(new, new).abs();
        report.at_most(
            "no step dissipates nothing",
            (lost, round_off * point.reach),
            at,
        )?;
        if let Some(value) = law.potential(new, &none) {
            let allowed = round_off * point.reach;
            report.at_most("no step has no potential", (value.abs(), allowed), at)?;
        }
        if point.response.flows {
            return Ok(());
        }
        let half = law.respond(&point.old, &(0.5 * point.d_eps)).state;
        let twice = law.respond(&half, &(0.5 * point.d_eps));
        let error = (twice.stress - point.response.stress).norm();
        report.at_most(
            "halves of an elastic step are the step",
            (error, round_off),
            at,
        )
    }

    /// A state that is written number by number and read into another is the same.
    fn memory(&self, point: &Point<L>, report: &mut Report) -> Result<(), Violation> {
        let at = || point.to_string();
        let mut numbers = Vec::new();
        let (mut state, mut read) = (point.response.state, *self.initial);
        state.visit(&mut |x| numbers.push(*x));
        let mut next = numbers.iter();
        let mut missing = 0;
        read.visit(&mut |x| match next.next() {
            Some(&number) => *x = number,
            None => missing += 1,
        });
        let complete = missing == 0 && next.next().is_none() && read == point.response.state;
        report.holds("a state is its numbers", complete, at)?;
        let names = |state: &L::State| {
            let mut names = Vec::new();
            self.law.fields(state, &mut |name, values| {
                names.push((name.to_owned(), values.len()));
            });
            names
        };
        let own = names(&point.response.state);
        let same = own == names(self.initial);
        report.holds("fields are the same in every state", same, at)?;
        let fit = own.iter().all(|(name, count)| {
            let words = name
                .bytes()
                .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
            let taken = COMMON_FIELDS.contains(&name.as_str());
            words && !taken && !name.is_empty() && [1, 3, 6].contains(count)
        });
        report.holds("fields are words of 1, 3 or 6 components", fit, at)
    }

    fn not_a_number(&self, report: &mut Report) -> Result<(), Violation> {
        for i in self.components() {
            let mut d_eps = Sym2::from_element(self.strain);
            d_eps[i] = f64::NAN;
            let response = self.law.respond(self.initial, &d_eps);
            let out = response.stress.iter().any(|c| c.is_nan());
            let potential = self.law.potential(self.initial, &d_eps);
            let out = out && potential.is_none_or(f64::is_nan);
            let at = || format!("of component {i} of the strain");
            report.holds("what is not a number comes out", out, at)?;
        }
        Ok(())
    }

    /// The tangent was compared both where something flows and where nothing does.
    fn coverage(&self, report: &mut Report) -> Result<(), Violation> {
        let (flowing, elastic) = (report.count(FLOWING), report.count(ELASTIC));
        let least = SAMPLES / 16;
        let enough = !self.yields || (flowing >= least && elastic >= least);
        report.holds("samples flow, and do not", enough, || {
            format!("of {SAMPLES}: {flowing} flow off a kink, {elastic} do not")
        })
    }
}

/// A strain, without that of the thickness where the law finds that.
fn strained(mut strain: Sym2, finds_thickness: bool) -> Sym2 {
    if finds_thickness {
        strain[2] = 0.0;
    }
    strain
}

const FLOWING: &str = "the tangent of flow is the derivative of the stress";
const ELASTIC: &str = "the elastic tangent is the derivative of the stress";

/// The size, to a few per cent, of the strain in a direction at which something flows.
fn yield_strain<L: BulkLaw>(law: &L, initial: &L::State, direction: &Sym2) -> Option<f64> {
    let mut sizes = (0..700).map(|k| 1e-9 * 1.04f64.powi(k));
    sizes.find(|size| law.respond(initial, &(direction * *size)).flows)
}
