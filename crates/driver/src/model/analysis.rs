//! Hypotheses with the elements that they are used with, and what is asked of them once these are built.

use crate::assembly::block::{Block, SolidBlock};
use crate::assembly::cells::{Cells, ElementCells};
use crate::model::load::facet_of;
use crate::vector::SparseVector;
use moreau_laws::{BulkLaw, InPlaneStress};
use moreau_mesh::{
    Axisymmetric, CellKind, Element, Facet, Hex8, Hex20, Hex27, Hypothesis, Integration, Mesh,
    MortarRow, MultiplierChoices, Pairing, PlaneStrain, PlaneStress, PositiveShare, Pressed, Quad4,
    Quad8, Quad9, Share, Solid, Tet4, Tet10, Tri3, Tri6,
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

/// The cells of a mesh of one dimension, by the elements that it has.
macro_rules! elements {
    ($name:ident, $dimension:literal: $($element:ident with $nodes:literal),*) => {
        fn $name<H: Hypothesis<$dimension>>(
            hypothesis: &H,
            mesh: &Mesh<$dimension>,
            kind: CellKind,
            of: &[usize],
            integration: Integration,
        ) -> Option<Box<dyn Cells<$dimension>>> {
            match kind {
                $(CellKind::$element => {
                    cells::<$element, H, $dimension, $nodes>(hypothesis, mesh, of, integration)
                })*
                _ => None,
            }
        }
    };
}

elements!(plane, 2: Tri3 with 3, Tri6 with 6, Quad4 with 4, Quad8 with 8, Quad9 with 9);
elements!(space, 3: Tet4 with 4, Tet10 with 10, Hex8 with 8, Hex20 with 20, Hex27 with 27);

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
    /// Shares of a surface that faces a tool under large strains, with the nodes of the mesh at these positions: in the plane
    /// at nodes themselves, whose places are what large strains ask of; on the axis one may bear nothing.
    fn shares_on_tool(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        facets: &[Facet],
    ) -> Vec<PositiveShare<D>>;
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
        kept: &mut MultiplierChoices,
    ) -> Vec<MortarRow<D>>;
}

impl<const D: usize, H: Hypothesis<D>> Measure<D> for H {
    fn facet_shares(&self, mesh: &Mesh<D>, facets: &[Facet]) -> Vec<Share<D>> {
        mesh.facet_shares(facets, self)
    }

    fn shares_on_tool(
        &self,
        mesh: &Mesh<D>,
        positions: &[[f64; D]],
        facets: &[Facet],
    ) -> Vec<PositiveShare<D>> {
        match D {
            2 => {
                let nodal = mesh.facet_shares_at(positions, facets, self);
                nodal.into_iter().map(PositiveShare::of_node).collect()
            }
            _ => mesh.positive_shares_at(positions, facets, self),
        }
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
        kept: &mut MultiplierChoices,
    ) -> Vec<MortarRow<D>> {
        mesh.mortar_rows_keeping(positions, surfaces, pairing, self, kept)
    }
}
