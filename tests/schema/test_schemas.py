# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/schema describes what mneme reads and writes: right files fit, wrong ones do not, and the program agrees."""
import copy
import json
import os
import pathlib
import re
import subprocess

import pytest

jsonschema = pytest.importorskip("jsonschema", reason="python3-jsonschema is not installed")
yaml = pytest.importorskip("yaml", reason="python3-yaml is not installed")

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])
PROGRAM = os.environ["MNEME_PROGRAM"]
SCHEMAS = {path.name.split(".")[0]: json.loads(path.read_text())
           for path in sorted((SOURCE / "docs/schema").glob("*.schema.json"))}
STORE = {schema["$id"]: schema for schema in SCHEMAS.values()}

PLANAR = SOURCE / "scenes/planar"
SHELF = SOURCE / "scenes/shelf"


def complaints(name, value):
    schema = SCHEMAS[name]
    resolver = jsonschema.RefResolver("", schema, store=STORE)
    validator = jsonschema.Draft202012Validator(schema, resolver=resolver)
    return [f"{error.json_path}: {error.message[:300]}" for error in validator.iter_errors(value)]


def mneme(*words, status=0):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=120)
    assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def kind_of(value):
    """The format of a YAML or JSON file, by the keys that only it has."""
    keys = set(value)
    if "problems" in keys:
        return "suite" if "robot" not in keys else "compact"
    if "distance" in keys:
        return "grid"
    if "stages" in keys:
        return "task"
    if "robot" in keys:
        return "problem"
    obstacles = value.get("obstacles")
    return "variations" if isinstance(obstacles, dict) or "scene" in keys else "scene"


def files():
    found = [path for folder in ("scenes", "examples", "bench/suites") for ending in ("yaml", "json")
             for path in sorted((SOURCE / folder).rglob(f"*.{ending}"))]
    return [pytest.param(path, id=str(path.relative_to(SOURCE))) for path in found]


def documented():
    """The blocks of YAML and JSON in the documents, one after the other."""
    blocks = []
    for path in sorted(SOURCE.glob("docs/**/*.md")):
        found = re.findall(r"^```(?:yaml|json)\n(.*?)^```", path.read_text(), re.MULTILINE | re.DOTALL)
        blocks += [pytest.param(block, id=f"{path.name}-{i}") for i, block in enumerate(found, 1)]
    return blocks


@pytest.mark.parametrize("schema", SCHEMAS)
def test_a_schema_is_one(schema):
    jsonschema.Draft202012Validator.check_schema(SCHEMAS[schema])


@pytest.mark.parametrize("path", files())
def test_files_that_come_with_mneme_fit(path):
    value = yaml.safe_load(path.read_text())
    assert complaints(kind_of(value), value) == []


@pytest.mark.parametrize("block", documented())
def test_examples_in_the_documents_fit(block):
    value = yaml.safe_load(block)
    assert complaints(kind_of(value), value) == []


@pytest.fixture(scope="module")
def memory(tmp_path_factory):
    path = tmp_path_factory.mktemp("memory") / "memory.db"
    mneme("learn", "--robot", "planar8", "--scenes", PLANAR / "scenario1.yaml", "--db", path)
    return path


@pytest.mark.parametrize("flags, status", [
    ((), 0), (("--max-iterations", "1"), 3), (("--start", "0,0"), 4), (("--planner", "prm"), 0)])
def test_results_of_plans_fit(memory, flags, status):
    output = mneme("plan", PLANAR / "scenario1.yaml", "--db", memory, "--json", *flags, status=status)
    assert complaints("plan", json.loads(output)) == []


@pytest.mark.parametrize("problem", [PLANAR / "scenario1.yaml", SHELF / "thin.yaml"], ids=["flat", "space"])
def test_traces_fit(tmp_path, problem):
    trace = tmp_path / "trace.json"
    mneme("plan", problem, "--trace", trace, "--max-iterations", "200000")
    value = json.loads(trace.read_text())
    assert complaints("trace", value) == []
    assert complaints("trace", {**value, "version": 2})
    assert complaints("trace", {key: value[key] for key in value if key != "waypoints"})


def test_trajectories_fit(tmp_path):
    trajectory = tmp_path / "motion.json"
    output = mneme("plan", PLANAR / "scenario1.yaml", "--trajectory", trajectory, "--json")
    assert complaints("plan", json.loads(output)) == []
    value = json.loads(trajectory.read_text())
    assert complaints("trajectory", value) == []
    assert value["duration_s"] == value["times"][-1] == json.loads(output)["duration_s"]
    assert complaints("trajectory", {key: value[key] for key in value if key != "times"})


def test_exported_rows_fit(memory, tmp_path):
    exported = tmp_path / "memory.jsonl"
    mneme("db", "export", memory, exported)
    lines = [json.loads(line) for line in exported.read_text().splitlines()]
    assert len(lines) == 2
    for line in lines:
        assert complaints("experience", line) == []

    broken = {key: lines[1][key] for key in lines[1] if key != "means"}
    assert complaints("experience", broken)
    exported.write_text("\n".join(map(json.dumps, (lines[0], broken))) + "\n")
    mneme("db", "import", tmp_path / "other.db", exported, status=1)


def test_scenes_and_problems_that_the_program_writes_fit(tmp_path):
    mneme("scene", "vary", SHELF / "learn/shelf_1.yaml", "--variations", SHELF / "learn/variations.yaml",
          "-n", "2", "-o", tmp_path)
    scene = tmp_path / "scene.yaml"
    mneme("scene", "convert", SHELF / "thin.yaml", "-o", scene)
    threaded = tmp_path / "threaded.json"
    mneme("scene", "threaded", "--robot", "planar8", "-n", "1", "-o", threaded)
    enclosed = tmp_path / "enclosed.json"
    mneme("scene", "enclosed", "--robot", "panda", "-n", "2", "--boxes", "20", "-o", enclosed)
    composed, lessons = tmp_path / "composed.json", tmp_path / "lessons.json"
    mneme("scene", "composed", "--robot", "panda", "-n", "2", "--boxes", "20", "--modules", "3", "-o", composed, "--lessons", lessons)
    written = sorted(tmp_path.glob("*.yaml"))
    assert len(written) == 3
    for path in written:
        assert complaints("scene", yaml.safe_load(path.read_text())) == [], path
    for path in threaded, enclosed, composed, lessons:
        assert complaints("compact", json.loads(path.read_text())) == [], path


SCENE = {"obstacles": [
    {"name": "ball", "type": "sphere", "position": [1, 0, 0.5], "radius": 0.1},
    {"body": "table", "type": "box", "position": [1, 0, 0.4], "quat_xyzw": [0, 0, 0, 1], "size": [0.8, 1, 0.1]},
    {"name": "can", "type": "cylinder", "position": [1, 0.3, 0.5], "radius": 0.03, "length": 0.12},
    {"name": "bar", "type": "capsule", "a": [0, 0, 1], "b": [1, 0, 1], "radius": 0.02},
    {"name": "map", "type": "octree", "cubes": [1, 0.5, 0.5, 0.1]}]}
PROBLEM = {"robot": "planar8", "scene": {"circles": {"a": [20, 0, 1]}}, "start": [0.0] * 8, "goal": [0.1] * 8}
COMPACT = {"robot": "planar8", "remark": "any",
           "problems": [{"index": 7, "start": [0.0] * 8, "goal": [0.1] * 8, "circles": [[20, 0, 1]]}]}
GRID = {"radius": [1, 2], "gap": [0.1, 1], "distance": [0.1, 2], "count": 1, "max_similarity_error": 1000}
VARIATIONS = {"scene": {"center": [1, 0, 0], "scale": {"uniform": 0.04}},
              "obstacles": {"ba*": {"position": {"gaussian": [0, 0.1, 0]}, "rpy": {"uniform": [0, 0, 1]}},
                            "can": {"size": {"uniform": [0.001, 0]}}}}
SUITE = {"problems": [{"file": str(PLANAR / "scenario1.yaml"), "set": "one", "part": "1/1"}], "seeds": 1,
         "settings": {"plain": {"samplers": "uniform", "max-iterations": 1000000, "simplify": False}}}
RIGHT = {"scene": SCENE, "problem": PROBLEM, "compact": COMPACT, "grid": GRID, "variations": VARIATIONS, "suite": SUITE}

# What is put where, by the path of keys; None takes the key away.
WRONG = [
    ("scene", ["obstacls"], []),
    ("scene", ["obstacles", 0, "radius"], -0.1),
    ("scene", ["obstacles", 0, "radius"], None),
    ("scene", ["obstacles", 0, "size"], [1, 1, 1]),
    ("scene", ["obstacles", 0, "name"], None),
    ("scene", ["obstacles", 0, "type"], "cone"),
    ("scene", ["obstacles", 0, "position"], [1, 0]),
    ("scene", ["obstacles", 1, "size"], [0.8, 1, -0.1]),
    ("scene", ["obstacles", 1, "quat_xyzw"], [0, 0, 0, 0]),
    ("scene", ["obstacles", 2, "length"], "long"),
    ("scene", ["obstacles", 3, "length"], 1),
    ("scene", ["obstacles", 4, "unknown"], "occupied"),
    ("scene", ["obstacles", 4, "file"], "map.bt"),
    ("scene", ["circles"], {"a": [1, 2]}),
    ("scene", ["circles"], [[1, 2, -1]]),
    ("problem", ["robot"], None),
    ("problem", ["scene"], None),
    ("problem", ["scene"], [1]),
    ("problem", ["scene", "circels"], {}),
    ("problem", ["start"], None),
    ("problem", ["goal"], None),
    ("problem", ["goals"], [[0.1] * 8]),
    ("problem", ["joints"], "joint_1"),
    ("problem", ["fixed_joints"], {"a": "b"}),
    ("problem", ["gaol"], [0.1] * 8),
    ("problem", ["goal"], {"link": "link_8"}),
    ("problem", ["goal"], {"link": "link_8", "position": [1, 0, 0], "quat_xyzw": [0, 0, 1]}),
    ("problem", ["goal"], {"link": "link_8", "position": [1, 0, 0], "cone": 0.1}),
    ("problem", ["goal"], {"link": "link_8", "position": [1, 0, 0], "position_tolerance": -1}),
    ("problem", ["start"], {"joint_1": "home"}),
    ("compact", ["problems"], None),
    ("compact", ["problems"], []),
    ("compact", ["problems", 0, "circles"], None),
    ("compact", ["problems", 0, "start"], 5),
    ("compact", ["problems", 0, "obstacles"], [{"name": "a", "type": "sphere", "position": [9, 9, 9], "radius": 1}]),
    ("grid", ["radius"], None),
    ("grid", ["gap"], [0, 1]),
    ("grid", ["count"], 1.5),
    ("grid", ["hight"], [1, 2]),
    ("variations", ["scene", "size"], {"uniform": 1}),
    ("variations", ["scene", "scale"], {"uniform": [1, 2]}),
    ("variations", ["scene", "scale"], {}),
    ("variations", ["obstacles", "can", "size"], {"uniform": [1, 1, 1, 1]}),
    ("variations", ["obstacles", "ba*", "position"], {"gaussian": [0, 1]}),
    ("variations", ["obstacles", "ba*", "position"], {"gaussian": [0, -1, 0]}),
    ("variations", ["obstacles", "ba*", "position"], {"gaussian": [0, 1, 0], "uniform": [0, 1, 0]}),
    ("suite", ["problems"], []),
    ("suite", ["problems", 0, "file"], None),
    ("suite", ["seeds"], 0),
    ("suite", ["settings", "plain", "lambda"], 2),
    ("suite", ["settings", "plain", "lamda"], 1),
    ("suite", ["settings", "plain", "max-matches"], 0),
    ("suite", ["settings", "plain", "first-components"], 0),
    ("suite", ["settings", "plain", "resolution"], 0),
    ("suite", ["settings", "plain", "simplify"], 1),
    ("suite", ["memories"], {"own": {}}),
    ("suite", ["memories"], {"own": {"primitives": "grid.yaml"}}),
    ("suite", ["memories"], {"own": {"problems": [str(PLANAR / "scenario1.yaml")], "decomposer": "pairs"}}),
    ("suite", ["memories"], {"own": {"file": "a.db", "primitives": "grid.yaml", "robot": "planar8"}}),
    ("suite", ["memories"], {"own": {"file": "a.db", "starts-per-link": 0}}),
]


POSE = {"link": "link_8", "position": [9, 3, 0], "quat_xyzw": [0, 0, 0, 1], "position_tolerance": [3, 3, 0],
        "axis": "z", "cone": 0, "turn": "free", "frame": "link_1"}


def test_the_program_reads_poses_and_maps_that_fit(tmp_path):
    start = {f"joint_{i}": 0.0 for i in range(1, 9)}
    value = {**PROBLEM, "start": start, "goals": [POSE, {**start, "joint_1": 0.1}]}
    del value["goal"]
    assert complaints("problem", value) == []
    read("problem", value, tmp_path, status=0)


def changed(value, path, to):
    value = copy.deepcopy(value)
    place = value
    for key in path[:-1]:
        place = place[key]
    if to is None:
        del place[path[-1]]
    else:
        place[path[-1]] = to
    return value


def read(name, value, folder, status):
    """Has the program read a file."""
    path = folder / ("file.json" if name == "compact" else "file.yaml")
    path.write_text(json.dumps(value) if name == "compact" else yaml.safe_dump(value))
    if name == "scene":
        mneme("scene", "info", path, status=status)
    elif name == "problem":
        mneme("plan", path, status=status)
    elif name == "compact":
        mneme("plan", f"{path}#7", status=status)
    elif name == "grid":
        mneme("learn", "--robot", "planar8", "--primitives", path, "--db", folder / "file.db", status=status)
    elif name == "variations":
        scene = folder / "scene.yaml"
        scene.write_text(json.dumps(SCENE))
        mneme("scene", "vary", scene, "--variations", path, "-n", "1", "-o", folder, status=status)
    else:
        mneme("bench", "run", path, "--out", folder / "out", status=status)


@pytest.mark.parametrize("name", RIGHT)
def test_the_program_reads_what_fits(name, tmp_path):
    assert complaints(name, RIGHT[name]) == []
    read(name, RIGHT[name], tmp_path, status=0)


@pytest.mark.parametrize("name, path, to", WRONG, ids=[f"{name}-{'.'.join(map(str, path))}" for name, path, _ in WRONG])
def test_neither_takes_what_is_wrong(name, path, to, tmp_path):
    wrong = changed(RIGHT[name], path, to)
    assert complaints(name, wrong)
    read(name, wrong, tmp_path, status=1)


def test_a_suite_may_have_every_setting_of_plan():
    help_text = mneme("plan", "--help-all")
    flags = set(re.findall(r"^  (?:-\w,)?--([a-z-]+)", help_text, re.MULTILINE))
    others = {"help", "help-all", "robot", "srdf", "group", "package-path", "start", "start-velocity", "end-velocity", "blend-tolerance", "fix", "goal", "goal-pose", "upright", "self-filter", "db", "db-memory", "planner",
              "sampler", "seed", "memory", "kind", "isa", "view", "beside", "svg", "trace", "json", "trajectory", "joint-limits", "dt",
              "velocity-scale", "acceleration-scale", "acceleration-limit", "jerk-limit", "path-tolerance", "time-rounds", "strict", "hard-limits"}
    assert others <= flags
    definitions = SCHEMAS["suite"]["$defs"]
    assert set(definitions["planning"]["properties"]) | set(definitions["learning"]["properties"]) == flags - others
