"""View: the addresses of a running scene's page, and frames over its WebSocket."""
import base64
import json
import os
import socket
import struct
import time
import urllib.parse
import urllib.request

import numpy as np
import pytest

import octopair as op

pytest.importorskip("octopair._view")

HEADER = 64  # bytes before the arrays of a frame (viewer/protocol.md)
WHOLE = 0xFFFFFFFF


class Page:
    """A page that is connected by WebSocket, with the standard library alone."""

    def __init__(self, address):
        host = urllib.parse.urlparse(address)
        self.socket = socket.create_connection((host.hostname, host.port), timeout=20)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET /socket HTTP/1.1\r\nHost: {host.netloc}\r\nOrigin: http://{host.netloc}\r\nUpgrade: websocket\r\n"
                            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.bytes += self.socket.recv(65536)
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        assert b" 101 " in head.split(b"\r\n")[0]

    def take(self, count):
        while len(self.bytes) < count:
            more = self.socket.recv(1 << 20)
            assert more, "the server closed the connection"
            self.bytes += more
        part, self.bytes = self.bytes[:count], self.bytes[count:]
        return part

    def message(self):
        """Returns the next message: bytes of a frame, or the JSON of an event."""
        first, length = self.take(2)
        if length == 126:
            length, = struct.unpack(">H", self.take(2))
        elif length == 127:
            length, = struct.unpack(">Q", self.take(8))
        body = self.take(length)
        return body if first & 15 == 2 else json.loads(body)

    def frame(self, last):
        """Requests a frame after frame `last`, and returns (number, base, moved rows, boxes, bytes)."""
        text = json.dumps({"want": last}).encode()
        mask = os.urandom(4)
        self.socket.sendall(bytes([0x81, 0x80 | len(text)]) + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(text)))
        while not isinstance(body := self.message(), bytes):
            pass
        magic, number, base, objects, shown, moved = struct.unpack("<6I", body[:24])
        assert magic == 0x4F504C56
        if base == WHOLE:
            return number, base, np.arange(shown), np.frombuffer(body, "<f4", 6 * shown, HEADER).reshape(-1, 6), body
        rows = np.frombuffer(body, "<u4", moved, HEADER)
        return number, base, rows, np.frombuffer(body, "<f4", 6 * moved, HEADER + 4 * moved).reshape(-1, 6), body


def get(view, path):
    with urllib.request.urlopen(view.address + path, timeout=20) as answer:
        return answer.read()


def test_page_has_the_scene():
    scene = op.Scene()
    scene.add(np.array([[0, 0, 0, 1, 1, 1], [5, 5, 5, 6, 6, 6], [1, 0, 0, 2, 1, 1]], dtype=np.float32))
    with op.View(scene, title="three", names=["a", "b", "c"], unit="m") as view:
        assert b"<html" in get(view, "")
        view.show(scene.step())
        page = Page(view.address)
        page.frame(-1)
        about = json.loads(get(view, "view.json"))
        assert (about["title"], about["kind"], about["objects"], about["unit"]) == ("three", "live", 3, "m")
        assert json.loads(get(view, "names.json")) == ["a", "b", "c"]
        assert [(row["a"], row["b"]) for row in json.loads(get(view, "collisions/0.json"))["rows"]] == [(0, 2)]
        assert json.loads(get(view, "object/0/2.json"))["partners"] == [0]


def test_frames_follow_the_scene():
    rng = np.random.default_rng(1)
    scene = op.Scene(dtype="float64")
    boxes = op.generate("uniform", 2000, seed=1).astype(np.float64)
    ids = scene.add(boxes)
    with op.View(scene, frames_per_second=1000) as view:
        view.show(scene.step())
        page = Page(view.address)
        number, base, rows, shown, _ = page.frame(-1)
        assert base == WHOLE
        known = shown.copy()
        origin = np.array(json.loads(get(view, "view.json"))["origin"])
        page.socket.settimeout(0.05)
        for _ in range(5):
            some = rng.choice(2000, 20, replace=False)
            boxes[some] += 0.01
            scene.move(ids[some], boxes[some])
            truth = (boxes - np.tile(origin, 2)).astype(np.float32)
            view.show(scene.step())
            deadline = time.monotonic() + 20
            while not np.array_equal(known, truth):  # show() copies seldom, so that it takes little of the time
                assert time.monotonic() < deadline
                try:
                    number, base, rows, shown, _ = page.frame(number)
                except TimeoutError:
                    view.show(scene.step())
                    continue
                assert base != WHOLE
                known[rows] = shown


def test_errors():
    scene = op.Scene()
    with pytest.raises(op.UsageError, match="up"):
        op.View(scene, up="x")
    with pytest.raises(op.UsageError, match="token"):
        op.View(scene, host="0.0.0.0")
    with pytest.raises(TypeError, match="scene"):
        op.View(op.find_pairs)
    view = op.View(scene)
    view.close()
    view.close()
    with pytest.raises(op.UsageError, match="closed"):
        view.show(scene.step())
    assert view.pages == 0


def test_view_keeps_its_scene():
    view = op.View(op.Scene())
    assert b"live" in get(view, "view.json")
    view.close()
