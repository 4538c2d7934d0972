#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Attacks `mneme serve` with hostile clients while honest ones plan.

    tests/soak/service_attack.py build/release/mneme --seconds 600 --kills 200

Prints the honest clients' latencies without and with the attack, the memory of the service, and how
long it took to end on SIGTERM at random moments of the attack. Fails if an honest request is not
answered rightly, if the memory grows without bound, or if a SIGTERM takes longer than a second.
"""
import argparse
import json
import multiprocessing
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

START = [0.0] * 8
CIRCLES = [[5, -2.2, 1.2], [5.5, -4, 1.2], [20, 0, 1]]


def head(method, path, length, more=""):
    return (f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
            f"{more}Content-Length: {length}\r\n\r\n").encode()


def request(method, path, body):
    text = json.dumps(body).encode()
    return head(method, path, len(text)) + text


def read_answer(connection):
    """Status and body; raises ConnectionError if the answer is torn."""
    data = b""
    while b"\r\n\r\n" not in data:
        more = connection.recv(65536)
        if not more:
            raise ConnectionError("closed within a head")
        data += more
    top, body = data.split(b"\r\n\r\n", 1)
    fields = dict(line.split(b": ", 1) for line in top.split(b"\r\n")[1:])
    length = int(fields[b"Content-Length"])
    while len(body) < length:
        more = connection.recv(65536)
        if not more:
            raise ConnectionError("closed within a body")
        body += more
    return int(top.split()[1]), body


def honest(port, seed, until, results):
    """Plans one after the other; sends (latency, fault) of each to `results`."""
    rng = random.Random(seed)
    connection = None
    while time.time() < until:
        body = {"circles": CIRCLES, "start": START, "goal": [rng.uniform(0.3, 1), rng.uniform(-0.3, 0.3)] + [0] * 6,
                "settings": {"timeout": 2, "seed": rng.randrange(1 << 30)}}
        begin, fault = time.time(), ""
        try:
            if connection is None:
                connection = socket.create_connection(("127.0.0.1", port), timeout=20)
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection.sendall(request("POST", "/v1/plan", body))
            status, text = read_answer(connection)
            if status == 503:
                fault = "busy"
            elif status != 200 or not json.loads(text)["solved"]:
                fault = text[:200].decode(errors="replace")
        except (OSError, ConnectionError) as error:
            fault, connection = f"{type(error).__name__}: {error}", None
        results.put((time.time() - begin, fault))
        time.sleep(0.02)


class Attacks:
    """Each method is one hostile visit over a fresh connection."""

    def __init__(self, rng):
        self.rng = rng

    def attached(self):
        count = self.rng.choice([10, 250, 500, 3000])
        kind = self.rng.choice([{"type": "box", "p": [0.1, 0, 0], "size": [3, 3, 3]},
                                {"type": "box", "p": [0.1, 0, 0], "size": [29, 29, 29]},
                                {"type": "sphere", "p": [0.1, 0, 0], "radius": 0.001}])
        bodies = [dict(name=f"t{i}", link=f"link_{1 + i % 8}", **kind) for i in range(count)]
        return request("POST", "/v1/plan", {"start": START, "goal": [0.1] + START[1:], "attached": bodies,
                                            "settings": {"timeout": 60}})

    def hopeless(self):
        wall = [[2.5, 0, 1.2], [-2.5, 0, 1.2], [0, 2.5, 1.2], [0, -2.5, 1.2]]
        return request("POST", "/v1/plan", {"circles": wall, "start": START, "goal": [3.1] + START[1:],
                                            "settings": {"timeout": 60, "improve": 60}})

    def many_goals(self):
        goals = [{"link": "link_8", "position": [self.rng.uniform(-9, 9), self.rng.uniform(-9, 9), 0],
                  "position_tolerance": [0.01, 0.01, 0]} for _ in range(4000)]
        return request("POST", "/v1/plan", {"start": START, "goals": goals, "settings": {"timeout": 5}})

    def allowed(self):
        pairs = [[f"a{i}", f"link_{1 + i % 8}"] for i in range(40000)]
        return request("POST", "/v1/plan", {"circles": CIRCLES, "allow": pairs, "start": START,
                                            "goal": [0.1] + START[1:]})

    def scene(self):
        circles = [[self.rng.uniform(10, 20), self.rng.uniform(-9, 9), 0.1] for _ in range(9000)]
        return request("PUT", f"/v1/scenes/s{self.rng.randrange(200)}", {"circles": circles})

    def mesh(self):
        corners = [[self.rng.choice([0, 1, 1e308, -1e30, 20]) for _ in range(3)] for _ in range(3000)]
        body = {"name": "m", "type": "mesh", "p": [20, 0, 0], "triangles": [n for c in corners for n in c * 3]}
        return request("POST", "/v1/plan", {"obstacles": [body], "start": START, "goal": [0.1] + START[1:]})

    def slivers(self):
        numbers = [n for i in range(5000) for n in (0, 0, 0, 1, 0, 0, 0.5, 1e-12 * i, 1e-300 * (i % 2))]
        body = {"name": "m", "type": "mesh", "link": "link_8", "triangles": numbers}
        return request("POST", "/v1/plan", {"attached": [body], "start": START, "goal": [0.1] + START[1:]})

    def deep(self):
        depth = self.rng.choice([10, 1000, 200000])
        text = b'{"circles":' + b"[" * depth + b"]" * depth + b"}"
        return head("POST", "/v1/plan", len(text)) + text

    def numbers(self):
        text = b'{"start":[1e999,-1e308,NaN,0,0,0,0,0],"goal":[' + b"9" * 100000 + b"]}"
        return head("POST", "/v1/plan", len(text)) + text

    def noise(self):
        return self.rng.randbytes(self.rng.randrange(1, 5000))

    def framing(self):
        more = self.rng.choice(["Transfer-Encoding: chunked\r\n", "Content-Length: %32\r\n", "X: a\rb\r\n",
                                " folded: yes\r\n", "Expect: 100-continue\r\n", "X: " + "y" * 100000 + "\r\n"])
        return head("PUT", "/v1/scenes/x", 2, more) + b"{}"

    def endless_head(self):
        return b"GET / HTTP/1.1\r\n" + b"".join(b"A%d: b\r\n" % i for i in range(5000))

    def false_length(self):
        return head("POST", "/v1/plan", self.rng.choice([10**18, 16 << 20, -1])) + b"{" * 1000

    def pipelined(self):
        return request("GET", "/healthz", {}) * 200


def hostile(port, seed, until):
    rng = random.Random(seed)
    attacks = Attacks(rng)
    names = [name for name in dir(Attacks) if not name.startswith("_")]
    while time.time() < until:
        data = getattr(attacks, rng.choice(names))()
        try:
            connection = socket.create_connection(("127.0.0.1", port), timeout=rng.choice([0.05, 1, 5]))
            manner = rng.randrange(5)
            if manner == 0:    # torn
                connection.sendall(data[:rng.randrange(1, len(data) + 1)])
            elif manner == 1:  # byte for byte
                for i in range(min(len(data), 60)):
                    connection.sendall(data[i:i + 1])
                    time.sleep(0.02)
            else:
                connection.sendall(data)
            if manner == 4:    # reset while it is answered
                time.sleep(rng.uniform(0, 0.1))
                connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            elif rng.randrange(3) > 0:
                while connection.recv(65536):
                    pass
            connection.close()
        except OSError:
            pass


class Service:
    def __init__(self, program, *flags):
        self.process = subprocess.Popen([program, "serve", "--robot", "planar8", "--listen", "127.0.0.1:0", *flags],
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.port = int(self.process.stdout.readline().rsplit(":", 1)[1])

    def memory_mib(self):
        with open(f"/proc/{self.process.pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    def end(self):
        """Seconds from SIGTERM to the end of the process."""
        begin = time.time()
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        return time.time() - begin


def start_all(function, arguments):
    processes = [multiprocessing.Process(target=function, args=a, daemon=True) for a in arguments]
    for process in processes:
        process.start()
    return processes


def hostile_threads(port, seed, until, count):
    os.nice(19)  # attackers have machines of their own
    threads = [threading.Thread(target=hostile, args=(port, seed * 1000 + i, until), daemon=True) for i in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def attack(port, clients, seed, until):
    """Hostile clients in two processes of low priority: they attack the service, not the machine."""
    return start_all(hostile_threads, [(port, seed + i, until, (clients + i) // 2) for i in range(2)])


def measure(service, options, seconds, is_attacked):
    """Latencies, faults and largest memory of the honest clients' requests."""
    until = time.time() + seconds
    results = multiprocessing.Queue()
    clients = start_all(honest, [(service.port, i, until, results) for i in range(options.honest)])
    enemies = attack(service.port, options.hostile, options.seed, until) if is_attacked else []
    latencies, faults, most = [], [], 0
    while any(client.is_alive() for client in clients) or not results.empty():
        most = max(most, service.memory_mib())
        try:
            latency, fault = results.get(timeout=0.2)
        except Exception:  # of queue.Empty: nothing came
            continue
        latencies.append(latency)
        if fault:
            faults.append(fault)
    for enemy in enemies:
        enemy.join(timeout=10)
        enemy.kill()
    latencies.sort()
    return latencies, faults, most


def print_row(name, latencies, faults, most):
    def share(p):
        return 1e3 * latencies[min(len(latencies) - 1, int(p * len(latencies)))]
    busy = sum(fault == "busy" for fault in faults)
    print(f"{name:8} {len(latencies):8} {share(0.5):8.1f} {share(0.99):8.1f} {1e3 * latencies[-1]:8.1f} "
          f"{busy:6} {len(faults) - busy:6} {most:8.0f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seconds", type=float, default=60, help="length of the attack")
    parser.add_argument("--hostile", type=int, default=50, help="hostile clients")
    parser.add_argument("--honest", type=int, default=4, help="honest clients")
    parser.add_argument("--kills", type=int, default=20, help="services ended by SIGTERM under attack")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most-mib", type=float, default=2048, help="memory that counts as unbounded")
    options = parser.parse_args()

    wrong = []
    service = Service(options.program)
    print(f"{'':8} {'requests':>8} {'p50 ms':>8} {'p99 ms':>8} {'max ms':>8} {'busy':>6} {'wrong':>6} {'MiB':>8}")
    for name, seconds in (("quiet", min(20, options.seconds)), ("attacked", options.seconds)):
        latencies, faults, most = measure(service, options, seconds, name == "attacked")
        print_row(name, latencies, faults, most)
        wrong += [fault for fault in faults if fault != "busy"]
        if most > options.most_mib:
            wrong.append(f"{most:.0f} MiB")
    if service.process.poll() is not None:
        wrong.append(f"the service ended with {service.process.returncode}")
    ends = [service.end()]
    rng = random.Random(options.seed)
    for i in range(options.kills):
        service = Service(options.program)
        enemies = attack(service.port, options.hostile, options.seed + 100 + i, time.time() + 20)
        time.sleep(rng.uniform(0.3, 2))
        ends.append(service.end())
        for enemy in enemies:
            enemy.kill()
    print(f"SIGTERM: {len(ends)} times, longest {max(ends):.2f} s")
    wrong += [f"SIGTERM took {end:.2f} s" for end in ends if end > 1]
    for fault in wrong[:20]:
        print("  WRONG:", fault)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
