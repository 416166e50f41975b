//! The kinematic bound of a mechanism: the dissipation of its velocity field over the power of the
//! loads.

use crate::driver::Driver;
use crate::report::ContactRecord;
use crate::report::collapse::{Collapse, UpperBound};
use crate::vector::SparseVector;
use moreau_laws::{FlowPower, Status};

impl<const D: usize> Driver<D> {
    /// The kinematic bound from the last increment, for the loads λ q with this λ at its end.
    pub(crate) fn upper_bound(&self, load: &SparseVector, factor: f64) -> Option<UpperBound> {
        let (v, _) = self.state.last.as_ref()?;
        let proportional = load.dot(v);
        let dead = |all, own| all - factor * own;
        let dead = self.state.loading.force.with(load, dead).dot(v);
        let mut flow = FlowPower::default();
        for block in &self.blocks {
            flow = flow.with(1.0, block.flow_power(v)?);
        }
        let contacts = &self.state.contacts;
        let slip = |c: &ContactRecord<D>| (1..D).map(|j| -c.t[j] * c.u[j]).sum::<f64>();
        let friction: f64 = contacts.iter().map(slip).sum();
        let mut pairs = self.points.iter().zip(contacts);
        let coulomb = pairs.any(|(p, c)| c.status == Status::Slip && p.law.coefficient() > 0.0);
        (proportional > 0.0).then(|| UpperBound {
            load_factor: (flow.total + friction - dead) / proportional,
            elastic_share: flow.elastic / proportional,
            coulomb,
            hardens: flow.hardening.abs() > Collapse::FLAT * flow.total,
        })
    }
}
