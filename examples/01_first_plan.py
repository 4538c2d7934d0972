#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plans a problem that came with mneme, or the one whose file is given."""
import sys

import mneme

file = sys.argv[1] if len(sys.argv) > 1 else mneme.find_scene("planar/scenario2.yaml")
problem = mneme.Problem.load(file)
plan = mneme.plan(problem, seed=1)
if not plan.is_solved:
    sys.exit(plan.message)
print(f"{problem.name}: {len(plan.path)} configurations, {1e3 * plan.planning_time_s:.2f} ms")
for q in plan.path:
    print("".join(f"{value:9.5f}" for value in q))
