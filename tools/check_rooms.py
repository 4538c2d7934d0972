#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that every include of src/ and include/ respects src/rooms.txt.

usage: check_rooms.py SOURCE_DIRECTORY
"""
import pathlib
import re
import sys

EVERYWHERE = {"base", "simd", "geometry"}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def read_rooms(path):
    """Returns {room: rooms it may include}, with transitive use expanded."""
    allowed = {}
    for line in path.read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        room, _, uses = line.partition(":")
        direct = set(uses.split())
        unknown = direct - set(allowed)
        if unknown:
            sys.exit(f"{path}: {room} uses {sorted(unknown)}, which do not stand below it")
        below = EVERYWHERE & set(allowed)
        allowed[room] = {room} | below | direct | {r for d in direct for r in allowed[d]}
    return allowed


def room_of_include(name, rooms):
    parts = pathlib.PurePosixPath(name).parts
    if parts[0] == "mneme":
        return pathlib.PurePosixPath(name).stem
    return parts[0] if parts[0] in rooms else None


def main():
    root = pathlib.Path(sys.argv[1])
    rooms = read_rooms(root / "src/rooms.txt")
    problems = []
    files = [(p, p.parent.name) for p in sorted(root.glob("src/*/*")) if p.is_file()]
    files += [(p, p.stem) for p in sorted(root.glob("include/mneme/*.h")) if p.stem != "mneme"]
    for path, room in files:
        if room not in rooms:
            problems.append(f"{path}: room {room} is not in src/rooms.txt")
            continue
        for name in INCLUDE.findall(path.read_text()):
            used = room_of_include(name, rooms)
            if used is not None and used not in rooms[room]:
                problems.append(f"{path}: {room} may not include {name} (room {used})")
    print("\n".join(problems) if problems else f"{len(files)} files respect {len(rooms)} rooms")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
