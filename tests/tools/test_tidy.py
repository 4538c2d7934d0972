# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/tidy.py: what it hands to clang-tidy, and what it makes of the answer."""
import json

from tools_of_source import TOOLS  # noqa: F401, makes tools importable

import tidy


def test_precompiled_headers_and_caches_are_left_out_of_commands():
    entry = {"command": "/usr/bin/ccache /usr/bin/c++ -Winvalid-pch -include /b/cmake_pch.hxx -DX='a b' -c a.cpp"}
    assert tidy.arguments_of(entry) == ["/usr/bin/c++", "-DX=a b", "-c", "a.cpp", "-Wno-unknown-warning-option"]


def test_rooms_are_found_by_what_their_translation_unit_includes(tmp_path):
    unity = tmp_path / "build/Unity/unity_robot_cxx.cxx"
    unity.parent.mkdir(parents=True)
    unity.write_text(f'#include "{tmp_path}/src/robot/a.cpp"\n#include "{tmp_path}/src/robot/b.cpp"\n')
    files = [unity, tmp_path / "src/base/version.cpp", tmp_path / "apps/main.cpp", tmp_path / "tests/robot/a_test.cpp"]
    commands = [{"directory": str(tmp_path / "build"), "command": f"c++ -c {file}", "file": str(file)} for file in files]
    (tmp_path / "build/compile_commands.json").write_text(json.dumps(commands))
    units = tidy.translation_units(tmp_path, tmp_path / "build")
    assert {room: [entry["file"] for entry in entries] for room, entries in units.items()} == {
        "robot": [str(unity)], "base": [str(files[1])], "apps": [str(files[2])]}


def test_a_finding_that_several_units_report_counts_once():
    finding = ["/s/a.h:1:2: warning: bad [bugprone-x]", "  int a;"]
    count, lines = tidy.findings_of([finding + ["/s/b.h:3:4: error: worse [y]"], finding])
    assert (count, lines) == (2, finding + ["/s/b.h:3:4: error: worse [y]"])
