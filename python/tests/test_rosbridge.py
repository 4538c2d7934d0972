# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""examples/ros2_bridge/rosbridge.py between a real service and a small rosbridge server."""
import json
import math
import pathlib
import socket
import sys
import threading

import pytest
from test_client import serving

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples/ros2_bridge"
sys.path.insert(0, str(FOLDER))
import rosbridge  # noqa: E402
import websocket  # noqa: E402

JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
START = [0.0, -1.57, 0.0, -1.57, 0.0, 0.0]
GOAL = [1.0, -1.2, 0.5, -1.0, 0.0, 0.05]


def scene_message():
    ball = {"id": "ball", "header": {"frame_id": "world"},
            "pose": {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "primitives": [{"type": 2, "dimensions": [0.1]}],
            "primitive_poses": [{"position": {"x": -0.8, "y": 0.5, "z": 0.5}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}]}
    return {"robot_state": {"joint_state": {"name": JOINTS, "position": START}}, "world": {"collision_objects": [ball]}}


class Server:
    """A rosbridge server for one client: move_group and its users."""

    def __init__(self):
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"ws://127.0.0.1:{self._listener.getsockname()[1]}"
        self.scene = scene_message()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._connection.sendall(websocket.frame(websocket.CLOSE, b"\x03\xe8"))
        self._connection.close()
        self._listener.close()

    def accept(self):
        self._connection, _ = self._listener.accept()
        self._connection.settimeout(60)
        self._stream = self._connection.makefile("rb")
        lines = [line.decode().strip() for line in iter(self._stream.readline, b"\r\n")]
        key = next(line.split(": ")[1] for line in lines if line.startswith("Sec-WebSocket-Key"))
        assert lines[0] == "GET / HTTP/1.1" and "Upgrade: websocket" in lines
        self._connection.sendall(("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                  f"Sec-WebSocket-Accept: {websocket.accept_of(key)}\r\n\r\n").encode())

    def send(self, **message):
        """In two frames with a ping between them, as the protocol allows."""
        text = json.dumps(message).encode()
        first = bytearray(websocket.frame(websocket.TEXT, text[:20]))
        first[0] &= 0x7F
        rest = websocket.frame(websocket.CONTINUATION, text[20:])
        self._connection.sendall(bytes(first) + websocket.frame(websocket.PING, b"?") + rest)

    def receive(self):
        while True:
            is_final, opcode, payload = websocket.read_frame(self._stream)
            if opcode == websocket.TEXT:
                assert is_final
                return json.loads(payload)
            assert opcode == websocket.PONG and payload == b"?"

    def ask(self, service, arguments):
        """The answer to a call, and what was published before it; gives the scene to who asks for it.

        An answer without a result, which has a text in place of values, is that text.
        """
        self.send(op="call_service", id="call 1", service=service, args=arguments)
        published = []
        while (message := self.receive())["op"] != "service_response":
            if message["op"] == "publish":
                published.append(message)
                continue
            assert message["op"] == "call_service" and message["service"] == "/get_planning_scene"
            assert message["type"] == "moveit_msgs/srv/GetPlanningScene"
            assert message["args"] == {"components": {"components": 510}}
            self.send(op="service_response", id=message["id"], service=message["service"],
                      values={"scene": self.scene} if self.scene else "no scene", result=bool(self.scene))
        assert (message["id"], message["service"], message["result"]) == ("call 1", service, not isinstance(message["values"], str))
        return message["values"], published


@pytest.fixture()
def server(tmp_path):
    address = f"unix:{tmp_path}/socket"
    with serving("ur5", address), Server() as graph:
        planner = rosbridge.Planner(address, {"world": "base_link"})
        made = []
        thread = threading.Thread(target=lambda: made.append(rosbridge.Rosbridge(graph.url, planner.services())))
        thread.start()
        graph.accept()
        thread.join()
        serve = threading.Thread(target=made[0].serve)
        serve.start()
        graph.advertised = [graph.receive(), graph.receive()]
        yield graph
    serve.join(timeout=60)
    assert not serve.is_alive()


def plan_request(**changes):
    goal = [{"joint_name": name, "position": value} for name, value in zip(JOINTS, GOAL)]
    return {"motion_plan_request": {"group_name": "arm", "goal_constraints": [{"joint_constraints": goal}], **changes}}


def test_the_program_says_first_that_no_graph_was_run():
    assert "No real ROS graph was run" in (FOLDER / "rosbridge.py").read_text().splitlines()[1]


def test_services_are_advertised_with_the_types_of_moveit(server):
    assert server.advertised == [
        {"op": "advertise_service", "service": "/mneme/plan_kinematic_path", "type": "moveit_msgs/srv/GetMotionPlan"},
        {"op": "advertise_service", "service": "/mneme/compute_ik", "type": "moveit_msgs/srv/GetPositionIK"}]


def test_a_plan_is_answered_and_displayed(server):
    values, published = server.ask(rosbridge.PLAN, plan_request())
    response = values["motion_plan_response"]
    assert response["error_code"] == {"val": 1} and response["group_name"] == "arm"
    path = [point["positions"] for point in response["trajectory"]["joint_trajectory"]["points"]]
    assert path[0] == START and path[-1] == GOAL
    assert response["trajectory"]["joint_trajectory"]["joint_names"] == JOINTS
    assert published == [{"op": "publish", "topic": "/display_planned_path",
                          "msg": {"model_id": "ur5_robotiq85", "trajectory": [response["trajectory"]],
                                  "trajectory_start": server.scene["robot_state"]}}]


def test_what_cannot_be_planned_is_a_failure_and_the_bridge_goes_on(server):
    values, published = server.ask(rosbridge.PLAN, plan_request(path_constraints={"joint_constraints": [{}]}))
    assert values == {"motion_plan_response": {"error_code": {"val": 99999}}} and published == []
    scene, server.scene = server.scene, None
    assert server.ask(rosbridge.PLAN, plan_request())[0]["motion_plan_response"]["error_code"]["val"] == 99999
    server.scene = scene
    assert server.ask(rosbridge.PLAN, plan_request())[0]["motion_plan_response"]["error_code"]["val"] == 1


def test_a_call_that_is_no_request_is_answered(server):
    assert server.ask(rosbridge.PLAN, {}) == ("KeyError: 'motion_plan_request'", [])
    assert server.ask(rosbridge.IK, {"ik_request": None})[0].startswith("AttributeError: ")
    assert server.ask(rosbridge.PLAN, plan_request())[0]["motion_plan_response"]["error_code"]["val"] == 1


def test_inverse_kinematics_finds_the_nearest_solution_or_none(server):
    position, q = [0.4, 0.2, 0.5], [0.0, 0.0, 0.0, 1.0]
    request = {"group_name": "arm", "ik_link_name": "tool0", "avoid_collisions": True,
               "pose_stamped": {"header": {"frame_id": "world"},
                                "pose": {"position": dict(zip("xyz", position)), "orientation": dict(zip("xyzw", q))}}}
    values, _ = server.ask(rosbridge.IK, {"ik_request": request})
    assert values["error_code"] == {"val": 1}
    state = values["solution"]["joint_state"]
    assert state["name"] == JOINTS and all(math.isfinite(value) for value in state["position"])
    request["pose_stamped"]["pose"]["position"]["x"] = 9.0
    assert server.ask(rosbridge.IK, {"ik_request": request})[0] == {"error_code": {"val": -31}}
