//! A directory of results, which one process writes at a time, and of which deck they are; not what
//! is in them.

use super::files::read_text;
use super::{CHECKPOINTS, RESOLVED, RUN, RunError, checkpoint, vtu};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Seek, Write};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// The file that is locked. It tells of which deck the results are, and which process writes them or
/// wrote them last.
const LOCK: &str = "run.lock";
/// Far more than it takes to sign.
const SIGNING: Duration = Duration::from_millis(100);
/// What else a run writes under one name.
const FILES: [&str; 9] = [
    RESOLVED,
    RUN,
    "history.csv",
    "contact.csv",
    "log.jsonl",
    "report.html",
    "history.svg",
    "contact.svg",
    "deformed.svg",
];

/// A directory of results that this process alone writes, until the value is dropped or the process
/// ends in whatever way: the lock is the system's, and no file has to be removed.
#[derive(Debug)]
pub struct Directory {
    path: PathBuf,
    lock: File,
    exclusive: bool,
}

impl Directory {
    /// Takes a directory, which is made if need be, for whatever it holds.
    ///
    /// # Errors
    /// [`RunError::Taken`] if another process writes there; [`RunError::Write`].
    pub fn take(path: &Path) -> Result<Self, RunError> {
        let write = |path: &Path, source| RunError::Write {
            path: path.to_owned(),
            source,
        };
        if path.exists() && !path.is_dir() {
            let file = std::io::Error::other("this is a file, results need a directory");
            return Err(write(path, file));
        }
        fs::create_dir_all(path).map_err(|source| write(path, source))?;
        let at = path.join(LOCK);
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true);
        let lock = options.truncate(false).open(&at);
        let lock = lock.map_err(|source| write(&at, source))?;
        let exclusive = match lock.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => {
                let (path, by) = (path.to_owned(), holder(&at));
                return Err(RunError::Taken { path, by });
            }
            // Some file systems know no locks.
            Err(TryLockError::Error(_)) => false,
        };
        let taken = Self {
            path: path.to_owned(),
            lock,
            exclusive,
        };
        taken.sign(recorded(path).as_deref())?;
        Ok(taken)
    }

    /// Takes a directory for the results of a deck's file. Those of the same file are overwritten,
    /// whatever has changed in it; others, and files that no run wrote, only if forced.
    ///
    /// # Errors
    /// [`RunError::NotOurs`] before anything is changed; those of [`Directory::take`].
    pub fn take_for(path: &Path, deck: &Path, forced: bool) -> Result<Self, RunError> {
        if !forced {
            refuse_others(path, deck)?;
        }
        let taken = Self::take(path)?;
        if !forced {
            // Another process may have been there in between.
            refuse_others(path, deck)?;
        }
        taken.sign(Some(&relative(deck, path)))?;
        Ok(taken)
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether others are kept out: not where the file system knows no locks.
    pub fn is_exclusive(&self) -> bool {
        self.exclusive
    }

    /// Writes down of which deck the results are, and who writes them.
    fn sign(&self, deck: Option<&str>) -> Result<(), RunError> {
        let mut text = deck.map_or(String::new(), |deck| format!("deck {deck}\n"));
        let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let host = match host.trim() {
            "" => String::new(),
            name => format!(" on {name}"),
        };
        text.push_str(&format!("process {}{host}\n", std::process::id()));
        // At no moment is it empty: others read it.
        let mut file = &self.lock;
        let written = file
            .rewind()
            .and_then(|()| file.write_all(text.as_bytes()))
            .and_then(|()| file.set_len(text.len() as u64));
        written.map_err(|source| RunError::Write {
            path: self.path.join(LOCK),
            source,
        })
    }
}

/// Who holds a lock, and for how long, as far as its file tells.
fn holder(lock: &Path) -> String {
    let mut text = String::new();
    // It may have taken the lock a moment ago, and not signed yet.
    for _ in 0..10 {
        std::thread::sleep(SIGNING);
        text = read_text(lock).unwrap_or_default();
        if text.contains("process ") {
            break;
        }
    }
    let process = text.lines().find(|l| l.starts_with("process "));
    let since = fs::metadata(lock).and_then(|m| m.modified());
    let since = since.ok().and_then(|t| t.elapsed().ok());
    let since = since.map_or(String::new(), |t| format!(", for {}", span(t)));
    format!("{}{since}", process.unwrap_or("another process"))
}

fn span(time: Duration) -> String {
    match time.as_secs() {
        s @ 0..120 => format!("{s} s"),
        s @ 120..7200 => format!("{} min", s / 60),
        s => format!("{} h", s / 3600),
    }
}

/// The deck whose results a directory holds, relative to it.
fn recorded(directory: &Path) -> Option<String> {
    let text = read_text(&directory.join(LOCK)).ok()?;
    let deck = text.lines().find_map(|l| l.strip_prefix("deck "));
    deck.map(str::to_owned)
}

/// An error if a directory holds what a run of a deck would overwrite or remove, and is not that
/// deck's.
fn refuse_others(directory: &Path, deck: &Path) -> Result<(), RunError> {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
    let ours = |name: &String| FILES.contains(&&**name) || name == vtu::LIST || vtu::is_ours(name);
    let checkpoint = checkpoint::list(&directory.join(CHECKPOINTS));
    let file = names.filter(ours).min().map(|name| directory.join(name));
    let Some(file) = file.or(checkpoint.into_iter().next()) else {
        return Ok(());
    };
    // Read after the files were seen: who writes here at this moment has signed before them.
    let recorded = recorded(directory);
    if recorded.as_deref() == Some(&*relative(deck, directory)) {
        return Ok(());
    }
    Err(RunError::NotOurs {
        file,
        deck: recorded.map(|deck| directory.join(deck)),
    })
}

/// A deck's path seen from a directory, so that it stays the same when both are moved.
fn relative(deck: &Path, directory: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().or(std::path::absolute(path));
    let (Ok(deck), Ok(directory)) = (whole(deck), whole(directory)) else {
        return deck.display().to_string();
    };
    let (to, from): (Vec<_>, Vec<_>) = (
        deck.components().collect(),
        directory.components().collect(),
    );
    let common = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = from[common..].iter().map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to[common..].iter().copied()).collect();
    path.to_string_lossy().replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty(name: &str) -> PathBuf {
        let name = format!("moreau-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        // Nothing may be there yet.
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a directory");
        path
    }

    #[test]
    fn one_at_a_time_and_the_next_when_the_first_is_gone() {
        let at = empty("lock");
        let first = Directory::take(&at).expect("free");
        assert!(first.is_exclusive());
        let second = Directory::take(&at).expect_err("taken").to_string();
        let own = format!("process {}", std::process::id());
        assert!(second.contains(&own) && second.contains(" s"), "{second}");
        drop(first);
        Directory::take(&at).expect("free again");
        // Of a process that is no more, which left its file: no lock.
        fs::write(at.join(LOCK), "deck a.toml\nprocess 1 on here\n").expect("written");
        drop(Directory::take(&at).expect("free"));
        assert_eq!(recorded(&at).as_deref(), Some("a.toml"));
        fs::remove_dir_all(&at).expect("removed");
    }

    #[test]
    fn results_are_overwritten_by_their_own_deck_alone() {
        let at = empty("owner");
        let decks = ["a.toml", "b.toml"].map(|name| at.join(name));
        decks
            .iter()
            .for_each(|d| fs::write(d, "").expect("written"));
        let to = at.join("results");
        let mine = |deck: usize, forced| Directory::take_for(&to, &decks[deck], forced).map(|_| ());
        mine(0, false).expect("nothing is there");
        // No results yet: anybody may.
        mine(1, false).expect("nothing is lost");
        fs::write(to.join("history.csv"), "").expect("written");
        mine(1, false).expect("its own");
        let before = fs::read_to_string(to.join(LOCK)).expect("a record");
        let told = mine(0, false).expect_err("of another deck").to_string();
        let words = ["history.csv", "b.toml", "--force"];
        assert!(words.iter().all(|w| told.contains(w)), "{told}");
        assert_eq!(fs::read_to_string(to.join(LOCK)).expect("a record"), before);
        mine(0, true).expect("forced");
        mine(0, false).expect("its own now");
        // Moved together, deck and results still belong together.
        let moved = empty("moved");
        fs::remove_dir(&moved).expect("empty");
        fs::rename(&at, &moved).expect("moved");
        Directory::take_for(&moved.join("results"), &moved.join("a.toml"), false).expect("its own");
        fs::remove_dir_all(&moved).expect("removed");
    }

    #[test]
    fn files_that_no_run_wrote_are_left_alone() {
        for name in ["run.json", "body_00001.vtu", "report.html", "result.pvd"] {
            let at = empty("foreign");
            let deck = at.join("deck.toml");
            fs::write(&deck, "").expect("written");
            fs::write(at.join("notes.txt"), "").expect("written");
            fs::write(at.join("body_of_mine.vtu"), "").expect("written");
            drop(Directory::take_for(&at, &deck, false).expect("nothing is overwritten"));
            fs::remove_file(at.join(LOCK)).expect("removed");
            fs::write(at.join(name), "mine").expect("written");
            let told = Directory::take_for(&at, &deck, false).expect_err("not ours");
            assert!(told.to_string().contains(name), "{told}");
            assert!(!at.join(LOCK).exists(), "left behind");
            fs::remove_dir_all(&at).expect("removed");
        }
    }
}
