# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/own_robot.md: its commands run, and its files are those of examples/own_robot."""
import os
import pathlib
import re
import shutil
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])
PROGRAM = pathlib.Path(os.environ["MNEME_PROGRAM"])
TEXT = (SOURCE / "docs/own_robot.md").read_text()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


@pytest.fixture()
def folder(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/mneme").symlink_to(PROGRAM)
    return shutil.copytree(SOURCE / "examples/own_robot", tmp_path / "own")


def test_the_commands_run_one_after_the_other(folder):
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) > 5
    path = f"{folder.parent / 'bin'}:{os.environ['PATH']}"
    for command in commands:
        done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, timeout=120,
                              env={**os.environ, "PATH": path})
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
        assert done.stdout
    assert (folder / "plan.html").stat().st_size > 100_000


def test_the_files_are_those_of_the_example(folder):
    for name, shown in zip(("scene.yaml", "problem.yaml"), blocks("yaml"), strict=True):
        lines = [line for line in (folder / name).read_text().splitlines() if not line.startswith("#")]
        assert lines == shown.splitlines(), name
