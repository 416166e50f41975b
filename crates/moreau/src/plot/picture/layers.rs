//! Which faces hide which, where they are seen from one side: layers from the far to the near; not how they are drawn.

use crate::plot::clip::cut;

/// Corners on paper with how near they are to the eye.
pub(super) type Polygon = Vec<[f64; 3]>;

/// Least area that two faces share, in square pixels: less is their rounding along an edge.
const LEAST: f64 = 1e-2;

/// Faces in layers, drawn one after the other: those of a layer hide nothing of each other, and each is after all that
/// it hides. Of two faces that pierce each other the one that is nearer in the mean is in front; of those that hide
/// each other in a circle the farthest comes first.
pub(super) fn layers(faces: &[Polygon]) -> Vec<Vec<usize>> {
    let mut above: Vec<Vec<usize>> = vec![Vec::new(); faces.len()];
    let mut waiting = vec![0usize; faces.len()];
    for [a, b] in neighbours(faces) {
        let [far, near] = match nearer(&faces[a], &faces[b]) {
            Some(way) if way > 0.0 => [b, a],
            // What touches is drawn in its order.
            Some(_) => [a, b],
            None => continue,
        };
        above[far].push(near);
        waiting[near] += 1;
    }
    let depth = |k: &usize| faces[*k].iter().map(|x| x[2]).sum::<f64>() / faces[*k].len() as f64;
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    let mut order = order.into_iter();
    let mut layer = vec![0usize; faces.len()];
    let mut done = vec![false; faces.len()];
    let mut ready: Vec<usize> = (0..faces.len()).filter(|&k| waiting[k] == 0).collect();
    loop {
        let next = ready.pop().or_else(|| order.find(|&k| !done[k]));
        let Some(k) = next else {
            break;
        };
        if std::mem::replace(&mut done[k], true) {
            continue;
        }
        for &near in above[k].iter().filter(|&&near| !done[near]) {
            layer[near] = layer[near].max(layer[k] + 1);
            waiting[near] -= 1;
            if waiting[near] == 0 {
                ready.push(near);
            }
        }
    }
    let count = layer.iter().max().map_or(0, |last| last + 1);
    let mut layers = vec![Vec::new(); count];
    layer
        .iter()
        .enumerate()
        .for_each(|(k, &l)| layers[l].push(k));
    layers
}

/// Whether a face hides a place.
pub(super) fn hides(face: &Polygon, [x, y, z]: [f64; 3], tolerance: f64) -> bool {
    triangles(face).any(|t| {
        let [a, b, c] = weights(&t, [x, y]);
        let inside = a > 0.0 && b > 0.0 && c > 0.0;
        inside && a * t[0][2] + b * t[1][2] + c * t[2][2] > z + tolerance
    })
}

/// Pairs of faces whose boxes on paper overlap.
fn neighbours(faces: &[Polygon]) -> Vec<[usize; 2]> {
    let bounds = |face: &Polygon, i: usize| {
        let extend = |[l, h]: [f64; 2], x: &[f64; 3]| [l.min(x[i]), h.max(x[i])];
        face.iter().fold([f64::INFINITY, f64::NEG_INFINITY], extend)
    };
    let boxes: Vec<[[f64; 2]; 2]> = faces.iter().map(|f| [bounds(f, 0), bounds(f, 1)]).collect();
    let all = |i: usize| {
        let extend = |[l, h]: [f64; 2], b: &[[f64; 2]; 2]| [l.min(b[i][0]), h.max(b[i][1])];
        boxes
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], extend)
    };
    let limits = [all(0), all(1)];
    let count = ((faces.len() as f64).sqrt().ceil() as usize).max(1);
    let slot = |i: usize, v: f64| {
        let part = (v - limits[i][0]) / (limits[i][1] - limits[i][0]);
        // Of a face that is no number: nowhere in particular.
        ((part * count as f64) as usize).min(count - 1)
    };
    let mut slots: Vec<Vec<usize>> = vec![Vec::new(); count * count];
    for (k, own) in boxes.iter().enumerate() {
        for column in slot(0, own[0][0])..=slot(0, own[0][1]) {
            for row in slot(1, own[1][0])..=slot(1, own[1][1]) {
                slots[row * count + column].push(k);
            }
        }
    }
    let mut pairs = Vec::new();
    for (at, own) in slots.iter().enumerate() {
        for (n, &a) in own.iter().enumerate() {
            for &b in &own[n + 1..] {
                let low = [0, 1].map(|i| boxes[a][i][0].max(boxes[b][i][0]));
                let overlap = (0..2).all(|i| low[i] < boxes[a][i][1].min(boxes[b][i][1]));
                // Once, where their overlap begins.
                if overlap && slot(1, low[1]) * count + slot(0, low[0]) == at {
                    pairs.push([a, b]);
                }
            }
        }
    }
    pairs
}

/// How much nearer the first face is, over what both cover; nothing where they do not cover each other.
fn nearer(a: &Polygon, b: &Polygon) -> Option<f64> {
    let (mut area, mut way) = (0.0, 0.0);
    for t in triangles(a) {
        let inside = |k: usize| move |x: &[f64; 3]| weights(&t, [x[0], x[1]])[k];
        for s in triangles(b) {
            let common = (0..3).fold(s.to_vec(), |p, k| cut(&p, inside(k)));
            for part in triangles(&common) {
                let own = 0.5 * doubled(&part).abs();
                let middle = [0, 1, 2].map(|i| (part[0][i] + part[1][i] + part[2][i]) / 3.0);
                let [u, v, w] = weights(&t, [middle[0], middle[1]]);
                area += own;
                way += own * (u * t[0][2] + v * t[1][2] + w * t[2][2] - middle[2]);
            }
        }
    }
    // Faces on each other: the later one is drawn over the earlier.
    let close = 1e-3 * area;
    (area > LEAST).then_some(if way.abs() < close { 0.0 } else { way })
}

/// The triangles of a convex face, those that are seen edge-on left out.
fn triangles(face: &[[f64; 3]]) -> impl Iterator<Item = [[f64; 3]; 3]> + '_ {
    let fan = (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]);
    fan.filter(|t| doubled(t).abs() > 1e-9)
}

/// Twice the area of a triangle on paper.
fn doubled([a, b, c]: &[[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Weights of the corners of a triangle at a place.
fn weights(t: &[[f64; 3]; 3], x: [f64; 2]) -> [f64; 3] {
    let at = [x[0], x[1], 0.0];
    let whole = doubled(t);
    let part = |a: [f64; 3], b: [f64; 3]| doubled(&[at, a, b]) / whole;
    [part(t[1], t[2]), part(t[2], t[0]), part(t[0], t[1])]
}

#[cfg(test)]
mod tests {
    use super::{hides, layers};

    /// A square of side 10 at a place, as near as a plane says.
    fn square([x, y]: [f64; 2], depth: impl Fn(f64, f64) -> f64) -> Vec<[f64; 3]> {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let place = |[s, t]: [f64; 2]| [x + s, y + t, depth(x + s, y + t)];
        corners.map(place).to_vec()
    }

    #[test]
    fn the_nearer_face_is_drawn_later_whatever_its_middle() {
        // The middle of the tilted one is nearer, but not where they overlap.
        let tilted = square([0.0, 0.0], |x, _| 100.0 - 12.0 * x);
        let flat = square([8.0, 0.0], |_, _| 10.0);
        assert_eq!(layers(&[flat.clone(), tilted.clone()]), [[1], [0]]);
        assert_eq!(layers(&[tilted.clone(), flat.clone()]), [[0], [1]]);
        assert!(hides(&flat, [9.0, 5.0, -5.0], 0.1) && !hides(&tilted, [9.0, 5.0, 10.0], 0.1));
        assert!(!hides(&flat, [9.0, 5.0, 9.95], 0.1) && !hides(&flat, [5.0, 5.0, -5.0], 0.1));
    }

    #[test]
    fn neighbours_share_a_layer_and_what_touches_keeps_its_order() {
        let row: Vec<_> = (0..40)
            .map(|k| square([10.0 * f64::from(k), 0.0], |x, y| x - y))
            .collect();
        assert_eq!(layers(&row), [(0..40).collect::<Vec<_>>()]);
        let twice = [row[3].clone(), row[3].clone()];
        assert_eq!(layers(&twice), [[0], [1]]);
        assert!(layers(&[]).is_empty());
    }

    #[test]
    fn faces_that_hide_each_other_in_a_circle_are_all_drawn() {
        let bar = |a: [f64; 2], b: [f64; 2], depth: [f64; 2]| {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let across = [-0.05 * dy, 0.05 * dx];
            let end = |x: [f64; 2], side: f64, z: f64| {
                [x[0] + side * across[0], x[1] + side * across[1], z]
            };
            vec![
                end(a, -1.0, depth[0]),
                end(b, -1.0, depth[1]),
                end(b, 1.0, depth[1]),
                end(a, 1.0, depth[0]),
            ]
        };
        let (a, b, c) = ([0.0, 0.0], [100.0, 0.0], [50.0, 80.0]);
        let circle = [
            bar(a, b, [0.0, 9.0]),
            bar(b, c, [0.0, 9.0]),
            bar(c, a, [0.0, 9.0]),
        ];
        assert_eq!(layers(&circle).concat().len(), 3);
    }
}
