# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""`mneme serve` answers what docs/schema/service.openapi.json says, and takes what it allows."""
import http.client
import json
import re
import signal
import subprocess
import threading

import pytest

from test_schemas import PLANAR, PROGRAM, SOURCE, STORE, jsonschema, yaml

OPENAPI = json.loads((SOURCE / "docs/schema/service.openapi.json").read_text())


def complaints(schema, value):
    """Of a schema in the OpenAPI file, which may refer to others there and beside it."""
    store = {**STORE, "openapi": OPENAPI}
    resolver = jsonschema.RefResolver("openapi", OPENAPI, store=store)
    validator = jsonschema.Draft202012Validator(schema, resolver=resolver)
    return [f"{error.json_path}: {error.message[:300]}" for error in validator.iter_errors(value)]


def operation(method, path):
    for pattern, methods in OPENAPI["paths"].items():
        if re.fullmatch(re.sub(r"\{\w+\}", "[^/]+", pattern), path):
            return methods[method.lower()]
    raise AssertionError(f"{path} is not documented")


class Service:
    def __init__(self, *flags):
        command = [PROGRAM, "serve", "--robot", "planar8", "--listen", "127.0.0.1:0", *map(str, flags)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        self.port = int(line.rsplit(":", 1)[1])
        self.headers = {"Content-Type": "application/json"}

    def ask(self, method, path, body=None, status=200):
        """The answer, which is as documented; the body is as documented exactly if it is taken."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=100)
        connection.request(method, path, None if body is None else json.dumps(body), self.headers)
        response = connection.getresponse()
        text = response.read().decode()
        assert response.status == status, text
        documented = operation(method, path)
        answer = documented["responses"][str(status)]["content"]
        if "application/json" not in answer:
            assert response.getheader("Content-Type").split(";")[0] in answer
            return text
        value = json.loads(text)
        assert complaints(answer["application/json"]["schema"], value) == []
        if body is not None:
            wrong = complaints(documented["requestBody"]["content"]["application/json"]["schema"], body)
            assert bool(wrong) == (status == 400), (body, wrong)
        return value

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        assert self.process.wait(timeout=60) == 0


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    memory = tmp_path_factory.mktemp("service") / "memory.db"
    started = Service("--db", memory, "--remember-after", 0)
    if started.process.poll() is not None:
        pytest.skip("this mneme has no subcommand serve")
    yield started
    started.stop()


def question():
    problem = yaml.safe_load((PLANAR / "scenario1.yaml").read_text())
    scene = problem["scene"]
    if isinstance(scene, str):
        scene = yaml.safe_load((PLANAR / scene).read_text())
    circles = scene["circles"]
    return {"circles": list(circles.values()) if isinstance(circles, dict) else circles,
            "start": problem["start"], "goal": problem["goal"]}


def test_the_file_holds_schemas():
    for schema in OPENAPI["components"]["schemas"].values():
        jsonschema.Draft202012Validator.check_schema(schema)


def test_plans_are_as_documented(service):
    answer = service.ask("POST", "/v1/plan", {**question(), "trace": True, "clearance": True,
                                              "settings": {"seed": 3, "lambda": 0.5, "kind": "paths"}})
    assert answer["solved"] and answer["least_clearance"] > 0
    assert answer["remembered"] == "queued"
    service.ask("GET", f"/v1/plans/{answer['id']}/trace")
    service.ask("GET", "/v1/plans/99/trace", status=404)
    task = {key: value for key, value in question().items() if key != "goal"}
    stages = [{"name": "there", "move": question()["goal"]}, {"move": question()["start"]}]
    answer = service.ask("POST", "/v1/tasks", {**task, "stages": stages, "trajectory": True,
                                               "settings": {"seed": 3, "branches": 2}})
    assert answer["status"] == "solved" and answer["trajectory"]["stages"][0]["name"] == "there"
    service.ask("POST", "/v1/tasks", {**task, "stages": []}, status=400)
    hopeless = service.ask("POST", "/v1/plan", {**question(), "settings": {"max-iterations": 1, "replay": 0}})
    assert hopeless["status"] == "iteration_limit"


def test_scenes_are_as_documented(service):
    ball = {"name": "ball", "type": "sphere", "p": [20, 0, 0], "radius": 1}
    service.ask("PUT", "/v1/scenes/cell", {"circles": question()["circles"]})
    edited = service.ask("PATCH", "/v1/scenes/cell", {"remove": ["circle_1"], "obstacles": [ball]})
    assert edited["obstacles"] == ["circle_2", "ball"]
    assert service.ask("GET", "/v1/scenes/cell") == edited
    plan = {"scene": "cell", "start": question()["start"], "goals": [question()["goal"]]}
    assert service.ask("POST", "/v1/plan", plan)["solved"]
    assert service.ask("POST", "/v1/plan", {**plan, "obstacles": [{**ball, "name": "other"}]})["solved"]
    service.ask("PATCH", "/v1/scenes/none", {}, status=404)
    service.ask("DELETE", "/v1/scenes/cell")
    service.ask("GET", "/v1/scenes/cell", status=404)


POSE = {"link": "link_8", "position": [9, 3, 0], "position_tolerance": [0.5, 0.5, 0]}


def test_goals_that_are_poses_are_as_documented(service):
    scene = {"circles": question()["circles"]}
    near = {f"joint_{i}": 0.1 for i in range(1, 9)}
    found = service.ask("POST", "/v1/ik", {**scene, "goal": POSE, "near": near, "margin": 0.01,
                                           "settings": {"seed": 2, "ik-solutions": 3}})
    assert found["solutions"] and found["message"] is None
    far = service.ask("POST", "/v1/ik", {"goals": [{**POSE, "position": [90, 0, 0]}]})
    assert not far["solutions"] and "out of reach" in far["message"]
    start = question()["start"]
    for goals in ({"goal": POSE}, {"goals": [POSE, question()["goal"]]}):
        assert service.ask("POST", "/v1/plan", {**scene, "start": start, **goals})["solved"]


def test_all_shapes_are_taken_as_numbers(service):
    at = {"p": [20, 0, 0]}
    obstacles = [{"name": "a", "type": "sphere", **at, "radius": 1}, {"name": "b", "type": "box", **at, "size": [1, 1, 1]},
                 {"name": "c", "type": "points", "radius": 0.1, "points": [20, 0, 0, 20, 1, 0], "scale": 2},
                 {"name": "d", "type": "mesh", "triangles": [20, 0, 0, 20, 1, 0, 20, 0, 1]},
                 {"body": "e", "type": "octree", "cubes": [20, 0, 0, 0.5]}]
    assert service.ask("PUT", "/v1/scenes/shapes", {"obstacles": obstacles})["obstacles"] == list("abcde")
    rod = {"name": "rod", "link": "link_8", "touch": [], "shapes": [{"type": "sphere", "p": [10.1, 0, 0], "radius": 0.1}]}
    body = {"scene": "shapes", "start": [0] * 8, "goal": [0.1] * 8, "attached": [rod], "allow": [["rod", "a"]]}
    assert service.ask("POST", "/v1/plan", body)["status"] == "invalid_start"  # it touches the others
    service.ask("POST", "/v1/check", {"scene": "shapes", "allow": [["link_8", "a"]], "configurations": [[0] * 8]})
    service.ask("DELETE", "/v1/scenes/shapes")


def test_checks_health_and_metrics_are_as_documented(service):
    states = service.ask("POST", "/v1/check", {"circles": [[4, 0, 1]], "configurations": [[0] * 8, [1] * 8, [0]]})
    assert [state["valid"] for state in states["states"]] == [False, True, False]
    assert service.ask("GET", "/healthz")["status"] == "ok"
    assert "mneme_memory_rows" in service.ask("GET", "/metrics")


def test_the_page_holds_the_robot_and_asks_nobody_else(service):
    page = service.ask("GET", "/")
    trace = json.loads(re.search(r'<script type="application/json" id="trace">(.*?)</script>', page, re.S)[1])
    assert [tip["link"] for tip in trace["live"]["tips"]] == ["link_8"]
    assert len(trace["live"]["start"]) == 8
    assert not re.search(r'(src|href)="http|@import|url\(http', page)


@pytest.mark.parametrize("path, change", [
    ("/v1/plan", {"start": None}), ("/v1/plan", {"goals": [[0] * 8]}), ("/v1/plan", {"scene": "cell", "frame": "base"}),
    ("/v1/plan", {"gaol": 1}), ("/v1/plan", {"clearance": "yes"}), ("/v1/plan", {"circles": [[1, 2]]}),
    ("/v1/plan", {"settings": {"lambda": 2}}), ("/v1/plan", {"settings": {"remember-after": 1}}),
    ("/v1/plan", {"settings": {"lamda": 1}}), ("/v1/plan", {"obstacles": [{"name": "a", "type": "cone"}]}),
    ("/v1/plan", {"settings": {"threads": 0}}), ("/v1/plan", {"attached": [{"name": "a"}]}),
    ("/v1/plan", {"attached": [{"name": "a", "link": "link_8", "type": "mesh", "file": "/etc/passwd"}]}),
    ("/v1/plan", {"obstacles": [{"name": "a", "type": "mesh", "file": "package://a/b.stl"}]}),
    ("/v1/plan", {"obstacles": [{"name": "a", "type": "points", "radius": 1, "points": [1, 2]}]}),
    ("/v1/ik", {}), ("/v1/ik", {"goal": [0] * 8}), ("/v1/ik", {"goal": POSE, "start": [0] * 8}),
    ("/v1/ik", {"goal": {**POSE, "position_tolerance": -1}}), ("/v1/ik", {"goal": POSE, "margin": -1}),
    ("/v1/ik", {"goal": POSE, "settings": {"lambda": 0.5}}), ("/v1/ik", {"goal": POSE, "settings": {"ik-seeds": 0}}),
    ("/v1/ik", {"goal": POSE, "obstacles": [{"name": "a", "type": "points", "radius": 1, "file": "../a.ply"}]}),
    ("/v1/check", {"configurations": 1}), ("/v1/check", {"configurations": [[0] * 8], "gaol": 1})])
def test_what_is_not_documented_is_refused(service, path, change):
    body = {**question(), **change} if path == "/v1/plan" else change
    service.ask("POST", path, {key: value for key, value in body.items() if value is not None}, status=400)


def stored_rows(service):
    """Rows of plans that /metrics reports as stored."""
    return int(re.search(r"^mneme_remembered_total (\d+)", service.ask("GET", "/metrics"), re.M).group(1))


def test_what_is_reported_as_stored_survives_a_killed_service(tmp_path):
    """Killed while clients plan, several times with one memory: what /metrics counted is all that they know of it."""
    memory = tmp_path / "memory.db"
    kept = 0
    for round_number in range(3):
        killed = Service("--db", memory, "--remember-after", 0)

        def plan(number):
            for seed in range(1000):
                settings = {"seed": 1000 * number + seed, "kind": "paths", "timeout": 50}
                try:
                    killed.ask("POST", "/v1/plan", {**question(), "settings": settings})
                except (OSError, http.client.HTTPException):
                    return  # it was killed

        clients = [threading.Thread(target=plan, args=(3 * round_number + number,)) for number in range(3)]
        for client in clients:
            client.start()
        stored = 0
        while stored < 5:
            stored = stored_rows(killed)
        killed.process.kill()
        for client in clients:
            client.join()
        killed.process.wait(timeout=60)
        left = Service("--db", memory)
        rows = left.ask("GET", "/healthz")["memory"]["rows"]
        assert rows >= kept + stored > 0, (rows, kept, stored)
        kept = rows  # with what was stored and not heard of
        left.stop()
    assert b"" == subprocess.run([PROGRAM, "db", "verify", memory], capture_output=True, timeout=60, check=True).stderr


def test_two_services_share_one_memory(tmp_path):
    memory = tmp_path / "memory.db"
    teacher = Service("--db", memory, "--remember-after", 0)
    settings = {"kind": "paths"}
    assert teacher.ask("POST", "/v1/plan", {**question(), "settings": settings})["remembered"] == "queued"
    while stored_rows(teacher) == 0:
        pass
    pupil = Service("--db", memory)
    teacher.ask("POST", "/v1/plan", {**question(), "settings": {**settings, "seed": 2}})
    while stored_rows(teacher) < 2:
        pass
    rows = teacher.ask("GET", "/healthz")["memory"]["rows"]
    while pupil.ask("GET", "/healthz")["memory"]["rows"] < rows:
        pass  # it looks once a second
    teacher.stop()
    pupil.stop()


def test_a_token_is_asked_for(tmp_path):
    (tmp_path / "token").write_text("secret\n")
    service = Service("--token-file", tmp_path / "token")
    service.ask("GET", "/metrics", status=401)
    service.headers["Authorization"] = "Bearer secret"
    service.ask("GET", "/metrics")
    service.stop()


@pytest.mark.parametrize("flags, code, words", [
    (("--listen", "0.0.0.0:0"), 1, "other machines reach"), (("--listen", "nowhere"), 2, "expected HOST:PORT"),
    (("--listen", "unix:"), 2, "expected unix:PATH"), (("--token-file", "/dev/null"), 1, "expected a token"),
    (("--robot", "nobody"), 1, "nobody"), (("--remember-after", "1"), 2, "--db")])
def test_a_wrong_command_line_is_refused(flags, code, words):
    robot = () if "--robot" in flags else ("--robot", "planar8")
    done = subprocess.run([PROGRAM, "serve", *robot, *flags], capture_output=True, text=True, timeout=60)
    assert done.returncode == code and words in done.stderr


def test_a_token_that_is_not_there_is_refused_before_a_memory_is_made(tmp_path):
    done = subprocess.run([PROGRAM, "serve", "--robot", "planar8", "--db", tmp_path / "new.db", "--remember-after", "1",
                           "--token-file", tmp_path / "none"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "none: cannot be read" in done.stderr
    assert not (tmp_path / "new.db").exists()
