//! Polylines cut off at a box and polygons at a line, so that pictures need no clip paths, which would need ids.

/// The part of a convex polygon where a function that is linear along its sides is positive, with what else its
/// corners carry.
pub(super) fn cut<const N: usize>(
    polygon: &[[f64; N]],
    function: impl Fn(&[f64; N]) -> f64,
) -> Vec<[f64; N]> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, a) in polygon.iter().enumerate() {
        let b = &polygon[(k + 1) % polygon.len()];
        let (f, g) = (function(a), function(b));
        if f >= 0.0 {
            kept.push(*a);
        }
        if (f > 0.0 && g < 0.0) || (f < 0.0 && g > 0.0) {
            let t = f / (f - g);
            kept.push(std::array::from_fn(|i| a[i] + t * (b[i] - a[i])));
        }
    }
    kept
}

/// The parts of a polyline in the box with least corner `low` and greatest corner `high`.
///
/// A single point is a polyline.
pub(super) fn clip(points: &[[f64; 2]], low: [f64; 2], high: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let inside = |p: &[f64; 2]| (0..2).all(|i| p[i] >= low[i] && p[i] <= high[i]);
    if let [point] = points {
        return if inside(point) {
            vec![vec![*point]]
        } else {
            Vec::new()
        };
    }
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some([a, b]) = clip_segment(pair[0], pair[1], low, high) else {
            open = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if open => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
        open = inside(&pair[1]);
    }
    pieces
}

/// The part of the segment from a to b in the box, by Liang and Barsky's parameters.
fn clip_segment(a: [f64; 2], b: [f64; 2], low: [f64; 2], high: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut t_0, mut t_1) = (0.0f64, 1.0f64);
    for i in 0..2 {
        let d = b[i] - a[i];
        if d == 0.0 {
            if a[i] < low[i] || a[i] > high[i] {
                return None;
            }
            continue;
        }
        let (enter, leave) = if d > 0.0 {
            (low[i], high[i])
        } else {
            (high[i], low[i])
        };
        t_0 = t_0.max((enter - a[i]) / d);
        t_1 = t_1.min((leave - a[i]) / d);
    }
    let at = |t: f64| [0, 1].map(|i| (a[i] + t * (b[i] - a[i])).clamp(low[i], high[i]));
    let ends = [
        if t_0 > 0.0 { at(t_0) } else { a },
        if t_1 < 1.0 { at(t_1) } else { b },
    ];
    (t_0 <= t_1 && ends.as_flattened().iter().all(|v| v.is_finite())).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::clip;

    fn unit(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        clip(points, [0.0; 2], [1.0; 2])
    }

    #[test]
    fn what_is_inside_stays_as_it_is() {
        let line = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.25]];
        assert_eq!(unit(&line), [line.to_vec()]);
        assert_eq!(unit(&line[1..2]), [vec![[0.5, 1.0]]]);
    }

    #[test]
    fn a_line_that_leaves_and_returns_is_in_two_pieces() {
        let pieces = unit(&[[0.25, 0.5], [0.25, 2.0], [0.75, 2.0], [0.75, 0.5]]);
        assert_eq!(
            pieces,
            [[[0.25, 0.5], [0.25, 1.0]], [[0.75, 1.0], [0.75, 0.5]]]
        );
    }

    #[test]
    fn a_line_through_the_box_is_cut_at_both_ends() {
        assert_eq!(unit(&[[-1.0, 0.5], [3.0, 0.5]]), [[[0.0, 0.5], [1.0, 0.5]]]);
    }

    #[test]
    fn what_is_outside_is_gone_even_where_differences_overflow() {
        assert!(unit(&[[-1.0, 0.5], [0.5, 3.0], [3.0, 3.0]]).is_empty());
        assert!(unit(&[[2.0, 2.0]]).is_empty());
        assert!(unit(&[]).is_empty());
        for piece in unit(&[[-1e308, -1e308], [1e308, 1e308]]) {
            assert!(piece.iter().flatten().all(|v| (0.0..=1.0).contains(v)));
        }
    }
}
