//! The calls of C that MPI and MUMPS are reached by: all `unsafe` of the workspace; no logic.
#![allow(unsafe_code)]

use std::ffi::c_int;
use std::ptr::{NonNull, null_mut};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The structure of MUMPS, which only C looks into.
#[repr(C)]
struct Structure {
    _private: [u8; 0],
}

unsafe extern "C" {
    fn moreau_mpi_begin(rank: *mut c_int, size: *mut c_int) -> c_int;
    fn moreau_mpi_end();
    fn moreau_mpi_abort(status: c_int);
    fn moreau_mpi_send(to: c_int, bytes: *const u8, length: u64);
    fn moreau_mpi_await(from: c_int) -> u64;
    fn moreau_mpi_receive(from: c_int, bytes: *mut u8, length: u64);
    fn moreau_mumps_new(sym: c_int) -> *mut Structure;
    fn moreau_mumps_free(m: *mut Structure);
    fn moreau_mumps_set_integer(m: *mut Structure, which: c_int, value: c_int);
    fn moreau_mumps_set_real(m: *mut Structure, which: c_int, value: f64);
    fn moreau_mumps_integer(m: *const Structure, which: c_int) -> c_int;
    fn moreau_mumps_real(m: *const Structure, which: c_int) -> f64;
    fn moreau_mumps_analyse(
        m: *mut Structure,
        n: c_int,
        entries: i64,
        rows: *mut c_int,
        columns: *mut c_int,
        kept: c_int,
        list: *mut c_int,
        order: *mut c_int,
    );
    fn moreau_mumps_factorise(m: *mut Structure, values: *const f64, schur: *mut f64, kept: c_int);
    fn moreau_mumps_solve(m: *mut Structure, x: *mut f64, n: c_int);
    fn moreau_mumps_null_pivot(m: *const Structure) -> c_int;
}

/// Held during every call: MUMPS keeps variables of the whole program, and MPI was told that calls come one at a
/// time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins MPI: number of this process and of all; `None` where threads may not call it in turn.
pub(crate) fn begin() -> Option<(usize, usize)> {
    let (mut rank, mut size) = (0, 0);
    let _alone = alone();
    // SAFETY: two places to write an integer to, which outlive the call; a second beginning is none.
    let refused = unsafe { moreau_mpi_begin(&mut rank, &mut size) };
    (refused == 0).then_some((rank as usize, size as usize))
}

/// Ends MPI; nothing may be called after it.
pub(crate) fn end() {
    let _alone = alone();
    // SAFETY: takes nothing; C sees to it that a second end is none.
    unsafe { moreau_mpi_end() }
}

/// Ends all processes.
pub(crate) fn abort(status: u8) {
    // Another thread may be within a call for ever: none is waited for.
    // SAFETY: takes a number; it does not return.
    unsafe { moreau_mpi_abort(c_int::from(status)) }
}

pub(crate) fn send(to: usize, bytes: &[u8]) {
    let _alone = alone();
    // SAFETY: as many bytes are read as the slice has, which outlives the call.
    unsafe { moreau_mpi_send(to as c_int, bytes.as_ptr(), bytes.len() as u64) }
}

pub(crate) fn receive(from: usize) -> Vec<u8> {
    let _alone = alone();
    // SAFETY: takes a number; it returns once a length has come.
    let length = unsafe { moreau_mpi_await(from as c_int) };
    let mut bytes = vec![0; length as usize];
    // SAFETY: as many bytes are written as the vector has.
    unsafe { moreau_mpi_receive(from as c_int, bytes.as_mut_ptr(), length) }
    bytes
}

/// An instance of MUMPS, a part of which is on every process: what is called on one must be called on all.
#[derive(Debug)]
pub(crate) struct Instance {
    raw: NonNull<Structure>,
    /// Rows, columns, kept unknowns and order, counted from 1: MUMPS keeps their addresses.
    places: [Vec<c_int>; 4],
    size: usize,
}

// SAFETY: the structure belongs to this value alone, nothing in it is bound to a thread, and calls are one at a
// time whoever makes them.
unsafe impl Send for Instance {}
// SAFETY: what takes `&self` only reads numbers that no call changes meanwhile: those that do take `&mut self`.
unsafe impl Sync for Instance {}

impl Instance {
    /// For matrices that are positive definite (1) or any symmetric (2); `None` without memory.
    pub(crate) fn new(sym: i32) -> Option<Self> {
        let _alone = alone();
        // SAFETY: takes a number, and gives an address of its own or none.
        let raw = NonNull::new(unsafe { moreau_mumps_new(sym) })?;
        Some(Self {
            raw,
            places: [const { Vec::new() }; 4],
            size: 0,
        })
    }

    /// A control by its number in the manual.
    pub(crate) fn set_integer(&mut self, which: i32, value: i32) {
        debug_assert!((1..=60).contains(&which));
        // SAFETY: the address is one that `new` gave, and the array has 60 of them.
        unsafe { moreau_mumps_set_integer(self.raw.as_ptr(), which, value) }
    }

    /// A real control by its number.
    pub(crate) fn set_real(&mut self, which: i32, value: f64) {
        debug_assert!((1..=15).contains(&which));
        // SAFETY: the address is one that `new` gave, and the array has 15 of them.
        unsafe { moreau_mumps_set_real(self.raw.as_ptr(), which, value) }
    }

    /// What is told of all processes, by its number.
    pub(crate) fn integer(&self, which: i32) -> i32 {
        debug_assert!((1..=80).contains(&which));
        // SAFETY: the address is one that `new` gave, and the array has 80 of them.
        unsafe { moreau_mumps_integer(self.raw.as_ptr(), which) }
    }

    /// Real numbers of the same.
    pub(crate) fn real(&self, which: i32) -> f64 {
        debug_assert!((1..=40).contains(&which));
        // SAFETY: the address is one that `new` gave, and the array has 40 of them.
        unsafe { moreau_mumps_real(self.raw.as_ptr(), which) }
    }

    /// The first row whose pivot is zero, where some is; on the first process.
    pub(crate) fn null_pivot(&self) -> Option<usize> {
        // SAFETY: the address is one that `new` gave; C looks whether there is a list.
        let row = unsafe { moreau_mumps_null_pivot(self.raw.as_ptr()) };
        usize::try_from(row).ok()?.checked_sub(1)
    }

    /// Analyses a matrix of so many rows, of which this process has entries (row, column), counted from 0. The last
    /// unknowns are kept; the order is that of the rows, or of MUMPS.
    pub(crate) fn analyse(
        &mut self,
        size: usize,
        entries: impl Iterator<Item = (u32, u32)>,
        kept: usize,
        as_given: bool,
    ) {
        let _alone = alone();
        let (rows, columns) = entries
            .map(|(i, j)| (i as c_int + 1, j as c_int + 1))
            .unzip();
        let last = (size - kept + 1..=size).map(|k| k as c_int).collect();
        let order = match as_given {
            true => (1..=size as c_int).collect(),
            false => Vec::new(),
        };
        self.places = [rows, columns, last, order];
        self.size = size;
        let count = self.places[0].len() as i64;
        let [rows, columns, list, order] = self.places.each_mut().map(Vec::as_mut_ptr);
        let order = if as_given { order } else { null_mut() };
        // SAFETY: rows and columns are `count` integers, the list `kept` and the order, where one is given, `size`;
        // they live as long as the instance, and are not touched again before the next analysis.
        unsafe {
            moreau_mumps_analyse(
                self.raw.as_ptr(),
                size as c_int,
                count,
                rows,
                columns,
                kept as c_int,
                list,
                order,
            );
        }
    }

    /// Factorises the values of the analysed entries; the Schur complement is written on the first process, which gives
    /// room for it, both triangles. Values that are not as many as the entries are not looked at, nor is room that
    /// is not as large: false.
    pub(crate) fn factorise(&mut self, values: &[f64], schur: Option<&mut [f64]>) -> bool {
        let kept = self.places[2].len();
        let fits = schur.as_ref().is_none_or(|s| s.len() == kept * kept);
        if values.len() != self.places[0].len() || !fits {
            return false;
        }
        let _alone = alone();
        let schur = schur.filter(|s| !s.is_empty());
        let schur = schur.map_or(null_mut(), |s| s.as_mut_ptr());
        // SAFETY: there are as many values as entries were analysed, which are only read, and room for kept × kept
        // numbers or no address; C forgets both after the call.
        unsafe {
            moreau_mumps_factorise(self.raw.as_ptr(), values.as_ptr(), schur, kept as c_int);
        }
        true
    }

    /// Solves for one right-hand side, which the first process gives and gets; the others give nothing. False where
    /// it has not as many numbers as there are rows.
    pub(crate) fn solve(&mut self, x: Option<&mut [f64]>) -> bool {
        let x = match x {
            Some(x) if x.len() != self.size => return false,
            Some(x) => x.as_mut_ptr(),
            None => null_mut(),
        };
        let _alone = alone();
        // SAFETY: on the first process there is a number for each row, which C forgets after the call; on the others
        // MUMPS does not look at it.
        unsafe { moreau_mumps_solve(self.raw.as_ptr(), x, self.size as c_int) }
        true
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        let _alone = alone();
        // SAFETY: the address is one that `new` gave, and this is the last call with it.
        unsafe { moreau_mumps_free(self.raw.as_ptr()) }
    }
}
