"""Inputs: what is read where it lies, what is refused and how, and what results own."""
import array
import gc

import numpy as np
import pytest
from conftest import brute_force, random_boxes

import octopair as op


class Interface:
    """Has only __array_interface__."""

    def __init__(self, of):
        self._of = of
        self.__array_interface__ = of.__array_interface__


class Dlpack:
    """Has only DLPack."""

    def __init__(self, of):
        self._of = of

    def __dlpack__(self, **options):
        return self._of.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._of.__dlpack_device__()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("wrap", [lambda a: a, Interface, Dlpack, memoryview, lambda a: a.view(np.recarray).view(np.matrix)])
def test_reads_arrays_where_they_lie(wrap, dtype):
    boxes = random_boxes(200, dtype=dtype)
    assert np.array_equal(op.find_pairs(wrap(boxes)), brute_force(boxes))


def test_reads_read_only_and_mapped_arrays(tmp_path):
    boxes = random_boxes(200)
    np.save(tmp_path / "boxes.npy", boxes)
    frozen = boxes.copy()
    frozen.flags.writeable = False
    for form in (frozen, np.load(tmp_path / "boxes.npy", mmap_mode="r")):
        assert np.array_equal(op.find_pairs(form), brute_force(boxes))


WRONG = {
    "list": (lambda b: b.tolist(), TypeError, "numpy.array(boxes)"),
    "text": (lambda b: "boxes", TypeError, "not an array"),
    "none": (lambda b: None, TypeError, "not an array"),
    "bytes": (lambda b: b.tobytes(), TypeError, "not an array"),
    "integers": (lambda b: (b * 100).astype(int), TypeError, "astype"),
    "float16": (lambda b: b.astype(np.float16), TypeError, "astype"),
    "objects": (lambda b: b.astype(object), TypeError, "astype"),
    "other byte order": (lambda b: b.astype(">f4"), TypeError, "astype"),
    "complex": (lambda b: b.astype(complex), TypeError, "astype"),
    "masked": (lambda b: np.ma.masked_array(b), TypeError, "mask"),
    "flat": (lambda b: b.ravel(), ValueError, "shape"),
    "seven columns": (lambda b: np.zeros((3, 7)), ValueError, "(n, 6)"),
    "three axes": (lambda b: b[None], ValueError, "(n, 6)"),
    "Fortran order": (np.asfortranarray, ValueError, "ascontiguousarray"),
    "every second row": (lambda b: b[::2], ValueError, "ascontiguousarray"),
    "reversed": (lambda b: b[::-1], ValueError, "ascontiguousarray"),
    "every second column": (lambda b: np.zeros((4, 12))[:, ::2], ValueError, "ascontiguousarray"),
    "array module": (lambda b: array.array("d", [1, 2, 3]), ValueError, "shape"),
}


@pytest.mark.parametrize("name", WRONG)
def test_refuses_other_arrays(name):
    make, kind, words = WRONG[name]
    with pytest.raises(op.Error) as caught:
        op.find_pairs(make(random_boxes(10)))
    assert isinstance(caught.value, kind)
    assert caught.value.code == "bad_input"
    assert str(caught.value).startswith("boxes: ") and words in str(caught.value)


@pytest.mark.parametrize("make", [lambda b: b.tolist(), np.asfortranarray, lambda b: b.astype(">f8"), lambda b: b.astype("g"),
                                  lambda b: np.repeat(b, 2, axis=0)[::2]])
def test_converts_on_request(make):
    boxes = random_boxes(100, dtype=np.float64)
    assert np.array_equal(op.find_pairs(make(boxes), copy=True), brute_force(boxes))


def test_converts_integers_without_loss():
    boxes = np.array([[2**40, 0, 0, 2**40 + 1, 1, 1], [2**40 + 2, 0, 0, 2**40 + 3, 1, 1]])
    assert op.count_pairs(boxes, copy=True) == 0
    assert op.count_pairs(boxes, margin=1, copy=True) == 1


def test_unaligned_memory_is_refused_or_copied():
    boxes = random_boxes(50)
    raw = np.empty(boxes.nbytes + 1, dtype=np.uint8)
    raw[1:] = boxes.reshape(-1).view(np.uint8)
    unaligned = np.ndarray(boxes.shape, dtype=np.float32, buffer=raw, offset=1)
    assert not unaligned.flags.aligned
    with pytest.raises(ValueError, match="boxes.copy()"):
        op.find_pairs(unaligned)
    assert np.array_equal(op.find_pairs(unaligned, copy=True), brute_force(boxes))
    assert np.array_equal(op.find_pairs(unaligned.copy()), brute_force(boxes))


@pytest.mark.parametrize("value, words", [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "inf")])
def test_names_the_invalid_box(value, words):
    boxes = random_boxes(100)
    boxes[37, 4] = value
    with pytest.raises(ValueError) as caught:
        op.find_pairs(boxes)
    assert (caught.value.index, caught.value.set) == (37, 0) and words in str(caught.value)
    with pytest.raises(op.InputError) as caught:
        op.find_pairs(random_boxes(5), against=boxes)
    assert (caught.value.index, caught.value.set) == (37, 1) and "second set" in str(caught.value)


def test_no_number_of_a_message_is_taken_for_an_index(tmp_path):
    with pytest.raises(op.FileError) as caught:
        op.Scene(recording=str(tmp_path / "object 7" / "scene.rec"))
    assert "object 7" in str(caught.value) and caught.value.index is None


@pytest.mark.parametrize("arguments, kind", [
    ({"margin": -1}, ValueError), ({"margin": np.nan}, ValueError), ({"margin": "1"}, TypeError), ({"margin": None}, TypeError),
    ({"margin": 10**400}, ValueError), ({"margin": np.ones(2)}, TypeError), ({"order": np.ones(2)}, TypeError),
    ({"order": "up"}, ValueError), ({"limit": -1}, ValueError), ({"limit": 1.5}, TypeError), ({"threads": -1}, ValueError),
    ({"threads": "2"}, TypeError), ({"padding": [1.0]}, TypeError), ({"padding": np.ones(3)}, ValueError),
    ({"padding": -1.0}, ValueError), ({"padding": np.ones(10, np.float32)}, TypeError), ({"against_padding": 1.0}, ValueError),
    ({"progress": 3}, TypeError), ({"against": 3}, TypeError)])
def test_refuses_other_arguments(arguments, kind):
    with pytest.raises(op.Error) as caught:
        op.find_pairs(random_boxes(10), **arguments)
    assert isinstance(caught.value, kind)


def test_results_are_arrays_of_their_own():
    boxes = random_boxes(100)
    pairs = op.find_pairs(boxes)
    assert pairs.dtype == np.uint32 and pairs.flags.c_contiguous and pairs.flags.writeable
    copy = pairs.copy()
    boxes[:] = 0
    op.find_pairs(boxes)
    assert np.array_equal(pairs, copy)
    empty = op.find_pairs(np.empty((0, 6)))
    assert empty.shape == (0, 2) and empty.dtype == np.uint32
    assert op.find_pairs(np.zeros((1, 6), np.float32)).shape == (0, 2)


def test_results_outlive_what_made_them():
    boxes = random_boxes(3000, size=0.3)
    expected = brute_force(boxes)
    engine = op.Engine("processes", workers=2)
    scene = op.Scene()
    scene.add(boxes)
    own = engine.allocate_boxes(len(boxes))
    own[:] = boxes
    results = [engine.find_pairs(own), engine.submit(own).result().pairs, scene.step().began, scene.pairs()]
    results += [np.vstack(list(engine.stream_pairs(own)))]
    del engine, scene
    gc.collect()
    assert np.array_equal(own, boxes)
    for result in results:
        assert np.array_equal(result, expected)
