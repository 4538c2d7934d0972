# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""mneme.Client plans what mneme.plan plans, over HTTP and over a Unix socket."""
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

import mneme

PROGRAM = pathlib.Path(os.environ["MNEME_BUILD"]) / "mneme"


@pytest.fixture(scope="module", params=["tcp", "unix"])
def client(request, tmp_path_factory):
    if not PROGRAM.exists():
        pytest.skip("the program was not built")
    listen = "127.0.0.1:0" if request.param == "tcp" else f"unix:{tmp_path_factory.mktemp('s')}/socket"
    service = subprocess.Popen([PROGRAM, "serve", "--robot", "planar8", "--listen", listen],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    line = service.stdout.readline()
    if not line:
        pytest.skip("this mneme has no subcommand serve")
    with mneme.Client(line.split(" at ")[1].strip()) as client:
        yield client
    service.terminate()
    assert service.wait(timeout=60) == 0


@pytest.fixture(scope="module")
def problem():
    return mneme.Problem.load(mneme.find_scene("planar/scenario1.yaml"))


def test_a_plan_is_that_of_this_process(client, problem):
    settings = {"seed": 5, "max_iterations": 100000, "sampler": "uniform"}
    remote = client.plan(problem, trace=True, clearance=True, **settings)
    local = mneme.plan(problem, **settings)
    assert remote.is_solved and remote.status == "solved" and remote.message == ""
    assert np.array_equal(remote.path, local.path)
    for name in ("iterations", "path_length", "planner", "sampler", "seed", "remembered"):
        assert getattr(remote, name) == getattr(local, name)
    assert json.loads(remote.to_json())["least_clearance"] > 0
    assert json.loads(remote.to_trace())["format"] == "mneme-trace"
    with pytest.raises(AttributeError):
        remote.nothing
    with pytest.raises(ValueError):
        client.plan(problem).to_trace()


def test_scenes_are_kept_and_edited(client, problem):
    names = client.put_scene("cell", problem.scene)
    assert len(names) == len(problem.scene)
    inside = client.plan(start=problem.start, goals=problem.goals, scene="cell", seed=2)
    assert np.array_equal(inside.path, client.plan(problem, seed=2).path)
    more = mneme.Scene()
    more.add_sphere("new", [20, 0, 0], 1)
    assert client.edit_scene("cell", remove=[names[0]], scene=more) == [*names[1:], "new"]
    client.delete_scene("cell")
    with pytest.raises(mneme.Error) as refused:
        client.plan(start=problem.start, goals=problem.goals, scene="cell")
    assert refused.value.code == "invalid" and "there is no scene" in str(refused.value)


def test_checks_and_health(client):
    scene = mneme.Scene.from_circles([[4, 0, 0.5]])
    free, touching = client.check([[1.5] + [0] * 7, [0] * 8], scene)
    assert free["valid"] and touching["contacts"][0]["other"] == "circle_1"
    assert client.health()["robot"] == "planar8"


def test_what_is_wrong_is_said(client, problem):
    with pytest.raises(mneme.Error, match="lamda"):
        client.plan(problem, lamda=1)
    with pytest.raises(TypeError):
        client.plan()
    with pytest.raises(ValueError, match="expected http"):
        mneme.Client("127.0.0.1:1")
    hopeless = client.plan(problem, max_iterations=1)
    assert not hopeless.is_solved and hopeless.message and len(hopeless.path) == 0


def test_inverse_kinematics_is_that_of_this_process(client, problem):
    robot = problem.robot
    goal = mneme.PoseGoal("link_8", [9, 3, 0], position_tolerance=[0.1, 0.1, 0])
    remote = client.inverse_kinematics(goal, near=problem.start, scene=problem.scene, seed=4, ik_solutions=3)
    local = mneme.inverse_kinematics(robot, [goal], near=problem.start, scene=problem.scene, seed=4, ik_solutions=3)
    assert len(local) >= 3 and np.array_equal(remote, local)
    assert client.inverse_kinematics([mneme.PoseGoal("link_8", [90, 0, 0])]).size == 0


def test_goals_may_be_poses(client, problem):
    goal = mneme.PoseGoal("link_8", [9, 3, 0], position_tolerance=0.5)
    remote = client.plan(start=problem.start, goals=[goal], scene=problem.scene, seed=3)
    posed = mneme.Problem(problem.robot, problem.scene, problem.start, pose_goals=[goal])
    assert np.array_equal(remote.path, mneme.plan(posed, seed=3, sampler="uniform").path)
    assert np.array_equal(remote.path, client.plan(posed, seed=3).path)
    assert client.plan(problem, goals=[goal, problem.goals[0]]).is_solved


def test_what_the_robot_carries_goes_along(client, problem):
    rod = mneme.Scene()
    rod.add_sphere("rod", [1, 0, 0], 0.3)
    carrying = mneme.Problem(problem.robot.attach("link_8", rod), problem.scene, problem.start, problem.goals)
    settings = {"seed": 2, "sampler": "uniform", "max_iterations": 1000000, "timeout": 50}
    local = mneme.plan(carrying, **settings)
    remote = client.plan(carrying, **settings)
    assert remote.status == local.status and np.array_equal(remote.path, local.path)
    named = [{"name": "rod", "link": "link_8", "type": "sphere", "p": [1, 0, 0], "radius": 0.3}]
    assert client.plan(problem, attached=named, **settings).status == local.status


def test_points_travel_as_numbers(client):
    cloud = mneme.Scene()
    cloud.add_points("cloud", [[4, 0.1, 0], [4, -0.1, 0]], radius=0.15)
    stretched, turned = client.check([[0] * 8, [1.5] + [0] * 7], cloud)
    assert not stretched["valid"] and stretched["contacts"][0]["other"] == "cloud" and turned["valid"]


def test_threads_of_a_plan_are_those_of_this_process(client, problem):
    settings = {"seed": 6, "threads": 2, "sampler": "uniform", "max_iterations": 100000}
    try:
        remote = client.plan(problem, **settings)
    except mneme.Error as refused:
        assert os.cpu_count() == 1 and "all threads" in str(refused)
        return
    assert np.array_equal(remote.path, mneme.plan(problem, **settings).path)
