# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files that Python writes, and those that it does not write over."""
import os
import pathlib
import stat

import pytest
from conftest import CIRCLES, GOAL, START, raised

import mneme

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])


@pytest.fixture()
def cell(tmp_path):
    """The directory of a robot, a scene and a problem of both."""
    (tmp_path / "arm.urdf").write_text((SOURCE / "robots/planar8.urdf").read_text())
    (tmp_path / "arm.srdf").write_text("<robot name='planar8'/>")
    (tmp_path / "scene.yaml").write_text(mneme.Scene.from_circles(CIRCLES).to_yaml())
    (tmp_path / "problem.yaml").write_text(f"robot: ./arm.urdf\nscene: scene.yaml\nstart: {START}\ngoal: {GOAL}\n")
    return tmp_path


def check_kept(call, path, what):
    """That `call` refuses to write the file `path`, in the words of the command line."""
    before = path.read_bytes()
    code, message = raised(call, path)
    assert code == "invalid"
    assert message == f"'{path}' is also an input ({what}); choose another output"
    assert path.read_bytes() == before


def test_a_page_is_not_written_over_what_the_problem_was_read_from(cell):
    plan = mneme.plan(mneme.Problem.load(cell / "problem.yaml"))
    (cell / "link.html").symlink_to(cell / "scene.yaml")
    for name, what in (("problem.yaml", "a file of the problem"), ("scene.yaml", "a file of the problem"),
                       ("link.html", "a file of the problem"), ("arm.urdf", "the robot"), ("arm.srdf", "the robot")):
        check_kept(plan.view, cell / name, what)
    for name in ("arm.stl", "arm.STL"):
        assert "but writes none" in raised(plan.view, cell / name)[1]
    assert not (cell / "arm.STL").exists()


def test_robots_and_scenes_know_their_files_whatever_problem_they_are_put_into(cell):
    scene = mneme.Scene.load(cell / "scene.yaml")
    box = mneme.Scene()
    box.add_sphere("tool", [0, 0, 0], 0.01)
    robot = mneme.Robot.load(cell / "arm.urdf").attach("link_8", box)
    for in_scene in (scene, scene.copy()):
        plan = mneme.plan(mneme.Problem(robot, in_scene, START, GOAL))
        check_kept(plan.view, cell / "arm.urdf", "the robot")
        check_kept(plan.view, cell / "scene.yaml", "a file of the scene")
    loaded = mneme.Problem.load(cell / "problem.yaml")
    plan = mneme.plan(mneme.Problem(loaded.robot, loaded.scene, START, GOAL))
    check_kept(plan.view, cell / "arm.urdf", "the robot")
    check_kept(plan.view, cell / "scene.yaml", "a file of the problem")


def test_no_output_is_written_over_a_memory(robot, problem, tmp_path):
    path = tmp_path / "memory.db"
    with mneme.Database.open(path, robot, mode="create") as database:
        mneme.learn(robot, database, scenes=[problem], starts_per_link=1, paths_per_start=1, jobs=1)
        check_kept(mneme.plan(problem, database).view, path, "the memory")
        check_kept(lambda csv: mneme.bench(problem, database, csv=csv), path, "the memory")
    assert raised(mneme.plan(problem).view, path)[1] == f"'{path}' is a database of experience; choose another output"


def test_rows_are_not_written_over_a_problem(cell):
    problem = mneme.Problem.load(cell / "problem.yaml")
    check_kept(lambda csv: mneme.bench([problem], csv=csv), cell / "problem.yaml", "a file of a problem")
    check_kept(lambda csv: mneme.bench([problem], csv=csv), cell / "arm.urdf", "the robot")


def test_a_page_replaces_a_file_as_a_whole_and_leaves_nothing_else(problem, tmp_path):
    plan = mneme.plan(problem)
    page = tmp_path / "pages" / "plan.html"
    page.parent.mkdir()
    (tmp_path / "link.html").symlink_to(page)
    assert plan.view(tmp_path / "link.html") == tmp_path / "link.html"
    assert plan.view(os.fsencode(page)) == os.fsencode(page)
    assert (tmp_path / "link.html").is_symlink() and page.read_text() == plan.to_page()
    for wrong in (page.parent, tmp_path / "none" / "plan.html"):
        code, message = raised(plan.view, wrong)
        assert code == "io" and message.startswith(f"{wrong}: cannot be written: ")
    with pytest.raises(TypeError, match="view: expected a Plan, got None"):
        mneme.view(None, page)
    plan.view("/dev/null")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    assert sorted(file.name for file in tmp_path.rglob("*")) == ["link.html", "pages", "plan.html"]
