//! The pictures of a simulation, from its tables and grids: forces or displacements over time, tractions along the
//! contact, the deformed body with a field.

#[cfg(feature = "command")]
mod conditions;
mod tools;

use crate::deck::{Deck, Units};
use crate::laws::Status;
use crate::mesh::{Facet, Mesh};
use crate::plot::{Chart, Mark, MeshPicture, Style, below_each_other};
use crate::simulation::status_name;
use crate::table::Table;
use crate::vtu::Array;
use std::collections::{BTreeMap, BTreeSet};
use tools::outlines;

/// What happens over time: the forces; where there are none, as under loads alone that nothing but
/// symmetry holds, the mean displacements. Nothing if there is nothing to draw.
pub(crate) fn over_time(history: &Table, deck: &Deck) -> Option<Chart> {
    let force = format!("force [{}]", deck.units.force());
    let displacement = format!("mean displacement [{}]", deck.units.length());
    // Sums of forces are known no better than each is balanced.
    let noise = largest(&history.numbers("out_of_balance"));
    columns(history, deck, ("force.", force, noise))
        .or_else(|| columns(history, deck, ("u.", displacement, 0.0)))
}

fn largest(column: &[f64]) -> f64 {
    column.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// All columns of a kind, by the beginning of their names, that are above a noise and not zero beside
/// the others.
fn columns(
    history: &Table,
    deck: &Deck,
    (kind, label, noise): (&str, String, f64),
) -> Option<Chart> {
    let time = history.numbers("time");
    let mut chart = Chart::new(&deck.title, "steps [–]", label);
    let names = history.columns().iter();
    let names = names
        .map(|c| c.name.as_str())
        .filter(|n| n.starts_with(kind));
    let columns: Vec<_> = names.map(|n| (n, history.numbers(n))).collect();
    let scale = columns.iter().map(|(_, c)| largest(c)).fold(0.0, f64::max);
    // Markers tell increments apart as long as they are not too many.
    let style = match time.len() <= 200 {
        true => Style::LinePoints,
        false => Style::Line,
    };
    for (name, column) in columns {
        if largest(&column) > noise.max(1e-9 * scale) {
            let start = std::iter::once([0.0, 0.0]);
            let points = time.iter().zip(&column).map(|(&t, &v)| [t, v]);
            let points: Vec<_> = start.chain(points).collect();
            chart = chart.with(name.trim_start_matches(kind), style, points);
        }
    }
    (!chart.series.is_empty()).then_some(chart)
}

/// A contact and the arc length of its surface along which it is drawn.
pub(crate) struct ContactLine {
    /// The surface, and what is opposite where it has several contacts.
    pub(crate) name: String,
    /// Arc length at its points, increasing.
    pub(crate) at: Vec<f64>,
    /// Pressure and shear there.
    pub(crate) tractions: [Vec<f64>; 2],
}

/// Names of the tractions of a [`ContactLine`].
pub(crate) const TRACTIONS: [&str; 2] = ["pressure", "shear"];

/// Tractions along the surfaces in one increment of a table, over the arc length.
pub(crate) fn contact_lines(contacts: &Table, increment: usize) -> Vec<ContactLine> {
    let wanted = increment as f64;
    let rows = contacts.numbers("increment");
    let [surfaces, opposites] = ["contact", "against"].map(|name| contacts.texts(name));
    let [place, node] = ["s", "node"].map(|name| contacts.numbers(name));
    let values = ["p_n", "p_1"].map(|name| contacts.numbers(name));
    let own: Vec<usize> = (0..rows.len()).filter(|&k| rows[k] == wanted).collect();
    let names: BTreeSet<(&str, &str)> = own.iter().map(|&k| (surfaces[k], opposites[k])).collect();
    let name = |k: usize| match names.iter().filter(|(s, _)| *s == surfaces[k]).count() {
        1 => surfaces[k].to_owned(),
        _ => format!("{} against {}", surfaces[k], opposites[k]),
    };
    let line = |own: &[usize]| {
        let line = foremost(own.iter().copied(), &node, &values[0]);
        let mut line: Vec<usize> = line.into_values().collect();
        line.sort_by(|&a, &b| place[a].total_cmp(&place[b]));
        ContactLine {
            name: name(own[0]),
            at: line.iter().map(|&k| place[k]).collect(),
            tractions: values
                .each_ref()
                .map(|v| line.iter().map(|&k| v[k]).collect()),
        }
    };
    own.chunk_by(|&a, &b| (surfaces[a], opposites[a]) == (surfaces[b], opposites[b]))
        .map(line)
        .collect()
}

/// Labels of the arc length and of the tractions.
pub(crate) fn contact_labels(units: Units) -> [String; 2] {
    [
        format!("along the surface [{}]", units.length()),
        format!("traction [{}]", units.stress()),
    ]
}

/// Pressure and shear along the contact surfaces in one increment.
pub(crate) fn tractions(contacts: &Table, increment: usize, deck: &Deck) -> Option<String> {
    let [label, traction] = contact_labels(deck.units);
    let mut chart = Chart::new(&deck.title, label, traction);
    for line in contact_lines(contacts, increment) {
        for (name, values) in TRACTIONS.iter().zip(&line.tractions) {
            let points: Vec<[f64; 2]> = line.at.iter().zip(values).map(|(&x, &v)| [x, v]).collect();
            let name = format!("{}, {name}", line.name);
            chart = chart.with(name, Style::LinePoints, points);
        }
    }
    chart.to_svg().ok()
}

/// Name of the field that is drawn if none is asked for.
pub(crate) fn usual_field(deck: &Deck) -> &'static str {
    match deck.materials.iter().any(|m| m.yields().is_some()) {
        true => "equivalent_plastic_strain",
        false => "von_mises",
    }
}

/// The unit of a field, if it is known.
pub(crate) fn unit(name: &str, units: Units) -> Option<&'static str> {
    let of_stress = |n: &str| n.contains("stress") || n == "von_mises" || n == "shear";
    match name {
        n if n.contains("strain") => Some("–"),
        n if of_stress(n) || n.starts_with("pressure") => Some(units.stress()),
        n if n.starts_with("displacement") => Some(units.length()),
        "gap" | "slip" => Some(units.length()),
        "temperature" => Some("K"),
        n if n.contains("force") || n == "out_of_balance" => Some(units.force()),
        _ => None,
    }
}

/// A field in words, with its unit.
pub(crate) fn label(name: &str, units: Units) -> String {
    let Some(unit) = unit(name, units) else {
        return name.replace('_', " ");
    };
    let name = match name {
        "von_mises" => "von Mises stress".into(),
        other => other.replace('_', " "),
    };
    format!("{name} [{unit}]")
}

/// Suffixes of the components of vectors, and of stresses in the order of VTK.
const VECTOR: [&str; 3] = ["x", "y", "z"];
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];

fn suffixes(array: &Array) -> &'static [&'static str] {
    match array.components {
        3 => &VECTOR,
        6 => &TENSOR,
        _ => &[],
    }
}

/// Names of all that [`field`] finds in some arrays.
pub(crate) fn fields(arrays: &[Array]) -> Vec<String> {
    let mut names = Vec::new();
    for array in arrays {
        if array.components <= 3 {
            names.push(array.name.clone());
        }
        names.extend(
            suffixes(array)
                .iter()
                .map(|s| format!("{}.{s}", array.name)),
        );
    }
    names
}

/// A field at every point, by name: a scalar; the length of a vector; or a component, as in
/// `displacement.x` or `stress.xy`. The first points are the nodes of the mesh.
pub(crate) fn field(arrays: &[Array], name: &str) -> Option<Vec<f64>> {
    let of = |name: &str| arrays.iter().find(|a| a.name == name);
    if let Some(array) = of(name).filter(|a| a.components <= 3) {
        let length = |v: &[f64]| match v {
            [x] => *x,
            v => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
        };
        return Some(array.values.chunks(array.components).map(length).collect());
    }
    let (name, component) = name.rsplit_once('.')?;
    let array = of(name)?;
    let k = suffixes(array).iter().position(|c| *c == component)?;
    let value = |v: &[f64]| v.get(k).copied().unwrap_or(0.0);
    Some(array.values.chunks(array.components).map(value).collect())
}

/// Displacement of every node.
fn displacement<const D: usize>(arrays: &[Array]) -> Option<Vec<[f64; D]>> {
    let array = arrays.iter().find(|a| a.name == "displacement")?;
    let own = |v: &[f64]| v.get(..D)?.try_into().ok();
    array.values.chunks(array.components).map(own).collect()
}

/// How many times displacements are drawn so that they are seen but not out of shape; never smaller than they are,
/// and large ones as they are.
pub(crate) fn usual_magnification(deck: &Deck, size: f64, largest: f64) -> f64 {
    match largest > 0.0 && largest.is_finite() && deck.finite.is_none() {
        true => round(0.05 * size / largest).max(1.0),
        false => 1.0,
    }
}

/// The deformed body with a field on it, and the tools where a row of the history has them; nothing if the arrays
/// do not have what it takes.
pub(crate) fn deformed<const D: usize>(
    mesh: &Mesh<D>,
    deck: &Deck,
    arrays: &[Array],
    name: &str,
    at: (&Table, usize),
    magnification: Option<f64>,
) -> Option<String> {
    let mut displacement = displacement::<D>(arrays)?;
    let mut values = field(arrays, name)?;
    displacement.truncate(mesh.nodes().len());
    values.truncate(mesh.nodes().len());
    let largest = displacement
        .iter()
        .map(|u| u.iter().fold(0.0f64, |m, v| m.hypot(*v)))
        .fold(0.0, f64::max);
    let magnification = magnification.unwrap_or(usual_magnification(deck, mesh.size(), largest));
    let picture = MeshPicture::new(mesh, &deck.title)
        .deformed(displacement, magnification)
        .field(label(name, deck.units), values)
        .unit(deck.units.length())
        .outline();
    with_tools(picture, deck, at, magnification).to_svg().ok()
}

/// A picture with the tools of a deck as well.
fn with_tools<'a, const D: usize>(
    picture: MeshPicture<'a, D>,
    deck: &Deck,
    at: (&Table, usize),
    magnification: f64,
) -> MeshPicture<'a, D> {
    let tools = outlines(deck, at, picture.mesh, magnification);
    match D {
        2 => tools.into_iter().fold(picture, MeshPicture::polyline),
        _ => tools.into_iter().fold(picture, MeshPicture::veil),
    }
}

/// The statuses of contact with their colours.
const STATUSES: [(Status, &str); 4] = [
    (Status::Open, "#9aa1ab"),
    (Status::Stick, "#1f5fbf"),
    (Status::Slip, "#e07b00"),
    (Status::Tied, "#3a7d44"),
];

/// Contact in one increment: along the surfaces of a plane body, on those of a solid.
pub(crate) fn contact<const D: usize>(
    mesh: &Mesh<D>,
    deck: &Deck,
    contacts: &Table,
    increment: usize,
    arrays: Option<&[Array]>,
) -> Option<String> {
    match D {
        2 => tractions(contacts, increment, deck),
        _ => surfaces(mesh, deck, contacts, increment, arrays),
    }
}

/// Of the rows of a table, that of each node; of those of a node with several contacts the one that presses most.
pub(crate) fn foremost(
    rows: impl Iterator<Item = usize>,
    node: &[f64],
    pressure: &[f64],
) -> BTreeMap<usize, usize> {
    let mut of_node = BTreeMap::new();
    for row in rows {
        let first = of_node.entry(node[row] as usize).or_insert(row);
        if pressure[row] > pressure[*first] {
            *first = row;
        }
    }
    of_node
}

/// The contact surfaces of a solid in one increment, each seen against its mean normal with its pressure and the
/// statuses of its points, below each other; where they are then if strains are large.
fn surfaces<const D: usize>(
    mesh: &Mesh<D>,
    deck: &Deck,
    contacts: &Table,
    increment: usize,
    arrays: Option<&[Array]>,
) -> Option<String> {
    let (names, status) = (contacts.texts("contact"), contacts.texts("status"));
    let [rows, node, pressure] = ["increment", "node", "p_n"].map(|name| contacts.numbers(name));
    let own: Vec<usize> = (0..rows.len())
        .filter(|&k| rows[k] == increment as f64)
        .collect();
    let moved = arrays
        .filter(|_| deck.finite.is_some())
        .and_then(displacement::<D>);
    let mut sheets = Vec::new();
    let mut drawn: Vec<&str> = Vec::new();
    for &k in &own {
        let name = names[k];
        if drawn.contains(&name) {
            continue;
        }
        drawn.push(name);
        let facets = mesh.facet_group(name).ok()?.to_vec();
        let points = own.iter().copied().filter(|&k| names[k] == name);
        let points: Vec<usize> = foremost(points, &node, &pressure).into_values().collect();
        let mut values = vec![f64::NAN; mesh.nodes().len()];
        for &k in &points {
            *values.get_mut(node[k] as usize)? = pressure[k];
        }
        between(mesh, &facets, &mut values);
        let title = match deck.title.as_str() {
            "" => name.to_owned(),
            title => format!("{title}: {name}"),
        };
        let mut picture = MeshPicture::new(mesh, title)
            .field(
                format!("contact pressure [{}]", deck.units.stress()),
                values,
            )
            .unit(deck.units.length());
        if let Some(u) = &moved {
            let u = u.iter().take(mesh.nodes().len()).copied().collect();
            picture = picture.deformed(u, 1.0);
        }
        picture = picture.surface(facets);
        let place = |n: usize| {
            let u = moved.as_ref().and_then(|u| u.get(n));
            std::array::from_fn(|i| mesh.nodes()[n][i] + u.map_or(0.0, |u| u[i]))
        };
        for (kind, colour) in STATUSES {
            let kind = status_name(kind);
            let alike: Vec<usize> = points
                .iter()
                .copied()
                .filter(|&k| status[k] == kind)
                .collect();
            if !alike.is_empty() {
                let dot = |&k: &usize| Mark::Dot {
                    at: place(node[k] as usize),
                    colour,
                };
                picture = picture
                    .marks(alike.iter().map(dot).collect())
                    .key(format!("{kind}: {}", alike.len()), colour);
            }
        }
        sheets.push(picture.to_svg().ok()?);
    }
    (!sheets.is_empty()).then(|| below_each_other(&sheets))
}

/// Values at nodes between corners that have one, where no contact is: their mean.
fn between<const D: usize>(mesh: &Mesh<D>, facets: &[Facet], values: &mut [f64]) {
    for &facet in facets {
        let nodes: Vec<usize> = mesh.facet_nodes(facet).collect();
        let corners = mesh.facet_kind(facet).corner_count();
        for (k, &n) in nodes.iter().enumerate().skip(corners) {
            if values[n].is_nan() {
                values[n] = match k < 2 * corners {
                    true => 0.5 * (values[nodes[k - corners]] + values[nodes[(k + 1) % corners]]),
                    false => {
                        nodes[..corners].iter().map(|&n| values[n]).sum::<f64>() / corners as f64
                    }
                };
            }
        }
    }
}

/// What a step of a deck is to do, before anything is computed: the mesh, the tools where they are at first, supports,
/// motions, loads and contacts.
#[cfg(feature = "command")]
pub(crate) fn planned<const D: usize>(
    deck: &Deck,
    setup: &crate::deck::Setup<D>,
    step: usize,
) -> Option<String> {
    let entry = deck.steps.get(step)?;
    let mesh = setup.driver.mesh();
    let title = match deck.title.as_str() {
        "" => format!("step {}", entry.name.value),
        title => format!("{title}: step {}", entry.name.value),
    };
    let picture = MeshPicture::new(mesh, title)
        .unit(deck.units.length())
        .marks(conditions::marks(deck, setup, entry));
    let none = Table::new(Vec::new());
    with_tools(picture, deck, (&none, 0), 1.0).to_svg().ok()
}

/// 1, 2 or 5 times a power of ten, at most the value.
fn round(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let digit = value / power;
    let digit = [5.0, 2.0].into_iter().find(|d| *d <= digit).unwrap_or(1.0);
    digit * power
}
