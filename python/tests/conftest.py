# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import mneme

CIRCLES = [[-5.75, -1.15, 1.73], [-2.1, -2.85, 1.88]]
START = [2.677, 1.211, 0.015, 0.374, -0.388, 0.592, -0.726, 1.724]
GOAL = [-3.1, -1.349, 2.054, 0.563, -3.021, 0.76, 0.434, -0.002]


@pytest.fixture(scope="session")
def robot():
    return mneme.Robot.load("planar8")


@pytest.fixture()
def problem(robot):
    """The geometry of the paper's first scenario: two circles with a gap of 1 m."""
    return mneme.Problem(robot, mneme.Scene.from_circles(CIRCLES), START, GOAL, name="two")


@pytest.fixture()
def blocked(robot):
    """A problem that no planner solves: the first link cannot cross the x axis."""
    wall = [[side * x, 0, 0.3] for x in np.arange(0.5, 12, 0.4) for side in (1, -1)]
    up = np.zeros(8)
    up[0] = 1.57
    return mneme.Problem(robot, mneme.Scene.from_circles(wall), up, -up, name="blocked")


@pytest.fixture()
def memory(robot, tmp_path):
    """An empty database that may be written."""
    with mneme.Database.open(tmp_path / "memory.db", robot, mode="create") as database:
        yield database


def raised(call, *arguments, **keywords):
    """The mneme.Error of a call, as (code, message)."""
    with pytest.raises(mneme.Error) as caught:
        call(*arguments, **keywords)
    return caught.value.code, str(caught.value)
