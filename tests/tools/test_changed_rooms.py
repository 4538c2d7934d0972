# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/changed_rooms.py in small repositories."""
import json
import shutil
import subprocess

import pytest
from tools_of_source import TOOLS  # noqa: F401, makes tools importable

import changed_rooms

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


@pytest.fixture()
def repository(tmp_path):
    for name in ("src/robot/a.cpp", "src/scene/b.cpp", "include/mneme/path.h", "docs/a.md", "tests/goal/a_test.cpp"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    git(tmp_path, "init", "-q", "-b", "main")
    commit(tmp_path)
    return tmp_path


def git(root, *arguments):
    subprocess.run(["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b", *arguments], check=True)


def commit(root):
    git(root, "add", ".")
    git(root, "commit", "-qm", "a", "--allow-empty")


def test_rooms_have_changed_if_their_sources_headers_or_tests_differ(repository):
    assert changed_rooms.changed_rooms(repository, "HEAD") == set()
    (repository / "src/robot/a.cpp").write_text("int a;\n")
    (repository / "include/mneme/path.h").write_text("int b;\n")
    (repository / "docs/a.md").write_text("c\n")
    (repository / "tests/goal/a_test.cpp").write_text("int c;\n")
    (repository / "apps").mkdir()
    (repository / "apps/new.cpp").write_text("")
    assert changed_rooms.changed_rooms(repository, "HEAD") == {"robot", "path", "goal", "apps"}


def test_a_branch_is_compared_with_where_it_left_main(repository):
    git(repository, "update-ref", "refs/remotes/origin/main", "HEAD")
    left = changed_rooms.git(repository, "rev-parse", "HEAD")
    git(repository, "checkout", "-q", "-b", "work")
    commit(repository)
    assert changed_rooms.earlier_commit(repository) == left


def test_main_is_compared_with_the_twentieth_commit_before(repository):
    first = changed_rooms.git(repository, "rev-parse", "HEAD")
    for _ in range(19):
        commit(repository)
    assert changed_rooms.earlier_commit(repository) is None
    commit(repository)
    git(repository, "update-ref", "refs/remotes/origin/main", "HEAD")
    assert changed_rooms.earlier_commit(repository) == first


def test_without_an_earlier_commit_all_rooms_have_changed(tmp_path):
    assert changed_rooms.changed_rooms(tmp_path, None) is None
    assert changed_rooms.changed_rooms(tmp_path, "HEAD") is None


def test_objects_are_those_of_rooms_and_their_tests(tmp_path):
    unity = tmp_path / "build/Unity/unity_robot_cxx.cxx"
    unity.parent.mkdir(parents=True)
    unity.write_text(f'#include "{tmp_path}/src/robot/a.cpp"\n')
    files = {unity: "robot.o", tmp_path / "src/scene/k.cpp": "scene.o", tmp_path / "tests/robot/a_test.cpp": "tests.o",
             tmp_path / "build/page.cpp": "page.o"}
    commands = [{"directory": str(tmp_path / "build"), "command": f"c++ -o {name} -c {file}", "file": str(file)}
                for file, name in files.items()]
    (tmp_path / "build/compile_commands.json").write_text(json.dumps(commands))
    assert changed_rooms.objects_of(tmp_path, tmp_path / "build", {"robot"}) == ["robot.o", "tests.o"]
    assert changed_rooms.objects_of(tmp_path, tmp_path / "build", None) == ["robot.o", "scene.o", "tests.o"]
