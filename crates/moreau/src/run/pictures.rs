//! The pictures of a run: forces over time, tractions along the contact, the deformed body; made
//! at its end.

use super::history::History;
use super::view::{NodalField, View};
use crate::deck::Deck;
use crate::driver::Driver;
use crate::plot::{Chart, Style};

/// File names and SVG documents; what cannot be drawn is left out.
pub(super) fn pictures<const D: usize>(
    driver: &Driver<D>,
    history: &History,
    deck: &Deck,
) -> Vec<(&'static str, String)>
where
    Driver<D>: View,
{
    let mut pictures = Vec::new();
    pictures.extend(forces(history, deck).map(|svg| ("history.svg", svg)));
    if D == 2 {
        pictures.extend(tractions(driver, deck).map(|svg| ("contact.svg", svg)));
    }
    let plastic = deck.materials.iter().any(|m| m.yield_stress.is_some());
    let (field, label) = match plastic {
        true => (
            NodalField::PlasticStrain,
            "equivalent plastic strain [–]".to_owned(),
        ),
        false => {
            let label = format!("von Mises stress [{}]", deck.units.stress());
            (NodalField::VonMises, label)
        }
    };
    let picture = driver.picture(&deck.title, &label, field);
    pictures.extend(
        picture
            .and_then(Result::ok)
            .map(|svg| ("deformed.svg", svg)),
    );
    pictures
}

/// All forces that are not zero throughout, over time.
fn forces(history: &History, deck: &Deck) -> Option<String> {
    let time = history.column("time")?;
    let label = format!("force [{}]", deck.units.force());
    let mut chart = Chart::new(&deck.title, "steps [–]", label);
    let names: Vec<&str> = history
        .names()
        .filter(|n| n.starts_with("force."))
        .collect();
    let columns: Vec<_> = names
        .iter()
        .filter_map(|n| Some((*n, history.column(n)?)))
        .collect();
    let largest = |c: &[f64]| c.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let scale = columns.iter().map(|(_, c)| largest(c)).fold(0.0, f64::max);
    for (name, column) in columns {
        if largest(&column) > 1e-9 * scale {
            let start = std::iter::once([0.0, 0.0]);
            let points = time.iter().zip(&column).map(|(&t, &f)| [t, f]);
            let points: Vec<_> = start.chain(points).collect();
            let short = name.trim_start_matches("force.");
            chart = chart.with(short, Style::LinePoints, points);
        }
    }
    chart.to_svg().ok()
}

/// Pressure and shear along the contact surfaces, by the coordinate along which they extend.
fn tractions<const D: usize>(driver: &Driver<D>, deck: &Deck) -> Option<String> {
    let records = driver.contacts();
    let extent = |k: usize| {
        let (low, high) = records
            .iter()
            .map(|c| c.position[k])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
        high - low
    };
    let axis = usize::from(extent(1) > extent(0));
    let label = format!("{} [{}]", ["x", "y"][axis], deck.units.length());
    let traction = format!("traction [{}]", deck.units.stress());
    let mut chart = Chart::new(&deck.title, label, traction);
    for k in 0..=records.iter().map(|c| c.contact).max()? {
        let mut line: Vec<_> = records.iter().filter(|c| c.contact == k).collect();
        line.sort_by(|a, b| a.position[axis].total_cmp(&b.position[axis]));
        let surface = driver.contact_name(k).0;
        for (component, name) in ["pressure", "shear"].into_iter().enumerate() {
            let points: Vec<[f64; 2]> = line
                .iter()
                .map(|c| [c.position[axis], c.t[component] / c.area])
                .collect();
            chart = chart.with(format!("{surface}, {name}"), Style::LinePoints, points);
        }
    }
    chart.to_svg().ok()
}
