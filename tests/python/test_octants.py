"""Octants of a search, and boxes and octants of scenes."""
import numpy as np
import pytest
from conftest import random_boxes

import octopair as op


def check(octants, boxes, gap=0.0):
    """Compares octants with brute force in NumPy. `gap`: what each box is widened by."""
    assert str(octants.codes[0]) == "{}" and octants.codes == sorted(octants.codes) and len(octants) == len(octants.codes)
    assert octants.bounds.dtype == np.float64 and octants.bounds.shape == (len(octants), 6)
    assert (np.diff(octants.offsets) == octants.entries.astype(np.int64)).all() and octants.homes.sum() == len(boxes)
    positions = {code: i for i, code in enumerate(octants.codes)}
    space = octants.space.copy()
    low, high = octants.bounds[:, :3].copy(), octants.bounds[:, 3:].copy()
    for i, code in enumerate(octants.codes):
        if code.level:
            parent = octants.bounds[positions[code.parent]]
            assert not octants.leaf[positions[code.parent]]
            assert (octants.bounds[i, :3] >= parent[:3]).all() and (octants.bounds[i, 3:] <= parent[3:]).all()
        objects = octants.objects_in(i)
        homes, others = np.split(objects, [int(octants.homes[i])])
        assert (np.diff(homes.astype(int)) > 0).all() and (np.diff(others.astype(int)) > 0).all()
        assert (octants.home_octants[homes] == i).all()
        assert (octants.levels[homes] == code.level).all()
    # An octant at the border of the space also stores what lies beyond.
    low[low <= space[:3]] = -np.inf
    high[high >= space[3:]] = np.inf
    tolerance = 1e-5
    wide = np.hstack([boxes[:, :3].astype(float) - gap, boxes[:, 3:].astype(float) + gap])
    for i in range(len(octants)):
        objects = wide[octants.objects_in(i)]
        assert (objects[:, :3] <= high[i] + tolerance).all() and (objects[:, 3:] >= low[i] - tolerance).all()
        if not octants.leaf[i] or (octants.bounds[i, :3] >= space[3:]).any():
            continue
        sure = (wide[:, :3] < high[i] - tolerance).all(axis=1) & (wide[:, 3:] > low[i] + tolerance).all(axis=1)
        stored, code = set(octants.objects_in(i)), octants.codes[i]
        while code.level:
            code = code.parent
            stored |= set(octants.objects_in(positions[code]))
        assert stored >= set(np.flatnonzero(sure))


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_equal_to_brute_force(dtype):
    boxes = random_boxes(9000, dtype=dtype, size=0.02)
    octants = op.list_octants(boxes)
    assert len(octants) > 8
    check(octants, boxes)
    check(op.list_octants(boxes, margin=0.01, padding=0.005, threads=1), boxes, 0.01)
    summary = op.find_pairs(boxes, return_summary=True)[1]
    assert summary.entries == octants.entries.sum() == len(octants.objects)
    again = op.list_octants(boxes, threads=3)
    assert again.codes == octants.codes and (again.objects == octants.objects).all() and (again.bounds == octants.bounds).all()


@pytest.mark.parametrize("count", [0, 1])
def test_few_objects(count):
    octants = op.list_octants(random_boxes(count))
    assert len(octants) == 1 and octants.leaf[0] and octants.entries[0] == count and octants.levels.tolist() == [0] * count
    assert octants.objects_in(-1).tolist() == list(range(count))
    with pytest.raises(IndexError):
        octants.objects_in(1)


def test_refuses_invalid_input():
    boxes = random_boxes(100)
    boxes[42, 0] = np.nan
    with pytest.raises(op.InputError) as caught:
        op.list_octants(boxes)
    assert caught.value.index == 42
    for margin in (-1, np.inf, np.nan):
        with pytest.raises(op.InputError):
            op.list_octants(random_boxes(2), margin=margin)
    with pytest.raises(op.InputTypeError):
        op.list_octants([["a"] * 6])
    assert len(op.list_octants([[0, 0, 0, 1, 1, 1]])) == len(op.list_octants([[0, 0, 0, 1, 1, 1]], copy=True)) == 1


@pytest.mark.parametrize("dtype, slack", [("float32", 0), ("float64", 0), ("float64", 0.1)])
def test_scene(dtype, slack):
    rng = np.random.default_rng(3)
    boxes = random_boxes(6000, dtype=dtype, size=0.02)
    scene = op.Scene(margin=0.001, dtype=dtype, slack=slack)
    assert scene.boxes().shape == (0, 6) and scene.boxes().dtype == dtype and len(scene.octants()) == 1
    ids = scene.add(boxes)
    for _ in range(3):
        moved = rng.random(len(ids)) < 0.2
        places = random_boxes(int(moved.sum()), int(rng.integers(99)), dtype, 0.02)
        scene.move(ids[moved], places)
        boxes[ids[moved]["index"]] = places
        gone = rng.random(len(ids)) < 0.1
        scene.remove(ids[gone])
        boxes[ids[gone]["index"]] = np.nan
        ids = np.ascontiguousarray(ids[~gone])
        for _ in range(2):
            assert np.array_equal(scene.boxes(), boxes, equal_nan=True) and scene.boxes().dtype == boxes.dtype
            octants, indices = scene.octants(), np.sort(ids["index"])
            alone = op.list_octants(np.ascontiguousarray(boxes[indices]), margin=0.001)
            assert octants.codes == alone.codes and (octants.bounds == alone.bounds).all()
            assert (octants.objects == indices[alone.objects]).all()
            assert (octants.levels[indices] == alone.levels).all() and (octants.levels == 255).sum() == len(boxes) - len(indices)
            scene.step()
    copied = scene.boxes()
    copied[:] = 0
    assert np.array_equal(scene.boxes(), boxes, equal_nan=True)


def test_swept_object():
    scene = op.Scene(dtype="float64")
    ids = scene.add(np.array([[0, 0, 0, 1, 1, 1.0]]))
    scene.sweep(ids, np.array([[4, 0, 0, 5, 1, 1.0]]))
    assert scene.boxes().tolist() == [[0, 0, 0, 5, 1, 1]]
    scene.step()
    assert scene.boxes().tolist() == [[4, 0, 0, 5, 1, 1]]
