# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import pathlib

import numpy as np
import pytest
from conftest import raised

import mneme


def test_a_robot_is_loaded_by_name_or_file(robot):
    assert robot.name == "planar8"
    assert robot.joint_count == 8 == len(robot.joint_names)
    assert robot.is_planar
    assert robot.limits.shape == (8, 2)
    assert robot.limits.dtype == np.float64
    path = pathlib.Path(mneme.find_scene("planar/grid.yaml")).parents[2] / "robots/planar8.urdf"
    assert mneme.Robot.load(path).hash == robot.hash
    assert mneme.Robot.load(path, package_paths=[path.parent, str(path.parent)]).hash == robot.hash
    assert "planar8" in repr(robot)


def test_poses_are_homogeneous_matrices():
    arm = mneme.Robot.planar([1.0, 2.0])
    poses = arm.link_poses([np.pi / 2, -np.pi / 2])
    assert poses.shape == (len(arm.link_names), 4, 4)
    tip = poses[arm.link_names.index("link_2")]
    np.testing.assert_allclose(tip[:3, 3], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(tip[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_array_equal(tip[3], [0, 0, 0, 1])


def test_distances_take_the_shorter_way_round():
    arm = mneme.Robot.planar([1.0, 1.0])
    np.testing.assert_allclose(arm.difference([3, 0], [-3, 0]), [2 * np.pi - 6, 0])
    assert arm.distance([3, 0], [-3, 0.5]) == pytest.approx(np.hypot(2 * np.pi - 6, 0.5))
    np.testing.assert_allclose(arm.normalized([4, 4]), [4 - 2 * np.pi, np.pi])
    assert arm.path_length([[0, 0], [0.3, 0.4], [0.3, 1.4]]) == pytest.approx(1.5)


def test_violations_are_told_in_words(robot):
    assert robot.describe_violation(np.zeros(8)) is None
    assert "q" in robot.describe_violation([0, 99, 0, 0, 0, 0, 0, 0])
    assert robot.describe_violation(np.full(8, np.nan)) is not None
    assert robot.describe_violation([0.0]) is not None


def test_integers_lists_and_views_are_numbers(robot):
    pose = robot.link_poses(np.zeros(8))
    for q in ([0] * 8, np.zeros(8, dtype=np.float32), np.zeros(16)[::2], tuple([0.0] * 8)):
        np.testing.assert_array_equal(robot.link_poses(q), pose)


@pytest.mark.parametrize("q", ["zero", None, [[0.0] * 8, [1.0]], [1j] * 8, [True] * 8, object()])
def test_what_is_no_number_is_a_type_error(robot, q):
    with pytest.raises(TypeError, match="q: expected an array of real numbers"):
        robot.link_poses(q)


def test_wrong_shapes_name_both_shapes(robot):
    code, message = raised(robot.link_poses, np.zeros(7))
    assert code == "invalid"
    assert "(8,)" in message and "(7,)" in message
    assert "(n, 8)" in raised(robot.path_length, np.zeros((2, 3)))[1]


def test_wrong_robots_are_errors_that_name_them(tmp_path):
    code, message = raised(mneme.Robot.load, "no_such_robot")
    assert code == "io" and "no_such_robot" in message
    code, message = raised(mneme.Robot.load, tmp_path / "none.urdf")
    assert code == "io" and "none.urdf" in message
    (tmp_path / "bad.urdf").write_text("<robot name='x'><link name='a'>")
    code, message = raised(mneme.Robot.load, tmp_path / "bad.urdf")
    assert code == "parse" and "bad.urdf" in message
    assert raised(mneme.Robot.load, "planar8", joints=["nobody"])[0] in ("invalid", "parse")
    assert raised(mneme.Robot.load, "planar8", excess=0)[0] == "invalid"
    assert raised(mneme.Robot.planar, [1.0, -1.0])[0] == "invalid"
    assert raised(mneme.Robot.planar, [])[0] == "invalid"
    with pytest.raises(TypeError):
        mneme.Robot.load(3)


ARM = """<robot name='arm'><link name='a'/><link name='b'><weight/><collision><geometry>
<sphere radius='0.1'/></geometry></collision></link>
<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>
<limit lower='-2' upper='2' velocity='1'/>
<safety_controller soft_lower_limit='-1' soft_upper_limit='1'/></joint></robot>"""


def test_foreign_elements_and_soft_limits_are_warnings_unless_switched_off(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    soft = mneme.Robot.load(path)
    assert len(soft.warnings) == 2
    assert "unknown element <weight> in <link>" in soft.warnings[0]
    np.testing.assert_array_equal(soft.limits, [[-1, 1]])
    hard = mneme.Robot.load(path, hard_limits=True)
    np.testing.assert_array_equal(hard.limits, [[-2, 2]])
    code, message = raised(mneme.Robot.load, path, strict=True)
    assert code == "parse" and "unknown element <weight>" in message


def test_bytes_that_are_not_utf_8_are_escaped_in_messages(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_bytes(ARM.encode().replace(b"weight", b"w\xffight"))
    assert "<w\\xffight>" in mneme.Robot.load(path).warnings[0]
    assert "<w\\xffight>" in raised(mneme.Robot.load, path, strict=True)[1]


def test_planar_joints_stand_where_fixed_values_say(tmp_path):
    path = tmp_path / "cart.urdf"
    path.write_text("""<robot name="cart"><link name="ground"/><link name="cart"/><link name="arm">
      <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="base" type="planar"><parent link="ground"/><child link="cart"/></joint>
      <joint name="turn" type="continuous"><parent link="cart"/><child link="arm"/>
      <axis xyz="0 0 1"/></joint></robot>""")
    robot = mneme.Robot.load(path, fixed_values={"base/x": 2, "base/y": -1})
    assert robot.hash != mneme.Robot.load(path).hash
    message = raised(mneme.Robot.load, path, fixed_values={"base": 1})[1]
    assert "its fixed values are base/theta, base/x, base/y" in message


def test_a_group_and_joints_are_not_given_together():
    with pytest.raises(mneme.Error, match="group and joints: expected one of them"):
        mneme.Robot.load("panda", group="panda_arm", joints=["panda_joint1"])
