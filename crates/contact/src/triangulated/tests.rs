//! Properties of triangulated tools, on a ball, a can and a cube.

use super::*;
use crate::Ball;
use nalgebra::Rotation3;
use proptest::prelude::*;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

const SHARP: f64 = 1.0;

type Skin = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// A ball of radius 2 around (1, 0, 0): an octahedron whose triangles are cut in four, so many times.
fn ball(times: usize) -> Skin {
    let center = Point::new(1.0, 0.0, 0.0);
    let mut at: Vec<Point> = [1.0, -1.0]
        .iter()
        .flat_map(|s| [Point::x() * *s, Point::y() * *s, Point::z() * *s])
        .collect();
    let mut faces = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    for _ in 0..times {
        let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
        let mut finer = Vec::new();
        for face in &faces {
            let middle = [0, 1, 2].map(|k| {
                let [a, b] = [face[k], face[(k + 1) % 3]];
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    at.push((at[a] + at[b]).normalize());
                    at.len() - 1
                })
            });
            finer.extend((0..3).map(|k| [face[k], middle[k], middle[(k + 2) % 3]]));
            finer.push(middle);
        }
        faces = finer;
    }
    let points = at.iter().map(|x| (center + x * 2.0).into()).collect();
    (points, faces)
}

/// The cylinder of radius 2 around the axis z from 0 to 6, with ends, of n sides.
fn can(n: usize) -> Skin {
    let ring = |z: f64| {
        (0..n).map(move |k| {
            let (s, c) = (TAU * k as f64 / n as f64).sin_cos();
            [2.0 * c, 2.0 * s, z]
        })
    };
    let mut points: Vec<[f64; 3]> = ring(0.0).chain(ring(6.0)).collect();
    points.extend([[0.0; 3], [0.0, 0.0, 6.0]]);
    let faces = (0..n).flat_map(|k| {
        let l = (k + 1) % n;
        [
            [k, l, n + l],
            [k, n + l, n + k],
            [l, k, 2 * n],
            [n + k, n + l, 2 * n + 1],
        ]
    });
    (points, faces.collect())
}

/// The cone around the axis z from its tip at 0 up to a height of 2 and a radius, of n sides in rings.
fn cone(n: usize, radius: f64, rings: usize) -> Skin {
    let ring = |i: usize| {
        let part = (i + 1) as f64 / rings as f64;
        (0..n).map(move |k| {
            let (s, c) = (TAU * k as f64 / n as f64).sin_cos();
            [radius * part * c, radius * part * s, 2.0 * part]
        })
    };
    let mut points: Vec<[f64; 3]> = (0..rings).flat_map(ring).collect();
    points.extend([[0.0; 3], [0.0, 0.0, 2.0]]);
    let (tip, middle) = (n * rings, n * rings + 1);
    let mut faces = Vec::new();
    for k in 0..n {
        let l = (k + 1) % n;
        let top = n * (rings - 1);
        faces.extend([[tip, l, k], [top + k, top + l, middle]]);
        for i in 1..rings {
            let below = n * (i - 1);
            faces.push([below + k, below + l, below + n + l]);
            faces.push([below + k, below + n + l, below + n + k]);
        }
    }
    (points, faces)
}

/// The torus of radii 3 and 1 around the axis z, of n by n quadrangles.
fn torus(n: usize) -> Skin {
    let angle = |k: usize| TAU * k as f64 / n as f64;
    let points = (0..n * n).map(|k| {
        let ((s, c), (z, r)) = (angle(k / n).sin_cos(), angle(k % n).sin_cos());
        [(3.0 + r) * c, (3.0 + r) * s, z]
    });
    let faces = (0..n * n).flat_map(|k| {
        let at = |i: usize, j: usize| (k / n + i) % n * n + (k % n + j) % n;
        [
            [at(0, 0), at(1, 0), at(1, 1)],
            [at(0, 0), at(1, 1), at(0, 1)],
        ]
    });
    (points.collect(), faces.collect())
}

fn cube() -> Skin {
    let points = (0..8).map(|k| [k & 1, (k >> 1) & 1, k >> 2].map(|b| b as f64));
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = sides
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (points.collect(), faces.collect())
}

/// Rings of as many points one above the other, with a face at either end.
fn lofted(rings: &[Vec<[f64; 3]>]) -> Skin {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut number = |x: [f64; 3]| {
        let is_same = |y: &[f64; 3]| (Point::from(*y) - Point::from(x)).norm() < 1e-9;
        points.iter().position(is_same).unwrap_or_else(|| {
            points.push(x);
            points.len() - 1
        })
    };
    let n = rings[0].len();
    let rings: Vec<Vec<usize>> = (rings.iter())
        .map(|ring| ring.iter().map(|&x| number(x)).collect())
        .collect();
    let mut faces = Vec::new();
    let (first, last) = (&rings[0], &rings[rings.len() - 1]);
    for k in 0..n {
        let next = (k + 1) % n;
        faces.push([first[0], first[next], first[k]]);
        for pair in rings.windows(2) {
            faces.push([pair[0][k], pair[0][next], pair[1][next]]);
            faces.push([pair[0][k], pair[1][next], pair[1][k]]);
        }
        faces.push([last[0], last[k], last[next]]);
    }
    faces.retain(|[a, b, c]| a != b && b != c && c != a);
    (points, faces)
}

/// Rings around a block of half sides, edges and corners rounded by 2, six steps a quarter.
fn rounded_block(half: [f64; 3]) -> Vec<Vec<[f64; 3]>> {
    let quarter = |from: f64| (0..=6).map(move |k| PI / 2.0 * (from + f64::from(k) / 6.0));
    let corners = [
        (0.0, 1.0, 1.0),
        (1.0, -1.0, 1.0),
        (2.0, -1.0, -1.0),
        (3.0, 1.0, -1.0),
    ];
    let latitudes = [(-1.0, -1.0), (0.0, 1.0)];
    let latitudes =
        (latitudes.into_iter()).flat_map(|(from, z)| quarter(from).map(move |at| (at, z)));
    let ring = |(latitude, z): (f64, f64)| {
        let longitudes =
            (corners.into_iter()).flat_map(|(from, x, y)| quarter(from).map(move |at| (at, x, y)));
        let point = |(longitude, x, y): (f64, f64, f64)| {
            let ((s, c), (up, out)) = (longitude.sin_cos(), latitude.sin_cos());
            [
                half[0] * x + 2.0 * c * out,
                half[1] * y + 2.0 * s * out,
                half[2] * z + 2.0 * up,
            ]
        };
        longitudes.map(point).collect()
    };
    latitudes.map(ring).collect()
}

fn surface((points, faces): &Skin) -> Triangulated {
    Triangulated::new(points, faces, SHARP).expect("closed")
}

/// Directions spread over the sphere.
fn directions(n: usize) -> impl Iterator<Item = Point> {
    (0..n).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
        let (s, c) = (PI * (1.0 + 5f64.sqrt()) * k as f64).sin_cos();
        Point::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
    })
}

/// Largest error of distance and normal beside a ball.
fn off(times: usize) -> (f64, f64) {
    let (surface, ball) = (
        surface(&ball(times)),
        Ball::new([1.0, 0.0, 0.0], 2.0).expect("a ball"),
    );
    directions(300).fold((0.0f64, 0.0f64), |(g, n), d| {
        let x = Point::new(1.0, 0.0, 0.0) + d * 2.3;
        let gap = (surface.distance(&x) - ball.distance(&x)).abs();
        (
            g.max(gap),
            n.max((surface.normal(&x) - ball.normal(&x)).norm()),
        )
    })
}

/// The surface is nearer to a ball by the fourth power of the edge, and its normal by the third.
#[test]
fn a_ball_of_triangles_is_round() {
    let [(g1, n1), (g2, n2), (g3, n3)] = [1, 2, 3].map(off);
    assert!(g1 < 4e-2 && g2 < 4e-3 && g3 < 3e-4, "{g1} {g2} {g3}");
    assert!(g1 > 8.0 * g2 && g2 > 12.0 * g3, "{g1} {g2} {g3}");
    assert!(n1 > 5.0 * n2 && n2 > 6.0 * n3, "{n1} {n2} {n3}");
}

/// Seen from both of its patches, an edge between smooth triangles has one normal.
#[test]
fn normals_are_continuous_across_smooth_edges() {
    let surface = surface(&ball(1));
    let mut seen: HashMap<[i64; 3], Vec<Point>> = HashMap::new();
    for patch in &surface.patches {
        for (a, b) in [
            ([0.0, 0.0], [1.0, 0.0]),
            ([1.0, 0.0], [0.0, 1.0]),
            ([0.0, 1.0], [0.0, 0.0]),
        ] {
            for s in [0.25, 0.5, 0.75] {
                let at = Vector2::from(a) * (1.0 - s) + Vector2::from(b) * s;
                let jet = patch.at(&at);
                let key = jet.x.map(|x| (x * 1e7).round() as i64).into();
                seen.entry(key)
                    .or_default()
                    .push(jet.normal().expect("a normal"));
            }
        }
    }
    for normals in seen.values() {
        assert_eq!(normals.len(), 2);
        assert!((normals[0] - normals[1]).norm() < 1e-12);
    }
}

/// The largest distance of the two points that patches have of an edge, and the largest difference of their normals where it
/// is smooth, all along.
fn jumps(surface: &Triangulated) -> [f64; 2] {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
    let at = |edge: usize, s: f64| {
        let [a, b] = [edge % 3, (edge + 1) % 3].map(|k| corners[k]);
        surface.patches[edge / 3].at(&(a * (1.0 - s) + b * s))
    };
    let plane = |edge: usize| {
        let [a, b, c] = surface.patches[edge / 3].corners();
        (b - a).cross(&(c - a))
    };
    let mut most = [0.0f64; 2];
    for (edge, &other) in surface.opposite.iter().enumerate() {
        for s in [1e-6, 1e-3, 0.1, 0.3, 0.5, 0.8, 0.999, 1.0 - 1e-6] {
            let (own, beside) = (at(edge, s), at(other, 1.0 - s));
            most[0] = most[0].max((own.x - beside.x).norm());
            if plane(edge).angle(&plane(other)) <= surface.sharp {
                let [n, m] = [own, beside].map(|jet| jet.normal().expect("a normal"));
                most[1] = most[1].max((n - m).norm());
            }
        }
    }
    most
}

/// Of a cone of circular section, whose sides are of these parts of a turn, one after the other.
fn uneven(parts: &[f64], radius: f64) -> Skin {
    let (n, whole) = (parts.len(), parts.iter().sum::<f64>());
    let (mut points, mut faces) = cone(n, radius, 1);
    let mut turned = 0.0;
    for (point, part) in points.iter_mut().zip(parts) {
        let (s, c) = (TAU * turned / whole).sin_cos();
        *point = [radius * c, radius * s, 2.0];
        turned += part;
    }
    faces.rotate_left(1);
    (points, faces)
}

/// A pyramid on its tip whose edges are rounded, four steps each.
fn pyramid() -> Skin {
    let (mut points, faces) = cone(20, 3.0, 1);
    for (k, point) in points[..20].iter_mut().enumerate() {
        let corner = PI * (0.25 + 0.5 * (k / 5) as f64);
        let (s, c) = (corner - 0.25 * PI + 0.125 * PI * (k % 5) as f64).sin_cos();
        let middle = [corner.cos(), corner.sin()].map(|x| 2.0 * 2f64.sqrt() * x);
        *point = [middle[0] + c, middle[1] + s, 2.0];
    }
    (points, faces)
}

/// Also where they end in a tip: of cones however cut, of a pyramid between its sides and the roundings of its edges, of a
/// quarter of a cone whose other sides are plane.
#[test]
fn edges_to_a_tip_have_one_normal_all_along() {
    let quarter = uneven(&[1.0, 1.0, 1.0, 1.0, 12.0 - 1e-9], 4.0);
    for skin in [
        cone(96, 5.6, 1),
        cone(24, 2.0, 3),
        cone(12, 5.6, 1),
        uneven(
            &[1.0, 2.0, 1.5, 3.0, 1.0, 1.2, 0.7, 2.0, 1.0, 1.0].repeat(2),
            6.0,
        ),
        pyramid(),
        quarter,
    ] {
        let [place, normal] = jumps(&surface(&skin));
        assert!(place < 1e-13 && normal < 1e-9, "{place} {normal}");
    }
}

/// Normals of a cone of sides are as symmetrical as its outline, from the tip to the rim, and along edges those of the round cone
/// through them, whatever their steps.
#[test]
fn normals_of_a_cone_are_those_of_its_outline() {
    let azimuth = |n: Point| n.y.atan2(n.x);
    for n in [12, 64] {
        let cone = surface(&cone(n, 5.6, 1));
        for k in 0..2 * n {
            let turned = PI * k as f64 / n as f64;
            let out = [1.0, (PI / n as f64).cos()][k % 2];
            for (height, lift) in [(1e-3, 1e-5), (0.1, 1e-4), (1.0, -1e-4), (1.9, 1e-3)] {
                let r = 2.8 * height * out;
                let x = Point::new(r * turned.cos(), r * turned.sin(), height + lift);
                let off = (azimuth(cone.normal(&x)) - turned) / TAU;
                assert!((off - off.round()).abs() < 1e-9, "{n} {k} {height}: {off}");
            }
        }
    }
    let parts = [1.0, 2.0, 1.5, 3.0, 1.0, 1.2, 1.0, 2.0, 1.0, 1.0].repeat(2);
    let cone = surface(&uneven(&parts, 6.0));
    let mut turned = 0.0;
    for part in &parts {
        let (s, c) = (TAU * turned / parts.iter().sum::<f64>()).sin_cos();
        for height in [0.01, 1.0, 1.9] {
            let exact = Point::new(2.0 * c, 2.0 * s, -6.0).normalize();
            let x = Point::new(3.0 * height * c, 3.0 * height * s, height) + exact * 1e-3;
            assert!((cone.normal(&x) - exact).norm() < 1e-9, "{turned} {height}");
        }
        turned += part;
    }
}

proptest! {
    /// A ball with dents has creases that end anywhere.
    #[test]
    fn surfaces_with_creases_are_continuous(dents in prop::collection::vec(0.8..1.0f64, 66), sharp in 0.3..0.9f64) {
        let (mut points, faces) = ball(2);
        for (x, dent) in points.iter_mut().zip(dents) {
            *x = [1.0 + dent * (x[0] - 1.0), dent * x[1], dent * x[2]];
        }
        let surface = Triangulated::new(&points, &faces, sharp).expect("closed");
        let [place, normal] = jumps(&surface);
        prop_assert!(place < 1e-13 && normal < 1e-9, "{place} {normal}");
    }
}

/// Opposite an edge, where the search for a perpendicular leaves both triangles beside it through another one.
#[test]
fn the_nearest_edge_is_met_wherever_the_search_ends() {
    let x = Point::new(0.7785016097511112, -0.2596892675529314, -0.2391723488813726);
    let distance = surface(&cube()).distance(&x);
    assert!((distance - x.y.hypot(x.z)).abs() < 1e-15, "{distance}");
}

/// The least distance of points spread over all patches, n + 1 along an edge.
fn sampled(surface: &Triangulated, x: &Point, n: u32) -> f64 {
    let inside = |i| (0..=n - i).map(move |j| Vector2::new(f64::from(i), f64::from(j)));
    let points = || (0..=n).flat_map(inside).map(|at| at / f64::from(n));
    let patches = surface.patches.iter();
    let all = patches.flat_map(|patch| points().map(|at| (patch.at(&at).x - x).norm()));
    all.fold(f64::INFINITY, f64::min)
}

/// Where a search from the middle of a patch does not come to its nearest point, and edges have valleys of their own.
#[test]
fn a_bent_patch_is_met_inside() {
    let torus = surface(&torus(8));
    for x in [
        Point::new(
            -2.1511930062162015,
            -1.3938054909756112,
            0.40729874438448255,
        ),
        Point::new(4.140482671285408, -1.1259849673326614, -3.4618767616979764),
        // Within the bulge of a patch, where all edges have valleys and the inside has another.
        Point::new(-3.3062693186974537, 1.8052463898509614, -0.818159479266013),
        Point::new(3.30211917766961, -1.8721157353656208, -0.8347113795551246),
        Point::new(3.284294292804703, 2.0103085832935914, 0.8614996302692761),
        Point::new(3.1736229825616284, 2.226559934349951, 0.9154004262752515),
        Point::new(2.269712798887527, -2.6798508014114044, 0.5804726068488453),
    ] {
        assert!(torus.distance(&x).abs() <= sampled(&torus, &x, 40), "{x:?}");
    }
}

/// A mantle is round, its ends are plane, and both meet along a round edge.
/// Wherever a plane part stands, it is known for one, which is met without a search.
#[test]
fn faces_of_a_cube_are_plane_wherever_it_stands() {
    for (k, far) in [0.0, 1.0, 30.0].into_iter().enumerate() {
        let turn = Rotation3::new(Point::new(0.3, -0.7, 0.2) * (1.0 + k as f64));
        let (points, faces) = cube();
        let moved =
            |x: &[f64; 3]| (turn * Point::from(*x) + Point::new(far, -far, 2.0 * far)).into();
        let points: Vec<[f64; 3]> = points.iter().map(moved).collect();
        let cube = surface(&(points, faces));
        assert!(cube.patches.iter().all(|patch| patch.is_plane), "{far}");
    }
}

/// A punch of revolution: a flat face of radius 8 at the bottom, a fillet of radius 2 in n steps, a wall and a lid, of 24
/// sides. The flat face stays plane, and the wall upright where its sides are.
/// Of a punch of radius 10 and height 20 whose edge below is rounded by 2, height and radius of the outline.
fn outline() -> impl Iterator<Item = [f64; 2]> {
    let rounded = (0..=8).map(|k| {
        let (s, c) = (PI / 16.0 * k as f64).sin_cos();
        [2.0 - 2.0 * c, 8.0 + 2.0 * s]
    });
    rounded.chain([[20.0, 10.0]])
}

/// Flat below to rounding and round beside it, as a whole and as a quarter cut off by two planes, a side away from those.
#[test]
fn what_a_fillet_of_revolution_rounds_off_keeps_its_shape() {
    for (turn, sides) in [(TAU, 24), (TAU / 4.0, 24)] {
        let rings: Vec<Vec<[f64; 3]>> = outline()
            .map(|[z, r]| {
                let round = (0..=sides).map(|k| {
                    let (s, c) = (turn * k as f64 / sides as f64).sin_cos();
                    [r * c, r * s, z]
                });
                match turn < TAU {
                    true => [[0.0, 0.0, z]].into_iter().chain(round).collect(),
                    false => round.take(sides).collect(),
                }
            })
            .collect();
        let punch = surface(&lofted(&rings));
        let mut most = [0.0f64; 2];
        for k in 0..200 {
            let part = 0.002 + 0.996 * (0.618 * k as f64).fract();
            let (s, c) = (turn * part).sin_cos();
            let r = 7.9 * (k as f64 / 200.0).sqrt();
            most[0] = most[0].max((punch.distance(&Point::new(r * c, r * s, -0.1)) - 0.1).abs());
            let (s, c) = (turn * (0.18 + 0.64 * part)).sin_cos();
            let z = 2.5 + 17.0 * k as f64 / 200.0;
            let out = punch.distance(&Point::new(10.1 * c, 10.1 * s, z)) - 0.1;
            most[1] = most[1].max(out.abs());
        }
        assert!(most[0] < 1e-12 && most[1] < 2e-3, "{turn}: {most:?}");
    }
}

/// A bar with one rounded edge as long as itself, of which the faces beside it are plane.
#[test]
fn what_a_straight_fillet_rounds_off_is_plane() {
    let rounded = (0..=8).map(|k| {
        let (s, c) = (PI / 16.0 * k as f64).sin_cos();
        [48.0 + 2.0 * s, 2.0 - 2.0 * c]
    });
    let outline: Vec<[f64; 2]> = [[0.0, 20.0], [0.0, 0.0]]
        .into_iter()
        .chain(rounded)
        .collect();
    let outline = outline.iter().chain(&[[50.0, 20.0]]);
    let rings = [0.0, 20.0].map(|z| outline.clone().map(|[x, y]| [*x, *y, z]).collect());
    let bar = surface(&lofted(&rings));
    for k in 0..200 {
        let z = 20.0 * (0.618 * k as f64).fract();
        let (x, y) = (0.24 * k as f64, 2.0 + 0.09 * k as f64);
        for at in [Point::new(x, -0.1, z), Point::new(50.1, y, z)] {
            assert!((bar.distance(&at) - 0.1).abs() < 1e-12, "{at:?}");
        }
    }
}

/// A block of which all edges and corners are rounded by 2: of the six faces to rounding, elsewhere to a fourth power; and
/// what is left of it without one, two and three of its sides, a plate, a capsule and a ball.
#[test]
fn a_block_with_rounded_edges_and_corners_has_plane_faces() {
    for half in [
        [20.0, 10.0, 5.0],
        [20.0, 10.0, 0.0],
        [20.0, 0.0, 0.0],
        [0.0, 0.0, 5.0],
        [0.0; 3],
    ] {
        let block = surface(&lofted(&rounded_block(half)));
        let mut most = [0.0f64; 2];
        for d in directions(2000) {
            let x = [0, 1, 2].map(|k| (1.2 * half[k] + 6.0) * d[k]);
            let beyond = [0, 1, 2].map(|k| (x[k].abs() - half[k]).max(0.0));
            let exact = Point::from(beyond).norm() - 2.0;
            let edge = usize::from(beyond.iter().filter(|b| **b > 0.0).count() > 1);
            most[edge] = most[edge].max((block.distance(&x.into()) - exact).abs());
        }
        assert!(most[0] < 1e-12 && most[1] < 1e-3, "{half:?}: {most:?}");
    }
}

#[test]
fn a_can_has_sharp_edges() {
    let off = |n: usize| {
        let can = surface(&can(n));
        directions(200).fold(0.0f64, |most, d| {
            let x = Point::new(3.0 * d.x, 3.0 * d.y, 3.0 + 4.0 * d.z);
            let (beyond, outside) = ((x.z - 3.0).abs() - 3.0, x.xy().norm() - 2.0);
            let exact = match beyond > 0.0 && outside > 0.0 {
                true => beyond.hypot(outside),
                false => beyond.max(outside),
            };
            most.max((can.distance(&x) - exact).abs())
        })
    };
    let (coarse, fine) = (off(24), off(48));
    assert!(coarse < 3e-4 && fine < coarse / 12.0, "{coarse} {fine}");
    let can = surface(&can(24));
    assert!((can.distance(&Point::new(1.9, 0.3, 7.0)) - 1.0).abs() < 1e-14);
}

proptest! {
    /// Of a cube the distance is known everywhere.
    #[test]
    fn a_cube_is_met_to_rounding(x in prop::array::uniform3(-1.0..2.0f64)) {
        let outside = x.map(|x| (x - 0.5f64).abs() - 0.5);
        let most = outside.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let exact = match most > 0.0 {
            true => outside.iter().map(|d| d.max(0.0).powi(2)).sum::<f64>().sqrt(),
            false => most,
        };
        let x = Point::from(x);
        let cube = surface(&cube());
        prop_assert!((cube.distance(&x) - exact).abs() < 1e-12);
        prop_assert!((cube.clone().hollow().distance(&x) + exact).abs() < 1e-12);
        if exact > 0.05 {
            prop_assert!((x - cube.normal(&x) * exact).iter().all(|v| (-1e-12..1.0 + 1e-12).contains(v)));
        }
    }

    /// No point of a curved surface is nearer than that which is found, from inside and from outside.
    #[test]
    fn of_all_points_the_nearest_is_met(x in prop::array::uniform3(-4.5..4.5f64), which in 0..6usize) {
        let skin = vec![ball(0), ball(1), can(8), torus(8), cone(12, 4.0, 1), pyramid()].swap_remove(which);
        let (surface, x) = (surface(&skin), Point::from(x));
        prop_assert!(surface.distance(&x).abs() <= sampled(&surface, &x, 8) + 1e-12);
    }

    /// Normals are gradients of the distance, and curvatures those of normals: off edges to the order of the step.
    #[test]
    fn derivatives_are_those_of_differences(x in prop::array::uniform3(-1.0..1.0f64), which in 0..3usize) {
        let (surface, center) = match which {
            0 => (surface(&ball(1)), Point::new(1.0, 0.0, 0.0)),
            1 => (surface(&can(16)), Point::new(0.0, 0.0, 3.0)),
            _ => (surface(&cone(16, 3.0, 1)), Point::new(0.0, 0.0, 1.0)),
        };
        let Some(d) = Point::from(x).try_normalize(0.1) else { return Ok(()) };
        let x = center + d * 4.0;
        // Opposite a corner of the rim the curvature is that of a point.
        let turn = x.y.atan2(x.x) / TAU * 16.0;
        if which > 0 && (turn - turn.round()).abs() < 1e-3 {
            return Ok(());
        }
        let (n, h) = (surface.normal(&x), 1e-5);
        prop_assert!((n.norm() - 1.0).abs() < 1e-12);
        let curvature = surface.curvature(&x);
        for i in 0..3 {
            let e = Point::from_fn(|k, _| if k == i { h } else { 0.0 });
            let slope = (surface.distance(&(x + e)) - surface.distance(&(x - e))) / (2.0 * h);
            prop_assert!((slope - n[i]).abs() < 1e-8, "{slope} {}", n[i]);
            let [left, right] = [x - e, x + e].map(|x| surface.normal(&x));
            let (to, back) = ((right - n) / h, (n - left) / h);
            // Where the curvature jumps, at an edge, one side is as good as the other.
            if (to - back).norm() < 1e-3 {
                let turned = (right - left) / (2.0 * h);
                prop_assert!((turned - curvature.column(i)).norm() < 2e-4, "{turned} {curvature}");
            }
        }
        prop_assert!((curvature - curvature.transpose()).norm() < 1e-12);
    }

    /// Ways are as long as on the round surface.
    #[test]
    fn ways_are_arcs(a in 0.1..3.0f64, b in 0.1..3.0f64, c in -1.0..1.0f64) {
        let (surface, round) = (surface(&ball(3)), Ball::new([1.0, 0.0, 0.0], 2.0).expect("a ball"));
        let at = |a: f64, b: f64| Point::new(1.0, 0.0, 0.0) + Point::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos()) * 2.05;
        let (from, to) = (at(a, b), at(a + 0.5 * c, b + 0.2));
        let (way, exact) = (surface.way(&from, &to), round.way(&from, &to));
        prop_assert!((way - exact).norm() < 2e-3 * exact.norm(), "{way} {exact}");
    }
}

#[test]
fn what_is_no_closed_surface_is_refused() {
    let (points, faces) = cube();
    let said = |faces: &[[usize; 3]], points: &[[f64; 3]]| {
        Triangulated::new(points, faces, SHARP)
            .expect_err("refused")
            .to_string()
    };
    assert!(said(&faces[1..], &points).contains("open along an edge"));
    // Without a side all of its corners are far from each other.
    assert!(!said(&faces[2..], &points).contains("apart"));
    // One triangle has a corner of its own, 0.003 from that of the others.
    let (mut torn, mut more) = (faces.clone(), points.clone());
    more.push([
        points[torn[0][1]][0] + 3e-3,
        points[torn[0][1]][1],
        points[torn[0][1]][2],
    ]);
    torn[0][1] = 8;
    assert!(
        said(&torn, &more).contains("3.0e-3 mm apart"),
        "{}",
        said(&torn, &more)
    );
    let mut turned = faces.clone();
    turned[3].swap(0, 1);
    assert!(said(&turned, &points).contains("same sense"));
    let twice = [&faces[..], &faces[..1]].concat();
    assert!(said(&twice, &points).contains("more than two"));
    let mut flat = points.clone();
    flat[2] = [0.0, 0.5, 0.5];
    flat[3] = [0.0, 0.25, 0.25];
    flat[0] = [0.0, 0.75, 0.75];
    assert!(said(&faces, &flat).contains("no area"));
    assert!(said(&[], &points).contains("number of triangles"));
    assert!(said(&[[0, 1, 9]], &points).contains("one of the points"));
    let inwards: Vec<[usize; 3]> = faces.iter().map(|&[a, b, c]| [b, a, c]).collect();
    let cube = surface(&(points, inwards));
    assert!((cube.distance(&Point::new(0.5, 0.5, 2.0)) - 1.0).abs() < 1e-14);
}

/// Also between the edges of its sides: a tenth of what plane sides would be off, from the tip to the rim.
#[test]
fn a_cone_of_sides_is_round() {
    for n in [12, 24, 48] {
        let cone = surface(&cone(n, 5.6, 1));
        let slope = Point::new(2.0, 0.0, -5.6).normalize();
        let half = PI / f64::from(n as u32);
        let (flat, tilt) = (5.6 * (1.0 - half.cos()) * slope.x, half * slope.x);
        for k in 0..400 {
            let turn = Rotation3::from_axis_angle(&Point::z_axis(), 0.618 * f64::from(k));
            let part = 0.02 + 0.96 * f64::from(k) / 400.0;
            let x = turn * (Point::new(5.6, 0.0, 2.0) * part + slope * 0.1);
            let off = (cone.distance(&x) - 0.1).abs();
            let turned = (cone.normal(&x) - turn * slope).norm();
            assert!(
                off < 0.1 * flat * part && turned < 0.11 * tilt,
                "{n} {part} {off} {turned}"
            );
        }
    }
}

/// However steep it is and whatever it is cut into: its sides are straight up to the tip, which has the cone of all normals
/// there.
#[test]
fn a_cone_ends_in_its_tip() {
    for (n, radius, rings) in [
        (96, 2.0, 1),
        (96, 2.0, 12),
        (24, 5.6, 1),
        (24, 5.6, 3),
        (12, 5.6, 1),
    ] {
        let cone = surface(&cone(n, radius, rings));
        let slope = Point::new(2.0, 0.0, -radius).normalize();
        // A polygon of n sides is off by this part of the radius, and by a part of that beside it.
        let flat = 1.0 - (PI / n as f64).cos();
        for part in [0.05, 0.3, 0.6] {
            let foot = Point::new(radius * part, 0.0, 2.0 * part);
            let x = foot + slope * 0.3;
            let off = (cone.distance(&x) - 0.3).abs();
            assert!(
                off < 1.1 * flat * radius * part + 1e-12,
                "{n} {radius} {rings} {part}: {off:e}"
            );
        }
        let tip = cone
            .corner(&Point::new(0.0, 0.0, -0.1), 1e-6)
            .expect("a tip");
        assert!(tip.position.norm() < 1e-12);
        assert!((tip.axis + Point::z()).norm() < 1e-9, "{:?}", tip.axis);
        let leans = (radius * (PI / n as f64).cos()).atan2(2.0);
        let faces = FRAC_PI_2 - leans;
        assert!(
            (tip.half_angle - faces).abs() < 1e-9,
            "{} {faces}",
            tip.half_angle
        );
        assert!((cone.distance(&Point::new(0.0, 0.0, -0.1)) - 0.1).abs() < 1e-12);
    }
}

/// However near: the distance is that to the tip, and normals and curvatures are numbers, on the surface and off it.
#[test]
fn a_cone_is_met_at_any_distance_of_its_tip() {
    let (n, radius) = (24, 5.6);
    let cone = surface(&cone(n, radius, 1));
    let slope = Point::new(2.0, 0.0, -radius).normalize();
    for far in [1e-12, 1e-40, 1e-109, 1e-160, 1e-300, 1e-310, 5e-324] {
        for k in 0..12 {
            let turn = Rotation3::from_axis_angle(&Point::z_axis(), 0.618 * f64::from(k));
            for off in [0.0, far, 1e-3] {
                let x = turn * (Point::new(radius, 0.0, 2.0) * far + slope * off);
                let (distance, normal, bend) =
                    (cone.distance(&x), cone.normal(&x), cone.curvature(&x));
                assert!(
                    (distance - off).abs() < 1e-12,
                    "{far:e} {off:e}: {distance:e}"
                );
                assert!(
                    (normal.norm() - 1.0).abs() < 1e-12,
                    "{far:e} {off:e}: {normal}"
                );
                assert!(
                    bend.iter().all(|b| b.is_finite()),
                    "{far:e} {off:e}: {bend}"
                );
            }
        }
    }
}

/// Straight ahead of an edge or a corner of a cube, at it, behind it, and beside it; in the middle there are none, and of a
/// hollow none at all.
#[test]
fn edges_and_corners_of_a_cube_have_their_cones() {
    let cube = surface(&cube());
    for out in [0.0, 0.2, -0.2, -1e-5] {
        let edge = cube.corner(&Point::new(1.0 + out, 0.3, 1.0 + out), 1e-6);
        let edge = edge.expect("an edge");
        assert!((edge.axis - Point::new(1.0, 0.0, 1.0).normalize()).norm() < 1e-12);
        assert!((edge.position - Point::new(1.0, 0.3, 1.0)).norm() < 1e-12);
        assert!((edge.half_angle - PI / 4.0).abs() < 1e-12);
        assert!(edge.edge.is_some_and(|along| along.y.abs() > 1.0 - 1e-12));
        let corner = cube.corner(&Point::repeat(1.0 + out), 1e-6);
        let corner = corner.expect("a corner");
        assert!((corner.axis - Point::repeat(1.0).normalize()).norm() < 1e-12);
        assert!((corner.position - Point::repeat(1.0)).norm() < 1e-12);
        assert!((corner.half_angle.cos() - 3f64.sqrt().recip()).abs() < 1e-12);
        assert!(corner.edge.is_none());
    }
    let beside = [[1.0, 0.3, 1.0 - 1e-5], [1.0, 0.3, 1.2], [0.4, 0.4, 1.0]];
    let within = [[0.8, 0.3, 0.8 - 1e-5], [0.5, 0.3, 0.5], [0.5; 3]];
    for beside in [beside, within].concat() {
        assert_eq!(cube.corner(&beside.into(), 1e-6), None);
    }
    for out in [0.0, -0.2] {
        let rounded = Point::new(1.0 + out + 3e-7, 0.3, 1.0 + out - 2e-7);
        let at = cube.corner(&rounded, 1e-6).expect("an edge");
        assert!((at.position - Point::new(1.0, 0.3, 1.0)).norm() < 1e-12);
    }
    let hollow = cube.hollow();
    assert_eq!(hollow.corner(&Point::new(1.0, 0.3, 1.0), 1e-6), None);
}

/// Rings of four corners each, the first and the last of which are closed.
fn nested(rings: &[(f64, f64)]) -> Skin {
    let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let ring = |&(half, z): &(f64, f64)| signs.map(|[x, y]| [x * half, y * half, z]);
    let points: Vec<[f64; 3]> = rings.iter().flat_map(ring).collect();
    let last = points.len() - 4;
    let mut faces = vec![
        [0, 1, 2],
        [0, 2, 3],
        [last, last + 2, last + 1],
        [last, last + 3, last + 2],
    ];
    for k in (0..last).step_by(4) {
        for i in 0..4 {
            let [a, b] = [k + i, k + (i + 1) % 4];
            faces.extend([[a, a + 4, b + 4], [a, b + 4, b]]);
        }
    }
    (points, faces)
}

/// A square pocket of half sides 3, 4 deep, in a block; its rim is rounded by 1, so that its walls are one smooth surface
/// around the ends of the edges between them.
fn pocket() -> Skin {
    let round = (0..=4).map(|k| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(k) / 4.0).sin_cos();
        (4.0 - cos, sin - 1.0)
    });
    let rings: Vec<_> = [(3.0, -4.0)]
        .into_iter()
        .chain(round)
        .chain([(8.0, 0.0), (8.0, -8.0)])
        .collect();
    nested(&rings)
}

fn distances(parts: &[Box<dyn Obstacle<3>>], x: &Point) -> Vec<f64> {
    let mut all: Vec<f64> = parts.iter().map(|part| part.distance(x)).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// In a room all pairs of walls are parts, within it and behind its walls.
#[test]
fn a_corner_of_a_room_is_three_planes() {
    let room = surface(&cube()).hollow();
    let parts = room.parts();
    assert_eq!(parts.len(), 3);
    for x in directions(200) {
        let x = Point::repeat(0.5) + x * 0.7;
        let mut planes: Vec<f64> = x.iter().map(|x| x.min(1.0 - x)).collect();
        planes.sort_by(f64::total_cmp);
        for (part, plane) in distances(&parts, &x).iter().zip(planes) {
            assert!((part - plane).abs() < 1e-12, "{x} {part} {plane}");
        }
    }
    assert!(surface(&cube()).parts().is_empty());
    assert!(surface(&ball(2)).hollow().parts().is_empty());
    // Ways go on with the planes.
    let [from, to] = [Point::new(1.05, 1.02, 0.3), Point::new(1.08, 1.06, 0.4)];
    for part in &parts {
        let (n, chord) = (part.normal(&to), to - from);
        assert!((part.way(&from, &to) - (chord - n * n.dot(&chord))).norm() < 1e-12);
    }
    // In the corner itself, and in an edge.
    let [corner, edge] = [Point::zeros(), Point::new(0.0, 0.4, 1.0)].map(|x| distances(&parts, &x));
    assert_eq!(corner, [0.0; 3]);
    assert_eq!((edge[0], edge[1], edge[2] > 0.1), (0.0, 0.0, true));
}

/// In front of a pocket one part is as near as its surface, and none nearer; in its corners there are three, between its
/// walls two.
#[test]
fn a_pocket_with_a_rounded_rim_has_parts() {
    let pocket = surface(&pocket());
    let parts = pocket.parts();
    assert_eq!(parts.len(), 3);
    let near = |x: [f64; 3], expected: &[f64]| {
        let found = distances(&parts, &x.into());
        let (near, far) = found.split_at(expected.len());
        let same = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        assert!(near.iter().zip(expected).all(same), "{x:?} {found:?}");
        assert!(far.iter().all(|&d| d > 0.5), "{x:?} {found:?}");
    };
    for (sx, sy) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        near([2.9 * sx, 2.8 * sy, -3.7], &[0.1, 0.2, 0.3]);
        near([3.1 * sx, 3.2 * sy, -4.3], &[-0.3, -0.2, -0.1]);
        near([3.1 * sx, 2.8 * sy, -3.9], &[-0.1, 0.1, 0.2]);
        near([3.1 * sx, 3.05 * sy, -2.0], &[-0.1, -0.05]);
        near([3.0 * sx, 2.8 * sy, -2.0], &[0.0, 0.2]);
        near([3.0 * sx, 3.0 * sy, -4.0], &[0.0; 3]);
        near([3.2 * sx, 0.3 * sy, -4.1], &[-0.2, -0.1]);
        // On the rim and beside the block, also where the edges between walls have ended.
        near([6.0 * sx, 6.0 * sy, 0.2], &[0.2]);
        near([6.0 * sx, 6.0 * sy, -0.2], &[-0.2]);
        near([4.1 * sx, 4.1 * sy, 0.0], &[0.0]);
        near([8.1 * sx, 0.4 * sy, -3.0], &[0.1]);
        near([1.0 * sx, 0.4 * sy, -8.1], &[0.1]);
    }
}

/// Where parts meet along an edge that is not concave, the nearest does not hang on rounding.
#[test]
fn the_first_of_parts_is_at_their_seam() {
    let parts = surface(&pocket()).parts();
    for (k, sx) in [1.0, -1.0].into_iter().enumerate() {
        let at = |by: f64| {
            let x = Point::new(sx * (6.0 + by), 6.0 - by, 0.0);
            parts.iter().position(|part| part.distance(&x) < 0.1)
        };
        let places = [-1e-12, 0.0, 1e-12, 3e-12].map(at);
        assert!(
            places
                .iter()
                .all(|&part| part == places[0] && part.is_some()),
            "{k} {places:?}"
        );
    }
}

/// In a round groove around a pocket with a round wall, what is before the wall is before the floor of the pocket, too,
/// though its plane goes on there into the rest of the block.
#[test]
fn what_is_before_a_surface_is_behind_none_of_its_parts() {
    let half = |middle: f64, z: f64, up: f64| {
        (0..=4).map(move |k| {
            let (sin, cos) = (PI * f64::from(k) / 4.0).sin_cos();
            (middle - cos, z + up * sin)
        })
    };
    let (wall, groove) = (half(4.0, -1.0, 1.0), half(6.0, -6.0, -1.0));
    let rest = [(7.0, 0.0), (12.0, 0.0), (12.0, -14.0)];
    let rings = [(3.0, -2.0)].into_iter().chain(wall).chain(groove);
    let block = surface(&nested(&rings.chain(rest).collect::<Vec<_>>()));
    let found = distances(&block.parts(), &Point::new(5.5, 0.4, -3.5));
    assert!((found[0] - 0.5).abs() < 1e-9 && found[1] > 0.5, "{found:?}");
}

proptest! {
    #[test]
    fn parts_are_as_near_as_their_surface(at in prop::array::uniform3(-1.0..1.0f64)) {
        let pocket = surface(&pocket());
        let parts = pocket.parts();
        let x = Point::new(9.0 * at[0], 9.0 * at[1], 5.0 * at[2] - 4.0);
        let (whole, found) = (pocket.distance(&x), distances(&parts, &x));
        // Behind an edge that they go on from, planes are nearer than the edge.
        let is_near = if whole > 0.0 { (found[0] - whole).abs() < 1e-9 } else { found[0] > whole - 1e-9 };
        prop_assert!(is_near && found[0] * whole >= 0.0, "{x} {whole} {found:?}");
        for part in parts.iter().filter(|part| part.distance(&x).abs() < 0.8) {
            let (n, h) = (part.normal(&x), 1e-6);
            prop_assert!((n.norm() - 1.0).abs() < 1e-12);
            let [ahead, back] = [h, -h].map(|step| part.distance(&(x + n * step)) - part.distance(&x));
            // Beside where another side counts it jumps.
            let jumps = ahead.abs().max(back.abs()) > 1e-2;
            prop_assert!(jumps || ((ahead - back) / (2.0 * h) - 1.0).abs() < 1e-3, "{x}");
        }
    }
}
