//! `run.json`: its keys, with what each means and where its value is from; not how a run ends.

use super::diagnosis::{Diagnosis, Flip};
use super::outcome::{Outcome, Verdict};
use super::status_name;
use crate::deck::{Described, Unit};
use crate::driver::{Collapse, Imbalance};
use crate::memory;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A key of what is told of a `T`, and its value.
type Key<T> = (Described, fn(&T) -> Value);

const fn key<T>(
    name: &'static str,
    unit: Unit,
    meaning: &'static str,
    value: fn(&T) -> Value,
) -> Key<T> {
    (Described::new(name, unit, meaning), value)
}

const RUN: &[Key<Outcome>] = &[
    key("version", Unit::None, "Version of the program.", |_| {
        json!(env!("CARGO_PKG_VERSION"))
    }),
    key(
        "finished",
        Unit::Second,
        "When the run ended, since 1970-01-01 UTC; `null` in memory.",
        |o| json!(o.finished),
    ),
    key("title", Unit::None, "Title of the deck.", |o| {
        json!(o.title)
    }),
    key("units", Unit::None, "Units of the deck.", |o| {
        json!(o.units.name())
    }),
    key(
        "status",
        Unit::None,
        "How the run ended: `done`, `refused`, `not converged`, `collapsed`, `interrupted`; `running` until then, and `not written` where results could not be.",
        |o| json!(o.status.name()),
    ),
    key(
        "error",
        Unit::None,
        "Why the run did not come to its end; `null` where it did or was interrupted.",
        |o| json!(o.error()),
    ),
    key(
        "seconds",
        Unit::Second,
        "Time that the run took, results written included; in memory that of the increments.",
        |o| json!(o.seconds),
    ),
    key("increments", Unit::Count, "Converged increments.", |o| {
        json!(o.increments)
    }),
    key(
        "newton_iterations",
        Unit::Count,
        "Newton iterations of the converged increments.",
        |o| json!(o.newton_iterations),
    ),
    key(
        "contact_iterations",
        Unit::Count,
        "Iterations of the contact solver in the converged increments.",
        |o| json!(o.contact_iterations),
    ),
    key(
        "factorisations",
        Unit::Count,
        "Sparse factorisations of the converged increments.",
        |o| json!(o.factorisations),
    ),
    key(
        "linear_iterations",
        Unit::Count,
        "Iterations of conjugate gradients in the converged increments.",
        |o| json!(o.linear_iterations),
    ),
    key(
        "contact_solves",
        Unit::Count,
        "Solves with a factor for tied contacts in the converged increments.",
        |o| json!(o.contact_solves),
    ),
    key(
        "cuts",
        Unit::Count,
        "Times that increments were halved before they converged.",
        |o| json!(o.cuts),
    ),
    key(
        "peak_memory_mb",
        Unit::Mebibyte,
        "Largest memory of the process; `null` where the system does not tell.",
        |_| json!(memory::peak().map(|bytes| bytes as f64 / f64::from(1 << 20))),
    ),
    key(
        "dofs",
        Unit::Count,
        "Degrees of freedom, prescribed ones included.",
        |o| json!(o.dofs),
    ),
    key("threads", Unit::Count, "Threads that work on cells.", |o| {
        json!(o.threads)
    }),
    key(
        "tolerance",
        Unit::None,
        "Out-of-balance force at which increments were accepted, over the largest nodal force.",
        |o| json!(o.tolerance),
    ),
    key(
        "certificate",
        Unit::None,
        "How far the contact law is from being met, the worst of all increments; an object.",
        |o| object(CERTIFICATE, o),
    ),
    key(
        "values",
        Unit::None,
        "Final forces, moments and displacements, by their columns of `history.csv` and in the units of these.",
        |o| json!(o.values.iter().cloned().collect::<BTreeMap<_, _>>()),
    ),
    key(
        "expectations",
        Unit::None,
        "What came of the expectations of the deck; a list of objects.",
        |o| list(EXPECTATION, &o.verdicts),
    ),
    key(
        "collapse",
        Unit::None,
        "Collapse, the last if more than one step ended in it; an object, `null` without collapse.",
        |o| {
            json!(
                o.collapse
                    .as_ref()
                    .map(|collapse| object(COLLAPSE, collapse))
            )
        },
    ),
    key(
        "warnings",
        Unit::None,
        "Doubts about the deck and the run, a sentence each.",
        |o| json!(o.warnings),
    ),
    key(
        "diagnosis",
        Unit::None,
        "Why an increment did not converge; an object, `null` where all did.",
        |o| {
            json!(
                o.diagnosis
                    .as_ref()
                    .map(|diagnosis| object(DIAGNOSIS, diagnosis))
            )
        },
    ),
];

const CERTIFICATE: &[Key<Outcome>] = &[
    key(
        "bipotential_gap",
        Unit::Energy,
        "Sum over the contacts of the bipotential and the work of the forces, zero exactly where the contact law holds.",
        |o| json!(o.certificate.bipotential_gap),
    ),
    key(
        "relative_gap",
        Unit::None,
        "The largest gap in parts of the work done, or of the energy stored and dissipated where that is less.",
        |o| json!(o.relative_gap),
    ),
    key(
        "penetration",
        Unit::Length,
        "Largest penetration of a contact point.",
        |o| json!(o.certificate.penetration),
    ),
    key(
        "excess_force",
        Unit::Force,
        "Largest distance of a contact force to the friction cone.",
        |o| json!(o.certificate.excess_force),
    ),
    key(
        "friction_over_critical",
        Unit::None,
        "Largest coefficient of friction over its critical value: from 1 on other solutions are possible; `null` where it is not known.",
        |o| json!(o.criticality),
    ),
];

const EXPECTATION: &[Key<Verdict>] = &[
    key("column", Unit::None, "The column of `history.csv`.", |v| {
        json!(v.column)
    }),
    key(
        "expected",
        Unit::None,
        "The value expected, in the unit of the column.",
        |v| json!(v.expected),
    ),
    key(
        "tolerance",
        Unit::None,
        "Largest difference accepted.",
        |v| json!(v.tolerance),
    ),
    key(
        "found",
        Unit::None,
        "The value found; `null` without a converged increment.",
        |v| json!(v.found),
    ),
    key(
        "passed",
        Unit::None,
        "Whether the expectation is met.",
        |v| json!(v.passed()),
    ),
];

const COLLAPSE: &[Key<(String, Collapse)>] = &[
    key("step", Unit::None, "Name of the step.", |(step, _)| {
        json!(step)
    }),
    key(
        "load_factor",
        Unit::None,
        "The largest load in equilibrium, in parts of the way from the forces at the start of the step to its loads.",
        |(_, c)| json!(c.load_factor),
    ),
    key(
        "added",
        Unit::None,
        "Whether there are forces at the start of the step, of the step before or that hold initial stresses: the load factor is then no part of the loads.",
        |(_, c)| json!(c.added),
    ),
    key(
        "growth",
        Unit::None,
        "Growth of the load factor, in parts of it, while the work of the loads doubled: what is left to be gained.",
        |(_, c)| json!(c.growth),
    ),
    key(
        "upper_bound",
        Unit::None,
        "Load factor of the kinematic bound from the mechanism; `null` where a law admits none.",
        |(_, c)| json!(c.upper_bound.map(|b| b.load_factor)),
    ),
    key(
        "elastic_share",
        Unit::None,
        "Share of changes of volume and elastic parts in the bound, which is strict as far as this is zero.",
        |(_, c)| json!(c.upper_bound.map(|b| b.elastic_share)),
    ),
    key(
        "strict",
        Unit::None,
        "Whether the bound is one: nothing in the mechanism hardens, and no friction in it depends on normal forces; with Coulomb's the bound holds for those at collapse.",
        |(_, c)| json!(c.is_strict()),
    ),
];

const DIAGNOSIS: &[Key<Diagnosis>] = &[
    key(
        "worst",
        Unit::None,
        "The nodes with the largest forces that nothing balances, worst first; a list of objects.",
        |d| list(WORST, &d.worst),
    ),
    key(
        "flips",
        Unit::None,
        "Contact points whose status changed in the last iterations; a list of objects.",
        |d| list(FLIP, &d.flips),
    ),
    key(
        "plastic_fraction",
        Unit::None,
        "Part of the volume that flows plastically.",
        |d| json!(d.plastic_fraction),
    ),
    key(
        "load_factor",
        Unit::None,
        "Estimate of the load at collapse, in parts of the loads of the step; `null` where the last increments do not tell.",
        |d| json!(d.limit),
    ),
    key("suggestion", Unit::None, "What to change first.", |d| {
        json!(d.suggestion)
    }),
];

const WORST: &[Key<Imbalance>] = &[
    key("node", Unit::Count, "Number of the node, from 0.", |w| {
        json!(w.node)
    }),
    key(
        "position",
        Unit::Length,
        "Its place in the undeformed body; a list.",
        |w| json!(w.position),
    ),
    key(
        "force",
        Unit::Force,
        "Size of the force that nothing balances.",
        |w| json!(w.force),
    ),
];

const FLIP: &[Key<Flip>] = &[
    key("node", Unit::Count, "Number of the node, from 0.", |f| {
        json!(f.node)
    }),
    key(
        "position",
        Unit::Length,
        "Its place in the undeformed body; a list.",
        |f| json!(f.position),
    ),
    key(
        "statuses",
        Unit::None,
        "Its statuses in the last iterations, oldest first.",
        |f| {
            json!(
                f.statuses
                    .iter()
                    .map(|s| status_name(*s))
                    .collect::<Vec<_>>()
            )
        },
    ),
];

fn object<T>(keys: &[Key<T>], of: &T) -> Value {
    let values = keys
        .iter()
        .map(|(key, value)| (key.name.to_owned(), value(of)));
    Value::Object(values.collect())
}

fn list<T>(keys: &[Key<T>], all: &[T]) -> Value {
    all.iter().map(|of| object(keys, of)).collect()
}

/// All keys, those within others after all that are not and with the way to them before the name.
pub(super) fn keys() -> Vec<(&'static str, &'static Described)> {
    fn within<T>(
        way: &'static str,
        keys: &'static [Key<T>],
    ) -> impl Iterator<Item = (&'static str, &'static Described)> {
        keys.iter().map(move |(key, _)| (way, key))
    }
    within("", RUN)
        .chain(within("certificate.", CERTIFICATE))
        .chain(within("expectations[].", EXPECTATION))
        .chain(within("collapse.", COLLAPSE))
        .chain(within("diagnosis.", DIAGNOSIS))
        .chain(within("diagnosis.worst[].", WORST))
        .chain(within("diagnosis.flips[].", FLIP))
        .collect()
}

impl Outcome {
    /// The content of `run.json`.
    pub fn json(&self) -> String {
        format!("{:#}\n", object(RUN, self))
    }
}
