# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks: stages as dicts, plans, and refusals."""
import json
import pathlib

import numpy as np
import pytest

import mneme

EXAMPLE = pathlib.Path(__file__).parents[2] / "examples/pick_and_place/task.yaml"
HOME = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])


def cell():
    scene = mneme.Scene()
    scene.add_box("table", [0.5, 0, 0.1], [0.6, 0.8, 0.2])
    scene.add_cylinder("cup", [0.5, -0.1, 0.2505], radius=0.035, length=0.1)
    return mneme.Robot.load("panda"), scene


def grasp(count):
    turn = {"turn": "z", "from": -3, "to": 3, "count": count}
    return {"frame": "cup", "position": np.array([-0.115, 0, 0]),
            "quat_xyzw": [0, np.sqrt(0.5), 0, np.sqrt(0.5)], "vary": [turn]}


def test_a_cup_is_lifted():
    line = {"direction": [0, 0, 1], "along": "panda_hand", "distance": 0.08, "to": grasp(20)}
    task = mneme.Task(*cell(), HOME, [
        {"name": "reach", "move": "next"}, {"name": "approach", "line": line}, {"attach": "cup"},
        {"name": "lift", "line": {"direction": [0, 0, 1], "distance": 0.1}}])
    plan = mneme.plan_task(task, seed=1)
    assert plan.is_solved, plan.message
    assert [stage["kind"] for stage in plan.stages] == ["move", "line", "attach", "line"]
    assert 0 <= plan.stages[1]["alternative"] < 20 == plan.stages[1]["alternatives"]
    np.testing.assert_allclose(plan.stages[0]["path"][0], HOME)
    for before, after in zip(plan.stages, plan.stages[1:]):
        np.testing.assert_allclose(before["path"][-1], after["path"][0], atol=1e-6)
    motion = plan.trajectory(dt=0.05)
    assert motion.positions.shape == (len(motion.times), 7)
    assert [stage["name"] for stage in motion.stages] == ["reach", "approach", "attach 3", "lift"]
    begins = [stage["begin_s"] for stage in motion.stages]
    assert begins == sorted(begins) and begins[2] == begins[3] < motion.duration
    assert motion.to_csv().splitlines()[-1].endswith(",lift")
    assert json.loads(motion.to_json())["stages"] == motion.stages
    assert 0 < plan.path_time_s < motion.duration
    assert json.loads(plan.to_json())["status"] == "solved"


def test_the_example_is_solved():
    plan = mneme.plan_task(mneme.Task.load(str(EXAMPLE)))
    assert plan.is_solved, plan.message


def test_wrong_stages_are_refused():
    with pytest.raises(mneme.Error, match="stage 'detach 1': expected a held object"):
        mneme.Task(*cell(), HOME, [{"detach": "cup"}])
    with pytest.raises(mneme.Error, match="unknown key"):
        mneme.Task(*cell(), HOME, [{"x": 1}])
    task = mneme.Task(*cell(), HOME, [{"attach": "cup"}])
    with pytest.raises(TypeError):
        mneme.plan_task(task, speed=1)
    plan = mneme.plan_task(task)
    assert not plan.is_solved and "move there first" in plan.message
    with pytest.raises(mneme.Error, match="there is no plan"):
        plan.trajectory()


def test_keywords_of_plan_hold_for_tasks():
    task = mneme.Task.load(str(EXAMPLE))
    plan = mneme.plan_task(task, timeout=1000, improve=1000, improve_rounds=3)
    assert json.loads(plan.to_json())["plans"] > 1
    for keyword in ({"remember_after": 0}, {"replay": 0.5}, {"learn_budget": 1}):
        with pytest.raises(mneme.Error, match=f"plan_task: {next(iter(keyword))} needs a database"):
            mneme.plan_task(task, **keyword)
    with pytest.raises(TypeError, match=r"plan_task\(\) got an unexpected .*help\(mneme.plan_task\)"):
        mneme.plan_task(task, xyzzy={"foo": 1})
    with pytest.raises(TypeError, match=r"help\(mneme.TaskPlan.trajectory\)"):
        plan.trajectory(xyzzy=1)


def test_what_is_no_number_is_named():
    with pytest.raises(TypeError, match="Task: stages: <object .* is no number, text, list, dict or array"):
        mneme.Task(*cell(), HOME, [{"move": object()}])
