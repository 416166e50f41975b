//! Collapse: the load that a structure carries at most, and a bound on it from its mechanism; not
//! the way there.

/// A step whose loads grow in proportion, F₀ + λ q from λ = 0 to 1, and which the structure does
/// not carry to its end: displacements grow while λ does not.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Collapse {
    /// The largest λ in equilibrium.
    pub load_factor: f64,
    /// Whether there were forces F₀ at the start of the step, loads of the step before or what held initial stresses: λ is
    /// then no part of the loads.
    pub added: bool,
    /// Growth of λ, over λ, while the work of the loads doubled: what is left to be gained; at most
    /// [`Collapse::FLAT`], or one of [`Collapse::SLOW`] where the displacements had grown to the size of the mesh, and negative
    /// past a maximum.
    pub growth: f64,
    /// Kinematic bound from the mechanism; `None` where a law has no dissipation of strain rates
    /// alone, as where flow is not associated.
    pub upper_bound: Option<UpperBound>,
}

/// λ⁺ of a velocity field v, the displacement increment of the last increment:
///
/// ```text
/// λ⁺ = ( Σ ∫ D(ε̇) dΩ + friction − F₀·v ) / q·v,   D(ε̇) = sup σ : ε̇
/// ```
///
/// over the stresses on the yield surface as it has become, so that λ⁺ ≥ λ. Of von Mises,
/// D = √(2/3) σ_y ‖ė‖ + σ_m tr ε̇: without change of volume λ⁺ bounds the limit load of the mesh
/// whatever v is, and what elastic changes of volume there are counts at the present mean stress.
/// Parts that stay elastic count with their present stress; there ε̇ fades on the plateau.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UpperBound {
    /// λ⁺.
    pub load_factor: f64,
    /// What changes of volume and elastic parts have a share in, in parts of q·v: λ⁺ is strict as
    /// far as this is zero.
    pub elastic_share: f64,
    /// Whether friction depends on normal forces somewhere in the mechanism. Coulomb's is not
    /// associated: λ⁺ then holds for the normal forces at collapse, and is no bound otherwise.
    pub coulomb: bool,
    /// Whether the yield surface grows, or shrinks, in the mechanism by more than [`Collapse::FLAT`] of its power: λ⁺ then bounds
    /// nothing but the present λ.
    pub hardens: bool,
}

impl Collapse {
    /// Growth of λ at which it counts as constant.
    pub const FLAT: f64 = 1e-6;

    /// Growth of λ up to which there is a limit load near once the structure has moved by its own size, if it hardens and if
    /// it does not: on coarse meshes a plateau may rise for long.
    pub const SLOW: [f64; 2] = [1e-3, 2e-2];

    /// Whether λ grows too fast for a limit load near, once the structure has moved by its own size.
    pub fn runs_away(&self) -> bool {
        let hardens = self.upper_bound.is_some_and(|bound| bound.hardens);
        self.growth > Self::SLOW[usize::from(!hardens)]
    }

    /// Whether the kinematic bound is one: nothing in the mechanism hardens, and no friction depends on normal forces; `None`
    /// without a bound.
    pub fn is_strict(&self) -> Option<bool> {
        self.upper_bound
            .map(|bound| !bound.hardens && !bound.coulomb)
    }
}

impl std::fmt::Display for Collapse {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "collapse at load factor {:.6}", self.load_factor)?;
        if self.added {
            write!(f, " of the way from the forces at its start to its loads")?;
        }
        let Some(bound) = &self.upper_bound else {
            return Ok(());
        };
        let what = match (self.is_strict(), bound.coulomb) {
            (Some(true), _) => "upper bound",
            (_, true) => "kinematic estimate (Coulomb friction: no bound)",
            _ => "kinematic estimate (it still hardens: no bound)",
        };
        write!(f, ", {what} {:.6}", bound.load_factor)
    }
}
