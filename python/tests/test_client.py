# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""mneme.Client plans what mneme.plan plans, over HTTP and over a Unix socket."""
import contextlib
import gc
import json
import os
import pathlib
import socket
import struct
import subprocess
import threading
import time
import warnings

import numpy as np
import pytest
from conftest import raised

import mneme

PROGRAM = pathlib.Path(os.environ["MNEME_BUILD"]) / "mneme"


@contextlib.contextmanager
def serving(robot, listen, *flags):
    if not PROGRAM.exists():
        pytest.skip("the program was not built")
    if subprocess.run([PROGRAM, "serve", "--help"], capture_output=True).returncode != 0:
        pytest.skip("this mneme was built without a service")
    with subprocess.Popen([PROGRAM, "serve", "--robot", robot, "--listen", listen, *flags],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as service:
        line = service.stdout.readline()
        assert " at " in line, service.communicate()
        try:
            with mneme.Client(line.split(" at ")[1].strip()) as client:
                yield client
        finally:
            service.terminate()
        assert service.wait(timeout=60) == 0


@pytest.fixture(scope="module", params=["tcp", "unix"])
def client(request, tmp_path_factory):
    listen = "127.0.0.1:0" if request.param == "tcp" else f"unix:{tmp_path_factory.mktemp('s')}/socket"
    with serving("planar8", listen, "--longest-body", "1") as client:
        yield client


@pytest.fixture(scope="module")
def problem():
    return mneme.Problem.load(mneme.find_scene("planar/scenario1.yaml"))


def test_a_trajectory_over_http_is_that_of_this_process(client, problem):
    velocity = np.zeros(problem.robot.joint_count)
    velocity[0] = -0.1
    timing = {"dt": 0.05, "jerk_limit": 20}
    settings = {"seed": 5, "max_iterations": 100000, "sampler": "uniform"}
    remote = client.plan(problem, start_velocity=velocity, trajectory=timing, **settings)
    local = mneme.plan(problem.with_start(problem.start, velocity), trajectory=timing, **settings).trajectory()
    answer = remote.answer["trajectory"]
    np.testing.assert_allclose(answer["positions"], local.positions, atol=1e-12)
    np.testing.assert_allclose(answer["velocities"][0], velocity, atol=1e-6)


def test_a_trajectory_that_is_no_dict_is_refused(client, problem):
    with pytest.raises(TypeError, match="Client.plan: trajectory=True: expected a dict of keywords"):
        client.plan(problem, trajectory=True)


def test_a_client_that_is_dropped_leaves_no_socket_open(client):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ResourceWarning)
        dropped = mneme.Client(client._connections._url)
        dropped.health()
        del dropped
        gc.collect()
    assert not caught


def test_a_plan_is_that_of_this_process(client, problem):
    settings = {"seed": 5, "max_iterations": 100000, "sampler": "uniform"}
    remote = client.plan(problem, trace=True, clearance=True, **settings)
    local = mneme.plan(problem, **settings)
    assert remote.is_solved and remote.status == "solved" and remote.message == ""
    assert np.array_equal(remote.path, local.path)
    for name in ("iterations", "path_length", "planner", "sampler", "seed", "remembered"):
        assert getattr(remote, name) == getattr(local, name)
    assert remote.remembered is False and mneme.RemotePlan({"remembered": "queued"}, client).remembered is True
    assert json.loads(remote.to_json())["least_clearance"] > 0
    assert json.loads(remote.to_trace())["format"] == "mneme-trace"
    with pytest.raises(AttributeError):
        remote.nothing
    with pytest.raises(ValueError):
        client.plan(problem).to_trace()


def test_scenes_are_kept_and_edited(client, problem):
    names = client.put_scene("cell", problem.scene)
    assert len(names) == len(problem.scene)
    inside = client.plan(start=problem.start, goals=problem.goals, scene="cell", seed=2)
    assert np.array_equal(inside.path, client.plan(problem, seed=2).path)
    more = mneme.Scene()
    more.add_sphere("new", [20, 0, 0], 1)
    assert client.edit_scene("cell", remove=[names[0]], scene=more) == [*names[1:], "new"]
    client.delete_scene("cell")
    with pytest.raises(mneme.Error) as refused:
        client.plan(start=problem.start, goals=problem.goals, scene="cell")
    assert refused.value.code == "invalid" and "there is no scene" in str(refused.value)


def test_a_scene_may_be_a_dict(client, problem):
    scene = {"circles": [[6, 0, 1]]}
    plan = client.plan(scene=scene, start=np.zeros(8), goals=problem.start)
    assert plan.status == "invalid_start" and "circle" in plan.message


def test_numbers_that_are_not_finite_are_named(client, problem):
    with pytest.raises(mneme.Error, match="^start: expected finite numbers"):
        client.plan(problem, start=np.full(problem.robot.joint_count, np.nan))


def test_checks_and_health(client):
    scene = mneme.Scene.from_circles([[4, 0, 0.5]])
    free, touching = client.check([[1.5] + [0] * 7, [0] * 8], scene)
    assert free["valid"] and touching["contacts"][0]["other"] == "circle_1"
    assert client.health()["robot"] == "planar8"


def test_what_is_wrong_is_said(client, problem):
    with pytest.raises(mneme.Error, match="lamda"):
        client.plan(problem, lamda=1)
    with pytest.raises(TypeError):
        client.plan()
    with pytest.raises(ValueError, match="expected http"):
        mneme.Client("127.0.0.1:1")
    hopeless = client.plan(problem, max_iterations=1)
    assert not hopeless.is_solved and hopeless.message and len(hopeless.path) == 0


def test_arguments_are_checked_as_those_of_this_process(client, problem):
    for start in ([True] * 8, ["1"] * 8, [1j] * 8, [[0], [0, 1]]):
        with pytest.raises(TypeError, match="^start: expected an array of real numbers, got "):
            client.plan(problem, start=start)
    with pytest.raises(TypeError, match=r"^attached: <object object at .* is no number, text, list, dict or array"):
        client.plan(problem, attached=[{"name": object()}])
    with pytest.raises(TypeError, match="^scene: expected a Scene or a dict with keys of compact files, got None"):
        client.put_scene("x", None)
    with pytest.raises(TypeError, match="^id: expected the name of a scene, got 3"):
        client.put_scene(3, problem.scene)
    with pytest.raises(TypeError, match="Client.plan: trajectory={1: 2}: expected a dict of keywords"):
        client.plan(problem, trajectory={1: 2})
    ball = {"name": "ball", "type": "sphere", "p": np.array([20, 0, 0]), "radius": np.float32(1)}
    assert client.put_scene("arrays", {"obstacles": [ball]}) == ["ball"]
    assert client.edit_scene("arrays", remove="ball") == []
    client.delete_scene("arrays")


def test_a_plan_without_a_path_has_what_a_plan_has(client, problem):
    plan = client.plan(problem, max_iterations=1)
    assert plan.path.shape == (0, 8) and not plan.is_solved
    assert plan.preparation_time_s >= 0 and (plan.replayed, plan.replay, plan.remember_failure) == (0, "", "")


def test_times_are_numbers(client, problem):
    for wrong in (-5, float("nan")):
        with pytest.raises(mneme.Error, match=f"Client.plan: timeout={wrong} is out of range: expected 0 or more"):
            client.plan(problem, timeout=wrong)
    with pytest.raises(TypeError, match="Client.plan: timeout='x' is not a number of seconds"):
        client.plan(problem, timeout="x")


def test_inverse_kinematics_is_that_of_this_process(client, problem):
    robot = problem.robot
    goal = mneme.PoseGoal("link_8", [9, 3, 0], position_tolerance=[0.1, 0.1, 0])
    remote = client.inverse_kinematics(goal, near=problem.start, scene=problem.scene, seed=4, ik_solutions=3)
    local = mneme.inverse_kinematics(robot, [goal], near=problem.start, scene=problem.scene, seed=4, ik_solutions=3)
    assert len(local) >= 3 and np.array_equal(remote, local)
    none = client.inverse_kinematics([mneme.PoseGoal("link_8", [90, 0, 0])])
    assert none.shape == (0, 8) and "out of reach of link 'link_8' by" in none.message and local.message == ""


def test_goals_may_be_poses(client, problem):
    goal = mneme.PoseGoal("link_8", [9, 3, 0], position_tolerance=0.5)
    remote = client.plan(start=problem.start, goals=[goal], scene=problem.scene, seed=3)
    posed = mneme.Problem(problem.robot, problem.scene, problem.start, pose_goals=[goal])
    assert np.array_equal(remote.path, mneme.plan(posed, seed=3, sampler="uniform").path)
    assert np.array_equal(remote.path, client.plan(posed, seed=3).path)
    assert client.plan(problem, goals=[goal, problem.goals[0]]).is_solved


def test_what_the_robot_carries_goes_along(client, problem):
    rod = mneme.Scene()
    rod.add_sphere("rod", [1, 0, 0], 0.3)
    scene = mneme.Scene.from_circles([[4, 4, 1.5], [-2, 4.5, 1]])
    start, goal = [0.1] * 8, [2.5] + [0.1] * 7
    carrying = mneme.Problem(problem.robot.attach("link_8", rod), scene, start, goal)
    settings = {"seed": 2, "sampler": "uniform", "max_iterations": 20000, "timeout": 50}
    local = mneme.plan(carrying, **settings)
    assert local.is_solved and np.array_equal(client.plan(carrying, **settings).path, local.path)
    named = [{"name": "rod", "link": "link_8", "type": "sphere", "p": [1, 0, 0], "radius": 0.3}]
    given = client.plan(start=start, goals=goal, scene=scene, attached=named, **settings)
    assert np.array_equal(given.path, local.path)
    named[0]["radius"] = 8
    assert client.plan(start=start, goals=goal, scene=scene, attached=named, **settings).status == "invalid_start"


def test_constraints_go_along(client, problem):
    def within(angle):
        return [mneme.OrientationConstraint("link_1", angle, axis=[1, 0, 0], up=[1, 0, 0])]

    assert client.plan(problem, constraints=within(3.14)).is_solved
    assert client.plan(problem, constraints=within(0.01)).status == "invalid_start"
    assert client.plan(problem.with_constraints(within(0.01))).status == "invalid_start"


def test_points_travel_as_numbers(client):
    cloud = mneme.Scene()
    cloud.add_points("cloud", [[4, 0.1, 0], [4, -0.1, 0]], radius=0.15)
    stretched, turned = client.check([[0] * 8, [1.5] + [0] * 7], cloud)
    assert not stretched["valid"] and stretched["contacts"][0]["other"] == "cloud" and turned["valid"]


def test_threads_of_a_plan_are_those_of_this_process(client, problem):
    settings = {"seed": 6, "threads": 2, "sampler": "uniform", "max_iterations": 100000}
    try:
        remote = client.plan(problem, **settings)
    except mneme.Error as refused:
        assert os.cpu_count() == 1 and "all threads" in str(refused)
        return
    assert np.array_equal(remote.path, mneme.plan(problem, **settings).path)


def test_a_problem_of_another_robot_is_refused(client, problem):
    other = mneme.Robot.planar([1.0] * 8, name="other")
    with pytest.raises(mneme.Error, match="expected planar8, the robot of this service"):
        client.plan(mneme.Problem(other, problem.scene, problem.start, problem.goals))


def test_a_body_that_is_too_long_is_refused_in_words(client):
    scene = {"circles": [[20, 0, 0.123456789]] * 200000}
    client.health()
    for _ in range(3):
        with pytest.raises(mneme.Error, match="body of at most 1048576 bytes"):
            client.put_scene("cell", scene)
    assert client.health()["status"] == "ok"


class Scripted:
    """A service that does to each connection in turn what a function of `script` says."""

    def __init__(self, *script):
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        self.requests = 0
        self.closed = threading.Semaphore(0)  # one for each connection
        self._thread = threading.Thread(target=self._run, args=[script])
        self._thread.start()

    def _run(self, script):
        for serve in script:
            connection, _ = self._listener.accept()
            with connection:
                serve(self, connection)
            self.closed.release()

    def hear(self, connection):
        """The head of a request, which has no body."""
        text = b""
        while b"\r\n\r\n" not in text:
            part = connection.recv(4096)
            if not part:
                return
            text += part
        self.requests += 1

    def answer(self, connection, body=b'{"status": "ok"}', head="200 OK"):
        self.hear(connection)
        connection.sendall(f"HTTP/1.1 {head}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)

    def say_nothing(self, connection):
        self.hear(connection)
        connection.recv(1)

    def never_answer(self, connection):
        while connection.recv(4096):
            pass

    def answer_slowly(self, connection):
        self.hear(connection)
        with contextlib.suppress(OSError):
            for byte in b"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n" + b" " * 100:
                connection.sendall(bytes([byte]))
                time.sleep(0.05)

    def answer_once_and_close(self, connection):
        self.answer(connection)

    def answer_once_and_reset(self, connection):
        self.answer(connection)
        self.hear(connection)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))

    def refuse(self, connection):
        self.answer(connection, b'{"error": {"code": "busy", "message": "too many"}}',
                    "503 Service Unavailable\r\nRetry-After: 1")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._thread.join(60)
        self._listener.close()
        assert not self._thread.is_alive()


@pytest.mark.parametrize("received", [
    b"HTTP/1.1 200 OK\r\nContent-Length: 18\r\n\r\n<html>proxy</html>",
    b"HTTP/1.1 502 Bad Gateway\r\nContent-Length: 18\r\n\r\n<html>proxy</html>",
    b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]",
    b"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n{}",
    b"HTTP/1.1 200 OK\r\nContent-Length: 99999999999999\r\n\r\n{}",
    b"HTTP/1.1 200 OK\r\nContent-Length: 50000\r\n\r\n" + b"[" * 50000,
    b"HTTP/1.1 200 OK\r\nA: " + b"b" * 70000 + b"\r\n\r\n{}",
    b"HTTP/1.1 400 Bad\r\nContent-Length: 13\r\n\r\n{\"error\":\"x\"}",
    b"SSH-2.0-OpenSSH\r\n"])
def test_an_answer_that_is_not_of_the_service_is_an_error(received):
    def send(service, connection):
        service.hear(connection)
        connection.sendall(received)

    with Scripted(send) as service, mneme.Client(service.url) as client:
        code, message = raised(client.health)
    assert code == "io" and "expected an answer of `mneme serve`, got " in message


def test_an_answer_without_its_keys_is_an_error(problem):
    with Scripted(Scripted.answer) as service, mneme.Client(service.url) as client:
        plan = client.plan(problem)
        code, message = raised(lambda: plan.path)
    assert code == "io" and "'path'" in message


def test_a_time_to_retry_that_is_a_date_is_a_second():
    def refuse(service, connection):
        service.answer(connection, b'{"error": {"code": "busy", "message": "too many"}}',
                       "503 Service Unavailable\r\nRetry-After: Wed, 21 Oct 2026 07:28:00 GMT")

    with Scripted(refuse) as service, mneme.Client(service.url, patience_s=0) as client:
        with pytest.raises(mneme.Busy) as busy:
            client.health()
    assert busy.value.retry_after_s == 1


def test_an_address_that_is_no_text_is_refused():
    with pytest.raises(TypeError, match="url is 5, expected a text"):
        mneme.Client(5)


@pytest.mark.parametrize("url", ["http://127.0.0.1:1", "unix:/nonexistent/mneme.sock"])
def test_a_service_that_is_not_there_is_named(url):
    with mneme.Client(url) as client:
        code, message = raised(client.health)
    assert code == "io" and message.startswith(f"{url}: cannot reach the service: ")


def test_a_client_goes_on_after_a_timeout():
    with Scripted(Scripted.say_nothing, Scripted.answer) as service, mneme.Client(service.url, timeout_s=2) as client:
        with pytest.raises(TimeoutError):
            client.health()
        assert client.health() == {"status": "ok"}


@pytest.mark.parametrize("serve", [Scripted.never_answer, Scripted.answer_slowly])
def test_a_plan_with_a_time_limit_ends_whatever_the_service_does(serve, problem):
    with Scripted(serve) as service, mneme.Client(service.url) as client:
        begin = time.monotonic()
        with pytest.raises(TimeoutError):
            client.plan(problem, timeout=0.3)
        assert time.monotonic() - begin < 0.8


def test_threads_that_share_a_client_get_their_own_answers(client, problem):
    def check_plans(turn, wrong):
        for seed in range(1, 21):
            goal = np.array(problem.goals[0])
            goal[7] = turn
            plan = client.plan(problem.with_goal(goal), seed=seed)
            if not plan.is_solved or np.abs(problem.robot.difference(plan.path[-1], goal)).max() > 1e-6:
                wrong.append((turn, seed))

    wrong = []
    threads = [threading.Thread(target=check_plans, args=(0.1 * k, wrong)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_a_forked_process_does_not_use_the_connections_of_its_parent(client):
    def count_answers(count):
        return [len(client.check([[0.0] * 8] * count)) for _ in range(50)]

    assert count_answers(1) == [1] * 50
    child = os.fork()
    if child == 0:
        os._exit(0 if count_answers(3) == [3] * 50 else 1)
    assert count_answers(2) == [2] * 50
    assert os.waitpid(child, 0)[1] == 0


def test_a_connection_that_was_idle_for_too_long_is_made_anew():
    with Scripted(Scripted.answer_once_and_close, Scripted.answer) as service, mneme.Client(service.url) as client:
        assert client.health() == {"status": "ok"}
        assert service.closed.acquire(timeout=60)
        assert client.health() == {"status": "ok"}
        assert service.requests == 2


def test_a_request_that_was_taken_is_not_sent_again():
    with Scripted(Scripted.answer_once_and_reset) as service, mneme.Client(service.url) as client:
        assert client.health() == {"status": "ok"}
        code, message = raised(client.health)
        assert code == "io" and "closed the connection without an answer" in message
        assert service.requests == 2


@pytest.mark.parametrize("reset", [False, True])
def test_a_peer_that_closes_at_once_is_an_error(reset, problem):
    def close(service, connection):
        if reset:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))

    with Scripted(close) as service, mneme.Client(service.url) as client:
        code, message = raised(lambda: client.plan(problem))
    assert code == "io" and message.startswith(f"{service.url}: ")


def test_a_scene_that_cannot_be_written_within_the_time_limit_is_refused_before(problem):
    scene = mneme.Scene()
    scene.add_points("cloud", np.full((500000, 3), 20.5), radius=0.01)
    with Scripted() as service, mneme.Client(service.url) as client:
        with pytest.raises(TimeoutError, match="the 500000 points.* put_scene"):
            client.plan(problem, scene=scene, timeout=0.5)


def test_a_body_has_the_values_of_compact_files(problem):
    for compact in (problem.to_compact_json("robot"), problem.scene.to_compact_json()):
        wanted = json.loads(compact)["problems"][0]
        assert json.loads(mneme._client._text(mneme._client._members(compact))) == wanted


def test_a_service_that_stays_busy_is_said_to_be():
    with Scripted(Scripted.refuse) as service, mneme.Client(service.url, patience_s=0) as client:
        with pytest.raises(mneme.Busy, match="too many") as busy:
            client.health()
        assert busy.value.retry_after_s == 1
