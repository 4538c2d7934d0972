#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes hard problems of others, for bench/suites/hard.yaml.

usage: hard_problems.py starts PROBLEMS.json URDF -o OUT.json          random starts within the joints' limits
       hard_problems.py carry PROBLEMS.json LINK OBJECT -o OUT.json    that link, a gripper, carries a stick instead of the object
       hard_problems.py reach MNEME URDF SRDF SCENE.yaml .. -o DIRECTORY
                                                  from a tucked arm to a random place in the shelf of each scene

--seed N makes others. Starts, and what is carried, may be in contact: benchmarks leave such problems out, and say how many there
were. Goals in shelves are MNEME's inverse kinematics, free of contact; scenes where it finds none are counted and left out.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import xml.etree.ElementTree

STICK = {"name": "stick", "type": "box", "p": [0.09, 0, 0], "q": [1, 0, 0, 0], "size": [0.03, 0.03, 0.16]}
# Fetch with its arm tucked, as in MotionBenchMaker's problems.
TUCKED = [0.1, 1.32, 1.4, -0.2, 1.72, 0, 1.66, 0]
# Of the gripper, behind the two cylinders in front: metres.
REACH = ((0.96, 1.04), (-0.03, 0.03), (0.86, 0.94))


def joint_limits(urdf):
    """Lower and upper limit of each joint that has some, by name; a turn of those that go round."""
    limits = {}
    for joint in xml.etree.ElementTree.parse(urdf).getroot().iter("joint"):
        if joint.get("type") == "continuous":
            limits[joint.get("name")] = (-math.pi, math.pi)
        elif joint.find("limit") is not None:
            limit = joint.find("limit")
            limits[joint.get("name")] = (float(limit.get("lower", 0)), float(limit.get("upper", 0)))
    return limits


def with_random_starts(compact, limits, chance):
    missing = [name for name in compact["joints"] if name not in limits]
    if missing:
        raise ValueError(f"joint '{missing[0]}' is none of the URDF's; expected limits of all joints of the problems")
    for problem in compact["problems"]:
        problem["start"] = [chance.uniform(*limits[name]) for name in compact["joints"]]
    return compact


def with_stick(compact, link, carried):
    for problem in compact["problems"]:
        problem["obstacles"] = [obstacle for obstacle in problem["obstacles"] if obstacle["name"] != carried]
        problem["attached"] = [{"link": link, **STICK}]
    return compact


def reaching(mneme, urdf, srdf, scene, chance):
    """A problem file; nothing if inverse kinematics finds no goal."""
    position = ",".join(f"{chance.uniform(*span):.4f}" for span in REACH)
    found = subprocess.run([mneme, "robot", "ik", urdf, "--srdf", srdf, "--group", "arm_with_torso", "--pose", f"gripper_link:{position}",
                            "--near", ",".join(map(str, TUCKED)), "--scene", scene, "--json"], capture_output=True, text=True, check=False)
    if not found.stdout:
        raise ValueError(f"{scene}: {found.stderr.strip()}")
    solutions = json.loads(found.stdout)["solutions"]
    if not solutions:
        return None
    return (f"robot: {json.dumps(str(pathlib.Path(urdf).resolve()))}\nsrdf: {json.dumps(str(pathlib.Path(srdf).resolve()))}\n"
            f"group: arm_with_torso\nscene: {json.dumps(str(pathlib.Path(scene).resolve()))}\n"
            f"start: {TUCKED}\ngoal: {solutions[0]['q']}\n")


def read_compact(path):
    try:
        compact = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from problem
    if not isinstance(compact, dict) or "joints" not in compact or "problems" not in compact:
        raise ValueError(f"{path}: expected compact problems with 'joints' and 'problems'")
    return compact


def write_reaches(mneme, urdf, srdf, scenes, folder, chance):
    folder.mkdir(parents=True, exist_ok=True)
    problems = {pathlib.Path(scene).name: reaching(mneme, urdf, srdf, scene, chance) for scene in scenes}
    for name, text in problems.items():
        if text:
            (folder / f"reach_{name}").write_text(text, encoding="utf-8")
    print(f"{sum(text is not None for text in problems.values())} of {len(problems)} scenes have a goal")


WANTED = {"starts": (2, 2, "PROBLEMS.json URDF"), "carry": (3, 3, "PROBLEMS.json LINK OBJECT"),
          "reach": (4, math.inf, "MNEME URDF SRDF SCENE.yaml ..")}


def write(arguments):
    least, most, names = WANTED[arguments.kind]
    if not least <= len(arguments.inputs) <= most:
        raise ValueError(f"{arguments.kind}: expected {names}, got {len(arguments.inputs)} arguments")
    chance = random.Random(arguments.seed)
    output = pathlib.Path(arguments.output)
    if arguments.kind == "reach":
        mneme, urdf, srdf, *scenes = arguments.inputs
        write_reaches(mneme, urdf, srdf, scenes, output, chance)
        return
    compact = read_compact(arguments.inputs[0])
    if arguments.kind == "starts":
        compact = with_random_starts(compact, joint_limits(arguments.inputs[1]), chance)
    else:
        compact = with_stick(compact, *arguments.inputs[1:])
    output.write_text(json.dumps(compact), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["starts", "carry", "reach"])
    parser.add_argument("inputs", nargs="+")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--seed", type=int, default=1)
    try:
        write(parser.parse_args())
    except (OSError, ValueError, xml.etree.ElementTree.ParseError) as problem:
        print(f"hard_problems: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
