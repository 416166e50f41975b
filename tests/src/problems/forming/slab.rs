//! Rolling by the theory of slabs: von Kármán's equation, and Orowan's, which counts shear in the slab.
//!
//! Sources: T. von Kármán, *Z. angew. Math. Mech.* 5 (1925) 139-141; E. Orowan, *Proc. Inst. Mech. Eng.* 150 (1943)
//! 140-167.

use super::Pass;

/// What the theory has for a roll, of the half above the middle of the strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rolled {
    /// Force on the roll across the strip \[N/mm\].
    pub force: f64,
    /// Moment about its axis \[N·mm/mm\].
    pub moment: f64,
    /// Where the strip is as fast as the roll, from the plane of exit \[rad\].
    pub neutral: f64,
}

/// How the pressure varies over a slab.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slab {
    /// Not at all.
    VonKarman,
    /// As in Nadai's converging channel.
    Orowan,
}

/// Slabs from exit to entry.
const SLABS: usize = 4000;

impl Slab {
    /// The part w of the yield stress in plane strain by which the pressure on the roll is more than the mean
    /// horizontal one, at an angle and for a, shear over its largest value.
    fn part(self, angle: f64, a: f64) -> f64 {
        const PIECES: usize = 32;
        if self == Self::VonKarman {
            return 1.0;
        }
        let at = |k: usize| {
            let s = (k as f64 + 0.5) / PIECES as f64;
            (1.0 - (a * s).powi(2)).sqrt() * (angle * s).cos()
        };
        let mean = (0..PIECES).map(at).sum::<f64>() / PIECES as f64;
        if angle > 0.0 {
            mean * angle / angle.sin()
        } else {
            mean
        }
    }

    /// Force, moment and neutral angle.
    pub fn rolled(self, pass: &Pass) -> Rolled {
        let [before, after] = pass.thickness;
        let entry = (1.0 - 0.5 * (before - after) / pass.radius).acos();
        let step = entry / SLABS as f64;
        // Rolled in from the exit the surface of the strip is faster than the roll, from the entry it is slower.
        let [exit, bite] = [1.0, -1.0].map(|sense| {
            let (mut angle, mut force) = (if sense > 0.0 { 0.0 } else { entry }, 0.0);
            let mut all = Vec::with_capacity(SLABS + 1);
            for _ in 0..=SLABS {
                all.push(self.pressure(pass, angle, force));
                // The horizontal force of the slab, by the midpoint rule.
                let slope = |angle: f64, force: f64| {
                    let [s, shear] = self.pressure(pass, angle, force);
                    2.0 * pass.radius * (s * angle.sin() + sense * shear * angle.cos())
                };
                let half = force + 0.5 * sense * step * slope(angle, force);
                force += sense * step * slope(angle + 0.5 * sense * step, half);
                angle += sense * step;
            }
            all
        });
        let mut rolled = Rolled {
            force: 0.0,
            moment: 0.0,
            neutral: entry,
        };
        for (k, (exit, bite)) in exit.iter().zip(bite.iter().rev()).enumerate() {
            let angle = k as f64 * step;
            let (sense, [s, shear]) = match exit[0] < bite[0] {
                true => (-1.0, *exit),
                false => (1.0, *bite),
            };
            if sense > 0.0 {
                rolled.neutral = rolled.neutral.min(angle);
            }
            let length = pass.radius * step;
            rolled.force += length * (s * angle.cos() + sense * shear * angle.sin());
            rolled.moment += pass.radius * length * sense * shear;
        }
        rolled
    }

    /// Pressure on the roll and shear \[MPa\] at an angle, under a horizontal force of the slab \[N/mm\].
    fn pressure(self, pass: &Pass, angle: f64, force: f64) -> [f64; 2] {
        let plane = 2.0 / 3f64.sqrt();
        let h = pass.thickness[1] + 2.0 * pass.radius * (1.0 - angle.cos());
        let strain = plane * (pass.thickness[0] / h).ln();
        let k = plane * (pass.yield_stress + pass.hardening * strain);
        let mut s = force / h + k;
        for _ in 0..30 {
            let a = (2.0 * pass.friction * s / k).clamp(0.0, 1.0);
            s = force / h + k * self.part(angle, a);
        }
        [s, (pass.friction * s).min(0.5 * k)]
    }
}
