# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""A client of `mneme serve`. Needs only the standard library and NumPy."""
import json
import math
import time
import urllib.parse

import numpy as np

from ._connections import Connections, make_error
from ._mneme import PoseGoal, Scene
from ._solutions import Solutions

_GRACE_S = 0.4  # for the answer to a plan with a time limit
_LEAST_S_PER_PART = 8e-6  # to write, send and read a point, triangle or cube of a scene, on fast machines


class Busy(Exception):
    """The service has too many requests. Try again after `retry_after_s` seconds."""

    def __init__(self, message, retry_after_s):
        super().__init__(message)
        self._retry_after_s = retry_after_s

    @property
    def retry_after_s(self):
        return self._retry_after_s

    def __reduce__(self):
        return Busy, (str(self), self._retry_after_s)


class _Answer(dict):
    """An answer of the service, whose missing keys are errors of the service."""

    def __missing__(self, key):
        raise make_error("io", f"expected an answer of `mneme serve` with the key '{key}', got {_excerpt(json.dumps(self))}")


def _excerpt(text):
    """Returns the beginning of a received text for messages."""
    if isinstance(text, bytes):
        text = text.decode(errors="replace")
    return repr(text[:80] + ("..." if len(text) > 80 else ""))


def _parsed(status, text):
    """Returns the answer, an object that for a status of 400 or more has an error. Raises mneme.Error for another."""
    try:
        answer = json.loads(text)
    except (ValueError, RecursionError):
        answer = None
    if isinstance(answer, dict):
        error = answer.get("error")
        is_error = isinstance(error, dict) and all(isinstance(error.get(key), str) for key in ("code", "message"))
        if status < 400 or is_error:
            return _Answer(answer)
    raise make_error("io", f"expected an answer of `mneme serve`, got HTTP status {status} with {_excerpt(text)}")


def _pause(retry_after):
    """Returns the seconds of a header Retry-After: 1 where it is a date."""
    try:
        pause = float(retry_after)
    except ValueError:
        return 1.0
    return pause if 0 <= pause < math.inf else 1.0


def _array(rows, joint_count):
    """Returns received rows of numbers as an array, of shape (0, joint_count) without rows."""
    try:
        return np.array(rows, dtype=float) if rows else np.empty((0, joint_count))
    except (TypeError, ValueError) as failure:
        raise make_error("io", f"expected rows of numbers from `mneme serve`, got {_excerpt(str(rows))}") from failure


class RemotePlan:
    """The result of Client.plan(), with the names of Plan for the attributes that are sent."""

    def __init__(self, answer, client, joint_count=0):
        self._answer = answer
        self._client = client
        self._joint_count = joint_count  # of a path without rows

    @property
    def answer(self):
        """A dict with the keys of `mneme plan --json`."""
        return self._answer

    @property
    def is_solved(self):
        return self._answer["solved"]

    @property
    def message(self):
        return self._answer.get("message", "")

    @property
    def notes(self):
        return self._answer.get("notes", [])

    @property
    def path(self):
        return _array(self._answer["path"], self._joint_count)

    @property
    def remembered(self):
        """True if the service is storing the path meanwhile."""
        return bool(self._answer["remembered"])

    @property
    def remember_failure(self):
        return self._answer.get("remember_failure", "")

    @property
    def replayed(self):
        """The row of the service's database whose path was replayed; 0 if none was."""
        return self._answer.get("replay", {}).get("row", 0)

    @property
    def replay(self):
        """Says whether a known task was replayed, and if not, why. Empty if no memory of whole paths was queried."""
        return self._answer.get("replay", {}).get("explanation", "")

    def to_json(self):
        """Returns the JSON that `mneme plan --json` prints."""
        return json.dumps(self._answer, indent=2)

    def to_trace(self):
        """Returns the plan as geometry: JSON for `mneme view`. Needs plan(..., trace=True)."""
        if "id" not in self._answer:
            raise ValueError("this plan has no trace: use plan(..., trace=True)")
        return json.dumps(self._client.ask("GET", f"/v1/plans/{self._answer['id']}/trace"))

    def __repr__(self):
        return (f"<mneme.RemotePlan {self.status}, {len(self.path)} configurations, "
                f"{1e3 * self.planning_time_s:.3f} ms>")


for _name in ("status", "path_length", "total_time_s", "preparation_time_s", "planning_time_s", "retrieval_time_s",
              "learning_time_s", "simplification_time_s", "verification_time_s", "iterations", "states_checked", "motions_checked",
              "planner", "sampler", "seed", "isa"):
    setattr(RemotePlan, _name, property(lambda self, name=_name: self._answer[name]))


_SCENE_KEYS = ("circles", "obstacles", "allow")


class _Json(str):
    """The text of a value in JSON. Parsing a large scene to write it again would take longer than planning."""


def _members(compact):
    """Returns the keys and values of the only problem in the text of a compact file, which indents them by 3 spaces."""
    begin = compact.index('\n "problems": [') + len('\n "problems": [')
    members = compact[begin:compact.rindex("\n  }\n ]")].split('\n   "')[1:]
    pairs = (member.rstrip(",").split('": ', 1) for member in members)
    # Each number of a cloud has a line.
    return {key: _Json(value.replace("\n      ", "")) for key, value in pairs}


def _scene_keys(scene):
    """Returns a Scene, or a dict with keys of compact files, as keys of a request."""
    if isinstance(scene, dict):
        return dict(scene)
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene or a dict with keys of compact files, got {scene!r:.80}")
    members = _members(scene.to_compact_json())
    return {key: members[key] for key in _SCENE_KEYS if key in members}


def _json(key, value):
    """Returns the text of a value, which `key` names in errors. NumPy's arrays and numbers may be within."""

    def plain(part):
        if isinstance(part, (np.ndarray, np.generic)):
            return part.tolist()
        raise TypeError(f"{key}: {part!r:.80} is no number, text, list, dict or array")

    try:
        return value if isinstance(value, _Json) else json.dumps(value, allow_nan=False, default=plain)
    except ValueError:
        raise make_error("invalid", f"{key}: expected finite numbers") from None


def _text(body):
    """Returns a body as JSON, in bytes."""
    return ("{" + ",".join(f"{json.dumps(key)}:{_json(key, value)}" for key, value in body.items()) + "}").encode()


def _check_size(scene, end):
    """Raises TimeoutError if writing the scene takes longer than until `end`, a time.monotonic()."""
    count = scene._part_count()
    if time.monotonic() + _LEAST_S_PER_PART * count > end:
        raise TimeoutError(f"timed out: writing the {count} points, triangles and cubes of the scene takes longer than "
                           "the time limit; upload the scene with put_scene() and name its id")


def _numbers(values, name):
    """Returns an array of float64. Raises TypeError, which names the argument, as this module's functions do."""
    try:
        array = np.asarray(values)
    except ValueError:
        array = None
    if array is None or (array.size > 0 and array.dtype.kind not in "fiu"):
        raise TypeError(f"{name}: expected an array of real numbers, got {values!r:.80}")
    return array.astype(float)


def _configuration(q, name):
    """Returns JSON: values of all joints, a dict by name, or the name of a state."""
    return q if isinstance(q, (str, dict)) else _numbers(q, name).tolist()


def _goals(goals):
    """Returns a list for JSON of one or more configurations and PoseGoals."""
    if isinstance(goals, (PoseGoal, str, dict)):
        goals = [goals]
    if not any(isinstance(goal, (PoseGoal, str, dict)) for goal in goals):
        return np.atleast_2d(_numbers(goals, "goals")).tolist()
    return [json.loads(goal.to_json()) if isinstance(goal, PoseGoal) else _configuration(goal, "goals")
            for goal in goals]


def _seconds(name, value):
    """Checks a setting that is a time or None."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.generic, type(None))):
        raise TypeError(f"Client.plan: {name}={value!r} is not a number of seconds")
    if value is not None and not value >= 0:
        raise make_error("invalid", f"Client.plan: {name}={value!r} is out of range: expected 0 or more")


def _settings(settings):
    """Returns settings by their names in requests."""
    return {name.rstrip("_").replace("_", "-"): _plain(value) for name, value in settings.items() if value is not None}


def _plain(value):
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else value


def _constraint(constraint):
    return {"link": constraint.link, "axis": constraint.axis.tolist(), "up": constraint.up.tolist(), "angle": constraint.angle}


class Client:
    """A client of the service at `url`, such as "http://127.0.0.1:7890" or "unix:/run/mneme.sock".

    Keeps its connections open, so that a plan takes about 0.1 ms longer than in-process. Threads may share a client, and
    forked processes may inherit one. Refused requests raise mneme.Error. If the queue of the service is full, waits up
    to `patience_s` seconds and raises mneme.Busy then. A request without an answer after `timeout_s` seconds raises
    TimeoutError.
    """

    def __init__(self, url="http://127.0.0.1:7890", token=None, timeout_s=120.0, patience_s=30.0):
        self._headers = {"Content-Type": "application/json"}
        if token is not None:
            self._headers["Authorization"] = f"Bearer {token}"
        self._timeout_s = timeout_s
        self._patience_s = patience_s
        self._connections = Connections(url)

    def close(self):
        self._connections.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def plan(self, problem=None, *, scene=None, start=None, goals=None, attached=None, constraints=None,
             start_velocity=None, end_velocity=None, trajectory=None, trace=False, clearance=False, remember=True, **settings):
        """Plans a Problem, or from `start` to one of `goals` in `scene`.

        scene: a Scene, a dict with keys of compact files, or the id of an uploaded scene. goals: configurations and
        PoseGoals. attached: a list of attached objects, as in compact files; default: those of the problem's robot.
        constraints: OrientationConstraints that replace the problem's. trajectory: a dict of keywords of
        Plan.trajectory() except `limits`, which may be empty: `answer` then has the trajectory. settings: those of
        mneme.plan() except `isa`, `memory`, `learn_budget`, `remember_after` and those of learning. With `timeout`,
        the call ends within that and half a second, whatever the service does: a late answer is a TimeoutError.
        """
        if problem is None and (start is None or goals is None):
            raise TypeError("plan() takes a problem, or start and goals")
        begin = time.monotonic()
        limit_s = math.inf
        if settings.get("timeout") is not None:
            for name in ("timeout", "improve"):
                _seconds(name, settings.get(name))
            limit_s = settings["timeout"] + (settings.get("improve") or 0) + _GRACE_S
        for sent in (scene, None if problem is None else problem.scene):
            if isinstance(sent, Scene):
                _check_size(sent, begin + limit_s)
        body = {}
        if problem is not None:
            body = {**_members(problem.to_compact_json("")), "robot": problem.robot.name,
                    "joints": problem.robot.joint_names}
        if scene is not None:
            body = {key: body[key] for key in body if key not in _SCENE_KEYS}
            body.update(self._place(scene))
        if start is not None:
            body["start"] = _configuration(start, "start")
        if goals is not None:
            body["goals"] = _goals(goals)
        if attached is not None:
            body["attached"] = list(attached)
        if constraints is not None:
            body["constraints"] = [_constraint(each) for each in constraints]
        for key, velocity in (("start_velocity", start_velocity), ("end_velocity", end_velocity)):
            if velocity is not None:
                body[key] = _numbers(velocity, key).tolist()
        if trajectory is not None:
            if not isinstance(trajectory, dict) or not all(isinstance(key, str) for key in trajectory):
                raise TypeError(f"Client.plan: trajectory={trajectory!r}: expected a dict of keywords of Plan.trajectory(), "
                                "such as {} or {'dt': 0.01}")
            body["trajectory"] = _settings(trajectory)
        body.update(settings=_settings(settings), trace=trace, clearance=clearance, remember=remember)
        answer = self.ask("POST", "/v1/plan", body, timeout_s=begin + limit_s - time.monotonic())
        known = start if problem is None else problem.start
        return RemotePlan(answer, self, 0 if answer.get("path") else self._joint_count(known))

    def inverse_kinematics(self, goals, *, near=None, scene=None, margin=0.0, **settings):
        """Returns free configurations that reach any of the PoseGoals, nearest to `near` (default: zeros) first.

        The result is Solutions, shape (k, joint_count). If k is 0, `message` says why. settings: as for
        mneme.inverse_kinematics().
        """
        body = {"goals": _goals(goals), "margin": float(margin), "settings": _settings(settings),
                **self._place(scene)}
        if near is not None:
            body["near"] = _configuration(near, "near")
        answer = self.ask("POST", "/v1/ik", body)
        found = [solution["q"] for solution in answer["solutions"]]
        solutions = _array(found, 0 if found else self._joint_count(near)).view(Solutions)
        solutions.message = answer.get("message") or ""
        return solutions

    def check(self, configurations, scene=None, margin=0.0):
        """Returns a dict per configuration: "valid", and for invalid ones "contacts" or "message"."""
        body = {"configurations": np.atleast_2d(_numbers(configurations, "configurations")).tolist(),
                "margin": float(margin), **self._place(scene)}
        return self.ask("POST", "/v1/check", body)["states"]

    def put_scene(self, id, scene, frame=None):
        """Uploads a Scene, or a dict with keys of compact files. Returns the names of its obstacles."""
        body = _scene_keys(scene)
        if frame is not None:
            body["frame"] = frame
        return self.ask("PUT", self._scene_path(id), body)["obstacles"]

    def edit_scene(self, id, remove=(), scene=None):
        """Removes obstacles by name, then adds those of `scene`, which replace others of the same names.

        remove: a name, or several.
        """
        body = {"remove": [remove] if isinstance(remove, str) else list(remove)}
        if scene is not None:
            body.update(_scene_keys(scene))
        return self.ask("PATCH", self._scene_path(id), body)["obstacles"]

    def delete_scene(self, id):
        self.ask("DELETE", self._scene_path(id))

    def health(self):
        """Returns a dict with "status", "robot", "joints" and "memory"."""
        return self.ask("GET", "/healthz")

    def _joint_count(self, q):
        """Returns the number of joints of the service's robot: those of `q`, an array that the service took, if given."""
        return len(self.health()["joints"]) if q is None or isinstance(q, (str, dict)) else np.size(q)

    @staticmethod
    def _scene_path(id):
        if not isinstance(id, str):
            raise TypeError(f"id: expected the name of a scene, got {id!r:.80}")
        return "/v1/scenes/" + urllib.parse.quote(id, safe="")

    @staticmethod
    def _place(scene):
        if scene is None:
            return {}
        return {"scene": scene} if isinstance(scene, str) else _scene_keys(scene)

    def ask(self, method, path, body=None, *, timeout_s=None):
        """Sends a request of docs/schema/service.openapi.json and returns its parsed answer.

        timeout_s: seconds for all attempts. Default: the client's for each attempt.
        """
        begin = time.monotonic()
        end = math.inf if timeout_s is None else begin + timeout_s
        data = None if body is None else _text(body)
        while True:
            deadline = min(end, time.monotonic() + self._timeout_s)
            response, text = self._connections.exchange(method, path, data, self._headers, deadline)
            answer = _parsed(response.status, text)
            if response.status < 400:
                return answer
            error = answer["error"]
            retry_after = response.getheader("Retry-After")
            if retry_after is None:
                raise make_error(error["code"], error["message"])
            pause = _pause(retry_after)
            if time.monotonic() + pause > min(end, begin + self._patience_s):
                raise Busy(error["message"], pause)
            time.sleep(pause)
