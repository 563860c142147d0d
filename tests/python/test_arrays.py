"""Inputs: what is read where it lies, what is refused and how, and what results own."""
import array
import collections.abc
import gc

import numpy as np
import pandas
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


def unaligned(boxes):
    raw = np.empty(boxes.nbytes + 1, dtype=np.uint8)
    raw[1:] = boxes.reshape(-1).view(np.uint8)
    found = np.ndarray(boxes.shape, dtype=boxes.dtype, buffer=raw, offset=1)
    assert not found.flags.aligned
    return found


class Rows(collections.abc.Sequence):
    """A sequence of rows."""

    def __init__(self, rows):
        self._rows = rows

    def __len__(self):
        return len(self._rows)

    def __getitem__(self, index):
        return self._rows[index]


CONVERTED = {
    "list": lambda b: b.tolist(),
    "tuple of rows": lambda b: tuple(map(tuple, b.tolist())),
    "list of arrays": list,
    "sequence": lambda b: Rows(b.tolist()),
    "DataFrame": pandas.DataFrame,
    "DataFrame of mixed columns": lambda b: pandas.DataFrame(b).astype({0: np.int16, 3: np.float32}),
    "int64": lambda b: b.astype(np.int64),
    "int8": lambda b: b.astype(np.int8),
    "uint64": lambda b: b.astype(np.uint64),
    "float16": lambda b: b.astype(np.float16),
    "longdouble": lambda b: b.astype(np.longdouble),
    "other byte order": lambda b: b.astype(">f4"),
    "integers in other byte order": lambda b: b.astype(">i8"),
    "Fortran order": np.asfortranarray,
    "every second row": lambda b: np.repeat(b, 2, axis=0)[::2],
    "reversed twice": lambda b: np.ascontiguousarray(b[::-1])[::-1],
    "every second column": lambda b: np.repeat(b, 2, axis=1)[:, ::2],
    "unaligned": unaligned,
}


@pytest.mark.parametrize("name", CONVERTED)
def test_converts_what_is_array_like(name):
    boxes = np.floor(random_boxes(100, dtype=np.float64, size=0.2) * 100)
    boxes[:, 3:] = np.maximum(boxes[:, 3:], boxes[:, :3])
    given, expected = CONVERTED[name](boxes), op.find_pairs(boxes)
    assert np.array_equal(expected, brute_force(boxes)) and len(expected)
    engine = op.Engine(threads=1)
    assert np.array_equal(op.find_pairs(given), expected)
    assert np.array_equal(op.find_pairs(given, copy=True), expected)
    assert np.array_equal(op.find_pairs(given, against=given), brute_force(boxes, boxes))
    assert op.count_pairs(given) == engine.count_pairs(given) == len(expected)
    assert np.array_equal(np.vstack(list(op.stream_pairs(given))), expected)
    assert np.array_equal(engine.submit(given).result().pairs, expected)
    assert np.array_equal(op.Pipeline().run(given).pairs, expected)
    assert op.list_octants(given).homes.sum() == 100
    for dtype in ("float32", "float64"):
        scene = op.Scene(dtype=dtype)
        ids = scene.add(given)
        scene.move(ids, given)
        assert np.array_equal(scene.step().began, expected)


@pytest.mark.parametrize("make", [lambda v: v, lambda v: v.tolist(), tuple, pandas.Series, lambda v: v.astype(np.float32),
                                  lambda v: v.astype(np.int32), lambda v: np.repeat(v, 2)[::2]])
def test_converts_columns(make):
    boxes, padding, groups = random_boxes(50), np.arange(50.0) % 3, np.arange(50) % 4 + 1
    expected = op.find_pairs(boxes, padding=padding)
    assert np.array_equal(op.find_pairs(boxes, padding=make(padding)), expected)
    assert np.array_equal(op.find_pairs(boxes, boxes, against_padding=make(padding)), op.find_pairs(boxes, boxes, against_padding=padding))
    whole = make(groups) if not isinstance(make(groups), np.ndarray) or make(groups).dtype.kind in "iu" else groups.tolist()
    scenes = [op.Scene(), op.Scene()]
    scenes[0].add(boxes, groups=groups.astype(np.uint32), mask=groups.astype(np.uint32), padding=padding)
    scenes[1].add(boxes, groups=whole, mask=whole, padding=make(padding))
    assert np.array_equal(scenes[0].step().began, scenes[1].step().began)
    table = op.Pipeline().parents(whole).groups(whole, whole).run(boxes, padding=make(padding))
    assert np.array_equal(table.pairs, op.Pipeline().parents(groups).groups(groups, groups).run(boxes, padding=padding).pairs)


def test_spheres_are_boxes_as_in_the_program(tmp_path):
    rng = np.random.default_rng(5)
    for dtype in (np.float32, np.float64):
        spheres = np.hstack([rng.random((300, 3)), rng.random((300, 1)) * 0.05]).astype(dtype)
        others = spheres[::-1] + dtype(0.01)
        np.save(tmp_path / "spheres.npy", spheres)
        np.save(tmp_path / "others.npy", others)
        expected = op.detect(tmp_path / "spheres.npy").pairs
        assert len(expected) and np.array_equal(op.find_pairs(spheres), expected)
        assert op.count_pairs(spheres) == len(expected)
        assert np.array_equal(np.vstack(list(op.stream_pairs(spheres))), expected)
        assert np.array_equal(op.Engine().submit(spheres).result().pairs, expected)
        joined = op.find_pairs(spheres, others, margin=0.01)
        assert np.array_equal(joined, op.detect(tmp_path / "spheres.npy", against=tmp_path / "others.npy", margin=0.01).pairs)
        scene = op.Scene(dtype=dtype)
        ids = scene.add(spheres)
        boxes = scene.boxes()
        assert np.array_equal(scene.step().began, expected) and np.array_equal(op.find_pairs(boxes), expected)
        wide, ends = spheres.astype(np.longdouble), boxes.astype(np.longdouble)
        centre = wide[:, :3].astype(np.float64) if dtype == np.float32 else wide[:, :3]
        assert (ends[:, :3] <= centre - wide[:, 3:]).all() and (ends[:, 3:] >= centre + wide[:, 3:]).all()
        assert (np.nextafter(boxes[:, :3], dtype(9)) > centre - wide[:, 3:]).all()
        scene.move(ids, others)
        assert np.array_equal(scene.step().began, difference(op.find_pairs(others), expected))
    # centre - radius is rounded outward: boxes that were rounded to the nearest would not touch.
    tight = np.array([[0, 0, 0, 1], [1 + 2.0 ** -53, 0, 0, 2.0 ** -54]], dtype=np.float64)
    assert len(op.find_pairs(tight)) == 1 and len(op.find_pairs([[0, 0, 0, 1], [3, 0, 0, 1.5]])) == 0


def difference(first, second):
    return np.array(sorted(set(map(tuple, first)) - set(map(tuple, second))), dtype=np.uint32).reshape(-1, 2)


@pytest.mark.parametrize("spheres, words", [([[0, 0, 0, 1], [0, 0, 0, -1]], "object 1: radius is -1, not a finite number >= 0"),
                                            ([[0, 0, 0, 1], [0, np.nan, 0, 1]], "object 1: centre y is nan"),
                                            ([[0, 0, 0, 1], [1e308, 0, 0, 1e308]], "object 1: its box is outside the range of float64")])
def test_names_the_invalid_sphere(spheres, words):
    with pytest.raises(op.InputError) as caught:
        op.find_pairs(spheres)
    assert str(caught.value).startswith(words) and (caught.value.index, caught.value.set) == (1, 0)
    with pytest.raises(op.InputError) as caught:
        op.find_pairs(random_boxes(3), spheres)
    assert str(caught.value).startswith("second set: " + words) and (caught.value.index, caught.value.set) == (1, 1)


WRONG = {
    "text": (lambda b: "boxes", TypeError, "not an array"),
    "none": (lambda b: None, TypeError, "not an array"),
    "number": (lambda b: 3.5, TypeError, "number"),
    "bytes": (lambda b: b.tobytes(), TypeError, "not an array"),
    "generator": (lambda b: (row for row in b), TypeError, "list of rows"),
    "set": (lambda b: {1, 2}, TypeError, "list of rows"),
    "list of texts": (lambda b: [["1"] * 6], TypeError, "dtype"),
    "ragged list": (lambda b: [[1, 2, 3], [4]], TypeError, "NumPy cannot read"),
    "objects": (lambda b: b.astype(object), TypeError, "dtype"),
    "DataFrame with texts": (lambda b: pandas.DataFrame(b).astype({2: str}), TypeError, "dtype"),
    "complex": (lambda b: b.astype(complex), TypeError, "dtype"),
    "dates": (lambda b: b.astype("M8[s]"), TypeError, "dtype"),
    "masked": (lambda b: np.ma.masked_array(b), TypeError, "mask"),
    "flat": (lambda b: b.ravel(), ValueError, "shape"),
    "seven columns": (lambda b: np.zeros((3, 7)), ValueError, "(n, 6)"),
    "three axes": (lambda b: b[None], ValueError, "(n, 6)"),
    "array module": (lambda b: array.array("d", [1, 2, 3]), ValueError, "shape"),
}


@pytest.mark.parametrize("name", WRONG)
def test_refuses_other_arrays(name):
    make, kind, words = WRONG[name]
    for call in (op.find_pairs, op.Scene().add, op.list_octants, op.Engine().submit, op.Pipeline().run):
        with pytest.raises(op.Error) as caught:
            call(make(random_boxes(10)))
        assert isinstance(caught.value, kind)
        assert caught.value.code == "bad_input"
        assert str(caught.value).startswith("boxes: ") and words in str(caught.value)


@pytest.mark.parametrize("value", [np.int64(2**53 + 1), np.int64(-2**53 - 1), np.uint64(2**64 - 1), np.longdouble(1) / 3])
def test_refuses_numbers_that_would_change(value):
    boxes = np.zeros((20, 6), dtype=value.dtype)
    boxes[7, 3:] = 1
    boxes[7, 4] = value
    with pytest.raises(op.InputError, match=r"boxes\[7, 4\] is .*float64 does not have this number") as caught:
        op.find_pairs(boxes)
    assert caught.value.index == 7
    for kept in (2**53, 2**62) if value.dtype.kind in "iu" else (0.5, np.inf):
        boxes[7, 3:] = value.dtype.type(kept)
        if kept != np.inf:
            assert op.count_pairs(boxes) == 190
    scene = op.Scene()
    with pytest.raises(op.InputError, match=r"boxes\[0, 3\] is 16777217.*float32.*dtype='float64'"):
        scene.add(np.array([[0, 0, 0, 2**24 + 1, 2**24, 2**24]]))
    with pytest.raises(op.InputError, match=r"boxes\[0, 3\] is 0.1.*float32.*dtype='float64'"):
        scene.add(np.array([[0, 0, 0, 0.1, 0.5, 0.5]]))
    assert len(scene) == 0
    scene.add([[0, 0, 0, 0.1, 0.5, 0.5]])  # the numbers of a list have no dtype
    scene.add(np.array([[0, 0, 0, 0.1, 0.5, 0.5]]), copy=True)
    assert scene.boxes()[:, 3].tolist() == [np.float32(0.1)] * 2


def test_refuses_integers_that_would_change_among_floats():
    for row in ([2**53 + 1, 0, 0, 2.0**54, 1, 1], [0.5, 0, 0, 2**63 + 1, 1, 1]):
        with pytest.raises(op.InputError, match=r"boxes\[1, [03]\] is \d+; float64 does not have this number"):
            op.find_pairs([[0] * 6, row])
    assert op.count_pairs([[2**53 + 2, 0, 0, 2.0**54, 1, 1.5], [2**60, 0, 0, 2**60, 1, 1]]) == 0
    for padding in (2**53 + 1, np.longdouble("0.1")):
        with pytest.raises(op.InputError, match="padding.*float64 does not have this number"):
            op.find_pairs(np.zeros((2, 6)), padding=padding)


def test_converts_integers_without_loss():
    boxes = np.array([[2**40, 0, 0, 2**40 + 1, 1, 1], [2**40 + 2, 0, 0, 2**40 + 3, 1, 1]])
    assert op.count_pairs(boxes) == op.count_pairs(boxes, copy=True) == 0
    assert op.count_pairs(boxes, margin=1) == op.count_pairs(boxes, margin=1, copy=True) == 1


@pytest.mark.parametrize("empty", [[], (), np.empty(0), np.empty((0, 4)), pandas.DataFrame(columns=list("abcdef"))])
def test_empty_inputs_have_no_pairs(empty):
    assert op.find_pairs(empty).shape == (0, 2) and len(op.Scene().add(empty)) == 0
    assert op.find_pairs(random_boxes(3), empty).shape == (0, 2)


@pytest.mark.parametrize("column, kind", [([1, 2, 3, np.nan], ValueError), ([1.0, 2.0, 3.0, 4.0], TypeError), ([1, 2, 3, -1], ValueError),
                                          ([1, 2, 3, 2**32], ValueError), ([True] * 4, TypeError), (["a"] * 4, TypeError),
                                          ([[1], [2], [3], [4]], ValueError)])
def test_refuses_other_integers(column, kind):
    boxes = random_boxes(4)
    calls = [lambda: op.Scene().add(boxes, groups=column), lambda: op.Pipeline().parents(column).run(boxes),
             lambda: op.Shapes([op.Geometry.sphere(1)], op.make_poses(np.zeros((4, 3))), column)]
    for call in calls:
        with pytest.raises(op.Error) as caught:
            call()
        assert isinstance(caught.value, kind)
    with pytest.raises(op.Error):
        op.Scene().remove(column)


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
    ({"margin": 10**400}, ValueError), ({"order": np.ones(2)}, TypeError),
    ({"order": "up"}, ValueError), ({"limit": -1}, ValueError), ({"limit": 1.5}, TypeError), ({"threads": -1}, ValueError),
    ({"threads": "2"}, TypeError), ({"padding": [1.0]}, ValueError), ({"padding": np.ones(3)}, ValueError),
    ({"padding": -1.0}, ValueError), ({"padding": ["a"] * 10}, TypeError), ({"against_padding": 1.0}, ValueError),
    ({"progress": 3}, TypeError), ({"against": 3}, TypeError)])
def test_refuses_other_arguments(arguments, kind):
    with pytest.raises(op.Error) as caught:
        op.find_pairs(random_boxes(10), **arguments)
    assert isinstance(caught.value, kind)


@pytest.mark.parametrize("margin", [np.ones(10), [1.0] * 10, pandas.Series(np.ones(10))])
def test_a_margin_is_one_number(margin):
    boxes, balls = random_boxes(10), op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0]]))
    for call in (op.find_pairs, op.count_pairs, op.stream_pairs, op.Engine().submit, op.Pipeline().run, op.list_octants):
        with pytest.raises(op.InputTypeError, match="margin: .*pass padding="):
            call(boxes, margin=margin)
    for call in (lambda: op.Scene(margin=margin), lambda: op.collide(balls, margin=margin)):
        with pytest.raises(op.InputTypeError, match="margin: .*pass padding="):
            call()


def test_a_number_in_place_of_a_second_set_is_a_margin():
    balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0]]))
    for call in (lambda: op.find_pairs(random_boxes(3), 0.25), lambda: op.Engine().count_pairs(random_boxes(3), 0.25),
                 lambda: op.Pipeline().run(random_boxes(3), 0.25), lambda: op.collide(balls, 0.25),
                 lambda: op.Pipeline().exact_objects(balls, 0.25)):
        with pytest.raises(op.InputTypeError, match="against: .*pass margin=0.25"):
            call()


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
