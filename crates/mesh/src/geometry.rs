//! The map from a reference cell to a cell of R^D, by its basis vectors; knows no element.

/// The combination Σ N_a x_a of points.
pub(crate) fn interpolate<const D: usize>(shape: &[f64], nodes: &[[f64; D]]) -> [f64; D] {
    std::array::from_fn(|i| shape.iter().zip(nodes).map(|(n, x)| n * x[i]).sum())
}

/// Basis vectors g_j = ∂x/∂ξ_j = Σ ∂N_a/∂ξ_j x_a.
pub(crate) fn basis<const D: usize>(gradient: &[[f64; D]], nodes: &[[f64; D]]) -> [[f64; D]; D] {
    std::array::from_fn(|j| {
        std::array::from_fn(|i| gradient.iter().zip(nodes).map(|(g, x)| g[j] * x[i]).sum())
    })
}

/// Cofactor vectors c_j of the basis, c_j · g_k = det δ_jk.
///
/// c_0 does not depend on g_0: with the tangents of a facet as the other basis vectors it is the
/// facet's area vector, (t_y, −t_x) in the plane and t₁ × t₂ in space.
pub(crate) fn cofactors<const D: usize>(g: &[[f64; D]; D]) -> [[f64; D]; D] {
    const { assert!(D >= 1 && D <= 3) };
    let minor = |j: usize, i: usize| match D {
        1 => 1.0,
        2 if i == j => g[1 - j][1 - i],
        2 => -g[1 - j][1 - i],
        _ => {
            let [(j1, i1), (j2, i2)] = [1, 2].map(|k| ((j + k) % 3, (i + k) % 3));
            g[j1][i1] * g[j2][i2] - g[j1][i2] * g[j2][i1]
        }
    };
    std::array::from_fn(|j| std::array::from_fn(|i| minor(j, i)))
}

pub(crate) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Least and greatest corner of the box around points.
pub(crate) fn bounds<const D: usize>(points: &[[f64; D]]) -> ([f64; D], [f64; D]) {
    points.iter().fold(
        ([f64::INFINITY; D], [f64::NEG_INFINITY; D]),
        |(low, high), x| {
            (
                std::array::from_fn(|i| low[i].min(x[i])),
                std::array::from_fn(|i| high[i].max(x[i])),
            )
        },
    )
}

/// Diagonal of the box around points.
pub(crate) fn diagonal<const D: usize>(points: &[[f64; D]]) -> f64 {
    let (low, high) = bounds(points);
    let span: [f64; D] = std::array::from_fn(|i| high[i] - low[i]);
    dot(&span, &span).sqrt()
}
