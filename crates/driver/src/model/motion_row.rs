//! Whose displacements make the relative displacement of a contact point; not its gap on a tool, nor the law.

use crate::vector::subspace::Subspace;
use moreau_contact::frame;
use moreau_mesh::MortarRow;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use std::collections::BTreeMap;

/// Spread of opposite nodes along a direction, over the largest, that is none.
const NO_SPREAD: f64 = 1e-6;

/// Whose displacements make the relative displacement of a contact point during an increment:
/// Σ own·v − Σ opposite·v. Forces go back with the same weights.
#[derive(Debug, Clone, Default)]
pub(crate) struct RelativeMotionRow<const D: usize> {
    /// The node, and those that share its multiplier at the edge of an overlap or its shape function
    /// in a changed basis.
    pub(crate) own: Vec<(usize, f64)>,
    /// Nodes of the surface opposite, or that of the tool.
    pub(crate) opposite: Vec<(usize, f64)>,
    /// Share of the surface in contact \[mm²\].
    pub(crate) area: f64,
    /// Whether it says only what its node can do: others say what the nodes opposite do along the rest.
    pub(crate) own_only: bool,
    /// Directions along which tools hold both its sides, so that nothing is left for it to say.
    pub(crate) grounded: Vec<SVector<f64, D>>,
    /// Normal and gap where the surfaces were paired, where they are those of a surface.
    plane: Option<(SVector<f64, D>, f64)>,
    /// Slip from the start of the increment to there, in space \[mm\].
    pub(crate) slipped: Option<SVector<f64, D>>,
}

impl<const D: usize> RelativeMotionRow<D> {
    /// On a tool, a body of the one node `tool`.
    pub(crate) fn on_tool(own: &[(usize, f64)], area: f64, tool: usize) -> Self {
        Self {
            own: own.to_vec(),
            opposite: vec![(tool, 1.0)],
            area,
            ..Self::default()
        }
    }

    /// On a surface, with nodes at the given positions.
    pub(crate) fn on_surface(mortar_row: MortarRow<D>, positions: &[[f64; D]]) -> Self {
        let mut motion_row = Self {
            own: mortar_row.own,
            opposite: mortar_row.opposite,
            area: mortar_row.area,
            ..Self::default()
        };
        let normal = SVector::from(mortar_row.normal);
        let apart = motion_row.relative(|a| SVector::from(positions[a]));
        motion_row.plane = Some((normal, normal.dot(&apart)));
        motion_row
    }

    /// Puts both points of the row, Σ own·x and Σ opposite·x, on one normal, and takes the gap from there: forces
    /// that touch leave no moment then. What that changes of the opposite weights is the least in proportion to
    /// them: a part of the gap times the difference of normals, nothing between plane surfaces.
    pub(crate) fn settle(&mut self, positions: &[[f64; D]]) {
        let Some((normal, _)) = self.plane else {
            return;
        };
        let at = |a: usize| SVector::<f64, D>::from(positions[a]);
        let tangents = frame(&normal);
        let along =
            |v: SVector<f64, D>| DVector::from_fn(D - 1, |j, _| tangents.column(j + 1).dot(&v));
        let total: f64 = self.opposite.iter().map(|(_, w)| w.abs()).sum();
        let sum = self.opposite.iter().map(|&(b, w)| at(b) * w.abs());
        let middle = sum.sum::<SVector<f64, D>>() / total;
        let mut spread = DMatrix::<f64>::zeros(D - 1, D - 1);
        for &(b, w) in &self.opposite {
            let off = along(at(b) - middle);
            spread += &off * off.transpose() * w.abs();
        }
        let missing = along(self.relative(at));
        let spread = spread.symmetric_eigen();
        let widest = spread.eigenvalues.amax();
        // What is far apart, and touches nothing, stays as it is.
        if missing.norm_squared() <= widest {
            let mut slope = DVector::<f64>::zeros(D - 1);
            for (direction, &width) in spread.eigenvectors.column_iter().zip(&spread.eigenvalues) {
                if width > NO_SPREAD * widest {
                    slope += direction * (direction.dot(&missing) / width);
                }
            }
            for (b, w) in &mut self.opposite {
                *w += w.abs() * slope.dot(&along(at(*b) - middle));
            }
        }
        self.plane = Some((normal, normal.dot(&self.relative(at))));
    }

    /// Puts Σ opposite·x where Σ own·x is, for a tie: rigid motions of both bodies together, and uniform strains, leave no
    /// relative displacement then, and forces no moment. Along the surface as [`Self::settle`]; what is left of a
    /// distance is bridged by nodes of the cells behind the surface opposite, `behind` with shares, as its displacements
    /// go on beyond it.
    pub(crate) fn close(
        &mut self,
        positions: &[[f64; D]],
        rounding: f64,
        behind: impl FnOnce() -> BTreeMap<usize, f64>,
    ) {
        self.settle(positions);
        let at = |a: usize| SVector::<f64, D>::from(positions[a]);
        let missing = self.relative(at);
        if missing.norm() > rounding {
            let behind = behind();
            let total: f64 = behind.values().sum();
            let sum: SVector<f64, D> = behind.iter().map(|(&a, c)| at(a) * *c).sum();
            let middle = sum / total;
            let mut spread = SMatrix::<f64, D, D>::zeros();
            for (&a, c) in &behind {
                let off = at(a) - middle;
                spread += off * off.transpose() * *c;
            }
            // Cells have a volume: their nodes spread along all directions.
            if let Some(inverse) = spread.try_inverse() {
                let slope = inverse * missing;
                let mut opposite: BTreeMap<usize, f64> = self.opposite.iter().copied().collect();
                for (&a, c) in &behind {
                    *opposite.entry(a).or_insert(0.0) += c * slope.dot(&(at(a) - middle));
                }
                self.opposite = opposite.into_iter().collect();
            }
        }
        if let Some((_, gap)) = &mut self.plane {
            *gap = 0.0;
        }
    }

    /// Faces along another normal.
    pub(crate) fn turn_to(&mut self, normal: SVector<f64, D>) {
        if let Some(plane) = &mut self.plane {
            plane.0 = normal;
        }
    }

    /// Takes note of the slip since the start of the increment, where the row was `first` and the nodes were
    /// `d_u` before these positions: how far, along the surface as it is now, the two points have parted that were opposite to each other
    /// then. It vanishes where the surfaces move as one body, however far (M. A. Puso and T. A. Laursen, *Comput. Methods
    /// Appl. Mech. Engng* 193 (2004) 4891–4913). Opposite to nothing then, the displacement relative to what is
    /// opposite now.
    pub(crate) fn slide(&mut self, first: &Self, positions: &[[f64; D]], d_u: &[f64]) {
        let Some((normal, _)) = self.plane else {
            return;
        };
        let at = |a: usize| SVector::<f64, D>::from(positions[a]);
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let parted = match first.plane {
            Some(_) => first.relative(at) - self.relative(at),
            None => self.relative(moved),
        };
        self.slipped = Some(parted - normal * normal.dot(&parted));
    }

    /// Σ own·v − Σ opposite·v.
    pub(crate) fn relative(&self, v: impl Fn(usize) -> SVector<f64, D>) -> SVector<f64, D> {
        self.weights().map(|(a, w)| v(a) * w).sum()
    }

    /// Adds a part of the multiplier of another point to its own: rows and gaps become means by
    /// area.
    pub(crate) fn take_over(&mut self, other: &Self, part: f64) {
        let (own, given) = (self.area, part * other.area);
        let area = own + given;
        let mean = |a: &[(usize, f64)], b: &[(usize, f64)]| -> Vec<(usize, f64)> {
            let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
            for (weights, share) in [(a, own), (b, given)] {
                for &(node, weight) in weights {
                    *sum.entry(node).or_insert(0.0) += share / area * weight;
                }
            }
            sum.into_iter().collect()
        };
        self.own = mean(&self.own, &other.own);
        self.opposite = mean(&self.opposite, &other.opposite);
        self.area = area;
        if let (Some((n, gap)), Some((m, beside))) = (&mut self.plane, other.plane) {
            *n = (*n * own + m * given).normalize();
            *gap = (*gap * own + beside * given) / area;
        }
    }

    /// Nodes with their weights, negative on the opposite side.
    pub(crate) fn weights(&self) -> impl Iterator<Item = (usize, f64)> {
        let opposite = self.opposite.iter().map(|&(b, w)| (b, -w));
        self.own.iter().copied().chain(opposite)
    }

    /// The largest weight, of either side.
    pub(crate) fn largest_weight(&self) -> f64 {
        self.weights().fold(0.0, |m: f64, (_, w)| m.max(w.abs()))
    }

    /// Whether another row says the same, of either sign: as vectors of weights their sine is at most `sine`.
    pub(crate) fn is_along(&self, other: &Self, sine: f64) -> bool {
        let others: BTreeMap<usize, f64> = other.weights().collect();
        let squared = |row: &Self| row.weights().map(|(_, w)| w * w).sum::<f64>();
        let both: f64 = (self.weights())
            .filter_map(|(a, w)| Some(w * others.get(&a)?))
            .sum();
        both * both > (1.0 - sine * sine) * squared(self) * squared(other)
    }

    /// The nodes on both sides.
    pub(crate) fn nodes(&self) -> Vec<usize> {
        self.weights().map(|(a, _)| a).collect()
    }

    /// Normal and gap after a relative displacement; `None` on a tool and opposite to nothing.
    pub(crate) fn plane(&self, slip: &SVector<f64, D>) -> Option<(SVector<f64, D>, f64)> {
        let (normal, gap) = self.plane?;
        Some((normal, gap + normal.dot(slip)))
    }

    /// Where the relative displacement is free, from where nodes are: as the own node is and, unless it says only that, as
    /// all of those opposite are; less what tools hold of both.
    pub(crate) fn free(&self, node: usize, of: impl Fn(usize) -> Subspace<D>) -> Subspace<D> {
        let opposite = self
            .opposite
            .iter()
            .filter(|_| !self.own_only)
            .map(|&(b, _)| of(b));
        let free = match opposite.reduce(|all, other| all.common(&other)) {
            Some(opposite) => of(node).with(&opposite),
            None => of(node),
        };
        match self.grounded.is_empty() {
            true => free,
            false => free.common(&Subspace::spanned(&self.grounded).complement()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::directions::Directions;
    use moreau_mesh::{
        CellKind, Hypothesis, Mesh, Pairing, PlaneStrain, Solid, block2, block3, uniform,
    };
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    #[test]
    fn what_moves_together_does_not_slip() {
        let motion_row = RelativeMotionRow::<2> {
            own: vec![(0, 0.75), (1, 0.25)],
            opposite: vec![(2, 1.5), (3, -0.5)],
            ..RelativeMotionRow::default()
        };
        let same = motion_row.relative(|_| SVector::<f64, 2>::new(0.5, 0.1));
        assert!(same.norm() < 1e-15, "carried along: {same}");
        // A direction is free if the own node is, or all of those opposite are.
        let none = Directions::default();
        let free = |held: &[usize]| {
            let of = |a| Subspace::of_node(a, &none, |dof| !held.contains(&dof));
            motion_row.free(0, of).within
        };
        assert_eq!(free(&[0]), [true, true]);
        assert_eq!(free(&[0, 4]), [false, true]);
        // Held along 37°, and opposite along −20°, and both along 37°.
        let held_along = |own: f64, opposite: f64| {
            let at = |degrees: f64| SVector::from(<[f64; 2]>::from(degrees.to_radians().sin_cos()));
            let of = |a: usize| match a {
                0 => Subspace::spanned(&[at(own)]).complement(),
                2 => Subspace::spanned(&[at(opposite)]).complement(),
                _ => Subspace::all(),
            };
            motion_row.free(0, of)
        };
        assert_eq!(held_along(37.0, -20.0).dimension(), 2);
        let left = held_along(37.0, 37.0);
        let along = SVector::from(<[f64; 2]>::from(37.0f64.to_radians().sin_cos()));
        assert_eq!(left.dimension(), 1);
        assert!(left.part(&along).norm() < 1e-15);
    }

    #[test]
    fn what_is_taken_over_is_a_mean_by_area() {
        let plane = |y: f64, gap| Some((SVector::<f64, 2>::new(0.0, y), gap));
        let mut motion_row = RelativeMotionRow {
            own: vec![(0, 1.0)],
            opposite: vec![(2, 0.5), (3, 0.5)],
            area: 3.0,
            own_only: false,
            grounded: Vec::new(),
            plane: plane(1.0, 0.1),
            slipped: None,
        };
        let held = RelativeMotionRow {
            own: vec![(1, 1.0)],
            opposite: vec![(2, 1.0)],
            area: 2.0,
            own_only: false,
            grounded: Vec::new(),
            plane: plane(1.0, 0.5),
            slipped: None,
        };
        motion_row.take_over(&held, 0.5);
        assert_eq!(motion_row.area, 4.0);
        assert_eq!(motion_row.own, [(0, 0.75), (1, 0.25)]);
        assert_eq!(motion_row.opposite, [(2, 0.625), (3, 0.375)]);
        let (normal, gap) = motion_row.plane(&SVector::zeros()).expect("a surface");
        assert_eq!((normal[1], gap), (1.0, 0.2));
    }

    /// Rows of two blocks that are curved where they touch, in the plane or in space, at the places that a motion
    /// takes them to.
    fn rows<const D: usize>(
        mesh: &Mesh<D>,
        hypothesis: &impl Hypothesis<D>,
        positions: &[[f64; D]],
    ) -> Vec<RelativeMotionRow<D>> {
        let surfaces =
            ["upper.bottom", "lower.top"].map(|name| mesh.facet_group(name).expect("there"));
        let surfaces = (surfaces[0], surfaces[1]);
        let rows = mesh.mortar_rows(positions, surfaces, Pairing::Mortar, hypothesis);
        rows.into_iter()
            .map(|row| RelativeMotionRow::on_surface(row, positions))
            .collect()
    }

    fn plane() -> Mesh<2> {
        let block = |name: &str, y: [f64; 2], cells: usize| {
            block2(
                name,
                CellKind::Quad8,
                &uniform(0.0, 6.0, cells),
                &uniform(y[0], y[1], 1),
            )
        };
        block("upper", [0.0, 2.0], 5)
            .and_then(|upper| upper.joined(block("lower", [-2.0, 0.0], 4)?))
            .expect("valid")
    }

    fn space() -> Mesh<3> {
        let block = |name: &str, y: [f64; 2], cells: usize| {
            let lines = uniform(0.0, 6.0, cells);
            block3(
                name,
                CellKind::Hex8,
                &lines,
                &uniform(y[0], y[1], 1),
                &lines,
            )
        };
        block("upper", [0.0, 2.0], 4)
            .and_then(|upper| upper.joined(block("lower", [-2.0, 0.0], 3)?))
            .expect("valid")
    }

    /// The nodes, with what is done to those of the upper block.
    fn lifted<const D: usize>(
        mesh: &Mesh<D>,
        mut place: impl FnMut([f64; D], bool) -> [f64; D],
    ) -> Vec<[f64; D]> {
        let upper = mesh.node_group("upper").expect("there");
        let nodes = mesh.nodes().iter().enumerate();
        nodes
            .map(|(a, x)| place(*x, upper.binary_search(&a).is_ok()))
            .collect()
    }

    /// Bent by a part of a millimetre, above less than below.
    fn bent<const D: usize>(mut x: [f64; D], bow: f64, above: bool) -> [f64; D] {
        let along = (0..D).filter(|i| *i != 1).map(|i| (0.7 * x[i]).sin());
        x[1] += if above { 0.9 * bow } else { bow } * along.sum::<f64>();
        x
    }

    /// A rotation and a translation.
    fn moved<const D: usize>(x: &[f64; D], angle: f64, by: f64) -> [f64; D] {
        let axis = if D == 2 {
            Vector3::z()
        } else {
            Vector3::new(0.3, -1.0, 0.5)
        };
        let all = Rotation3::new(axis.normalize() * angle).into_inner();
        let turn = SMatrix::<f64, D, D>::from_fn(|i, j| all[(i, j)]);
        (turn * SVector::from(*x) + SVector::repeat(by)).into()
    }

    /// The moment of unit forces along the normal and along the first tangent that a row leaves \[mm\], beside that of
    /// its gap.
    fn moment<const D: usize>(row: &RelativeMotionRow<D>, positions: &[[f64; D]]) -> f64 {
        let (normal, gap) = row.plane(&SVector::zeros()).expect("a surface");
        let apart = row.relative(|a| SVector::from(positions[a]));
        (apart - normal * gap).norm()
    }

    fn check<const D: usize>(
        mesh: &Mesh<D>,
        hypothesis: &impl Hypothesis<D>,
        (bow, angle, by): (f64, f64, f64),
    ) -> Result<(), TestCaseError> {
        let x = lifted(mesh, |x, above| bent(x, bow, above));
        let y: Vec<[f64; D]> = x.iter().map(|x| moved(x, angle, by)).collect();
        let increments = x
            .iter()
            .zip(&y)
            .flat_map(|(x, y)| (0..D).map(move |i| y[i] - x[i]));
        let d_u: Vec<f64> = increments.collect();
        let (mut before, mut after) = (rows(mesh, hypothesis, &x), rows(mesh, hypothesis, &y));
        let raw = before.iter().map(|row| moment(row, &x)).fold(0.0, f64::max);
        before.iter_mut().for_each(|row| row.settle(&x));
        prop_assert!(before.len() > D);
        let size = 6.0 + by.abs();
        for (first, row) in before.iter().zip(&mut after) {
            row.settle(&y);
            row.slide(first, &y, &d_u);
            let gaps = [first, row].map(|row| row.plane(&SVector::zeros()).expect("a surface").1);
            prop_assert!((gaps[0] - gaps[1]).abs() <= 1e-12 * size, "{:?}", gaps);
            let slipped = row.slipped.expect("an increment").norm();
            prop_assert!(slipped <= 1e-12 * size, "slip {slipped:e}");
            for (what, row, at) in [("before", first, &x), ("after", row, &y)] {
                let left = moment(row, at);
                prop_assert!(left <= 1e-13 * size, "{what}: {left:e}");
                let sums = [&row.own, &row.opposite].map(|w| w.iter().map(|w| w.1).sum::<f64>());
                prop_assert!((sums[0] - 1.0).abs() + (sums[1] - 1.0).abs() <= 1e-13);
            }
        }
        // Without being settled they would leave one.
        prop_assert!(raw > 1e-7 * bow * bow);
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn a_common_motion_is_no_slip_and_forces_leave_no_moment(
            bow in 0.05..0.4f64, angle in -3.0..3.0f64, by in -5.0..5.0f64
        ) {
            check(&plane(), &PlaneStrain::default(), (bow, angle, by))?;
            check(&space(), &Solid, (bow, angle, by))?;
        }

        /// Flat surfaces: the slip is the way, however far and across however many edges, and turned with both.
        #[test]
        fn the_slip_is_the_way_along_the_surface(
            way in -2.5..2.5f64, angle in -3.0..3.0f64, apart in -0.1..0.1f64
        ) {
            let mesh = plane();
            let x = mesh.nodes();
            let y = lifted(&mesh, |x, above| {
                let slid = if above { [x[0] + way, x[1] + apart] } else { x };
                moved(&slid, angle, 0.0)
            });
            let d_u: Vec<f64> = x.iter().zip(&y).flat_map(|(x, y)| [y[0] - x[0], y[1] - x[1]]).collect();
            let mut before = rows(&mesh, &PlaneStrain::default(), x);
            before.iter_mut().for_each(|row| row.settle(x));
            let along = SVector::from(moved(&[way, 0.0], angle, 0.0));
            for mut row in rows(&mesh, &PlaneStrain::default(), &y) {
                row.settle(&y);
                // The same point, where it is wholly on the other surface at both times.
                let whole = |row: &RelativeMotionRow<2>| row.own.len() == 1;
                let first = before.iter().find(|first| first.own == row.own);
                let Some(first) = first.filter(|first| whole(first) && whole(&row)) else { continue };
                row.slide(first, &y, &d_u);
                let off: SVector<f64, 2> = row.slipped.expect("an increment") - along;
                prop_assert!(off.norm() <= 1e-12, "{off}");
                let gap = row.plane(&SVector::zeros()).expect("a surface").1;
                prop_assert!((gap - apart).abs() <= 1e-12);
            }
        }
    }
}
