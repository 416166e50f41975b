//! Work on parts of slices: on all threads of the pool, or without the feature `parallel` one part after the other; not
//! what is done with them, nor how many threads there are.

/// What makes parts of a slice, in either way.
#[cfg(feature = "parallel")]
pub(crate) mod prelude {
    pub(crate) use rayon::prelude::*;
}

/// What makes parts of a slice, in either way: the names are those of the parallel one.
#[cfg(not(feature = "parallel"))]
pub(crate) mod prelude {
    use std::slice::{Chunks, ChunksMut};

    pub(crate) trait ParallelSlice<T> {
        /// Parts of so many entries, the last of what is left.
        fn par_chunks(&self, size: usize) -> Chunks<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_chunks(&self, size: usize) -> Chunks<'_, T> {
            self.chunks(size)
        }
    }

    pub(crate) trait ParallelSliceMut<T> {
        /// Parts of so many entries, the last of what is left.
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T>;
    }

    impl<T> ParallelSliceMut<T> for [T] {
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }

    pub(crate) trait IndexedParallelIterator: Iterator + Sized {
        /// So many at least on a thread: of one there is no less.
        fn with_min_len(self, _least: usize) -> Self {
            self
        }
    }

    impl<I: Iterator> IndexedParallelIterator for I {}
}

/// Threads that work on cells: those of the pool that this is called in, one without the feature `parallel`. Results do
/// not depend on it.
pub fn threads() -> usize {
    #[cfg(feature = "parallel")]
    let count = rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    let count = 1;
    count
}
