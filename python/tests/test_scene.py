# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import re
import signal
import tracemalloc

import numpy as np
import pytest
from conftest import CIRCLES, GOAL, START, raised

import mneme


def test_a_scene_is_built_from_shapes_and_written_as_yaml():
    scene = mneme.Scene("kitchen")
    scene.add_sphere("ball", [1, 0, 0.5], 0.1)
    scene.add_box("table", (1, 0, 0.4), np.array([0.8, 1.2, 0.04]))
    scene.add_box("table", (1, 0, 0.2), [0.1, 0.1, 0.36], quat_xyzw=[0, 0, 0.5**0.5, 0.5**0.5])
    scene.add_cylinder("can", [1, 0.3, 0.5], radius=0.03, length=0.12)
    scene.add_capsule("bar", [0, 0, 1], [1, 0, 1], 0.02)
    assert scene.obstacle_names == ["ball", "table", "can", "bar"]
    assert len(scene) == 4
    again = mneme.Scene.parse(scene.to_yaml())
    assert again.name == "kitchen"
    assert again.obstacle_names == scene.obstacle_names


def test_shipped_scenes_are_found():
    problem = mneme.Problem.load(mneme.find_scene("planar/scenario1.yaml"))
    assert problem.name == "scenario1"
    assert len(problem.scene) == 2
    assert problem.start.shape == (8,)
    assert problem.goals.shape == (1, 8)
    assert raised(mneme.find_scene, "no/such.yaml")[0] == "io"


def test_wrong_scenes_are_errors(tmp_path):
    scene = mneme.Scene()
    for add in (lambda: scene.add_sphere("a", [0, 0, 0], -1),
                lambda: scene.add_sphere("a", [0, 0, 0], np.nan),
                lambda: scene.add_sphere("a", [0, 0], 1),
                lambda: scene.add_sphere("a", [0, np.inf, 0], 1),
                lambda: scene.add_sphere("", [0, 0, 0], 1),
                lambda: scene.add_box("a", [0, 0, 0], [1, 0, 1]),
                lambda: scene.add_box("a", [0, 0, 0], [1, 1, 1], [0, 0, 0, 0]),
                lambda: scene.add_cylinder("a", [0, 0, 0], 1, 0),
                lambda: mneme.Scene.from_circles([[0, 0]])):
        assert raised(add)[0] == "invalid"
    assert len(scene) == 0
    with pytest.raises(TypeError):
        scene.add_sphere("a", "here", 1)
    code, message = raised(mneme.Scene.parse, "obstacles: [", "kitchen.yaml")
    assert code == "parse" and "kitchen.yaml" in message
    assert raised(mneme.Scene.load, tmp_path / "none.yaml")[0] == "io"


def test_a_problem_takes_one_goal_or_several(robot):
    scene = mneme.Scene.from_circles(CIRCLES)
    assert mneme.Problem(robot, scene, START, GOAL).goals.shape == (1, 8)
    assert mneme.Problem(robot, scene, START, [GOAL, START]).goals.shape == (2, 8)
    assert raised(mneme.Problem, robot, scene, START, GOAL[:7])[0] == "invalid"
    assert raised(mneme.Problem, robot, scene, START, np.zeros((0, 8)))[0] == "invalid"
    assert "start" in raised(mneme.Problem, robot, scene, START[:3], GOAL)[1]


def test_no_edit_of_a_scene_is_lost(robot):
    scene = mneme.Scene.from_circles(CIRCLES)
    problem = mneme.Problem(robot, scene, START, GOAL)
    assert mneme.plan(problem).is_solved
    plan = mneme.plan(problem)
    problem.scene.add_sphere("on the first link", [-0.7, 0.35, 0], 0.3)
    assert len(scene) == len(problem.scene) == len(plan.problem.scene) == 3
    assert mneme.plan(problem).status == "invalid_start"
    assert mneme.plan(plan.problem).status == "invalid_start"
    scene.remove("on the first link")
    assert mneme.plan(problem).is_solved
    del scene
    assert len(problem.scene) == 2


def test_obstacles_are_moved_removed_and_copied(robot):
    scene = mneme.Scene.from_circles(CIRCLES)
    copy = scene.copy()
    scene.add_box("table", [1, 0, 0.5], [1, 1, 0.1])
    scene.add_cylinder("table", [1, 0, 0.2], 0.05, 0.5)
    scene.move("table", [2, 0, 0.5], quat_xyzw=[0, 0, 0.5**0.5, 0.5**0.5])
    moved = mneme.Scene()
    moved.add_box("table", [2, 0, 0.5], [1, 1, 0.1], quat_xyzw=[0, 0, 0.5**0.5, 0.5**0.5])
    moved.add_cylinder("table", [2, 0, 0.2], 0.05, 0.5, quat_xyzw=[0, 0, 0.5**0.5, 0.5**0.5])
    scene.remove(copy.obstacle_names[0])
    scene.remove(copy.obstacle_names[1])
    scene.name = moved.name
    assert scene.to_yaml() == moved.to_yaml()
    scene.move("table", [1, 0, 0.5])
    assert len(copy) == 2 and len(scene) == 1
    for edit in (lambda: scene.remove("chair"), lambda: scene.move("chair", [0, 0, 0])):
        code, message = raised(edit)
        assert code == "invalid" and "'chair'" in message
    assert raised(scene.move, "table", [0, np.nan, 0])[0] == "invalid"


def test_a_thousand_moves_leave_a_body_rigid(robot):
    def turn(k):
        return np.array([0, 0.6, 0.8, 0]) * np.sin(0.1 * k) + [0, 0, 0, np.cos(0.1 * k)]

    scene = mneme.Scene("s")
    scene.add_box("b", [0, 0, 0], [0.1, 0.2, 0.3], turn(3))
    scene.add_cylinder("b", [0.5, 0, 0], 0.1, 0.2, turn(5))
    first = mneme.Scene.parse(scene.to_yaml())
    for k in range(1000):
        scene.move("b", [0.001 * k, 0, 0.3], turn(k) if k % 2 else None)
    scene.move("b", [0, 0, 0], turn(3))
    assert_same(scene, first)
    mneme.CollisionChecker(robot, scene)


def assert_same(scene, other):
    """Checks that two scenes differ by rounding only."""
    numbers = [np.array(re.findall(r"-?\d[\d.e-]*", one.to_yaml()), float) for one in (scene, other)]
    np.testing.assert_allclose(numbers[0], numbers[1], atol=1e-9)


def test_a_move_to_where_a_body_is_changes_nothing():
    turn = [0, 0, 0.5**0.5, 0.5**0.5]

    def box(scene):
        scene.add_box("o", [1, 0, 0], [0.2, 0.4, 0.6])

    def ball(scene):
        scene.add_sphere("o", [0, 1, 0], 0.1)

    def bar(scene):
        scene.add_capsule("o", [0, 0, 0], [1, 0, 0], 0.1)

    for shapes in ([box], [ball], [bar], [ball, box], [bar, box], [ball, bar], [bar, ball], [ball, ball]):
        scene = mneme.Scene()
        for add in shapes:
            add(scene)
        scene.move("o", [1, 2, 3], turn)
        once = scene.copy()
        scene.move("o", [1, 2, 3], turn)
        assert_same(scene, once)
    scene = mneme.Scene()
    bar(scene)
    scene.move("o", [0, 0, 0], [0.5**0.5, 0, 0, 0.5**0.5])
    along_y = mneme.Scene()
    along_y.add_capsule("o", [0, 0.5, 0], [0, -0.5, 0], 0.1)
    assert_same(scene, along_y)


def test_edits_beyond_what_planning_takes_are_refused():
    scene = mneme.Scene()
    scene.add_box("box", [0, 0, 0], [1, 1, 1])
    scene.add_points("cloud", [[0, 0, 0]], 0.1, position=[1, 0, 0])
    before = scene.to_yaml()
    for edit in (lambda: scene.move("box", [1e5, 0, 0]), lambda: scene.replace_points("cloud", 0, [[1e9, 0, 0]]),
                 lambda: mneme.Scene.from_circles([[1e5, 0, 1]])):
        assert "expected a shape within 10000 m" in raised(edit)[1]
    for edit in (lambda: scene.replace_points("cloud", 0, [[np.nan, 0, 0]]),
                 lambda: mneme.Scene.from_circles([[np.nan, 0, 1]])):
        assert "expected finite coordinates" in raised(edit)[1]
    assert raised(scene.add_sphere, b"\xff", [0, 0, 0], 1) == ("invalid", r"name: expected UTF-8 text, got '\xff'")
    assert scene.to_yaml() == before


def test_an_interrupted_addition_adds_nothing():
    scene = mneme.Scene()
    cloud = np.random.default_rng(1).uniform(-2, 2, (1_000_000, 3)).astype(np.float32)

    def interrupt(*_):
        if len(scene) == 0:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
    try:
        with pytest.raises(KeyboardInterrupt):
            while True:  # however fast the machine is
                scene.add_points("cloud", cloud, 0.001)
                scene.remove("cloud")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(scene) == 0


def test_problems_vary_and_share_robot_and_scene(problem):
    other = problem.with_start(GOAL).with_goal([START, GOAL])
    np.testing.assert_array_equal(other.start, GOAL)
    assert other.goals.shape == (2, 8) and problem.goals.shape == (1, 8)
    np.testing.assert_array_equal(problem.start, START)
    assert other.scene is problem.scene
    empty = problem.with_scene(mneme.Scene())
    assert len(empty.scene) == 0 and len(problem.scene) == 2
    assert raised(problem.with_start, [0, 0])[0] == "invalid"
    none = ("invalid", "goals: expected at least one configuration, got none")
    assert raised(problem.with_goal, np.zeros((0, 8))) == none
    assert raised(mneme.Problem, problem.robot, problem.scene, problem.start, goals=[]) == none
    pose = mneme.PoseGoal("link_8", [9, 3, 0])
    both = mneme.Problem(problem.robot, problem.scene, START, goals=[], pose_goals=[pose])
    assert len(both.pose_goals) == 1


def test_arrays_that_stand_for_something_are_read_only(problem):
    for array in (problem.start, problem.goals, problem.robot.limits, mneme.plan(problem).path):
        with pytest.raises(ValueError):
            array[0] = 1
        assert array.copy().flags.writeable


def test_a_problem_is_written_and_read_back(problem, tmp_path):
    path = tmp_path / "two.yaml"
    path.write_text(problem.to_yaml("planar8"))
    again = mneme.Problem.load(path, goal=START)
    np.testing.assert_array_equal(again.start, problem.start)
    np.testing.assert_array_equal(again.goals, [START])
    assert again.robot.hash == problem.robot.hash
    assert raised(mneme.Problem.load, tmp_path / "none.yaml")[0] == "io"
    shared = mneme.Problem.load(path, robot=problem.robot)
    np.testing.assert_array_equal(shared.start, problem.start)
    assert shared.robot.hash == problem.robot.hash
    assert "pass only the Robot" in raised(mneme.Problem.load, path, robot=problem.robot, group="arm")[1]
    with pytest.raises(TypeError, match="robot: expected a name, a path or a Robot, got 3"):
        mneme.Problem.load(path, robot=3)
    assert raised(mneme.Problem.load, path, robot="nobody")[0] == "io"
    assert raised(mneme.list_problems, tmp_path / "none.json")[0] == "io"


def test_a_checker_answers_for_one_configuration_or_many(problem):
    checker = mneme.CollisionChecker(problem.robot, problem.scene)
    assert checker.is_valid(problem.start) is True
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (500, 8))
    answers = checker.is_valid(q)
    assert answers.dtype == np.bool_ and answers.shape == (500,)
    assert 0 < answers.sum() < 500
    for row, answer in zip(q[:50], answers):
        assert bool(answer) == checker.is_valid(row) == (not checker.contacts(row))
    assert checker.is_valid(np.zeros((0, 8))).shape == (0,)
    assert "(n, 8)" in raised(checker.is_valid, np.zeros((2, 7)))[1]


def test_motions_and_margins_are_checked(robot):
    scene = mneme.Scene()
    scene.add_sphere("post", [0, 6, 0], 0.5)
    checker = mneme.CollisionChecker(robot, scene)
    left, right = np.eye(8)[0] * 0.5, np.eye(8)[0] * 2.5
    assert checker.is_motion_valid(np.zeros(8), left)
    assert not checker.is_motion_valid(left, right)
    contact = checker.contacts(np.eye(8)[0] * np.pi / 2)[0]
    assert contact["other"] == "post" and not contact["is_self"]
    assert checker.is_path_free([np.zeros(8), left])
    assert not checker.is_path_free([left, right])
    wide = mneme.CollisionChecker(robot, scene, margin=5.9)
    assert wide.margin == pytest.approx(5.9) and mneme.CollisionChecker(robot, scene).margin == 0
    assert not wide.is_valid(np.zeros(8)) and checker.is_valid(np.zeros(8))
    assert raised(mneme.CollisionChecker, robot, scene, margin=-1)[0] == "invalid"
    assert raised(mneme.CollisionChecker, robot, scene, isa="mmx")[0] == "invalid"
    for resolution in (np.nan, 0, 1e-9):
        assert raised(mneme.CollisionChecker, robot, scene, resolution=resolution)[0] == "invalid"
    assert raised(checker.is_path_free, [left], 1e-9)[0] == "invalid"
    assert raised(checker.contacts, np.full(8, np.nan))[0] == "invalid"


def test_links_may_touch_obstacles_that_allow_it(robot):
    scene = mneme.Scene.from_circles([[1.0, 0.0, 0.2]])
    assert not mneme.CollisionChecker(robot, scene).is_valid(np.zeros(8))
    name = scene.obstacle_names[0]
    for link in robot.link_names:
        scene.allow(link, name)
    assert mneme.CollisionChecker(robot, scene).is_valid(np.zeros(8))
    assert raised(scene.allow, "link_1", "shelf")[0] == "invalid"
    scene.allow("hand", name)
    assert "'hand'" in raised(mneme.CollisionChecker, robot, scene)[1]


def test_what_a_robot_carries_is_checked(robot):
    cup = mneme.Scene()
    cup.add_sphere("cup", [1, 0, 0], 0.5)
    carrying = robot.attach(robot.link_names[-1], cup)
    assert carrying.attached == ["cup"] and robot.attached == []
    assert carrying.hash == robot.hash
    tip = robot.link_poses(np.zeros(8))[-1, :3, 3]
    scene = mneme.Scene.from_circles([[tip[0] + 1, 0.6, 0.2]])
    assert mneme.CollisionChecker(robot, scene).is_valid(np.zeros(8))
    contacts = mneme.CollisionChecker(carrying, scene).contacts(np.zeros(8))
    assert [c["link"] for c in contacts] == ["cup"]
    assert carrying.detach("cup").attached == []
    assert raised(robot.detach, "cup")[0] == "invalid"
    assert raised(robot.attach, "hand", cup)[0] == "invalid"
    assert raised(robot.attach, "link_8", mneme.Scene())[0] == "invalid"


def test_a_mesh_of_a_file_or_of_arrays_can_be_attached(robot, tmp_path):
    corners = [[1, 0.5, -0.2], [1.5, 0.5, -0.2], [1, 1, -0.2], [1, 0.5, 0.4]]
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    of_arrays = mneme.Scene()
    of_arrays.add_mesh("part", corners, faces)
    (tmp_path / "part.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                                       + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
    (tmp_path / "scene.yaml").write_text("obstacles: [{name: part, type: mesh, file: part.obj}]\n")
    tip = robot.link_poses(np.zeros(8))[-1, :3, 3]
    near = mneme.Scene.from_circles([[tip[0] + 1.15, 0.65, 0.1]])
    for scene in (of_arrays, mneme.Scene.load(tmp_path / "scene.yaml")):
        carrying = robot.attach(robot.link_names[-1], scene)
        assert [c["link"] for c in mneme.CollisionChecker(carrying, near).contacts(np.zeros(8))] == ["part"]
    cloud = mneme.Scene()
    cloud.add_points("part", corners, 0.01)
    assert "mesh without a radius" in raised(robot.attach, "link_8", cloud)[1]


def test_hostile_meshes_are_errors(tmp_path):
    node = '<node id="n"><instance_node url="#n"/></node>'
    ply = "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\n"
    for name, text, fault in [
        ("loop.dae", f"<COLLADA><library_visual_scenes><visual_scene>{node}</visual_scene>"
                     "</library_visual_scenes></COLLADA>", "this node contains an instance of itself"),
        ("count.ply", ply + "property float z\nend_header\n0 0 0\n", "ends before all elements"),
        ("far.obj", "v 0 0 0\nf 1 2 4294967297\n", "there are 1 before it"),
    ]:
        (tmp_path / name).write_text(text)
        scene = f"obstacles: [{{name: part, type: mesh, file: {tmp_path / name}}}]\n"
        assert fault in raised(mneme.Scene.parse, scene)[1]


def test_points_and_meshes_are_added_from_arrays(robot):
    scene = mneme.Scene()
    points = np.full((1000, 3), [2.0, 0.5, 0.0])
    points[7, 1] = np.nan
    assert scene.add_points("scan", points, radius=0.05) == 1
    corners = [[2, -1, -1], [3, -1, 1], [2.5, 1, 0]]
    scene.add_mesh("sheet", corners, [[0, 1, 2]], position=[0, 3, 0])
    assert scene.obstacle_names == ["scan", "sheet"]
    straight = np.zeros(8)
    checker = mneme.CollisionChecker(robot, scene)
    assert checker.is_valid(straight)
    scene.replace_points("scan", 0, [[2.0, 0.0, 0.0]])
    touching = mneme.CollisionChecker(robot, scene)
    assert not touching.is_valid(straight)
    assert [c["other"] for c in touching.contacts(straight)] == ["scan"]
    assert checker.is_valid(straight)


def test_points_of_the_robot_itself_are_dropped(tmp_path):
    robot = mneme.Robot.load("planar8")
    scene = mneme.Scene()
    scene.add_points("scan", [[1, 0, 0], [9, 9, 0]], radius=0.05)
    file = tmp_path / "p.yaml"
    file.write_text(mneme.Problem(robot, scene, np.zeros(8), np.ones(8)).to_yaml("planar8"))
    assert mneme.Problem.load(file).warnings == []
    assert "1 of 2 points" in mneme.Problem.load(file, self_filter=0.02).warnings[0]
    assert len(mneme.drop_own_points(scene, robot, np.zeros(8), 0)) == 1
    assert mneme.drop_own_points(scene, robot, np.zeros(8), 0) == []
    assert raised(mneme.drop_own_points, scene, robot, np.zeros(8), -1)[0] == "invalid"


def test_objects_of_a_planning_scene_stand_in_its_frame(tmp_path):
    path = tmp_path / "world.yaml"
    path.write_text(
        "world: {collision_objects: [{header: {frame_id: panda_link0}, id: a, operation: 0, primitives: "
        "[{type: 2, dimensions: [0.1]}], primitive_poses: [{position: [1, 0, 0], orientation: [0, 0, 0, 1]}]}]}\n"
    )
    alone = mneme.Scene.load(path)
    assert len(alone.warnings) == 1 and 'in frame "panda_link0"' in alone.warnings[0]
    panda = mneme.Robot.load("panda")
    assert mneme.Scene.load(path, robot=panda).warnings == []
    path.write_text(path.read_text().replace("panda_link0", "nowhere"))
    assert raised(mneme.Scene.load, path, robot=panda)[0] == "invalid"


def test_what_was_left_aside_of_a_scene_is_told(tmp_path):
    header = "ply\nformat ascii 1.0\nelement vertex 2\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    (tmp_path / "scan.ply").write_text(header + "1 2 3\nnan 0 0\n")
    path = tmp_path / "scene.yaml"
    path.write_text("obstacles: [{name: a, type: points, file: scan.ply, radius: 0.1}]\n")
    warnings = mneme.Scene.load(path).warnings
    assert len(warnings) == 1
    assert "1 of 2 points are not finite" in warnings[0]


def test_wrong_points_and_meshes_are_errors():
    scene = mneme.Scene()
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    for add in (lambda: scene.add_points("a", [[1, 2]], 0.1),
                lambda: scene.add_points("a", [[1, 2, 3]], 0),
                lambda: scene.add_mesh("a", corners, [[0, 1, 3]]),
                lambda: scene.add_mesh("a", corners, [[0, 1, 1]]),
                lambda: scene.add_mesh("a", [[0, 0, np.inf], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
                lambda: scene.replace_points("none", 0, [[1, 2, 3]])):
        assert raised(add)[0] == "invalid"
    assert len(scene) == 0


def test_clouds_of_too_many_points_are_errors(robot):
    scene = mneme.Scene()
    many = np.zeros((4_000_001, 3), np.float32)
    refusal = ("unsupported", "obstacle 'a': expected at most 4000000 points, got 4000001")
    tracemalloc.start()
    assert raised(scene.add_points, "a", many, 0.1) == refusal
    assert tracemalloc.get_traced_memory()[1] < many.nbytes  # NumPy tells of its copies
    tracemalloc.stop()
    scene.add_sphere("a", [5, 0, 0], 0.1)
    assert raised(scene.add_points, "a", many, 0.1) == refusal
    assert len(scene) == 1


def test_arrays_that_are_no_points_are_named_by_their_shape():
    scene = mneme.Scene()
    for points, shape in ((np.ones(3), "(3,)"), (np.ones((5, 4)), "(5, 4)"), (np.ones((4, 5, 3)), "(4, 5, 3)"), ([], "(0,)")):
        assert raised(scene.add_points, "a", points, 0.1)[1] == f"points: expected an array of shape (n, 3), got shape {shape}"
    for points in (np.ones((4, 3), complex), np.ones((4, 3), bool), [["x", "y", "z"]], None):
        with pytest.raises(TypeError, match="points: expected an array of real numbers"):
            scene.add_points("a", points, 0.1)
    scene.add_points("a", np.ones((5, 3), np.int16)[::2], 0.1)
    assert raised(scene.replace_points, "a", -1, [[1, 2, 3]])[1] == "first: expected 0 or more, got -1"
    assert "expected points 2 to 4 to be among the cloud's 3" in raised(scene.replace_points, "a", 2, np.ones((2, 3)))[1]


def test_no_scene_is_a_type_error():
    robot = mneme.Robot.planar([1.0] * 2)
    with pytest.raises(TypeError):
        mneme.Problem(robot, None, [0, 0], [1, 0])
    problem = mneme.Problem(robot, mneme.Scene(), [0, 0], [1, 0])
    with pytest.raises(TypeError):
        problem.with_scene(None)


def test_what_files_would_refuse_is_refused():
    scene = mneme.Scene()
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    with pytest.raises(mneme.Error, match="expected indices of 3 vertices, got 1.7"):
        scene.add_mesh("mesh", corners, [[0, 1.7, 2]])
    with pytest.raises(mneme.Error, match="obstacle 'far': expected a shape within 10000 m"):
        scene.add_sphere("far", [9999.5, 0, 0], 1)
    assert len(scene) == 0


def test_a_pair_may_touch_at_the_ends_of_a_path():
    scene = mneme.Scene()
    scene.add_sphere("ball", [0, 0, 0], 0.1)
    scene.allow("hand", "ball", at_ends=0.02)
    text = scene.to_yaml()
    assert "at_ends: 0.02" in text and "hand" in text
    assert mneme.Scene.parse(text).to_yaml() == text
    for wrong in (0, -1, 2, float("nan")):
        assert "at_ends" in raised(scene.allow, "hand", "ball", at_ends=wrong)[1]


def test_a_cloud_without_points_is_left_out_with_a_warning():
    scene = mneme.Scene()
    for points, ignored in ((np.empty((0, 3)), 0), ([[1, 2, np.nan]], 1)):
        with pytest.warns(UserWarning, match="'a' is not added"):
            assert scene.add_points("a", points, 0.1) == ignored
    assert len(scene) == 0


def test_quaternions_of_other_lengths_are_scaled_with_a_warning_or_refused():
    scene = mneme.Scene()
    with pytest.warns(UserWarning, match="length 2 is scaled"):
        scene.add_box("a", [0, 0, 0], [1, 1, 1], [0, 0, 0, 2])
    for wrong in ([0, 0, 0, 0], [0, 0, 0, 11], [0, 0, 0, 0.05], [0, 0, 0, np.nan]):
        code, message = raised(scene.add_box, "b", [0, 0, 0], [1, 1, 1], wrong)
        assert code == "invalid" and "expected a quaternion of length 1" in message


def test_points_with_a_mask_are_refused():
    points = np.ma.masked_array(np.ones((2, 3)), [[True] * 3, [False] * 3])
    with pytest.raises(mneme.Error, match="points: expected an array without a mask"):
        mneme.Scene().add_points("cloud", points, 0.01)
