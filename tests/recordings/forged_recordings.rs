//! Recordings in which lengths, numbers, times and indexes are forged, inside of chunks too, and all
//! checksums are right: what is read is told or refused, and never believed to the point of a panic.
//!
//! With `XCSCR_LONG=1` the long suite forges fifty times as many.

use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::desk::Desk;
use crate::recordings::copies::Parts;
use xcscr::record::reader::Recording;
use xcscr::xcs::random::Stream;

/// The opcodes of records that this knows by their parts.
const FOOTER: u8 = 2;
const CHUNK: u8 = 6;
const ATTACHMENT: u8 = 9;
const SUMMARY_OFFSET: u8 = 14;
const DATA_END: u8 = 15;
/// The bytes of a chunk that is not packed before its records: times, size, sum, no name, length.
const CHUNK_HEAD: usize = 8 + 8 + 8 + 4 + 4 + 8;

/// An opcode and a body.
type Record = (u8, Vec<u8>);

/// A part of the sample, written without compression, so that its chunks can be forged.
fn sample() -> Vec<u8> {
    let path = Path::new("recordings/sample-maze4.mcap");
    let mut parts = Parts::of(&Recording::open(path).unwrap());
    for topic in &mut parts.topics {
        let length = topic.schema_data.len().min(64);
        topic.schema_data = topic.schema_data[..length].into();
    }
    parts.messages.retain(|message| message.data.len() < 500);
    parts.messages.truncate(40);
    let options = mcap::WriteOptions::new().compression(None);
    parts.write(options.chunk_size(Some(1 << 12)))
}

/// The whole records of a stream of them.
fn split(mut bytes: &[u8]) -> Vec<Record> {
    let mut records = Vec::new();
    while bytes.len() >= 9 {
        let length = u64::from_le_bytes(bytes[1..9].try_into().unwrap()) as usize;
        records.push((bytes[0], bytes[9..9 + length].to_vec()));
        bytes = &bytes[9 + length..];
    }
    records
}

fn join(records: &[Record]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (opcode, body) in records {
        bytes.push(*opcode);
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

/// Changes one record, or the order and number of them.
fn forge(records: &mut Vec<Record>, dice: &mut Stream) {
    if records.is_empty() {
        return;
    }
    let (at, other) = (dice.below(records.len()), dice.below(records.len()));
    match dice.below(10) {
        0 => drop(records.remove(at)),
        1 => records.insert(other, records[at].clone()),
        2 => records.swap(at, other),
        3 => records[at].0 = dice.below(20) as u8,
        _ => forge_body(&mut records[at], dice),
    }
}

fn forge_body((opcode, body): &mut Record, dice: &mut Stream) {
    if *opcode == CHUNK && body.len() >= CHUNK_HEAD && dice.below(4) > 0 {
        let mut inner = split(&body[CHUNK_HEAD..]);
        forge(&mut inner, dice);
        let inner = join(&inner);
        let length = (inner.len() as u64).to_le_bytes();
        body.truncate(CHUNK_HEAD);
        body[16..24].copy_from_slice(&length);
        body[CHUNK_HEAD - 8..].copy_from_slice(&length);
        body.extend(inner);
    } else {
        let odd = [0, 1, 255, 1 << 31, u64::from(u32::MAX), 1 << 63, u64::MAX];
        let value = odd[dice.below(odd.len())].to_le_bytes();
        let width = [1, 2, 4, 8][dice.below(4)].min(body.len());
        let at = dice.below(body.len() - width + 1);
        match dice.below(8) {
            0 => body.truncate(at),
            1 => drop(body.splice(at..at, value)),
            _ => body[at..at + width].copy_from_slice(&value[..width]),
        }
    }
    // The sums of what was forged are right.
    if *opcode == CHUNK && body.len() >= CHUNK_HEAD {
        let sum = crc32fast::hash(&body[CHUNK_HEAD..]);
        body[24..28].copy_from_slice(&sum.to_le_bytes());
    }
    if *opcode == ATTACHMENT && body.len() >= 4 {
        let end = body.len() - 4;
        let sum = crc32fast::hash(&body[..end]);
        body[end..].copy_from_slice(&sum.to_le_bytes());
    }
}

/// A file of these records, with the sums over its sections and the places of them.
fn file(records: &[Record]) -> Vec<u8> {
    file_with(records, None)
}

/// The same, whose footer may name another place as the beginning of the summary.
fn file_with(records: &[Record], summary: Option<u64>) -> Vec<u8> {
    let mut bytes = mcap::MAGIC.to_vec();
    let (mut start, mut offsets) = (0, 0);
    for (opcode, body) in records.iter().filter(|(opcode, _)| *opcode != FOOTER) {
        let mut record = (*opcode, body.clone());
        if *opcode == DATA_END {
            record.1 = crc32fast::hash(&bytes).to_le_bytes().to_vec();
        }
        if *opcode == SUMMARY_OFFSET && offsets == 0 {
            offsets = bytes.len();
        }
        bytes.extend(join(&[record]));
        if *opcode == DATA_END {
            start = bytes.len();
        }
    }
    let footer = bytes.len();
    bytes.push(FOOTER);
    bytes.extend(20_u64.to_le_bytes());
    bytes.extend(summary.unwrap_or(start as u64).to_le_bytes());
    bytes.extend((offsets as u64).to_le_bytes());
    let summed = if start == 0 { footer } else { start };
    let sum = crc32fast::hash(&bytes[summed..]);
    bytes.extend(sum.to_le_bytes());
    bytes.extend(mcap::MAGIC);
    bytes
}

#[test]
fn forged_recordings() {
    let sound = sample();
    let records = split(&sound[mcap::MAGIC.len()..sound.len() - mcap::MAGIC.len()]);
    let name = Path::new("forged.mcap");
    let again = Recording::from_bytes(name, file(&records)).unwrap();
    assert_eq!(again.messages().count(), 40, "the control is whole");
    let mut dice = dice(13);
    let mut taken = 0;
    for number in 0..rounds([100, 2_000, 100_000]) {
        let mut forged = records.clone();
        for _ in 0..=dice.below(3) {
            forge(&mut forged, &mut dice);
        }
        // Every third footer points anywhere, also into the data of records.
        let place = dice.below(sound.len()) as u64;
        let bytes = file_with(&forged, Some(place).filter(|_| number % 3 == 0));
        if let Ok(recording) = Recording::from_bytes(name, bytes) {
            taken += 1;
            let counted: u64 = recording.topics().iter().map(|topic| topic.messages).sum();
            assert!(counted <= 4096, "mutant {number} has {counted} messages");
            let _ = recording.check();
        }
    }
    // Control: another time of a message is read as well as the right one.
    assert!(taken > 0);
}

/// The summary begins in the data of an attachment, with an attachment that is shorter than its
/// lengths say, or with a chunk that unpacks to much.
#[test]
fn a_summary_that_hides_in_an_attachment_is_never_read() {
    let text = |text: &[u8]| [&(text.len() as u32).to_le_bytes()[..], text].concat();
    let hidden_chunk = [
        &[0; 16][..],
        &(1_u64 << 40).to_le_bytes(),
        &[0; 4],
        &text(b"zstd"),
        &8_u64.to_le_bytes(),
        &[0; 8],
    ];
    for hidden in [(ATTACHMENT, vec![0; 32]), (CHUNK, hidden_chunk.concat())] {
        let hidden = join(&[hidden]);
        let head = [
            &[0; 16][..],
            &text(b"x"),
            &text(b""),
            &(hidden.len() as u64).to_le_bytes(),
        ]
        .concat();
        let header = (1, [text(b""), text(b"")].concat());
        let before = mcap::MAGIC.len() + join(std::slice::from_ref(&header)).len();
        let attachment = (ATTACHMENT, [&head[..], &hidden, &[0; 4]].concat());
        let records = [header, attachment, (DATA_END, vec![0; 4])];
        let place = (before + 9 + head.len()) as u64;
        let desk = Desk::new();
        desk.write("forged.mcap", file_with(&records, Some(place)));
        for line in [
            "recording check @forged.mcap",
            "recording verify @forged.mcap",
            "replay @forged.mcap --html @page.html",
        ] {
            let code = desk.output(line).status.code();
            assert!(matches!(code, Some(1 | 65)), "{line}: {code:?}");
        }
        desk.ok("recording info @forged.mcap");
    }
}

/// A recording whose index claims so many messages of each channel is not believed.
#[test]
fn what_the_index_claims_is_not_what_replay_shows() {
    const STATISTICS: u8 = 11;
    let sound = sample();
    let mut records = split(&sound[mcap::MAGIC.len()..sound.len() - mcap::MAGIC.len()]);
    for (_, body) in records
        .iter_mut()
        .filter(|(opcode, _)| *opcode == STATISTICS)
    {
        // The counts of the channels: two bytes of number, eight of count each.
        let counts = 8 + 2 + 4 * 4 + 8 + 8 + 4;
        for count in body[counts..].chunks_mut(10) {
            count[2..].fill(0xff);
        }
    }
    let recording = Recording::from_bytes(Path::new("forged.mcap"), file(&records)).unwrap();
    let shown: u64 = recording.topics().iter().map(|topic| topic.messages).sum();
    assert_eq!(shown, 40);
    let findings = recording.check();
    let claims = |what: &str| what.contains("the index says 18446744073709551615");
    assert!(findings.iter().any(|one| claims(one)), "{findings:?}");
}

/// A bit that flipped inside of a chunk before the sum over the file was made.
#[test]
fn a_chunk_whose_own_sum_is_wrong_is_refused() {
    let sound = sample();
    let records = split(&sound[mcap::MAGIC.len()..sound.len() - mcap::MAGIC.len()]);
    let is_chunk = |at: &usize| records[*at].0 == CHUNK;
    let chunks: Vec<usize> = (0..records.len()).filter(is_chunk).collect();
    assert!(chunks.len() > 1, "{chunks:?}");
    for at in chunks {
        let mut forged = records.clone();
        *forged[at].1.last_mut().unwrap() ^= 1;
        let bytes = file(&forged);
        let refused = Recording::from_bytes(Path::new("forged.mcap"), bytes);
        assert!(refused.is_err(), "chunk {at}");
    }
}
