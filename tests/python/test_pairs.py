"""Pairs: equal to brute force, to scipy and to the program, for every engine, order, dtype and option."""
import subprocess

import numpy as np
import pytest
from conftest import brute_force, random_boxes, serving
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from octopair._program import program_path

import octopair as op

# Few different coordinates: boxes touch, coincide and have no extent.
coordinates = hnp.arrays(np.int8, st.tuples(st.integers(0, 40), st.just(6)), elements=st.integers(-4, 4))
SETTINGS = settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))


def as_boxes(numbers, dtype=np.float64):
    corners = numbers.reshape(-1, 2, 3) / 4
    return np.hstack([corners.min(axis=1), corners.max(axis=1)]).astype(dtype)


@SETTINGS
@given(coordinates, coordinates, st.sampled_from([0, 0.25, 1]), st.sampled_from([np.float32, np.float64]))
def test_equal_to_brute_force(numbers, others, margin, dtype):
    boxes, second = as_boxes(numbers, dtype), as_boxes(others, dtype)
    engine = op.Engine(threads=1)
    expected = brute_force(boxes, gap=margin)
    assert np.array_equal(engine.find_pairs(boxes, margin=margin), expected)
    assert engine.count_pairs(boxes, margin=margin) == len(expected)
    join = brute_force(boxes, second, margin)
    assert np.array_equal(engine.find_pairs(boxes, second, margin=margin), join)
    octal = engine.find_pairs(boxes, second, margin=margin, order="octal")
    assert np.array_equal(octal[np.lexsort(octal.T[::-1])].reshape(-1, 2), join)


@SETTINGS
@given(coordinates, hnp.arrays(np.int8, 40, elements=st.integers(0, 4)))
def test_paddings_are_equal_to_brute_force(numbers, padding):
    boxes = as_boxes(numbers)
    padding = padding[:len(boxes)] / 4
    expected = brute_force(boxes, gap=padding[:, None] + padding[None, :] + 0.25)
    assert np.array_equal(op.find_pairs(boxes, margin=0.25, padding=padding), expected)


@SETTINGS
@given(hnp.arrays(np.int8, st.tuples(st.integers(2, 60), st.just(3)), elements=st.integers(-64, 64)), st.integers(0, 16))
def test_equal_to_scipy(sixteenths_of_centres, sixteenths):
    spatial = pytest.importorskip("scipy.spatial")
    centres, radius = sixteenths_of_centres / 16, sixteenths / 16
    expected = spatial.cKDTree(centres).query_pairs(radius, p=np.inf, output_type="ndarray")
    expected = expected[np.lexsort(expected.T[::-1])].reshape(-1, 2)
    half = radius / 2
    assert np.array_equal(op.find_pairs(np.hstack([centres - half, centres + half])), expected)
    assert np.array_equal(op.find_pairs(np.hstack([centres, centres]), margin=radius), expected)


@pytest.fixture(scope="module")
def server():
    with serving() as address:
        yield address


@pytest.mark.parametrize("kind", ["uniform", "clustered", "coincident", "rods"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_same_bytes_as_the_program(kind, dtype, tmp_path, server):
    boxes = op.generate(kind, 1500, seed=5).astype(dtype)
    np.save(tmp_path / "boxes.npy", boxes)
    engines = [op.Engine(threads=1), op.Engine(threads=3), op.Engine("processes", workers=2), op.Engine(server)]
    for options in ({}, {"order": "octal"}, {"margin": 0.01}, {"limit": 100}):
        arguments = [text for name, value in options.items() for text in (f"--{name}", str(value))]
        subprocess.run([program_path(), "detect", str(tmp_path / "boxes.npy"), "--output", str(tmp_path / "pairs.npy"), "--quiet",
                        *arguments], check=True)
        expected = np.load(tmp_path / "pairs.npy")
        for engine in engines:
            found, summary = engine.find_pairs(boxes, **options, return_summary=True)
            assert found.tobytes() == expected.tobytes()
            assert summary.pairs == len(expected) and summary.truncated == ("limit" in options)
            with engine.stream_pairs(boxes, **options, buffer_bytes=1 << 20) as stream:
                chunks = list(stream)
                assert stream.summary.pairs == len(expected)
            assert np.vstack([np.empty((0, 2), np.uint32), *chunks]).tobytes() == expected.tobytes()
            assert engine.submit(boxes, **options).result().pairs.tobytes() == expected.tobytes()


def test_long_results_are_complete():
    boxes = np.zeros((3000, 6), np.float32)
    expected = np.argwhere(np.triu(np.ones((3000, 3000), bool), 1)).astype(np.uint32)
    assert np.array_equal(op.find_pairs(boxes), expected)
    chunks = list(op.stream_pairs(boxes, buffer_bytes=1 << 20))
    assert len(chunks) > 20 and np.array_equal(np.vstack(chunks), expected)


def test_verify_and_counts(engine):
    boxes = random_boxes(3000)
    pairs, summary = engine.find_pairs(boxes, verify=True, return_summary=True)
    assert summary.verified and summary.not_checked == "" and summary.entries >= 3000
    assert engine.count_pairs(boxes) == len(pairs) == len(brute_force(boxes))
    assert engine.count_pairs(boxes, limit=7) == 7


def test_allocated_boxes(engine):
    for dtype in ("float32", "float64"):
        own = engine.allocate_boxes(500, dtype=dtype)
        assert own.shape == (500, 6) and own.dtype == dtype and own.flags.writeable
        own[:] = random_boxes(500)
        assert np.array_equal(engine.find_pairs(own), brute_force(own))


def test_faults_of_workers():
    assert op.Engine("processes", workers=1).worker_faults() == (0, 0, (0, 0, 0, 0, 0))
    with pytest.raises(op.UsageError):
        op.Engine().worker_faults()


@pytest.mark.parametrize("arguments", [("other",), (None,), ("unix:/x", {"token": 1}), ("unix:/x", {"patience": "x"}), ("local", {"workers": 2}), ("processes", {"threads": 2}), ("local", {"token": "x"}), ("local", {"patience": 3}), ("processes", {"tls": True}),
                                       ("unix:/x", {"threads": 2, "connect_timeout": 0.1})])
def test_refuses_other_engines(arguments):
    options = arguments[1] if len(arguments) > 1 else {}
    with pytest.raises(op.Error):
        op.Engine(arguments[0], **options)


def test_octal_codes():
    code = op.OctalCode("{3,1,4}")
    assert code.digits == (2, 0, 3) and code.level == 3 and code.integer() == 314 and code.integer(5) == 31400
    assert op.OctalCode(314) == code == op.OctalCode((2, 0, 3)) and str(code) == "{3,1,4}" and repr(code) == "OctalCode('{3,1,4}')"
    assert code.parent == op.OctalCode(31) and code.parent.contains(code) and code.parent < code
    assert code <= code and code != 1 and code != "x"
    for wrong, kind in (("{9}", ValueError), (-1, TypeError), (2**64, TypeError), (1.5, TypeError), (None, TypeError)):
        with pytest.raises(op.Error) as caught:
            op.OctalCode(wrong)
        assert isinstance(caught.value, kind)
