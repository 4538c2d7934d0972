#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""An own robot, scene, start and goal: an arm of three links passes a post."""
import pathlib
import sys
import tempfile

import mneme

ARM = """<robot name="arm3">
  <link name="base"/>
  <link name="turret"><collision><geometry><sphere radius="0.06"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.25"/>
    <geometry><capsule radius="0.05" length="0.5"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0 0 0.2"/>
    <geometry><capsule radius="0.04" length="0.4"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="turret"/>
    <origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="turret"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5"/></joint>
</robot>"""

with tempfile.TemporaryDirectory() as directory:
    urdf = pathlib.Path(directory) / "arm3.urdf"
    urdf.write_text(ARM)
    robot = mneme.Robot.load(urdf)
scene = mneme.Scene()
scene.add_box("post", position=[0.6, 0, 0.4], size=[0.1, 0.1, 0.8])
problem = mneme.Problem(robot, scene, start=[-1, 1.2, 0.3], goals=[1, 1.2, 0.3], name="arm3")
plan = mneme.plan(problem)
if not plan.is_solved:
    sys.exit(plan.message)
print(f"arm3: {len(plan.path)} configurations, length {plan.path_length:.3f}")
