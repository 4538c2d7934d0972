# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The Debian packages, unpacked but not installed."""
import json
import shutil

import pytest
from conftest import environment, run

pytestmark = pytest.mark.skipif(shutil.which("dpkg-deb") is None, reason="there is no dpkg-deb")


@pytest.fixture(scope="session")
def unpacked(packages, tmp_path_factory):
    directory = tmp_path_factory.mktemp("unpacked")
    for package in packages.values():
        run(["dpkg", "-x", package, directory])
    return directory / "usr"


def test_there_is_a_package_for_each_use(packages):
    assert {"mneme", "libmneme-dev"} <= set(packages) <= {"mneme", "libmneme-dev", "python3-mneme"}


def test_the_program_runs_from_where_it_was_unpacked(unpacked):
    info = json.loads(run([unpacked / "bin/mneme", "robot", "info", "fetch", "--json"], cwd="/"))
    assert info["path"] == f"{unpacked}/share/mneme/robots/fetch.urdf"
    doctor = json.loads(run([unpacked / "bin/mneme", "doctor", "--json"], cwd="/"))
    assert doctor["ok"]


def test_packages_say_what_they_need(packages):
    needs = run(["dpkg-deb", "--field", packages["mneme"], "Depends"])
    for library in ("libc6", "libsqlite3-0", "libyaml-cpp", "libassimp"):
        assert library in needs
    assert "libeigen3-dev" in run(["dpkg-deb", "--field", packages["libmneme-dev"], "Depends"])
    assert run(["dpkg-deb", "--field", packages["mneme"], "Description"]).strip()


def test_every_file_belongs_to_one_package_and_to_root(packages):
    seen = set()
    for package in packages.values():
        for line in run(["dpkg-deb", "--contents", package]).splitlines():
            mode, owner, *_, name = line.split()
            assert owner == "root/root"
            if not mode.startswith("d"):
                assert name not in seen
                seen.add(name)
    for wanted in ("./usr/bin/mneme", "./usr/share/man/man1/mneme.1",
                   "./usr/share/bash-completion/completions/mneme",
                   "./usr/share/mneme/scenes/planar/grid.yaml",
                   "./usr/share/mneme/schema/scene.schema.json", "./usr/include/mneme/mneme.h",
                   "./usr/lib/cmake/mneme/mneme-config.cmake"):
        assert wanted in seen


def test_the_python_package_plans(unpacked):
    module = unpacked / "lib/python3/dist-packages"
    if not (module / "mneme").exists():
        pytest.skip("the Python module was not built")
    program = ("import mneme; plan = mneme.plan(mneme.Problem.load(mneme.find_scene("
               "'planar/scenario1.yaml'))); print(plan.is_solved, mneme.find_scene("
               "'planar/scenario1.yaml'))")
    printed = run(["/usr/bin/python3", "-c", program], cwd="/",
                  env=environment(PYTHONPATH=str(module)))
    assert printed.startswith(f"True {unpacked}/share/mneme")
