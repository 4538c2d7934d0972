#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sums gcovr's tables of files by room, as rows of a Markdown table; the last one is everything.

usage: coverage_by_room.py [--rooms FILE] < coverage.csv

With --rooms (src/rooms.txt) it fails if the tests reach less than 90 % of the lines of a room, or none of a room
that is in the list.
"""
import argparse
import collections
import csv
import pathlib
import sys

COUNTS = ("line_total", "line_covered", "branch_total", "branch_covered")
LEAST = 90  # per cent of the lines of a room
# Rooms that may have less, each with the reason: {room: (per cent, "reason")}. It is printed with the table.
EXCEPTIONS = {}


def room_of(path):
    parts = pathlib.PurePosixPath(path).parts
    return parts[1] if parts[0] == "src" and len(parts) > 2 else parts[0]


def sums_by_room(rows):
    """{room: the four counts}, and those of "all"."""
    rooms = collections.defaultdict(lambda: [0] * len(COUNTS))
    for row in rows:
        if row["filename"] == "filename":  # tables one after the other
            continue
        for name in (room_of(row["filename"]), "all"):
            rooms[name] = [sum + int(row[count]) for sum, count in zip(rooms[name], COUNTS)]
    return dict(rooms)


def percent(covered, total):
    return f"{100 * covered / total:.1f} %" if total else "-"


def table(rooms):
    lines = ["| room | lines | reached | branches | reached |", "|---|---|---|---|---|"]
    for name in sorted(rooms, key=lambda room: (room == "all", room)):
        lines_total, lines_covered, branches, branches_covered = rooms[name]
        lines.append(f"| {name} | {lines_total} | {percent(lines_covered, lines_total)} "
                     f"| {branches} | {percent(branches_covered, branches)} |")
    return "\n".join(lines)


def listed_rooms(path):
    return [line.partition(":")[0] for line in path.read_text().splitlines()
            if line.strip() and not line.startswith(("#", "library "))]


def shortcomings(rooms, listed):
    """What of which room the tests do not reach enough of."""
    result = [f"{room}: no line of it was counted" for room in listed if room not in rooms]
    for room, (total, covered, *_) in sorted(rooms.items()):
        least, _ = EXCEPTIONS.get(room, (LEAST, ""))
        if room != "all" and 100 * covered < least * total:
            result.append(f"{room}: tests reach {covered} of {total} lines, {percent(covered, total)}; "
                          f"{least} % are wanted, {-(-least * total // 100) - covered} lines more")
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=pathlib.Path, help="the rooms of which 90 %% of the lines are wanted")
    arguments = parser.parse_args()
    rooms = sums_by_room(csv.DictReader(sys.stdin))
    print(table(rooms) if rooms else "no coverage in the input")
    if not arguments.rooms:
        return 0
    for room, (least, reason) in EXCEPTIONS.items():
        print(f"{room}: {least} % will do: {reason}")
    problems = shortcomings(rooms, listed_rooms(arguments.rooms))
    print("\n".join(problems), file=sys.stderr, end="\n" if problems else "")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
