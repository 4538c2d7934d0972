# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/coverage_by_room.py on made-up tables of gcovr."""
import subprocess
import sys

from tools_of_source import TOOLS

HEAD = "filename,line_total,line_covered,line_percent,branch_total,branch_covered,branch_percent\n"
LOW = HEAD + "src/low/a.cpp,100,89,0.89,10,5,0.5\n"
TABLES = LOW + HEAD + "src/high/b.cpp,80,80,1.0,0,0,\nsrc/high/b.h,20,10,0.5,4,4,1.0\napps/main.cpp,10,10,1.0,2,2,1.0\n"


def run(tmp_path, table, rooms=None):
    arguments = []
    if rooms is not None:
        (tmp_path / "rooms.txt").write_text(rooms)
        arguments = ["--rooms", tmp_path / "rooms.txt"]
    return subprocess.run([sys.executable, TOOLS / "coverage_by_room.py", *arguments], input=table,
                          capture_output=True, text=True)


def test_files_are_summed_by_room(tmp_path):
    done = run(tmp_path, TABLES)
    assert done.returncode == 0
    assert done.stdout.splitlines()[2:] == ["| apps | 10 | 100.0 % | 2 | 100.0 % |", "| high | 100 | 90.0 % | 4 | 100.0 % |",
                                            "| low | 100 | 89.0 % | 10 | 50.0 % |", "| all | 210 | 90.0 % | 16 | 68.8 % |"]


def test_a_room_with_less_than_90_percent_fails_by_name(tmp_path):
    done = run(tmp_path, TABLES, "# rooms\nlow:\nhigh: low\n")
    assert done.returncode == 1
    assert done.stderr == "low: tests reach 89 of 100 lines, 89.0 %; 90 % are wanted, 1 lines more\n"
    assert "| high |" in done.stdout


def test_a_listed_room_that_was_not_counted_fails(tmp_path):
    done = run(tmp_path, LOW.replace("89,", "95,", 1), "library mneme:\nlow:\nattic: low\n")
    assert (done.returncode, done.stderr) == (1, "attic: no line of it was counted\n")


def test_enough_passes(tmp_path):
    assert run(tmp_path, LOW.replace("89,", "90,", 1), "low:\n").returncode == 0
