//! What other processes hold of a stiffness, as the first one sees it: sums over all of them, in the order of their
//! numbers; not how they add it up.

use crate::assembly::spread::ask;
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use moreau_algebra::{Parcel, SharedTeam, Unpacked};

/// Entries of K with other processes.
#[derive(Debug)]
pub(crate) struct Others {
    team: SharedTeam,
    /// Unknowns that each of them has.
    rows: Vec<Vec<u32>>,
    diagonal: Vec<f64>,
    /// Whether the entries are those that the factor at hand was made of.
    is_factorised: bool,
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
