# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/import_problems.py makes compact problems of MoveIt's messages, and refuses what it cannot express."""
import json
import os
import pathlib
import subprocess
import sys

import pytest
import yaml
from tools_of_source import TOOLS

DATA = pathlib.Path(os.environ.get("MNEME_DATA", "/nowhere")) / "mbm"


def thing(name, kind, dimensions, frame="base_link"):
    return {"header": {"frame_id": frame}, "id": name, "primitives": [{"type": kind, "dimensions": dimensions}],
            "primitive_poses": [{"position": [1, 2, 3], "orientation": [0, 0, 0.6, 0.8]}]}


def request(goal, **others):
    return {"goal_constraints": [{"joint_constraints": [{"joint_name": name, "position": value} for name, value in goal.items()]}],
            "start_state": {"joint_state": {"name": ["finger", "b", "a"], "position": [0.05, 0.25, 1.123456789]}}, **others}


def write(folder, number, objects, asked):
    scene = {"robot_model_name": "arm", "world": {"collision_objects": objects}}
    (folder / f"scene{number}.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    (folder / f"request{number}.yaml").write_text(yaml.safe_dump(asked), encoding="utf-8")


def run(folder, *flags):
    return subprocess.run([sys.executable, "-B", TOOLS / "import_problems.py", folder, "-o", folder / "out.json", *flags],
                          capture_output=True, text=True, check=False)


def made(folder, *flags):
    done = run(folder, *flags)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "out.json").read_text(encoding="utf-8"))


@pytest.fixture(name="folder")
def make_folder(tmp_path):
    things = [thing("can", "cylinder", [0.14, 0.03]), thing("board", "box", [1, 2, 3]), thing("ball", "sphere", [0.5])]
    for number in ("0001", "0002", "0010"):
        write(tmp_path, number, things, request({"a": 1, "b": int(number)}))
    return tmp_path


def test_messages_become_problems(folder):
    compact = made(folder)
    assert {key: compact[key] for key in compact if key != "problems"} == {
        "robot": "arm", "frame": "base_link", "joints": ["a", "b"], "fixed_joints": {"finger": 0.05}}
    first = compact["problems"][0]
    assert (first["index"], first["start"], first["goal"]) == (1, [1.1234568, 0.25], [1, 1])
    assert [problem["goal"][1] for problem in compact["problems"]] == [1, 2, 10]
    place = {"p": [1, 2, 3], "q": [0.8, 0, 0, 0.6]}
    assert first["obstacles"] == [{"name": "can", "type": "cylinder", **place, "length": 0.14, "radius": 0.03},
                                  {"name": "board", "type": "box", **place, "size": [1, 2, 3]},
                                  {"name": "ball", "type": "sphere", **place, "radius": 0.5}]


def test_halves_are_by_the_number_of_the_problem(folder):
    assert [problem["index"] for problem in made(folder, "--half", "odd")["problems"]] == [1]
    assert [problem["index"] for problem in made(folder, "--half", "even")["problems"]] == [2, 10]


def test_shapes_of_one_object_form_a_body(folder):
    desk = thing("desk", "box", [1, 1, 1])
    desk["primitives"] *= 2
    desk["primitive_poses"] *= 2
    write(folder, "0001", [desk], request({"a": 1, "b": 1}))
    assert [(part["name"], part["body"]) for part in made(folder, "--half", "odd")["problems"][0]["obstacles"]] == [
        ("desk_1", "desk"), ("desk_2", "desk")]


@pytest.mark.parametrize("objects, asked, words", [
    ([thing("can", "cone", [1, 2])], request({"a": 1}), "scene0001.yaml: 'can' is a cone"),
    ([thing("can", "box", [1, 1, 1]), thing("far", "sphere", [1], "map")], request({"a": 1}), "'far' is in frame 'map'"),
    ([{**thing("can", "box", [1, 1, 1]), "primitives": []}], request({"a": 1}), "expected 'can' to consist of primitives"),
    ([thing("can", "box", [1, 1, 1])], request({"c": 1}), "request0001.yaml: the start has no value of joint 'c'"),
    ([thing("can", "box", [1, 1, 1])], request({"b": 1}), "another 'joints' than problem 0001"),
    ([thing("can", "box", [1, 1, 1])], {**request({}), "goal_constraints": [{}]}, "expected one goal of joint constraints"),
    ([thing("can", "box", [1, 1, 1])], {}, "a message has no 'goal_constraints'")])
def test_what_cannot_be_expressed_is_refused(folder, objects, asked, words):
    write(folder, "0001", objects, asked)
    done = run(folder)
    assert done.returncode == 2 and words in done.stderr


def test_a_directory_without_messages_is_refused(tmp_path):
    done = run(tmp_path)
    assert done.returncode == 2 and "expected files requestNNNN.yaml" in done.stderr


@pytest.mark.skipif(not (DATA / "moveit_yaml").is_dir(), reason="needs MNEME_DATA")
@pytest.mark.parametrize("name", ["bookshelf_thin", "box", "cage"])
def test_published_messages_agree_with_the_problems_of_the_benchmarks(tmp_path, name):
    done = subprocess.run([sys.executable, "-B", TOOLS / "import_problems.py", DATA / "moveit_yaml" / f"{name}_fetch", "-o",
                           tmp_path / "out.json", "--half", "odd"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    ours = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    theirs = json.loads((DATA / "fetch" / f"{name}.json").read_text(encoding="utf-8"))
    assert {key: ours[key] for key in ("robot", "frame", "joints", "fixed_joints")} == {
        key: theirs[key] for key in ("robot", "frame", "joints", "fixed_joints")}
    known = {problem["index"]: problem for problem in theirs["problems"]}
    for problem in ours["problems"]:
        assert problem == known[problem["index"]]
