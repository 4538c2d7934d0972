# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from conftest import raised

import mneme


def cell(problem, count):
    """Problems with circles that are moved a little in each."""
    problems = []
    for i in range(count):
        circles = [[-5.75 + 0.01 * i, -1.15, 1.73], [-2.1, -2.85 - 0.01 * i, 1.88]]
        problems.append(problem.with_scene(mneme.Scene.from_circles(circles)))
    return problems


def test_each_problem_has_the_path_that_it_has_alone(problem):
    problems = cell(problem, 6)
    plans = mneme.plan_many(problems, jobs=2, seed=4)
    assert len(plans) == 6 and plans.is_solved.all() and plans.status == ["solved"] * 6
    assert plans.path_offsets[0] == 0 and plans.path_offsets[-1] == len(plans.paths)
    for i, one in enumerate(problems):
        path = plans.paths[plans.path_offsets[i]:plans.path_offsets[i + 1]]
        np.testing.assert_array_equal(path, mneme.plan(one, seed=4).path)
    assert (plans.seeds == 4).all() and (plans.total_times_s >= plans.planning_times_s).all()
    assert len(plans.times) == 0 and plans.trajectory_offsets[-1] == 0
    assert repr(plans) == "<mneme.Plans: 6 of 6 solved>"


def test_trajectories_are_columns_that_numpy_saves(problem, tmp_path):
    plans = mneme.plan_many(cell(problem, 3), dt=0.05, velocity_scale=0.5)
    np.savez(tmp_path / "plans.npz", **plans.columns())
    with np.load(tmp_path / "plans.npz") as columns:
        assert set(columns) >= {"paths", "times", "positions", "velocities", "accelerations", "status"}
        begin, end = columns["trajectory_offsets"][1:3]
        assert columns["times"][begin] == 0 and columns["times"][begin + 1] == pytest.approx(0.05)
        np.testing.assert_allclose(columns["positions"][begin], problem.start, atol=1e-6)
        alone = mneme.plan(cell(problem, 2)[1], trajectory={"dt": 0.05, "velocity_scale": 0.5}).trajectory()
        np.testing.assert_array_equal(columns["velocities"][begin:end], alone.velocities)


def test_what_cannot_be_planned_has_a_status_and_a_message(problem, blocked):
    plans = mneme.plan_many([problem, blocked], max_iterations=200, timeout=60)
    assert list(plans.is_solved) == [True, False]
    assert plans.status[1] == "iteration_limit" and "200" in plans.messages[1]


def test_wrong_calls_are_errors(problem, memory):
    assert raised(mneme.plan_many, [problem], memory, remember_after=0)[0] == "invalid"
    other = mneme.Robot.planar([1, 1])
    pair = mneme.Problem(other, mneme.Scene(), [0, 0], [1, 1])
    assert "same number of joints" in raised(mneme.plan_many, [problem, pair])[1]
    assert "no effect without dt" in raised(mneme.plan_many, [problem], velocity_scale=0.5)[1]
    with pytest.raises(mneme.Error, match="plan_many: jobs=-5 is out of range: 0 or more"):
        mneme.plan_many([problem], jobs=-5)
    assert len(mneme.plan_many([])) == 0
