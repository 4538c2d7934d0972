#!/usr/bin/python3
# Not runnable where mneme is tested: it needs ROS 2 and MoveIt. Only mapping.py was run, with recorded messages.
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""A ROS 2 node that answers MoveIt's service plan_kinematic_path with plans of `mneme serve`.

    mneme serve --robot fetch --db fetch.db &
    python3 bridge.py --ros-args -p url:=http://127.0.0.1:7890 -p world_frame:=odom -p root_link:=base_link

The planning scene is asked of move_group for each plan. Paths have no times.
"""
import mneme
import rclpy
from mapping import FAILURE, Unsupported, to_plan_request, to_plan_response
from moveit_msgs.msg import PlanningSceneComponents
from moveit_msgs.srv import GetMotionPlan, GetPlanningScene
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rosidl_runtime_py import message_to_ordereddict, set_message_fields

COMPONENTS = (PlanningSceneComponents.WORLD_OBJECT_GEOMETRY | PlanningSceneComponents.OCTOMAP
              | PlanningSceneComponents.ROBOT_STATE | PlanningSceneComponents.ROBOT_STATE_ATTACHED_OBJECTS
              | PlanningSceneComponents.ALLOWED_COLLISION_MATRIX | PlanningSceneComponents.LINK_PADDING_AND_SCALING)


class Bridge(Node):
    def __init__(self):
        super().__init__("mneme_bridge")
        self._url = self.declare_parameter("url", "http://127.0.0.1:7890").value
        world = self.declare_parameter("world_frame", "").value
        root = self.declare_parameter("root_link", "base_link").value
        self._links = {world: root} if world else {}
        with mneme.Client(self._url) as client:
            self._joints = client.health()["joints"]
        group = ReentrantCallbackGroup()
        self._scenes = self.create_client(GetPlanningScene, "get_planning_scene", callback_group=group)
        self.create_service(GetMotionPlan, "mneme/plan_kinematic_path", self._plan, callback_group=group)

    async def _plan(self, request, response):
        asked = request.motion_plan_request
        question = GetPlanningScene.Request(components=PlanningSceneComponents(components=COMPONENTS))
        scene = (await self._scenes.call_async(question)).scene
        try:
            body = to_plan_request(message_to_ordereddict(asked), message_to_ordereddict(scene), self._joints, self._links)
            with mneme.Client(self._url) as client:  # one per thread
                answer = client.ask("POST", "/v1/plan", body)
        except (Unsupported, mneme.Error, mneme.Busy, OSError) as failure:
            self.get_logger().error(str(failure))
            response.motion_plan_response.error_code.val = FAILURE
            return response
        if not answer["solved"]:
            self.get_logger().warning(answer["message"])
        fields = to_plan_response(answer, self._joints, asked.group_name)
        set_message_fields(response.motion_plan_response, fields)
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Bridge())
    executor.spin()


if __name__ == "__main__":
    main()
