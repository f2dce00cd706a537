#!/usr/bin/env python3
"""Runs the reader over the conformance files of MCAP, or over any other folder of recordings.

    python3 tests/conformance.py FOLDER [PROGRAM]

Each file is read, or refused with an error. A file whose records are described by a JSON file beside it, as in
`tests/conformance/data` of MCAP, must be read with the messages of these records.
"""

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

TIME_S = 10


def described(path):
    """The number of messages of each topic in the description of a file, or `None` without one."""
    description = path.with_suffix(".json")
    if not description.exists():
        return None
    records = json.loads(description.read_text())["records"]
    fields = [(record["type"], dict(map(tuple, record["fields"]))) for record in records]
    topics = {own["id"]: own["topic"] for kind, own in fields if kind == "Channel"}
    return Counter(topics[own["channel_id"]] for kind, own in fields if kind == "Message")


def fault(program, path):
    """Returns what is wrong with the answer to a file, and whether the file was read."""
    try:
        info = subprocess.run([program, "recording", "info", "--json", path], capture_output=True, text=True, timeout=TIME_S)
    except subprocess.TimeoutExpired:
        return f"it takes more than {TIME_S} s", False
    if info.returncode == 65 and info.stderr.startswith("error: ") and not info.stdout:
        return "it is valid, but refused: " + info.stderr if described(path) is not None else None, False
    if info.returncode != 0:
        return f"it ends with code {info.returncode}: {info.stderr}", False
    (recording,) = json.loads(info.stdout)
    found = Counter({topic["name"]: topic["messages"] for topic in recording["topics"]})
    wanted = described(path)
    return f"it has {dict(found)}, not {dict(wanted)}" if wanted is not None and +found != wanted else None, True


def main():
    folder, program = Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else "target/debug/xcscr"
    files = sorted(folder.rglob("*.mcap"))
    counts, faults = Counter(), 0
    for path in files:
        wrong, is_read = fault(program, path)
        counts["read" if is_read else "refused"] += 1
        if wrong:
            faults += 1
            print(f"{path}: {wrong.strip()}")
    print(f"{len(files)} files: {counts['read']} read, {counts['refused']} refused, {faults} with a wrong answer")
    sys.exit(1 if faults or not files else 0)


if __name__ == "__main__":
    main()
