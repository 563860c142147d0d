"""Scenes: events and queries equal to brute force in NumPy, for local and remote scenes."""
import itertools
import signal

import numpy as np
import pytest
from conftest import brute_force, random_boxes, serving
from failing_arrays import room_for

import octopair as op


@pytest.fixture(scope="module", params=["local", "remote"])
def make_scene(request):
    if request.param == "local":
        yield op.Scene
        return
    from octopair.remote import RemoteScene
    with serving() as address:
        yield lambda **options: RemoteScene(address, **options)


class World:
    """What a scene should hold, in plain arrays by index."""

    def __init__(self):
        self.boxes, self.groups, self.masks, self.fixed, self.padding = {}, {}, {}, {}, {}

    def add(self, ids, boxes, traits):
        for row, (index, box) in enumerate(zip(ids["index"], boxes)):
            self.boxes[index] = box
            self.groups[index], self.masks[index], self.fixed[index], self.padding[index] = (column[row] for column in traits)

    def pairs(self, margin):
        order = sorted(self.boxes)
        if not order:
            return np.empty((0, 2), np.uint32)
        columns = [np.array([store[index] for index in order]) for store in (self.groups, self.masks, self.fixed, self.padding)]
        groups, masks, fixed, padding = columns
        found = brute_force(np.array([self.boxes[index] for index in order]), gap=margin + padding[:, None] + padding[None, :])
        a, b = found[:, 0], found[:, 1]
        wanted = (groups[a] & masks[b] != 0) & (groups[b] & masks[a] != 0) & ~(fixed[a] & fixed[b])
        return np.array(order, dtype=np.uint32)[found[wanted]].reshape(-1, 2)


def difference(first, second):
    return np.array(sorted(set(map(tuple, first)) - set(map(tuple, second))), dtype=np.uint32).reshape(-1, 2)


@pytest.mark.parametrize("dtype, seed", itertools.product(["float32", "float64"], range(3)))
def test_equal_to_brute_force(make_scene, dtype, seed):
    rng = np.random.default_rng(seed)
    margin = 0.0625 * seed
    scene, world = make_scene(margin=margin, dtype=dtype), World()
    alive = np.empty(0, op.id_dtype)
    before = np.empty((0, 2), np.uint32)
    for step in range(25):
        count = int(rng.integers(0, 40))
        boxes = np.round(random_boxes(count, int(rng.integers(1 << 30)), size=0.3) * 16).astype(dtype) / 16
        traits = (rng.integers(1, 4, count, dtype=np.uint32), rng.integers(0, 4, count, dtype=np.uint32), rng.random(count) < 0.3,
                  rng.integers(0, 2, count) / 8)
        ids = scene.add(boxes, groups=traits[0], mask=traits[1], fixed=traits[2], padding=traits[3])
        world.add(ids, boxes, traits)
        alive = np.concatenate([alive, ids])
        moved = rng.random(len(alive)) < 0.3
        places = np.round(random_boxes(int(moved.sum()), step + 100 * seed, size=0.3) * 16).astype(dtype) / 16
        scene.move(alive[moved], places)
        for index, box in zip(alive[moved]["index"], places):
            world.boxes[index] = box
        gone = rng.random(len(alive)) < 0.2
        scene.remove(alive[gone])
        for index in alive[gone]["index"]:
            del world.boxes[index]
        assert not scene.contains(alive[gone]).any()
        alive = np.ascontiguousarray(alive[~gone])
        result = scene.step()
        now = world.pairs(margin)
        assert np.array_equal(scene.pairs(), now)
        assert np.array_equal(result.began, difference(now, before))
        assert np.array_equal(result.ended, difference(before, now))
        assert result.pairs == len(now) and result.persisting == len(scene.persisting())
        if isinstance(scene, op.Scene):
            scene.verify()
        assert len(scene) == len(alive) and scene.contains(alive).all()
        assert np.array_equal(scene.ids(np.unique(now)), alive[np.isin(alive["index"], np.unique(now))][
            np.argsort(alive[np.isin(alive["index"], np.unique(now))]["index"])])
        before = now


class Interrupted(Exception):
    pass


def step_unless_interrupted(scene, seconds):
    """Makes a step that a signal handler interrupts after some seconds. Returns None if the handler raised."""
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            return scene.step()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    except Interrupted:
        return None


def test_an_interrupted_step_happens_or_not(make_scene):
    def interrupt(*_):
        raise Interrupted

    rng = np.random.default_rng(1)
    boxes = random_boxes(6000, size=0.05)  # more than the calls that are never interrupted
    scene = make_scene()
    ids = scene.add(boxes)
    before = np.empty((0, 2), np.uint32)
    former = signal.signal(signal.SIGALRM, interrupt)
    interrupted = 0
    try:
        for step in range(40):
            moved = np.arange(len(boxes)) if step % 4 == 0 else rng.choice(len(boxes), 30, replace=False)
            boxes[moved] = random_boxes(len(moved), seed=step, size=0.05)
            scene.move(ids[moved], boxes[moved])
            # Every tenth step is certainly interrupted, and every tenth is not.
            result = step_unless_interrupted(scene, {0: 1e-6, 5: 3600}.get(step % 10, 0.004 * rng.random() + 1e-6))
            interrupted += result is None
            if result is None and np.array_equal(scene.pairs(), before):
                result = scene.step()
            now = op.find_pairs(boxes)
            assert np.array_equal(scene.pairs(), now)
            if result is not None:
                assert np.array_equal(result.began, difference(now, before))
                assert np.array_equal(result.ended, difference(before, now))
            before = now
    finally:
        signal.signal(signal.SIGALRM, former)
    assert 0 < interrupted < 40


@pytest.mark.parametrize("arrays", [0, 1])
def test_a_step_whose_arrays_do_not_fit_is_returned_by_the_next_call(make_scene, arrays):
    boxes = random_boxes(50, size=0.3)
    scene, untroubled = make_scene(), op.Scene()
    ids = scene.add(boxes)
    assert np.array_equal(untroubled.add(boxes), ids)
    for step in range(3):
        with room_for(arrays), pytest.raises(MemoryError):
            scene.step()
        calls = [lambda: scene.add(boxes), lambda: scene.move(ids, boxes), lambda: scene.sweep(ids, boxes), lambda: scene.remove(ids),
                 lambda: scene.set_traits(ids, fixed=True), scene.pairs, scene.persisting]
        for call in calls:
            with pytest.raises(op.UsageError, match="call step\\(\\) again"):
                call()
        assert len(scene) == 50 and scene.contains(ids).all()
        result, expected = scene.step(), untroubled.step()
        assert np.array_equal(result.began, expected.began) and np.array_equal(result.ended, expected.ended)
        assert result.persisting == expected.persisting
        assert np.array_equal(scene.pairs(), untroubled.pairs())
        boxes = random_boxes(50, seed=step + 2, size=0.3)
        scene.move(ids, boxes)
        untroubled.move(ids, boxes)
    assert not np.array_equal(expected.ended, np.empty((0, 2)))


def test_sweep_and_traits(make_scene):
    scene = make_scene(dtype="float64")
    wall = scene.add(np.array([[5, 0, 0, 5.1, 1, 1.0]]), fixed=True)
    ball = scene.add(np.array([[0, 0, 0, 1, 1, 1.0]]))
    assert len(scene.step().began) == 0
    scene.sweep(ball, np.array([[9, 0, 0, 10, 1, 1.0]]))
    assert scene.step().began.tolist() == [[0, 1]]
    assert scene.step().ended.tolist() == [[0, 1]]
    scene.move(ball, np.array([[5, 0, 0, 6, 1, 1.0]]))
    assert scene.step().began.tolist() == [[0, 1]]
    scene.set_traits(np.concatenate([wall, ball]), fixed=True)
    assert scene.step().ended.tolist() == [[0, 1]]
    scene.set_traits(ball)
    assert scene.step().began.tolist() == [[0, 1]]
    scene.set_traits(ball, mask=0)
    assert scene.step().ended.tolist() == [[0, 1]]


def test_refuses_wrong_calls(make_scene):
    scene = make_scene()
    ids = scene.add(random_boxes(4))
    cases = [lambda: scene.add(random_boxes(4, dtype=np.float64)), lambda: scene.move(ids, random_boxes(3)),
             lambda: scene.move(ids["index"] + 0.5, random_boxes(4)), lambda: scene.move(ids[::2], random_boxes(3)),
             lambda: scene.move(np.array([(77, 0)], op.id_dtype), random_boxes(1)),
             lambda: scene.add(random_boxes(4), groups=-1), lambda: scene.add(random_boxes(4), groups=np.array([1.5, 1, 1, 1]), copy=True),
             lambda: scene.add(random_boxes(4), mask=np.array([2**32, 1, 1, 1]), copy=True), lambda: scene.add(random_boxes(4), fixed=np.zeros(4, int)),
             lambda: scene.add(random_boxes(4), groups=np.zeros(3, np.uint32)), lambda: scene.ids([99]), lambda: scene.ids([-1]),
             lambda: make_scene(margin=-1), lambda: make_scene(dtype="int32"), lambda: scene.remove(np.concatenate([ids, ids]))]
    for case in cases:
        with pytest.raises(op.Error):
            case()
    assert len(scene) == 4 and scene.contains(ids).all()
    assert scene.add(random_boxes(4, dtype=np.float64), copy=True).shape == (4,)


@pytest.mark.parametrize("named", [lambda ids: ids["index"], lambda ids: ids["index"].tolist(), lambda ids: tuple(map(int, ids["index"])),
                                   lambda ids: ids["index"].astype(np.int64)[::-1][::-1], lambda ids: [ids[i] for i in range(len(ids))],
                                   lambda ids: np.repeat(ids, 2)[::2]])
def test_objects_are_named_by_indices_or_ids(make_scene, named):
    boxes, others = random_boxes(30, size=0.3), random_boxes(30, seed=2, size=0.3)
    scene, other = make_scene(), make_scene()
    ids = scene.add(boxes)
    assert np.array_equal(other.add(boxes), ids)
    for step in range(3):
        some, gone = ids[step:12], ids[12 + step:13 + step]
        scene.move(named(some), others[step:12])
        other.move(some, others[step:12])
        scene.sweep(named(ids[20:25]), others[20:25])
        other.sweep(ids[20:25], others[20:25])
        scene.set_traits(named(ids[25:]), fixed=True)
        other.set_traits(ids[25:], fixed=True)
        scene.remove(named(gone))
        other.remove(gone)
        assert not scene.contains(named(gone)).any() and scene.contains(named(some)).all()
        result, expected = scene.step(), other.step()
        assert np.array_equal(result.began, expected.began) and np.array_equal(result.ended, expected.ended)


def test_an_index_stands_for_the_object_that_has_it_now(make_scene):
    scene = make_scene()
    ids = scene.add(random_boxes(3))
    scene.remove(1)
    scene.remove(ids[0])
    assert scene.contains([0, 1, 2, 99]).tolist() == [False, False, True, False] and scene.contains(2).tolist() == [True]
    for call in (lambda: scene.move([2, 1], random_boxes(2)), lambda: scene.remove([2, 1]), lambda: scene.sweep((2, 1), random_boxes(2)),
                 lambda: scene.set_traits(np.array([2, 1]), fixed=True), lambda: scene.ids_at([2, 1]), lambda: scene.ids([2, 1])):
        with pytest.raises(op.InputError, match="no object has the index 1") as caught:
            call()
        assert caught.value.index == 1 and len(scene) == 1
    scene.step()
    again = scene.add(random_boxes(2))
    assert sorted(again["index"]) == [0, 1]  # as before, with other generations
    assert np.array_equal(scene.ids_at(again["index"]), again) and np.array_equal(scene.ids(again["index"].tolist()), again)
    assert scene.contains([0, 1]).all() and not scene.contains(ids[:2]).any()
    scene.move(1, random_boxes(1))
    with pytest.raises(op.InputError):
        scene.move(ids[1], random_boxes(1))


@pytest.mark.parametrize("wrong, words", [([0.0], "ids_at"), ([True, False, True], "mask"), (["a"], "ids_at"), ([-1], r"ids\[0\] is -1"),
                                          ([2**32], r"ids\[0\]"), ([[0, 1]], "shape"), (None, "NoneType"), ("a", "str"), (1.5, "number")])
def test_refuses_other_ids(make_scene, wrong, words):
    scene = make_scene()
    scene.add(random_boxes(3))
    for call in (lambda: scene.move(wrong, random_boxes(1)), lambda: scene.remove(wrong), lambda: scene.contains(wrong)):
        with pytest.raises(op.Error, match=words):
            call()


def test_scenes_end(make_scene, tmp_path):
    options = {"recording": tmp_path / "scene.rec"} if make_scene is op.Scene else {}
    with pytest.raises(KeyError):
        with make_scene(**options) as scene:
            ids = scene.add(random_boxes(50, size=0.3))
            step = scene.step()
            raise KeyError
    if options:
        op.replay(options["recording"])
    assert np.array_equal(step.began, brute_force(random_boxes(50, size=0.3)))
    scene.close()
    calls = [scene.step, scene.pairs, scene.persisting, lambda: len(scene), lambda: scene.indices, lambda: scene.add(random_boxes(1)),
             lambda: scene.move(ids, random_boxes(50)), lambda: scene.move([0], random_boxes(1)), lambda: scene.sweep(ids, random_boxes(50)),
             lambda: scene.remove(ids), lambda: scene.contains(ids), lambda: scene.contains([0]), lambda: scene.ids_at([0]),
             lambda: scene.set_traits(ids, fixed=True)]
    if options:
        calls += [scene.boxes, scene.octants, scene.verify, scene.enlarged_pairs, lambda: scene.nearest([0, 0, 0]),
                  lambda: scene.overlaps([0, 0, 0, 1]), lambda: scene.first_hits([0, 0, 0], [1, 0, 0])]
    for call in calls:
        with pytest.raises(op.UsageError, match="the scene is closed"):
            call()
    assert repr(scene).endswith("Scene(closed, dtype='float32', margin=0)")


def test_queries_are_equal_to_brute_force():
    rng = np.random.default_rng(3)
    boxes = random_boxes(500, dtype=np.float64)
    groups = rng.integers(1, 4, 500, dtype=np.uint32)
    scene = op.Scene(dtype="float64")
    ids = scene.add(boxes, groups=groups)
    scene.step()
    queries = random_boxes(3000, 9, np.float64, 0.2)
    answers = scene.overlaps(queries, groups=2)
    expected = brute_force(queries, boxes)
    expected = expected[groups[expected[:, 1]] & 2 != 0]
    assert np.array_equal(answers.indices, expected[:, 1])
    assert np.array_equal(np.repeat(np.arange(3000), answers.counts), expected[:, 0])
    assert len(answers) == 3000 and np.array_equal(answers[-1], expected[expected[:, 0] == 2999, 1])
    points = rng.random((50, 3)).astype(np.float32)
    gaps = np.maximum(np.maximum(boxes[None, :, :3] - points[:, None], points[:, None] - boxes[None, :, 3:]), 0)
    distances = np.linalg.norm(gaps, axis=2)
    nearest = scene.nearest(points, k=4)
    assert np.array_equal(nearest.counts, np.full(50, 4))
    assert np.allclose(nearest.distances.reshape(50, 4), np.sort(distances, axis=1)[:, :4])
    assert (scene.nearest(points, k=500, within=0.1).counts == (distances <= 0.1).sum(axis=1)).all()
    balls = np.hstack([points, np.full((50, 1), 0.1)])
    assert np.array_equal(scene.overlaps(balls).counts, (distances <= 0.1).sum(axis=1))
    directions = rng.standard_normal((50, 3))
    first, hits = scene.first_hits(points, directions), scene.all_hits(points, directions)
    for ray in range(50):
        with np.errstate(divide="ignore"):
            at = np.sort((boxes.reshape(-1, 2, 3) - points[ray]) / directions[ray], axis=1)
        begin, end = at[:, 0].max(axis=1).clip(0), at[:, 1].min(axis=1)
        inside = np.flatnonzero(begin <= end)
        assert set(hits[ray]) >= set(inside) and len(hits[ray]) - len(inside) <= 1
        along = hits.along[hits.offsets[ray]:hits.offsets[ray + 1]]
        assert np.all(np.diff(along) >= 0)
        assert first[ray].tolist() == hits[ray][:1].tolist()
    assert len(scene.first_hits(points, directions, longest=0.0).indices) == sum(distances.min(axis=1) == 0)
    assert scene.overlaps(np.array([0, 0, 0, 1, 1, 1.0])).counts.tolist() == [500]
    assert len(scene.overlaps(np.empty((0, 6)))) == 0
    with pytest.raises(op.InputError) as caught:
        scene.overlaps(np.vstack([queries, np.full((1, 6), np.nan)]))
    assert caught.value.index == 3000
    scene.remove(ids)
    assert scene.nearest(points, k=3).counts.sum() == 0


@pytest.mark.parametrize("call", [lambda s: s.overlaps(np.zeros((2, 5))), lambda s: s.nearest(np.zeros((2, 2))),
                                  lambda s: s.nearest(np.zeros((2, 3)), k=-1), lambda s: s.nearest(np.zeros((2, 3)), within=-1.0),
                                  lambda s: s.first_hits(np.zeros((2, 3)), np.zeros((2, 3))), lambda s: s.overlaps("x"), lambda s: s.first_hits(np.zeros((2, 3)), np.ones((2, 3)), longest=None),
                                  lambda s: s.first_hits(np.zeros((2, 3)), np.ones((3, 3))), lambda s: s.overlaps(np.zeros((2, 6), "O")),
                                  lambda s: s.nearest(np.zeros((2, 3)), k=1.5), lambda s: s.overlaps(np.zeros((2, 6)), groups="a")])
def test_refuses_wrong_queries(call):
    scene = op.Scene()
    with pytest.raises(op.Error):
        call(scene)


def test_verifies_directly_after_a_step():
    scene = op.Scene()
    with pytest.raises(op.UsageError):
        scene.verify()
    ids = scene.add(random_boxes(300))
    scene.step()
    scene.verify()
    scene.sweep(ids[:5], random_boxes(5, seed=2))
    with pytest.raises(op.UsageError):
        scene.verify()
    scene.step()
    scene.verify()


def test_recording_and_slack(tmp_path):
    path = tmp_path / "scene.rec"
    scene = op.Scene(recording=path, slack=0.01)
    boxes = random_boxes(300)
    ids = scene.add(boxes)
    for step in range(5):
        boxes += np.float32(0.001)
        scene.move(ids, boxes)
        scene.step()
        assert np.array_equal(scene.pairs(), brute_force(boxes))
        enlarged = set(map(tuple, scene.enlarged_pairs()))
        assert enlarged >= set(map(tuple, scene.pairs()))
    del scene
    op.replay(path)
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(op.InputError):
        op.replay(path)
