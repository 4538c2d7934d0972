# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Straight lines of a link."""
import numpy as np
import pytest

import mneme

READY = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])
POSITION, TURN = [0.4, 0.1, 0.5], [1.0, 0, 0, 0]


@pytest.fixture(scope="module")
def panda():
    return mneme.Robot.load("panda")


def test_a_link_moves_by_a_vector(panda):
    line = mneme.Line("panda_hand", by=(0, 0.1, -0.1))
    result = mneme.plan_line(panda, line, READY)
    assert result.is_whole and result.fraction == 1 and not result.reason
    assert result.path.shape == (len(result.fractions), 7)
    assert np.array_equal(result.path[0], READY)
    assert 0 < result.position_deviation <= line.position_tolerance == 1e-4
    assert result.rotation_deviation <= line.rotation_tolerance
    assert "configurations" in repr(result)


def test_a_line_starts_at_a_pose_on_several_branches(panda):
    line = mneme.Line(from_=mneme.PoseGoal("panda_hand", POSITION, TURN), by=(0, 0, 0.05),
                      frame="panda_hand")
    result = mneme.plan_line(panda, line, line_paths=3)
    assert line.link == "panda_hand"
    assert result.is_whole and result.branches >= 3 and len(result.others) == 2
    assert all(other.shape[1] == 7 for other in result.others)


def test_a_line_ends_before_an_obstacle_and_says_why(panda):
    scene = mneme.Scene()
    scene.add_box("shelf", [0.4, 0.1, 0.2], [0.2, 0.2, 0.04])
    to = mneme.PoseGoal("panda_hand", [0.4, 0.1, 0.25])
    line = mneme.Line(from_=mneme.PoseGoal("panda_hand", POSITION, TURN), to=to)
    result = mneme.plan_line(panda, line, scene=scene)
    assert not result.is_whole and 0 < result.fraction < 1
    assert "'shelf'" in result.reason


def test_a_line_without_a_path_has_rows_of_the_robots_joints(panda):
    to = mneme.PoseGoal("panda_hand", [3, 0, 0.5])
    far = mneme.Line(from_=mneme.PoseGoal("panda_hand", [2, 0, 0.5], TURN), to=to)
    result = mneme.plan_line(panda, far)
    assert not result.is_whole and result.path.shape == (0, 7)


def test_wrong_lines_are_errors(panda):
    with pytest.raises(mneme.Error, match="by, to: expected one of both"):
        mneme.Line("panda_hand")
    with pytest.raises(mneme.Error, match="free_axis: expected x, y or z, got 'w'"):
        mneme.Line("panda_hand", by=(0, 0, 1), free_axis="w")
    with pytest.raises(mneme.Error, match="start: expected one"):
        mneme.plan_line(panda, mneme.Line("panda_hand", by=(0, 0, 0.1)))
    with pytest.raises(mneme.Error, match='frame "table" is no link'):
        mneme.plan_line(panda, mneme.Line("panda_hand", by=(0, 0, 0.1), frame="table"), READY)
    with pytest.raises(mneme.Error, match="has no length"):
        mneme.plan_line(panda, mneme.Line("panda_hand", by=(0, 0, 0)), READY)
