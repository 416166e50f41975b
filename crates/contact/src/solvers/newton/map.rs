//! The equations that Newton's method on u = W r + q solves in place of the contact law, and their
//! derivatives; not the method.

use crate::solvers::one_contact::Bound;
use moreau_laws::{Friction, Local};
use nalgebra::SMatrix;

/// The equation F(r, u) = 0 that Newton's method solves in place of the contact law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NewtonMap {
    /// P. Alart and A. Curnier's augmented Lagrangian: r_n = (r_n − ρ_n u_n)⁺, and r_t the
    /// projection of r_t − ρ_t u_t on the disc of radius g((r_n − ρ_n u_n)⁺) (*Comput. Methods Appl.
    /// Mech. Engrg.* 92 (1991) 353-375).
    #[default]
    AlartCurnier,
    /// The same with the disc of radius g(r_n⁺), after M. Jean and J. J. Moreau.
    JeanMoreau,
    /// The natural map of the law, \[90′\]: r − proj(r − ρ ũ, K_μ) where the forces fill a cone.
    Natural,
}

/// F of a contact with its derivatives: dF = A dr + B du.
pub(super) struct Linearised<const D: usize> {
    pub(super) map: Local<D>,
    pub(super) force: SMatrix<f64, D, D>,
    pub(super) displacement: SMatrix<f64, D, D>,
}

impl NewtonMap {
    /// F and its derivatives at (r, u), with ρ of every component.
    pub(super) fn linearise<const D: usize>(
        self,
        law: &Friction,
        rho: &Local<D>,
        r: &Local<D>,
        u: &Local<D>,
    ) -> Linearised<D> {
        if self == Self::Natural || law.is_tie() {
            let rho = rho.mean();
            let (projector, displacement) = law.correct_jacobian(u, r, rho);
            return Linearised {
                map: law.natural_map(u, r, rho),
                force: SMatrix::identity() - projector,
                displacement,
            };
        }
        let bound = Bound::of(law);
        if !matches!(law, Friction::Anisotropic(_)) {
            return self.disc(bound, rho, r, u);
        }
        // Between stretched vectors the law is isotropic.
        let m: Local<D> = law.stretch();
        let at = self.disc(bound, rho, &r.component_div(&m), &u.component_mul(&m));
        Linearised {
            map: at.map.component_mul(&m),
            force: SMatrix::from_fn(|k, l| m[k] * at.force[(k, l)] / m[l]),
            displacement: SMatrix::from_fn(|k, l| m[k] * at.displacement[(k, l)] * m[l]),
        }
    }

    /// The maps that project the shear on a disc.
    fn disc<const D: usize>(
        self,
        bound: Bound,
        rho: &Local<D>,
        r: &Local<D>,
        u: &Local<D>,
    ) -> Linearised<D> {
        let mut at = Linearised {
            map: Local::zeros(),
            force: SMatrix::zeros(),
            displacement: SMatrix::zeros(),
        };
        let prediction = r - rho.component_mul(u);
        if prediction[0] > 0.0 {
            at.map[0] = rho[0] * u[0];
            at.displacement[(0, 0)] = rho[0];
        } else {
            at.map[0] = r[0];
            at.force[(0, 0)] = 1.0;
        }
        let pressure = if self == Self::AlartCurnier {
            prediction[0]
        } else {
            r[0]
        };
        let (radius, slope) = bound.at(pressure.max(0.0));
        let squares = (1..D).map(|k| prediction[k] * prediction[k]);
        let size = squares.sum::<f64>().sqrt();
        if size <= radius && radius > 0.0 {
            for k in 1..D {
                at.map[k] = rho[k] * u[k];
                at.displacement[(k, k)] = rho[k];
            }
            return at;
        }
        for k in 1..D {
            at.map[k] = r[k];
            at.force[(k, k)] = 1.0;
        }
        if radius > 0.0 {
            let shrunk = radius / size;
            for k in 1..D {
                let d_k = prediction[k] / size;
                at.map[k] -= radius * d_k;
                for l in 1..D {
                    let turned = if k == l { 1.0 } else { 0.0 } - d_k * prediction[l] / size;
                    at.force[(k, l)] -= shrunk * turned;
                    at.displacement[(k, l)] += shrunk * rho[l] * turned;
                }
                at.force[(k, 0)] -= slope * d_k;
                if self == Self::AlartCurnier {
                    at.displacement[(k, 0)] += slope * rho[0] * d_k;
                }
            }
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::{AnisotropicCoulomb, Coulomb, LimitedCoulomb, Tresca};

    fn laws() -> [Friction; 4] {
        [
            Coulomb::new(0.6).expect("valid").into(),
            Tresca::new(0.5).expect("valid").into(),
            LimitedCoulomb::new(0.6, 0.3).expect("valid").into(),
            AnisotropicCoulomb::new(0.6, 0.2).expect("valid").into(),
        ]
    }

    /// A and B are the derivatives of F, in every branch of every map.
    #[test]
    fn derivatives_are_those_of_the_map() {
        let rho = Local::<3>::new(1.3, 0.7, 0.7);
        let points = [
            ([1.0, 0.2, 0.1], [0.1, 0.05, -0.1]),
            ([1.0, 0.9, -0.5], [0.1, -0.8, 0.3]),
            ([0.1, 0.2, 0.1], [0.9, -0.8, 0.3]),
            ([-0.4, 0.2, 0.1], [-0.9, -0.8, 0.3]),
        ];
        let maps = [
            NewtonMap::AlartCurnier,
            NewtonMap::JeanMoreau,
            NewtonMap::Natural,
        ];
        for (map, law) in maps.iter().flat_map(|m| laws().map(|law| (*m, law))) {
            for (r, u) in points {
                let (r, u) = (Local::<3>::from(r), Local::<3>::from(u));
                let at = map.linearise(&law, &rho, &r, &u);
                for k in 0..3 {
                    let mut d = Local::<3>::zeros();
                    d[k] = 1e-6;
                    let f = |r: &Local<3>, u: &Local<3>| map.linearise(&law, &rho, r, u).map;
                    let by_force = (f(&(r + d), &u) - f(&(r - d), &u)) / 2e-6;
                    let by_displacement = (f(&r, &(u + d)) - f(&r, &(u - d))) / 2e-6;
                    let off = (by_force - at.force.column(k)).norm()
                        + (by_displacement - at.displacement.column(k)).norm();
                    assert!(off < 1e-8, "{map:?} {law:?} {r} {u}: {off}");
                }
            }
        }
    }

    /// All maps vanish at the law, whatever ρ, and none of them beside it.
    #[test]
    fn the_zeros_are_the_law() {
        let rho = Local::<3>::new(1.3, 0.7, 0.7);
        for law in laws() {
            let m: Local<3> = law.stretch();
            let (bound, _) = Bound::of(&law).at(1.5);
            // Slip against the shear of the bound, between stretched vectors; less shear sticks.
            let (d, s) = ([0.6, 0.8], 0.4);
            let slip = Local::<3>::new(0.0, -s * d[0] / m[1], -s * d[1] / m[2]);
            let full = Local::<3>::new(1.5, m[1] * bound * d[0], m[2] * bound * d[1]);
            let mut part = full * 0.9;
            part[0] = 1.5;
            for map in [
                NewtonMap::AlartCurnier,
                NewtonMap::JeanMoreau,
                NewtonMap::Natural,
            ] {
                let f = |r: &Local<3>, u: &Local<3>| map.linearise(&law, &rho, r, u).map.norm();
                assert!(f(&full, &slip) < 1e-14, "{map:?} {law:?}");
                assert!(f(&part, &Local::zeros()) < 1e-14, "{map:?} {law:?}");
                assert!(f(&part, &slip) > 1e-3, "{map:?} {law:?}");
                assert!(f(&full, &-slip) > 1e-3, "{map:?} {law:?}");
            }
        }
    }
}
