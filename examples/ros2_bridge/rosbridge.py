#!/usr/bin/python3
# No real ROS graph was run: it was tested with recorded messages and the rosbridge server of python/tests alone.
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Answers MoveIt's services with plans of `mneme serve`, through rosbridge: no package of ROS is needed here.

    ros2 run rosbridge_server rosbridge_websocket          # on a machine of the ROS graph
    mneme serve --robot fetch --db fetch.db &
    python3 rosbridge.py ws://HOST:9090 --world-frame odom --root-link base_link

Services: mneme/plan_kinematic_path (moveit_msgs/srv/GetMotionPlan) and mneme/compute_ik (GetPositionIK). The planning
scene is asked of move_group's get_planning_scene for each call. Paths are also published on display_planned_path.
"""
import argparse
import itertools
import json
import os
import queue
import sys
import threading

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import mneme  # noqa: E402
from mapping import (FAILURE, Unsupported, to_ik_request, to_ik_response, to_plan_request,  # noqa: E402
                     to_plan_response)
from websocket import WebSocket  # noqa: E402

SCENE_PARTS = 2 | 4 | 8 | 16 | 32 | 64 | 128 | 256  # moveit_msgs/PlanningSceneComponents: state, world, matrix, padding
PLAN, IK, DISPLAY = "/mneme/plan_kinematic_path", "/mneme/compute_ik", "/display_planned_path"
ANSWER_S = 10


class Rosbridge:
    """A connection by the protocol of rosbridge, version 2. `services`: from names to their type and function."""

    def __init__(self, url, services):
        self._socket = WebSocket(url)
        self._sending = threading.Lock()
        self._answers = {}
        self._numbers = itertools.count(1)
        self._services = services
        for name, (kind, _) in services.items():
            self.send(op="advertise_service", service=name, type=kind)

    def send(self, **message):
        with self._sending:
            self._socket.send(json.dumps(message))

    def call(self, service, kind, arguments):
        """Calls a service of the graph, from another thread than serve(). Raises ConnectionError without an answer."""
        number = f"mneme {next(self._numbers)}"
        answer = self._answers[number] = queue.Queue()
        try:
            self.send(op="call_service", id=number, service=service, type=kind, args=arguments)
            message = answer.get(timeout=ANSWER_S)
        except queue.Empty:
            raise ConnectionError(f"{service} does not answer") from None
        finally:
            del self._answers[number]
        if not message.get("result", True):
            raise ConnectionError(f"{service}: {message.get('values')}")
        return message["values"]

    def serve(self):
        """Answers calls, each in a thread of its own, until the other side closes."""
        while (text := self._socket.receive()) is not None:
            message = json.loads(text)
            if message["op"] == "service_response" and message.get("id") in self._answers:
                self._answers[message["id"]].put(message)
            elif message["op"] == "call_service" and message["service"] in self._services:
                threading.Thread(target=self._answer, args=(message,), daemon=True).start()

    def _answer(self, message):
        service = message["service"]
        try:
            values, is_done = self._services[service][1](self, message.get("args") or {}), True
        except Exception as failure:  # without an answer the caller would wait for ever
            values, is_done = f"{type(failure).__name__}: {failure}", False
            print(f"{service}: {values}", file=sys.stderr)
        self.send(op="service_response", id=message.get("id"), service=service, values=values, result=is_done)


class Planner:
    """MoveIt's services as requests to `mneme serve` at `url`."""

    def __init__(self, url, links):
        self._url = url
        self._links = links
        with mneme.Client(url) as client:
            self._joints = client.health()["joints"]

    def services(self):
        return {PLAN: ("moveit_msgs/srv/GetMotionPlan", self.plan), IK: ("moveit_msgs/srv/GetPositionIK", self.solve_ik)}

    def _ask(self, path, body):
        with mneme.Client(self._url) as client:  # one per thread
            return client.ask("POST", path, body)

    def _scene(self, bridge):
        arguments = {"components": {"components": SCENE_PARTS}}
        return bridge.call("/get_planning_scene", "moveit_msgs/srv/GetPlanningScene", arguments)["scene"]

    def plan(self, bridge, arguments):
        asked = arguments["motion_plan_request"]
        try:
            scene = self._scene(bridge)
            answer = self._ask("/v1/plan", to_plan_request(asked, scene, self._joints, self._links))
        except (Unsupported, mneme.Error, mneme.Busy, OSError) as failure:
            print(f"{PLAN}: {failure}", file=sys.stderr)
            return {"motion_plan_response": {"error_code": {"val": FAILURE}}}
        if not answer["solved"]:
            print(f"{PLAN}: {answer['message']}", file=sys.stderr)
        response = to_plan_response(answer, self._joints, asked.get("group_name", ""))
        if answer["solved"]:
            bridge.send(op="publish", topic=DISPLAY, msg={"model_id": answer["robot"], "trajectory": [response["trajectory"]],
                                                          "trajectory_start": scene.get("robot_state") or {}})
        return {"motion_plan_response": response}

    def solve_ik(self, bridge, arguments):
        try:
            body = to_ik_request(arguments["ik_request"], self._scene(bridge), self._joints, self._links)
            answer = self._ask("/v1/ik", body)
        except (Unsupported, mneme.Error, mneme.Busy, OSError) as failure:
            print(f"{IK}: {failure}", file=sys.stderr)
            return {"error_code": {"val": FAILURE}}
        return to_ik_response(answer, self._joints)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rosbridge", help="ws://HOST:PORT of rosbridge_server")
    parser.add_argument("--url", default="http://127.0.0.1:7890", help="address of 'mneme serve'")
    parser.add_argument("--world-frame", help="frame of the planning scene that is no link of the robot")
    parser.add_argument("--root-link", default="base_link", help="link that stands for the world frame")
    options = parser.parse_args()
    links = {options.world_frame: options.root_link} if options.world_frame else {}
    bridge = Rosbridge(options.rosbridge, Planner(options.url, links).services())
    bridge.send(op="advertise", topic=DISPLAY, type="moveit_msgs/msg/DisplayTrajectory")
    print(f"serving {PLAN} and {IK}", flush=True)
    bridge.serve()


if __name__ == "__main__":
    main()
