#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Learns how to get through one gap, then plans in a scene with a similar one, with and without
that memory: with rrt, since rrt_connect's walks escape from such a gap without any. The database
is the file given, or learned.db."""
import sys

import mneme

LEARNED = [1.7, 2.3, 1.1, 3.4, 0.5, 1.1]  # two circles that hold an arm threaded between them

problem = mneme.Problem.load(mneme.find_scene("planar/threaded_b0.yaml"))
path = sys.argv[1] if len(sys.argv) > 1 else "learned.db"
with mneme.Database.open(path, problem.robot, mode="create") as memory:
    summary = mneme.learn(problem.robot, memory, primitives=[LEARNED])
    print(f"learned {summary.learned} primitives, {summary.skipped} known before")
    for name, database in ("with", memory), ("without", None):
        plan = mneme.plan(problem, database, planner="rrt")
        if not plan.is_solved:
            sys.exit(plan.message)
        print(f"{name} memory: {plan.iterations} samples, {1e3 * plan.planning_time_s:.2f} ms")
