"""Tables of collisions: a mapping of columns, rows, pandas. And copies of results, also through pickle."""
import builtins
import collections.abc
import copy
import json
import pickle

import numpy as np
import pandas
import pytest
from conftest import random_boxes
from test_shapes import CUBE_FACES, CUBE_VERTICES, cube_mesh

import octopair as op

COLUMNS = ["a", "b", "class", "distance", "depth", "depth_kind", "depth_at_most", "thickness", "thickness_kind", "time", "contacts"]


@pytest.fixture(scope="module")
def shapes():
    """Cubes, some of them open, and balls, in one heap."""
    rng = np.random.default_rng(1)
    geometries = [op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES), op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES[:-1]), op.Geometry.sphere(1)]
    places = np.vstack([rng.random((29, 3)) * 8, [[90, 0, 0]]])
    return op.Shapes(geometries, op.make_poses(places), np.arange(30) % 3, names=[f"part {i}" for i in range(30)])


@pytest.fixture(scope="module")
def table(shapes):
    found = op.collide(shapes, margin=0.5, max_contacts=3)
    assert len(found) > 20 and len(set(found.class_)) > 1 and len(found.contact_depths) > 20 and found.more_contacts.any()
    return found


def test_a_table_is_a_mapping_of_columns(table, shapes):
    names = [*COLUMNS[:2], "name_a", "name_b", *COLUMNS[2:]]
    assert list(table) == list(table.keys()) == names and len(table) == len(table.pairs)
    assert isinstance(table, collections.abc.Mapping)
    with pytest.raises(TypeError, match="not JSON serializable"):
        json.dumps(table)
    assert table
    columns = dict(table)
    assert list(columns) == names and columns.keys() == table.keys() == {**table}.keys() == table.columns().keys()
    for name, column in table.items():
        assert len(column) == len(table) and column.ndim == 1
        for other in (table[name], columns[name], table.get(name), dict(zip(table, table.values()))[name], table.columns()[name]):
            assert np.array_equal(other, column)
    assert np.array_equal(table["a"], table.pairs[:, 0]) and np.array_equal(table["depth"], table.depth)
    assert np.array_equal(table["contacts"], np.diff(table.contact_offsets))
    assert table["name_b"].tolist() == [shapes.names[b] for b in table.b]
    assert set(table["depth_kind"]) <= set(op.DEPTH_KINDS) and np.array_equal(np.array(op.DEPTH_KINDS)[table.depth_kind], table["depth_kind"])
    assert set(table["thickness_kind"]) == {"unknown"}  # no tolerance
    touching = op.collide(shapes, tolerance=1)
    assert set(touching["thickness_kind"]) <= set(op.THICKNESS_KINDS) and touching.thickness[touching["thickness_kind"] == "at_most"].max() <= 1
    assert table["nearest"] is not None and np.array_equal(table["pairs"], table.pairs)  # further arrays
    assert "depth" in table and "pairs" in table and "nonsense" not in table and "names" not in table and 0 not in table and table
    assert table.get("nonsense") is None and table.get("nonsense", 3) == 3
    with pytest.raises(KeyError, match="no column 'nonsense'; there are a, b, name_a"):
        table["nonsense"]
    assert list(op.collide(op.Shapes(shapes.geometries, shapes.poses[:3]))) == COLUMNS
    batches = []
    op.Pipeline().keep(lambda batch: batches.append(list(batch)) or batch["a"] >= 0).run(np.zeros((9, 6)))
    assert batches[0] == COLUMNS


def test_rows(table):
    rows = table.to_dicts()
    assert len(rows) == len(table)
    for i, row in enumerate(rows):
        assert table[i] == row and table[np.int64(i)] == row and table[i - len(table)] == row
        contacts = row["contacts"]
        for name in table:
            if name != "contacts":
                assert row[name] == table[name][i] and type(row[name]) in (int, float, str)
        where = table.contacts(i)
        assert len(contacts) == table["contacts"][i] == where.stop - where.start
        for contact, k in zip(contacts, range(where.start, where.stop)):
            assert contact["point"] == table.contact_points[k].tolist() and contact["normal"] == table.contact_normals[k].tolist()
            assert contact["depth"] == table.contact_depths[k]
            assert contact["features"] == [None if f == 0xFFFFFFFF else f for f in table.contact_features[k].tolist()]
        assert row["nearest"] == table.nearest[i].tolist() and row["open"] == table.open[i].tolist()
        assert row["more_contacts"] == table.more_contacts[i]
    assert json.loads(json.dumps(rows)) == rows
    for wrong in (len(table), -len(table) - 1):
        with pytest.raises(IndexError, match="row"):
            table[wrong]
    for wrong in (slice(0, 2), 1.5, None, np.ones(len(table), bool), [0, 1], ("a", "b")):
        with pytest.raises(op.InputTypeError, match="neither the name of a column nor the number of a row"):
            table[wrong]


def test_a_table_does_not_change(table):
    before = table.columns()
    calls = [lambda: table.update(a=1), lambda: table.__setitem__("a", 1), lambda: table.__delitem__("a"), lambda: table.pop("a"),
             table.popitem, table.clear, lambda: table.setdefault("x", 1), lambda: table.__ior__({"a": 1})]
    for call in calls:
        with pytest.raises(TypeError, match="does not change"):
            call()
    with pytest.raises(AttributeError):
        table.depth = None
    row = table[0]
    row["a"] = 77
    assert table[0]["a"] == before["a"][0] and all(np.array_equal(table[name], before[name]) for name in table)
    assert (table == table) is True and (table != table) is False and hash(table) and table != copy.copy(table)
    assert list(table | {"x": 1}) == [*table, "x"] and list({"x": 1} | table) == ["x", *table] and list(table.copy()) == list(table)


def test_a_table_becomes_a_data_frame(table):
    frame = pandas.DataFrame(table)
    assert frame.columns.tolist() == list(table) and len(frame) == len(table)
    for name in table:
        assert frame[name].tolist() == table[name].tolist()
    assert table.to_pandas().equals(frame)
    assert pandas.DataFrame(table, columns=["depth", "a"]).equals(frame[["depth", "a"]])
    assert frame.groupby("class")["depth"].max().max() == table.depth.max()
    contacts = table.to_pandas(contacts=True)
    assert len(contacts) == len(table.contact_depths) and contacts.groupby("row").size().reindex(range(len(table)), fill_value=0).tolist() == \
        table["contacts"].tolist()
    assert np.array_equal(contacts[["x", "y", "z"]], table.contact_points) and np.array_equal(contacts["depth"], table.contact_depths)
    assert np.array_equal(contacts[["normal_x", "normal_y", "normal_z"]], table.contact_normals)
    assert np.array_equal(contacts[["feature_a", "feature_b"]], table.contact_features)
    assert np.array_equal(contacts[["a", "b"]], table.pairs[contacts["row"]])
    empty = op.collide(op.Shapes([], np.empty((0, 4, 4))))
    assert pandas.DataFrame(empty).shape == (0, len(COLUMNS)) and empty.to_dicts() == [] and len(empty.to_pandas(contacts=True)) == 0 and not empty


def test_pandas_may_be_missing(table, monkeypatch):
    normal = builtins.__import__

    def without(name, *arguments, **keywords):
        if name == "pandas":
            raise ImportError("No module named 'pandas'")
        return normal(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(op.UsageError, match="to_pandas.. needs pandas"):
        table.to_pandas()


def copies(value):
    """Returns copies of a value: copied, deeply copied, and through pickle with each protocol."""
    return [copy.copy(value), copy.deepcopy(value), *(pickle.loads(pickle.dumps(value, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1))]


def equal(a, b):
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(equal(getattr(a, name), getattr(b, name)) for name in a.__dataclass_fields__)
    return a == b


def test_results_can_be_copied_and_pickled(table):
    boxes = random_boxes(50, size=0.3)
    scene = op.Scene()
    scene.add(boxes)
    job = op.Engine().submit(boxes).result()
    results = [scene.step(), job, job.summary, table, table.summary, scene.overlaps(boxes), scene.nearest(boxes, k=3), op.list_octants(boxes),
               scene.octants(), scene.first_hits(np.zeros((3, 3)), np.ones((3, 3))), op.OctalCode("{3,1,4}"), op.OctalCode()]
    for result in results:
        for other in copies(result):
            assert equal(result, other) and repr(result) == repr(other)
    assert np.array_equal(copy.deepcopy(results[7]).levels, results[7].levels)


@pytest.mark.parametrize("make", [
    lambda: op.Geometry.sphere(0.1), lambda: op.Geometry.box([0.1, 0.2, 0.3]), lambda: op.Geometry.capsule(0.1, 0.3),
    lambda: op.Geometry.cylinder(0.1, 0.3), lambda: op.Geometry.cone(0.1, 0.3), lambda: op.Geometry.ellipsoid([0.1, 0.2, 0.3]),
    lambda: op.Geometry.plane([0.1, 0.2, 0.3], 0.7), lambda: op.Geometry.hull(random_boxes(9)[:, :3]),
    lambda: op.Geometry.mesh(CUBE_VERTICES / 3, CUBE_FACES), lambda: op.Geometry.mesh(CUBE_VERTICES, CUBE_FACES[1:]),
    lambda: op.Geometry.mesh(CUBE_VERTICES[CUBE_FACES].reshape(-1, 3) + np.linspace(0, 1e-3, 36)[:, None], np.arange(36).reshape(12, 3), weld=0.01)])
def test_geometries_can_be_copied_and_pickled(make):
    geometry, ball = make(), op.Geometry.sphere(0.3)
    poses = op.make_poses([[0, 0, 0], [0.2, 0.1, 0.15]])
    expected = op.collide(op.Shapes([geometry, ball], poses), margin=5).to_dicts()
    assert len(expected) == 1
    for other in copies(geometry):
        assert other.kind == geometry.kind and other.closed == geometry.closed and repr(other) == repr(geometry)
        assert op.collide(op.Shapes([other, ball], poses), margin=5).to_dicts() == expected


def test_shapes_can_be_copied_and_pickled(shapes, table):
    moving = op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0], [10, 0, 0]]), [0, 0], end_poses=op.make_poses(np.zeros((2, 3))),
                       padding=[0.1, 0.2])
    for original in (shapes, moving, op.Shapes.from_trimesh(cube_mesh()), op.Shapes([], [])):
        for other in copies(original):
            assert len(other) == len(original) and other.names == original.names
            for name in ("poses", "geometry", "end_poses", "padding"):
                one, two = getattr(original, name), getattr(other, name)
                assert (one is None and two is None) or (np.array_equal(one, two) and not two.flags.writeable)
            assert np.array_equal(original.boxes(), other.boxes())
            assert op.collide(other, margin=0.5, max_contacts=3).to_dicts() == op.collide(original, margin=0.5, max_contacts=3).to_dicts()
    first, second = pickle.loads(pickle.dumps((shapes, shapes.geometries[0])))
    assert first.geometries[0] is second  # shared geometries stay shared


@pytest.mark.parametrize("make", [op.Engine, op.Scene, op.Pipeline, lambda: op.Engine().submit(np.zeros((2, 6)))])
def test_what_runs_is_not_pickled(make):
    with pytest.raises(TypeError, match="cannot pickle"):
        pickle.dumps(make())


@pytest.mark.parametrize("kind", [op.Error, op.UsageError, op.InputError, op.InputTypeError, op.FileError, op.ResourceLimitError, op.EngineError,
                                  op.CancelledError])
def test_errors_are_named_and_pickled_as_users_see_them(kind):
    assert repr(kind) == f"<class 'octopair.{kind.__name__}'>"
    for error in (kind("a message", 3, 1), kind("a message")):
        for other in copies(error):
            assert type(other) is kind and str(other) == "a message" and (other.index, other.set, other.code) == (error.index, error.set, error.code)
