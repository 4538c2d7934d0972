# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""One build tree, configured before and after packages that parts of mneme need were installed."""
import json
import os
import shutil

import pytest
from conftest import SOURCE, environment, run

PACKAGES = ("Boost", "ompl", "pybind11", "PostgreSQL", "doctest", "benchmark")
TARGETS = {"mneme_ompl", "mneme_service", "mneme_python", "test_ompl", "test_service", "test_store", "mneme_micro"}


@pytest.fixture
def only_xxhash(tmp_path):
    """A directory for PKG_CONFIG_LIBDIR in which cpp-httplib is missing."""
    folder = tmp_path / "pkgconfig"
    folder.mkdir()
    shutil.copy(os.path.join(run(["pkg-config", "--variable=pcfiledir", "libxxhash"]).strip(), "libxxhash.pc"), folder)
    return str(folder)


def configure(build, *arguments, **changes):
    run(["cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", "-DPython3_EXECUTABLE=/usr/bin/python3", *arguments],
        env=environment(**changes))


def targets(build):
    lines = run(["ninja", "-C", build, "-t", "targets", "all"]).splitlines()
    return {line.split(":")[0] for line in lines if line.endswith(": phony")}


def has_postgresql(build):
    commands = json.loads((build / "compile_commands.json").read_text())
    return any("-DMNEME_HAS_POSTGRESQL=1" in entry["command"] or "-DMNEME_HAS_POSTGRESQL " in entry["command"]
               for entry in commands)


def test_parts_appear_once_their_packages_are_installed(tmp_path, only_xxhash):
    build = tmp_path / "build"
    # What script/demo does on a bare machine, then what script/test does after script/setup --all.
    configure(build, "-DMNEME_BUILD_TESTS=OFF", *[f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in PACKAGES],
              PKG_CONFIG_LIBDIR=only_xxhash)
    assert not TARGETS & targets(build)
    assert not has_postgresql(build)
    configure(build, "-DMNEME_BUILD_TESTS=ON", *[f"-UCMAKE_DISABLE_FIND_PACKAGE_{name}" for name in PACKAGES])
    assert TARGETS <= targets(build)
    assert has_postgresql(build)
