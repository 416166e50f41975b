//! `contact.csv`: a row for each contact point and converged increment; no sums.

use super::status_name;
use super::table::field;
use super::touch::{Touch, touches};
use crate::deck::Units;
use crate::driver::{ContactRecord, Driver, IncrementReport};
use crate::mesh::NodeKind;
use crate::numbers::number;

/// The header.
pub(super) fn header(units: Units) -> String {
    let (l, f, s) = (units.length(), units.force(), units.stress());
    format!(
        "step,increment,contact,node,x [{l}],y [{l}],z [{l}],kind,gap [{l}],slip_1 [{l}],\
         slip_2 [{l}],t_n [{f}],t_1 [{f}],t_2 [{f}],p_n [{s}],p_1 [{s}],p_2 [{s}],status,x_now [{l}],y_now [{l}],\
         z_now [{l}]"
    )
}

/// The rows of an increment. Slips are those of the increment; nodes are counted from 0.
pub(super) fn rows<const D: usize>(
    driver: &Driver<D>,
    report: &IncrementReport,
    stage: usize,
) -> Vec<String> {
    let row = |(c, touch): (&ContactRecord<D>, Touch<D>)| {
        let at = |k: usize, v: &[f64]| number(v.get(k).copied().unwrap_or(0.0));
        let kind = match c.kind {
            NodeKind::Corner => "corner",
            NodeKind::Midside => "midside",
            NodeKind::Face => "face",
        };
        let mut fields = vec![
            stage.to_string(),
            report.increment.to_string(),
            field(driver.contact_name(c.contact).0).into_owned(),
            c.node.to_string(),
        ];
        fields.extend((0..3).map(|k| at(k, &c.position)));
        fields.push(kind.to_owned());
        for v in [&touch.u, &c.t, &touch.traction] {
            fields.extend((0..3).map(|k| at(k, v.as_slice())));
        }
        fields.push(status_name(touch.status).to_owned());
        let u = driver.displacement(c.node);
        let now: Vec<f64> = c.position.iter().zip(&u).map(|(x, u)| x + u).collect();
        fields.extend((0..3).map(|k| at(k, &now)));
        fields.join(",")
    };
    let records = driver.contacts().iter();
    records.zip(touches(driver)).map(row).collect()
}
