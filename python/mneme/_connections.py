# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""HTTP connections that threads share, with a deadline for each request."""
import http.client
import io
import os
import socket
import time
import urllib.parse

from ._mneme import Error


_MOST_ANSWER_BYTES = 1 << 30


def make_error(code, message):
    """Returns a mneme.Error with this code."""
    error = Error(message)
    error.code = code
    return error


class _TimedSocket:
    """A socket for http.client whose operations all end at `deadline`, however slowly the service sends."""

    def __init__(self, opened, deadline):
        self.socket = opened
        self.deadline = deadline

    def arm(self):
        self.socket.settimeout(_time_left(self.deadline))

    def sendall(self, data):
        self.arm()
        self.socket.sendall(data)

    def makefile(self, _mode):
        return io.BufferedReader(_Reader(self))

    def close(self):
        self.socket.close()


class _Reader(io.RawIOBase):
    def __init__(self, timed):
        self._timed = timed
        self._file = timed.socket.makefile("rb", buffering=0)

    def readable(self):
        return True

    def readinto(self, buffer):
        self._timed.arm()
        return self._file.readinto(buffer)

    def close(self):
        self._file.close()
        super().close()


def _time_left(deadline):
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("timed out")
    return left


class _Connection:
    def __init__(self, url):
        if not isinstance(url, str):
            raise TypeError(f"url is {url!r}, expected a text such as http://HOST:PORT or unix:PATH")
        self._url = url
        self._path = url[len("unix:"):] if url.startswith("unix:") else None
        parts = urllib.parse.urlsplit(url if self._path is None else "http://localhost")
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ValueError(f"'{url}': expected http://HOST:PORT or unix:PATH")
        kind = http.client.HTTPSConnection if parts.scheme == "https" else http.client.HTTPConnection
        self._http = kind(parts.hostname, parts.port)

    @property
    def is_open(self):
        return self._http.sock is not None

    def close(self):
        self._http.close()

    def open(self, deadline):
        self._http.timeout = _time_left(deadline)
        if self._path is None:
            self._http.connect()
        else:
            self._http.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self._http.sock.settimeout(self._http.timeout)
            self._http.sock.connect(self._path)
        self._http.sock = _TimedSocket(self._http.sock, deadline)

    def exchange(self, method, path, data, headers, deadline):
        self._http.sock.deadline = deadline
        try:
            self._http.request(method, path, data, headers)
        except (BrokenPipeError, ConnectionResetError):
            pass  # The service refused the body before it was sent completely: read its answer.
        try:
            response = self._http.getresponse()
            if (response.length or 0) > _MOST_ANSWER_BYTES:
                raise OverflowError(f"an answer of {response.length} bytes")
            return response, response.read()
        except http.client.RemoteDisconnected:
            raise
        except (http.client.HTTPException, ValueError, OverflowError, MemoryError) as failure:
            raise make_error("io", f"{self._url}: expected an answer of `mneme serve`, got {failure!r:.200}") from failure


class Connections:
    """Connections to the service at `url`. Each request has one of its own, so threads get their own answers."""

    def __init__(self, url):
        self._url = url
        self._idle = []
        self._idle.append(_Connection(url))
        self._process = os.getpid()

    def close(self):
        idle, self._idle = self._idle, []
        for connection in idle:
            connection.close()

    def __del__(self):
        self.close()

    def exchange(self, method, path, data, headers, deadline):
        """Returns the response and its body. Raises TimeoutError at `deadline`, a time.monotonic()."""
        connection = self._take()
        was_open = connection.is_open
        try:
            try:
                answer = self._try(connection, method, path, data, headers, deadline)
            except (http.client.RemoteDisconnected, BrokenPipeError):
                if not was_open:
                    raise
                # The service has closed this connection, which was idle for too long, before it took the request.
                connection.close()
                answer = self._try(connection, method, path, data, headers, deadline)
        except ConnectionError as failure:
            connection.close()
            raise make_error("io", f"{self._url}: the service closed the connection without an answer: {failure}") from failure
        except BaseException:
            # A late answer must not be taken for the answer of the next request.
            connection.close()
            raise
        self._idle.append(connection)
        return answer

    def _take(self):
        if self._process != os.getpid():
            # Connections that a forked process inherits belong to its parent, which keeps its own descriptors.
            self.close()
            self._process = os.getpid()
        try:
            return self._idle.pop()
        except IndexError:
            return _Connection(self._url)

    def _try(self, connection, method, path, data, headers, deadline):
        if not connection.is_open:
            try:
                connection.open(deadline)
            except OSError as failure:
                raise make_error("io", f"{self._url}: cannot reach the service: {failure}") from failure
        return connection.exchange(method, path, data, headers, deadline)
