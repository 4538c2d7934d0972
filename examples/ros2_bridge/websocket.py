# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The client's side of a WebSocket (RFC 6455) that carries text, with the standard library alone."""
import base64
import hashlib
import os
import socket
import struct
import urllib.parse

ACCEPT_KEY = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
MOST_BYTES = 1 << 28


def accept_of(key):
    """The header Sec-WebSocket-Accept that answers `key`."""
    return base64.b64encode(hashlib.sha1((key + ACCEPT_KEY).encode()).digest()).decode()


def frame(opcode, payload, mask=b""):
    """Returns one final frame. A client must mask: `mask` has 4 bytes; a server must not."""
    size = len(payload)
    bit = 0x80 if mask else 0
    if size < 126:
        head = struct.pack("!BB", 0x80 | opcode, bit | size)
    elif size < 1 << 16:
        head = struct.pack("!BBH", 0x80 | opcode, bit | 126, size)
    else:
        head = struct.pack("!BBQ", 0x80 | opcode, bit | 127, size)
    return head + mask + masked(payload, mask)


def masked(payload, mask):
    if not mask:
        return payload
    key = (mask * (len(payload) // 4 + 1))[:len(payload)]
    mixed = int.from_bytes(payload, "big") ^ int.from_bytes(key, "big")
    return mixed.to_bytes(len(payload), "big")


def read_frame(stream):
    """Returns whether the frame is final, its opcode and its payload. Raises ConnectionError at the end."""
    def exactly(count):
        data = stream.read(count)
        if len(data) < count:
            raise ConnectionError("the other side closed the connection")
        return data

    first, second = exactly(2)
    size = second & 0x7F
    if size == 126:
        size = struct.unpack("!H", exactly(2))[0]
    elif size == 127:
        size = struct.unpack("!Q", exactly(8))[0]
    if size > MOST_BYTES:
        raise ConnectionError(f"expected at most {MOST_BYTES} bytes in a frame, got {size}")
    mask = exactly(4) if second & 0x80 else b""
    return bool(first & 0x80), first & 0x0F, masked(exactly(size), mask)


class WebSocket:
    """Not thread-safe, but one thread may send() while another one receives()."""

    def __init__(self, url, timeout_s=10):
        parts = urllib.parse.urlsplit(url)
        if parts.scheme != "ws" or not parts.hostname:
            raise ValueError(f"{url}: expected ws://HOST:PORT")
        address = (parts.hostname, parts.port or 9090)
        self._socket = socket.create_connection(address, timeout_s)
        self._stream = self._socket.makefile("rb")
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall((f"GET {parts.path or '/'} HTTP/1.1\r\nHost: {address[0]}:{address[1]}\r\n"
                              "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                              f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n").encode())
        status = self._stream.readline(4096).decode("latin-1")
        headers = {}
        for line in iter(lambda: self._stream.readline(4096).decode("latin-1").strip(), ""):
            name, _, value = line.partition(":")
            headers[name.lower()] = value.strip()
        if " 101 " not in status or headers.get("sec-websocket-accept") != accept_of(key):
            raise ConnectionError(f"{url}: no WebSocket answers there, but {status.strip() or 'nothing'}")
        self._socket.settimeout(None)

    def send(self, text):
        self._socket.sendall(frame(TEXT, text.encode(), os.urandom(4)))

    def receive(self):
        """Waits for the next text; None once the other side has closed."""
        parts = []
        while True:
            is_final, opcode, payload = read_frame(self._stream)
            if opcode == CLOSE:
                self._socket.sendall(frame(CLOSE, payload[:2], os.urandom(4)))
                return None
            if opcode == PING:
                self._socket.sendall(frame(PONG, payload, os.urandom(4)))
            if opcode not in (CONTINUATION, TEXT):
                continue
            parts.append(payload)
            if is_final:
                return b"".join(parts).decode()

    def close(self):
        self._socket.close()
