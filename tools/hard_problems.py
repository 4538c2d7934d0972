#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes hard or foreign problems of others, for bench/suites/hard.yaml, transfer.yaml and worlds.yaml.

usage: hard_problems.py starts PROBLEMS.json URDF -o OUT.json          random starts within the joints' limits
       hard_problems.py carry PROBLEMS.json LINK OBJECT -o OUT.json    that link, a gripper, carries a stick instead of the object
       hard_problems.py meshes PROBLEMS.json -o OUT.json               obstacles as triangles
       hard_problems.py clouds PROBLEMS.json -o OUT.json               what a sensor would see of all obstacles: one cloud
       hard_problems.py segments PROBLEMS.json -o OUT.json             the same as a cloud for each obstacle
       hard_problems.py reach MNEME URDF SRDF SCENE.yaml .. -o DIRECTORY
                                                  from a tucked arm to a random place in the shelf of each scene

Meshes and clouds are those of boxes and cylinders; round sides have 32 faces within the cylinder. Points are at most 2 cm apart, and 5 mm thick.
With --points N there are about N of them, 5 mm below the surface, so that a cloud is as large as its solids.
--seed N makes others. Starts, and what is carried, may be in contact: benchmarks leave such problems out, and say how many there
were. Goals in shelves are MNEME's inverse kinematics, free of contact; scenes where it finds none are counted and left out.
"""
import argparse
import itertools
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
SIDES = 32  # of a cylinder
APART = 0.02  # metres between points of a cloud, at most
RADIUS = 0.005  # of points, metres
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


def turned(q, p):
    """The vector p, turned by the quaternion q: w, x, y, z."""
    w, *v = q
    cross = [v[1] * p[2] - v[2] * p[1] + w * p[0], v[2] * p[0] - v[0] * p[2] + w * p[1], v[0] * p[1] - v[1] * p[0] + w * p[2]]
    return [p[i] + 2 * (v[(i + 1) % 3] * cross[(i + 2) % 3] - v[(i + 2) % 3] * cross[(i + 1) % 3]) for i in range(3)]


def faces_of(obstacle):
    """Corner and two edges of each parallelogram of the surface, and two edges of each triangle, in the obstacle's own frame."""
    if obstacle["type"] == "box":
        x, y, z = (0.5 * size for size in obstacle["size"])
        edges = [[2 * x, 0, 0], [0, 2 * y, 0], [0, 0, 2 * z]]
        for side in (-1, 1):
            corner = [side * x, side * y, side * z]
            for i in range(3):
                yield corner, *([-side * value for value in edges[k]] for k in range(3) if k != i), False
        return
    if obstacle["type"] != "cylinder":
        raise ValueError(f"obstacle '{obstacle['name']}': expected a box or a cylinder, got a {obstacle['type']}")
    radius, length = obstacle["radius"], obstacle["length"]
    rim = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in (math.tau * i / SIDES for i in range(SIDES + 1))]
    for (x, y), (next_x, next_y) in zip(rim, rim[1:]):
        yield [x, y, -0.5 * length], [next_x - x, next_y - y, 0], [0, 0, length], False
        for z in (-0.5 * length, 0.5 * length):
            yield [0, 0, z], [x, y, 0], [next_x, next_y, 0], True


def placed_faces(obstacle):
    """As faces_of, where the obstacle is."""
    for corner, edge, other, is_triangle in faces_of(obstacle):
        corner = [place + value for place, value in zip(obstacle["p"], turned(obstacle["q"], corner))]
        yield corner, turned(obstacle["q"], edge), turned(obstacle["q"], other), is_triangle


def along(corner, edge, share, other, other_share):
    return tuple(round(c + share * e + other_share * o, 5) for c, e, o in zip(corner, edge, other))


def triangles_of(obstacle):
    for corner, edge, other, is_triangle in placed_faces(obstacle):
        a, b, c, d = (along(corner, edge, i, other, k) for i, k in ((0, 0), (1, 0), (0, 1), (1, 1)))
        yield from (*a, *b, *c)
        if not is_triangle:
            yield from (*b, *c, *d)


def points_of(obstacle, apart):
    for corner, edge, other, is_triangle in placed_faces(obstacle):
        steps = [max(1, math.ceil(math.hypot(*side) / apart)) for side in (edge, other)]
        for i in range(steps[0] + 1):
            for k in range(steps[1] + 1):
                share, other_share = i / steps[0], k / steps[1]
                if not is_triangle or share + other_share <= 1:
                    yield along(corner, edge, share, other, other_share)


def inset(obstacle):
    """The obstacle without what its points will stick out by; what is thinner keeps a hundredth of its size."""
    def thinner(size, by):
        return max(size - by, 0.01 * size)

    if obstacle["type"] == "box":
        return {**obstacle, "size": [thinner(size, 2 * RADIUS) for size in obstacle["size"]]}
    return {**obstacle, "radius": thinner(obstacle["radius"], RADIUS), "length": thinner(obstacle["length"], 2 * RADIUS)}


def spacing(obstacles, count):
    """Metres between about so many points on all surfaces."""
    area = sum(math.hypot(*edge) * math.hypot(*other) * (0.5 if is_triangle else 1)
               for obstacle in obstacles for _, edge, other, is_triangle in faces_of(obstacle))
    return math.sqrt(area / count)


def as_meshes(compact):
    for problem in compact["problems"]:
        problem["obstacles"] = [{"name": obstacle["name"], "type": "mesh", "triangles": list(triangles_of(obstacle))}
                                for obstacle in problem["obstacles"]]
    return compact


def cloud(name, points):
    return {"name": name, "type": "points", "radius": RADIUS, "points": [value for point in dict.fromkeys(points) for value in point]}


def as_clouds(compact, count, is_one):
    for problem in compact["problems"]:
        obstacles = problem["obstacles"] if count is None else list(map(inset, problem["obstacles"]))
        apart = APART if count is None else spacing(obstacles, count)
        clouds = [(obstacle["name"], points_of(obstacle, apart)) for obstacle in obstacles]
        if is_one:
            clouds = [("scan", itertools.chain(*(points for _, points in clouds)))]
        problem["obstacles"] = [cloud(*of) for of in clouds]
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
          "meshes": (1, 1, "PROBLEMS.json"), "clouds": (1, 1, "PROBLEMS.json"), "segments": (1, 1, "PROBLEMS.json"),
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
    elif arguments.kind == "carry":
        compact = with_stick(compact, *arguments.inputs[1:])
    elif arguments.kind == "meshes":
        compact = as_meshes(compact)
    else:
        compact = as_clouds(compact, arguments.points, arguments.kind == "clouds")
    output.write_text(json.dumps(compact), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=list(WANTED))
    parser.add_argument("inputs", nargs="+")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--points", type=int)
    try:
        write(parser.parse_args())
    except (OSError, ValueError, xml.etree.ElementTree.ParseError) as problem:
        print(f"hard_problems: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
