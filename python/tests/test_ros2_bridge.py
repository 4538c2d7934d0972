# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mapping of examples/ros2_bridge, on messages in the form that ROS 2 gives them and on those that MoveIt wrote
for MotionBenchMaker's problems: what it asks of a service is what mneme reads itself."""
import copy
import importlib.util
import json
import math
import os
import pathlib

import numpy as np
import pytest

import mneme

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples/ros2_bridge"
RECORDED = json.loads((pathlib.Path(__file__).parent / "moveit_messages.json").read_text())
JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]


def load_mapping():
    spec = importlib.util.spec_from_file_location("mapping", FOLDER / "mapping.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


mapping = load_mapping()


@pytest.fixture()
def messages():
    recorded = copy.deepcopy(RECORDED)
    return recorded["request"], recorded["scene"]


def test_the_node_says_first_that_it_was_not_run():
    lines = (FOLDER / "bridge.py").read_text().splitlines()
    assert "Not runnable" in lines[1] and "ROS 2" in lines[1]
    compile("\n".join(lines), "bridge.py", "exec")


def test_a_recorded_request_becomes_a_plan_request(messages):
    body = mapping.to_plan_request(*messages, JOINTS, {"world": "base_link"})
    assert body["start"] == [0.0, -1.57, 0.0, -1.57, 0.25, 0.0]  # the request's value of wrist_2_joint counts
    assert body["goals"][0] == [1.0, -1.2, 0.5, -1.0, 0.0, 0.05]  # the middle of the tolerance
    pose = body["goals"][1]
    assert pose["link"] == "tool0" and pose["frame"] == "base_link" and pose["axis"] == "z" and pose["turn"] == "free"
    assert pose["position"] == [0.4, 0.2, 0.5] and math.isclose(pose["position_tolerance"], 0.01 / math.sqrt(3))
    assert body["frame"] == "base_link" and body["settings"] == {"timeout": 5.0}
    table, can, lid, ramp = body["obstacles"]
    assert table == {"name": "table", "type": "box", "p": [1.0, 0.0, 0.25], "q": [1.0, 0.0, 0.0, 0.0], "size": [0.5, 1.0, 0.5]}
    assert can["body"] == lid["body"] == "can" and can["length"] == 0.2 and can["radius"] == 0.05
    # The object's pose turns x into y, and its parts with it.
    assert np.allclose(lid["p"], [0.0, 0.9, 0.6]) and np.allclose(can["q"], [math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
    assert ramp["type"] == "mesh" and ramp["triangles"] == [0, 0, 0, 1, 0, 0, 0, 1, 0]
    assert body["attached"] == [{"name": "rod", "link": "tool0", "touch": ["wrist_3_link"],
                                 "shapes": [{"type": "sphere", "p": [0.0, 0.0, 0.1], "radius": 0.02}]}]
    assert body["allow"] == [["base_link", "table"], ["rod", "can"]]


def test_what_a_plan_would_leave_out_is_refused(messages):
    def refused(words, change):
        request, scene = copy.deepcopy(messages)
        change(request, scene)
        with pytest.raises(mapping.Unsupported, match=words):
            mapping.to_plan_request(request, scene, JOINTS)

    def objects(scene):
        return scene["world"]["collision_objects"]

    refused("path_constraints", lambda request, _: request["path_constraints"].update(joint_constraints=[{}]))
    refused("octomap", lambda _, scene: scene["world"].update(octomap={"octomap": {"data": [1]}}))
    refused("one frame", lambda _, scene: objects(scene)[0]["header"].update(frame_id="moon"))
    refused("planes", lambda _, scene: objects(scene)[0].update(planes=[{"coef": [0, 0, 1, 0]}]))
    refused("type 4", lambda _, scene: objects(scene)[0]["primitives"][0].update(type=4))
    refused("expected a shape", lambda _, scene: objects(scene)[0].update(primitives=[]))
    refused("padding", lambda _, scene: scene.update(link_padding=[{"link_name": "tool0", "padding": 0.1}]))
    refused("link_scale", lambda _, scene: scene.update(link_scale=[{"link_name": "tool0", "scale": 1.1}]))
    refused("elbow_joint", lambda request, _: request["goal_constraints"][0]["joint_constraints"].pop(2))
    refused("got none of shoulder_pan", lambda _, scene: scene["robot_state"]["joint_state"]["name"].__setitem__(0, "x"))
    refused("one sphere", lambda request, _: request["goal_constraints"][1]["position_constraints"][0][
        "constraint_region"]["primitives"][0].update(type=1))
    refused("beside", lambda request, _: request["goal_constraints"][1].update(position_constraints=[]))
    refused("visibility", lambda request, _: request["goal_constraints"][0].update(visibility_constraints=[{}]))
    refused("frame of the link", lambda _, scene: scene["robot_state"]["attached_collision_objects"][0]["object"][
        "header"].update(frame_id="base_link"))
    refused("may touch everything", lambda _, scene: scene["allowed_collision_matrix"].update(
        default_entry_names=["table"], default_entry_values=[True]))


def test_euler_tolerances_about_the_middle_axis_are_narrowed():
    def keys(**constraint):
        tolerances = {"absolute_x_axis_tolerance": 0.1, "absolute_y_axis_tolerance": math.pi, "absolute_z_axis_tolerance": 0.1}
        return mapping.orientation_keys({"orientation": {"x": 0, "y": 0, "z": 0, "w": 1}, **tolerances, **constraint})

    euler = keys()
    cone = math.atan(math.tan(0.1) * math.cos(1.4))
    assert euler["axis"] == "y" and math.isclose(euler["cone"], cone)
    assert math.isclose(euler["turn"], 1.4 - cone * cone / 2)
    vector = keys(parameterization=1)
    assert vector["turn"] == "free" and math.isclose(vector["cone"], 0.2 / math.pi)


def test_inverse_kinematics_leaves_obstacles_out_unless_asked(messages):
    request, scene = messages
    asked = {"robot_state": request["start_state"], "ik_link_name": "tool0",
             "pose_stamped": {"header": {"frame_id": "base_link"}, "pose": {
                 "position": {"x": 0.4, "y": 0.1, "z": 0.5}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}}
    assert mapping.to_ik_request(asked, scene, JOINTS)["obstacles"] == []
    assert mapping.to_ik_request({**asked, "avoid_collisions": True}, scene, JOINTS)["obstacles"]


def test_answers_become_responses():
    solved = {"status": "solved", "path": [[0, 1], [1, 2]], "total_time_s": 0.5}
    response = mapping.to_plan_response(solved, ["a", "b"], "arm")
    assert response["error_code"]["val"] == 1 and response["group_name"] == "arm" and response["planning_time"] == 0.5
    trajectory = response["trajectory"]["joint_trajectory"]
    assert trajectory == {"joint_names": ["a", "b"], "points": [{"positions": [0, 1]}, {"positions": [1, 2]}]}
    codes = {status: mapping.to_plan_response({"status": status, "path": [], "total_time_s": 0}, [], "")["error_code"]["val"]
             for status in ("timeout", "invalid_start", "invalid_goal", "cancelled", "iteration_limit", "new")}
    assert codes == {"timeout": -6, "invalid_start": -10, "invalid_goal": -12, "cancelled": -7, "iteration_limit": -1,
                     "new": 99999}


@pytest.mark.parametrize("task", ["cage_fetch", "box_fetch", "bookshelf_thin_fetch"])
def test_messages_that_moveit_wrote_are_read_as_mneme_reads_them(task):
    if "MNEME_DATA" not in os.environ:
        pytest.skip("MNEME_DATA is not set")
    yaml = pytest.importorskip("yaml", reason="python3-yaml is not installed")
    folder = pathlib.Path(os.environ["MNEME_DATA"]) / "mbm/moveit_yaml" / task
    requests = sorted(folder.glob("request*.yaml"))[:3]
    assert requests
    for path in requests:
        files = [path.with_name(path.name.replace("request", "scene")), path]
        scene, request = (yaml.safe_load(path.read_text()) for path in files)
        problem = mneme.Problem.load(f"{files[0]},{files[1]}", robot="fetch")
        expected = json.loads(problem.to_compact_json("fetch"))
        body = mapping.to_plan_request(request, scene, expected["joints"])
        expected = expected["problems"][0]
        assert body["start"] == expected["start"] and np.allclose(body["goals"], expected["goals"])
        assert len(body["obstacles"]) == len(expected["obstacles"])
        for shape, same in zip(body["obstacles"], expected["obstacles"]):
            assert {key: shape[key] for key in ("type", "name", "body") if key in shape} == \
                   {key: same[key] for key in ("type", "name", "body") if key in same}
            for key in ("p", "size", "radius", "length"):
                assert (key in shape) == (key in same) and (key not in shape or np.allclose(shape[key], same[key]))
            if "q" in same and "q" in shape:
                assert math.isclose(abs(np.dot(shape["q"], same["q"])), 1, abs_tol=1e-9)
