# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import json
import signal
import threading
import time

import numpy as np
import pytest
from conftest import raised

import mneme


def test_a_plan_is_an_array_from_start_to_goal(problem):
    plan = mneme.plan(problem, seed=3)
    assert plan.is_solved and plan.status == "solved" and plan.message == ""
    assert plan.path.dtype == np.float64 and plan.path.shape[1] == 8
    np.testing.assert_allclose(plan.path[0], problem.start, atol=1e-6)
    # Continuous joints do not wrap along a path.
    np.testing.assert_allclose(problem.robot.difference(plan.path[-1], problem.goals[0]), 0, atol=1e-6)
    assert plan.path_length == pytest.approx(problem.robot.path_length(plan.path))
    assert plan.to_row().is_path_valid
    assert mneme.CollisionChecker(problem.robot, problem.scene).is_path_free(plan.path)
    assert plan.sampler == "uniform" and plan.planner == "rrt_connect" and plan.seed == 3


def test_the_same_seed_gives_the_same_path(problem):
    own = [name for name in mneme.planner_names() if not name.startswith("ompl:")]
    assert len(own) >= 3
    for planner in own:
        first, second = (mneme.plan(problem, planner=planner, seed=5, timeout=1e6,
                                    max_iterations=300) for _ in range(2))
        np.testing.assert_array_equal(first.path, second.path)
        assert first.iterations == second.iterations


def test_planners_of_ompl_plan_from_memory_too(problem, memory):
    if "ompl:RRTConnect" not in mneme.planner_names():
        pytest.skip("mneme was built without OMPL")
    mneme.learn(problem.robot, memory, scenes=[problem], starts_per_link=1, paths_per_start=1, jobs=1)
    plan = mneme.plan(problem, memory, planner="ompl:RRTConnect", timeout=60)
    assert plan.is_solved and plan.planner == "ompl:RRTConnect" and plan.sampler == "gl"
    assert plan.to_row().is_path_valid
    assert len(plan.means) > 0
    code, message = raised(mneme.plan, problem, planner="ompl:Best")
    assert code == "invalid" and "RRTConnect" in message


def test_an_unknown_planner_is_an_error_that_lists_all_that_can_be_chosen(problem):
    code, message = raised(mneme.plan, problem, planner="nope")
    assert code == "invalid" and "'nope'" in message
    assert all(name in message for name in mneme.planner_names())


def test_json_is_that_of_the_command_line(problem):
    plan = mneme.plan(problem)
    keys = json.loads(plan.to_json())
    assert keys["solved"] is True
    np.testing.assert_allclose(keys["path"], plan.path)
    assert keys["iterations"] == plan.iterations


def test_a_trajectory_is_arrays_over_time(problem, tmp_path):
    plan = mneme.plan(problem)
    motion = plan.trajectory(0.02)
    assert motion.positions.shape == motion.velocities.shape == motion.accelerations.shape
    assert motion.positions.shape == (len(motion.times), 8) and motion.positions.dtype == np.float64
    np.testing.assert_allclose(np.diff(motion.times)[:-1], 0.02)
    assert motion.times[0] == 0 and motion.times[-1] == motion.duration > 0
    np.testing.assert_allclose(motion.positions[0], plan.path[0])
    turn = (motion.positions[-1] - plan.path[-1]) / (2 * np.pi)
    np.testing.assert_allclose(turn, np.round(turn), atol=1e-9)
    assert np.all(np.abs(motion.velocities) <= 1 + 1e-6)
    assert np.all(np.abs(motion.accelerations) <= 1 + 1e-6)
    steps = np.diff(motion.positions, axis=0)
    assert np.all(np.abs(steps) <= 0.02 * (1 + 1e-6))

    slow = plan.trajectory(velocity_scale=0.5, acceleration_scale=0.25)
    assert slow.duration == pytest.approx(2 * motion.duration)
    limits = tmp_path / "limits.yaml"
    limits.write_text("joint_limits: {joint_1: {max_velocity: 0.01}}")
    assert plan.trajectory(limits=limits).duration > motion.duration
    limits.write_text("joint_limits: {joint_3: {max_position: 2}}")
    refused = mneme.plan(problem, trajectory={"limits": limits})
    assert refused.status == "invalid_goal" and "joint 'joint_3' (value 3 of 8) is 2.054" in refused.message
    with pytest.warns(UserWarning, match="the robot's limits of position are wider"):
        plan.trajectory(limits=limits)
    assert motion.to_csv().startswith("time,joint_1.position,")
    assert json.loads(motion.to_json())["times"] == list(motion.times)
    assert "joint_names:" in motion.to_yaml()


def test_a_trajectory_that_is_announced_decides_what_is_shortened(problem):
    limits = {"acceleration_limit": 5, "dt": 0.05}
    plan = mneme.plan(problem, trajectory=limits)
    announced = plan.trajectory()
    np.testing.assert_array_equal(announced.positions, plan.trajectory(**limits).positions)
    assert announced.times[1] == pytest.approx(0.05)
    for change in ({"velocity_scale": 0.5}, {"dt": 0.02}):
        changed = plan.trajectory(**change)
        np.testing.assert_array_equal(changed.positions, plan.trajectory(**limits | change).positions)
    with pytest.raises(TypeError, match=r"^Plan.trajectory\(\) got an unexpected"):
        mneme.plan(problem, trajectory={"acceleration": 5})
    for wrong in (True, {1: 2}):
        with pytest.raises(TypeError, match=f"plan: trajectory={wrong}: expected a dict of keywords"):
            mneme.plan(problem, trajectory=wrong)
    with pytest.raises(TypeError, match=r"help\(mneme.Plan.trajectory\)"):
        plan.trajectory(xyzzy=1)


def test_announced_limits_hold_whatever_else_is_given(problem, tmp_path, monkeypatch):
    (tmp_path / "limits.yaml").write_text("joint_limits: {joint_1: {max_velocity: 0.1}}")
    monkeypatch.chdir(tmp_path)
    plan = mneme.plan(problem, trajectory={"limits": "limits.yaml"})
    monkeypatch.chdir("/")
    for change in ({}, {"dt": 0.1}, {"velocity_scale": 0.5}, {"path_tolerance": 0.1}):
        fastest = np.abs(plan.trajectory(**change).velocities[:, 0]).max()
        assert fastest <= 0.1 * change.get("velocity_scale", 1) + 1e-9


def test_samplers_of_memory_need_a_database(problem):
    for sampler in (name for name in mneme.sampler_names() if name != "uniform"):
        if mneme._mneme._needs_memory(sampler):
            with pytest.raises(TypeError, match=f"plan: the sampler '{sampler}' needs a database to sample from"):
                mneme.plan(problem, sampler=sampler)


def test_a_moving_start_is_timed_from_its_velocity(problem):
    velocity = np.zeros(problem.robot.joint_count)
    velocity[0] = -0.1
    moving = problem.with_start(problem.start, velocity)
    np.testing.assert_array_equal(moving.start_velocity, velocity)
    plan = mneme.plan(moving, trajectory={"acceleration_limit": 2})
    assert plan.is_solved, plan.message
    motion = plan.trajectory()
    np.testing.assert_allclose(motion.velocities[0], velocity, atol=1e-6)
    np.testing.assert_allclose(motion.positions[0], problem.start, atol=1e-6)
    assert moving.with_start(problem.start).start_velocity.size == 0
    refused = mneme.plan(problem.with_start(problem.start, velocity * 1e4))
    assert refused.status == "invalid_start" and "faster than its limit" in refused.message


def test_a_moving_end_is_timed_to_its_velocity(problem):
    velocity = np.zeros(problem.robot.joint_count)
    velocity[1] = 0.05
    moving = problem.with_goal(problem.goals, velocity)
    np.testing.assert_array_equal(moving.end_velocity, velocity)
    motion = mneme.plan(moving, trajectory={"acceleration_limit": 2}).trajectory()
    np.testing.assert_allclose(motion.velocities[-1], velocity, atol=1e-6)
    assert problem.robot.distance(motion.positions[-1], problem.goals[0]) < 1e-6  # up to whole turns
    assert moving.with_goal(problem.goals).end_velocity.size == 0
    refused = mneme.plan(problem.with_goal(problem.goals, velocity * 1e4))
    assert refused.status == "invalid_goal" and "faster than its limit" in refused.message


def test_a_trajectory_needs_a_path_and_settings_in_range(problem, blocked):
    code, message = raised(mneme.plan(blocked, max_iterations=50).trajectory)
    assert code == "invalid" and "there is no path" in message
    plan = mneme.plan(problem)
    for settings in ({"dt": 0}, {"dt": float("nan")}, {"velocity_scale": 0}, {"velocity_scale": 1.1},
                     {"acceleration_scale": -1}, {"path_tolerance": -1}):
        code, message = raised(plan.trajectory, **settings)
        assert code == "invalid" and f"{next(iter(settings))}=" in message
    assert raised(plan.trajectory, limits="/nowhere.yaml")[0] == "io"
    with pytest.raises(TypeError, match="velocity_scale"):
        plan.trajectory(velocity_scal=1)


def test_a_no_is_a_status(problem, blocked):
    plan = mneme.plan(blocked, max_iterations=50)
    assert plan.status == "iteration_limit" and not plan.is_solved
    assert plan.path.shape == (0, 8)
    assert plan.message
    inside = mneme.Problem(problem.robot, problem.scene, problem.start, np.full(8, 9.0))
    assert mneme.plan(inside).status == "invalid_goal"


def test_settings_are_those_that_are_declared(problem):
    help_text = mneme.plan.__doc__
    for name in ("lambda_", "sigma", "max_matches", "goal_bias", "max_gap", "starts_per_link"):
        assert f"\n{name}: " in help_text
    assert mneme.plan(problem, lambda_=0, simplify=np.bool_(False), seed=np.uint8(7)).seed == 7
    assert mneme.plan(problem, lambda_=None, max_iterations=None, kind=None, seed=7).seed == 7


@pytest.mark.parametrize("settings, words", [
    ({"lambda_": 1.5}, "lambda_=1.5 is out of range: expected 0 to 1"),
    ({"lambda_": -1}, "lambda_=-1 is out of range"),
    ({"lambda_": float("nan")}, "lambda_=nan"),
    ({"seed": -1}, "seed=-1 is out of range: expected 0 or more"),
    ({"seed": 2**64}, f"seed={2**64} is out of range: expected 0 to {2**64 - 1}"),
    ({"neighbours": 0}, "neighbours=0 is out of range: expected 1 to 1000"),
    ({"timeout": float("inf")}, "timeout=inf"),
    ({"max_matches": 10**30}, "max_matches"),
    ({"max_matches": 0}, "max_matches=0 is out of range: expected 1 to 1000000"),
    ({"max_iterations": 0}, "max_iterations=0"),
    ({"planner": "best"}, "best"),
    ({"sampler": "best"}, "best"),
    ({"isa": "mmx"}, "mmx"),
    ({"learn_budget": 1}, "learn_budget needs a database"),
    ({"remember_after": 0}, "remember_after needs a database"),
    ({"replay": 0.5}, "replay needs a database"),
])
def test_a_setting_out_of_range_is_an_error_that_names_it(problem, settings, words):
    code, message = raised(mneme.plan, problem, **settings)
    assert code == "invalid"
    assert words in message


@pytest.mark.parametrize("settings, words", [
    ({"timout": 1}, "unexpected keyword argument 'timout'; did you mean 'timeout'"),
    ({"xyzzy": 1}, "help\\(mneme.plan\\)"),
    ({"seed": 1.5}, "seed=1.5 is not a whole number"),
    ({"seed": True}, "seed=True is not a whole number"),
    ({"timeout": "soon"}, "timeout='soon' is not a number"),
    ({"timeout": None}, "timeout=None is not a number"),
    ({"simplify": 1}, "simplify=1 is not True or False"),
    ({"lambda": 0.5}, "lambda_"),
])
def test_a_setting_of_the_wrong_type_is_a_type_error(problem, settings, words):
    with pytest.raises(TypeError, match=words):
        mneme.plan(problem, **settings)


def test_other_threads_run_while_it_plans(blocked):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1

    other = threading.Thread(target=count)
    other.start()
    before = counted
    plan = mneme.plan(blocked, timeout=0.5)
    during = counted - before
    done.set()
    other.join()
    assert plan.status == "timeout"
    assert during > 1000


def test_plans_in_several_threads_are_those_of_one(problem):
    expected = [mneme.plan(problem, seed=seed).path for seed in range(4)]
    found = [None] * 4

    def solve(seed):
        found[seed] = mneme.plan(problem, seed=seed).path

    threads = [threading.Thread(target=solve, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for a, b in zip(expected, found):
        np.testing.assert_array_equal(a, b)


def test_control_c_ends_a_plan(blocked):
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    begin = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        mneme.plan(blocked, timeout=60)
    timer.join()
    assert time.monotonic() - begin < 20


def test_control_c_ends_batches_checks_and_trajectories(robot, problem):
    checker = mneme.CollisionChecker(robot, problem.scene)
    many = np.tile(problem.start, (2_000_000, 1))
    plan = mneme.plan(problem)
    calls = (lambda: checker.is_valid(many),
             lambda: checker.is_path_free(plan.path, resolution=1e-5),
             lambda: plan.trajectory(dt=1e-3, velocity_scale=0.002, acceleration_scale=0.001))
    for call in calls:
        timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            for _ in range(1000):
                call()
        timer.join()


def test_a_plan_is_a_picture_and_a_page(problem, tmp_path):
    plan = mneme.plan(problem, record=True)
    assert "<svg" in plan.to_svg()
    assert plan._repr_html_().startswith("<iframe srcdoc=")
    text = plan.view(tmp_path / "plan.html").read_text()
    assert text.lower().startswith("<!doctype html")
    assert text == plan.to_page()


def test_a_recorded_plan_is_the_same_plan_with_samples(problem):
    plain, recorded = mneme.plan(problem), mneme.plan(problem, record=True)
    np.testing.assert_array_equal(plain.path, recorded.path)
    assert json.loads(recorded.to_trace())["samples"]["shown"]
    assert not json.loads(plain.to_trace())["samples"]["shown"]


def test_what_cannot_be_shown_says_why(problem):
    inside = mneme.Problem(problem.robot, problem.scene, problem.start, np.full(8, 9.0))
    assert "<pre>" in mneme.plan(inside)._repr_html_()


def test_a_plan_in_space_has_a_page_too(tmp_path):
    robot = mneme.Robot.load("panda")
    scene = mneme.Scene()
    scene.add_sphere("far", [3, 0, 0], 0.1)
    middle = robot.limits.mean(axis=1)
    plan = mneme.plan(mneme.Problem(robot, scene, middle, middle + 0.1))
    assert plan.is_solved, plan.message
    assert plan._repr_html_()
    mneme.view(plan, tmp_path / "plan.html")
    assert (tmp_path / "plan.html").stat().st_size > 100


def test_where_only_spheres_touch_plans_are_checked_by_exact_geometry(tmp_path):
    urdf = tmp_path / "arm.urdf"
    urdf.write_text("""<robot name="arm"><link name="base"/><link name="upper"/><link name="forearm">
      <collision><origin xyz="0.4 0 0"/><geometry><box size="0.7 0.1 0.1"/></geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
      <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
      <joint name="lift" type="revolute"><parent link="upper"/><child link="forearm"/>
      <origin xyz="0.5 0 0"/><axis xyz="0 -1 0"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>""")
    robot = mneme.Robot.load(str(urdf))
    scene = mneme.Scene()
    scene.add_box("plate", [0.9, 0, 0.103], [0.4, 0.4, 0.1])
    plan = mneme.plan(mneme.Problem(robot, scene, [0, 0], [[1.2, 0.7]]), seed=1)
    assert plan.is_solved and plan.to_row().is_path_valid
    assert plan.notes[0].endswith("this pair is checked by exact geometry, 3 mm away")
    assert mneme.CollisionChecker(robot, plan.checked_scene).is_path_free(plan.path)
    assert not mneme.CollisionChecker(robot, scene).is_path_free(plan.path)


def test_velocities_that_are_not_finite_are_refused(problem):
    velocity = np.zeros(problem.robot.joint_count)
    velocity[0] = np.nan
    with pytest.raises(mneme.Error, match="start_velocity: expected finite numbers"):
        problem.with_start(problem.start, velocity)
