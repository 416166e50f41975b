//! Where shears of given limits act as an increment goes on; not how large they are.

use crate::driver::Driver;
use crate::linear::system::System;
use crate::model::grip::Grip;
use crate::model::load::Loading;
use moreau_laws::Local;

/// Gap that is none, over the size of the mesh.
const CLOSED: f64 = 1e-6;

impl<const D: usize> Driver<D> {
    /// At the start of an increment: of the first where the undeformed bodies touch.
    pub(crate) fn begin_grips(&mut self, system: &System, start: &Loading<D>) {
        self.begin_corners();
        let none = CLOSED * self.mesh.size();
        let before = self.state.contacts.iter();
        self.grips = match self.state.increment {
            0 => {
                let rest = vec![0.0; self.state.displacement.len()];
                let undeformed = self.kinematics(system, start, &rest);
                let closed = undeformed.iter().map(|k| k.gap <= none);
                closed.map(Grip::start).collect()
            }
            _ => {
                let closed = before.map(|c| c.t[0] > 0.0 || c.u[0] <= none);
                closed.map(Grip::start).collect()
            }
        };
    }

    /// Shears of given limits act where bodies have come to press, and what slides leaves its corner.
    pub(crate) fn grip(&mut self, force: &[Local<D>]) {
        for (grip, t) in self.grips.iter_mut().zip(force) {
            if t[0] > 0.0 {
                *grip = grip.pressed();
            }
        }
        self.leave_corners(force);
    }

    /// They act everywhere: what opens is found later. Whether that changes anything.
    pub(crate) fn grip_everywhere(&mut self) -> bool {
        let last = self.grips.clone();
        self.grips
            .iter_mut()
            .for_each(|grip| *grip = grip.pressed());
        self.has_other_shears(&last)
    }

    /// They cease where balance leaves bodies open. Whether that changes anything.
    pub(crate) fn release(&mut self, force: &[Local<D>]) -> bool {
        let last = self.grips.clone();
        for (grip, t) in self.grips.iter_mut().zip(force) {
            if t[0] <= 0.0 {
                *grip = grip.open();
            }
        }
        self.has_other_shears(&last)
    }

    fn has_other_shears(&self, last: &[Grip]) -> bool {
        let mut pairs = self.points.iter().zip(self.grips.iter().zip(last));
        pairs.any(|(p, (now, last))| now.area(&p.law, 1.0) != last.area(&p.law, 1.0))
    }
}
