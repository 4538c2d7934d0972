# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import re
import signal
import sqlite3
import threading
import time

import numpy as np
import pytest
from conftest import CIRCLES, raised

import mneme

FAST = {"starts_per_link": 1, "paths_per_start": 1, "jobs": 1}


@pytest.fixture()
def learned(robot, memory, problem):
    summary = mneme.learn(robot, memory, scenes=[problem], **FAST)
    assert summary.learned == 1 and summary.components > 0
    return memory


def test_memory_is_learned_and_drawn_from(problem, learned):
    plan = mneme.plan(problem, learned, retrieve_after=0)
    assert plan.is_solved and plan.sampler == "gl"
    (primitive,) = plan.primitives
    assert primitive["obstacles"] == ["circle_1", "circle_2"]
    assert primitive["similarity_errors"] == pytest.approx([0], abs=1e-9)
    assert plan.means.shape[1] == 8 and len(plan.means) > 0
    checker = mneme.CollisionChecker(problem.robot, problem.scene)
    assert checker.is_valid(plan.means.astype(float)).all()


def test_memory_modes_are_automatic_off_or_the_papers(problem, learned):
    assert mneme.plan(problem, learned, memory="off").primitives == []
    assert len(mneme.plan(problem, learned, memory="paper", max_iterations=1).means) > 0
    with pytest.raises(mneme.Error, match="auto, off or paper"):
        mneme.plan(problem, learned, memory="on")
    with pytest.raises(TypeError, match="memory"):
        mneme.plan(problem, learned, memory=True)


def test_rows_can_be_looked_at(robot, problem, learned, tmp_path):
    assert len(learned) == 1
    row = learned[0]
    assert row["key"].shape == (6,)
    assert row["means"].shape[1] == 8 and row["means"].dtype == np.float32
    np.testing.assert_array_equal(learned[-1]["means"], row["means"])
    with pytest.raises(IndexError):
        learned[1]
    (primitive,) = mneme.decompose(robot, problem.scene)
    (match,) = learned.find(primitive)
    assert match["similarity_error"] == pytest.approx(0, abs=1e-9)
    assert learned.find(primitive, similarity=1e-9, max_matches=0)
    turned = mneme.Primitive.from_circles([0, 50, 1, 3, 50, 1])
    assert learned.find(turned) == []
    assert learned.info()["samplers"] == 1
    assert mneme.Database.open(tmp_path / "memory.db").info()["robot_hash"] == robot.hash
    assert mneme.Database.verify(tmp_path / "memory.db") == []
    assert mneme.similarity_error(primitive.key, primitive.key) == 0


def test_all_rows_are_arrays_that_numpy_saves(learned, tmp_path):
    arrays = learned.to_arrays()
    np.savez(tmp_path / "rows.npz", **arrays)
    row, saved = learned[0], np.load(tmp_path / "rows.npz")
    assert sorted(saved) == sorted(arrays)
    assert list(saved["ids"]) == [row["id"]] and list(saved["kinds"]) == [row["kind"]]
    np.testing.assert_array_equal(saved["keys"][: saved["key_ends"][0]], row["key"])
    np.testing.assert_array_equal(saved["means"][: saved["mean_ends"][0]], row["means"])
    assert saved["means"].dtype == np.float32 and saved["seeds"].dtype == np.uint64
    assert saved["factors"].shape == (0, 36) and list(saved["settings"]) == [row["settings"]]


def test_a_database_that_may_not_be_in_memory_finds_the_same(robot, problem, learned, tmp_path):
    (primitive,) = mneme.decompose(robot, problem.scene)
    with mneme.Database.open(tmp_path / "memory.db", robot, memory_mib=0) as partial:
        (match,) = partial.find(primitive)
        np.testing.assert_array_equal(match["means"], learned[0]["means"])
    assert (tmp_path / "memory.db.index").exists()
    for wrong in (-1, 10**7):
        with pytest.raises(mneme.Error, match="memory_mib"):
            mneme.Database.open(tmp_path / "memory.db", robot, memory_mib=wrong)


def test_a_plan_says_what_it_taught(robot, problem, tmp_path):
    path = tmp_path / "paths.db"
    with mneme.Database.open(path, robot, mode="create") as database:
        plan = mneme.plan(problem, database, kind="paths", remember_after=0)
        assert plan.remembered and plan.remember_failure == ""
        database.flush()
        assert len(database) == 1 and database[0]["kind"].startswith("paths/")
    read_only = mneme.Database.open(path, robot)
    plan = mneme.plan(problem, read_only, remember_after=0, replay=0)
    assert plan.is_solved and not plan.remembered
    assert "read" in plan.remember_failure


def test_a_plan_says_why_no_known_task_was_replayed(robot, problem, tmp_path):
    def plan(asked, database, **settings):
        return mneme.plan(asked, database, kind="paths", replay=0.5, **settings)

    with mneme.Database.open(tmp_path / "paths.db", robot, mode="create") as database:
        first = plan(problem, database, remember_after=0)
        assert first.replayed == 0 and first.replay == "not replayed: no task is known"
        database.flush()
        again = plan(problem, database)
        assert again.replayed == 1 and again.replay.startswith("replayed row 1, 0.000 rad away")
        np.testing.assert_allclose(again.path[[0, -1]], first.path[[0, -1]], atol=1e-9)

        elsewhere = problem.with_goal([*problem.start[:7], problem.start[7] + 0.1])
        assert plan(elsewhere, database).replay.startswith(
            "not replayed: the nearest known task is ")

        scene = problem.scene.copy()
        lengths = np.linalg.norm(np.diff(again.path, axis=0), axis=1)
        longest = int(np.argmax(lengths))
        middle = again.path[longest : longest + 2].mean(axis=0)
        scene.add_sphere("in_the_way", robot.link_poses(middle)[-1][:3, 3], 0.05)
        blocked = plan(problem.with_scene(scene), database)
        assert blocked.is_solved
        assert re.search(r"row 1, 0.000 rad away, is blocked at \d+ %: link '\w+' touches "
                         "obstacle 'in_the_way'$", blocked.replay)
    assert mneme.plan(problem).replay == ""


def test_the_keys_of_all_kinds_have_a_similarity_error():
    sizes = {"pairs": 6, "body_pairs": 18, "motions": 3, "paths": 17}
    assert set(sizes) == set(mneme.kind_names())
    for kind, size in sizes.items():
        assert mneme.similarity_error(np.arange(size), np.arange(size), kind) == 0
        assert mneme.similarity_error(np.arange(size), np.arange(size) + 1, kind) > 0
        for wrong in (0, 1, 8):
            with pytest.raises(mneme.Error, match=f"'{kind}'"):
                mneme.similarity_error(np.arange(wrong), np.arange(wrong), kind)
    with pytest.raises(mneme.Error, match="shape"):
        mneme.similarity_error(np.arange(6), np.arange(8))
    with pytest.raises(mneme.Error, match="body_pairs"):
        mneme.similarity_error(np.arange(6), np.arange(6), "nope")


def test_a_kind_of_memory_is_chosen_by_name(robot, problem, memory):
    assert [p.gap for p in mneme.decompose(robot, problem.scene, kind="pairs")] == \
        [p.gap for p in mneme.decompose(robot, problem.scene)]
    for call in (lambda **kind: mneme.decompose(robot, problem.scene, **kind),
                 lambda **kind: mneme.learn(robot, memory, scenes=[problem], **kind),
                 lambda **kind: mneme.learn_from_paths(robot, memory, problem.scene, [], **kind),
                 lambda **kind: mneme.plan(problem, memory, **kind)):
        code, message = raised(call, kind="nope")
        assert code == "invalid" and "'nope'" in message
        assert all(name in message for name in mneme.kind_names())
        with pytest.raises(TypeError, match="kind"):
            call(kind=3)
    for setting in ("kind", "memory"):
        code, message = raised(mneme.plan, problem, memory, **{setting: "\udcff"})
        assert code == "invalid" and "udcff" in message


def test_learning_again_skips_what_is_known(robot, learned, problem):
    again = mneme.learn(robot, learned, scenes=[problem.scene], **FAST)
    assert (again.learned, again.skipped) == (0, 1)


def test_primitives_are_learned_from_keys_and_ranges(robot, memory):
    keys = np.array([[3, 1, 1.2, 3, -1.5, 1.0], [4, 1, 1.2, 4, -1.5, 1.0]])
    progress = []
    summary = mneme.learn(robot, memory, primitives=keys, on_progress=progress.append, **FAST)
    assert summary.learned == 2 == len(memory)
    assert progress[-1].done == progress[-1].total == 2
    code, message = raised(mneme.learn, robot, memory, primitives="no/grid.yaml")
    assert code == "io" and "no/grid.yaml" in message


def test_what_a_callback_raises_ends_the_learning(robot, memory):
    keys = [[3 + 0.2 * i, 1, 1.2, 3 + 0.2 * i, -1.5, 1.0] for i in range(3)]

    def complain(progress):
        raise ZeroDivisionError("enough")

    with pytest.raises(ZeroDivisionError, match="enough"):
        mneme.learn(robot, memory, primitives=keys, on_progress=complain, **FAST)


def test_control_c_leaves_a_valid_database(robot, tmp_path):
    path = tmp_path / "memory.db"
    grid = mneme.find_scene("planar/grid.yaml")
    with mneme.Database.open(path, robot, mode="create") as database:
        timer = threading.Timer(0.4, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            mneme.learn(robot, database, primitives=grid, jobs=1)
        timer.join()
    # A file is made with its first row.
    assert not path.exists() or mneme.Database.verify(path) == []


def test_paths_teach_an_arm_in_space(tmp_path):
    robot = mneme.Robot.load("panda")
    scene = mneme.Scene()
    scene.add_box("left", [0.4, 0.25, 0.5], [0.2, 0.2, 0.2])
    scene.add_box("right", [0.4, -0.25, 0.5], [0.2, 0.2, 0.2])
    path = np.linspace(robot.limits.mean(axis=1) - 0.2, robot.limits.mean(axis=1), 5)
    with mneme.Database.open(tmp_path / "panda.db", robot, mode="create") as database:
        rows = mneme.learn_from_paths(robot, database, scene, [path], reach=1.0, max_gap=1.0)
        assert rows == len(database) == 1
        assert mneme.learn_from_paths(robot, database, scene, [path], reach=1.0, max_gap=1.0) == 0
        assert 0 < len(database[0]["means"]) <= 5
        assert raised(mneme.learn_from_paths, robot, database, scene, [path[:, :3]])[0] == "invalid"
        assert raised(mneme.learn_from_paths, robot, database, scene, [path], reach=0)[0] == \
            "invalid"


def test_problems_teach_an_arm_in_space_whole_paths_unless_told_otherwise(tmp_path):
    robot = mneme.Robot.load("panda")
    ready = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])
    problem = mneme.Problem(robot, mneme.Scene(), ready, ready + 0.2)
    with mneme.Database.open(tmp_path / "panda.db", robot, mode="create") as database:
        summary = mneme.learn(robot, database, problems=[problem], paths=2, jobs=1)
        assert summary.rows == len(database) == 1  # Both paths go straight.
        assert [kind["kind"] for kind in database.info()["kinds"]] == ["paths/1"]


def test_a_miss_is_learned_within_the_budget(problem, memory):
    plan = mneme.plan(problem, memory, learn_budget=5, **{k: FAST[k] for k in FAST if k != "jobs"})
    assert plan.primitives[0]["is_learned"]
    assert plan.learning_time_s > 0
    assert len(memory) == 1


def test_a_kind_that_does_not_learn_on_a_miss_says_why(problem, memory):
    code, message = raised(mneme.plan, problem, memory, kind="paths", learn_budget=1)
    assert code == "unsupported" and "'paths'" in message and "learn-budget" in message


def test_results_outlive_the_database(problem, learned):
    plan = mneme.plan(problem, learned, retrieve_after=0)
    learned.close()
    assert plan.primitives[0]["similarity_errors"]
    assert len(plan.means) > 0
    code, message = raised(mneme.plan, problem, learned)
    assert code == "invalid" and "closed" in message


def test_closing_stores_what_was_remembered_while_plans_are_alive(robot, problem, tmp_path):
    path = tmp_path / "paths.db"
    with mneme.Database.open(path, robot, mode="create") as database:
        plan = mneme.plan(problem, database, kind="paths", remember_after=0)
    assert len(mneme.Database.open(path, robot)) == 1
    assert plan.is_solved and repr(database) == "<mneme.Database, closed>"
    assert raised(len, database) == ("invalid", "the database was closed")
    database.close()
    with pytest.raises(mneme.Error, match="paths.db"):
        plan.view(path)


def test_control_c_ends_the_wait_for_a_locked_file(robot, problem, tmp_path):
    database = mneme.Database.open(tmp_path / "paths.db", robot, mode="create")
    mneme.plan(problem, database, kind="paths", remember_after=0)
    database.flush()
    other = sqlite3.connect(tmp_path / "paths.db", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    back = mneme.Problem(robot, problem.scene, problem.goals[0], problem.start)
    mneme.plan(back, database, kind="paths", remember_after=0)
    code, message = raised(database.flush, 0.1)
    assert code == "io" and "1 rows are not stored yet: the first attempt has not ended" in message
    assert raised(database.flush, np.nan)[0] == raised(database.flush, -1)[0] == "invalid"
    begin = time.monotonic()
    for wait, warning in ((lambda: database.flush(60), contextlib.nullcontext()),
                          (database.close, pytest.warns(UserWarning, match="1 rows are lost"))):
        timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with warning, pytest.raises(KeyboardInterrupt):
            wait()
        timer.join()
    assert time.monotonic() - begin < 8
    other.execute("ROLLBACK")
    assert len(mneme.Database.open(tmp_path / "paths.db", robot)) == 1


def test_wrong_databases_are_errors(robot, tmp_path):
    other = mneme.Robot.planar([1.0, 1.0, 1.0])
    path = tmp_path / "memory.db"
    assert raised(mneme.Database.open, path, robot)[0] == "io"
    path.touch()
    mneme.Database.open(path, robot, mode="create").close()
    assert raised(mneme.Database.open, path, other)[0] == "wrong_robot"
    assert raised(mneme.Database.open, path, robot, mode="w")[0] == "invalid"
    assert raised(mneme.Database.open, path, mode="create")[0] == "invalid"
    (tmp_path / "text.db").write_text("no database\n" * 100)
    assert raised(mneme.Database.open, tmp_path / "text.db", robot)[0] == "corrupt"
    with mneme.Database.open(path, robot) as read_only:
        keys = [[3, 1, 1.2, 3, -1.5, 1.0]]
        assert raised(mneme.learn, robot, read_only, primitives=keys, **FAST)[0] == "io"


def test_wrong_lessons_are_errors(robot, memory, problem):
    with pytest.raises(TypeError, match="primitives or scenes"):
        mneme.learn(robot, memory)
    with pytest.raises(TypeError, match="mneme.Scene or mneme.Problem"):
        mneme.learn(robot, memory, scenes=["scene.yaml"])
    with pytest.raises(TypeError, match="did you mean"):
        mneme.learn(robot, memory, scenes=[problem], start_per_link=1)
    assert "(n, 6)" in raised(mneme.learn, robot, memory, primitives=CIRCLES)[1]
    assert raised(mneme.learn, robot, memory, scenes=[problem], jobs=-1)[0] == "invalid"
    assert raised(mneme.learn, robot, memory, scenes=[problem], starts_per_link=0)[0] == "invalid"


def test_memory_is_learned_from_problems(problem, memory):
    robot, asked = problem.robot, {"problems": [problem], "paths": 1, "kind": "paths", "jobs": 1}
    summary = mneme.learn(robot, memory, timeout=60, **asked)
    assert summary.learned == 1 and summary.rows == len(memory) > 0, summary.unsolved
    assert mneme.learn(robot, memory, **asked).skipped == 1
    assert mneme.plan(problem, memory).is_solved
    for wrong in ({}, {"problems": [problem], "scenes": [problem]}, {"problems": [problem.scene]}):
        with pytest.raises(TypeError):
            mneme.learn(robot, memory, **wrong)
    assert raised(mneme.learn, robot, memory, problems=[problem], paths=0)[0] == "invalid"
    other = mneme.Robot.planar([1, 1, 1])
    assert raised(mneme.learn, other, memory, problems=[problem])[0] == "invalid"


def test_memory_applies_to_a_robot_with_other_shapes(problem, memory, tmp_path):
    thick = mneme.Robot.planar([1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7], thickness=0.002)
    if thick.kinematics_hash != problem.robot.kinematics_hash:
        pytest.skip("the planar arm of the tests has other limits")
    assert thick.hash != problem.robot.hash
    assert memory.info()["kinematics_hash"] == thick.kinematics_hash
    other = mneme.Problem(thick, problem.scene, problem.start, problem.goals)
    assert mneme.plan(other, memory).is_solved
