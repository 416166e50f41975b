//! What the pattern of a matrix says of its factor: supernodes, their rows, and what they cost; no
//! values.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};

use crate::engine::{Cost, TooLarge};
use crate::pattern::Pattern;

/// Operations from which on L D Lᵀ is made on all threads: some seconds, for in each dense product threads have to
/// wait for each other, and on a busy machine long.
const PARALLEL: f64 = 1e11;

/// All threads of the pool, where there are threads.
fn all() -> Par {
    #[cfg(feature = "parallel")]
    let par = Par::rayon(0);
    #[cfg(not(feature = "parallel"))]
    let par = Par::Seq;
    par
}

/// Elimination tree of a pattern, and the number of entries of every column of its factor.
struct Columns<'a> {
    upper: SymbolicSparseColMat<u32>,
    tree: simplicial::EliminationTreeRef<'a, u32>,
    counts: &'a [u32],
    /// Room for the analysis.
    memory: &'a mut MemStack,
}

impl Columns<'_> {
    /// Hands them on; `None` where not even the indices have room.
    fn of<T>(pattern: &Pattern, then: impl FnOnce(Columns<'_>) -> T) -> Option<T> {
        let n = pattern.size();
        let upper = pattern.transposed();
        let request = StackReq::or(
            simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, pattern.entries()),
            supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n),
        );
        let mut memory = MemBuffer::try_new(request).ok()?;
        let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
        let tree = simplicial::prefactorize_symbolic_cholesky(
            &mut tree,
            &mut counts,
            upper.as_ref(),
            MemStack::new(&mut memory),
        );
        Some(then(Columns {
            upper,
            tree,
            counts: &counts,
            memory: MemStack::new(&mut memory),
        }))
    }

    fn cost(&self) -> Cost {
        let counts = || self.counts.iter().map(|&count| f64::from(count));
        Cost {
            entries: counts().sum(),
            operations: counts().map(|count| count * count).sum(),
        }
    }
}

impl Cost {
    /// What the factor of a pattern takes, all of its unknowns eliminated in their order.
    pub fn of(pattern: &Pattern) -> Self {
        let no_room = Self {
            entries: f64::INFINITY,
            operations: f64::INFINITY,
        };
        Columns::of(pattern, |columns| columns.cost()).unwrap_or(no_room)
    }
}

/// A symbolic factorisation.
#[derive(Debug)]
pub(crate) struct Symbolic {
    pub(crate) pattern: Pattern,
    pub(crate) supernodes: supernodal::SymbolicSupernodalCholesky<u32>,
    /// With the zeros that make the columns of a supernode alike.
    pub(crate) cost: Cost,
    /// Entries that there is room for.
    pub(crate) room: f64,
}

/// Columns of a factor that have the same rows below them.
pub(crate) struct Supernode<'a> {
    /// First column.
    pub(crate) start: usize,
    /// Number of columns.
    pub(crate) width: usize,
    /// Rows below, ascending.
    pub(crate) rows: &'a [u32],
    /// Where its values are, column by column, in a factor of all supernodes.
    pub(crate) values: std::ops::Range<usize>,
}

impl Supernode<'_> {
    /// Its rows from that of a column on, the rows below all of them included.
    #[inline]
    pub(crate) fn below(&self, column: usize) -> impl Iterator<Item = usize> + Clone {
        let own = self.start + column..self.start + self.width;
        own.chain(self.rows.iter().map(|&i| i as usize))
    }
}

impl Symbolic {
    /// Of a factor that may take `memory` \[bytes\].
    pub(crate) fn new(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        let by_memory = memory.map_or(f64::INFINITY, |bytes| {
            bytes as f64 / size_of::<f64>() as f64
        });
        // Positions of entries are 32-bit numbers.
        let room = by_memory.min(f64::from(u32::MAX));
        let too_large = |entries: f64| TooLarge { entries, room };
        let analysed = Columns::of(pattern, |columns| {
            let cost = columns.cost();
            if cost.entries > room {
                return Err(too_large(cost.entries));
            }
            let supernodes = supernodal::factorize_supernodal_symbolic_cholesky(
                columns.upper.as_ref(),
                columns.tree,
                columns.counts,
                columns.memory,
                Default::default(),
            );
            let supernodes = supernodes.map_err(|_| too_large(cost.entries))?;
            Ok((supernodes, cost.operations))
        });
        let (supernodes, operations) = analysed.ok_or(too_large(pattern.size() as f64))??;
        let entries = supernodes.len_val() as f64;
        if entries > room {
            return Err(too_large(entries));
        }
        Ok(Self {
            pattern: pattern.clone(),
            supernodes,
            cost: Cost {
                entries,
                operations,
            },
            room,
        })
    }

    /// Threads for L D Lᵀ.
    pub(crate) fn par(&self) -> Par {
        match self.cost.operations > PARALLEL {
            true => all(),
            false => Par::Seq,
        }
    }

    /// Of every column the supernode that it is in.
    pub(crate) fn supernode_of_columns(&self) -> Vec<u32> {
        let mut of = vec![0; self.pattern.size()];
        for s in 0..self.count() {
            let node = self.supernode(s);
            of[node.start..node.start + node.width].fill(s as u32);
        }
        of
    }

    pub(crate) fn count(&self) -> usize {
        self.supernodes.n_supernodes()
    }

    /// Rows below all supernodes before one.
    #[inline]
    pub(crate) fn rows_before(&self, s: usize) -> usize {
        self.supernodes.col_ptr_for_row_idx()[s] as usize
    }

    #[inline]
    pub(crate) fn supernode(&self, s: usize) -> Supernode<'_> {
        let all = &self.supernodes;
        let (start, end) = (all.supernode_begin()[s], all.supernode_end()[s]);
        let (at, of) = (all.col_ptr_for_val(), all.col_ptr_for_row_idx());
        Supernode {
            start: start as usize,
            width: (end - start) as usize,
            rows: &all.row_idx()[of[s] as usize..of[s + 1] as usize],
            values: at[s] as usize..at[s + 1] as usize,
        }
    }
}
