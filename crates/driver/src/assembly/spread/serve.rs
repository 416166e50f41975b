//! What other processes than the first do: what they are told, with the cells that they hold; nothing of their own.

use super::ask;
use super::share::Entries;
use crate::assembly::block::{Block, BlockEnergy};
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use moreau_algebra::{ENGINE, Parcel, Share, Team, Unpacked};
use moreau_laws::FlowPower;

/// A stiffness as two numbers.
pub(crate) fn packed(stiffness: Stiffness) -> [f64; 2] {
    match stiffness {
        Stiffness::None => [0.0, 0.0],
        Stiffness::Total(part) => [1.0, part],
        Stiffness::Plastic(part) => [2.0, part],
    }
}

fn unpacked(numbers: &[f64]) -> Stiffness {
    match *numbers {
        [1.0, part] => Stiffness::Total(part),
        [2.0, part] => Stiffness::Plastic(part),
        _ => Stiffness::None,
    }
}

/// Energies as numbers, and a sum with them.
pub(crate) fn energies(e: &BlockEnergy) -> [f64; 4] {
    [e.stored, e.dissipated, e.plastic_volume, e.volume]
}

/// Points of a block as numbers: cell in the block, position, weight, stress, Jacobian, plastic strain and gradient.
pub(crate) fn points<const D: usize>(block: &dyn Block<D>, u: &[f64]) -> Vec<f64> {
    let mut numbers = Vec::new();
    block.gradients(u, &mut |point, gradient| {
        numbers.extend(point.position);
        numbers.push(point.weight);
        numbers.extend(point.stress.iter());
        numbers.push(point.jacobian);
        numbers.push(point.plastic_strain);
        numbers.extend(gradient.iter());
    });
    numbers
}

/// Numbers of a point.
pub(crate) const fn per_point(dimension: usize) -> usize {
    dimension + 1 + 6 + 1 + 1 + 9
}

/// The nodes of some blocks, ascending.
pub(crate) fn nodes_of<const D: usize>(blocks: &[Box<dyn Block<D>>], all: usize) -> Vec<u32> {
    let mut own = vec![false; all];
    for block in blocks {
        (0..block.cells().len()).for_each(|k| block.nodes(k).iter().for_each(|&a| own[a] = true));
    }
    (0..all as u32).filter(|&a| own[a as usize]).collect()
}

/// A process that holds cells.
struct Served<'a, const D: usize> {
    team: &'a dyn Team,
    blocks: Vec<Box<dyn Block<D>>>,
    /// Nodes of its cells, ascending.
    nodes: Vec<u32>,
    /// Degrees of freedom of the mesh, those of its tools among them.
    dofs: usize,
    entries: Option<Entries>,
}

/// Does what the first process asks until that is the end.
pub(crate) fn serve<const D: usize>(
    team: &dyn Team,
    blocks: Vec<Box<dyn Block<D>>>,
    (nodes, dofs): (usize, usize),
) {
    let mut served = Served {
        team,
        nodes: nodes_of(&blocks, nodes),
        blocks,
        dofs,
        entries: None,
    };
    loop {
        let order = team.receive(0);
        match order.first() {
            None => return,
            Some(&ENGINE) => {
                let share = served.entries.as_ref().map_or(Share::NONE, Entries::share);
                team.assist(&order, share);
            }
            Some(_) => served.does(&order),
        }
    }
}

impl<const D: usize> Served<'_, D> {
    /// Numbers at its nodes, at every degree of freedom: zero at the others, of which no page is touched.
    fn spread(&self, own: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.dofs];
        for (&a, own) in self.nodes.iter().zip(own.chunks_exact(D)) {
            all[D * a as usize..D * a as usize + D].copy_from_slice(own);
        }
        all
    }

    fn answer(&self, parcel: &Parcel) {
        self.team.send(0, parcel.bytes());
    }

    fn answer_reals(&self, numbers: &[f64]) {
        self.answer(&Parcel::default().reals(numbers));
    }

    fn does(&mut self, order: &[u8]) {
        let (kind, mut order) = Unpacked::order(order);
        match kind {
            ask::NUMBER => {
                let (unknown, turned) = (order.indices(), order.indices());
                let turned = turned.into_iter().map(|dof| dof as usize);
                let directions = Directions::from_numbers(D, turned, &order.reals());
                let entries = Entries::new(&self.blocks, (&unknown, directions));
                self.answer(&Parcel::default().indices(entries.rows()));
                self.entries = Some(entries);
            }
            ask::RESET => {
                let stiffness = order.count() == 1;
                let mut missing = SparseVector::default();
                let at = order.indices();
                for (dof, u) in at.into_iter().zip(order.reals()) {
                    missing.add(dof as usize, u);
                }
                if let Some(entries) = &mut self.entries {
                    entries.reset(stiffness, missing);
                }
            }
            ask::PRODUCT | ask::PRESCRIBED | ask::DIAGONAL => {
                let u = order.reals();
                let of = |entries: &Entries| match kind {
                    ask::PRODUCT => entries.product(&u),
                    ask::PRESCRIBED => entries.prescribed(self.dofs),
                    _ => entries.diagonal(),
                };
                self.answer_reals(&self.entries.as_ref().map_or(Vec::new(), of));
            }
            ask::COARSEN..=ask::SWEEP_UP => {
                if let Some(mut entries) = self.entries.take() {
                    self.iterates(&mut entries, kind, order);
                    self.entries = Some(entries);
                }
            }
            _ => {
                let block = order.count();
                if block < self.blocks.len() {
                    self.does_with(block, kind, order);
                }
            }
        }
    }

    /// What conjugate gradients ask.
    fn iterates(&self, entries: &mut Entries, kind: u8, mut order: Unpacked<'_>) {
        match kind {
            ask::COARSEN => {
                let places = entries.coarsen(&mut order);
                self.answer(&Parcel::default().indices(&places));
            }
            ask::HAND_OVER => self.answer_reals(&entries.hand_over()),
            ask::PROJECT => entries.project(),
            ask::SWEEP_DOWN => {
                let (rows, load) = (order.count(), order.reals());
                let (x, left) = entries.sweep_down(rows, &load);
                self.answer(&Parcel::default().reals(&x).reals(&left));
            }
            _ => {
                let (rows, load) = (order.count(), order.reals());
                self.answer_reals(&entries.sweep_up(rows, &load, order.reals()));
            }
        }
    }

    /// What is asked of a block.
    fn does_with(&mut self, k: usize, kind: u8, mut order: Unpacked<'_>) {
        match kind {
            ask::EVALUATE => self.evaluate(k, order),
            ask::COMMIT => self.blocks[k].commit(),
            ask::RESTORE => {
                let taken = self.blocks[k].restore(&order.reals());
                self.answer(&Parcel::default().count(taken));
            }
            ask::ENERGY => self.answer_reals(&energies(&self.blocks[k].energy())),
            ask::STATE => self.answer_reals(&self.blocks[k].state()),
            ask::LACKING => {
                let [from, by, v] = std::array::from_fn(|_| self.spread(&order.reals()));
                let motion = Motion {
                    from: &from,
                    by: &by,
                    free: &order.reals(),
                };
                let mut forces = Vec::new();
                self.blocks[k].lacking(motion, &v, &mut |_, force| forces.extend(force));
                self.answer_reals(&forces);
            }
            ask::POTENTIAL => {
                let [from, by] = std::array::from_fn(|_| self.spread(&order.reals()));
                let motion = Motion {
                    from: &from,
                    by: &by,
                    free: &order.reals(),
                };
                let potential = self.blocks[k].potential(motion);
                self.answer_reals(&Vec::from_iter(potential));
            }
            _ => {
                let u = self.spread(&order.reals());
                self.tells(k, kind, &u);
            }
        }
    }

    /// What is asked of a block at displacements.
    fn tells(&self, k: usize, kind: u8, u: &[f64]) {
        let block = self.blocks[k].as_ref();
        match kind {
            ask::FLOW_POWER => {
                let power = block.flow_power(u);
                let numbers = |p: FlowPower| vec![p.total, p.elastic, p.hardening];
                self.answer_reals(&power.map_or(Vec::new(), numbers));
            }
            ask::GRADIENTS => self.answer_reals(&points(block, u)),
            ask::FIELDS => {
                let fields = block.fields(u);
                let mut parcel = Parcel::default().count(fields.len());
                for field in fields {
                    parcel = parcel.text(&field.name).count(field.components);
                    parcel = parcel.reals(&field.values);
                }
                self.answer(&parcel);
            }
            ask::STRESS_STIFFNESS => {
                let mut force = vec![0.0; self.dofs];
                block.add_stress_stiffness(u, &mut force);
                let own = self.nodes.iter().flat_map(|&a| {
                    let a = D * a as usize;
                    force[a..a + D].iter().copied()
                });
                self.answer_reals(&own.collect::<Vec<f64>>());
            }
            _ => {}
        }
    }

    fn evaluate(&mut self, k: usize, mut order: Unpacked<'_>) {
        let stiffness = unpacked(&order.reals());
        let [from, by] = std::array::from_fn(|_| self.spread(&order.reals()));
        let motion = Motion {
            from: &from,
            by: &by,
            free: &order.reals(),
        };
        let mut forces = Vec::new();
        let entries = &mut self.entries;
        let flows = self.blocks[k].evaluate(motion, stiffness, &mut |cell| {
            forces.extend(cell.force);
            if let Some(entries) = entries {
                entries.add::<D>(k, cell);
            }
        });
        let parcel = Parcel::default().count(usize::from(flows));
        self.answer(&parcel.reals(&forces));
    }
}
