# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Goals that are poses, and inverse kinematics."""
import signal
import threading

import numpy as np
import pytest

import mneme

READY = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])
POSITION, TURN = [0.4, 0.2, 0.5], [1.0, 0, 0, 0]


@pytest.fixture(scope="module")
def panda():
    return mneme.Robot.load("panda")


def test_inverse_kinematics_finds_free_configurations_nearest_first(panda):
    goal = mneme.PoseGoal("panda_hand", POSITION, TURN)
    solutions = mneme.inverse_kinematics(panda, [goal], near=READY, ik_solutions=5)
    assert solutions.ndim == 2 and solutions.shape[1] == 7 and 1 <= len(solutions) <= 5
    distances = np.linalg.norm(solutions - READY, axis=1)
    assert np.all(np.diff(distances) >= 0)
    checker = mneme.CollisionChecker(panda, mneme.Scene())
    assert checker.is_valid(solutions).all()


def test_a_pose_out_of_reach_has_no_configuration(panda):
    far = mneme.PoseGoal("panda_hand", [2, 0, 0.5])
    none = mneme.inverse_kinematics(panda, [far])
    assert none.shape == (0, 7) and none.copy().message == none.message
    plan = mneme.plan(mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[far]))
    assert plan.status == "invalid_goal"
    assert "out of reach of link 'panda_hand' by " in plan.message
    assert none.message == plan.message


def test_no_configuration_says_why(panda):
    goal = mneme.PoseGoal("panda_hand", POSITION, TURN)
    scene = mneme.Scene()
    scene.add_sphere("ball", POSITION, 0.3)
    blocked = mneme.inverse_kinematics(panda, [goal], near=READY, scene=scene)
    assert len(blocked) == 0
    assert "link 'panda_hand' reaches the pose only in contact with obstacle 'ball'" in blocked.message
    upside_down = mneme.PoseGoal("panda_link1", [0, 0, 0.333], TURN)
    assert "reaches this position, but not this rotation" in mneme.inverse_kinematics(panda, [upside_down]).message
    with pytest.raises(mneme.Error, match="at least one"):
        mneme.inverse_kinematics(panda, [])


def test_solutions_are_an_array_like_any_other(panda):
    goal = mneme.PoseGoal("panda_hand", POSITION, TURN)
    solutions = mneme.inverse_kinematics(panda, goal, near=READY, ik_solutions=2)
    np.testing.assert_array_equal(solutions, mneme.inverse_kinematics(panda, [goal], near=READY, ik_solutions=2))
    assert isinstance(solutions, mneme.Solutions) and isinstance(solutions, np.ndarray)
    assert solutions.message == "" and solutions[:0].message == ""
    assert mneme.CollisionChecker(panda, mneme.Scene()).is_valid(solutions[0])
    np.testing.assert_array_equal(np.vstack([solutions, solutions])[-1], solutions[-1])


def test_a_plan_goes_to_a_pose_or_a_region(panda):
    for goal in (mneme.PoseGoal("panda_hand", POSITION, TURN),
                 mneme.PoseGoal("panda_hand", POSITION, TURN, position_tolerance=0.05, cone=0.2, turn=3.2)):
        problem = mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[goal])
        assert problem.goals.shape == (0, 7)
        assert [g.link for g in problem.pose_goals] == ["panda_hand"]
        plan = mneme.plan(problem, ik_solutions=3)
        assert plan.is_solved, plan.message


def test_a_pose_may_be_in_the_frame_of_a_link_at_the_start(panda, tmp_path):
    hand = panda.link_poses(READY)[panda.link_names.index("panda_hand")]
    expected = hand[:3, 3] + hand[:3, :3] @ [0.01, 0.02, 0.05]
    goal = mneme.PoseGoal("panda_hand", [0.01, 0.02, 0.05], [0, 0, 0, 1], frame="panda_hand")
    assert goal.frame == "panda_hand" and '"frame":"panda_hand"' in goal.to_json()
    problem = mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[goal])
    (placed,) = problem.pose_goals
    assert placed.frame == ""
    np.testing.assert_allclose(placed.position, expected, atol=1e-12)
    (tmp_path / "problem.yaml").write_text(mneme.Problem(panda, mneme.Scene(), READY, READY).to_yaml("panda"))
    loaded = mneme.Problem.load(tmp_path / "problem.yaml", pose_goals=[goal])
    np.testing.assert_allclose(loaded.pose_goals[0].position, expected, atol=1e-12)
    found = mneme.inverse_kinematics(panda, goal, near=READY)
    reached = panda.link_poses(found[0])[panda.link_names.index("panda_hand")]
    np.testing.assert_allclose(reached[:3, 3], expected, atol=1e-3)
    nowhere = mneme.PoseGoal("panda_hand", [0, 0, 0], frame="nose")
    for ask in (lambda: mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[nowhere]),
                lambda: mneme.inverse_kinematics(panda, nowhere, near=READY)):
        with pytest.raises(mneme.Error, match='expected a link of robot panda, got "nose"'):
            ask()


def test_poses_replace_the_goals_of_a_file(tmp_path):
    path = tmp_path / "p.yaml"
    path.write_text("robot: panda\nscene: {obstacles: []}\nstart: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]\n"
                    "goal: {link: panda_hand, position: [0.4, 0.2, 0.5]}\n")
    assert mneme.Problem.load(path).pose_goals[0].cone == pytest.approx(np.pi)
    other = mneme.Problem.load(path, pose_goals=[mneme.PoseGoal("panda_hand", POSITION, TURN)])
    np.testing.assert_allclose(other.pose_goals[0].position, POSITION)
    np.testing.assert_allclose(np.abs(other.pose_goals[0].quat_xyzw), TURN, atol=1e-12)


@pytest.mark.parametrize("make, message", [
    (lambda: mneme.PoseGoal("panda_hand", POSITION, [0, 0, 0, 0]), "length 1, got one of length 0"),
    (lambda: mneme.PoseGoal("panda_hand", POSITION, [0, 0, 0, 2]), "length 1, got one of length 2"),
    (lambda: mneme.PoseGoal("panda_hand", POSITION, TURN, axis="w"), "expected x, y or z"),
    (lambda: mneme.PoseGoal("panda_hand", POSITION, cone=0.1), "expected quat_xyzw, too"),
    (lambda: mneme.PoseGoal("panda_hand", POSITION, turn=0.1), "expected quat_xyzw, too"),
    (lambda: mneme.PoseGoal("panda_hand", POSITION, TURN, turn="any"), "turn: expected radians or 'free', got 'any'"),
])
def test_poses_that_are_none_are_errors(make, message):
    with pytest.raises(mneme.Error, match=message):
        make()


@pytest.mark.parametrize("goal, message", [
    (mneme.PoseGoal("nose", POSITION), "expected a link of robot panda"),
    (mneme.PoseGoal("panda_hand", [np.nan, 0, 0]), "finite numbers"),
    (mneme.PoseGoal("panda_hand", POSITION, TURN, position_tolerance=-1), "the region is empty"),
    (mneme.PoseGoal("panda_hand", POSITION, TURN, cone=-1), "the region is empty"),
])
def test_goals_that_a_robot_cannot_be_asked_for_are_errors(panda, goal, message):
    with pytest.raises(mneme.Error, match=message):
        mneme.inverse_kinematics(panda, [goal])
    with pytest.raises(mneme.Error, match=message):
        mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[goal])


def test_a_goal_tells_what_it_is():
    goal = mneme.PoseGoal("panda_hand", POSITION, TURN, position_tolerance=[0.1, 0, 0.2], axis="x", cone=0.3, turn=0.4)
    assert (goal.axis, goal.cone, goal.turn) == ("x", 0.3, 0.4)
    np.testing.assert_array_equal(goal.position_tolerance, [0.1, 0, 0.2])
    for one in (0.25, np.float32(0.25), np.array(0.25), [0.25] * 3, np.int64(2), 2):
        goal = mneme.PoseGoal("panda_hand", POSITION, position_tolerance=one)
        np.testing.assert_array_equal(goal.position_tolerance, np.broadcast_to(one, 3))
    for wrong in (True, 10**400, "1", None, 1j):
        with pytest.raises(TypeError, match="position_tolerance: expected an array of real numbers"):
            mneme.PoseGoal("panda_hand", POSITION, position_tolerance=wrong)
    free = mneme.PoseGoal("panda_hand", POSITION, TURN, cone=1, turn="free")
    assert (free.cone, free.turn) == (1, np.pi)


def test_control_c_ends_a_search(panda):
    far = mneme.PoseGoal("panda_hand", [2, 0, 0.5])
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        mneme.inverse_kinematics(panda, [far], ik_seeds=100000000)
    timer.join()


def test_another_goal_replaces_poses_too(panda):
    pose = mneme.PoseGoal("panda_hand", POSITION, TURN)
    problem = mneme.Problem(panda, mneme.Scene(), READY, pose_goals=[pose], end_velocity=np.full(7, 0.1))
    there = READY + 0.3
    other = problem.with_goal(there)
    assert other.pose_goals == [] and other.goals.shape == (1, 7) and other.end_velocity.shape == (0,)
    np.testing.assert_array_equal(mneme.plan(other).path[-1], there)
    assert len(problem.pose_goals) == 1 and len(problem.with_start(there).pose_goals) == 1


def test_a_problem_without_any_goal_is_an_error(panda):
    with pytest.raises(mneme.Error, match="at least one configuration"):
        mneme.Problem(panda, mneme.Scene(), READY)


@pytest.fixture(scope="module")
def fetch():
    return mneme.Robot.load("fetch")


TUCKED = np.array([0.1, 1.32, 0.6, -0.2, 1.0, 0.0, -1.6, 0.0])
UPRIGHT = mneme.OrientationConstraint("gripper_link", 0.3)


def leveled(robot, turn):
    """A free configuration with the gripper upright."""
    goal = mneme.PoseGoal("gripper_link", [0.7, turn, 0.9], [0, 0, np.sin(turn / 2), np.cos(turn / 2)])
    return mneme.inverse_kinematics(robot, [goal], near=TUCKED)[0]


def test_a_link_stays_upright_all_the_way(fetch):
    start, goal = leveled(fetch, -0.4), leveled(fetch, 0.4)
    problem = mneme.Problem(fetch, mneme.Scene(), start, goal, constraints=[UPRIGHT])
    assert [(each.link, each.angle) for each in problem.constraints] == [("gripper_link", 0.3)]
    plan = mneme.plan(problem, seed=1)
    assert plan.is_solved, plan.message
    for a, b in zip(plan.path, plan.path[1:]):
        assert max(UPRIGHT.tilt(fetch, a + part * (b - a)) for part in np.linspace(0, 1, 50)) <= UPRIGHT.angle
    assert mneme.Problem(fetch, mneme.Scene(), start, goal).with_constraints([UPRIGHT]).constraints[0].link == "gripper_link"


def test_a_start_beyond_the_cone_is_refused_with_its_tilt(fetch):
    tilted = mneme.OrientationConstraint("gripper_link", 0.1, axis=[2, 0, 0])
    np.testing.assert_array_equal(tilted.axis, [1, 0, 0])
    start = leveled(fetch, 0)
    plan = mneme.plan(mneme.Problem(fetch, mneme.Scene(), start, start, constraints=[tilted]))
    assert plan.status == "invalid_start"
    assert "gripper_link" in plan.message


def test_planners_that_keep_no_constraint_refuse_it_by_name(fetch):
    problem = mneme.Problem(fetch, mneme.Scene(), leveled(fetch, 0), leveled(fetch, 0.2), constraints=[UPRIGHT])
    with pytest.raises(mneme.Error, match="prm"):
        mneme.plan(problem, planner="prm")


@pytest.mark.parametrize("make, message", [
    (lambda robot: mneme.OrientationConstraint("gripper_link", 0.1, axis=[0, 0, 0]), "axis: expected finite numbers"),
    (lambda robot: mneme.OrientationConstraint("gripper_link", 0.1, up=[np.nan, 0, 1]), "finite"),
    (lambda robot: mneme.OrientationConstraint("nose", 0.1).tilt(robot, TUCKED), "nose"),
    (lambda robot: mneme.Problem(robot, mneme.Scene(), TUCKED, TUCKED,
                                 constraints=[mneme.OrientationConstraint("gripper_link", 0)]), "constraints: "),
    (lambda robot: mneme.Problem(robot, mneme.Scene(), TUCKED, TUCKED,
                                 constraints=[mneme.OrientationConstraint("base_link", 0.2)]), "base_link"),
])
def test_constraints_that_a_robot_cannot_keep_are_errors(fetch, make, message):
    with pytest.raises(mneme.Error, match=message):
        make(fetch)
