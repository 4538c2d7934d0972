# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Certified cells."""
import signal
import threading

import numpy as np
import pytest

import mneme

REGION = """robot: panda
scene:
  obstacles:
    - {name: table, type: box, position: [0.5, 0, 0.1], size: [0.6, 1.2, 0.04]}
start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
goal: {link: panda_hand, position: [0.5, 0, 0.35], quat_xyzw: [1, 0, 0, 0]}
region: {x: 0.04, y: 0.04}
"""


@pytest.fixture(scope="module")
def region(tmp_path_factory):
    path = tmp_path_factory.mktemp("cell") / "region.yaml"
    path.write_text(REGION)
    return str(path)


def test_a_cell_answers_certified_tasks_and_survives_its_file(region, tmp_path):
    cell = mneme.Cell.build(region, boxes=20, seconds=1000)
    assert cell.proven_count == cell.box_count > 0
    assert cell.coverage()["proven"] > 0.95
    answer = cell.ask([0.01, -0.02, 0, 0])
    assert answer.tier == "certified" and answer.path.shape[1] == 7
    cell.save(str(tmp_path / "a.cell"))
    again = mneme.Cell.load(str(tmp_path / "a.cell"))
    assert again.is_of_this_world
    assert np.array_equal(again.ask([0.01, -0.02, 0, 0]).path, answer.path)
    done = again.verify(samples=20)
    assert done["proven"] == done["boxes"] and done["in_contact"] == 0


def test_certified_answers_of_a_box_take_equally_long(region):
    cell = mneme.Cell.build(region, boxes=20, seconds=1000)
    motions = mneme.CellMotions(cell)
    answers = [cell.ask([x, -0.02, 0, 0]) for x in (0.01, 0.0101)]
    assert answers[0].tier == "certified" and answers[0].box == answers[1].box
    timed = [motions.trajectory(answer, 0.01, jerk_limit=500) for answer in answers]
    assert timed[0].duration == timed[1].duration
    assert timed[0].is_of_box is True
    for answer, motion in zip(answers, timed):
        assert np.allclose(motion.positions[[0, -1]], answer.path[[0, -1]], atol=1e-6)
    with pytest.raises(mneme.Error, match="the answer has no path"):
        motions.trajectory(cell.ask([1, 0, 0, 0]))
    with pytest.raises(TypeError):
        motions.trajectory(answers[0], colour="red")


def test_answers_of_another_cell_have_no_motion(region, tmp_path):
    (tmp_path / "other.yaml").write_text(REGION.replace("y: 0.04", "y: 0.05"))
    paths = region, str(tmp_path / "other.yaml")
    cell, other = (mneme.Cell.build(path, boxes=20, seconds=1000) for path in paths)
    with pytest.raises(mneme.Error, match="of another cell"):
        mneme.CellMotions(cell).trajectory(other.ask([0.01, -0.02, 0, 0]))


def test_control_c_ends_long_calls_of_a_cell(region):
    cell = mneme.Cell.build(region, boxes=1)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        cell.coverage(samples=2_000_000_000)
    timer.join()


def test_wrong_words_of_a_cell_raise(region, tmp_path):
    cell = mneme.Cell.build(region, boxes=1)
    with pytest.raises(mneme.Error, match="start: expected one of start"):
        cell.ask([0, 0, 0, 0], start="tray")
    assert cell.ask([1, 0, 0, 0]).message.startswith("the task is beyond the region: x is 1,")
    with pytest.raises(mneme.Error, match="task: z is nan, expected a finite number"):
        cell.ask([0, 0, float("nan"), 0])
    for timeout in ("nan", "inf", "-1"):
        with pytest.raises(mneme.Error, match=f"timeout: expected 0 to 1e6 seconds, got {timeout}"):
            cell.ask([0, 0, 0, 0], timeout=float(timeout))
    assert cell.ask([1, 0, 0, 0]).path.shape == (0, 7)
    with pytest.raises(mneme.Error, match="the output exists and is no cell"):
        cell.save(region)
    with open(region) as text:
        assert text.read() == REGION
    with pytest.raises(mneme.Error, match="samples: expected at least 1, got -1"):
        cell.coverage(samples=-1)
    with pytest.raises(mneme.Error, match="samples: expected 0 or more, got -1"):
        cell.verify(samples=-1)
    with pytest.raises(TypeError):
        mneme.Cell.build(region, colour="red")
    (tmp_path / "b.cell").write_text("no cell")
    with pytest.raises(mneme.Error, match="mneme cell"):
        mneme.Cell.load(str(tmp_path / "b.cell"))
