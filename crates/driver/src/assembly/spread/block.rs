//! The block that stands for the cells of all processes: on the first, which holds a part of them; not the stiffness,
//! which stays where the cells are.

use super::ask;
use super::serve::{energies, packed, per_point, points};
use crate::assembly::block::{Block, BlockEnergy, CellResult, PointField, PointState};
use crate::assembly::cell_law::{Motion, Stiffness};
use moreau_algebra::{Parcel, SharedTeam, Unpacked};
use moreau_laws::FlowPower;
use moreau_mandel::Sym2;
use nalgebra::Matrix3;
use std::sync::Arc;

/// Cells of all processes.
pub(crate) struct SpreadBlock<const D: usize> {
    team: SharedTeam,
    /// Its number among the blocks.
    number: usize,
    /// Those of this process.
    own: Box<dyn Block<D>>,
    members: Vec<usize>,
    /// Nodes of all cells, one after the other.
    nodes: Vec<usize>,
    per_cell: usize,
    /// The process of each cell.
    process: Vec<u32>,
    /// Nodes of each process, ascending: of all of its blocks.
    nodes_of: Arc<Vec<Vec<u32>>>,
    /// Cells of this process in the block, ascending.
    held: Vec<usize>,
}

impl<const D: usize> SpreadBlock<D> {
    /// Of the cells `members` of a mesh with nodes `nodes`, `per_cell` each, of which each is with a process; `own`
    /// are those of this one, and `nodes_of` the nodes that each process has cells at.
    pub(crate) fn new(
        (team, number): (SharedTeam, usize),
        own: Box<dyn Block<D>>,
        members: Vec<usize>,
        (nodes, per_cell): (Vec<usize>, usize),
        process: Vec<u32>,
        nodes_of: Arc<Vec<Vec<u32>>>,
    ) -> Self {
        let held = (0..members.len()).filter(|&k| process[k] == 0).collect();
        Self {
            team,
            number,
            own,
            members,
            nodes,
            per_cell,
            process,
            nodes_of,
            held,
        }
    }

    fn order(&self, kind: u8) -> Parcel {
        Parcel::order(kind).count(self.number)
    }

    /// What a process needs of a vector over the degrees of freedom.
    fn part(&self, of: usize, v: &[f64]) -> Vec<f64> {
        let nodes = self.nodes_of[of].iter();
        let own = nodes.flat_map(|&a| &v[D * a as usize..D * a as usize + D]);
        own.copied().collect()
    }

    /// Sends an order with vectors to all others.
    fn ask(&self, order: &Parcel, vectors: &[&[f64]]) {
        self.ask_with(order, vectors, &[]);
    }

    /// The same with numbers of the points of the block.
    fn ask_with(&self, order: &Parcel, vectors: &[&[f64]], of_points: &[f64]) {
        for to in 1..self.team.size() {
            let mut parcel = order.clone();
            for v in vectors {
                parcel = parcel.reals(&self.part(to, v));
            }
            parcel = parcel.reals(&self.of_points(to, of_points));
            self.team.send(to, parcel.bytes());
        }
    }

    /// Of numbers of the points of the block those of the cells that a process holds.
    fn of_points(&self, process: usize, numbers: &[f64]) -> Vec<f64> {
        let cells = numbers.chunks_exact(self.points_per_cell());
        let own = cells.zip(&self.process);
        let own = own.filter(|&(_, &p)| p as usize == process);
        own.flat_map(|(numbers, _)| numbers).copied().collect()
    }

    /// Answers of all others that are real numbers, in their order.
    fn answers(&self) -> Vec<Vec<f64>> {
        let from = |r: usize| Unpacked::new(&self.team.receive(r)).reals();
        (1..self.team.size()).map(from).collect()
    }

    /// Hands on numbers of the cells, of each process those of its own one after the other, in the order of the
    /// cells.
    fn in_order(&self, numbers: &[Vec<f64>], sink: &mut dyn FnMut(usize, &[f64])) {
        let mut count = vec![0; numbers.len()];
        self.process.iter().for_each(|&p| count[p as usize] += 1);
        let mut next = vec![0; numbers.len()];
        for (k, &process) in self.process.iter().enumerate() {
            let process = process as usize;
            let size = numbers[process].len() / count[process];
            sink(k, &numbers[process][next[process]..next[process] + size]);
            next[process] += size;
        }
    }

    fn of(&self, k: usize) -> &[usize] {
        &self.nodes[k * self.per_cell..(k + 1) * self.per_cell]
    }
}

impl<const D: usize> Block<D> for SpreadBlock<D> {
    fn cells(&self) -> &[usize] {
        &self.members
    }

    fn nodes(&self, k: usize) -> &[usize] {
        self.of(k)
    }

    fn holds(&self, k: usize) -> bool {
        self.process[k] == 0
    }

    fn evaluate(
        &mut self,
        motion: Motion<'_>,
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool {
        let order = self.order(ask::EVALUATE).reals(&packed(stiffness));
        self.ask_with(&order, &[motion.from, motion.by], motion.free);
        let free = self.of_points(0, motion.free);
        let motion = Motion {
            free: &free,
            ..motion
        };
        let mut forces = Vec::new();
        let held = &self.held;
        let mut flows = self.own.evaluate(motion, stiffness, &mut |cell| {
            forces.extend(cell.force);
            // Its forces come in their place among those of all.
            sink(CellResult {
                cell: held[cell.cell],
                force: &[],
                ..cell
            });
        });
        let mut all = vec![forces];
        for from in 1..self.team.size() {
            let parcel = self.team.receive(from);
            let mut parcel = Unpacked::new(&parcel);
            flows |= parcel.count() == 1;
            all.push(parcel.reals());
        }
        self.in_order(&all, &mut |k, force| {
            sink(CellResult {
                cell: k,
                nodes: self.of(k),
                force,
                stiffness: &[],
            });
        });
        flows
    }

    fn points_per_cell(&self) -> usize {
        self.own.points_per_cell()
    }

    fn is_symmetric(&self) -> bool {
        self.own.is_symmetric()
    }

    fn has_potential(&self) -> bool {
        self.own.has_potential()
    }

    fn keeps_elastic_stiffness(&self) -> bool {
        self.own.keeps_elastic_stiffness()
    }

    fn lacking(&self, motion: Motion<'_>, v: &[f64], sink: &mut dyn FnMut(&[usize], &[f64])) {
        if self.is_symmetric() {
            return;
        }
        let order = self.order(ask::LACKING);
        self.ask_with(&order, &[motion.from, motion.by, v], motion.free);
        let free = self.of_points(0, motion.free);
        let motion = Motion {
            free: &free,
            ..motion
        };
        let mut forces = Vec::new();
        self.own
            .lacking(motion, v, &mut |_, force| forces.extend(force));
        let mut all = vec![forces];
        all.extend(self.answers());
        self.in_order(&all, &mut |k, force| sink(self.of(k), force));
    }

    fn potential(&self, motion: Motion<'_>) -> Option<f64> {
        let order = self.order(ask::POTENTIAL);
        self.ask_with(&order, &[motion.from, motion.by], motion.free);
        let free = self.of_points(0, motion.free);
        let motion = Motion {
            free: &free,
            ..motion
        };
        let own = self.own.potential(motion);
        let others = self.answers();
        let others = others.iter().map(|numbers| numbers.first().copied());
        std::iter::once(own).chain(others).sum()
    }

    fn energy(&self) -> BlockEnergy {
        self.team.order(self.order(ask::ENERGY).bytes());
        let mut sum = energies(&self.own.energy());
        for numbers in self.answers() {
            sum.iter_mut().zip(numbers).for_each(|(sum, x)| *sum += x);
        }
        let [stored, dissipated, plastic_volume, volume] = sum;
        BlockEnergy {
            stored,
            dissipated,
            plastic_volume,
            volume,
        }
    }

    fn flow_power(&self, v: &[f64]) -> Option<FlowPower> {
        self.ask(&self.order(ask::FLOW_POWER), &[v]);
        let mut sum = self.own.flow_power(v);
        for numbers in self.answers() {
            let part = match *numbers {
                [total, elastic, hardening] => Some(FlowPower {
                    total,
                    elastic,
                    hardening,
                }),
                _ => None,
            };
            sum = sum.zip(part).map(|(sum, part)| sum.with(1.0, part));
        }
        sum
    }

    fn commit(&mut self) {
        self.team.order(self.order(ask::COMMIT).bytes());
        self.own.commit();
    }

    fn points(&self, u: &[f64]) -> Vec<PointState<D>> {
        let mut all = Vec::new();
        self.gradients(u, &mut |point, _| all.push(*point));
        all
    }

    fn fields(&self, u: &[f64]) -> Vec<PointField> {
        self.ask(&self.order(ask::FIELDS), &[u]);
        let mut parts = vec![self.own.fields(u)];
        for from in 1..self.team.size() {
            let parcel = self.team.receive(from);
            let mut parcel = Unpacked::new(&parcel);
            let count = parcel.count();
            let field = |_| PointField {
                name: parcel.text(),
                components: parcel.count(),
                values: parcel.reals(),
            };
            parts.push((0..count).map(field).collect());
        }
        // Who holds no cell of the block names no field.
        let Some(named) = parts.iter().find(|p| !p.is_empty()).cloned() else {
            return Vec::new();
        };
        let whole = named.into_iter().enumerate().map(|(f, field)| {
            let of = |p: &Vec<PointField>| p.get(f).map_or(Vec::new(), |f| f.values.clone());
            let numbers: Vec<Vec<f64>> = parts.iter().map(of).collect();
            let mut values = Vec::new();
            self.in_order(&numbers, &mut |_, own| values.extend(own));
            PointField { values, ..field }
        });
        whole.collect()
    }

    fn gradients(&self, u: &[f64], sink: &mut dyn FnMut(&PointState<D>, &Matrix3<f64>)) {
        self.ask(&self.order(ask::GRADIENTS), &[u]);
        let mut all = vec![points(self.own.as_ref(), u)];
        all.extend(self.answers());
        self.in_order(&all, &mut |k, numbers| {
            for point in numbers.chunks_exact(per_point(D)) {
                let state = PointState {
                    cell: self.members[k],
                    position: std::array::from_fn(|i| point[i]),
                    weight: point[D],
                    stress: Sym2::from_column_slice(&point[D + 1..D + 7]),
                    jacobian: point[D + 7],
                    plastic_strain: point[D + 8],
                };
                sink(&state, &Matrix3::from_column_slice(&point[D + 9..]));
            }
        });
    }

    fn add_stress_stiffness(&self, v: &[f64], force: &mut [f64]) {
        self.ask(&self.order(ask::STRESS_STIFFNESS), &[v]);
        self.own.add_stress_stiffness(v, force);
        for (numbers, nodes) in self.answers().iter().zip(&self.nodes_of[1..]) {
            for (own, &a) in numbers.chunks_exact(D).zip(nodes) {
                let at = force[D * a as usize..D * a as usize + D].iter_mut();
                at.zip(own).for_each(|(sum, f)| *sum += f);
            }
        }
    }

    fn state(&self) -> Vec<f64> {
        self.team.order(self.order(ask::STATE).bytes());
        let mut parts = vec![self.own.state()];
        parts.extend(self.answers());
        let mut all = Vec::with_capacity(parts.iter().map(Vec::len).sum());
        self.in_order(&parts, &mut |_, own| all.extend(own));
        all
    }

    fn restore(&mut self, numbers: &[f64]) -> usize {
        let mut parts = vec![Vec::new(); self.team.size()];
        let size = numbers.len() / self.process.len().max(1);
        for (own, &process) in numbers.chunks_exact(size.max(1)).zip(&self.process) {
            parts[process as usize].extend(own);
        }
        for (to, part) in parts.iter().enumerate().skip(1) {
            let order = self.order(ask::RESTORE).reals(part);
            self.team.send(to, order.bytes());
        }
        let mut taken = self.own.restore(&parts[0]);
        for from in 1..self.team.size() {
            taken += Unpacked::new(&self.team.receive(from)).count();
        }
        taken
    }
}
