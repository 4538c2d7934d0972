#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stops, slows, kills and restarts PostgreSQL while clients of `mneme serve` plan and remember.

    tests/soak/postgres_faults.py build/release/mneme --faults 20

Fails if a plan takes longer than its time limit and 50 ms, if `/healthz` does not say `degraded`
within 2 s of a server that hangs, if a row that the service counts as stored is not in the database
at the end, or if SIGTERM takes longer than a second. Needs Debian's package of PostgreSQL.
"""
import argparse
import atexit
import glob
import http.client
import json
import os
import pwd
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

LIMIT = 1.0  # seconds of each plan
SPARE = 0.05


class Postgres:
    """A server of its own in a temporary directory. As root it runs as the user postgres."""

    def __init__(self):
        self.programs = sorted(glob.glob("/usr/lib/postgresql/*/bin"))[-1]
        self.folder = tempfile.mkdtemp(prefix="mneme-pg-")
        self.user = pwd.getpwnam("postgres") if os.geteuid() == 0 else None
        if self.user:
            os.chown(self.folder, self.user.pw_uid, self.user.pw_gid)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        atexit.register(self.close)
        self.run("initdb", "-D", self.data(), "-U", "mneme", "-A", "trust", "-N")
        self.start()

    def data(self):
        return os.path.join(self.folder, "data")

    def run(self, program, *arguments):
        def leave_root():
            os.setgid(self.user.pw_gid)
            os.setuid(self.user.pw_uid)
        return subprocess.run([f"{self.programs}/{program}", *arguments], cwd="/", stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, preexec_fn=leave_root if self.user else None).returncode

    def start(self):
        while self.run("pg_ctl", "-D", self.data(), "-w", "-l", os.path.join(self.folder, "log"), "-o",
                       f"-c port={self.port} -c listen_addresses=127.0.0.1 -k {self.folder}", "start") != 0:
            time.sleep(0.1)

    def restart(self):
        self.run("pg_ctl", "-D", self.data(), "-m", "immediate", "-w", "stop")
        self.start()

    def signal(self, number):
        with open(os.path.join(self.data(), "postmaster.pid")) as file:
            parent = int(file.readline())
        children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(parent)], capture_output=True, text=True).stdout
        for process in [parent, *map(int, children.split())]:
            os.kill(process, number)

    def close(self):
        self.run("pg_ctl", "-D", self.data(), "-m", "immediate", "-w", "stop")
        shutil.rmtree(self.folder, ignore_errors=True)


class Line:
    """A TCP line to the server, which can be slowed to one byte a second."""

    def __init__(self, port):
        self.port, self.is_slow = port, threading.Event()
        self.listener = socket.create_server(("127.0.0.1", 0))
        threading.Thread(target=self.accept, daemon=True).start()

    def address(self):
        return self.listener.getsockname()[1]

    def accept(self):
        while True:
            near, _ = self.listener.accept()
            try:
                far = socket.create_connection(("127.0.0.1", self.port))
            except OSError:
                near.close()
                continue
            for a, b in ((near, far), (far, near)):
                threading.Thread(target=self.carry, args=(a, b), daemon=True).start()

    def carry(self, source, sink):
        try:
            while data := source.recv(65536):
                while data:
                    size = 1 if self.is_slow.is_set() else len(data)
                    sink.sendall(data[:size])
                    data = data[size:]
                    if data:
                        time.sleep(1)
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


def ask(port, method, path, body=None, timeout=30):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout)
    connection.request(method, path, None if body is None else json.dumps(body), {"Content-Type": "application/json"})
    text = connection.getresponse().read().decode()
    connection.close()
    return text


class Load:
    """Clients that plan one problem after the other, and what was wrong."""

    def __init__(self, port, count):
        self.port, self.is_over, self.latencies, self.wrong = port, threading.Event(), [], []
        self.threads = [threading.Thread(target=self.run, args=(i,), daemon=True) for i in range(count)]
        for thread in self.threads:
            thread.start()

    def run(self, seed):
        rng = random.Random(seed)
        while not self.is_over.is_set():
            circles = [[rng.uniform(4, 7), -rng.uniform(1.5, 3), 1.2], [rng.uniform(4, 7), -rng.uniform(3, 5), 1.2]]
            body = {"circles": circles, "start": [0] * 8, "goal": [rng.uniform(0.3, 1), rng.uniform(-0.5, 0.5)] + [0] * 6,
                    "settings": {"timeout": LIMIT, "seed": rng.randrange(1 << 30), "kind": "paths", "retrieve-after": 0}}
            begin = time.time()
            try:
                answer = json.loads(ask(self.port, "POST", "/v1/plan", body))
                if "status" not in answer:
                    self.wrong.append(str(answer)[:200])
            except OSError as error:
                self.wrong.append(f"{type(error).__name__}: {error}")
            self.latencies.append(time.time() - begin)
            time.sleep(0.02)

    def end(self):
        self.is_over.set()
        for thread in self.threads:
            thread.join()


def seconds_until_degraded(port):
    begin = time.time()
    while time.time() - begin < 5:
        if json.loads(ask(port, "GET", "/healthz"))["status"] == "degraded":
            break
        time.sleep(0.02)
    return time.time() - begin


def inflict(kind, postgres, line, port, wrong):
    """One fault and its end; returns seconds until the service said `degraded`, or None."""
    if kind == "stopped":
        postgres.signal(signal.SIGSTOP)
        took = seconds_until_degraded(port)
        time.sleep(1)
        postgres.signal(signal.SIGCONT)
        if took > 2:
            wrong.append(f"degraded after {took:.2f} s")
        return took
    if kind == "slowed":
        line.is_slow.set()
        time.sleep(3)
        line.is_slow.clear()
    elif kind == "killed":
        postgres.signal(signal.SIGKILL)
        time.sleep(0.5)
        postgres.start()
    else:
        postgres.restart()
    return None


def stored(port):
    found = re.search(r"^mneme_remembered_total (\d+)", ask(port, "GET", "/metrics"), re.M)
    return int(found.group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--faults", type=int, default=20)
    parser.add_argument("--clients", type=int, default=3)
    options = parser.parse_args()
    postgres = Postgres()
    line = Line(postgres.port)
    url = "postgresql://mneme@127.0.0.1:{}/postgres"
    service = subprocess.Popen([options.program, "serve", "--robot", "planar8", "--listen", "127.0.0.1:0", "--db",
                                url.format(line.address()), "--remember-after", "0"], stdout=subprocess.PIPE, text=True)
    port = int(service.stdout.readline().rsplit(":", 1)[1])
    load = Load(port, options.clients)
    wrong, degraded, rng = [], [], random.Random(1)
    for i in range(options.faults):
        time.sleep(rng.uniform(0.5, 1.5))
        took = inflict(("stopped", "slowed", "killed", "restarted")[i % 4], postgres, line, port, wrong)
        degraded += [took] if took is not None else []
    time.sleep(3)
    load.end()
    counted = stored(port)
    begin = time.time()
    service.send_signal(signal.SIGTERM)
    try:
        service.wait(timeout=30)
    except subprocess.TimeoutExpired:
        service.kill()
    end_s = time.time() - begin
    rows = json.loads(subprocess.run([options.program, "db", "info", url.format(postgres.port), "--json"],
                                     capture_output=True, text=True).stdout)["samplers"]
    late = [latency for latency in load.latencies if latency > LIMIT + SPARE]
    print(f"{options.faults} faults, {len(load.latencies)} plans, longest {max(load.latencies):.3f} s, {len(late)} late; "
          f"degraded within {max(degraded, default=0):.2f} s; {counted} rows counted as stored, {rows} in the database; "
          f"SIGTERM {end_s:.2f} s")
    wrong += load.wrong + [f"a plan took {latency:.3f} s" for latency in late]
    wrong += [f"{counted - rows} rows are missing"] if rows < counted else []
    wrong += [f"SIGTERM took {end_s:.2f} s"] if end_s > 1 else []
    for fault in wrong[:20]:
        print("  WRONG:", fault)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
