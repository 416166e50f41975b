//! Quadrature rules on reference cells, with positive weights and interior points only; not
//! adaptive integration.

use std::f64::consts::PI;

/// How densely a cell is sampled; [`Element::rule`](crate::Element::rule) of each element says
/// by how many points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Integration {
    /// One degree less than full: relieves locking, and may leave spurious zero modes.
    Reduced,
    /// Exact for the stiffness of an undistorted cell.
    Full,
    /// The points of the full rule, with the dilatation of the strain replaced by its mean over the
    /// cell: B̄ = B + ⅓ 1 (b̄ − b), b the trace of B. Relieves the locking of linear cells in
    /// volume-preserving flow without spurious modes.
    ///
    /// Source: T. J. R. Hughes, *International Journal for Numerical Methods in Engineering* 15
    /// (1980) 1413-1418.
    BBar,
}

/// A point of a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<const D: usize> {
    /// Reference coordinates, inside the reference cell.
    pub xi: [f64; D],
    /// Weight > 0.
    pub weight: f64,
}

/// Quadrature rule on the reference cell of R^D: ∫ f ≈ Σ weight · f(ξ).
#[derive(Debug, Clone, PartialEq)]
pub struct Rule<const D: usize> {
    /// The points; in products of [`gauss`] the first coordinate runs fastest.
    pub points: Vec<Point<D>>,
}

/// Gauss–Legendre rule with n points on \[−1, 1\], in increasing order; exact for polynomials of
/// degree 2n − 1.
///
/// # Panics
///
/// If n is 0.
pub fn gauss(n: usize) -> Rule<1> {
    assert!(n > 0, "a Gauss rule needs at least one point");
    let point = |k: usize| {
        // From an estimate that lies in the basin of the k-th root, Newton's method converges to
        // rounding in far fewer steps than these.
        let mut x = -(PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (p, d_p) = legendre(n, x);
            x -= p / d_p;
        }
        let (_, d_p) = legendre(n, x);
        Point {
            xi: [x],
            weight: 2.0 / ((1.0 - x * x) * d_p * d_p),
        }
    };
    Rule {
        points: (0..n).map(point).collect(),
    }
}

/// Legendre polynomial P_n and its derivative, by the three-term recurrence; |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 1..n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0));
    }
    (p, n as f64 * (before - x * p) / (1.0 - x * x))
}

impl Rule<2> {
    /// Product of two [`gauss`] rules of n points on \[−1, 1\]²; exact for degree 2n − 1 in each
    /// coordinate.
    ///
    /// # Panics
    ///
    /// If n is 0.
    pub fn quadrilateral(n: usize) -> Self {
        let line = gauss(n).points;
        let row = |b: &Point<1>| {
            let b = *b;
            line.iter().map(move |a| Point {
                xi: [a.xi[0], b.xi[0]],
                weight: a.weight * b.weight,
            })
        };
        Self {
            points: line.iter().flat_map(row).collect(),
        }
    }

    /// Rule on the unit triangle ξ, η ≥ 0, ξ + η ≤ 1, exact for polynomials of at least the given
    /// total degree: symmetric with 1 point for degree 1, 3 for 2, 6 for 3 and 4, 7 for 5; above,
    /// products of [`gauss`] rules on the square that the triangle is with one side collapsed.
    ///
    /// # Panics
    ///
    /// If the degree is 0.
    pub fn triangle(degree: usize) -> Self {
        let centroid = |weight: f64| {
            vec![Point {
                xi: [1.0 / 3.0; 2],
                weight: 0.5 * weight,
            }]
        };
        // The three points with barycentric coordinates a, a, 1 − 2a.
        let orbit = |a: f64, weight: f64| {
            [[a, a], [1.0 - 2.0 * a, a], [a, 1.0 - 2.0 * a]]
                .map(|xi| Point {
                    xi,
                    weight: 0.5 * weight,
                })
                .to_vec()
        };
        let points = match degree {
            1 => centroid(1.0),
            2 => orbit(1.0 / 6.0, 1.0 / 3.0),
            3 | 4 => {
                let s = 10f64.sqrt();
                let a = (38.0 - 44.0 * 0.4f64.sqrt()).sqrt();
                let w = (213_125.0 - 53_320.0 * s).sqrt();
                [
                    orbit((8.0 - s + a) / 18.0, (620.0 + w) / 3720.0),
                    orbit((8.0 - s - a) / 18.0, (620.0 - w) / 3720.0),
                ]
                .concat()
            }
            5 => {
                let s = 15f64.sqrt();
                [
                    centroid(9.0 / 40.0),
                    orbit((6.0 - s) / 21.0, (155.0 - s) / 1200.0),
                    orbit((6.0 + s) / 21.0, (155.0 + s) / 1200.0),
                ]
                .concat()
            }
            0 => panic!("a triangle rule needs a degree of at least 1"),
            // ξ = s (1 − t), η = t: one degree more in t, by the Jacobian 1 − t.
            _ => {
                let collapsed = |p: &Point<2>| {
                    let [s, t] = p.xi.map(|v| 0.5 * (1.0 + v));
                    Point {
                        xi: [s * (1.0 - t), t],
                        weight: 0.25 * p.weight * (1.0 - t),
                    }
                };
                let square = Self::quadrilateral(degree.div_ceil(2) + 1).points;
                square.iter().map(collapsed).collect()
            }
        };
        Self { points }
    }
}

impl Rule<3> {
    /// Product of three [`gauss`] rules of n points on \[−1, 1\]³; exact for degree 2n − 1 in each
    /// coordinate.
    ///
    /// # Panics
    ///
    /// If n is 0.
    pub fn hexahedron(n: usize) -> Self {
        let plane = Rule::quadrilateral(n).points;
        let layer = |c: &Point<1>| {
            let c = *c;
            plane.iter().map(move |p| Point {
                xi: [p.xi[0], p.xi[1], c.xi[0]],
                weight: p.weight * c.weight,
            })
        };
        Self {
            points: gauss(n).points.iter().flat_map(layer).collect(),
        }
    }

    /// Symmetric rule on the unit tetrahedron ξ, η, ζ ≥ 0, ξ + η + ζ ≤ 1, exact for polynomials of
    /// the given total degree: 1 point for degree 1, 4 for 2, 14 for 5.
    ///
    /// # Panics
    ///
    /// If the degree is not 1, 2 or 5.
    pub fn tetrahedron(degree: usize) -> Self {
        // The four points with barycentric coordinates a, a, a, 1 − 3a.
        let orbit = |a: f64, weight: f64| {
            let b = 1.0 - 3.0 * a;
            [[a, a, a], [b, a, a], [a, b, a], [a, a, b]]
                .map(|xi| Point { xi, weight })
                .to_vec()
        };
        let points = match degree {
            1 => vec![Point {
                xi: [0.25; 3],
                weight: 1.0 / 6.0,
            }],
            2 => orbit((5.0 - 5f64.sqrt()) / 20.0, 1.0 / 24.0),
            5 => {
                let mut points = Vec::with_capacity(14);
                for (a, weight) in [
                    (0.310_885_919_263_300_6, 0.018_781_320_953_002_64),
                    (0.092_735_250_310_891_23, 0.012_248_840_519_393_658),
                ] {
                    points.extend(orbit(a, weight));
                }
                // The six points with barycentric coordinates a, a, ½ − a, ½ − a.
                let (a, weight) = (0.045_503_704_125_649_65, 0.007_091_003_462_846_911);
                let b = 0.5 - a;
                points.extend(
                    [[b, b, a], [b, a, b], [a, b, b]]
                        .into_iter()
                        .flat_map(|xi| [xi, xi.map(|x| a + b - x)])
                        .map(|xi| Point { xi, weight }),
                );
                points
            }
            _ => panic!("no tetrahedron rule of degree {degree}: it must be 1, 2 or 5"),
        };
        Self { points }
    }
}
