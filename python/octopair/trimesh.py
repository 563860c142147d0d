"""The classes and functions of trimesh.collision, without trimesh and python-fcl.

Meshes are any objects with ``vertices`` and ``faces``.

What differs:

- Meshes are solid where they are closed, so an object within another collides with it.
- All contacts of all pairs are returned. There is no maximum. Two convex hulls (:func:`mesh_to_convex`) have one contact.
- Distances are exact, also far away. Where objects penetrate, a distance is negative; its size is the depth that
  :func:`octopair.collide` reports: a lower bound on the shortest translation that separates them.
- An object that lies within another has no contacts. Equal objects in one place have none either, and the depth 0.
- :func:`mesh_to_BVH` and :func:`mesh_to_convex` return a :class:`PreparedMesh` instead of objects of FCL. There are no other objects of
  FCL: ``CollisionManager.add_object`` returns nothing, and the second value of :func:`scene_to_collision` has a ``Geometry`` per node.

>>> import numpy as np
>>> from octopair.trimesh import CollisionManager
>>> class Tetrahedron:
...     vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
...     faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
>>> manager = CollisionManager()
>>> manager.add_object("a", Tetrahedron)
>>> manager.add_object("b", Tetrahedron, [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
>>> manager.in_collision_internal(), manager.min_distance_internal(return_names=True)
(False, (2.0, ('a', 'b')))
"""

from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from . import _arrays
from ._arrays import Array
from ._collisions import Collisions
from ._engine import Engine
from ._errors import InputError, InputTypeError, UsageError
from ._pipeline import Pipeline, collide
from ._scene import Scene
from ._shapes import Geometry, Shapes

__all__ = ["CollisionManager", "ContactData", "DistanceData", "PreparedMesh", "mesh_to_BVH", "mesh_to_convex", "scene_to_collision"]

EXTERNAL = "__external"
"""Name of the mesh in the data of ``in_collision_single`` and ``min_distance_single``."""

ALL_CONTACTS = 0xFFFFFFFF
"""Value of ``max_contacts`` that leaves out no contact."""

NO_FACE = 0xFFFFFFFF
"""Value in ``contact_features`` of a shape without triangles."""


class PreparedMesh(NamedTuple):
    """A mesh that is prepared for exact tests. A CollisionManager takes it in place of the mesh, and shares it among objects."""

    geometry: Geometry
    vertices: Array
    faces: Array


class _Object(NamedTuple):
    mesh: PreparedMesh
    transform: Array


class _Place(NamedTuple):
    """A point of an object, and the triangle that has the point, or NO_FACE."""

    item: _Object
    point: Array
    triangle: int

    def face(self) -> int:
        return self.triangle if self.triangle != NO_FACE else _nearest_face(self.item, self.point)


class ContactData:
    """A contact of two objects. If both have the same name, in two managers, the data of a name is that of the second object."""

    __slots__ = ("_contact", "_objects", "_table")

    def __init__(self, objects: Dict[str, _Object], table: Collisions, contact: int) -> None:
        self._objects, self._table, self._contact = objects, table, contact

    @property
    def names(self) -> Set[str]:
        """Names of the objects."""
        return set(self._objects)

    @property
    def point(self) -> Array:
        """Contact point, shape (3,)."""
        return self._table.contact_points[self._contact]

    @property
    def normal(self) -> Array:
        """Unit vector from the first object to the second, shape (3,)."""
        return self._table.contact_normals[self._contact]

    @property
    def depth(self) -> float:
        """Penetration depth."""
        return float(self._table.contact_depths[self._contact])

    def index(self, name: str) -> int:
        """Returns the index of the face of this object."""
        item = self._objects[name]
        column = int(name == list(self._objects)[-1])
        return _Place(item, self.point, int(self._table.contact_features[self._contact, column])).face()


class DistanceData:
    """The distance of two objects. If both have the same name, in two managers, the data of a name is that of the second object.

    Attributes
    ----------
    names : set of str
        Names of the objects.
    distance : float
        Negative where the objects penetrate.
    """

    def __init__(self, places: Dict[str, _Place], distance: float) -> None:
        self._places = places
        self.names = set(places)
        self.distance = distance

    def point(self, name: str) -> Array:
        """Returns the point of this object that is nearest to the other. For objects that meet, this is a contact point; its
        coordinates are NaN if they have no contact."""
        return self._places[name].point

    def index(self, name: str) -> int:
        """Returns the index of the face of this object that has the point. Of several such faces, any. Raises a ValueError for objects
        that meet without a contact."""
        place = self._places[name]
        if np.isnan(place.point).any():
            raise UsageError(f"index: {' and '.join(sorted(self.names))} have no contact: an object lies within the other, or both are equal")
        return place.face()


class _Nearest(NamedTuple):
    """Smallest distance of two sets: indices of the pair, or None without a pair; the nearest points and their triangles."""

    distance: float
    pair: Optional[Tuple[int, int]]
    points: Array
    triangles: Tuple[int, int]


def _matrix(transform: Any) -> Array:
    if transform is None:
        return np.eye(4)
    matrix = np.array(_arrays.numbers(transform, "transform", (4, 4)))
    if not np.isfinite(matrix).all() or not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise InputError(f"transform: it must have finite numbers and the last row 0, 0, 0, 1:\n{matrix}")
    return matrix


def _manager(other: Any) -> "CollisionManager":
    if not isinstance(other, CollisionManager):
        raise InputTypeError(f"other_manager: a {type(other).__name__} is not an octopair.trimesh.CollisionManager")
    return other


def _prepared(mesh: Any, kind: Optional[str] = None) -> PreparedMesh:
    """Returns a mesh that is prepared as "mesh" or "hull". With None, a prepared mesh stays as it is."""
    if isinstance(mesh, PreparedMesh) and kind in (None, mesh.geometry.kind):
        return mesh
    if not hasattr(mesh, "vertices") or not hasattr(mesh, "faces"):
        raise InputTypeError(f"mesh: a {type(mesh).__name__} has not both vertices and faces")
    if len(mesh.faces) == 0:
        raise InputError("mesh: it has no faces")
    vertices = np.array(_arrays.numbers(mesh.vertices, "vertices", (None, 3)))
    faces = np.array(_arrays.integers(mesh.faces, "faces", (None, 3)))
    for array in (vertices, faces):
        array.flags.writeable = False
    checked = Geometry.mesh(vertices, faces)
    return PreparedMesh(Geometry.hull(vertices) if kind == "hull" else checked, vertices, faces)


def mesh_to_BVH(mesh: Any) -> PreparedMesh:
    """Returns a mesh that is prepared for exact tests. Requires: `mesh` has ``vertices`` (n, 3) and ``faces`` (m, 3)."""
    return _prepared(mesh, "mesh")


def mesh_to_convex(mesh: Any) -> PreparedMesh:
    """Returns the convex hull of a mesh, prepared for exact tests, which are faster than those of a mesh.

    The index of a face is that of the face of the mesh that is nearest to the point.

    Requires: `mesh` has ``vertices`` (n, 3) and ``faces`` (m, 3).
    """
    return _prepared(mesh, "hull")


class CollisionManager:
    """Named objects that collide with each other, with a mesh, or with the objects of another manager."""

    def __init__(self) -> None:
        self._objects: Dict[str, _Object] = {}
        self._ignored: Set[Tuple[str, str]] = set()
        self._engine = Engine("local")
        self._shapes: Optional[Shapes] = None

    def add_object(self, name: str, mesh: Any, transform: Any = None) -> None:
        """Adds an object, or replaces the object of this name.

        Parameters
        ----------
        name : str
            Name.
        mesh : object
            A PreparedMesh, or an object with ``vertices`` (n, 3) and ``faces`` (m, 3).
        transform : array, shape (4, 4), optional
            Homogeneous matrix. Default: identity.
        """
        self._objects[_arrays.text(name, "name")] = _Object(_prepared(mesh), _matrix(transform))
        self._shapes = None

    def remove_object(self, name: str) -> None:
        """Removes an object and its ignored pairs. Raises a ValueError if there is none of this name."""
        self._object(name)
        del self._objects[name]
        self._ignored = {pair for pair in self._ignored if name not in pair}
        self._shapes = None

    def set_transform(self, name: str, transform: Any) -> None:
        """Places an object. Raises a ValueError if there is none of this name."""
        self._objects[name] = self._object(name)._replace(transform=_matrix(transform))
        self._shapes = None

    def set_pair_ignored(self, name_a: str, name_b: str, ignored: bool = True) -> None:
        """Sets whether :meth:`in_collision_internal` leaves out this pair. Distances do not leave it out.

        Raises a ValueError if there is no such pair.
        """
        self._object(name_a)
        self._object(name_b)
        if name_a == name_b:
            raise InputError(f"a pair has two objects; both names are {name_a}")
        (self._ignored.add if ignored else self._ignored.discard)(_sorted(name_a, name_b))

    def is_pair_ignored(self, name_a: str, name_b: str) -> bool:
        """Returns whether :meth:`in_collision_internal` leaves out this pair."""
        return _sorted(name_a, name_b) in self._ignored

    def clear_ignored_pairs(self) -> None:
        """Ignores no pair."""
        self._ignored.clear()

    @property
    def ignored_pairs(self) -> Set[Tuple[str, str]]:
        """Pairs that :meth:`in_collision_internal` leaves out; the names of a pair are sorted."""
        return set(self._ignored)

    def in_collision_single(self, mesh: Any, transform: Any = None, return_names: bool = False, return_data: bool = False) -> Any:
        """Checks a mesh against all objects.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of str
            With `return_names`: objects that collide with the mesh.
        contacts : list of ContactData
            With `return_data`: all contacts. The name of the mesh is ``"__external"``.
        """
        single = _single(mesh, transform)
        table = self._collide(_shapes([single]), return_data)
        names = list(self._objects)
        found = {names[a] for a in table.a}
        contacts = _contacts(table, self._objects, {EXTERNAL: single}) if return_data else []
        return _answer(len(table.pairs) > 0, (return_names, found), (return_data, contacts))

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Checks the objects against each other.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of (str, str)
            With `return_names`: pairs that collide; the names of a pair are sorted.
        contacts : list of ContactData
            With `return_data`: all contacts.
        """
        table = self._collide(None, return_data)
        names = list(self._objects)
        found = {_sorted(names[a], names[b]) for a, b in table.pairs}
        contacts = _contacts(table, self._objects, self._objects) if return_data else []
        return _answer(len(table.pairs) > 0, (return_names, found), (return_data, contacts))

    def in_collision_other(self, other_manager: "CollisionManager", return_names: bool = False, return_data: bool = False) -> Any:
        """Checks the objects against those of another manager.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of (str, str)
            With `return_names`: pairs of a name of this manager and a name of the other.
        contacts : list of ContactData
            With `return_data`: all contacts.
        """
        table = self._collide(_manager(other_manager)._all(), return_data)
        names, others = list(self._objects), list(other_manager._objects)
        found = {(names[a], others[b]) for a, b in table.pairs}
        contacts = _contacts(table, self._objects, other_manager._objects) if return_data else []
        return _answer(len(table.pairs) > 0, (return_names, found), (return_data, contacts))

    def min_distance_single(self, mesh: Any, transform: Any = None, return_name: bool = False, return_data: bool = False) -> Any:
        """Returns the smallest distance between a mesh and all objects; infinite if there are none.

        Returns
        -------
        distance : float
            Negative if the mesh penetrates an object.
        name : str
            With `return_name`: name of the nearest object, or None.
        data : DistanceData
            With `return_data`, or None. The name of the mesh is ``"__external"``.
        """
        single = _single(mesh, transform)
        nearest = self._nearest(self._all(), _shapes([single]))
        pair = _named(nearest, self._objects, {EXTERNAL: single})
        return _distance_answer(nearest, pair, (return_name, None if pair is None else pair[0][0]), return_data)

    def min_distance_internal(self, name: Optional[str] = None, return_names: bool = False, return_data: bool = False) -> Any:
        """Returns the smallest distance between two objects; infinite if there are fewer.

        Parameters
        ----------
        name : str, optional
            Considers only pairs with this object.
        return_names, return_data : bool
            Whether to return more.

        Returns
        -------
        distance : float
            Negative if objects penetrate.
        names : tuple of str
            With `return_names`: the pair, sorted, or None.
        data : DistanceData
            With `return_data`, or None.
        """
        if name is None:
            nearest = self._nearest(self._all(), None)
            pair = _named(nearest, self._objects, self._objects)
        else:
            own = {name: self._object(name)}
            others = {other: item for other, item in self._objects.items() if other != name}
            nearest = self._nearest(_shapes(others.values()), _shapes(own.values()))
            pair = _named(nearest, others, own)
        names = None if pair is None else _sorted(pair[0][0], pair[1][0])
        return _distance_answer(nearest, pair, (return_names, names), return_data)

    def min_distance_other(self, other_manager: "CollisionManager", return_names: bool = False, return_data: bool = False) -> Any:
        """Returns the smallest distance between the objects and those of another manager; infinite if one has none.

        Returns
        -------
        distance : float
            Negative if objects penetrate.
        names : tuple of str
            With `return_names`: a name of this manager and a name of the other, or None.
        data : DistanceData
            With `return_data`, or None.
        """
        nearest = self._nearest(self._all(), _manager(other_manager)._all())
        pair = _named(nearest, self._objects, other_manager._objects)
        names = None if pair is None else (pair[0][0], pair[1][0])
        return _distance_answer(nearest, pair, (return_names, names), return_data)

    def __repr__(self) -> str:
        return f"CollisionManager({len(self._objects):,} objects)"

    def _object(self, name: str) -> _Object:
        if name not in self._objects:
            raise InputError(f"{name} is not in this collision manager")
        return self._objects[name]

    def _all(self) -> Shapes:
        if self._shapes is None:
            self._shapes = _shapes(self._objects.values())
        return self._shapes

    def _collide(self, other: Optional[Shapes], contacts: bool) -> Collisions:
        keep = self._ignored_filter() if other is None and self._ignored else None
        return collide(self._all(), against=other, stage="features" if contacts else "objects", max_contacts=ALL_CONTACTS, keep=keep,
                       engine=self._engine)

    def _ignored_filter(self) -> Callable[[Collisions], Array]:
        """Returns a filter that leaves out the ignored pairs of the objects."""
        index = {name: number for number, name in enumerate(self._objects)}
        to_number = np.array([len(index), 1])  # a pair @ to_number: one number for each pair
        ignored = np.sort([(index[a], index[b]) for a, b in self._ignored], axis=1) @ to_number
        return lambda table: np.isin(table.pairs @ to_number, ignored, invert=True)

    def _nearest(self, first: Shapes, second: Optional[Shapes]) -> _Nearest:
        """Returns the smallest distance within a set, or between two sets.

        If objects meet, it is the negative of the largest depth. Otherwise an exact search follows, whose margin is the distance of a pair
        that the boxes suggest: so that the search finds this pair or a nearer one.
        """
        size = len(first) if second is None else len(second)
        if len(first) == 0 or size < (2 if second is None else 1):
            return _Nearest(np.inf, None, np.zeros((2, 3)), (NO_FACE, NO_FACE))
        meeting = collide(first, against=second, max_contacts=1, engine=self._engine)
        if len(meeting.pairs):
            return _deepest(meeting)
        margin = _suggested_distance(first, second)
        table = collide(first, against=second, margin=margin, stage="objects", engine=self._engine)
        best = int(np.argmin(table.distance))
        return _Nearest(float(table.distance[best]), _pair(table, best), table.nearest[best], (NO_FACE, NO_FACE))


def _deepest(meeting: Collisions) -> _Nearest:
    """Returns the deepest pair of objects that meet, with its contact, if it has one."""
    row = int(np.argmax(meeting.depth))
    points, triangles = np.full((2, 3), np.nan), (NO_FACE, NO_FACE)
    contacts = meeting.contacts(row)
    if contacts.start < contacts.stop:
        points = np.repeat(meeting.contact_points[contacts.start:contacts.start + 1], 2, axis=0)
        a, b = meeting.contact_features[contacts.start].tolist()
        triangles = a, b
    return _Nearest(-float(meeting.depth[row]) + 0.0, _pair(meeting, row), points, triangles)


def _shapes(objects: Iterable[_Object]) -> Shapes:
    items = list(objects)
    return Shapes([item.mesh.geometry for item in items], np.array([item.transform for item in items]).reshape(-1, 4, 4))


def _single(mesh: Any, transform: Any) -> _Object:
    return _Object(_prepared(mesh), _matrix(transform))


def _suggested_distance(first: Shapes, second: Optional[Shapes]) -> float:
    """Returns the distance of the objects whose boxes are nearest, or slightly more. Requires: no objects meet."""
    boxes = first.boxes(against=second)
    here, there = (boxes, boxes) if second is None else boxes
    scene = Scene(dtype="float64")
    scene.add(there)
    nearest = scene.nearest(here, k=2 if second is None else 1)
    rows = np.repeat(np.arange(len(here)), nearest.counts)
    others = nearest.indices if second is not None else np.where(nearest.indices == rows, len(here), nearest.indices)
    distances = np.where(others == len(here), np.inf, nearest.distances) if second is None else nearest.distances
    best = int(np.argmin(distances))
    a, b = int(rows[best]), int(others[best])
    pair = np.vstack([here[a], there[b]])
    farthest = float(np.linalg.norm(pair[:, 3:].max(axis=0) - pair[:, :3].min(axis=0)))
    one, other = _subset(first, a), _subset(first if second is None else second, b)
    here_box, there_box = one.boxes(against=other)
    table = Pipeline().exact_objects(one, margin=farthest, against=other).run(here_box, against=there_box, margin=farthest)
    return float(np.nextafter(table.distance[0], np.inf))


def _subset(shapes: Shapes, index: int) -> Shapes:
    return Shapes([shapes.geometries[shapes.geometry[index]]], shapes.poses[index:index + 1])


def _pair(table: Collisions, row: int) -> Tuple[int, int]:
    return int(table.a[row]), int(table.b[row])


def _sorted(a: str, b: str) -> Tuple[str, str]:
    return (a, b) if a <= b else (b, a)


def _nearest_face(item: _Object, point: Array) -> int:
    """Returns the index of the face of an object that is nearest to a point."""
    transform = item.transform
    vertices = item.mesh.vertices @ transform[:3, :3].T + transform[:3, 3]
    corners = vertices[item.mesh.faces] - point
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.sum(sides * sides, axis=2)
    along = np.clip(-np.sum(corners * sides, axis=2) / np.where(lengths > 0, lengths, 1), 0, 1)
    to_sides = np.linalg.norm(corners + along[:, :, None] * sides, axis=2).min(axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    areas = np.linalg.norm(normals, axis=1)
    inside = (np.sum(np.cross(corners, sides) * normals[:, None], axis=2) >= 0).all(axis=1) & (areas > 0)
    to_planes = np.abs(np.sum(corners[:, 0] * normals, axis=1)) / np.where(areas > 0, areas, 1)
    return int(np.argmin(np.where(inside, to_planes, to_sides)))


_Pair = Tuple[Tuple[str, _Place], Tuple[str, _Place]]
"""Names of two objects, and a place of each."""


def _named(nearest: _Nearest, first: Dict[str, _Object], second: Dict[str, _Object]) -> Optional[_Pair]:
    """Returns the nearest places of two objects."""
    if nearest.pair is None:
        return None
    (name_a, item_a), (name_b, item_b) = list(first.items())[nearest.pair[0]], list(second.items())[nearest.pair[1]]
    a, b = nearest.triangles
    return (name_a, _Place(item_a, nearest.points[0], a)), (name_b, _Place(item_b, nearest.points[1], b))


def _contacts(table: Collisions, first: Dict[str, _Object], second: Dict[str, _Object]) -> List[ContactData]:
    objects, others = list(first.items()), list(second.items())
    found = []
    for row, (a, b) in enumerate(table.pairs.tolist()):
        pair, contacts = dict((objects[a], others[b])), table.contacts(row)
        found += [ContactData(pair, table, contact) for contact in range(contacts.start, contacts.stop)]
    return found


def _answer(first: Any, *more: Tuple[bool, Any]) -> Any:
    """Returns the first value, or a tuple of it and those that are wanted."""
    wanted = [value for want, value in more if want]
    return (first, *wanted) if wanted else first


def _distance_answer(nearest: _Nearest, pair: Optional[_Pair], name: Tuple[bool, Any], return_data: bool) -> Any:
    data = None if pair is None else DistanceData(dict(pair), nearest.distance)
    return _answer(nearest.distance, name, (return_data, data))


def scene_to_collision(scene: Any) -> Tuple[CollisionManager, Dict[str, Geometry]]:
    """Returns a manager with the objects of a trimesh scene by the names of its nodes, and the geometry of each node.

    Nodes of a geometry without faces (a path, a point cloud, an empty mesh) are left out.
    """
    if not hasattr(scene, "graph") or not hasattr(scene, "geometry"):
        raise InputTypeError(f"scene: a {type(scene).__name__} has not both graph and geometry")
    meshes = {name: mesh_to_BVH(mesh) for name, mesh in scene.geometry.items() if len(getattr(mesh, "faces", ()))}
    manager = CollisionManager()
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        if name in meshes:
            manager.add_object(str(node), meshes[name], transform)
    return manager, {name: item.mesh.geometry for name, item in manager._objects.items()}
