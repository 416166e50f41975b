//! Hypotheses with the elements that they are used with, and what is asked of them once these are built.

use crate::assembly::block::{Block, SolidBlock};
use crate::assembly::cells::{Cells, ElementCells};
use crate::model::load::facet_of;
use crate::vector::SparseVector;
use moreau_laws::{BulkLaw, InPlaneStress};
use moreau_mesh::{
    Axisymmetric, CellKind, Element, Facet, Hex8, Hex20, Hex27, Hypothesis, Integration, Mesh,
    MortarRow, Pairing, PlaneStrain, PlaneStress, Pressed, Quad4, Quad8, Quad9, Share, Solid, Tet4,
    Tet10, Tri3, Tri6,
};

/// A hypothesis together with the elements that it can be used with.
pub trait Analysis<const D: usize>: Hypothesis<D> {
    /// Cells of one kind; `None` if the hypothesis has no such cells.
    fn cells(
        &self,
        mesh: &Mesh<D>,
        kind: CellKind,
        cells: &[usize],
        integration: Integration,
    ) -> Option<Box<dyn Cells<D>>>;

    /// Cells of the mesh, `members`, under a law at small or at `large` strains, with the state that every quadrature
    /// point starts from by its position in the undeformed body \[mm\].
    fn solid_block<L: BulkLaw>(
        members: Vec<usize>,
        cells: Box<dyn Cells<D>>,
        law: L,
        large: bool,
        state: &impl Fn(&[f64; D]) -> L::State,
    ) -> Box<dyn Block<D>>;
}

fn cells<E, H, const D: usize, const N: usize>(
    hypothesis: &H,
    mesh: &Mesh<D>,
    cells: &[usize],
    integration: Integration,
) -> Option<Box<dyn Cells<D>>>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
{
    let cells = ElementCells::<D, N>::new::<E, H>(mesh, cells, hypothesis, integration).ok()?;
    Some(Box::new(cells))
}

/// The elements of the plane.
fn plane<H: Hypothesis<2>>(
    h: &H,
    mesh: &Mesh<2>,
    kind: CellKind,
    of: &[usize],
    rule: Integration,
) -> Option<Box<dyn Cells<2>>> {
    match kind {
        CellKind::Tri3 => cells::<Tri3, H, 2, 3>(h, mesh, of, rule),
        CellKind::Tri6 => cells::<Tri6, H, 2, 6>(h, mesh, of, rule),
        CellKind::Quad4 => cells::<Quad4, H, 2, 4>(h, mesh, of, rule),
        CellKind::Quad8 => cells::<Quad8, H, 2, 8>(h, mesh, of, rule),
        CellKind::Quad9 => cells::<Quad9, H, 2, 9>(h, mesh, of, rule),
        _ => None,
    }
}

/// The elements of space.
fn space<H: Hypothesis<3>>(
    h: &H,
    mesh: &Mesh<3>,
    kind: CellKind,
    of: &[usize],
    rule: Integration,
) -> Option<Box<dyn Cells<3>>> {
    match kind {
        CellKind::Tet4 => cells::<Tet4, H, 3, 4>(h, mesh, of, rule),
        CellKind::Tet10 => cells::<Tet10, H, 3, 10>(h, mesh, of, rule),
        CellKind::Hex8 => cells::<Hex8, H, 3, 8>(h, mesh, of, rule),
        CellKind::Hex20 => cells::<Hex20, H, 3, 20>(h, mesh, of, rule),
        CellKind::Hex27 => cells::<Hex27, H, 3, 27>(h, mesh, of, rule),
        _ => None,
    }
}

/// A law as it is.
fn solid<L: BulkLaw, const D: usize>(
    members: Vec<usize>,
    cells: Box<dyn Cells<D>>,
    law: L,
    large: bool,
    state: &impl Fn(&[f64; D]) -> L::State,
) -> Box<dyn Block<D>> {
    match large {
        true => Box::new(SolidBlock::large(members, cells, law).with_states(state)),
        false => Box::new(SolidBlock::new(members, cells, law).with_states(state)),
    }
}

/// A law in plane stress, which is not compiled where there is none; at small strains, as is checked before.
fn plate<L: BulkLaw>(
    members: Vec<usize>,
    cells: Box<dyn Cells<2>>,
    law: L,
    _large: bool,
    state: &impl Fn(&[f64; 2]) -> L::State,
) -> Box<dyn Block<2>> {
    let plate = SolidBlock::new(members, cells, InPlaneStress(law));
    Box::new(plate.with_states(|x| state(x).into()))
}

macro_rules! analysis {
    ($hypothesis:ty, $dimension:literal, $elements:ident, $block:ident) => {
        impl Analysis<$dimension> for $hypothesis {
            fn cells(
                &self,
                mesh: &Mesh<$dimension>,
                kind: CellKind,
                cells: &[usize],
                integration: Integration,
            ) -> Option<Box<dyn Cells<$dimension>>> {
                $elements(self, mesh, kind, cells, integration)
            }

            fn solid_block<L: BulkLaw>(
                members: Vec<usize>,
                cells: Box<dyn Cells<$dimension>>,
                law: L,
                large: bool,
                state: &impl Fn(&[f64; $dimension]) -> L::State,
            ) -> Box<dyn Block<$dimension>> {
                $block(members, cells, law, large, state)
            }
        }
    };
}

analysis!(PlaneStrain, 2, plane, solid);
analysis!(PlaneStress, 2, plane, plate);
analysis!(Axisymmetric, 2, plane, solid);
analysis!(Solid, 3, space, solid);

/// What the driver still asks of the hypothesis once the blocks are built.
pub(crate) trait Measure<const D: usize>: Send + Sync {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>>;
    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)>;
    /// [`Mesh::press`] of the entries of [`Loading::pressure`](crate::Loading::pressure).
    fn press(
        &self,
        mesh: &Mesh<D>,
        pressures: &SparseVector,
        position: &dyn Fn(usize) -> [f64; D],
        visit: &mut dyn FnMut(&Pressed),
    );
    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]>;
    fn mortar_rows(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        surfaces: (&[Facet], &[Facet]),
        pairing: Pairing,
    ) -> Vec<MortarRow<D>>;
}

impl<const D: usize, H: Hypothesis<D>> Measure<D> for H {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>> {
        mesh.facet_shares(facets, self)
    }

    fn volume_shares(&self, mesh: &Mesh<D>, cells: &[usize]) -> Vec<(usize, f64)> {
        mesh.volume_shares(cells, self)
    }

    fn press(
        &self,
        mesh: &Mesh<D>,
        pressures: &SparseVector,
        position: &dyn Fn(usize) -> [f64; D],
        visit: &mut dyn FnMut(&Pressed),
    ) {
        let facets = pressures.iter().map(|(k, p)| (facet_of(k), p));
        mesh.press(facets, position, self, visit);
    }

    fn rigid_modes(&self, x: &[f64; D]) -> Vec<[f64; D]> {
        H::rigid_modes(x)
    }

    fn mortar_rows(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        surfaces: (&[Facet], &[Facet]),
        pairing: Pairing,
    ) -> Vec<MortarRow<D>> {
        mesh.mortar_rows(positions, surfaces, pairing, self)
    }
}
