//! The contact problems, and what is read off a pair (u, t) of any of them; not how they are solved.

mod blocks;
mod condensed;
mod local;

pub use blocks::BlockMatrix;
pub(crate) use blocks::Factor;
pub use condensed::CondensedProblem;
pub(crate) use local::over;
pub use local::{LocalProblem, Residual};

use moreau_laws::{Friction, Local, Status};
use nalgebra::DVector;

/// What a caller must give.
const PAIRS: &str = "a pair (u, t) a law";

/// How far a pair (u, t) is from the contact law: the bipotential gap and what it cannot see.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// Σ b(−u, t) + t·u ≥ 0 over the contacts, of Coulomb's law \[38\] and \[39\]: zero exactly at
    /// the law \[N·mm\].
    pub bipotential_gap: f64,
    /// Largest penetration ⟨−u_n⟩ \[mm\], where b_c = +∞; the gap above is taken at max(u_n, 0). Of a tie the largest
    /// component of u, and zero.
    pub penetration: f64,
    /// Largest distance of a force to the admissible ones \[N\], the Coulomb cone, where b_c = +∞; the gap above is
    /// taken at its projection.
    pub excess_force: f64,
}

impl Certificate {
    /// The certificate of displacements u and forces t under the laws; where one is no number the
    /// penetration or the excess is infinite.
    ///
    /// # Panics
    /// If there are not as many displacements and forces as laws.
    pub fn new<const D: usize>(
        laws: &[impl Copy + Into<Friction>],
        u: &[Local<D>],
        t: &[Local<D>],
    ) -> Self {
        assert_eq!([u.len(), t.len()], [laws.len(); 2], "{PAIRS}");
        let mut certificate = Self::default();
        for ((&law, u), t) in laws.iter().zip(u).zip(t) {
            let law: Friction = law.into();
            let admissible = law.project(t);
            let open = law.admissible(u);
            let (apart, outside) = (open - u, (t - admissible).norm());
            certificate.penetration = certificate.penetration.max(largest(&apart));
            certificate.excess_force = certificate.excess_force.max(largest([&outside]));
            certificate.bipotential_gap += law.b(&-open, &admissible) + admissible.dot(&open);
        }
        certificate
    }
}

/// Status of every contact at (u, t), \[35\], predicted with the parameter α \[N/mm\] of each.
pub(crate) fn statuses<const D: usize>(
    laws: &[Friction],
    u: &[Local<D>],
    t: &[Local<D>],
    alpha: impl Fn(usize) -> f64,
) -> Vec<Status> {
    assert_eq!([u.len(), t.len()], [laws.len(); 2], "{PAIRS}");
    let status = |(i, law): (usize, &Friction)| law.status(&u[i], &t[i], alpha(i));
    laws.iter().enumerate().map(status).collect()
}

/// Largest ratio μ/μ_c over some contacts with its contact, 1/μ_c = |d|; `None` without contacts.
///
/// d(i) is the tangential displacement of contact i over its normal one under a normal force, all other
/// contacts as the problem says. A single plane contact has exactly one solution for μ < μ_c. From μ_c on
/// it may have several, lose the path of its load, or wedge (A. Klarbring, *Ingenieur-Archiv* 60 (1990)
/// 529-541). Together contacts may have several solutions at smaller ratios, and need not have them at
/// larger ones, nor in space: it is an indicator, not a bound.
fn criticality<const D: usize>(
    laws: &[Friction],
    contacts: impl Iterator<Item = usize>,
    d: impl Fn(usize) -> Local<D>,
) -> Option<(usize, f64)> {
    let ratio = |i: usize| {
        // Between stretched vectors an anisotropic law is isotropic.
        let moved = d(i).component_mul(&laws[i].stretch());
        (i, laws[i].coefficient() * moved.norm())
    };
    contacts.map(ratio).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Largest absolute value; infinite where there is a NaN, which [`f64::max`] passes over.
pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let larger = |most: f64, v: &f64| match v.is_nan() {
        true => f64::INFINITY,
        false => most.max(v.abs()),
    };
    values.into_iter().fold(0.0, larger)
}

/// Norm of the natural map at (u, t) \[N\]; infinite where one of the two is no number, which the projection may pass over.
pub(crate) fn size_of_map<const D: usize>(map: &Local<D>, u: &Local<D>, t: &Local<D>) -> f64 {
    match u.iter().chain(t).all(|v| v.is_finite()) {
        true => largest([&map.norm()]),
        false => f64::INFINITY,
    }
}

/// Splits a vector of all components into contacts.
pub(crate) fn split<const D: usize>(all: &DVector<f64>) -> Vec<Local<D>> {
    all.as_slice()
        .chunks_exact(D)
        .map(Local::from_column_slice)
        .collect()
}

/// All components of all contacts in one vector.
pub(crate) fn stack<const D: usize>(t: &[Local<D>]) -> DVector<f64> {
    DVector::from_iterator(D * t.len(), t.iter().flat_map(|t| (0..D).map(|k| t[k])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::Coulomb;

    #[test]
    fn certificate_is_zero_on_the_law_and_counts_what_is_lost() {
        let law = [Coulomb::new(0.5).expect("valid")];
        // Slip against the force: b_c = t·(−u).
        let exact = Certificate::new(
            &law,
            &[Local::<2>::new(0.0, -0.1)],
            &[Local::<2>::new(2.0, 1.0)],
        );
        assert!(exact.bipotential_gap.abs() < 1e-15 && exact.penetration == 0.0);
        // Slip along the force dissipates a negative power: the gap is 2 μ t_n |u_t|.
        let wrong = Certificate::new(
            &law,
            &[Local::<2>::new(0.0, 0.1)],
            &[Local::<2>::new(2.0, 1.0)],
        );
        assert!((wrong.bipotential_gap - 0.2).abs() < 1e-15);
        // An open gap under load: t_n u_n.
        let open = Certificate::new(
            &law,
            &[Local::<2>::new(0.3, 0.0)],
            &[Local::<2>::new(2.0, 0.0)],
        );
        assert!((open.bipotential_gap - 0.6).abs() < 1e-15);
        let outside = Certificate::new(
            &law,
            &[Local::<2>::new(-0.3, 0.0)],
            &[Local::<2>::new(-1.0, 0.0)],
        );
        assert_eq!((outside.penetration, outside.excess_force), (0.3, 1.0));
    }

    #[test]
    fn what_is_no_number_is_not_certified() {
        let law = [Coulomb::new(0.5).expect("valid")];
        for k in 0..2 {
            let mut nan = Local::<2>::zeros();
            nan[k] = f64::NAN;
            let certificate = |u, t| Certificate::new(&law, &[u], &[t]);
            assert_eq!(certificate(nan, Local::zeros()).penetration, f64::INFINITY);
            assert_eq!(certificate(Local::zeros(), nan).excess_force, f64::INFINITY);
        }
    }

    #[test]
    #[should_panic(expected = "a pair (u, t) a law")]
    fn a_certificate_is_one_of_all_contacts() {
        let law = [Coulomb::new(0.5).expect("valid"); 2];
        let _ = Certificate::new(&law, &[Local::<2>::zeros(); 2], &[]);
    }
}
