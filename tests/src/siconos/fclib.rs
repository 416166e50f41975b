//! Reader of discrete frictional contact problems in the HDF5 layout of FCLIB; not of its text form.
//!
//! ```text
//! /fclib_local    spacedim  W/  vectors/q  vectors/mu
//! /fclib_global   spacedim  M/  H/  vectors/f  vectors/w  vectors/mu
//! ```
//!
//! A matrix holds m, n, nzmax, nz, p, i and x: triplets if nz ≥ 0 (rows i, columns p), compressed
//! columns if nz = −1, compressed rows if nz = −2. Guesses and solutions are left alone.

use super::{Entries, Global, Problem, SiconosError};
use hdf5::{File, Group, H5Type};
use moreau::contact::{BlockMatrix, LocalProblem};
use moreau::laws::{Coulomb, Local};
use std::path::Path;

/// Reads a problem of either form; the file says which it is.
///
/// # Errors
/// [`SiconosError::Hdf5`] with the object that cannot be read, and those of the problem itself.
pub(super) fn read(path: &Path) -> Result<Problem, SiconosError> {
    let file = File::open(path).map_err(|error| wrong("the file", &error))?;
    if let Ok(group) = file.group("fclib_local") {
        return match dimension(&group)? {
            2 => local(&group).map(Problem::Local2),
            _ => local(&group).map(Problem::Local3),
        };
    }
    let group = file
        .group("fclib_global")
        .map_err(|_| wrong("the file", &"neither /fclib_local nor /fclib_global in it"))?;
    if group.link_exists("G") {
        return Err(wrong(
            "fclib_global/G",
            &"bilateral constraints, expected none",
        ));
    }
    match dimension(&group)? {
        2 => global(&group).map(Problem::Global2),
        _ => global(&group).map(Problem::Global3),
    }
}

fn wrong(object: &str, what: &dyn std::fmt::Display) -> SiconosError {
    SiconosError::Hdf5 {
        object: object.to_owned(),
        what: what.to_string(),
    }
}

/// All numbers of a data set, converted to the type asked for.
fn numbers<T: H5Type>(group: &Group, name: &str) -> Result<Vec<T>, SiconosError> {
    let set = group.dataset(name).and_then(|set| set.read_raw());
    set.map_err(|error| wrong(&format!("{}/{name}", group.name()), &error))
}

fn number(group: &Group, name: &str) -> Result<i64, SiconosError> {
    let all = numbers::<i64>(group, name)?;
    let first = all.first().copied();
    first.ok_or_else(|| {
        wrong(
            &format!("{}/{name}", group.name()),
            &"no number, expected one",
        )
    })
}

fn dimension(group: &Group) -> Result<i64, SiconosError> {
    match number(group, "spacedim")? {
        dimension @ (2 | 3) => Ok(dimension),
        other => Err(wrong("spacedim", &format!("{other}, expected 2 or 3"))),
    }
}

fn within(group: &Group, name: &str) -> Result<Group, SiconosError> {
    let found = group.group(name);
    found.map_err(|error| wrong(&format!("{}/{name}", group.name()), &error))
}

fn friction(vectors: &Group) -> Result<Vec<Coulomb>, SiconosError> {
    let all = numbers::<f64>(vectors, "mu")?;
    Ok(all
        .into_iter()
        .map(Coulomb::new)
        .collect::<Result<_, _>>()?)
}

/// A vector over the contacts.
fn locals<const D: usize>(vectors: &Group, name: &str) -> Result<Vec<Local<D>>, SiconosError> {
    let all = numbers::<f64>(vectors, name)?;
    if all.len() % D != 0 {
        let what = format!("{} numbers, expected a multiple of {D}", all.len());
        return Err(wrong(name, &what));
    }
    Ok(all.chunks_exact(D).map(Local::from_column_slice).collect())
}

fn local<const D: usize>(group: &Group) -> Result<LocalProblem<D>, SiconosError> {
    let vectors = within(group, "vectors")?;
    let friction = friction(&vectors)?;
    let entries = matrix(group, "W", [D * friction.len(); 2])?;
    let operator = BlockMatrix::from_entries(friction.len(), entries);
    Ok(LocalProblem::new(
        operator,
        locals(&vectors, "q")?,
        friction,
    )?)
}

fn global<const D: usize>(group: &Group) -> Result<Global<D>, SiconosError> {
    let vectors = within(group, "vectors")?;
    let friction = friction(&vectors)?;
    let load = numbers::<f64>(&vectors, "f")?;
    let n = load.len();
    let mut stiffness = matrix(group, "M", [n; 2])?;
    // Some writers store one triangle only, and do not say so. A stiffness that is triangular without
    // being diagonal would not be symmetric, as stiffnesses and masses are.
    let coupled = stiffness.iter().any(|(i, j, _)| i != j);
    let upper = stiffness.iter().all(|(i, j, _)| i <= j);
    let lower = stiffness.iter().all(|(i, j, _)| i >= j);
    if coupled && (upper || lower) {
        let other: Entries = (stiffness.iter())
            .filter(|(i, j, _)| i != j)
            .map(|&(i, j, v)| (j, i, v))
            .collect();
        stiffness.extend(other);
    }
    Ok(Global {
        stiffness,
        directions: matrix(group, "H", [n, D * friction.len()])?,
        load,
        free: locals(&vectors, "w")?,
        friction,
    })
}

/// Entries of a matrix whose size is known.
fn matrix(group: &Group, name: &str, expected: [usize; 2]) -> Result<Entries, SiconosError> {
    let group = within(group, name)?;
    let object = group.name();
    let sizes = [number(&group, "m")?, number(&group, "n")?];
    if sizes != expected.map(|size| size as i64) {
        let [m, n] = expected;
        let what = format!("{} × {}, expected {m} × {n}", sizes[0], sizes[1]);
        return Err(wrong(&object, &what));
    }
    let stored = number(&group, "nz")?;
    let (p, i) = (numbers::<i64>(&group, "p")?, numbers::<i64>(&group, "i")?);
    let x = numbers::<f64>(&group, "x")?;
    let outside = |what: &str| wrong(&object, &format!("an index beyond the {what}"));
    let place = |k: i64, size: usize| usize::try_from(k).ok().filter(|k| *k < size);
    let mut entries = Entries::new();
    if stored >= 0 {
        for k in 0..stored as usize {
            let (Some(&row), Some(&column), Some(&value)) = (i.get(k), p.get(k), x.get(k)) else {
                return Err(outside("stored entries"));
            };
            let row = place(row, expected[0]).ok_or_else(|| outside("rows"))?;
            let column = place(column, expected[1]).ok_or_else(|| outside("columns"))?;
            entries.push((row, column, value));
        }
        return Ok(entries);
    }
    // By columns or by rows: `major` runs over what is compressed.
    let [major, minor] = match stored {
        -1 => [expected[1], expected[0]],
        -2 => expected,
        other => {
            let what = format!("nz = {other}, expected -2, -1 or a number of triplets");
            return Err(wrong(&object, &what));
        }
    };
    if p.len() <= major {
        return Err(outside("starts"));
    }
    for (line, ends) in p[..=major].windows(2).enumerate() {
        for k in ends[0]..ends[1] {
            let k = place(k, x.len().min(i.len())).ok_or_else(|| outside("stored entries"))?;
            let other = place(i[k], minor).ok_or_else(|| outside("rows or columns"))?;
            entries.push(match stored {
                -1 => (other, line, x[k]),
                _ => (line, other, x[k]),
            });
        }
    }
    Ok(entries)
}
