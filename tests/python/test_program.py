"""Files: detect, generate and replay run the program and raise its errors."""
import inspect
import json
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import brute_force, random_boxes

import octopair as op
from octopair._program import program_path

TETRAHEDRA = """o first
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
o second
v 0.2 0.2 0.2
v 1.2 0.2 0.2
v 0.2 1.2 0.2
v 0.2 0.2 1.2
f 5 7 6
f 5 6 8
f 5 8 7
f 6 7 8
"""


def test_detects_boxes_in_files(tmp_path):
    boxes, others = random_boxes(300), random_boxes(200, 2)
    np.save(tmp_path / "a.npy", boxes)
    np.save(tmp_path / "b.npy", others)
    found = op.detect(tmp_path / "a.npy", against=tmp_path / "b.npy", margin=0.01)
    assert found.pairs.tobytes() == op.find_pairs(boxes, others, margin=0.01).tobytes()
    assert found.collisions is None and found.stats["pairs"] == len(found.pairs) and not found.truncated
    assert op.detect(str(tmp_path / "a.npy"), limit=1).truncated
    both = op.detect(tmp_path / "a.npy", tmp_path / "b.npy", engine="processes", workers=2)
    assert both.pairs.tobytes() == op.find_pairs(np.vstack([boxes, others])).tobytes()


def test_detects_moving_boxes(tmp_path):
    frames = op.generate("brownian", 500, seed=3, frames=4)
    assert frames.shape == (4, 500, 6)
    np.save(tmp_path / "moving.npy", frames)
    found = op.detect(tmp_path / "moving.npy")
    assert found.frame_offsets is not None and len(found.frame_offsets) == 5
    for frame in range(4):
        piece = found.pairs[found.frame_offsets[frame]:found.frame_offsets[frame + 1]]
        assert np.array_equal(piece, brute_force(frames[frame]))
    scene = op.Scene()
    ids = scene.add(frames[0])
    events = op.detect(tmp_path / "moving.npy", events=True).events
    for frame in range(4):
        if frame:
            scene.move(ids, frames[frame])
        step = scene.step()
        rows = events[events["frame"] == frame]
        for name, pairs in (("begin", step.began), ("end", step.ended)):
            kind = rows[rows["event"] == name]
            assert np.array_equal(np.column_stack([kind["a"], kind["b"]]), pairs)


def test_detects_meshes(tmp_path):
    path = tmp_path / "two.obj"
    path.write_text(TETRAHEDRA)
    found = op.detect(path, stage="features")
    assert found.pairs.tolist() == [[0, 1]] and found.collisions[0]["class"] == "penetrating" and found.collisions[0]["contacts"]
    assert op.detect(path, stage="pairs").pairs.tolist() == [[0, 1]]
    assert op.detect(path).pairs.tolist() == [[0, 1]]
    assert len(op.detect(path, objects="triangle").pairs) > 0
    for adjacent in ("include", "beyond_shared", "beyond-shared"):
        assert len(op.detect(path, objects="triangle", stage="objects", adjacent=adjacent).pairs) > 0
    assert op.detect(path, stage="objects", same_parent="include").pairs.tolist() == [[0, 1]]
    rules = tmp_path / "rules.json"
    rules.write_text(json.dumps({"exclude": [{"a": "*first*", "b": "*second*"}]}))
    assert len(op.detect(path, exclude=rules, stage="objects").pairs) == 0


# A reader that gives each file the same triangle.
READER = """
import struct, sys
def text(word): return struct.pack("<I", len(word)) + word.encode()
def record(kind, content): sys.stdout.buffer.write(struct.pack("<IQ", kind, len(content)) + content)
sys.stdout.buffer.write(b"OPMODEL\\n" + struct.pack("<I", 1))
record(1, text("m") + text("z") + text(""))
record(2, struct.pack("<dII9d3I", 0, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2))
record(3, struct.pack("<I16d", 0, *[float(i % 5 == 0) for i in range(16)]) + 9 * text("") + struct.pack("<I", 0))
record(7, struct.pack("<QQII", 1, 1, 0, 0))
"""


def test_detects_by_a_reader(tmp_path):
    (tmp_path / "reader.py").write_text(READER)
    for name in ("a.npy", "b.npy"):
        (tmp_path / name).write_text("no array")
    found = op.detect(tmp_path / "a.npy", tmp_path / "b.npy", reader=f"{sys.executable} {tmp_path / 'reader.py'}")
    assert found.pairs.tolist() == [[0, 1]] and found.collisions is not None
    with pytest.raises(op.InputError, match="status 1"):
        op.detect(tmp_path / "a.npy", reader="false")


def test_gives_an_option_for_each_element_of_a_list(monkeypatch, tmp_path):
    shown = tmp_path / "program"
    shown.write_text('#!/bin/sh\necho "octopair: $*" >&2\nexit 3\n')
    shown.chmod(0o755)
    monkeypatch.setenv("OCTOPAIR_PROGRAM", str(shown))
    for types, words in ((["IfcSpace", "IfcGrid"], "--include-type=IfcSpace --include-type=IfcGrid"), ("IfcSpace", "--include-type=IfcSpace ")):
        with pytest.raises(op.InputError, match=words):
            op.detect("a.ifc", include_type=types)


def test_detect_has_the_options_of_the_command():
    shown = subprocess.run([program_path(), "detect", "--help"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"^  (?:-\w, )?--([a-z-]+)", shown, re.MULTILINE))
    assert {"margin", "same-parent", "help"} <= options
    own = {"help", "output", "count-only", "stats", "quiet", "fail-on-collision"}  # detect() returns what these are for
    parameters = {name: parameter for name, parameter in inspect.signature(op.detect).parameters.items() if name != "inputs"}
    assert {name.replace("_", "-") for name in parameters} == options - own
    assert {parameter.kind for parameter in parameters.values()} == {inspect.Parameter.KEYWORD_ONLY}
    flags = set(re.findall(r"^  (?:-\w, )?--([a-z-]+)(?:\s{2,}|\n)", shown, re.MULTILINE))
    assert {name.replace("_", "-") for name, parameter in parameters.items() if parameter.default is False} == flags - own


def test_generates_the_same_bytes(tmp_path):
    assert op.generate("uniform", 1000, seed=7).tobytes() == op.generate("uniform", 1000, seed=7).tobytes()
    assert op.generate("uniform", 0).shape == (0, 6)
    with pytest.raises(op.UsageError, match="KIND"):
        op.generate("circular", 10)


@pytest.mark.parametrize("call, kind, words", [
    (lambda p: op.detect(), op.UsageError, "file"), (lambda p: op.detect(p / "none.npy"), op.FileError, "none.npy"),
    (lambda p: op.detect(p / "bad.npy"), op.InputError, "object 1"), (lambda p: op.detect(p / "bad.npy", nonsense=3), TypeError, "nonsense"),
    (lambda p: op.detect(5), TypeError, "path"), (lambda p: op.detect("--help"), op.InputError, "help"),
    (lambda p: op.detect("a\0b.npy"), op.InputError, "character"), (lambda p: op.generate("--help", 5), op.UsageError, "help"),
    (lambda p: op.detect(p / "bad.npy", help=True), TypeError, "help"), (lambda p: op.generate(None, 5), TypeError, "kind"),
    (lambda p: op.detect(p / "bad.npy", output="x.npy"), TypeError, "output"), (lambda p: op.replay(p / "bad.npy"), op.InputError, "bad.npy"),
    (lambda p: op.generate("uniform", -1), op.Error, "objects")])
def test_raises_the_errors_of_the_program(call, kind, words, tmp_path):
    np.save(tmp_path / "bad.npy", np.array([[0, 0, 0, 1, 1, 1], [0, 0, 0, -1, 1, 1.0]]))
    with pytest.raises(kind, match=words):
        call(tmp_path)


def test_the_program_may_be_missing(monkeypatch, tmp_path):
    monkeypatch.setenv("OCTOPAIR_PROGRAM", str(tmp_path / "none"))
    with pytest.raises(op.FileError):
        op.generate("uniform", 10)


def test_the_command_runs_the_program():
    shown = subprocess.run([sys.executable, "-c", "from octopair._program import main; main()", "--version"], capture_output=True,
                           text=True, check=True)
    assert shown.stdout == f"octopair {op.__version__}\n"
