//! Colours that say a value; not the colours that tell series apart.

pub(super) const INK: &str = "#222222";

/// Perceptually uniform colours from dark blue to yellow, at equal distances: viridis.
const ANCHORS: [[u8; 3]; 16] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x1a, 0x6c],
    [0x47, 0x2f, 0x7d],
    [0x41, 0x44, 0x87],
    [0x39, 0x56, 0x8c],
    [0x31, 0x68, 0x8e],
    [0x2a, 0x78, 0x8e],
    [0x23, 0x88, 0x8e],
    [0x1f, 0x98, 0x8b],
    [0x22, 0xa8, 0x84],
    [0x35, 0xb7, 0x79],
    [0x54, 0xc5, 0x68],
    [0x7a, 0xd1, 0x51],
    [0xa5, 0xdb, 0x36],
    [0xd2, 0xe2, 0x1b],
    [0xfd, 0xe7, 0x25],
];

/// Colours that a picture uses: few enough to draw what has one colour in one go, and so many that
/// the eye sees no steps.
pub(super) const LEVELS: usize = 96;

/// Level of t in [0, 1].
pub(super) fn level(t: f64) -> usize {
    ((t * LEVELS as f64) as usize).min(LEVELS - 1)
}

/// Colour of a level, as "#rrggbb".
pub(super) fn colour(level: usize) -> String {
    let t = (level.min(LEVELS - 1) as f64 + 0.5) / LEVELS as f64 * (ANCHORS.len() - 1) as f64;
    let k = (t as usize).min(ANCHORS.len() - 2);
    let [r, g, b] = [0, 1, 2].map(|i| {
        let (a, b) = (f64::from(ANCHORS[k][i]), f64::from(ANCHORS[k + 1][i]));
        (a + (t - k as f64) * (b - a)).round() as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colours of a field, as "#rrggbb", from the least value to the largest.
pub fn colours() -> Vec<String> {
    (0..LEVELS).map(colour).collect()
}
