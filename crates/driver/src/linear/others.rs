//! What other processes hold of a stiffness, as the first one sees it: sums over all of them, in the order of their
//! numbers; not how they add it up.

use crate::assembly::spread::ask;
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use moreau_algebra::{CoarseSpace, Parcel, Pattern, SharedTeam, Unpacked};

/// Entries of K with other processes.
#[derive(Debug)]
pub(crate) struct Others {
    team: SharedTeam,
    /// Unknowns that each of them has.
    rows: Vec<Vec<u32>>,
    diagonal: Vec<f64>,
    /// Whether the entries are those that the factor at hand was made of.
    is_factorised: bool,
    /// What they sweep, where there is a coarse space.
    swept: Swept,
}

/// Unknowns that other processes sweep, each of which has them alone, and what comes to the first of the rest.
#[derive(Debug, Default)]
struct Swept {
    /// Whether an unknown is none of them.
    here: Vec<bool>,
    /// Where entries of each process come to.
    slots: Vec<Vec<u32>>,
}

impl Others {
    /// Tells them the unknown of every degree of freedom, and its direction.
    pub(crate) fn new(team: &SharedTeam, (position, directions): (&[u32], &Directions)) -> Self {
        let (turned, along) = directions.numbers();
        let order = Parcel::order(ask::NUMBER).indices(position);
        team.order(order.indices(&turned).reals(&along).bytes());
        let rows = |from: usize| Unpacked::new(&team.receive(from)).indices();
        Self {
            rows: (1..team.size()).map(rows).collect(),
            team: team.clone(),
            diagonal: Vec::new(),
            is_factorised: false,
            swept: Swept::default(),
        }
    }

    /// Unknowns that several of them have, of so many.
    pub(crate) fn shared(&self, size: usize) -> Vec<bool> {
        let mut count = vec![0u8; size];
        let rows = self.rows.iter().flatten();
        rows.for_each(|&row| count[row as usize] = (count[row as usize] + 1).min(2));
        count.into_iter().map(|count| count == 2).collect()
    }

    /// Tells them what their unknowns follow in a coarse space, whose entries they share from then on, and takes over
    /// what they have of entries between unknowns that are swept `here`, to places of a pattern.
    pub(crate) fn coarsen(&mut self, space: &CoarseSpace, pattern: &Pattern, here: Vec<bool>) {
        for (k, rows) in self.rows.iter().enumerate() {
            let row = |&row: &u32| space.row(row as usize);
            let counts: Vec<u32> = rows.iter().map(|r| row(r).len() as u32).collect();
            let (unknowns, parts): (Vec<u32>, Vec<f64>) =
                rows.iter().flat_map(row).copied().unzip();
            let alone = rows.iter().map(|&row| u32::from(!here[row as usize]));
            let order = Parcel::order(ask::COARSEN).count(1).indices(&counts);
            let order = order.indices(&unknowns).reals(&parts);
            let order = order.indices(&alone.collect::<Vec<u32>>());
            self.team.send(k + 1, order.bytes());
        }
        let slot = |at: &[u32]| pattern.slot(at[0], at[1]);
        let slots = (1..self.team.size()).map(|from| {
            let places = Unpacked::new(&self.team.receive(from)).indices();
            places.chunks_exact(2).filter_map(slot).collect()
        });
        let slots = slots.collect();
        self.swept = Swept { here, slots };
    }

    /// There is no coarse space after all.
    pub(crate) fn refine(&mut self) {
        self.team
            .order(Parcel::order(ask::COARSEN).count(0).bytes());
        (1..self.team.size()).for_each(|from| drop(self.team.receive(from)));
        self.swept = Swept::default();
    }

    /// Takes over the entries between unknowns that are swept here.
    pub(crate) fn take_over(&self, values: &mut [f64]) {
        if self.swept.here.is_empty() {
            return;
        }
        self.team.order(Parcel::order(ask::HAND_OVER).bytes());
        for (k, slots) in self.swept.slots.iter().enumerate() {
            let entries = Unpacked::new(&self.team.receive(k + 1)).reals();
            let pairs = slots.iter().zip(entries);
            pairs.for_each(|(&at, entry)| values[at as usize] += entry);
        }
    }

    /// Their shares of the coarse space are those of the entries as they are now.
    pub(crate) fn project(&self) {
        self.team.order(Parcel::order(ask::PROJECT).bytes());
    }

    /// Whether an unknown is swept here.
    pub(crate) fn is_here(&self, row: usize) -> bool {
        self.swept.here[row]
    }

    /// Unknowns that a process has alone.
    fn alone(&self, rows: &[u32]) -> impl Iterator<Item = usize> {
        let rows = rows.iter().map(|&row| row as usize);
        rows.filter(|&row| !self.swept.here[row])
    }

    /// A sweep down over the first `rows` of what they have alone: what is left of b at all of their unknowns, added to
    /// `left` at those that are swept here, and written at the others.
    pub(crate) fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]) {
        for (k, own) in self.rows.iter().enumerate() {
            let load: Vec<f64> = self.alone(own).map(|row| b[row]).collect();
            let order = Parcel::order(ask::SWEEP_DOWN).count(rows).reals(&load);
            self.team.send(k + 1, order.bytes());
        }
        for (k, own) in self.rows.iter().enumerate() {
            let parcel = self.team.receive(k + 1);
            let mut parcel = Unpacked::new(&parcel);
            let (moved, leaves) = (parcel.reals(), parcel.reals());
            self.alone(own).zip(moved).for_each(|(row, z)| x[row] = z);
            for (row, leaves) in own.iter().map(|&row| row as usize).zip(leaves) {
                match self.is_here(row) {
                    true => left[row] += leaves,
                    false => left[row] = leaves,
                }
            }
        }
    }

    /// The sweep back.
    pub(crate) fn sweep_up(&self, b: &[f64], rows: usize, x: &mut [f64]) {
        for (k, own) in self.rows.iter().enumerate() {
            let load: Vec<f64> = self.alone(own).map(|row| b[row]).collect();
            let moved: Vec<f64> = own.iter().map(|&row| x[row as usize]).collect();
            let order = Parcel::order(ask::SWEEP_UP).count(rows);
            self.team
                .send(k + 1, order.reals(&load).reals(&moved).bytes());
        }
        for (k, own) in self.rows.iter().enumerate() {
            let moved = Unpacked::new(&self.team.receive(k + 1)).reals();
            self.alone(own).zip(moved).for_each(|(row, z)| x[row] = z);
        }
    }

    /// Begins a new sum, under prescribed displacements that are missing.
    pub(crate) fn reset(&mut self, stiffness: bool, missing: Option<&SparseVector>) {
        let missing = missing.map_or(Vec::new(), |m| m.iter().collect());
        let (at, by): (Vec<u32>, Vec<f64>) =
            missing.into_iter().map(|(dof, u)| (dof as u32, u)).unzip();
        let order = Parcel::order(ask::RESET).count(usize::from(stiffness));
        self.team.order(order.indices(&at).reals(&by).bytes());
        self.is_factorised &= !stiffness;
    }

    /// The numbers that each of them answers with, at its unknowns.
    fn visit(&self, sink: &mut dyn FnMut(usize, f64)) {
        for (k, rows) in self.rows.iter().enumerate() {
            let numbers = Unpacked::new(&self.team.receive(k + 1)).reals();
            rows.iter()
                .zip(numbers)
                .for_each(|(&row, x)| sink(row as usize, x));
        }
    }

    /// Adds what the missing displacements do, at the degrees of freedom of the unknowns \[N\].
    pub(crate) fn add_prescribed(&self, dofs: &[usize], load: &mut [f64]) {
        self.team
            .order(Parcel::order(ask::PRESCRIBED).reals(&[]).bytes());
        self.visit(&mut |row, f| load[dofs[row]] += f);
    }

    /// Asks for the diagonal.
    pub(crate) fn find_diagonal(&mut self, size: usize) {
        let mut diagonal = vec![0.0; size];
        self.team
            .order(Parcel::order(ask::DIAGONAL).reals(&[]).bytes());
        self.visit(&mut |row, k| diagonal[row] += k);
        self.diagonal = diagonal;
    }

    /// The diagonal when it was last asked for.
    pub(crate) fn diagonal(&self, row: usize) -> f64 {
        self.diagonal.get(row).copied().unwrap_or(0.0)
    }

    /// r ← r − K u.
    pub(crate) fn subtract_product(&self, u: &[f64], r: &mut [f64]) {
        for (k, rows) in self.rows.iter().enumerate() {
            let own: Vec<f64> = rows.iter().map(|&row| u[row as usize]).collect();
            let order = Parcel::order(ask::PRODUCT).reals(&own);
            self.team.send(k + 1, order.bytes());
        }
        self.visit(&mut |row, f| r[row] -= f);
    }

    /// A factor was made of the entries, or was not.
    pub(crate) fn factorised(&mut self, holds: bool) {
        self.is_factorised = holds;
    }

    /// Whether the entries are those of the factor at hand.
    pub(crate) fn is_factorised(&self) -> bool {
        self.is_factorised
    }
}
