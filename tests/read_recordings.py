#!/usr/bin/env python3
"""Reads the recordings of a run folder with someone else's code.

    pip install mcap mcap-protobuf-support
    python3 tests/read_recordings.py recordings/maze4-xcscr-plus-physics-s1

Decodes every message of every file and checks checksums, schemas, topics, the order of time,
attachments and metadata. Prints one line; ends with code 1 and a message at the first fault.
"""

import io
import json
import re
import struct
import sys
import zlib
from collections import Counter
from pathlib import Path

from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

MAGIC = b"\x89MCAP0\r\n"
PAGE = Path(__file__).parent.parent / "docs/src/reference/recordings.md"
# A line of the table of topics: the topic, its schema, and which recordings have it.
ROW = re.compile(r"^\| `(/\S+)` \| `(\S+)`(?: \(JSON\))? \| (both|run|episodes(?:, \w+)?) \|", re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text())
SCHEMAS = {topic: schema for topic, schema, _ in ROWS}


def in_(*places):
    return {topic for topic, _, place in ROWS if place in places}


ONLY_IN_EPISODES = in_("episodes")
ONLY_IN_RUN = in_("run")
# What a robot that senses believes, and what its beams measured, which is recorded on demand.
ONLY_IF_SENSED = in_("episodes, sensed")
ON_DEMAND = in_("episodes, beams")
LOOKED_UP = {"neighbours", "position", "neighbours-position"}
ATTACHED = {"world.json", "config.json"}
ATTACHED_TO_RUN = {"foxglove-layout.json", "rules.json"}
FACTS = {"seed", "method", "arena", "sensor", "world", "episode", "episodes", "version"}
TYPES = {
    "boolean": bool,
    "integer": int,
    "number": (int, float),
    "string": str,
    "array": list,
}


class Fault(Exception):
    """Something is wrong with a recording."""


def expect(condition, what):
    if not condition:
        raise Fault(what)


def check_sums(data):
    """The sums over the data section and the summary, which the reader leaves to its caller."""
    expect(data.startswith(MAGIC) and data.endswith(MAGIC), "magic bytes are missing")
    footer_at = len(data) - len(MAGIC) - 29
    summary_start, _, summary_crc = struct.unpack_from("<QQI", data, footer_at + 9)
    found = zlib.crc32(data[summary_start : footer_at + 9 + 16])
    expect(found == summary_crc, "wrong checksum of the summary")
    # The data section ends with its own record: opcode, length 4, checksum.
    end_at = summary_start - 13
    opcode, length, data_crc = struct.unpack_from("<BQI", data, end_at)
    expect((opcode, length) == (0x0F, 4), "the data section does not end before the summary")
    expect(zlib.crc32(data[:end_at]) == data_crc, "wrong checksum of the data section")


def check_json(schema, message, where):
    """A message has only fields of its schema, of the types that it gives."""
    properties = json.loads(schema.data)["properties"]
    for field, value in message.items():
        expect(field in properties, f"{where}: {field} is not in the schema")
        wanted = properties[field]["type"]
        fits = isinstance(value, TYPES[wanted]) and (
            wanted == "boolean" or not isinstance(value, bool)
        )
        expect(fits, f"{where}: {field} is {value!r}, expected {wanted}")


def check_explained(schemas):
    """All fields say what they mean."""
    for schema in schemas:
        properties = json.loads(schema.data)["properties"] if schema.encoding == "jsonschema" else {}
        for field, known in properties.items():
            expect(known.get("description"), f"{schema.name}: {field} is not explained")


def decode(schema, channel, message, decoders):
    where = f"{channel.topic} at {message.log_time} ns"
    expect(schema is not None, f"{where} has no schema")
    expect(
        schema.name == SCHEMAS.get(channel.topic),
        f"{where} has the schema {schema.name}",
    )
    expect(message.publish_time == message.log_time, f"{where} has two times")
    if channel.message_encoding == "json":
        check_json(schema, json.loads(message.data), where)
        return
    decoder = decoders.decoder_for(channel.message_encoding, schema)
    expect(decoder is not None, f"{where}: nobody decodes {channel.message_encoding}")
    decoder(message.data)


def check_facts(reader):
    attached = {one.name: one.data for one in reader.iter_attachments()}
    for name, text in attached.items():
        json.loads(text)
    metadata = {one.name: one.metadata for one in reader.iter_metadata()}
    expect("run" in metadata, "the metadata record `run` is missing")
    is_run = metadata["run"].get("episode") == "run"
    wanted = ATTACHED | (ATTACHED_TO_RUN if is_run else set())
    missing = (wanted - set(attached)) | (FACTS - set(metadata["run"]))
    expect(not missing, f"missing: {', '.join(sorted(missing))}")
    return metadata["run"]


def read(path):
    """Checks a file; returns the numbers of its messages by topic."""
    data = path.read_bytes()
    check_sums(data)
    list(StreamReader(io.BytesIO(data), validate_crcs=True).records)
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    run = check_facts(reader)
    decoders, counts, before = DecoderFactory(), Counter(), 0
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        expect(message.log_time >= before, f"time runs backwards on {channel.topic}")
        before = message.log_time
        decode(schema, channel, message, decoders)
        counts[channel.topic] += 1
    summary = reader.get_summary()
    expect(summary.statistics.message_count == sum(counts.values()), "wrong statistics")
    check_explained(summary.schemas.values())
    topics = {channel.topic for channel in summary.channels.values()}
    senses = run["arena"] == "physics" and run["sensor"] not in LOOKED_UP
    is_run = run["episode"] == "run"
    left_out = (ONLY_IN_EPISODES | ONLY_IF_SENSED) if is_run else ONLY_IN_RUN
    wanted = set(SCHEMAS) - ON_DEMAND - left_out - (set() if senses else ONLY_IF_SENSED)
    topics -= ON_DEMAND if senses and not is_run else set()
    expect(topics == wanted, f"topics differ: {sorted(topics ^ wanted)}")
    expect(counts["/episode"] >= 1 and counts["/step"] >= 1, "nothing happened")
    return counts


def main(folder):
    paths = sorted(Path(folder).glob("*.mcap*"))
    expect(paths, f"no recordings in {folder}")
    total = Counter()
    for path in paths:
        try:
            expect(path.suffix == ".mcap", "it was never finished")
            total += read(path)
        except Exception as fault:
            raise Fault(f"{path}: {fault}") from fault
    megabytes = sum(path.stat().st_size for path in paths) / 1e6
    print(
        f"{len(paths)} recordings, {sum(total.values())} messages on {len(total)} topics, "
        f"{megabytes:.1f} MB: all sound"
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        main(sys.argv[1])
    except Fault as fault:
        print(f"read_recordings: {fault}", file=sys.stderr)
        sys.exit(1)
