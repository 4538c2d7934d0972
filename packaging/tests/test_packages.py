# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The Debian packages, unpacked but not installed."""
import json
import re
import shutil
import subprocess

import pytest
from conftest import EMULATOR, PYTHON, SOURCE, environment, run

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
    info = json.loads(run([*EMULATOR, unpacked / "bin/mneme", "robot", "info", "fetch", "--json"], cwd="/"))
    assert info["path"] == f"{unpacked}/share/mneme/robots/fetch.urdf"
    doctor = json.loads(run([*EMULATOR, unpacked / "bin/mneme", "doctor", "--json"], cwd="/"))
    assert doctor["ok"]


def test_packages_say_what_they_need(packages):
    needs = run(["dpkg-deb", "--field", packages["mneme"], "Depends"])
    for library in ("libc6", "libsqlite3-0", "libyaml-cpp"):
        assert library in needs
    needs = run(["dpkg-deb", "--field", packages["libmneme-dev"], "Depends"])
    for package in ("libeigen3-dev", "libtinyxml2-dev"):
        assert package in needs


def test_packages_are_for_the_machine_of_the_build(packages):
    wanted = "arm64" if EMULATOR else run(["dpkg", "--print-architecture"]).strip()
    for package in packages.values():
        assert run(["dpkg-deb", "--field", package, "Architecture"]).strip() == wanted


def test_packages_describe_themselves(packages):
    for package in packages.values():
        first, *rest = run(["dpkg-deb", "--field", package, "Description"]).splitlines()
        assert first.startswith("Motion planning from memory")
        assert rest and all(re.match(r" \S", line) and "Motion planning from memory" not in line for line in rest)


@pytest.mark.skipif(shutil.which("apt-get") is None, reason="there is no apt-get")
def test_apt_would_install_them(packages):
    lists = {"APT_CONFIG": str(SOURCE / "build/aarch64-apt/apt.conf")} if EMULATOR else {}
    simulated = subprocess.run(["apt-get", "install", "--simulate", *packages.values()], capture_output=True,
                               text=True, timeout=120, env=environment(LC_ALL="C", **lists))
    if "not installable" in simulated.stdout:
        pytest.skip("apt knows no packages: apt-get update was never run")
    assert simulated.returncode == 0, simulated.stdout + simulated.stderr
    for name in packages:
        assert f"Inst {name} " in simulated.stdout


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
                   "./usr/share/mneme/schema/scene.schema.json",
                   "./usr/share/doc/mneme/examples/own_robot/arm.urdf", "./usr/include/mneme/mneme.h",
                   "./usr/lib/cmake/mneme/mneme-config.cmake"):
        assert wanted in seen


def test_the_python_package_plans(unpacked):
    module = unpacked / "lib/python3/dist-packages"
    if not (module / "mneme").exists():
        pytest.skip("the Python module was not built")
    program = ("import mneme; plan = mneme.plan(mneme.Problem.load(mneme.find_scene("
               "'planar/scenario1.yaml'))); print(plan.is_solved, mneme.find_scene("
               "'planar/scenario1.yaml'))")
    printed = run([*PYTHON, "-c", program], cwd="/",
                  env=environment(PYTHONPATH=str(module)))
    assert printed.startswith(f"True {unpacked}/share/mneme")
