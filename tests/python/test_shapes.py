"""Shapes, filters and self-intersections."""
import time
import types

import numpy as np
import pytest
from conftest import brute_force, random_boxes
from scipy.spatial.transform import Rotation

import octopair as op

CUBE_VERTICES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
CUBE_FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                       [1, 5, 7], [1, 7, 3]])


def cube_mesh():
    return types.SimpleNamespace(vertices=CUBE_VERTICES, faces=CUBE_FACES)


class Scene:
    """The interface of trimesh.Scene that octopair uses."""

    def __init__(self, placed):
        self.geometry = {"cube": cube_mesh(), "path": types.SimpleNamespace(vertices=CUBE_VERTICES)}
        matrices = {name: (matrix, "cube") for name, matrix in placed.items()}
        matrices["line"] = (np.eye(4), "path")

        class Graph(dict):
            nodes_geometry = list(matrices)

        self.graph = Graph(matrices)


def test_spheres_are_equal_to_brute_force():
    rng = np.random.default_rng(1)
    places, radii = rng.random((150, 3)) * 10, rng.choice([0.25, 0.5, 1.0], 150)
    shapes = op.Shapes([op.Geometry.sphere(r) for r in (0.25, 0.5, 1.0)], op.make_poses(places),
                       np.searchsorted([0.25, 0.5, 1.0], radii))
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) - radii[:, None] - radii[None]
    for margin in (0.0, 0.3):
        table = op.collide(shapes, margin=margin, max_contacts=1)
        assert np.array_equal(table.pairs, np.argwhere(np.triu(apart <= margin, 1)))
        expected = apart[table.a, table.b]
        meets = expected <= 0
        assert np.array_equal(table.class_ == "clearance", ~meets)
        assert np.allclose(table.depth[meets & (table.class_ == "penetrating")], -expected[meets & (table.class_ == "penetrating")])
        assert np.allclose(table.distance[~meets], expected[~meets])
        assert np.allclose(np.linalg.norm(np.diff(table.nearest, axis=1)[~meets, 0], axis=1), expected[~meets])
        # An object within another has no contacts.
        assert np.array_equal(np.diff(table.contact_offsets), (table.class_ == "penetrating").astype(int))
        assert table.summary.collisions == len(table) and sum(table.summary.of_class.values()) == len(table)
    half = op.Shapes(shapes.geometries, shapes.poses[:75], shapes.geometry[:75])
    rest = op.Shapes(shapes.geometries, shapes.poses[75:], shapes.geometry[75:], padding=0.1)
    assert np.array_equal(op.collide(half, rest, margin=0.2).pairs, np.argwhere(apart[:75, 75:] <= 0.2 + 0.1))
    assert np.array_equal(op.collide(half, rest, stage="objects").pairs, np.argwhere(apart[:75, 75:] <= 0.1))


def test_every_kind_of_shape():
    kinds = [op.Geometry.sphere(1), op.Geometry.box([1, 1, 1]), op.Geometry.capsule(1, 1), op.Geometry.cylinder(1, 2),
             op.Geometry.cone(1, 2), op.Geometry.ellipsoid((1, 1, 1)), op.Geometry.hull(CUBE_VERTICES),
             op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES), op.Geometry.plane([0, 0, 1], 0)]
    shapes = op.Shapes(kinds, op.make_poses(np.zeros((9, 3))))
    assert len(op.collide(shapes)) == 9 * 8 // 2
    apart = op.Shapes(kinds[:8], op.make_poses(np.arange(8)[:, None] * [3.0, 0, 0]))
    assert len(op.collide(apart)) == 0 and len(op.collide(apart, margin=1.5)) == 7
    assert all(kind.closed for kind in kinds) and [kind.kind for kind in kinds][:2] == ["sphere", "box"]
    assert not op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES[:-1]).closed


def test_moving_objects_have_a_time_of_impact():
    balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0], [10, 0, 0]]), [0, 0],
                      end_poses=op.make_poses([[0, 0, 0], [0, 0, 0]]))
    table = op.collide(balls)
    assert np.isclose(table.time[0], 0.8, atol=1e-6)


def test_from_trimesh():
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    turned[0, 3] = 2.2
    far = np.eye(4)
    far[0, 3] = 50
    shapes = op.Shapes.from_trimesh(Scene({"a": np.eye(4), "b": turned, "c": far}))
    assert shapes.names == ["a", "b", "c"] and len(shapes.geometries) == 1
    table = op.collide(shapes, margin=0.05, max_contacts=16)
    assert table.pairs.tolist() == [[0, 1]] and table["class"].tolist() == ["penetrating"]
    assert np.isclose(table.depth[0], 1 + np.sqrt(2) - 2.2)
    assert 1 <= len(table.contact_points) <= 16 and table.columns()["name_b"].tolist() == ["b"]
    assert np.allclose(np.linalg.norm(table.contact_normals, axis=1), 1)
    assert len(op.collide(cube_mesh(), op.Shapes.from_trimesh(Scene({"a": np.eye(4)})))) == 1
    with pytest.raises(TypeError):
        op.Shapes.from_trimesh(3)


def test_self_intersections():
    vertices = np.vstack([CUBE_VERTICES, CUBE_VERTICES + [1.5, 0.3, 0.2]])
    faces = np.vstack([CUBE_FACES, CUBE_FACES + 8])
    pairs = op.self_intersections(vertices, faces)
    assert len(pairs) and (pairs[:, 0] < 12).all() and (pairs[:, 1] >= 12).all()
    assert len(op.self_intersections(CUBE_VERTICES, CUBE_FACES)) == 0
    assert len(op.self_intersections(CUBE_VERTICES, CUBE_FACES, adjacent="include")) > 20
    table = op.self_intersections(vertices.astype(np.float32), faces.astype(np.uint16), features=True)
    assert table.pairs.tolist() == pairs.tolist() and (table.class_ == "penetrating").any()
    assert op.self_intersections(np.empty((0, 3)), np.empty((0, 3), int)).shape == (0, 2)
    for wrong in ([[0, 1, 16]], [[-1, 0, 1]], [[0, 1]], [[0.5, 1, 2]]):
        with pytest.raises(op.Error):
            op.self_intersections(CUBE_VERTICES, wrong)


def test_filters():
    boxes = random_boxes(400, size=0.3)
    all_pairs = brute_force(boxes)
    a, b = all_pairs.T
    rng = np.random.default_rng(2)
    groups, masks = rng.integers(1, 8, 400, dtype=np.uint32), rng.integers(0, 8, 400, dtype=np.uint32)
    parents = np.arange(400) // 7
    names = [f"{'pipe' if i % 3 else 'wall'}{i}" for i in range(400)]
    is_wall = np.array([name.startswith("wall") for name in names])
    cases = [
        (op.Pipeline().groups(groups, masks), (groups[a] & masks[b] != 0) & (groups[b] & masks[a] != 0)),
        (op.Pipeline().parents(parents), parents[a] != parents[b]),
        (op.Pipeline().ignored_pairs(all_pairs[::2, ::-1]), np.arange(len(all_pairs)) % 2 == 1),
        (op.Pipeline().name_rules(names, [("wall*", "wall*")]), ~(is_wall[a] & is_wall[b])),
        (op.Pipeline().column_rules({"name": names, "parity": ["odd" if i % 2 else "" for i in range(400)]},
                                    [({"name": "wall*", "parity": "odd"}, {"name": "pipe*"})]),
         ~((is_wall[a] & (a % 2 == 1) & ~is_wall[b]) | (is_wall[b] & (b % 2 == 1) & ~is_wall[a]))),
        (op.Pipeline().keep(lambda batch: (batch.a + batch.b) % 2 == 0, name="even"), (a + b) % 2 == 0),
    ]
    for pipeline, kept in cases:
        found = pipeline.run(boxes)
        assert np.array_equal(found.pairs, all_pairs[kept])
        assert found.summary.filters[0].pairs_in == len(all_pairs) and found.summary.filters[0].pairs_out == kept.sum()
        assert pipeline.count(boxes).collisions == kept.sum()
        batches = []
        rest = pipeline.run(boxes, sink=batches.append, engine=op.Engine("processes", workers=2))
        assert len(rest) == 0 and np.array_equal(np.vstack([batch.pairs for batch in batches]), all_pairs[kept])
        limited = pipeline.run(boxes, limit=5)
        assert np.array_equal(limited.pairs, all_pairs[kept][:5]) and limited.summary.truncated
    assert repr(op.Pipeline().parents(parents).keep(np.ones)) == "Pipeline(same parent > ones)"


def test_filters_see_findings_and_join():
    balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses(np.arange(6)[:, None] * [1.5, 0, 0]), np.zeros(6, int))
    deep = op.Pipeline().exact_objects(balls).exact_features(balls).keep(lambda batch: batch.depth > 0.4)
    assert len(deep.run(balls.boxes())) == 5
    assert len(op.Pipeline().exact_objects(balls).exact_features(balls).min_depth(0.6).run(balls.boxes())) == 0
    boxes, others = random_boxes(100, 1, size=0.4), random_boxes(80, 2, size=0.4)
    pairs = brute_force(boxes, others)
    even, third = np.arange(100) % 2, np.arange(80) % 3
    found = op.Pipeline().parents(even, third).run(boxes, others)
    assert np.array_equal(found.pairs, pairs[even[pairs[:, 0]] != third[pairs[:, 1]]])


@pytest.mark.parametrize("answer", [lambda b: np.ones(3, bool), lambda b: np.ones(len(b)), lambda b: None, lambda b: b.a])
def test_refuses_other_answers_of_filters(answer):
    with pytest.raises(TypeError):
        op.Pipeline().keep(answer).run(random_boxes(200, size=0.4))


def test_exceptions_of_callbacks_propagate():
    def fail(batch):
        raise KeyError("mine")

    boxes = random_boxes(200, size=0.4)
    with pytest.raises(KeyError, match="mine"):
        op.Pipeline().keep(fail).run(boxes)
    with pytest.raises(KeyError, match="mine"):
        op.Pipeline().run(boxes, sink=fail)
    with pytest.raises(KeyError, match="mine"):
        op.find_pairs(boxes, progress=fail)
    assert len(op.Pipeline().run(boxes)) == len(brute_force(boxes))


@pytest.mark.parametrize("make", [
    lambda: op.Geometry.sphere(-1), lambda: op.Geometry.sphere("a"), lambda: op.Geometry.box([1, 1]), lambda: op.Geometry.hull([]),
    lambda: op.Geometry.mesh(CUBE_VERTICES, [[0, 1, 99]]), lambda: op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES.astype(float)),
    lambda: op.Geometry.plane([0, 0, 0], 1), lambda: op.Shapes([op.Geometry.sphere(1)], np.eye(4)),
    lambda: op.Shapes([op.Geometry.sphere(1)], [np.eye(4) * 2]), lambda: op.Shapes([op.Geometry.sphere(1)], [np.diag([2, 2, 2, 1])]),
    lambda: op.Shapes([op.Geometry.sphere(1)], [np.eye(4)], [1]), lambda: op.Shapes([3], [np.eye(4)]),
    lambda: op.Shapes([op.Geometry.sphere(1)], [np.eye(4)], names=["a", "b"]), lambda: op.make_poses([[0, 0]]),
    lambda: op.make_poses([[0, 0, 0]], [[0, 0, 0, 0]]), lambda: op.Pipeline().exact_objects(3), lambda: op.Pipeline().parents(["a"]),
    lambda: op.collide(op.Shapes([], np.empty((0, 4, 4))), stage="pairs"), lambda: op.Pipeline().keep(3),
    lambda: op.Pipeline().run(np.zeros((2, 6)), engine="local"), lambda: op.Pipeline().groups([1], [1, 2])])
def test_refuses_wrong_shapes(make):
    with pytest.raises(op.Error):
        make()


def test_filters_refuse_boxes_without_shapes():
    balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses(np.zeros((4, 3))), np.zeros(4, int))
    for add in (lambda p: p.exact_objects(balls), lambda p: p.oriented_boxes(balls), lambda p: p.bounding_spheres(balls)):
        assert add(op.Pipeline()).count(np.zeros((4, 6))).collisions == 6
        with pytest.raises(op.InputError, match="5 objects, but shapes of 4"):
            add(op.Pipeline()).run(np.zeros((5, 6)))
        with pytest.raises(op.UsageError, match="second set"):
            add(op.Pipeline()).run(np.zeros((4, 6)), np.zeros((4, 6)))
    joined = op.Pipeline().exact_objects(balls, balls)
    assert joined.count(np.zeros((4, 6)), np.zeros((4, 6))).collisions == 16
    for boxes in ((np.zeros((4, 6)), np.zeros((5, 6))), (np.zeros((5, 6)), np.zeros((4, 6)))):
        with pytest.raises(op.InputError):
            joined.run(*boxes)
    with pytest.raises(op.UsageError):
        joined.run(np.zeros((4, 6)))


def test_callbacks_may_not_use_what_calls_them():
    zeros = np.zeros((5, 6))
    engine, pipeline = op.Engine(), op.Pipeline()
    calls = [lambda: op.Pipeline().keep(lambda b: engine.find_pairs(zeros)).run(zeros, engine=engine),
             lambda: op.Pipeline().run(zeros, engine=engine, sink=lambda b: engine.find_pairs(zeros)),
             lambda: pipeline.run(zeros, sink=lambda b: pipeline.run(zeros)),
             lambda: pipeline.run(zeros, sink=lambda b: pipeline.parents(np.arange(5))),
             lambda: pipeline.run(zeros, sink=lambda b: pipeline.min_depth(0)),
             lambda: op.Pipeline().keep(lambda b: engine.submit(zeros)).run(zeros, engine=engine),
             lambda: op.Pipeline().keep(lambda b: engine.stream_pairs(zeros)).run(zeros, engine=engine)]
    for call in calls:
        with pytest.raises(op.UsageError, match="callback"):
            call()
    assert pipeline.count(zeros, engine=engine).collisions == 10
    other = op.Engine()
    assert len(op.Pipeline().keep(lambda b: np.full(len(b), other.count_pairs(zeros) == 10)).run(zeros, engine=engine)) == 10


def test_batches_of_slow_callables_are_large():
    sizes = []
    boxes = np.zeros((100, 6))

    def slow(batch):
        sizes.append(len(batch))
        time.sleep(0.002)
        return batch.a >= 0

    assert len(op.Pipeline().keep(slow).run(boxes)) == 4950
    assert sum(sizes) == 4950 and len(sizes) <= 4950 // 256 + 1


def test_tables_are_right_at_their_edges():
    ball = op.Geometry.sphere(1)
    named, plain = op.Shapes([ball], op.make_poses([[0, 0, 0]]), names=["a"]), op.Shapes([ball] * 2, op.make_poses([[1, 0, 0], [1, 0, 1]]))
    columns = op.collide(named, plain).columns()
    assert columns["name_a"].tolist() == ["a", "a"] and "name_b" not in columns
    assert op.collide(plain, named).columns()["name_b"].tolist() == ["a", "a"]
    table = op.collide(plain)
    assert table.contacts(-1) == table.contacts(0) == slice(0, 1) and (table == table) is True and hash(table)
    for wrong in (lambda: table.contacts(1), lambda: table["nonsense"], lambda: table[1], lambda: table[-2]):
        with pytest.raises(LookupError):
            wrong()
    with pytest.raises(ValueError):
        plain.poses[0] = 0
    for wrong in (lambda: op.Shapes([ball], op.make_poses([[0, 0, 0]]), end_poses=np.empty((0, 4, 4))),
                  lambda: op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES, weld=-1), lambda: op.Shapes(ball, op.make_poses([[0, 0, 0]])),
                  lambda: op.self_intersections(CUBE_VERTICES, CUBE_FACES, tolerance=np.nan), lambda: op.Geometry(1, "x"),
                  lambda: op.Pipeline().bounding_spheres(None), lambda: op.Pipeline().groups([1], [1], against=3),
                  lambda: op.Pipeline().column_rules(3, []), lambda: op.Pipeline().column_rules({"n": None}, []),
                  lambda: op.Pipeline().column_rules({}, []), lambda: op.Pipeline().column_rules({"n": "abc"}, []),
                  lambda: op.Pipeline().column_rules({"n": ["a"]}, None), lambda: op.Pipeline().column_rules({"n": ["a"]}, [], against=3),
                  lambda: op.Pipeline().name_rules(None, []), lambda: op.Pipeline().name_rules("abc", []),
                  lambda: op.Pipeline().name_rules(["\ud800"], []), lambda: op.Pipeline().name_rules(["a"], 3), lambda: plain.boxes(3),
                  lambda: op.Pipeline().column_rules({"n": ["a"]}, [({"x": "a"}, {})]), lambda: op.Pipeline().column_rules({"n": ["a"]}, [3]),
                  lambda: op.Pipeline().column_rules({"n": ["a"], "m": []}, []), lambda: op.Pipeline().column_rules({"n": [1]}, []),
                  lambda: op.Pipeline().column_rules({"n": ["a"]}, [], against={"m": ["a"]}), lambda: op.Pipeline().name_rules([1], []), lambda: op.Pipeline().name_rules(["a"], [("a",)]),
                  lambda: op.Pipeline().run(np.zeros((2, 6)), sink=5), lambda: op.Geometry.sphere(10**400)):
        with pytest.raises(op.Error):
            wrong()
    assert len(op.collide(op.Shapes((shape for shape in [ball] * 2), op.make_poses(np.zeros((2, 3)))))) == 1
