# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""A wheel of this build, installed by pip into a new environment without a network."""
import re
import sys
import zipfile

import mneme_wheel
import pytest
from conftest import BUILD, EMULATOR, MACHINE, PROCESSOR, PYTHON, SOURCE, environment, run


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    return folder / mneme_wheel.build_wheel(folder, {"build": str(BUILD), "machine": PROCESSOR})


def pip(venv, *arguments):
    """Runs pip from its own wheel: to install it, `venv` starts Python, which no emulator can."""
    wheel = next((MACHINE.root / "usr/share/python-wheels").glob("pip-*.whl"))
    run([*EMULATOR, venv / "bin/python", "-m", "pip", *arguments],
        env=environment(PYTHONPATH=str(wheel)))


@pytest.fixture(scope="module")
def venv(wheel, tmp_path_factory):
    """An environment with NumPy of the system, and the wheel."""
    folder = tmp_path_factory.mktemp("venv")
    python = PYTHON if EMULATOR else [sys.executable]
    run([*python, "-m", "venv", "--without-pip", "--system-site-packages", folder])
    pip(folder, "install", "--no-index", "--no-deps", wheel)
    return folder


def outside(**changes):
    """Nothing of this source tree is found by accident."""
    kept = environment(**changes)
    kept.pop("PYTHONPATH", None)
    return kept


def test_python_plans_as_the_readme_says(venv):
    program = re.search(r"^```python\n(.*?)^```", (SOURCE / "docs/python.md").read_text(),
                        re.MULTILINE | re.DOTALL).group(1)
    printed = run([*EMULATOR, venv / "bin/python", "-c", program], cwd=venv, env=outside())
    assert re.match(r"solved \(\d+, 8\) \d+\.\d+ ms", printed)
    where = run([*EMULATOR, venv / "bin/python", "-c", "import mneme; print(mneme.find_scene('shelf/thin.yaml'))"],
                cwd="/", env=outside()).strip()
    assert where == str(venv / "share/mneme/scenes/shelf/thin.yaml")


def test_the_program_is_on_the_path(venv):
    printed = run([*EMULATOR, venv / "bin/mneme", "plan", venv / "share/mneme/scenes/planar/threaded_b2.yaml"],
                  cwd="/", env=outside())
    assert "solved" in printed


def test_the_program_loads_the_libraries_of_the_wheel(venv):
    loaded = mneme_wheel.needed_libraries(venv / "bin/mneme", MACHINE)
    outer = [name for name, path in loaded.items() if "mneme.libs" not in str(path)]
    assert loaded and not outer


def test_types_and_licence_are_in_the_wheel(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert "mneme/__init__.pyi" in names and "mneme/py.typed" in names
    assert f"mneme-{mneme_wheel.version()}.dist-info/LICENSE" in names
    assert not [name for name in names if "__pycache__" in name]


def test_pip_removes_all_that_it_installed(venv):
    pip(venv, "uninstall", "--yes", "mneme")
    assert not (venv / "bin/mneme").exists()
    assert not [path for path in venv.rglob("*mneme*") if path.is_file()]
