"""View: the addresses of a running scene's page, and frames over its WebSocket."""
import json
import pathlib
import socket
import struct
import sys
import time
import types
import urllib.parse
import urllib.request

import numpy as np
import pytest

import octopair as op

sys.path.append(str(pathlib.Path(__file__).parents[1] / "viewer"))
from view_process import WebSocket  # noqa: E402

pytest.importorskip("octopair._view")

HEADER = 64  # bytes before the arrays of a frame (viewer/protocol.md)
WHOLE = 0xFFFFFFFF


class Page(WebSocket):
    """A page that is connected by WebSocket."""

    def __init__(self, address):
        host = urllib.parse.urlparse(address)
        view = types.SimpleNamespace(endpoint=host.netloc, connect=lambda: socket.create_connection((host.hostname, host.port), timeout=20))
        super().__init__(view, headers=[f"Origin: http://{host.netloc}"])
        assert self.status == 101

    def message(self):
        """Returns the next message: bytes of a frame, or the JSON of an event."""
        opcode, body = self.read()
        return body if opcode == 2 else json.loads(body)

    def frame(self, last):
        """Requests a frame after frame `last`, and returns (number, base, moved rows, boxes, bytes)."""
        self.send(json.dumps({"want": last}).encode())
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
        page.connection.settimeout(0.05)
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


def test_the_end_of_a_scene_closes_its_views():
    with op.Scene() as scene:
        view = op.View(scene)
        view.show(scene.step())
    with pytest.raises(op.UsageError, match="the view is closed"):
        view.address
    view.close()
    with pytest.raises(op.UsageError, match="the scene is closed"):
        op.View(scene)


def test_view_keeps_its_scene():
    view = op.View(op.Scene())
    assert b"live" in get(view, "view.json")
    view.close()
