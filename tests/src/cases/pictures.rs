//! What the pictures of the cases show: values along a contact, fields on deformed meshes; not the
//! charts themselves.

use moreau::driver::{ContactRecord, Driver, PointState};
use moreau::mesh::NodeKind;
use moreau::plot::{MeshPicture, nodal_average};

/// Positions \[mm\] and values of the contact points of one kind.
pub(super) fn along(
    contacts: &[ContactRecord<2>],
    kind: NodeKind,
    value: impl Fn(&ContactRecord<2>) -> f64,
) -> Vec<[f64; 2]> {
    contacts
        .iter()
        .filter(|c| c.kind == kind)
        .map(|c| [c.position[0], value(c)])
        .collect()
}

/// The contact points in the order of their positions.
pub(super) fn sorted(contacts: &[ContactRecord<2>]) -> Vec<ContactRecord<2>> {
    let mut contacts = contacts.to_vec();
    contacts.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
    contacts
}

/// Positions \[mm\] along the contact, in order, and a component of the traction \[MPa\], from the
/// nodal force.
pub(super) fn tractions(
    driver: &Driver<2>,
    force: impl Fn(&ContactRecord<2>) -> f64,
) -> Vec<[f64; 2]> {
    let traction = |c: &ContactRecord<2>| [c.position[0], force(c) / c.area];
    sorted(driver.contacts()).iter().map(traction).collect()
}

/// The deformed mesh, its displacements enlarged, coloured by a field of its material points.
pub(super) fn deformed<'a>(
    driver: &'a Driver<2>,
    title: impl Into<String>,
    magnification: f64,
    label: &str,
    value: impl Fn(&PointState<2>) -> f64,
) -> MeshPicture<'a> {
    let nodes = 0..driver.mesh().nodes().len();
    let displacement = nodes.map(|a| driver.displacement(a).into()).collect();
    let field = nodal_average(driver.mesh(), &driver.points(), value);
    MeshPicture::new(driver.mesh(), title)
        .deformed(displacement, magnification)
        .field(label, field)
        .outline()
}
