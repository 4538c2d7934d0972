# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/tidy.py: what it hands to clang-tidy, and what it makes of the answer."""
import json
import shutil
import subprocess

import pytest
from tools_of_source import TOOLS

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


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_changed_rooms_are_those_with_files_that_differ_from_the_last_commit(tmp_path):
    for name in ("src/robot/a.cpp", "src/scene/b.cpp", "include/mneme/path.h", "docs/a.md"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    git = ["git", "-C", tmp_path, "-c", "user.name=a", "-c", "user.email=a@b"]
    for arguments in (["init", "-q"], ["add", "."], ["commit", "-qm", "a"]):
        subprocess.run(git + arguments, check=True)
    assert tidy.changed_rooms(tmp_path) == set()
    (tmp_path / "src/robot/a.cpp").write_text("int a;\n")
    (tmp_path / "include/mneme/path.h").write_text("int b;\n")
    (tmp_path / "docs/a.md").write_text("c\n")
    (tmp_path / "apps").mkdir()
    (tmp_path / "apps/new.cpp").write_text("")
    assert tidy.changed_rooms(tmp_path) == {"robot", "path", "apps"}


def test_a_finding_that_several_units_report_counts_once():
    finding = ["/s/a.h:1:2: warning: bad [bugprone-x]", "  int a;"]
    count, lines = tidy.findings_of([finding + ["/s/b.h:3:4: error: worse [y]"], finding])
    assert (count, lines) == (2, finding + ["/s/b.h:3:4: error: worse [y]"])
