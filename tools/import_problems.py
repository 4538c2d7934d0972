#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a set of MotionBenchMaker's published problems into one compact file.

usage: import_problems.py DIRECTORY [--half odd|even] -o SET.json

DIRECTORY has pairs of MoveIt messages, sceneNNNN.yaml and requestNNNN.yaml. The number becomes the problem's index. The
joints are those of the goal, in its order; values of all other joints are fixed. Allowed collisions are not taken over.
--half odd keeps the problems with odd numbers, on which mneme is developed; even keeps the withheld ones. Values are rounded
to seven decimals.
"""
import argparse
import json
import pathlib
import re
import sys

import yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
SHAPES = {"box": 3, "sphere": 1, "cylinder": 2}
HALVES = {"odd": (1,), "even": (0,), "all": (0, 1)}


def rounded(values):
    return [round(float(value), 7) + 0.0 for value in values]


def read(path):
    try:
        message = yaml.load(path.read_text(encoding="utf-8"), Loader=LOADER)
    except yaml.YAMLError as problem:
        raise ValueError(f"{path}: {problem}") from problem
    if not isinstance(message, dict):
        raise ValueError(f"{path}: expected a MoveIt message, a map")
    return message


def shape(path, primitive, pose, names):
    kind, sizes = primitive["type"], rounded(primitive["dimensions"])
    if SHAPES.get(kind) != len(sizes):
        raise ValueError(f"{path}: '{next(iter(names.values()))}' is a {kind} of {len(sizes)} dimensions; expected a box of 3, a "
                         "cylinder of 2 (height, radius) or a sphere of 1")
    x, y, z, w = rounded(pose["orientation"])
    sizes = {"size": sizes} if kind == "box" else {"radius": sizes[0]} if kind == "sphere" else {"length": sizes[0], "radius": sizes[1]}
    return {**names, "type": kind, "p": rounded(pose["position"]), "q": [w, x, y, z], **sizes}


def obstacles_of(path, message, frame):
    for placed in message["world"]["collision_objects"]:
        name = placed["id"]
        if placed["header"]["frame_id"] != frame:
            raise ValueError(f"{path}: '{name}' is in frame '{placed['header']['frame_id']}'; expected '{frame}', as of the first object")
        if placed.get("meshes") or placed.get("planes") or not placed.get("primitives"):
            raise ValueError(f"{path}: expected '{name}' to consist of primitives; use the messages themselves (mneme plan {path})")
        parts = list(zip(placed["primitives"], placed["primitive_poses"]))
        for number, (primitive, pose) in enumerate(parts, 1):
            names = {"name": name} if len(parts) == 1 else {"name": f"{name}_{number}", "body": name}
            yield shape(path, primitive, pose, names)


def goal_of(path, message):
    goals = message["goal_constraints"]
    joints = goals[0].get("joint_constraints") if len(goals) == 1 else None
    if not joints:
        raise ValueError(f"{path}: expected one goal of joint constraints; use the messages themselves (mneme plan {path})")
    return {joint["joint_name"]: joint["position"] for joint in joints}


def problem_of(directory, number):
    """A problem, and what all problems of a file share."""
    request_path, scene_path = (directory / f"{kind}{number}.yaml" for kind in ("request", "scene"))
    request, scene = read(request_path), read(scene_path)
    goal = goal_of(request_path, request)
    state = request["start_state"]["joint_state"]
    start = dict(zip(state["name"], state["position"]))
    missing = [joint for joint in goal if joint not in start]
    if missing:
        raise ValueError(f"{request_path}: the start has no value of joint '{missing[0]}' of the goal")
    frame = scene["world"]["collision_objects"][0]["header"]["frame_id"]
    header = {"robot": scene["robot_model_name"], "frame": frame, "joints": list(goal),
              "fixed_joints": {joint: round(value, 7) for joint, value in start.items() if joint not in goal}}
    return header, {"index": int(number), "start": rounded(start[joint] for joint in goal), "goal": rounded(goal.values()),
                    "obstacles": list(obstacles_of(scene_path, scene, frame))}


def convert(directory, half):
    numbers = sorted((match[1] for path in directory.iterdir() if (match := re.fullmatch(r"request(\d+)\.yaml", path.name))), key=int)
    numbers = [number for number in numbers if int(number) % 2 in HALVES[half]]
    if not numbers:
        raise ValueError(f"{directory}: expected files requestNNNN.yaml and sceneNNNN.yaml, got none of this half")
    compact = None
    for number in numbers:
        header, problem = problem_of(directory, number)
        if compact is None:
            compact = {**header, "problems": []}
        differs = [key for key, value in header.items() if compact[key] != value]
        if differs:
            raise ValueError(f"{directory}: problem {number} has another '{differs[0]}' than problem {numbers[0]}; expected one robot and "
                             "one group per directory")
        compact["problems"].append(problem)
    return compact


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--half", choices=list(HALVES), default="all")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    try:
        compact = convert(arguments.directory, arguments.half)
        arguments.output.write_text(json.dumps(compact), encoding="utf-8")
    except (OSError, ValueError) as problem:
        print(f"import_problems: {problem}", file=sys.stderr)
        return 2
    except (KeyError, TypeError, IndexError) as problem:
        print(f"import_problems: {arguments.directory}: a message has no {problem}; expected MoveIt's scenes and requests", file=sys.stderr)
        return 2
    print(f"{len(compact['problems'])} problems of {compact['robot']}: {arguments.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
