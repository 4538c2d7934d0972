# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""What can be sent to another process, and what is made there."""
import copy
import multiprocessing
import pickle
import re

import numpy as np
import pytest

import mneme

START, GOAL = np.zeros(3), np.array([1.0, 0.5, -0.5])


def arm():
    return mneme.Robot.planar([1, 1, 1])


def make_scene():
    rng = np.random.default_rng(1)
    scene = mneme.Scene("cell")
    scene.add_sphere("ball", [0.1, 2 / 3, 0], 0.2)
    scene.add_box("box", [-2, 1, 0], [1 / 7, 1, 1], [0, 0, np.sin(0.3), np.cos(0.3)])
    scene.add_box("box", [-2, 2, 0], [1, 1, 1])
    scene.add_points("cloud", rng.uniform(2, 3, (500, 3)), 0.01)
    scene.add_mesh("mesh", rng.uniform(-3, -2, (4, 3)), [[0, 1, 2], [1, 2, 3]])
    scene.allow("link_3", "ball")
    return scene


def split(text):
    """The words of a JSON text, and its numbers."""
    number = r"-?\d+\.?\d*(?:e[-+]?\d+)?"
    return re.sub(number, "", text), [float(x) for x in re.findall(number, text)]


def test_a_scene_comes_back_the_same():
    scene = make_scene()
    for other in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert other is not scene and other.name == "cell"
        assert other.obstacle_names == scene.obstacle_names
        words, numbers = split(other.to_compact_json())
        assert words == split(scene.to_compact_json())[0]
        # Rotations are written as quaternions, which rounds them.
        np.testing.assert_allclose(numbers, split(scene.to_compact_json())[1], rtol=0, atol=1e-15)


def test_goals_and_constraints_come_back_the_same():
    turn = [np.sin(0.3), 0, 0, np.cos(0.3)]
    goal = mneme.PoseGoal("hand", [0.1, 0.2, 1 / 3], turn, position_tolerance=[0, 0.1, 0.2], axis="x", cone=0.1,
                          turn="free", frame="base")
    again = pickle.loads(pickle.dumps(goal))
    assert again.to_json() == goal.to_json() and (again.frame, again.turn) == ("base", np.pi)
    upright = mneme.OrientationConstraint("hand", 0.2, axis=[1, 2, 3], up=[0, 1, 0])
    again = pickle.loads(pickle.dumps(upright))
    assert (again.link, again.angle) == ("hand", 0.2)
    np.testing.assert_array_equal(again.axis, upright.axis)
    np.testing.assert_array_equal(again.up, upright.up)


def test_empty_solutions_and_refusals_come_back_with_their_reasons():
    far = mneme.inverse_kinematics(arm(), mneme.PoseGoal("link_3", [9, 0, 0]))
    again = pickle.loads(pickle.dumps(far))
    assert again.shape == far.shape == (0, 3) and again.message == far.message != ""
    some = mneme.inverse_kinematics(arm(), mneme.PoseGoal("link_3", [1, 1, 0]))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(some)), some)
    busy = pickle.loads(pickle.dumps(mneme.Busy("too many", 1.5)))
    assert str(busy) == "too many" and busy.retry_after_s == 1.5


def test_what_is_made_in_each_process_says_so(tmp_path):
    robot = arm()
    problem = mneme.Problem(robot, mneme.Scene(), START, GOAL)
    with mneme.Database.open(tmp_path / "m.db", robot, mode="create") as database:
        for thing, instead in ((robot, "Robot cannot be pickled: load or make it in each process"),
                               (problem, "Problem cannot be pickled: load it in each process"),
                               (database, "Database cannot be pickled: open it in each process"),
                               (mneme.CollisionChecker(robot, mneme.Scene()), "make it in each process"),
                               (mneme.plan(problem), "Plan cannot be pickled: send its path"),
               (mneme.plan(problem).trajectory(0.1), "Trajectory cannot be pickled: send its times")):
            for send in (pickle.dumps, copy.copy):
                with pytest.raises(TypeError, match=instead):
                    send(thing)


def plan_there(question):
    scene, start, goal = question
    return mneme.plan(mneme.Problem(arm(), scene, start, goal), seed=1).path


def test_workers_plan_in_scenes_that_they_are_sent():
    scene = mneme.Scene()
    scene.add_sphere("ball", [2, 1.8, 0], 0.3)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (path,) = pool.map(plan_there, [(scene, START, GOAL)])
    np.testing.assert_array_equal(path, plan_there((scene, START, GOAL)))
