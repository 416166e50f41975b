//! A bound of the shear read off a table over the pressure; not what is done with a bound.

use crate::error::LawError;
use crate::friction::bounded::ShearBound;

/// Straight lines between points (t_n, g) of a bound of the shear by the pressure, constant beyond the last.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearTable {
    points: Vec<[f64; 2]>,
}

impl ShearTable {
    /// From pressures and bounds of the shear there \[MPa\].
    ///
    /// # Errors
    /// `ShearTable` unless there are points, all finite, the first at no pressure, with rising pressures and bounds that
    /// are not negative, never fall, and rise ever more slowly, as a [`ShearBound`] does.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, LawError> {
        let refused = |row: usize, problem| Err(LawError::ShearTable { row, problem });
        if points.is_empty() {
            return refused(1, "is missing");
        }
        let (mut before, mut first) = (f64::INFINITY, 0.0);
        for (k, &[pressure, shear]) in points.iter().enumerate() {
            if !(pressure.is_finite() && shear.is_finite()) {
                return refused(k + 1, "is not finite");
            }
            let Some(last) = k.checked_sub(1) else {
                match (pressure == 0.0, shear >= 0.0) {
                    (false, _) => return refused(1, "does not start at no pressure"),
                    (_, false) => return refused(1, "has a negative bound"),
                    _ => continue,
                }
            };
            if pressure <= points[last][0] {
                return refused(k + 1, "does not have more pressure than the one before");
            }
            let slope = slope(points[last], points[k]);
            if slope < 0.0 {
                return refused(k + 1, "falls: its bound is below the one before");
            }
            if last == 0 {
                first = slope;
            }
            if slope > before + ROUNDING * first {
                return refused(
                    k + 1,
                    "is steeper than the one before: the bound must be concave",
                );
            }
            before = before.min(slope);
        }
        let points = points.to_vec();
        Ok(Self { points })
    }

    /// The points \[MPa\].
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }
}

/// What slopes of rows that are read off a curve may rise by rounding, over the steepest.
const ROUNDING: f64 = 1e-9;

fn slope([p, g]: [f64; 2], [q, h]: [f64; 2]) -> f64 {
    (h - g) / (q - p)
}

impl ShearBound for ShearTable {
    fn bound(&self, t_n: f64) -> f64 {
        let after = self.points.partition_point(|x| x[0] <= t_n);
        match (after.checked_sub(1), self.points.get(after)) {
            // No number stays none.
            _ if t_n.is_nan() => t_n,
            (Some(k), Some(&next)) => {
                let last = self.points[k];
                last[1] + slope(last, next) * (t_n - last[0])
            }
            (Some(k), None) => self.points[k][1],
            (None, _) => self.points[0][1],
        }
    }

    fn slope(&self, t_n: f64) -> f64 {
        let after = self.points.partition_point(|x| x[0] <= t_n);
        match (after.checked_sub(1), self.points.get(after)) {
            (Some(k), Some(&next)) => slope(self.points[k], next),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ShearTable;
    use crate::Friction;
    use crate::contract;
    use crate::friction::bounded::ShearBound;

    fn law(points: &[[f64; 2]]) -> &'static ShearTable {
        Box::leak(Box::new(ShearTable::new(points).expect("a table")))
    }

    #[test]
    fn lines_between_points_and_constant_beyond() {
        let law = law(&[[0.0, 1.0], [10.0, 3.0], [30.0, 4.0]]);
        for (t_n, bound, slope) in [
            (0.0, 1.0, 0.2),
            (5.0, 2.0, 0.2),
            (10.0, 3.0, 0.05),
            (20.0, 3.5, 0.05),
            (30.0, 4.0, 0.0),
            (1e9, 4.0, 0.0),
        ] {
            assert!((law.bound(t_n) - bound).abs() < 1e-14, "{t_n}");
            assert!((law.slope(t_n) - slope).abs() < 1e-15, "{t_n}");
        }
        assert!(law.bound(f64::NAN).is_nan());
        assert_eq!(
            ShearTable::new(&[[0.0, 2.0]]).expect("a table").bound(7.0),
            2.0
        );
    }

    #[test]
    fn it_keeps_the_contract_of_laws_of_friction() {
        let law: Friction = law(&[[0.0, 0.0], [50.0, 10.0], [200.0, 25.0], [400.0, 30.0]]).into();
        contract::friction::<2>(law).expect("a law");
        contract::friction::<3>(law).expect("a law");
    }

    #[test]
    fn what_is_no_bound_is_refused_with_its_row() {
        for (points, row, word) in [
            (&[][..], 1, "missing"),
            (&[[1.0, 0.0]], 1, "no pressure"),
            (&[[0.0, -1.0]], 1, "negative"),
            (&[[0.0, f64::NAN]], 1, "finite"),
            (&[[0.0, 0.0], [0.0, 1.0]], 2, "more pressure"),
            (&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.9]], 3, "falls"),
            (&[[0.0, 0.0], [1.0, 0.1], [2.0, 0.3]], 3, "concave"),
            (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.1]], 3, "concave"),
        ] {
            let error = ShearTable::new(points).expect_err("no table").to_string();
            assert!(
                error.contains(&format!("row {row} ")) && error.contains(word),
                "{error}"
            );
        }
    }
}
