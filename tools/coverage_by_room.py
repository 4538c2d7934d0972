#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sums gcovr's table of files by room, as rows of a Markdown table; the last one is everything.

usage: coverage_by_room.py < coverage.csv
"""
import collections
import csv
import pathlib
import sys

COUNTS = ("line_total", "line_covered", "branch_total", "branch_covered")


def room_of(path):
    parts = pathlib.PurePosixPath(path).parts
    return parts[1] if parts[0] == "src" and len(parts) > 2 else parts[0]


def percent(covered, total):
    return f"{100 * covered / total:.1f} %" if total else "-"


def main():
    rooms = collections.defaultdict(lambda: [0] * len(COUNTS))
    for row in csv.DictReader(sys.stdin):
        for name in (room_of(row["filename"]), "all"):
            rooms[name] = [sum + int(row[count]) for sum, count in zip(rooms[name], COUNTS)]
    print("| room | lines | reached | branches | reached |\n|---|---|---|---|---|")
    for name in sorted(rooms, key=lambda room: (room == "all", room)):
        lines, lines_covered, branches, branches_covered = rooms[name]
        print(f"| {name} | {lines} | {percent(lines_covered, lines)} "
              f"| {branches} | {percent(branches_covered, branches)} |")


main()
