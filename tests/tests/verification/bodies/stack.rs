//! Two blocks, one on the other, in the plane and in space, with what any pair of bodies must obey;
//! not what they are put to.

use super::*;
use moreau::driver::Analysis;
use moreau::laws::VonMises;
use moreau::mesh::{Axisymmetric, MeshError, Solid, block3};

/// A hypothesis, with blocks to be pressed under it.
pub(super) trait Blocks<const D: usize>: Analysis<D> + Default {
    /// What a footprint of WIDTH, and DEPTH in space, measures \[mm²\].
    const FOOTPRINT: f64;
    /// Stress along z over the pressure, where nothing else resists it.
    const ACROSS: f64;

    /// A block on lines along the axes.
    fn block(name: &str, kind: CellKind, lines: &[Vec<f64>; D]) -> Result<Mesh<D>, MeshError>;
}

impl Blocks<2> for PlaneStrain {
    const FOOTPRINT: f64 = WIDTH;
    const ACROSS: f64 = -NU;

    fn block(name: &str, kind: CellKind, [x, y]: &[Vec<f64>; 2]) -> Result<Mesh<2>, MeshError> {
        block2(name, kind, x, y)
    }
}

impl Blocks<2> for Axisymmetric {
    const FOOTPRINT: f64 = PI * WIDTH * WIDTH;
    const ACROSS: f64 = 0.0;

    fn block(name: &str, kind: CellKind, [r, z]: &[Vec<f64>; 2]) -> Result<Mesh<2>, MeshError> {
        block2(name, kind, r, z)
    }
}

impl Blocks<3> for Solid {
    const FOOTPRINT: f64 = WIDTH * DEPTH;
    const ACROSS: f64 = 0.0;

    fn block(name: &str, kind: CellKind, [x, y, z]: &[Vec<f64>; 3]) -> Result<Mesh<3>, MeshError> {
        block3(name, kind, x, y, z)
    }
}

/// Where the nodes of a block go.
pub(super) type Map<const D: usize> = fn([f64; D]) -> [f64; D];

/// Two blocks, the upper on the lower; y points up.
#[derive(Clone)]
pub(super) struct Stack<H, const D: usize> {
    pub(super) kinds: [CellKind; 2],
    /// Lines along the axes of the upper and of the lower block.
    pub(super) lines: [[Vec<f64>; D]; 2],
    /// Along the interface.
    pub(super) maps: [Map<D>; 2],
    pub(super) young: [f64; 2],
    /// Of both, if they yield.
    pub(super) yield_stress: Option<f64>,
    /// Hardening modulus of both where they yield, under large strains.
    pub(super) large: Option<f64>,
    pub(super) friction: f64,
    pub(super) pairing: Pairing,
    /// Whether the lower block is the non-mortar side.
    pub(super) swapped: bool,
    /// Of the whole.
    pub(super) rotation: SMatrix<f64, D, D>,
    pub(super) hypothesis: H,
}

impl<H: Blocks<D>, const D: usize> Stack<H, D> {
    /// Of one footprint, with so many cells along the axes.
    pub(super) fn new(kinds: [CellKind; 2], cells: [[usize; D]; 2]) -> Self {
        let lines = |k: usize, axis: usize| {
            let (low, high) = match (axis, k) {
                (0, _) => (0.0, WIDTH),
                (1, 0) => (0.0, HEIGHT),
                (1, _) => (-HEIGHT, 0.0),
                _ => (0.0, DEPTH),
            };
            uniform(low, high, cells[k][axis])
        };
        Self {
            kinds,
            lines: [0, 1].map(|k| from_fn(|axis| lines(k, axis))),
            maps: [|x| x; 2],
            young: [E; 2],
            yield_stress: None,
            large: None,
            friction: 0.0,
            pairing: Pairing::Mortar,
            swapped: false,
            rotation: SMatrix::identity(),
            hypothesis: H::default(),
        }
    }

    pub(super) fn turn(&self, v: [f64; D]) -> [f64; D] {
        (self.rotation * SVector::from(v)).into()
    }

    /// As it was before the whole was turned.
    pub(super) fn back(&self, v: [f64; D]) -> [f64; D] {
        self.rotation.tr_mul(&SVector::from(v)).into()
    }

    pub(super) fn mesh(&self) -> Fallible<Mesh<D>> {
        let block = |k: usize, name: &str| -> Fallible<Mesh<D>> {
            Ok(H::block(name, self.kinds[k], &self.lines[k])?.map(self.maps[k])?)
        };
        let mut mesh = block(0, "upper")?.joined(block(1, "lower")?)?;
        // What the upper block does not cover; its footprint is a box.
        let beside = |x: f64, side: f64| x < -1e-9 || x > side + 1e-9;
        let _ = mesh.node_group_where("uncovered", "lower.top", |x| {
            beside(x[0], WIDTH) || D == 3 && beside(x[2], DEPTH)
        });
        Ok(match self.rotation == SMatrix::<f64, D, D>::identity() {
            true => mesh,
            false => mesh.map(|x| self.turn(x))?,
        })
    }

    /// Names of the non-mortar and of the mortar surface.
    pub(super) fn surfaces(&self) -> [&'static str; 2] {
        let mut surfaces = ["upper.bottom", "lower.top"];
        if self.swapped {
            surfaces.reverse();
        }
        surfaces
    }

    pub(super) fn driver(&self, mesh: Mesh<D>, settings: Settings<D>) -> Fallible<Driver<D>> {
        let [own, other] = self.surfaces();
        let mut model = match self.large {
            None => Model::new(mesh, self.hypothesis),
            Some(_) => Model::with_large_strains(mesh, self.hypothesis),
        };
        for (k, name) in ["upper", "lower"].into_iter().enumerate() {
            let (young, rule) = (self.young[k], self.kinds[k].integration());
            model = match self.yield_stress {
                None => model.material(name, Elastic::new(young, NU)?, rule)?,
                Some(s) => {
                    let law = VonMises::new(young, NU, s)?;
                    let law = match self.large {
                        None => law,
                        Some(hardening) => law.with_isotropic(hardening)?,
                    };
                    model.material(name, law, rule)?
                }
            };
        }
        let model = model.pair(own, other, Coulomb::new(self.friction)?, self.pairing)?;
        Ok(Driver::new(model, settings)?)
    }

    pub(super) fn what(&self) -> String {
        let cells = |k: usize| self.lines[k].each_ref().map(|l| l.len() - 1);
        let cells = [cells(0), cells(1)];
        format!("{:?} {cells:?} swapped {}", self.kinds, self.swapped)
    }

    /// Held on the base and at the planes of symmetry of both blocks, the upper by its contact
    /// besides.
    pub(super) fn held(&self, name: &str) -> Step<D> {
        let mut step = Step::new(name).fix("lower.bottom", &[Axis::Y]);
        for body in ["upper", "lower"] {
            for (low, _, axis) in sides::<D>() {
                step = step.fix(&format!("{body}.{low}"), &[axis]);
            }
        }
        step
    }
}

/// Sides across the interface, of the least and of the greatest coordinate along an axis.
pub(super) fn sides<const D: usize>() -> impl Iterator<Item = (&'static str, &'static str, Axis)> {
    let all = [("left", "right", Axis::X), ("back", "front", Axis::Z)];
    all.into_iter().take(D - 1)
}

/// The stress of a pressure on blocks that are free to spread.
pub(super) fn squeezed<H: Blocks<D>, const D: usize>() -> [f64; 6] {
    [0.0, -PRESSURE, H::ACROSS * PRESSURE, 0.0, 0.0, 0.0]
}

/// What holds for every pair: the forces on both surfaces cancel, and the law is obeyed. Returns the
/// force on the upper body.
pub(super) fn action_is_reaction<const D: usize>(
    driver: &Driver<D>,
    [own, other]: [&str; 2],
) -> Fallible<SVector<f64, D>> {
    let (on_own, on_other) = (driver.contact_force(own)?, driver.contact_force(other)?);
    let size: f64 = driver.contacts().iter().map(|c| c.force.norm()).sum();
    let left = (on_own + on_other).norm();
    assert!(
        left <= 1e-13 * size,
        "{left} N of {size} N are not returned"
    );
    let records: SVector<f64, D> = driver.contacts().iter().map(|c| c.force).sum();
    assert!((records - on_own).norm() <= 1e-13 * size);
    Ok(if own.starts_with("upper") {
        on_own
    } else {
        on_other
    })
}

/// The largest distance of the stress at any point from a uniform one, over that one.
pub(super) fn stress_error<const D: usize>(driver: &Driver<D>, exact: [f64; 6]) -> f64 {
    let exact = Sym2::from_column_slice(&exact);
    let error = |s: Sym2| (s - exact).norm() / exact.norm();
    let points = driver.points();
    points.iter().map(|p| error(p.stress)).fold(0.0, f64::max)
}

/// Asserts that the stress is the same everywhere.
#[track_caller]
pub(super) fn uniform_stress<const D: usize>(driver: &Driver<D>, exact: [f64; 6], what: &str) {
    let error = stress_error(driver, exact);
    assert!(error <= 1e-10, "{what}: stress off by {error:.2e}");
}

/// Asserts that every contact point takes its share of the pressure; one on an axis of symmetry may
/// have none.
#[track_caller]
pub(super) fn uniform_pressure<const D: usize>(driver: &Driver<D>, pressure: f64, what: &str) {
    for c in driver.contacts() {
        match c.area == 0.0 {
            true => assert_eq!(c.t[0], 0.0, "{what}"),
            false => close(what, c.t[0] / c.area, pressure, 1e-9),
        }
    }
}
