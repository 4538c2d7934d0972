#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the map of ARCHITECTURE.md from the code: layers, libraries, rooms and what each room includes.

usage: draw_rooms.py SOURCE_DIRECTORY [--check]

Writes the map between the lines `<!-- map -->` and `<!-- /map -->` of ARCHITECTURE.md; with --check it changes nothing
and fails if the map is stale. The purpose of a room is the first sentence of its public header; a room without one has
it as a comment above its line in src/rooms.txt. Uses are the includes that the code has, without those that another
used room has already.
"""
import argparse
import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s+"(?:mneme/)?(\w+)[./]', re.MULTILINE)
OPEN_TO_ALL = ("base", "simd", "geometry")


def read_rooms(root):
    """{library: [room]} and {room: purpose} of src/rooms.txt, in its order."""
    libraries, purposes, comment = {}, {}, ""
    for line in (root / "src/rooms.txt").read_text().splitlines():
        if line.startswith("#"):
            comment = line.lstrip("# ").rstrip(".")
        elif line.startswith("library "):
            libraries[line.split()[1].rstrip(":")] = []
        elif ":" in line:
            room = line.split(":")[0]
            list(libraries.values())[-1].append(room)
            purposes[room] = purpose_of(root / "include/mneme" / f"{room}.h") or comment
            comment = ""
    return libraries, purposes


def purpose_of(header):
    """The first sentence of a header's own comment; empty if there is no such header."""
    if not header.is_file():
        return ""
    comment = []
    for line in header.read_text().splitlines():
        if line.startswith("///"):
            comment.append(line[3:].strip())
        elif comment:
            break
    return re.split(r"\.(?:\s|$)", " ".join(comment))[0]


def read_uses(root, rooms):
    """{room: rooms that its files include}."""
    uses = {}
    for room in rooms:
        files = [*(root / "src" / room).glob("*"), root / "include/mneme" / f"{room}.h"]
        texts = [file.read_text() for file in files if file.is_file()]
        named = {name for text in texts for name in INCLUDE.findall(text)}
        uses[room] = (named & set(rooms)) - {room, *OPEN_TO_ALL}
    return uses


def reach(room, uses):
    """All rooms below this one."""
    below = set()
    for used in uses[room]:
        below |= {used} | reach(used, uses)
    return below


def layer_of(room, uses):
    return 0 if room in OPEN_TO_ALL else 1 + max((layer_of(used, uses) for used in uses[room]), default=0)


def draw(libraries, purposes, uses):
    """The layers of all libraries from the top down as text, then a table of rooms from the bottom up."""
    places = [(layer_of(room, uses), library, room) for library, rooms in libraries.items() for room in rooms]
    wide = max(map(len, libraries))
    lines = ["```text", f"{'layer':>5}  {'library':{wide}}  rooms"]
    for layer, library in sorted({place[:2] for place in places}, reverse=True):
        rooms = " ".join(room for at, of, room in places if (at, of) == (layer, library))
        lines.append(f"{layer:5}  {library:{wide}}  {rooms}")
    lines += ["```", "", "| room | purpose | uses |", "|---|---|---|"]
    for _, _, room in sorted(places, key=lambda place: place[0]):
        direct = uses[room] - {deep for used in uses[room] for deep in reach(used, uses)}
        names = ", ".join(sorted(direct)) or ("" if room in OPEN_TO_ALL else "base, geometry")
        lines.append(f"| `{room}` | {purposes[room]} | {names} |")
    return "\n".join([*lines, ""])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    libraries, purposes = read_rooms(arguments.root)
    rooms = [room for of in libraries.values() for room in of]
    page = arguments.root / "ARCHITECTURE.md"
    text = page.read_text()
    parts = re.split(r"(<!-- map -->\n|<!-- /map -->)", text)
    if len(parts) != 5:
        sys.exit(f"{page}: expected one <!-- map --> and one <!-- /map -->")
    parts[2] = "\n" + draw(libraries, purposes, read_uses(arguments.root, rooms))
    drawn = "".join(parts)
    if arguments.check and drawn != text:
        sys.exit(f"{page}: the map is stale; tools/draw_rooms.py {arguments.root} draws it anew")
    if not arguments.check:
        page.write_text(drawn)


if __name__ == "__main__":
    main()
