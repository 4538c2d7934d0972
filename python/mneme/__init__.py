# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion planning from memory.

    import mneme
    problem = mneme.Problem.load(mneme.find_scene("planar/threaded_b2.yaml"))
    plan = mneme.plan(problem)
    plan.path                      # float64 array of shape (n, joint_count), radians

Metres and radians; configurations are arrays of shape (joint_count,), paths of shape
(n, joint_count). Wrong input raises mneme.Error; a plan without a path has `is_solved` False.
plan(), plan_many(), plan_task(), learn() and bench() let other threads run and end at Control-C.
"""
from ._mneme import (
    BenchmarkRow,
    Cell,
    CellAnswer,
    CellMotions,
    CollisionChecker,
    Database,
    Error,
    LearnProgress,
    LearnSummary,
    Line,
    LineResult,
    OrientationConstraint,
    Plan,
    Plans,
    PoseGoal,
    Primitive,
    Problem,
    Robot,
    Scene,
    Task,
    TaskPlan,
    Trajectory,
    __version__,
    available_isas,
    decompose,
    kind_names,
    default_isa,
    find_scene,
    inverse_kinematics,
    learn,
    learn_from_paths,
    drop_own_points,
    list_problems,
    plan,
    plan_line,
    plan_many,
    plan_task,
    planner_names,
    sampler_names,
    similarity_error,
)
from ._bench import Benchmark, bench
from ._client import Busy, Client, RemotePlan
from ._solutions import Solutions
from ._view import view

__all__ = [
    "Benchmark",
    "BenchmarkRow",
    "Busy",
    "Cell",
    "CellAnswer",
    "CellMotions",
    "Client",
    "CollisionChecker",
    "Database",
    "Error",
    "LearnProgress",
    "LearnSummary",
    "Line",
    "LineResult",
    "OrientationConstraint",
    "Plan",
    "Plans",
    "PoseGoal",
    "Primitive",
    "Problem",
    "RemotePlan",
    "Robot",
    "Scene",
    "Task",
    "TaskPlan",
    "Solutions",
    "Trajectory",
    "__version__",
    "available_isas",
    "bench",
    "decompose",
    "kind_names",
    "default_isa",
    "find_scene",
    "inverse_kinematics",
    "learn",
    "learn_from_paths",
    "drop_own_points",
    "list_problems",
    "plan",
    "plan_line",
    "plan_many",
    "plan_task",
    "planner_names",
    "sampler_names",
    "similarity_error",
    "view",
]
