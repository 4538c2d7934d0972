#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over rooms, each as the one translation unit that it is compiled as.

usage: tidy.py SOURCE_DIRECTORY BUILD_DIRECTORY [--changed] [ROOM ...]

ROOM is a room of src/, or apps; without any, all are looked at, with --changed those that differ from git's HEAD. The
build directory needs to be configured, not built. Precompiled headers are left out: they are those of another compiler.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from changed_rooms import changed_rooms, room_of, sources_of

SKIPPED = 77  # ctest's SKIP_RETURN_CODE
FINDING = re.compile(r"^(\S+?):\d+:\d+: (?:warning|error): ")


def arguments_of(entry):
    """The command of an entry of compile_commands.json without precompiled headers and compiler caches."""
    words = entry.get("arguments") or shlex.split(entry["command"])
    result, skip = [], False
    for word in words:
        if skip:
            skip = False
        elif word == "-include":
            skip = True
        elif word != "-Winvalid-pch" and not (not result and word.endswith("ccache")):
            result.append(word)
    return result + ["-Wno-unknown-warning-option"]


def translation_units(root, build):
    """{room: entries of compile_commands.json}"""
    units = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["directory"]) / entry["file"]
        sources = [source for source in sources_of(entry) if root / "tests" not in source.parents]
        rooms = {room_of(source, root) for source in sources} - {None}
        for room in rooms:
            units.setdefault(room, []).append({**entry, "file": str(path), "arguments": arguments_of(entry)})
    for entry in (entry for entries in units.values() for entry in entries):
        entry.pop("command", None)
    return units


def look_at(root, database, path):
    """Lines that clang-tidy prints of one translation unit."""
    done = subprocess.run(["clang-tidy", "-p", database, "--quiet", f"--config-file={root / '.clang-tidy'}",
                           f"--header-filter=^{re.escape(str(root))}/(src|include|apps)/.*", path],
                          capture_output=True, text=True)
    if done.returncode != 0 and not done.stdout:
        return [f"{path}:1:1: error: {done.stderr.strip().splitlines()[-1]}"]
    return done.stdout.splitlines()


def findings_of(outputs):
    """Each finding once, with the lines that explain it."""
    seen, result, is_new = set(), [], False
    for line in (line for output in outputs for line in output):
        if FINDING.match(line):
            is_new = line not in seen
            seen.add(line)
        if is_new:
            result.append(line)
    return len(seen), result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=lambda name: pathlib.Path(name).resolve(), metavar="SOURCE_DIRECTORY")
    parser.add_argument("build", type=lambda name: pathlib.Path(name).resolve(), metavar="BUILD_DIRECTORY")
    parser.add_argument("rooms", nargs="*", metavar="ROOM")
    parser.add_argument("--changed", action="store_true", help="rooms that differ from git's HEAD")
    arguments = parser.parse_args()
    units = translation_units(arguments.root, arguments.build)
    unknown = set(arguments.rooms) - set(units)
    if unknown:
        parser.error(f"not compiled in {arguments.build}: {', '.join(sorted(unknown))}")
    rooms = set(arguments.rooms) or set(units)
    if arguments.changed:
        changed = changed_rooms(arguments.root, "HEAD")
        if changed is None:
            print("tidy: this is no checkout of git, so that nothing tells what has changed")
            return SKIPPED
        rooms &= changed
    entries = [entry for room in sorted(rooms) for entry in units[room]]
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "compile_commands.json").write_text(json.dumps(entries))
        paths = sorted({entry["file"] for entry in entries})
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            outputs = pool.map(lambda path: look_at(arguments.root, folder, path), paths)
    count, lines = findings_of(outputs)
    print("\n".join(lines + [f"tidy: {count} findings in {', '.join(sorted(rooms)) or 'no room: nothing has changed'}"]))
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
