"""octopair.trimesh.CollisionManager: the methods and return values of trimesh.collision."""
import numpy as np
import pytest
from test_shapes import CUBE_FACES, CUBE_VERTICES, Scene, cube_mesh

import octopair as op
from octopair.trimesh import CollisionManager, scene_to_collision


def at(x, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


@pytest.fixture
def manager():
    made = CollisionManager()
    for name, x in (("a", 0), ("b", 1.5), ("c", 10)):
        made.add_object(name, cube_mesh(), at(x))
    return made


def test_internal_collisions(manager):
    assert manager.in_collision_internal() is True
    assert manager.in_collision_internal(return_names=True) == (True, {("a", "b")})
    hit, contacts = manager.in_collision_internal(return_data=True)
    assert hit and contacts and contacts[0].names == {"a", "b"}
    hit, names, contacts = manager.in_collision_internal(return_names=True, return_data=True)
    assert names == {("a", "b")} and contacts[0].point.shape == (3,) and np.isclose(np.linalg.norm(contacts[0].normal), 1)
    assert 0 <= contacts[0].index("a") < 12 and 0 <= contacts[0].index("b") < 12
    manager.set_transform("b", at(5))
    assert manager.in_collision_internal(return_names=True) == (False, set())
    manager.remove_object("a")
    assert manager.in_collision_internal() is False


def test_single_and_other(manager):
    assert manager.in_collision_single(cube_mesh(), at(3.4), return_names=True) == (True, {"b"})
    hit, names, contacts = manager.in_collision_single(cube_mesh(), at(3.4), return_names=True, return_data=True)
    assert hit and contacts[0].names == {"b", "__external"}
    assert manager.in_collision_single(cube_mesh(), at(6)) is False
    other = CollisionManager()
    other.add_object("x", cube_mesh(), at(0.75))
    other.add_object("y", cube_mesh(), at(11))
    assert manager.in_collision_other(other, return_names=True) == (True, {("a", "x"), ("b", "x"), ("c", "y")})
    assert other.in_collision_other(manager, return_names=True)[1] == {("x", "a"), ("x", "b"), ("y", "c")}


def test_distances(manager):
    manager.set_transform("b", at(5))
    assert manager.min_distance_internal() == 3.0
    distance, names, data = manager.min_distance_internal(return_names=True, return_data=True)
    assert (distance, names, data.distance, data.names) == (3.0, ("a", "b"), 3.0, {"a", "b"})
    assert data.point("a")[0] == 1 and data.point("b")[0] == 4
    assert manager.min_distance_internal("c", return_names=True) == (3.0, ("b", "c"))
    manager.set_transform("c", at(1e4))
    assert manager.min_distance_internal("c") == 1e4 - 7
    assert manager.min_distance_single(cube_mesh(), at(0, 7, 0), return_name=True) == (5.0, "a")
    data = manager.min_distance_single(cube_mesh(), at(0, 7, 0), return_data=True)[1]
    assert data.point("a")[1] == 1 and data.point("__external")[1] == 6
    other = CollisionManager()
    other.add_object("x", cube_mesh(), at(5, 0, 12))
    assert manager.min_distance_other(other, return_names=True) == (10.0, ("b", "x"))


def test_penetration_is_negative(manager):
    table = op.collide(op.Shapes.from_trimesh(Scene({"a": at(0), "b": at(1.5)})))
    distance, names = manager.min_distance_internal(return_names=True)
    assert distance == -table.depth[0] and np.isclose(distance, -0.5) and names == ("a", "b")
    assert np.isclose(manager.min_distance_single(cube_mesh(), at(10.5)), -1.5)
    manager.set_transform("b", at(2))
    assert manager.min_distance_internal() == 0


def test_distances_are_those_of_all_pairs():
    rng = np.random.default_rng(4)
    for _ in range(10):
        count = int(rng.integers(2, 30))
        manager, spheres = CollisionManager(), []
        places = rng.random((count, 3)) * 40
        sizes = rng.random(count) * 0.4 + 0.1
        for i in range(count):
            mesh = type("Mesh", (), {"vertices": CUBE_VERTICES * sizes[i], "faces": CUBE_FACES})
            manager.add_object(str(i), mesh, at(*places[i]))
            spheres.append(np.concatenate([places[i] - sizes[i], places[i] + sizes[i]]))
        boxes = np.array(spheres)
        gaps = np.maximum(boxes[:, None, :3] - boxes[None, :, 3:], boxes[None, :, :3] - boxes[:, None, 3:]).clip(0)
        distances = np.linalg.norm(gaps, axis=2) + np.diag(np.full(count, np.inf))
        if distances.min() > 0:
            distance, names = manager.min_distance_internal(return_names=True)
            a, b = map(int, names)
            assert np.isclose(distance, distances.min()) and np.isclose(distances[a, b], distances.min())


def test_empty_and_unknown():
    manager = CollisionManager()
    assert manager.in_collision_internal() is False and manager.min_distance_internal() == np.inf
    assert manager.in_collision_single(cube_mesh(), return_names=True) == (False, set())
    assert manager.min_distance_single(cube_mesh(), return_name=True, return_data=True) == (np.inf, None, None)
    manager.add_object("a", cube_mesh())
    assert manager.min_distance_internal("a") == np.inf and repr(manager) == "CollisionManager(1 objects)"
    for call in (lambda: manager.remove_object("x"), lambda: manager.set_transform("x", np.eye(4)),
                 lambda: manager.add_object("y", cube_mesh(), np.full((4, 4), np.nan)), lambda: manager.add_object("y", cube_mesh(), np.ones((4, 4))),
                 lambda: manager.add_object("y", type("Empty", (), {"vertices": np.empty((0, 3)), "faces": np.empty((0, 3), int)})),
                 lambda: manager.min_distance_internal("x"), lambda: manager.add_object("y", cube_mesh(), np.eye(3))):
        with pytest.raises(ValueError):
            call()
    for call in (lambda: manager.add_object(3, cube_mesh()), lambda: manager.add_object("z", None), lambda: manager.in_collision_other(3)):
        with pytest.raises(TypeError):
            call()


def test_scene_to_collision():
    manager, geometries = scene_to_collision(Scene({"a": at(0), "b": at(1.5), "c": at(9)}))
    assert manager.in_collision_internal(return_names=True) == (True, {("a", "b")})
    assert list(geometries) == ["a", "b", "c"]
