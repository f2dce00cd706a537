//! The episodes inside the page of a run, packed.

use std::io::Write;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

use super::data::Data;
use crate::error::Error;
use crate::record::reader::Recording;

/// The maximum size of the recordings that a page is made of, in bytes: of one episode and of all.
/// A page takes about a third of it.
const MOST_OF_ONE: u64 = 512 << 10;
const MOST_OF_ALL: u64 = 6 << 20;
/// The maximum size of all packed episodes of a page, in bytes.
const MOST_PACKED: usize = 2_500_000;

/// An episode in a page.
#[derive(Debug, Serialize)]
pub struct PackedEpisode {
    episode: u64,
    /// The data of the episode as JSON, compressed with zlib, in base64.
    data: String,
}

/// Packs the recordings of a run's episodes, in order. If they are too large for a page, packs
/// every second one, or every fourth, and so on, and the last one. Episodes that are too large on
/// their own are omitted.
///
/// # Errors
/// If a recording cannot be read.
pub fn packed(files: &[PathBuf]) -> Result<Vec<PackedEpisode>, Error> {
    let size = |file: &Path| file.metadata().map_or(0, |facts| facts.len());
    let sized = files.iter().map(|file| (file, size(file)));
    let mut files: Vec<_> = sized.filter(|(_, bytes)| *bytes <= MOST_OF_ONE).collect();
    while files.iter().map(|(_, bytes)| bytes).sum::<u64>() > MOST_OF_ALL {
        thin_out(&mut files);
    }
    let episodes = files.iter().map(|(file, _)| pack(file));
    let episodes: Result<Vec<_>, _> = episodes.collect();
    let mut episodes: Vec<_> = episodes?.into_iter().flatten().collect();
    while episodes.iter().map(|one| one.data.len()).sum::<usize>() > MOST_PACKED {
        thin_out(&mut episodes);
    }
    Ok(episodes)
}

/// Removes every second entry, but never the last one of several.
fn thin_out<T>(entries: &mut Vec<T>) {
    let all = entries.len();
    let mut numbers = 0..;
    entries.retain(|_| {
        let at: usize = numbers.next().unwrap_or(all);
        (at.is_multiple_of(2) && all > 1) || (at + 1 == all && all > 2)
    });
}

/// Packs an episode; returns `None` if the recording contains no episode.
fn pack(file: &Path) -> Result<Option<PackedEpisode>, Error> {
    let data = Data::of(&Recording::open(file)?, None)?.without_curve();
    let Some(episode) = data.first_episode() else {
        return Ok(None);
    };
    let json = serde_json::to_vec(&data).expect("the data have text keys and finite numbers");
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
            thin_out(&mut numbers);
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
