//! What a page calls, by names of C: bytes of a text go in, bytes of a text come out. Nothing is computed here.
//!
//! `room(n)` makes room for `n` bytes and tells where; then `open()`, `advance()`, `outcome()` leave a text of
//! `length()` bytes at `text()`, which the next call overwrites.
#![expect(unsafe_code)] // The names, which no other function of a module may have.

use crate::Course;
use std::cell::RefCell;

/// What is kept between calls: pages call a module on one thread.
struct Kept {
    given: Vec<u8>,
    told: String,
    course: Option<Course>,
}

thread_local! {
    static KEPT: RefCell<Kept> = const {
        RefCell::new(Kept { given: Vec::new(), told: String::new(), course: None })
    };
}

fn kept<T>(what: impl FnOnce(&mut Kept) -> T) -> T {
    KEPT.with_borrow_mut(what)
}

/// Room for a text of so many bytes that is to be given; where it begins.
#[unsafe(no_mangle)]
extern "C" fn room(bytes: usize) -> *mut u8 {
    kept(|kept| {
        kept.given = vec![0; bytes];
        kept.given.as_mut_ptr()
    })
}

/// Opens the deck that was given: 1, or 0 with what is wrong with it as text.
#[unsafe(no_mangle)]
extern "C" fn open() -> u32 {
    kept(|kept| {
        kept.course = None;
        match Course::open(&String::from_utf8_lossy(&kept.given)) {
            Ok(course) => {
                (kept.course, kept.told) = (Some(course), String::new());
                1
            }
            Err(refused) => {
                kept.told = refused;
                0
            }
        }
    })
}

/// Applies the next increment: 1 with what there is to tell of it, 0 where there is none.
#[unsafe(no_mangle)]
extern "C" fn advance() -> u32 {
    kept(|kept| {
        let told = kept.course.as_mut().and_then(Course::advance);
        let goes_on = u32::from(told.is_some());
        kept.told = told.unwrap_or_default();
        goes_on
    })
}

/// Tells how it stands; nothing without a deck.
#[unsafe(no_mangle)]
extern "C" fn outcome() {
    kept(|kept| {
        kept.told = kept
            .course
            .as_ref()
            .map_or_else(String::new, Course::outcome)
    });
}

/// Where the text begins that was told last.
#[unsafe(no_mangle)]
extern "C" fn text() -> *const u8 {
    kept(|kept| kept.told.as_ptr())
}

/// Its bytes.
#[unsafe(no_mangle)]
extern "C" fn length() -> usize {
    kept(|kept| kept.told.len())
}
