//! The condensed contact problem t = S (u − g) − f and its residual; not how it is solved.

use super::{BlockMatrix, LocalProblem, PAIRS, criticality, size_of_map, split, stack, statuses};
use crate::ContactError;
use crate::error::{expect_finite, expect_sizes, expect_symmetric};
use moreau_algebra::DenseCholesky;
use moreau_laws::{Friction, Local, Status};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix2, Vector2};

/// Eigenvalue of S, over its largest diagonal, below which it is rounding.
const FAINT: f64 = 1e-9;

/// Least proximal term, over the stiffest diagonal, whose inverse is not too large to iterate on.
const SWEPT: f64 = 1e-9;

/// Least α of a contact, over that of the stiffest: it sees displacements where the contact has no stiffness of its own.
const SEEN: f64 = 1e-6;

/// The largest proximal term that is looked for, over the stiffest diagonal, and how near the least that makes S stable is
/// found.
const MOST: f64 = 1e3;
const NEAR: f64 = 2.0;

/// The contact problem of one linearised increment, in the contacts' local frames:
///
/// ```text
/// t = S (u − g) − f,      (−u, t) extremal for [38] at every contact.
/// ```
///
/// u = (u_n, u_t) is the gap at the end of the step and the slip of the step \[mm\], t the contact
/// force on the body \[N\]; S is the stiffness of the structure condensed on the interface \[N/mm\],
/// symmetric positive semi-definite, `D·contacts` square; f the condensed load \[N\] and g the
/// displacement about which the structure was linearised \[mm\]. Where stresses make the structure unstable S is indefinite:
/// such a problem may have several solutions, of which methods find one or another, or none.
#[derive(Debug, Clone)]
pub struct CondensedProblem<const D: usize> {
    stiffness: DMatrix<f64>,
    load: DVector<f64>,
    origin: Vec<Local<D>>,
    laws: Vec<Friction>,
    previous: Vec<Local<D>>,
    /// Its proximal term \[N/mm\].
    held: f64,
    /// By how much the load may be rounding \[N\].
    load_rounding: f64,
    /// The least stiffness by which displacements weigh in the residual of a solution \[N/mm\].
    weight: f64,
    /// The least α of a contact \[N/mm\].
    least: f64,
}

impl<const D: usize> CondensedProblem<D> {
    /// A problem from its parts; `previous` are the forces t₀ at the start of the step.
    ///
    /// # Errors
    /// [`ContactError::Dimension`] if sizes disagree, [`ContactError::NotFinite`] for NaN or ∞,
    /// [`ContactError::Unsymmetric`] if S is not symmetric up to rounding.
    pub fn new(
        stiffness: DMatrix<f64>,
        load: DVector<f64>,
        origin: Vec<Local<D>>,
        laws: Vec<impl Into<Friction>>,
        previous: Vec<Local<D>>,
    ) -> Result<Self, ContactError> {
        let contacts = laws.len();
        expect_sizes([
            ("stiffness rows", stiffness.nrows(), D * contacts),
            ("stiffness columns", stiffness.ncols(), D * contacts),
            ("load", load.len(), D * contacts),
            ("origin", origin.len(), contacts),
            ("previous", previous.len(), contacts),
        ])?;
        expect_symmetric("stiffness", &stiffness)?;
        expect_finite("load", &load)?;
        expect_finite("origin", origin.iter().flatten())?;
        expect_finite("previous", previous.iter().flatten())?;
        let mut problem = Self {
            stiffness,
            load,
            origin,
            laws: laws.into_iter().map(Into::into).collect(),
            previous,
            held: 0.0,
            load_rounding: 0.0,
            weight: 0.0,
            least: 0.0,
        };
        problem.least = problem.least_alpha();
        Ok(problem)
    }

    /// The least α: a part of the stiffest contact's, and where no contact has any stiffness that with which the load
    /// closes the gaps.
    fn least_alpha(&self) -> f64 {
        let own = (0..self.contacts()).map(|i| self.mean_stiffness(i));
        match own.fold(0.0, f64::max) {
            0.0 => self.closing(),
            stiffest => SEEN * stiffest,
        }
    }

    /// Stiffness with which the load closes the gaps \[N/mm\]; 1 where there is no load or no gap, and so nothing to weigh.
    fn closing(&self) -> f64 {
        let load = self.load.amax();
        let gap = self.origin.iter().map(|g| g.amax()).fold(0.0, f64::max);
        Some(load / gap).filter(|c| c.is_normal()).unwrap_or(1.0)
    }

    /// A problem given in the form u = W t + q of discrete frictional contact; t₀ = 0.
    ///
    /// # Errors
    /// As [`CondensedProblem::new`]; [`ContactError::Unsymmetric`], [`ContactError::Indefinite`] if W is not positive
    /// definite.
    pub fn from_delassus(
        operator: DMatrix<f64>,
        free: &[Local<D>],
        laws: Vec<impl Into<Friction>>,
    ) -> Result<Self, ContactError> {
        let size = D * laws.len();
        expect_sizes([
            ("Delassus operator's rows", operator.nrows(), size),
            ("Delassus operator's columns", operator.ncols(), size),
        ])?;
        expect_symmetric("Delassus operator", &operator)?;
        let stiffness = inverse(&operator).ok_or_else(|| ContactError::Indefinite {
            what: "Delassus operator",
            component: breakdown(&operator),
        })?;
        let zero = vec![Local::zeros(); laws.len()];
        Self::new(stiffness, DVector::zeros(size), free.to_vec(), laws, zero)
    }

    /// A proximal term c/2 |u − g|² about the origin, c \[N/mm\]: S + c 1 takes the place of S. Where
    /// the statuses leave the bodies a rigid motion S is singular, and the solutions are many; this has
    /// one, near to the origin. Repeated about its own solution it ends at one of the problem itself. It takes the
    /// place of the term before.
    pub fn hold(&mut self, c: f64) {
        for k in 0..self.stiffness.nrows() {
            self.stiffness[(k, k)] += c - self.held;
        }
        self.held = c;
        self.least = self.least_alpha();
    }

    /// Tells by how much the load may be rounding \[N\] beyond that of its own size: what is left of stresses that have
    /// vanished is the rounding of those before. A solution is exact where its residual is no larger.
    pub fn rounds(&mut self, rounding: f64) {
        self.load_rounding = rounding;
    }

    /// Tells by which stiffness \[N/mm\] displacements weigh at least where a solution is judged. In plastic flow S is softer
    /// than the bodies, and what is within a tolerance when weighed by S need not be when weighed by them. Newton's method
    /// on S, whose last step leaves rounding only, does without.
    pub fn weigh(&mut self, stiffness: f64) {
        self.weight = stiffness;
    }

    /// Whether only a proximal term makes S regular that is so small that the inverse is too large to iterate on.
    pub(crate) fn is_faintly_held(&self) -> bool {
        self.held > 0.0 && self.held < SWEPT * self.stiffness.diagonal().amax()
    }

    /// Whether S has an eigenvalue that is negative and no rounding of a rigid motion, as where stresses make the structure
    /// unstable with all its contacts free: it has no inverse that is one of a body, and there may be no solution.
    pub(crate) fn is_unstable(&self) -> bool {
        !self.is_stable_with(FAINT * self.stiffness.diagonal().amax())
    }

    /// Whether S + c 1 is positive definite.
    fn is_stable_with(&self, c: f64) -> bool {
        let mut stiffness = self.stiffness.clone();
        (0..stiffness.nrows()).for_each(|k| stiffness[(k, k)] += c);
        DenseCholesky::new(stiffness).is_some()
    }

    /// The least c with which S + c 1 is positive definite, or up to twice as much \[N/mm\]; `None` of an S that is
    /// not unstable without, and of one that no c makes stable.
    pub fn stabilising(&self) -> Option<f64> {
        let stiffest = self.stiffness.diagonal().amax();
        let (mut unstable, mut stable) = (FAINT * stiffest, MOST * stiffest);
        if self.is_stable_with(unstable) || !self.is_stable_with(stable) {
            return None;
        }
        while stable > NEAR * unstable {
            let between = (unstable * stable).sqrt();
            match self.is_stable_with(between) {
                true => stable = between,
                false => unstable = between,
            }
        }
        Some(stable)
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        self.laws.len()
    }

    /// S, `D·contacts` square \[N/mm\].
    pub fn stiffness(&self) -> &DMatrix<f64> {
        &self.stiffness
    }

    /// The law of every contact.
    pub fn laws(&self) -> &[Friction] {
        &self.laws
    }

    /// Contact forces t₀ at the start of the step \[N\].
    pub fn previous(&self) -> &[Local<D>] {
        &self.previous
    }

    /// Displacement g about which the structure was linearised \[mm\].
    pub fn origin(&self) -> &[Local<D>] {
        &self.origin
    }

    /// Forces that displacements u ask of the structure: t = S (u − g) − f \[N\].
    ///
    /// # Panics
    /// If there are not as many displacements as contacts.
    pub fn force(&self, u: &[Local<D>]) -> Vec<Local<D>> {
        self.force_of(&self.relative(u))
    }

    /// Displacements from the origin, x = u − g \[mm\].
    pub(crate) fn relative(&self, u: &[Local<D>]) -> Vec<Local<D>> {
        assert_eq!(u.len(), self.contacts(), "a displacement a contact");
        u.iter().zip(&self.origin).map(|(u, g)| u - g).collect()
    }

    /// Forces for displacements x = u − g from the origin: t = S x − f \[N\].
    pub(crate) fn force_of(&self, x: &[Local<D>]) -> Vec<Local<D>> {
        split(&(&self.stiffness * stack(x) - &self.load))
    }

    /// The form u = W t + q, with the Delassus operator W = S⁻¹ and q = g + W f.
    ///
    /// # Errors
    /// [`ContactError::Floating`] if S is singular: the bodies are held by contact alone.
    pub fn delassus(&self) -> Result<LocalProblem<D>, ContactError> {
        self.local().map_err(|error| match error {
            ContactError::Singular => ContactError::Floating {
                component: breakdown(&self.stiffness),
            },
            other => other,
        })
    }

    /// [`Self::delassus`], without where S breaks down.
    ///
    /// # Errors
    /// [`ContactError::Singular`] if S is.
    pub(crate) fn local(&self) -> Result<LocalProblem<D>, ContactError> {
        let operator = inverse(&self.stiffness).ok_or(ContactError::Singular)?;
        let free = split::<D>(&(&operator * &self.load));
        let free = free.iter().zip(&self.origin).map(|(w, g)| w + g).collect();
        LocalProblem::new(BlockMatrix::from_dense(&operator)?, free, self.laws.clone())
    }

    /// Parameter α of \[90′\] for contact i \[N/mm\]: the mean stiffness of its own components, so
    /// that a residual in newtons weighs gaps and forces alike in any system of units. It never vanishes, or a gap would
    /// not be seen: where a contact has next to no stiffness it is a small part of the stiffest one's, and where none has
    /// any that with which the load closes the gaps. It is negative where stresses make the structure so unstable.
    ///
    /// # Panics
    /// If there is no contact i.
    pub fn alpha(&self, i: usize) -> f64 {
        match self.mean_stiffness(i) {
            // Of a structure that stresses make unstable.
            own if own < 0.0 => own,
            own => own.max(self.least),
        }
    }

    /// Mean stiffness of the components of contact i \[N/mm\].
    fn mean_stiffness(&self, i: usize) -> f64 {
        (0..D)
            .map(|k| self.stiffness[(D * i + k, D * i + k)])
            .sum::<f64>()
            / D as f64
    }

    /// Largest norm over the contacts of the natural map t − proj(t − α ũ), \[90′\] \[N\]; infinite where a displacement or a
    /// force is no number.
    ///
    /// # Panics
    /// If there are not as many displacements and forces as contacts.
    pub fn residual(&self, u: &[Local<D>], t: &[Local<D>]) -> f64 {
        self.residual_by(0.0, u, t)
    }

    /// [`Self::residual`] with displacements weighed as [`Self::weigh`] tells \[N\]: no smaller, since the map grows with α.
    pub(crate) fn judged_residual(&self, u: &[Local<D>], t: &[Local<D>]) -> f64 {
        self.residual_by(self.weight, u, t)
    }

    /// The largest norm of the natural map, with α of this size at least \[N\].
    fn residual_by(&self, least: f64, u: &[Local<D>], t: &[Local<D>]) -> f64 {
        assert_eq!([u.len(), t.len()], [self.contacts(); 2], "{PAIRS}");
        let size = |i: usize| {
            let map = self.laws[i].natural_map(&u[i], &t[i], self.alpha(i).max(least));
            size_of_map(&map, &u[i], &t[i])
        };
        (0..self.contacts()).map(size).fold(0.0, f64::max)
    }

    /// Size of the forces in play, against which a residual is judged \[N\]: the largest of the
    /// forces now and at the start of the step, and of the condensed load.
    pub fn force_scale(&self, t: &[Local<D>]) -> f64 {
        let forces = t
            .iter()
            .chain(&self.previous)
            .map(|t| t.norm())
            .fold(0.0, f64::max);
        forces.max(self.load.amax()).max(f64::MIN_POSITIVE)
    }

    /// Rounding of forces S x − f \[N\], x = u − g: no residual can be expected below it.
    pub(crate) fn rounding(&self, x: &[Local<D>]) -> f64 {
        let reach = x.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let stiffest = self.stiffness.diagonal().amax();
        let terms = (self.load.len() as f64).sqrt();
        4.0 * f64::EPSILON * terms * (stiffest * reach + self.load.amax()) + self.load_rounding
    }

    /// Rounding of forces where displacements are found as sums with the origin \[N\]: it counts where a contact hardly presses
    /// and slips far.
    pub(crate) fn rounding_of_origin(&self, t: &[Local<D>]) -> f64 {
        let bearing = t.iter().zip(&self.origin).filter(|(t, _)| t.amax() > 0.0);
        let reach = bearing.map(|(_, g)| g.amax()).fold(0.0, f64::max);
        4.0 * f64::EPSILON * self.stiffness.diagonal().amax() * reach
    }

    /// Largest ratio μ/μ_c over the contacts that are closed, or were at the start of the step, with its
    /// contact; `None` if there are none.
    ///
    /// It is 1/μ_c = |S_tt⁻¹ S_tn| of the diagonal block, which belongs to a contact beside which all others
    /// stick: an indicator, not a bound (A. Klarbring, *Ingenieur-Archiv* 60 (1990) 529-541). Of a single
    /// contact it is that of [`LocalProblem::criticality`]; of several, the block of W is taken while all
    /// others are open.
    ///
    /// # Panics
    /// If there are not as many statuses as contacts.
    pub fn criticality(&self, status: &[Status]) -> Option<(usize, f64)> {
        assert_eq!(status.len(), self.contacts(), "a status a contact");
        let touches = |i: &usize| status[*i] != Status::Open || self.previous[*i][0] > 0.0;
        let touching = (0..self.contacts()).filter(touches);
        criticality(&self.laws, touching, |i| self.moved_along(i))
    }

    /// −S_tt⁻¹ S_tn of contact i, what it moves along while it opens by one.
    fn moved_along(&self, i: usize) -> Local<D> {
        let s = |a: usize, b: usize| match a.max(b) < D {
            true => self.stiffness[(D * i + a, D * i + b)],
            false => f64::from(u8::from(a == b)),
        };
        let along = Matrix2::new(s(1, 1), s(1, 2), s(2, 1), s(2, 2)).cholesky();
        // What has no stiffness has no coupling either.
        let moved = along.map_or_else(Vector2::zeros, |along| {
            -along.solve(&Vector2::new(s(1, 0), s(2, 0)))
        });
        Local::from_fn(|k, _| if k == 0 { 0.0 } else { moved[k - 1] })
    }

    /// Status of every contact at (u, t), \[35\].
    ///
    /// # Panics
    /// If there are not as many displacements and forces as contacts.
    pub fn statuses(&self, u: &[Local<D>], t: &[Local<D>]) -> Vec<Status> {
        statuses(&self.laws, u, t, |i| self.alpha(i))
    }
}

/// Inverse of a symmetric matrix; `None` if it is not positive definite.
fn inverse(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if a.is_empty() {
        return Some(a.clone()); // Nothing touches.
    }
    regular(a.clone(), least_pivot(a)).map(|factor| factor.inverse())
}

/// A pivot at rounding level is a rigid motion, not a stiffness.
fn least_pivot(a: &DMatrix<f64>) -> f64 {
    1e-13 * a.diagonal().amax()
}

/// The factor of a matrix, if all of its pivots are above the least.
fn regular(a: DMatrix<f64>, least: f64) -> Option<Cholesky<f64, Dyn>> {
    let factor = a.cholesky();
    factor.filter(|factor| factor.l_dirty().diagonal().amin().powi(2) > least)
}

/// The first component at which a matrix is not positive definite.
fn breakdown(a: &DMatrix<f64>) -> usize {
    // The leading parts of a regular one are regular.
    let sizes: Vec<usize> = (1..=a.nrows()).collect();
    let leading = |size: usize| a.view((0, 0), (size, size)).into_owned();
    sizes.partition_point(|&size| regular(leading(size), least_pivot(a)).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::Coulomb;

    fn coulomb(mu: f64) -> Friction {
        Coulomb::new(mu).expect("valid").into()
    }

    #[test]
    fn nothing_in_contact_has_a_form_too() {
        let (s, f) = (DMatrix::zeros(0, 0), DVector::zeros(0));
        let problem = CondensedProblem::<2>::new(s, f, vec![], Vec::<Friction>::new(), vec![]);
        let form = problem.expect("valid").delassus().expect("empty");
        assert_eq!(form.contacts(), 0);
    }

    #[test]
    fn delassus_form_inverts_the_stiffness_form() {
        let s = DMatrix::from_row_slice(2, 2, &[3.0, 1.0, 1.0, 2.0]);
        let f = DVector::from_row_slice(&[0.5, -0.25]);
        let g = vec![Local::<2>::new(0.1, 0.2)];
        let zero = vec![Local::zeros()];
        let problem = CondensedProblem::new(s, f, g, vec![coulomb(0.3)], zero).expect("valid");
        let t = Local::<2>::new(0.7, -0.2);
        let form = problem.delassus().expect("definite");
        let back = problem.force(&form.displacement(&[t]));
        assert!((back[0] - t).norm() < 1e-14);
    }

    /// The last term counts alone, and only a faint one forbids to iterate on the inverse.
    #[test]
    fn a_proximal_term_takes_the_place_of_the_one_before() {
        let s = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 2.0]);
        let zero = vec![Local::<2>::zeros()];
        let (f, laws) = (DVector::zeros(2), vec![coulomb(0.3)]);
        let problem = CondensedProblem::new(s, f, zero.clone(), laws, zero);
        let mut problem = problem.expect("valid");
        for (c, faint) in [(0.0, false), (2e-9, true), (0.5, false), (2e-9, true)] {
            problem.hold(c);
            let held = DMatrix::from_row_slice(2, 2, &[4.0 + c, 1.0, 1.0, 2.0 + c]);
            assert!((problem.stiffness() - held).amax() < 1e-15, "{c}");
            assert_eq!(problem.is_faintly_held(), faint, "{c}");
        }
    }

    /// Within its factor, and only where it is unstable.
    #[test]
    fn the_least_term_that_makes_it_stable() {
        let zero = vec![Local::<2>::zeros()];
        let stabilising = |own: f64, across: f64| {
            let s = DMatrix::from_row_slice(2, 2, &[own, across, across, own]);
            let laws = vec![coulomb(0.3)];
            let problem =
                CondensedProblem::new(s, DVector::zeros(2), zero.clone(), laws, zero.clone());
            problem.expect("valid").stabilising()
        };
        assert_eq!(stabilising(3.0, 2.0), None);
        assert_eq!(stabilising(3.0, 3.0), None);
        // Eigenvalues own ± across.
        for across in [3.0 + 1e-6, 3.1, 30.0, 300.0] {
            let (c, least) = (stabilising(3.0, across).expect("unstable"), across - 3.0);
            assert!((least..=NEAR * least).contains(&c), "{across}: {c}");
        }
        assert_eq!(stabilising(3.0, 1e5), None);
    }

    /// What is measured in newtons, by its definition.
    #[test]
    fn the_measures_are_mean_stiffness_and_largest_force() {
        let s = DMatrix::from_diagonal(&DVector::from_row_slice(&[3.0, 1.0, 8.0, 2.0]));
        let f = DVector::from_row_slice(&[0.5, -7.0, 0.0, 0.1]);
        let zero = vec![Local::<2>::zeros(); 2];
        let before = vec![Local::<2>::new(3.0, 4.0), Local::zeros()];
        let problem = CondensedProblem::new(s, f, zero.clone(), vec![coulomb(0.3); 2], before);
        let problem = problem.expect("valid");
        assert_eq!((problem.alpha(0), problem.alpha(1)), (2.0, 5.0));
        assert_eq!(problem.force_scale(&zero), 7.0);
        let now = [Local::<2>::new(0.0, 0.0), Local::<2>::new(6.0, 8.0)];
        assert_eq!(problem.force_scale(&now), 10.0);
        // A gap of 0.1 mm beside a force is α times that, as long as the force is larger.
        let (u, t) = (Local::<2>::new(0.1, 0.0), Local::<2>::new(4.0, 0.0));
        let residual = problem.residual(&[u, zero[0]], &[t, zero[0]]);
        assert!((residual - 0.2).abs() < 1e-15, "{residual}");
    }

    #[test]
    fn bad_data_is_refused() {
        let s = DMatrix::identity(2, 2);
        let one = vec![coulomb(0.1)];
        let zero = vec![Local::<2>::zeros()];
        let f = DVector::zeros(2);
        let nan = DVector::from_element(2, f64::NAN);
        let new = CondensedProblem::new;
        assert!(matches!(
            new(s.clone(), nan, zero.clone(), one.clone(), zero.clone()),
            Err(ContactError::NotFinite { what: "load" })
        ));
        assert!(matches!(
            new(
                DMatrix::identity(3, 3),
                f.clone(),
                zero.clone(),
                one.clone(),
                zero.clone()
            ),
            Err(ContactError::Dimension {
                found: 3,
                expected: 2,
                ..
            })
        ));
        let singular = new(
            DMatrix::zeros(2, 2),
            f.clone(),
            zero.clone(),
            one.clone(),
            zero.clone(),
        );
        let singular = singular.expect("valid");
        assert!(matches!(
            singular.delassus(),
            Err(ContactError::Floating { .. })
        ));
        // What floats is not unstable, though rounding may make its pivots negative.
        for (x, unstable) in [(1.0, false), (1.0 + 1e-13, false), (1.0 + 1e-6, true)] {
            let s = DMatrix::from_row_slice(2, 2, &[1.0, x, x, 1.0]);
            let problem = new(s, f.clone(), zero.clone(), one.clone(), zero.clone());
            assert_eq!(problem.expect("valid").is_unstable(), unstable, "{x}");
        }
    }

    /// One triangle alone would make another problem.
    #[test]
    fn an_operator_that_is_not_symmetric_is_refused() {
        let new = |across: f64| {
            let w = DMatrix::from_row_slice(2, 2, &[1.0, across, 0.1, 1.0]);
            CondensedProblem::<2>::from_delassus(w, &[Local::zeros()], vec![coulomb(0.3)])
        };
        assert!(new(0.1 + 1e-12).is_ok());
        match new(5.0) {
            Err(ContactError::Unsymmetric { at, values, .. }) => {
                assert_eq!((at, values), ([1, 0], [0.1, 5.0]));
            }
            other => panic!("{other:?}"),
        }
        assert!(matches!(new(f64::NAN), Err(ContactError::NotFinite { .. })));
    }
}
