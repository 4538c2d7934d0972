# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The examples in Python do what their twins in C++ do."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])
PROGRAMS = pathlib.Path(os.environ["MNEME_BUILD"]) / "examples"
NAMES = sorted(path.stem for path in (SOURCE / "examples").glob("[0-9][0-9]_*.py"))


def output(command, directory):
    run = subprocess.run(command, cwd=directory, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    return re.sub(r"[0-9.]+ ms", "ms", run.stdout)


def test_there_are_examples():
    assert "01_first_plan" in NAMES


@pytest.mark.parametrize("name", NAMES)
def test_an_example_prints_what_its_twin_prints(name, tmp_path):
    script = output([sys.executable, SOURCE / "examples" / f"{name}.py"], tmp_path)
    assert script
    program = PROGRAMS / name
    if not program.exists():
        pytest.skip(f"{program} was not built")
    other = tmp_path / "cpp"
    other.mkdir()
    assert output([program], other) == script


def test_a_missing_file_is_told(tmp_path):
    run = subprocess.run([sys.executable, SOURCE / "examples/01_first_plan.py", "none.yaml"],
                         cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert run.returncode == 1
    assert "mneme.Error" in run.stderr and "none.yaml" in run.stderr
