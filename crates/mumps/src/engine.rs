//! MUMPS as the engine of a team: what it is asked, and what its answers mean; not how it is called.

use crate::calls;
use crate::options::Options;
use crate::part::{Part, SINGULAR, entries, places};
use crate::processes::Processes;
use moreau_algebra::{
    Cost, ENGINE, Engine, EngineError, Inertia, Parcel, Pattern, Share, Team, TooLarge, Unpacked,
};
use nalgebra::{DMatrix, DVectorViewMut, Dyn, LU};
use std::collections::BTreeMap;

/// What an order asks for, in its second place.
const ANALYSE: usize = 1;
const FACTORISE: usize = 2;
const SOLVE: usize = 3;
const FREE: usize = 4;

/// Errors of MUMPS: singular; no memory.
const IS_SINGULAR: i32 = -10;
const NO_MEMORY: [i32; 2] = [-13, -7];

/// The part of other processes than the first in an order.
pub(crate) fn assist(
    team: &Processes,
    parts: &mut BTreeMap<usize, Part>,
    order: &[u8],
    share: Share<'_>,
) {
    let (_, mut order) = Unpacked::order(order);
    let (kind, number) = (order.count(), order.count());
    match kind {
        ANALYSE => {
            let (size, kept, sym) = (order.count(), order.count(), order.count());
            let options = Options::unpacked(&mut order);
            let part = Part::new((size, kept, sym as i32), options, entries(share));
            parts.insert(number, part);
        }
        FACTORISE => {
            let finite = share.values.iter().all(|v| v.is_finite());
            team.send(0, Parcel::default().count(usize::from(finite)).bytes());
            let goes = Unpacked::new(&team.receive(0)).count();
            if goes != 1 {
                return;
            }
            let is_done = parts.get_mut(&number).is_some_and(|part| {
                let all: Vec<(u32, u32, f64)> =
                    part.coupling(entries(share), share.values).collect();
                let places: Vec<u32> = all.iter().flat_map(|&(i, j, _)| [i, j]).collect();
                let values: Vec<f64> = all.iter().map(|&(_, _, k)| k).collect();
                team.send(0, Parcel::default().indices(&places).reals(&values).bytes());
                part.factorise(share.values, None)
            });
            if !is_done {
                // The first is within MUMPS already, and waits there for this one.
                team.refuse("a factorisation of other entries than those that were analysed");
            }
        }
        SOLVE => match parts.get_mut(&number).and_then(|p| p.instance.as_mut()) {
            Some(instance) => drop(instance.solve(None)),
            None => team.refuse("a solution with a factor that is not there"),
        },
        _ => drop(parts.remove(&number)),
    }
}

impl Team for Processes {
    fn rank(&self) -> usize {
        self.number()
    }

    fn size(&self) -> usize {
        self.count()
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        calls::send(to, bytes);
    }

    fn receive(&self, from: usize) -> Vec<u8> {
        calls::receive(from)
    }

    fn engine(
        &self,
        pattern: &Pattern,
        memory: Option<u64>,
        is_definite: bool,
    ) -> Result<Box<dyn Engine>, TooLarge> {
        Ok(Box::new(Mumps::new(self, pattern, memory, is_definite)?))
    }

    fn assist(&self, order: &[u8], share: Share<'_>) {
        assist(self, &mut self.parts(), order, share);
    }
}

/// MUMPS on all processes of a team, for a matrix of which each may hold a part; this is on the first.
#[derive(Debug)]
pub(crate) struct Mumps {
    team: Processes,
    number: usize,
    part: Part,
    pattern: Pattern,
    is_definite: bool,
    cost: Cost,
    room: Option<u64>,
    is_factorised: bool,
    least_pivot: f64,
    /// Entries between kept unknowns and others, and among kept ones: their values.
    coupling: Vec<(u32, u32, f64)>,
    schur: DMatrix<f64>,
    /// Factor of S, made when it is first asked for.
    dense: Option<LU<f64, Dyn, Dyn>>,
}

impl Mumps {
    pub(crate) fn new(
        team: &Processes,
        pattern: &Pattern,
        memory: Option<u64>,
        is_definite: bool,
    ) -> Result<Self, TooLarge> {
        let (size, kept) = (pattern.size(), pattern.kept());
        let (number, sym) = (Processes::next(), if is_definite { 1 } else { 2 });
        let options = team.options();
        let order = Parcel::order(ENGINE).count(ANALYSE).count(number);
        let order = order.count(size).count(kept).count(sym);
        team.order(options.packed(order).bytes());
        let part = Part::new((size, kept, sym as i32), options, places(pattern));
        let mut cost = Cost {
            entries: 0.0,
            operations: 0.0,
        };
        let mut bytes = 0.0;
        if let Some(instance) = &part.instance {
            let millions = |n: i32| match n < 0 {
                true => -1e6 * f64::from(n),
                false => f64::from(n),
            };
            cost = Cost {
                entries: millions(instance.integer(20)),
                operations: 0.5 * instance.real(1),
            };
            let estimate = if options.low_rank.is_some() { 36 } else { 16 };
            let largest = 1e6 * f64::from(instance.integer(estimate));
            bytes = largest * team.on_this_computer() as f64;
        }
        // An engine that is refused is freed on all processes, as any other.
        let new = Self {
            team: team.clone(),
            number,
            part,
            pattern: pattern.clone(),
            is_definite,
            cost,
            room: memory,
            is_factorised: false,
            least_pivot: f64::INFINITY,
            coupling: Vec::new(),
            schur: DMatrix::zeros(kept, kept),
            dense: None,
        };
        match memory.map(|room| room as f64) {
            Some(room) if bytes > room => Err(TooLarge {
                entries: bytes / size_of::<f64>() as f64,
                room: room / size_of::<f64>() as f64,
            }),
            _ => Ok(new),
        }
    }

    /// Of whatever processes there are, none of which but the first holds entries.
    fn alone(pattern: &Pattern, memory: Option<u64>, is_definite: bool) -> Result<Self, TooLarge> {
        let none = TooLarge {
            entries: 0.0,
            room: 0.0,
        };
        let team = Processes::begin(Options::default()).ok_or(none)?;
        Self::new(&team, pattern, memory, is_definite)
    }

    fn order(&self, kind: usize) -> Parcel {
        Parcel::order(ENGINE).count(kind).count(self.number)
    }

    /// Number of unknowns that are eliminated.
    fn inner(&self) -> usize {
        self.pattern.size() - self.pattern.kept()
    }

    /// What an error of MUMPS means.
    fn failure(&self, code: i32, detail: i32) -> EngineError {
        let row = self.inner().saturating_sub(1);
        if NO_MEMORY.contains(&code) {
            let room = self
                .room
                .map_or(self.cost.entries, |bytes| bytes as f64 / 8.0);
            let entries = self.cost.entries.max(room);
            return EngineError::TooLarge(TooLarge { entries, room });
        }
        match (code, self.is_definite) {
            (IS_SINGULAR, true) => EngineError::NotPositiveDefinite { row },
            (IS_SINGULAR, false) => EngineError::Singular {
                row,
                inertia: Inertia {
                    zero: 1,
                    ..Inertia::default()
                },
            },
            _ => EngineError::GaveUp { code, detail },
        }
    }

    /// The column of a value.
    fn column_of(&self, value: usize) -> usize {
        let holds = |&j: &usize| self.pattern.range(j).contains(&value);
        (0..self.pattern.size()).find(holds).unwrap_or(0)
    }

    /// Signs of the pivots, or why there is no factor.
    fn signs(&mut self) -> Result<Inertia, EngineError> {
        let Some(instance) = &self.part.instance else {
            return Ok(Inertia::default());
        };
        let (code, detail) = (instance.integer(1), instance.integer(2));
        if code < 0 {
            return Err(self.failure(code, detail));
        }
        let negative = usize::try_from(instance.integer(12)).unwrap_or(0);
        let zero = usize::try_from(instance.integer(28)).unwrap_or(0);
        let inertia = Inertia {
            positive: self.inner().saturating_sub(negative + zero),
            negative,
            zero,
        };
        self.least_pivot = instance.real(19);
        let row = instance.null_pivot().unwrap_or(self.inner() - 1);
        match self.is_definite {
            true if negative > 0 => Err(EngineError::NotPositiveDefinite { row }),
            _ if zero > 0 => Err(EngineError::Singular { row, inertia }),
            _ => Ok(inertia),
        }
    }

    /// x ← K_ii⁻¹ x of one column whose kept unknowns are zero before, and nothing after.
    fn solve_inner(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let order = self.order(SOLVE);
        let Some(instance) = &mut self.part.instance else {
            return Ok(());
        };
        self.team.order(order.bytes());
        instance.solve(Some(x));
        let (code, detail) = (instance.integer(1), instance.integer(2));
        match code < 0 {
            true => Err(self.failure(code, detail)),
            false => Ok(()),
        }
    }

    /// Whether there is a factor, and so many numbers are columns.
    fn check(&self, x: &[f64]) -> Result<(), EngineError> {
        let (found, expected) = (x.len(), self.pattern.size());
        if !self.is_factorised {
            return Err(EngineError::NotFactorised);
        }
        match found == 0 || (expected > 0 && found % expected == 0) {
            true => Ok(()),
            false => Err(EngineError::Length {
                what: "numbers in columns of a right-hand side",
                found,
                expected,
            }),
        }
    }

    /// Column by column: what one becomes does not depend on the others.
    fn by_column(
        &mut self,
        x: &mut [f64],
        mut of_one: impl FnMut(&mut Self, &mut [f64]) -> Result<(), EngineError>,
    ) -> Result<(), EngineError> {
        self.check(x)?;
        let size = self.pattern.size().max(1);
        x.chunks_exact_mut(size)
            .try_for_each(|column| of_one(self, column))
    }

    /// (f_i, f_c) becomes (K_ii⁻¹ f_i, g).
    fn condense_one(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let first = self.inner();
        let mut inner = x.to_vec();
        inner[first..].fill(0.0);
        self.solve_inner(&mut inner)?;
        x[..first].copy_from_slice(&inner[..first]);
        for &(i, j, k) in &self.coupling {
            x[i as usize] -= k * inner[j as usize];
        }
        Ok(())
    }

    /// (K_ii⁻¹ f_i, u_c) becomes (K_ii⁻¹ (f_i − K_ic u_c), u_c).
    fn expand_one(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let first = self.inner();
        if x[first..].iter().all(|u| *u == 0.0) {
            return Ok(());
        }
        let mut inner = vec![0.0; x.len()];
        for &(i, j, k) in &self.coupling {
            inner[j as usize] += k * x[i as usize];
        }
        self.solve_inner(&mut inner)?;
        let pairs = x[..first].iter_mut().zip(&inner);
        pairs.for_each(|(u, held)| *u -= held);
        Ok(())
    }
}

impl Engine for Mumps {
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        Self::alone(pattern, memory, false)
    }

    fn size(&self) -> usize {
        self.pattern.size()
    }

    fn kept(&self) -> usize {
        self.pattern.kept()
    }

    fn cost(&self) -> Cost {
        self.cost
    }

    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.is_factorised = false;
        self.dense = None;
        self.least_pivot = f64::INFINITY;
        let (found, expected) = (values.len(), self.pattern.entries());
        if found != expected {
            let what = "values";
            return Err(EngineError::Length {
                what,
                found,
                expected,
            });
        }
        self.team.order(self.order(FACTORISE).bytes());
        let bad = values.iter().position(|v| !v.is_finite());
        let others = 1..self.team.size();
        let mut finite = bad.is_none();
        for from in others.clone() {
            finite &= Unpacked::new(&self.team.receive(from)).count() == 1;
        }
        self.team
            .order(Parcel::default().count(usize::from(finite)).bytes());
        if !finite {
            let column = bad.map_or(0, |bad| self.column_of(bad));
            return Err(EngineError::NotFinite { column });
        }
        self.coupling = self.part.coupling(places(&self.pattern), values).collect();
        for from in others {
            let parcel = self.team.receive(from);
            let mut parcel = Unpacked::new(&parcel);
            let (places, values) = (parcel.indices(), parcel.reals());
            let pairs = places.chunks_exact(2).zip(values);
            self.coupling.extend(pairs.map(|(at, k)| (at[0], at[1], k)));
        }
        let first = self.inner();
        self.schur.fill(0.0);
        if !(self.part).factorise(values, Some(self.schur.as_mut_slice())) {
            self.team.refuse("a factorisation of other entries");
        }
        match &self.part.instance {
            // By rows, its lower triangle is the upper one by columns.
            Some(_) => self.schur.fill_lower_triangle_with_upper_triangle(),
            None => {
                for &(i, j, k) in &self.coupling {
                    let (i, j) = (i as usize - first, j as usize - first);
                    self.schur[(i, j)] += k;
                    self.schur[(j, i)] = self.schur[(i, j)];
                }
            }
        }
        self.coupling.retain(|&(_, j, _)| (j as usize) < first);
        let inertia = self.signs()?;
        self.is_factorised = true;
        Ok(inertia)
    }

    fn least_pivot(&self) -> f64 {
        self.least_pivot
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.check(x)?;
        let first = self.inner();
        if first < self.pattern.size() && self.dense.is_none() {
            let singular = EngineError::Singular {
                row: first,
                inertia: Inertia::default(),
            };
            let dense = self.schur.clone().lu();
            let pivots = dense.u().diagonal();
            let least = pivots.amin();
            if least.is_nan() || least <= SINGULAR * pivots.amax() {
                return Err(singular);
            }
            self.dense = Some(dense);
        }
        self.by_column(x, |engine, x| {
            if engine.dense.is_none() {
                return engine.solve_inner(x);
            }
            engine.condense_one(x)?;
            let first = engine.inner();
            if let Some(dense) = &engine.dense {
                let kept = x.len() - first;
                dense.solve_mut(&mut DVectorViewMut::from_slice(&mut x[first..], kept));
            }
            engine.expand_one(x)
        })
    }

    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.by_column(x, Self::condense_one)
    }

    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.by_column(x, Self::expand_one)
    }

    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        match self.is_factorised {
            true => Ok(self.schur.clone()),
            false => Err(EngineError::NotFactorised),
        }
    }
}

impl Drop for Mumps {
    fn drop(&mut self) {
        // The others free theirs; this one goes with the fields.
        self.team.order(self.order(FREE).bytes());
    }
}

/// Engines by what they take, for whoever asks for one by its type.
macro_rules! engines {
    ($($(#[$doc:meta])* $name:ident $definite:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $name(Mumps);

        impl Engine for $name {
            fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
                Mumps::alone(pattern, memory, $definite).map(Self)
            }
            fn size(&self) -> usize {
                self.0.size()
            }
            fn kept(&self) -> usize {
                self.0.kept()
            }
            fn cost(&self) -> Cost {
                self.0.cost()
            }
            fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
                self.0.factorise(values)
            }
            fn least_pivot(&self) -> f64 {
                self.0.least_pivot()
            }
            fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
                self.0.solve(x)
            }
            fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
                self.0.condense(x)
            }
            fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
                self.0.expand(x)
            }
            fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
                self.0.schur()
            }
        }
    )*};
}

engines! {
    /// Of matrices that are positive definite (`sym = 1`), on all processes of MPI.
    Definite true;
    /// Of any symmetric matrix (`sym = 2`), with the signs of its eigenvalues.
    Indefinite false;
}

/// What another process than the first does where there is nothing but engines: until the first says that it is the
/// end, by an order of no bytes.
pub fn serve(team: &Processes) {
    loop {
        let order = team.receive(0);
        match order.first() {
            Some(&ENGINE) => team.assist(&order, Share::NONE),
            _ => return,
        }
    }
}
