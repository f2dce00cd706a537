//! The episodes inside the page of a run, packed.

use std::io::Write;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

use super::data::Data;
use crate::Error;
use crate::record::event;
use crate::record::reader::Recording;

/// The maximum size of the recordings that a page is made of, in bytes: of one episode and of all.
/// A page takes about a sixth of it.
const MOST_OF_ONE: u64 = 512 << 10;
const MOST_OF_ALL: u64 = 12 << 20;
/// The maximum size of all packed episodes of a page, in bytes.
const MOST_PACKED: u64 = 2_500_000;

/// An episode in a page.
#[derive(Debug, Serialize)]
pub struct PackedEpisode {
    pub episode: u32,
    /// The data of the episode as JSON, compressed with zlib, in base64.
    data: String,
}

/// Packs the recordings of a run's episodes, in order. If they are too large for a page, packs
/// every second one, or every fourth, and so on, and the last one; the `wanted` episodes are thinned
/// out last. Episodes that are too large on their own are omitted.
///
/// # Errors
/// If a recording cannot be read.
pub fn packed(files: &[PathBuf], wanted: &[u32]) -> Result<Vec<PackedEpisode>, Error> {
    let size = |file: &Path| file.metadata().map_or(0, |facts| facts.len());
    let sized = (1..).zip(files).map(|(number, file)| Sized {
        is_wanted: wanted.contains(&number),
        bytes: size(file),
        entry: file,
    });
    let files = sized.filter(|one| one.bytes <= MOST_OF_ONE).collect();
    let mut episodes = Vec::new();
    for one in thinned(files, MOST_OF_ALL) {
        episodes.extend(pack(one.entry)?.map(|packed| Sized {
            is_wanted: one.is_wanted,
            bytes: packed.data.len() as u64,
            entry: packed,
        }));
    }
    let episodes = thinned(episodes, MOST_PACKED).into_iter();
    Ok(episodes.map(|one| one.entry).collect())
}

/// An entry with its size.
struct Sized<T> {
    is_wanted: bool,
    bytes: u64,
    entry: T,
}

/// Thins out entries until they take at most this many bytes.
fn thinned<T>(mut entries: Vec<Sized<T>>, most: u64) -> Vec<Sized<T>> {
    while entries.iter().map(|one| one.bytes).sum::<u64>() > most {
        let has_others = entries.iter().any(|one| !one.is_wanted);
        thin_out(&mut entries, |one| has_others && one.is_wanted);
    }
    entries
}

/// Removes every second entry, but neither the last one of several nor those to keep.
fn thin_out<T>(entries: &mut Vec<T>, keeps: impl Fn(&T) -> bool) {
    let all = entries.iter().filter(|one| !keeps(one)).count();
    let mut numbers = 0..;
    entries.retain(|one| {
        if keeps(one) {
            return true;
        }
        let at: usize = numbers.next().unwrap_or(all);
        (at.is_multiple_of(2) && all > 1) || (at + 1 == all && all > 2)
    });
}

/// Packs an episode; returns `None` if the recording contains no episode.
fn pack(file: &Path) -> Result<Option<PackedEpisode>, Error> {
    let data = Data::of(&Recording::open(file)?)?.without_curve();
    let Some(episode) = data.first_episode() else {
        return Ok(None);
    };
    let mut json = Vec::new();
    event::write_json(&mut json, &data);
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::best());
    let packed = packer.write_all(&json).and_then(|()| packer.finish());
    Ok(Some(PackedEpisode {
        episode,
        data: STANDARD.encode(packed.expect("memory can be written")),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_first_and_the_last_entry_and_ends() {
        let mut numbers: Vec<u32> = (1..=10).collect();
        let mut seen = Vec::new();
        while !numbers.is_empty() {
            thin_out(&mut numbers, |_| false);
            seen.push(numbers.clone());
        }
        let expected: [&[u32]; 5] = [
            &[1, 3, 5, 7, 9, 10],
            &[1, 5, 9, 10],
            &[1, 9, 10],
            &[1, 10],
            &[1],
        ];
        assert_eq!(seen[..5], expected.map(<[u32]>::to_vec));
    }
}
