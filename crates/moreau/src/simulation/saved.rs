//! A list of numbers as bytes that are whole or known not to be; not what the numbers mean, nor where the bytes
//! are kept.
//!
//! They are the line `moreau checkpoint 9`, the CRC-32 of the resolved deck, that of the numbers and their count,
//! each as 8 bytes, and the numbers as IEEE doubles; all little endian.

use flate2::Crc;

const MAGIC: &[u8] = b"moreau checkpoint 9\n";

/// A state that a simulation cannot take over.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the state cannot be taken over: {0}")]
pub struct RestoreError(pub(super) String);

fn crc(bytes: &[u8]) -> u64 {
    let mut crc = Crc::new();
    crc.update(bytes);
    u64::from(crc.sum())
}

/// Numbers of a resolved deck as bytes.
pub(crate) fn sealed(deck: &str, numbers: &[f64]) -> Vec<u8> {
    let head = MAGIC.len() + 24;
    let mut bytes = Vec::with_capacity(head + 8 * numbers.len());
    bytes.extend(MAGIC);
    bytes.resize(head, 0);
    numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    let words = [
        crc(deck.as_bytes()),
        crc(&bytes[head..]),
        numbers.len() as u64,
    ];
    for (place, word) in bytes[MAGIC.len()..head].chunks_exact_mut(8).zip(words) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

/// The numbers, or why they cannot be used.
pub(crate) fn unsealed(bytes: &[u8], deck: &str) -> Result<Vec<f64>, String> {
    let head = bytes
        .strip_prefix(MAGIC)
        .ok_or("not a checkpoint of this version")?;
    let torn = || format!("torn: {} bytes", bytes.len());
    let (words, body) = head.split_at_checked(24).ok_or_else(torn)?;
    let word = |k: usize| {
        let bytes = words[8 * k..8 * k + 8].iter().rev();
        bytes.fold(0u64, |sum, &b| (sum << 8) | u64::from(b))
    };
    if word(0) != crc(deck.as_bytes()) {
        return Err("of another deck than deck.resolved.toml".into());
    }
    if body.len() as u64 != word(2).saturating_mul(8) || crc(body) != word(1) {
        return Err(torn());
    }
    let number = |b: &[u8]| f64::from_le_bytes(std::array::from_fn(|i| b[i]));
    Ok(body.chunks(8).map(number).collect())
}
