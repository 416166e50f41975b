//! Rules are exact up to their degree and not beyond, positive, and inside their cell.

use crate::ROUND_OFF;
use approx::assert_abs_diff_eq;
use moreau_mesh::{Rule, gauss};

fn integral<const D: usize>(rule: &Rule<D>, powers: [i32; D]) -> f64 {
    let value = |xi: &[f64; D]| -> f64 { (0..D).map(|i| xi[i].powi(powers[i])).product() };
    rule.points.iter().map(|p| p.weight * value(&p.xi)).sum()
}

/// ∫ over [−1, 1]^D.
fn cube<const D: usize>(powers: [i32; D]) -> f64 {
    powers
        .iter()
        .map(|&k| {
            if k % 2 == 0 {
                2.0 / f64::from(k + 1)
            } else {
                0.0
            }
        })
        .product()
}

/// ∫ over the unit simplex: Π k_i! / (Σ k_i + D)!.
fn simplex<const D: usize>(powers: [i32; D]) -> f64 {
    let factorial = |k: i32| (1..=k).map(f64::from).product::<f64>();
    let total = powers.iter().sum::<i32>() + D as i32;
    powers.iter().map(|&k| factorial(k)).product::<f64>() / factorial(total)
}

/// All exponents with each at most `max`.
fn exponents<const D: usize>(max: i32) -> impl Iterator<Item = [i32; D]> {
    let base = max + 1;
    (0..base.pow(D as u32)).map(move |k| std::array::from_fn(|i| k / base.pow(i as u32) % base))
}

fn is_exact<const D: usize>(rule: &Rule<D>, powers: [i32; D], exact: fn([i32; D]) -> f64) -> bool {
    (integral(rule, powers) - exact(powers)).abs() <= ROUND_OFF
}

#[test]
fn gauss_rules_are_exact_up_to_their_degree() {
    for n in 1..=12 {
        let rule = gauss(n);
        assert_eq!(rule.points.len(), n);
        assert!(rule.points.is_sorted_by(|a, b| a.xi[0] < b.xi[0]));
        assert!(
            rule.points
                .iter()
                .all(|p| p.weight > 0.0 && p.xi[0].abs() < 1.0)
        );
        let degree = 2 * n as i32 - 1;
        assert!(
            (0..=degree).all(|k| is_exact(&rule, [k], cube)),
            "{n} points"
        );
        // The defect falls like 4^−n; it is still far above rounding at 12 points.
        assert!(!is_exact(&rule, [degree + 1], cube), "{n} points");
    }
}

#[test]
fn gauss_points_known_by_hand() {
    let two = gauss(2);
    assert_abs_diff_eq!(two.points[1].xi[0], 1.0 / 3f64.sqrt(), epsilon = ROUND_OFF);
    let three = gauss(3);
    assert_abs_diff_eq!(three.points[0].xi[0], -0.6f64.sqrt(), epsilon = ROUND_OFF);
    assert_abs_diff_eq!(three.points[1].xi[0], 0.0, epsilon = ROUND_OFF);
    assert_abs_diff_eq!(three.points[1].weight, 8.0 / 9.0, epsilon = ROUND_OFF);
}

#[test]
fn product_rules_are_exact_up_to_their_degree() {
    for n in 1..=4 {
        let degree = 2 * n as i32 - 1;
        let plane = Rule::quadrilateral(n);
        assert_eq!(plane.points.len(), n * n);
        assert!(exponents(degree).all(|powers| is_exact(&plane, powers, cube)));
        assert!([[1, 0], [0, 1]].iter().all(|e| !is_exact(
            &plane,
            e.map(|k| k * 2 * n as i32),
            cube
        )));

        let solid = Rule::hexahedron(n);
        assert_eq!(solid.points.len(), n * n * n);
        assert!(exponents(degree).all(|powers| is_exact(&solid, powers, cube)));
        for axis in 0..3 {
            let powers = std::array::from_fn(|i| if i == axis { degree + 1 } else { 0 });
            assert!(!is_exact(&solid, powers, cube));
        }
    }
}

#[test]
fn the_first_coordinate_of_a_product_runs_fastest() {
    let points = Rule::quadrilateral(2).points;
    assert!(points[0].xi[0] < points[1].xi[0] && points[0].xi[1] == points[1].xi[1]);
    assert!(points[0].xi[1] < points[2].xi[1]);
}

/// Checks a rule on the unit simplex of exactly the given total degree.
fn has_degree<const D: usize>(rule: &Rule<D>, degree: i32) {
    assert!(rule.points.iter().all(|p| p.weight > 0.0));
    assert!(rule.points.iter().all(|p| p.xi.iter().all(|&x| x > 0.0)));
    assert!(rule.points.iter().all(|p| p.xi.iter().sum::<f64>() < 1.0));
    let of_total = |total: std::ops::RangeInclusive<i32>| {
        exponents::<D>(degree + 1).filter(move |e| total.contains(&e.iter().sum()))
    };
    assert!(of_total(0..=degree).all(|powers| is_exact(rule, powers, simplex)));
    assert!(of_total(degree + 1..=degree + 1).any(|powers| !is_exact(rule, powers, simplex)));
}

#[test]
fn triangle_rules_are_exact_up_to_their_degree() {
    let symmetric = [(1, 1, 1), (2, 3, 2), (3, 6, 4), (4, 6, 4), (5, 7, 5)];
    let collapsed = [(6, 16, 6), (7, 25, 8), (12, 49, 12)];
    for (asked, count, degree) in symmetric.into_iter().chain(collapsed) {
        let rule = Rule::triangle(asked);
        assert_eq!(rule.points.len(), count);
        has_degree(&rule, degree);
    }
}

#[test]
fn tetrahedron_rules_are_exact_up_to_their_degree() {
    for (degree, count) in [(1, 1), (2, 4), (5, 14)] {
        let rule = Rule::tetrahedron(degree);
        assert_eq!(rule.points.len(), count);
        has_degree(&rule, degree as i32);
    }
}
