//! Blocks of cells of one element and a law that answers for many points at once, under small strains; not the law,
//! nor how its points are found.

use crate::assembly::block::{
    Block, BlockEnergy, CellResult, PointField, PointState, add_stress_stiffness, visit_gradients,
};
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::assembly::cells::Cells;
use crate::error::{LawFault, Place};
use crate::threads::prelude::*;
use moreau_laws::{FlowPower, Panel, PanelLaw};
use moreau_mandel::{Sym2, Sym4, equivalent_strain};
use nalgebra::Matrix3;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Points that a law is asked for at once: so many that a call costs nothing, and so few that what it computes stays
/// near the processor.
const POINTS: usize = 8192;

/// Cells that are worth a thread.
const GRAIN: usize = 256;

/// Part of the elastic tangent up to which two tangents are the same but for rounding.
const ROUNDING: f64 = 1e-12;

/// Part of its largest entry up to which a tangent is symmetric: of a law that others round.
const SYMMETRIC: f64 = 1e-9;

/// What the points remember.
#[derive(Clone)]
struct States {
    stress: Vec<Sym2>,
    /// Equivalent plastic strain p = Σ √(2/3) ‖Δεᵖ‖ with Δεᵖ = Δε − C⁻¹ Δσ.
    p: Vec<f64>,
    /// The numbers of the law, point by point.
    numbers: Vec<f64>,
}

impl States {
    /// Those of some points become those of others.
    fn copy(&mut self, points: Range<usize>, other: &Self, numbers: usize) {
        self.stress[points.clone()].copy_from_slice(&other.stress[points.clone()]);
        self.p[points.clone()].copy_from_slice(&other.p[points.clone()]);
        let numbers = points.start * numbers..points.end * numbers;
        self.numbers[numbers.clone()].copy_from_slice(&other.numbers[numbers]);
    }

    /// Hands every number on, point by point.
    fn visit(&mut self, numbers: usize, each: &mut dyn FnMut(&mut f64)) {
        for (point, (stress, p)) in self.stress.iter_mut().zip(&mut self.p).enumerate() {
            stress.iter_mut().for_each(&mut *each);
            each(p);
            let own = &mut self.numbers[point * numbers..(point + 1) * numbers];
            own.iter_mut().for_each(&mut *each);
        }
    }
}

/// Room for what the cells of a panel need, used again for the next one.
#[derive(Default)]
struct Room {
    d_eps: Vec<Sym2>,
    tangent: Vec<Sym4>,
    force: Vec<f64>,
    stiffness: Vec<f64>,
    /// Whether the tangent at a point is another than the elastic one.
    flows: Vec<bool>,
}

/// The block of some cells with a law of panels.
///
/// Plastic strain is what is not elastic, Δε − C⁻¹ Δσ with the elastic tangent C, at points whose tangent is another.
/// What is dissipated is the work of the stress at the end on it, and what is stored ½ σ : C⁻¹ σ.
pub struct PanelBlock<const D: usize> {
    members: Vec<usize>,
    cells: Box<dyn Cells<D>>,
    law: Arc<dyn PanelLaw>,
    /// Numbers of a state of the law.
    numbers: usize,
    elastic: Sym4,
    compliance: Sym4,
    old: States,
    new: States,
    /// Plastic work of the step at each point \[N·mm/mm³\].
    spent: Vec<f64>,
    fault: Mutex<Option<LawFault>>,
    room: Room,
}

impl<const D: usize> PanelBlock<D> {
    /// The block of `cells`, which are the cells `members` of the mesh, in the initial state of the law. What the law
    /// answers to a point at rest is the stress at the start and the elastic tangent.
    ///
    /// # Errors
    /// [`LawFault`].
    pub fn new(
        members: Vec<usize>,
        cells: Box<dyn Cells<D>>,
        law: Arc<dyn PanelLaw>,
    ) -> Result<Self, LawFault> {
        let initial = law.initial();
        let count = cells.count() * cells.points_per_cell();
        let (mut stress, mut tangent) = ([Sym2::zeros()], [Sym4::zeros()]);
        let mut numbers = initial.clone();
        respond(
            law.as_ref(),
            Panel {
                d_eps: &[Sym2::zeros()],
                old: &initial,
                stress: &mut stress,
                tangent: &mut tangent,
                new: &mut numbers,
            },
        )?;
        let [elastic] = tangent;
        let (largest, found) = asymmetry(&elastic);
        let compliance = elastic.cholesky().map(|factor| factor.inverse());
        let symmetric = found <= SYMMETRIC * largest;
        let compliance = compliance.filter(|_| symmetric && largest.is_finite());
        let states = States {
            stress: vec![stress[0]; count],
            p: vec![0.0; count],
            numbers: initial.repeat(count),
        };
        let block = Self {
            members,
            cells,
            law,
            numbers: initial.len(),
            elastic: symmetrised(&elastic),
            compliance: compliance.ok_or(LawFault::NotElastic)?,
            old: states.clone(),
            new: states,
            spent: vec![0.0; count],
            fault: Mutex::default(),
            room: Room::default(),
        };
        if count > 0 {
            let finite = stress[0].iter().chain(&initial).all(|x| x.is_finite());
            if !finite {
                return Err(block.not_finite("stress or state at rest", 0));
            }
        }
        Ok(block)
    }

    fn place(&self, point: usize) -> Place {
        let per_cell = self.cells.points_per_cell();
        Place {
            cell: self.members[point / per_cell],
            point: point % per_cell,
            position: self.cells.position(point).to_vec(),
        }
    }

    fn not_finite(&self, what: &'static str, point: usize) -> LawFault {
        LawFault::NotFinite {
            what,
            place: self.place(point),
        }
    }

    /// Panels of cells.
    fn panels(&self) -> impl Iterator<Item = Range<usize>> + use<D> {
        let all = self.cells.count();
        let cells = (POINTS / self.cells.points_per_cell().max(1)).max(1);
        (0..all)
            .step_by(cells)
            .map(move |first| first..(first + cells).min(all))
    }

    fn points_of(&self, cells: &Range<usize>) -> Range<usize> {
        let per_cell = self.cells.points_per_cell();
        cells.start * per_cell..cells.end * per_cell
    }

    /// Strains of the cells of a panel by a motion.
    fn strains(&self, cells: &Range<usize>, motion: Motion<'_>, d_eps: &mut Vec<Sym2>) {
        let per_cell = self.cells.points_per_cell();
        d_eps.resize(cells.len() * per_cell, Sym2::zeros());
        let of_cells = d_eps.par_chunks_mut(per_cell).enumerate();
        of_cells.with_min_len(GRAIN).for_each(|(k, d_eps)| {
            let k = cells.start + k;
            self.cells.strain(k, motion.by, d_eps);
            motion.relieve((self.cells.as_ref(), k), d_eps);
        });
    }

    /// Asks the law for the points of a panel, and looks at what it says; the tangents in `room` are made symmetric.
    ///
    /// # Errors
    /// [`LawFault`]; the candidate of these points is then what they were.
    fn ask(&mut self, points: &Range<usize>, room: &mut Room) -> Result<(), LawFault> {
        room.tangent.resize(points.len(), Sym4::zeros());
        let numbers = points.start * self.numbers..points.end * self.numbers;
        let answered = respond(
            self.law.as_ref(),
            Panel {
                d_eps: &room.d_eps,
                old: &self.old.numbers[numbers.clone()],
                stress: &mut self.new.stress[points.clone()],
                tangent: &mut room.tangent,
                new: &mut self.new.numbers[numbers],
            },
        );
        let looked_at = answered.and_then(|()| self.look_at(points, room));
        if looked_at.is_err() {
            self.new.copy(points.clone(), &self.old, self.numbers);
            self.spent[points.clone()].fill(0.0);
        }
        looked_at
    }

    /// Whether an answer is one; with the plastic strain and work that it means.
    fn look_at(&mut self, points: &Range<usize>, room: &mut Room) -> Result<(), LawFault> {
        let symmetric = self.law.is_symmetric();
        let rounding = ROUNDING * self.elastic.amax();
        for (k, point) in points.clone().enumerate() {
            let numbers = point * self.numbers..(point + 1) * self.numbers;
            let (stress, tangent) = (self.new.stress[point], room.tangent[k]);
            let (largest, asymmetry) = asymmetry(&tangent);
            let mut what = None;
            if !self.new.numbers[numbers].iter().all(|x| x.is_finite()) {
                what = Some("state");
            }
            if !largest.is_finite() {
                what = Some("tangent");
            }
            if !stress.iter().all(|x| x.is_finite()) {
                what = Some("stress");
            }
            if let Some(what) = what {
                return Err(self.not_finite(what, point));
            }
            let allowed = SYMMETRIC * largest;
            if symmetric && asymmetry > allowed {
                return Err(LawFault::Unsymmetric {
                    found: asymmetry,
                    allowed,
                    place: self.place(point),
                });
            }
            let flows = (tangent - self.elastic).amax() > rounding;
            room.flows[k] = flows;
            room.tangent[k] = symmetrised(&tangent);
            let mut plastic = Sym2::zeros();
            if flows {
                plastic = room.d_eps[k] - self.compliance * (stress - self.old.stress[point]);
            }
            self.new.p[point] = self.old.p[point] + equivalent_strain(&plastic);
            self.spent[point] = stress.dot(&plastic);
        }
        Ok(())
    }

    /// States of the points of a panel at the end of a step, and the tangents there with whether they are others than
    /// the elastic one; `None` where there is no answer.
    fn respond(
        &mut self,
        points: &Range<usize>,
        stiffness: Stiffness,
        room: &mut Room,
    ) -> Option<()> {
        room.flows.clear();
        room.flows.resize(points.len(), false);
        // A step without strain changes nothing: that is not asked.
        let rests = matches!(stiffness, Stiffness::None | Stiffness::Total(0.0))
            && room.d_eps.iter().flatten().all(|&e| e == 0.0);
        if rests {
            self.new.copy(points.clone(), &self.old, self.numbers);
            self.spent[points.clone()].fill(0.0);
            room.tangent.clear();
            room.tangent.resize(points.len(), self.elastic);
            return Some(());
        }
        let kept = self.fault.get_mut().unwrap_or_else(PoisonError::into_inner);
        let finite = room.d_eps.iter().flatten().all(|e| e.is_finite());
        if kept.is_some() || !finite {
            return None;
        }
        match self.ask(points, room) {
            Ok(()) => Some(()),
            Err(fault) => {
                self.note(fault);
                None
            }
        }
    }

    fn note(&self, fault: LawFault) {
        let mut kept = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(fault);
    }

    /// Forces and stiffness of the cells of a panel, from what the law has answered.
    fn integrate(
        &self,
        (cells, points): (&Range<usize>, &Range<usize>),
        stiffness: Stiffness,
        entries: usize,
        room: &mut Room,
    ) {
        let (per_cell, elastic) = (self.cells.points_per_cell(), self.elastic);
        for (tangent, &flows) in room.tangent.iter_mut().zip(&room.flows) {
            let of_law = if flows { *tangent } else { elastic };
            *tangent = match stiffness {
                Stiffness::None => break,
                Stiffness::Total(0.0) => elastic,
                Stiffness::Total(part) => elastic + (of_law - elastic) * part,
                Stiffness::Plastic(part) => (of_law - elastic) * part,
            };
        }
        let stress = &self.new.stress[points.clone()];
        let size = D * self.cells.nodes(cells.start).len();
        let of_cells = (room.force.par_chunks_mut(size))
            .zip(room.stiffness.par_chunks_mut(entries.max(1)))
            .zip(stress.par_chunks(per_cell))
            .zip(room.tangent.par_chunks(per_cell))
            .zip(room.flows.par_chunks(per_cell))
            .enumerate();
        of_cells.with_min_len(GRAIN).for_each(
            |(k, ((((force, matrix), stress), tangent), flows))| {
                let cell = cells.start + k;
                self.cells.force(cell, stress, force);
                if stiffness.is_given(flows.contains(&true)) {
                    self.cells.stiffness(cell, tangent, matrix);
                }
            },
        );
    }

    /// The committed state at a quadrature point.
    fn point(&self, point: usize) -> PointState<D> {
        PointState {
            cell: self.members[point / self.cells.points_per_cell()],
            position: self.cells.position(point),
            weight: self.cells.weight(point),
            stress: self.old.stress[point],
            jacobian: 1.0,
            plastic_strain: self.old.p[point],
        }
    }
}

fn respond(law: &dyn PanelLaw, panel: Panel<'_>) -> Result<(), LawFault> {
    law.respond(panel)
        .map_err(|error| LawFault::NoAnswer { problem: error.0 })
}

/// The largest entry, infinite where one is no number, and the largest difference of two that symmetry makes one.
fn asymmetry(tangent: &Sym4) -> (f64, f64) {
    let not_a_number = !tangent.iter().all(|x| x.is_finite());
    let largest = if not_a_number {
        f64::INFINITY
    } else {
        tangent.amax()
    };
    (largest, (tangent - tangent.transpose()).amax())
}

/// ½ (C + Cᵀ), the same to the bit where that is C.
fn symmetrised(tangent: &Sym4) -> Sym4 {
    (tangent + tangent.transpose()) * 0.5
}

impl<const D: usize> Block<D> for PanelBlock<D> {
    fn cells(&self) -> &[usize] {
        &self.members
    }

    fn nodes(&self, k: usize) -> &[usize] {
        self.cells.nodes(k)
    }

    fn count(&self) -> usize {
        self.cells.count()
    }

    fn is_at(&self, k: usize, nodes: &[[f64; D]]) -> bool {
        self.cells.is_at(k, nodes)
    }

    fn evaluate(
        &mut self,
        motion: Motion<'_>,
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool {
        let kept = self.fault.get_mut().unwrap_or_else(PoisonError::into_inner);
        kept.take_if(|fault| !fault.breaks_off());
        let mut room = std::mem::take(&mut self.room);
        let mut any = false;
        for cells in self.panels() {
            let size = D * self.cells.nodes(cells.start).len();
            let entries = match stiffness {
                Stiffness::None => 0,
                Stiffness::Total(_) | Stiffness::Plastic(_) => size * (size + 1) / 2,
            };
            let points = self.points_of(&cells);
            room.force.resize(cells.len() * size, 0.0);
            // One entry a cell at least, so that cells stay aligned.
            room.stiffness.resize(cells.len() * entries.max(1), 0.0);
            self.strains(&cells, motion, &mut room.d_eps);
            if self.respond(&points, stiffness, &mut room).is_some() {
                self.integrate((&cells, &points), stiffness, entries, &mut room);
            } else {
                // No forces: who is in search of balance turns back.
                room.force.fill(f64::NAN);
                room.stiffness.fill(f64::NAN);
                room.flows.fill(true);
            }
            let flows = room.flows.chunks(self.cells.points_per_cell());
            for (k, flows) in flows.enumerate() {
                let flows = flows.contains(&true);
                let entries = match stiffness.is_given(flows) {
                    true => entries,
                    false => 0,
                };
                sink(CellResult {
                    cell: cells.start + k,
                    nodes: self.cells.nodes(cells.start + k),
                    force: &room.force[k * size..(k + 1) * size],
                    stiffness: &room.stiffness[k * entries..(k + 1) * entries],
                });
                any |= flows;
            }
        }
        self.room = room;
        any
    }

    fn take_fault(&mut self) -> Option<LawFault> {
        let kept = self.fault.get_mut().unwrap_or_else(PoisonError::into_inner);
        kept.take()
    }

    fn points_per_cell(&self) -> usize {
        self.cells.points_per_cell()
    }

    fn is_symmetric(&self) -> bool {
        self.law.is_symmetric()
    }

    fn keeps_elastic_stiffness(&self) -> bool {
        true
    }

    fn lacking(&self, motion: Motion<'_>, v: &[f64], sink: &mut dyn FnMut(&[usize], &[f64])) {
        if self.law.is_symmetric() {
            return;
        }
        let (mut d_eps, mut rate) = (Vec::new(), Vec::new());
        let per_cell = self.cells.points_per_cell();
        for cells in self.panels() {
            let points = self.points_of(&cells);
            let numbers = points.start * self.numbers..points.end * self.numbers;
            self.strains(&cells, motion, &mut d_eps);
            self.strains(&cells, Motion::new(motion.from, v), &mut rate);
            let mut stress = vec![Sym2::zeros(); points.len()];
            let mut tangent = vec![Sym4::zeros(); points.len()];
            let answered = respond(
                self.law.as_ref(),
                Panel {
                    d_eps: &d_eps,
                    old: &self.old.numbers[numbers.clone()],
                    stress: &mut stress,
                    tangent: &mut tangent,
                    new: &mut vec![0.0; numbers.len()],
                },
            );
            if let Err(fault) = answered {
                tangent.fill(Sym4::repeat(f64::NAN));
                self.note(fault);
            }
            for (rate, tangent) in rate.iter_mut().zip(&tangent) {
                *rate = (tangent - symmetrised(tangent)) * *rate;
            }
            for (k, rate) in cells.zip(rate.chunks(per_cell)) {
                let nodes = self.cells.nodes(k);
                let mut force = vec![0.0; D * nodes.len()];
                self.cells.force(k, rate, &mut force);
                sink(nodes, &force);
            }
        }
    }

    fn potential(&self, _: Motion<'_>) -> Option<f64> {
        None
    }

    fn energy(&self) -> BlockEnergy {
        let mut sum = BlockEnergy::default();
        for (point, stress) in self.new.stress.iter().enumerate() {
            let weight = self.cells.weight(point);
            sum.stored += weight * 0.5 * stress.dot(&(self.compliance * stress));
            sum.dissipated += weight * self.spent[point];
            sum.volume += weight;
            if self.new.p[point] > self.old.p[point] {
                sum.plastic_volume += weight;
            }
        }
        sum
    }

    fn flow_power(&self, _: &[f64]) -> Option<FlowPower> {
        None
    }

    fn commit(&mut self) {
        let all = 0..self.spent.len();
        self.old.copy(all, &self.new, self.numbers);
        self.spent.fill(0.0);
    }

    fn points(&self, _: &[f64]) -> Vec<PointState<D>> {
        (0..self.spent.len())
            .map(|point| self.point(point))
            .collect()
    }

    fn fields(&self, _: &[f64]) -> Vec<PointField> {
        let mut first = 0;
        let mut fields = Vec::new();
        for (name, components) in self.law.fields() {
            let own = first..first + components;
            first = own.end;
            let of_points = self.old.numbers.chunks_exact(self.numbers.max(1));
            let values = of_points.filter_map(|numbers| numbers.get(own.clone()));
            fields.push(PointField {
                name,
                components,
                values: values.flatten().copied().collect(),
            });
        }
        fields
    }

    fn gradients(&self, u: &[f64], sink: &mut dyn FnMut(&PointState<D>, &Matrix3<f64>)) {
        visit_gradients(self.cells.as_ref(), u, &mut |k, gradients| {
            let first = k * self.cells.points_per_cell();
            for (g, gradient) in gradients.iter().enumerate() {
                sink(&self.point(first + g), gradient);
            }
        });
    }

    fn add_stress_stiffness(&self, v: &[f64], force: &mut [f64]) {
        add_stress_stiffness(
            self.cells.as_ref(),
            &|point| self.old.stress[point],
            v,
            force,
        );
    }

    fn state(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.old
            .clone()
            .visit(self.numbers, &mut |x| numbers.push(*x));
        numbers
    }

    fn restore(&mut self, numbers: &[f64]) -> usize {
        let count = (6 + 1 + self.numbers) * self.spent.len();
        if numbers.len() == count {
            let mut next = numbers.iter();
            self.old.visit(self.numbers, &mut |x| {
                *x = next.next().copied().unwrap_or(*x);
            });
            self.new = self.old.clone();
            self.spent.fill(0.0);
        }
        count
    }
}
