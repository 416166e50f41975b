//! Damaged files: whatever bytes are read, the answer is a mesh or an error, soon and in little
//! memory.

use crate::abaqus::DECK;
use moreau_mesh::{read_abaqus, read_gmsh};

/// A generator of numbers, the same ones in each run.
struct Numbers(u64);

impl Numbers {
    /// A number below `end` > 0.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % end as u64) as usize
    }
}

/// The bytes, cut short, or with some of them changed, or with lines deleted or repeated.
fn damaged(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=numbers.below(3) {
        if bytes.is_empty() {
            return bytes;
        }
        let at = numbers.below(bytes.len());
        let lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
        let line = numbers.below(lines.len());
        match numbers.below(6) {
            0 => bytes.truncate(at),
            1 => bytes[at] ^= 1 << numbers.below(8),
            2 => bytes[at] = numbers.below(256) as u8,
            3 => bytes[at] = b"0123456789-.,*$ \n"[numbers.below(17)],
            4 => bytes = [&lines[..line], &lines[line + 1..]].concat().concat(),
            _ => {
                bytes = [&lines[..line], &lines[line..=line], &lines[line..]]
                    .concat()
                    .concat()
            }
        }
    }
    bytes
}

const FILES: [&[u8]; 10] = [
    include_bytes!("../data/mixed.2a.msh"),
    include_bytes!("../data/mixed.2b.msh"),
    include_bytes!("../data/mixed.4a.msh"),
    include_bytes!("../data/mixed.4b.msh"),
    include_bytes!("../data/hex8.2a.msh"),
    include_bytes!("../data/hex8.2b.msh"),
    include_bytes!("../data/hex8.4a.msh"),
    include_bytes!("../data/hex8.4b.msh"),
    include_bytes!("../data/partitioned.4a.msh"),
    include_bytes!("../data/partitioned.4b.msh"),
];

#[test]
fn damaged_files_of_gmsh() {
    let mut numbers = Numbers(1);
    let (mut read, mut refused) = (0, 0);
    for file in FILES {
        for _ in 0..200 {
            let file = damaged(file, &mut numbers);
            let (plane, solid) = (read_gmsh::<2>(&file), read_gmsh::<3>(&file));
            if plane.is_ok() || solid.is_ok() {
                read += 1;
            } else {
                refused += 1;
            }
            if let Err(error) = plane {
                let text = error.to_string();
                assert!(text.len() < 500, "{text}");
            }
        }
    }
    assert!(
        read > 100 && refused > 100,
        "{read} read, {refused} refused"
    );
}

#[test]
fn damaged_decks() {
    let mut numbers = Numbers(2);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..1000 {
        let deck = damaged(DECK.as_bytes(), &mut numbers);
        let deck = String::from_utf8_lossy(&deck);
        match read_abaqus::<2>(&deck) {
            Ok(_) => read += 1,
            Err(error) => {
                let text = error.to_string();
                assert!(text.len() < 500, "{text}");
                refused += 1;
            }
        }
        assert!(read_abaqus::<3>(&deck).is_err());
    }
    assert!(
        read > 100 && refused > 100,
        "{read} read, {refused} refused"
    );
}

#[test]
fn a_file_cut_short_is_never_a_mesh() {
    for file in [FILES[0], FILES[1], FILES[2], FILES[3]] {
        let whole = file.trim_ascii_end().len();
        for end in 0..whole {
            assert!(read_gmsh::<2>(&file[..end]).is_err(), "cut at {end}");
        }
        assert!(read_gmsh::<2>(&file[..whole]).is_ok());
    }
}
