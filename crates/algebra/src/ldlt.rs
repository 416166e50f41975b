//! L D Lᵀ = A of sparse symmetric matrices, definite or not, with the signs of their eigenvalues: fronts
//! put together up a tree; not the elimination within one.
//!
//! The multifrontal method of I. S. Duff, J. K. Reid, *ACM Trans. Math. Softw.* 9 (1983) 302-325, on the
//! supernodes of the Cholesky factor: a column without a stable pivot in its own front is delayed to the
//! next. L stays bounded whatever the matrix is, so that the inertia and the residual are right to
//! rounding; a positive definite matrix delays next to nothing.

mod blocks;
mod front;

use faer::Par;
use nalgebra::DMatrix;
use pulp::Arch;
use std::fmt;

use crate::engine::{Cost, Engine, EngineError, Inertia, TooLarge, check_columns, check_values};
use crate::panel::SIDES;
use crate::pattern::Pattern;
use crate::symbolic::Symbolic;
use blocks::Blocks;
use front::{Front, Pivots};

/// L D Lᵀ = P A Pᵀ with pivots of one and of two columns, in the order in which A is given but for the exchanges
/// that stability asks for.
///
/// The unknowns that are kept are not eliminated but by [`solve`](Engine::solve): A_cc may be anything, and so may S.
/// The matrix is scaled by powers of two, rows and columns alike, so that its rows are of size 1. Of rows that
/// have no diagonal, as those of multipliers, that is not the only scale: where they are 10¹³ times as large as the
/// rows that they constrain, these are taken for rounding.
///
/// The memory of an analysis is that of L; the fronts that wait for their parents come on top of it.
pub struct Ldlt {
    symbolic: Symbolic,
    /// Supernodes that receive what others leave, by the others; the last one beyond them is of the kept
    /// unknowns.
    parents: Vec<u32>,
    /// Children before their parents, one family after the other.
    order: Vec<u32>,
    scale: Vec<f64>,
    inner: Blocks,
    /// S of the scaled matrix, its lower triangle.
    schur: DMatrix<f64>,
    /// Its factor, if it was asked for.
    outer: Option<Blocks>,
    room: Room,
    least_pivot: f64,
    factorised: bool,
    par: Par,
    /// Instructions that the processor has.
    arch: Arch,
}

/// What a factorisation needs, kept for the next one.
#[derive(Default)]
struct Room {
    front: Front,
    /// Row of an unknown in the front.
    place: Vec<u32>,
}

/// What a front leaves to its parent.
struct Left {
    /// Unknowns: those delayed, then those below.
    index: Vec<u32>,
    delayed: usize,
    /// Lower triangle, column by column, each from its diagonal on.
    entries: Vec<f64>,
}

impl fmt::Debug for Ldlt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ldlt")
            .field("size", &self.size())
            .field("kept", &self.kept())
            .field("cost", &self.cost())
            .finish_non_exhaustive()
    }
}

impl Ldlt {
    /// On threads of another number than the operations ask for, if one is given.
    pub(crate) fn analyse_for(
        pattern: &Pattern,
        memory: Option<u64>,
        threads: Option<Par>,
    ) -> Result<Self, TooLarge> {
        let symbolic = Symbolic::new(pattern, memory)?;
        let (parents, order) = tree(&symbolic);
        let size = pattern.size();
        Ok(Self {
            parents,
            order,
            scale: vec![1.0; size],
            inner: Blocks::default(),
            schur: DMatrix::zeros(0, 0),
            outer: None,
            room: Room {
                front: Front::default(),
                place: vec![0; size],
            },
            least_pivot: f64::INFINITY,
            factorised: false,
            par: threads.unwrap_or_else(|| symbolic.par()),
            arch: Arch::new(),
            symbolic,
        })
    }

    /// First of the unknowns that are kept.
    fn first_kept(&self) -> usize {
        self.size() - self.kept()
    }

    /// Eliminates all but the kept unknowns.
    fn eliminate(&mut self, values: &[f64], room: &mut Room) -> Result<Inertia, EngineError> {
        self.scale = scales(&self.symbolic.pattern, values);
        self.inner.clear();
        let mut known = Pivots::of(self.size());
        let mut left: Vec<Vec<Left>> = Vec::new();
        left.resize_with(self.parents.len() + 1, Vec::new);
        for k in 0..self.order.len() {
            let s = self.order[k] as usize;
            let children = std::mem::take(&mut left[s]);
            self.assemble(s, &children, values, room);
            drop(children);
            room.front
                .eliminate(false, &mut known, (self.par, self.arch));
            self.keep(&room.front)?;
            left[self.parents[s] as usize].extend(rest(&room.front));
        }
        let children = left.pop().unwrap_or_default();
        self.assemble_kept(&children, values, room);
        room.front
            .eliminate(true, &mut known, (self.par, self.arch));
        self.keep(&room.front)?;
        let (size, kept) = (room.front.size(), self.kept());
        let first = size - kept;
        self.schur = DMatrix::from_fn(kept, kept, |i, j| match i >= j {
            true => room.front.entries[(first + j) * size + first + i],
            false => 0.0,
        });
        self.least_pivot = known.least;
        known.result()
    }

    /// Takes up what was eliminated.
    fn keep(&mut self, front: &Front) -> Result<(), EngineError> {
        let pushed = self.inner.push(front);
        let entries = self.inner.entries() as f64;
        let room = self.symbolic.room;
        if pushed.is_none() || entries > room {
            return Err(TooLarge { entries, room }.into());
        }
        Ok(())
    }

    /// The front of a supernode: its columns of the matrix, and what its children leave.
    fn assemble(&self, s: usize, children: &[Left], values: &[f64], room: &mut Room) {
        let node = self.symbolic.supernode(s);
        let end = (node.start + node.width).min(self.first_kept());
        let Room { front, place } = room;
        front.index.clear();
        front.index.extend((node.start..end).map(|i| i as u32));
        for child in children {
            front.index.extend_from_slice(&child.index[..child.delayed]);
        }
        let complete = front.index.len();
        let below = node.below(end - node.start).map(|i| i as u32);
        front.index.extend(below);
        front.begin(complete);
        for (k, &i) in front.index.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        self.add_columns(node.start..end, values, front, place);
        children.iter().for_each(|child| add(child, front, place));
    }

    /// The last front: what is delayed so far, and the kept unknowns.
    fn assemble_kept(&self, children: &[Left], values: &[f64], room: &mut Room) {
        let (first, size) = (self.first_kept(), self.size());
        let Room { front, place } = room;
        front.index.clear();
        for child in children {
            front.index.extend_from_slice(&child.index[..child.delayed]);
        }
        let complete = front.index.len();
        front.index.extend((first..size).map(|i| i as u32));
        front.begin(complete);
        for (k, &i) in front.index.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        self.add_columns(first..size, values, front, place);
        children.iter().for_each(|child| add(child, front, place));
    }

    /// Adds columns of the scaled matrix.
    fn add_columns(
        &self,
        columns: std::ops::Range<usize>,
        values: &[f64],
        front: &mut Front,
        place: &[u32],
    ) {
        let (pattern, size) = (&self.symbolic.pattern, front.size());
        for j in columns {
            let range = pattern.range(j);
            let at = place[j] as usize * size;
            for (&i, v) in pattern.rows()[range.clone()].iter().zip(&values[range]) {
                let scaled = self.scale[i as usize] * v * self.scale[j];
                front.entries[at + place[i as usize] as usize] += scaled;
            }
        }
    }

    /// Factorises S, once for a factor, and only for those who solve with it.
    fn factorise_schur(&mut self) -> Result<(), EngineError> {
        if self.outer.is_some() {
            return Ok(());
        }
        let (kept, outer) = (self.kept(), self.first_kept()..self.size());
        let mut known = Pivots::of(self.size());
        let front = &mut self.room.front;
        front.index.clear();
        front.index.extend(outer.map(|i| i as u32));
        front.begin(kept);
        front.entries.copy_from_slice(self.schur.as_slice());
        front.eliminate(true, &mut known, (self.par, self.arch));
        known.result()?;
        let mut outer = Blocks::default();
        outer.push(front).ok_or(TooLarge {
            entries: (kept * kept) as f64,
            room: self.symbolic.room,
        })?;
        self.outer = Some(outer);
        Ok(())
    }

    fn check(&self, x: &[f64]) -> Result<usize, EngineError> {
        check_columns(x, self.size())?;
        if !self.factorised {
            return Err(EngineError::NotFactorised);
        }
        Ok((SIDES * self.size()).max(1))
    }

    /// Multiplies some rows of every column by their scales.
    fn scale(&self, rows: std::ops::Range<usize>, x: &mut [f64]) {
        let scale = &self.scale[rows.clone()];
        for x in x.chunks_exact_mut(self.size()) {
            for (x, s) in x[rows.clone()].iter_mut().zip(scale) {
                *x *= s;
            }
        }
    }

    /// Divides the kept rows of every column by their scales, which are powers of two.
    fn unscale_kept(&self, x: &mut [f64]) {
        let first = self.first_kept();
        for x in x.chunks_exact_mut(self.size()) {
            for (x, s) in x[first..].iter_mut().zip(&self.scale[first..]) {
                *x /= s;
            }
        }
    }
}

/// What is left of a front for its parent; nothing if nothing is.
fn rest(front: &Front) -> Option<Left> {
    let (size, done) = (front.size(), front.pivots.len());
    if done == size {
        return None;
    }
    let mut entries = Vec::with_capacity((size - done) * (size - done + 1) / 2);
    for j in done..size {
        entries.extend_from_slice(&front.entries[j * size + j..(j + 1) * size]);
    }
    Some(Left {
        index: front.index[done..].to_vec(),
        delayed: front.complete() - done,
        entries,
    })
}

/// Adds what a child leaves.
fn add(child: &Left, front: &mut Front, place: &[u32]) {
    let size = front.size();
    let mut entries = child.entries.as_slice();
    for (k, &j) in child.index.iter().enumerate() {
        let j = place[j as usize] as usize;
        let (column, others) = entries.split_at(child.index.len() - k);
        entries = others;
        for (&i, v) in child.index[k..].iter().zip(column) {
            let i = place[i as usize] as usize;
            front.entries[i.min(j) * size + i.max(j)] += v;
        }
    }
}

/// Of every supernode the one that receives what it leaves, and all of them children first, families
/// together: what waits to be received is then little.
fn tree(symbolic: &Symbolic) -> (Vec<u32>, Vec<u32>) {
    let count = symbolic.count();
    let first_kept = symbolic.pattern.size() - symbolic.pattern.kept();
    let of = symbolic.supernode_of_columns();
    let inner = |s: usize| symbolic.supernode(s).start < first_kept;
    let parent = |s: usize| {
        let below = symbolic.supernode(s).rows.first();
        let parent = below.map(|&i| of[i as usize] as usize);
        parent.filter(|&p| inner(p)).unwrap_or(count) as u32
    };
    let parents: Vec<u32> = (0..count).map(parent).collect();
    // The last child first: read backwards, that is from the root on.
    let mut children = vec![Vec::new(); count + 1];
    for s in (0..count).filter(|&s| inner(s)) {
        children[parents[s] as usize].push(s as u32);
    }
    let mut stack = children[count].clone();
    let mut order = Vec::with_capacity(count);
    while let Some(s) = stack.pop() {
        order.push(s);
        stack.extend_from_slice(&children[s as usize]);
    }
    order.reverse();
    (parents, order)
}

/// Rounds of scaling, each of which takes the square root of what is left: far more than numbers of any size need.
const ROUNDS: usize = 16;

/// Powers of two by which rows and columns are multiplied, after which the largest entry of a row is about 1
/// (D. Ruiz, RAL-TR-2001-034). A row of zeros keeps its scale.
fn scales(pattern: &Pattern, values: &[f64]) -> Vec<f64> {
    let size = pattern.size();
    let mut scale = vec![1.0; size];
    for _ in 0..ROUNDS {
        let mut largest = vec![0.0f64; size];
        for j in 0..size {
            let range = pattern.range(j);
            for (&i, v) in pattern.rows()[range.clone()].iter().zip(&values[range]) {
                let i = i as usize;
                let scaled = (scale[i] * v * scale[j]).abs();
                largest[i] = largest[i].max(scaled);
                largest[j] = largest[j].max(scaled);
            }
        }
        if largest
            .iter()
            .all(|&v| v == 0.0 || (0.25..=4.0).contains(&v))
        {
            break;
        }
        for (scale, largest) in scale.iter_mut().zip(&largest) {
            if *largest > 0.0 {
                *scale = power_of_two(*scale / largest.sqrt());
            }
        }
    }
    scale
}

/// The power of two at or below a positive number.
fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT)
}

impl Engine for Ldlt {
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        Self::analyse_for(pattern, memory, None)
    }

    fn size(&self) -> usize {
        self.symbolic.pattern.size()
    }

    fn kept(&self) -> usize {
        self.symbolic.pattern.kept()
    }

    fn cost(&self) -> Cost {
        let grown = self.inner.entries() as f64;
        Cost {
            entries: self.symbolic.cost.entries.max(grown),
            ..self.symbolic.cost
        }
    }

    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.factorised = false;
        self.outer = None;
        check_values(values, &self.symbolic.pattern)?;
        let mut room = std::mem::take(&mut self.room);
        let inertia = self.eliminate(values, &mut room);
        self.room = room;
        self.factorised = inertia.is_ok();
        inertia
    }

    fn least_pivot(&self) -> f64 {
        self.least_pivot
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        self.factorise_schur()?;
        let (size, arch) = (self.size(), self.arch);
        for x in x.chunks_mut(at_once) {
            self.scale(0..size, x);
            self.inner.forward(x, size, arch);
            self.inner.divide(x, size);
            if let Some(outer) = &mut self.outer {
                outer.forward(x, size, arch);
                outer.divide(x, size);
                outer.backward(x, size, arch);
            }
            self.inner.backward(x, size, arch);
            self.scale(0..size, x);
        }
        Ok(())
    }

    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        let (size, arch) = (self.size(), self.arch);
        for x in x.chunks_mut(at_once) {
            self.scale(0..size, x);
            self.inner.forward(x, size, arch);
            self.unscale_kept(x);
        }
        Ok(())
    }

    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        let (size, first, arch) = (self.size(), self.first_kept(), self.arch);
        let mut known = Vec::new();
        for x in x.chunks_mut(at_once) {
            self.inner.divide(x, size);
            known.clear();
            known.extend(
                x.chunks_exact(size)
                    .flat_map(|x| x[first..].iter().copied()),
            );
            self.unscale_kept(x);
            self.inner.backward(x, size, arch);
            self.scale(0..first, x);
            // As they were given, to the bit.
            for (x, known) in x
                .chunks_exact_mut(size)
                .zip(known.chunks((size - first).max(1)))
            {
                x[first..].copy_from_slice(known);
            }
        }
        Ok(())
    }

    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        if !self.factorised {
            return Err(EngineError::NotFactorised);
        }
        let scale = &self.scale[self.first_kept()..];
        let entry = |i: usize, j: usize| self.schur[(i.max(j), i.min(j))] / scale[i] / scale[j];
        Ok(DMatrix::from_fn(self.kept(), self.kept(), entry))
    }
}
