"""octopair.trimesh: the classes, functions and return values of trimesh.collision."""
import types

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from test_shapes import CUBE_FACES, CUBE_VERTICES, Scene, cube_mesh

import octopair as op
from octopair.trimesh import CollisionManager, mesh_to_BVH, mesh_to_convex, scene_to_collision


def at(x, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def ball(count, seed=0):
    """A convex mesh whose vertices are on the unit sphere."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = ConvexHull(points).simplices
    corners = points[faces]
    inward = np.sum(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * corners[:, 0], axis=1) < 0
    return types.SimpleNamespace(vertices=points, faces=np.where(inward[:, None], faces[:, ::-1], faces))


def is_on_face(mesh, place, face, point):
    """Whether a point is a mean of the corners of a face, with weights that are not negative, to rounding."""
    corners = mesh.vertices[mesh.faces[face]] @ place[:3, :3].T + place[:3, 3]
    weights, *_ = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), np.append(point, 1), rcond=None)
    return np.allclose(weights @ corners, point, atol=1e-9) and np.isclose(weights.sum(), 1) and (weights > -1e-9).all()


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


def test_no_contact_is_left_out():
    first, second = ball(300), ball(300, 1)
    manager, other = CollisionManager(), CollisionManager()
    manager.add_object("a", first)
    other.add_object("b", second, at(0.7, 0.1, 0.05))
    triangles = [first.vertices[first.faces], second.vertices[second.faces] + [0.7, 0.1, 0.05]]
    boxes = [np.hstack([corners.min(axis=1), corners.max(axis=1)]) for corners in triangles]
    crossing = op.Pipeline().triangles(triangles[0], against=(triangles[1], None)).run(boxes[0], against=boxes[1])
    expected = {tuple(pair) for pair in crossing.pairs.tolist()}
    assert len(expected) > 64
    found = [manager.in_collision_other(other, return_data=True)[1]]
    assert {(contact.index("a"), contact.index("b")) for contact in found[0]} == expected
    found.append(other.in_collision_single(first, return_data=True)[1])
    manager.add_object("b", second, at(0.7, 0.1, 0.05))
    found.append(manager.in_collision_internal(return_data=True)[1])
    assert [len(contacts) for contacts in found] == [len(expected)] * 3
    # Of two objects of one name, an index is that of the second object.
    other = CollisionManager()
    other.add_object("a", second, at(0.7, 0.1, 0.05))
    found = [contact.index("a") for contact in manager.in_collision_other(other, return_data=True)[1]]
    assert {b for _, b in expected} <= set(found)


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


@pytest.mark.parametrize("prepare", [lambda mesh: mesh, mesh_to_BVH, mesh_to_convex])
def test_the_face_of_a_distance(prepare):
    rng = np.random.default_rng(3)
    meshes = {"a": ball(60), "b": ball(80, 1)}
    for _ in range(10):
        manager, places = CollisionManager(), {}
        for name, x in (("a", 0), ("b", 3)):
            places[name] = at(*(rng.random(3) * 0.3 + [x, 0, 0]))
            places[name][:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            manager.add_object(name, prepare(meshes[name]), places[name])
        distance, data = manager.min_distance_internal(return_data=True)
        manager.set_transform("b", at(50))  # does not change the data
        assert np.isclose(distance, np.linalg.norm(data.point("a") - data.point("b")))
        for name in ("a", "b"):
            assert is_on_face(meshes[name], places[name], data.index(name), data.point(name))
    data = manager.min_distance_single(meshes["a"], at(1.5, 9), return_data=True)[1]
    assert is_on_face(meshes["a"], at(1.5, 9), data.index("__external"), data.point("__external"))


def test_the_face_of_objects_that_meet(manager):
    data = manager.min_distance_internal(return_data=True)[1]
    contact = manager.in_collision_internal(return_data=True)[1][0]
    assert data.index("a") == contact.index("a") and data.index("b") == contact.index("b")
    assert is_on_face(cube_mesh(), at(0), data.index("a"), data.point("a"))
    # A cube within another has no contact with it.
    small = types.SimpleNamespace(vertices=CUBE_VERTICES / 4, faces=CUBE_FACES)
    assert manager.in_collision_single(small, at(10), return_data=True) == (True, [])
    data = manager.min_distance_single(small, at(10), return_data=True)[1]
    assert np.isnan(data.point("c")).all()
    with pytest.raises(op.UsageError, match="__external and c have no contact"):
        data.index("c")
    with pytest.raises(KeyError):
        data.index("b")


def test_prepared_meshes():
    mesh = mesh_to_BVH(cube_mesh())
    assert mesh.geometry.kind == "mesh" and mesh_to_convex(cube_mesh()).geometry.kind == "hull"
    assert mesh_to_BVH(mesh_to_convex(mesh)).geometry.kind == "mesh" and mesh_to_convex(mesh).geometry.kind == "hull"
    assert mesh.vertices.tolist() == CUBE_VERTICES.tolist() and mesh.faces.tolist() == CUBE_FACES.tolist()
    manager = CollisionManager()
    for name, x in (("a", 0), ("b", 1.5)):
        manager.add_object(name, mesh, at(x))
    assert manager.in_collision_single(mesh, at(3.4), return_names=True) == (True, {"b"})
    assert op.collide(op.Shapes([mesh.geometry], np.array([at(0), at(1.5)]), [0, 0])).class_.tolist() == ["penetrating"]
    # An L of two boxes is not convex: the hull fills its corner, the mesh does not.
    corner = types.SimpleNamespace(vertices=np.vstack([CUBE_VERTICES * [3, 1, 1], CUBE_VERTICES * [1, 3, 1] + [-2, 4, 0]]),
                                   faces=np.vstack([CUBE_FACES, np.array(CUBE_FACES) + 8]))
    small = types.SimpleNamespace(vertices=CUBE_VERTICES / 4, faces=CUBE_FACES)
    for prepared, expected in ((mesh_to_BVH(corner), False), (mesh_to_convex(corner), True)):
        manager = CollisionManager()
        manager.add_object("corner", prepared)
        assert manager.in_collision_single(small, at(0, 2)) is expected
    hulls = CollisionManager()
    hulls.add_object("a", mesh_to_convex(cube_mesh()))
    contact = hulls.in_collision_single(mesh_to_convex(mesh), at(1.5, 0.25, 0.5), return_data=True)[1][0]
    assert contact.index("a") in (2, 3) and contact.index("__external") in (0, 1)  # the faces x = 1 and x = -1
    for prepare in (mesh_to_BVH, mesh_to_convex):
        with pytest.raises(ValueError):
            prepare(types.SimpleNamespace(vertices=CUBE_VERTICES, faces=[[0, 1, 8]]))
        with pytest.raises(TypeError):
            prepare(3)


def test_ignored_pairs(manager):
    manager.add_object("d", cube_mesh(), at(0.25, 0.5))
    everything = {("a", "b"), ("a", "d"), ("b", "d")}
    assert manager.in_collision_internal(return_names=True) == (True, everything)
    manager.set_pair_ignored("b", "a")
    assert manager.is_pair_ignored("a", "b") and manager.is_pair_ignored("b", "a") and manager.ignored_pairs == {("a", "b")}
    hit, names, contacts = manager.in_collision_internal(return_names=True, return_data=True)
    assert hit and names == everything - {("a", "b")} and {frozenset(contact.names) for contact in contacts} == {*map(frozenset, names)}
    manager.set_pair_ignored("a", "d")
    manager.set_pair_ignored("b", "d")
    assert manager.in_collision_internal() is False
    assert manager.in_collision_single(cube_mesh(), return_names=True)[1] == {"a", "b", "d"}
    manager.set_pair_ignored("d", "a", ignored=False)
    assert manager.in_collision_internal(return_names=True) == (True, {("a", "d")})
    manager.remove_object("b")
    assert manager.ignored_pairs == set() and not manager.is_pair_ignored("a", "b")
    manager.set_pair_ignored("a", "d")
    manager.clear_ignored_pairs()
    assert manager.in_collision_internal() is True
    for pair in (("a", "a"), ("a", "x"), ("x", "a")):
        with pytest.raises(ValueError):
            manager.set_pair_ignored(*pair)


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
    scene = Scene({"a": at(0)})
    scene.geometry["empty"] = types.SimpleNamespace(vertices=np.zeros((0, 3)), faces=np.zeros((0, 3), dtype=np.int64))
    assert list(scene_to_collision(scene)[1]) == ["a"]
    with pytest.raises(TypeError):
        scene_to_collision(cube_mesh())
