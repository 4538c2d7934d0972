# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])
BUILD = pathlib.Path(os.environ["MNEME_BUILD"])
sys.path.insert(0, str(SOURCE / "packaging/wheel"))
import mneme_wheel  # noqa: E402

# What the build is for. Programs of another machine run under its emulator.
PROCESSOR = os.environ["MNEME_PROCESSOR"]
MACHINE = mneme_wheel.MACHINES[PROCESSOR]
EMULATOR = MACHINE.emulator
PYTHON = [*EMULATOR, MACHINE.root / "usr/bin/python3"]


def run(command, **settings):
    """What a command prints; it must succeed."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          timeout=900, **settings)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def environment(**changes):
    kept = {name: value for name, value in os.environ.items() if not name.startswith("MNEME_")}
    return {**kept, **changes}


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """A prefix that mneme was installed to."""
    prefix = tmp_path_factory.mktemp("prefix")
    run(["cmake", "--install", BUILD, "--prefix", prefix])
    return prefix


@pytest.fixture(scope="session")
def packages(tmp_path_factory):
    """The Debian packages by name."""
    directory = tmp_path_factory.mktemp("packages")
    run(["cpack", "--config", BUILD / "CPackConfig.cmake", "-B", directory], cwd=directory)
    return {path.name.split("_")[0]: path for path in directory.glob("*.deb")}
