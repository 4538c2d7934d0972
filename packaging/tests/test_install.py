# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""An installed mneme: the program, the library and the Python module."""
import json
import re
import subprocess

import pytest
from conftest import BUILD, SOURCE, environment, run

GUIDE = SOURCE / "docs/cpp.md"


def test_the_program_finds_its_robots_and_scenes(installed):
    info = json.loads(run([installed / "bin/mneme", "robot", "info", "planar8", "--json"], cwd="/"))
    assert info["path"] == f"{installed}/share/mneme/robots/planar8.urdf"
    doctor = json.loads(run([installed / "bin/mneme", "doctor", "--json"], cwd="/"))
    details = [check["detail"] for check in doctor["checks"]]
    assert f"{installed}/share/mneme/scenes/planar" in details


def test_a_moved_installation_still_works(installed, tmp_path):
    moved = tmp_path / "elsewhere"
    run(["cp", "-r", installed, moved])
    info = json.loads(run([moved / "bin/mneme", "robot", "info", "panda", "--json"], cwd="/"))
    assert info["path"].startswith(str(moved))


def test_manual_and_completions_are_there(installed):
    assert (installed / "share/man/man1/mneme.1").read_text().startswith(".TH MNEME 1")
    assert "_mneme" in (installed / "share/bash-completion/completions/mneme").read_text()
    assert (installed / "share/zsh/vendor-completions/_mneme").read_text().startswith("#compdef")
    assert "complete -c mneme" in (installed / "share/fish/vendor_completions.d/mneme.fish").read_text()


def guide_program():
    return re.search(r"^```cpp\n(.*?)^```", GUIDE.read_text(), re.MULTILINE | re.DOTALL).group(1)


def test_another_project_finds_and_links_the_library(installed, tmp_path):
    (tmp_path / "guide.cpp").write_text(guide_program())
    run(["cmake", "-S", SOURCE / "packaging/tests/consumer", "-B", tmp_path / "build",
         f"-DCMAKE_PREFIX_PATH={installed}", f"-DGUIDE_PROGRAM={tmp_path}/guide.cpp",
         "-DCMAKE_CXX_FLAGS=-O0"])
    run(["cmake", "--build", tmp_path / "build"])
    printed = run([tmp_path / "build/consumer", tmp_path / "memory.db"], cwd="/")
    assert re.match(r"\d+\.\d+\.\d+ .*planar/threaded_b2.yaml", printed)
    assert run([tmp_path / "build/measures"], cwd="/").startswith("problem,set,planner,sampler,seed")
    if (installed / "lib/cmake/mneme/mneme-service-targets.cmake").exists():
        assert run([tmp_path / "build/serves"], cwd="/").startswith("serves at http://127.0.0.1:")


def compile_guide(folder, packages):
    """Runs the guide's line for builds without CMake."""
    (folder / "first_plan.cpp").write_text(guide_program())
    line = re.search(r"^g\+\+ .*pkg-config.*$", GUIDE.read_text(), re.MULTILINE).group(0)
    (folder / "scenes").symlink_to(SOURCE / "scenes")
    printed = run(["sh", "-c", line], cwd=folder, env=environment(PKG_CONFIG_PATH=str(packages)))
    assert re.fullmatch(r"\d+ configurations in \d+\.\d+ ms\n", printed)


def test_pkg_config_finds_the_built_library(tmp_path):
    compile_guide(tmp_path, BUILD)


def test_pkg_config_finds_the_installed_library(installed, tmp_path):
    compile_guide(tmp_path, installed / "lib/pkgconfig")
    for path in (installed / "lib/pkgconfig").glob("*.pc"):
        assert str(SOURCE) not in path.read_text()


def test_no_file_of_the_library_names_this_tree(installed):
    for path in (installed / "lib/cmake/mneme").glob("*.cmake"):
        assert str(SOURCE) not in path.read_text(), path


def test_a_version_that_is_too_new_is_refused(installed, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(x LANGUAGES CXX)\n"
        "find_package(mneme 99 REQUIRED)\n")
    done = subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build",
                           f"-DCMAKE_PREFIX_PATH={installed}"], capture_output=True, text=True,
                          timeout=300)
    assert done.returncode != 0 and "99" in done.stderr


def test_the_python_module_finds_what_came_with_it(installed):
    module = installed / "lib/python3/dist-packages"
    if not (module / "mneme").exists():
        pytest.skip("the Python module was not built")
    path = run(["/usr/bin/python3", "-c", "import mneme; print(mneme.find_scene('planar/grid.yaml'))"],
               cwd="/", env=environment(PYTHONPATH=str(module)))
    assert path.startswith(f"{installed}/share/mneme/scenes")
