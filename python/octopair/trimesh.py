"""A CollisionManager with the methods and return values of trimesh.collision, which needs neither trimesh nor python-fcl.

Meshes are any objects with ``vertices`` and ``faces``.

What differs: meshes are solid where they are closed, so an object within another collides with it. Distances are exact, also far away.
Where objects penetrate, a distance is negative; its size is the depth that :func:`octopair.collide` reports, the shortest translation
that is known to be necessary to separate them. Equal objects in one place have the depth 0. An object that lies within another has no
contacts.

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

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _arrays
from ._arrays import Array
from ._engine import Engine
from ._errors import InputError, InputTypeError
from ._pipeline import Pipeline, collide
from ._results import Collisions
from ._scene import Scene
from ._shapes import Geometry, Shapes

__all__ = ["CollisionManager", "ContactData", "DistanceData", "scene_to_collision"]

EXTERNAL = "__external"
"""Name of the mesh in the data of ``in_collision_single`` and ``min_distance_single``."""


class ContactData:
    """A contact of two objects.

    Attributes
    ----------
    names : set of str
        Names of the objects.
    point, normal : numpy.ndarray
        Contact point, and unit vector from the first object to the second, shape (3,).
    depth : float
        Penetration depth.
    """

    def __init__(self, names: Tuple[str, str], table: Collisions, contact: int) -> None:
        self.names = set(names)
        self.point = table.contact_points[contact]
        self.normal = table.contact_normals[contact]
        self.depth = float(table.contact_depths[contact])
        self._indices = dict(zip(names, map(int, table.contact_features[contact])))

    def index(self, name: str) -> int:
        """Returns the index of the face of this object."""
        return self._indices[name]


class DistanceData:
    """The distance of two objects.

    Attributes
    ----------
    names : set of str
        Names of the objects.
    distance : float
        Negative where the objects penetrate.
    """

    def __init__(self, names: Tuple[str, str], distance: float, points: Array) -> None:
        self.names = set(names)
        self.distance = distance
        self._points = dict(zip(names, points))

    def point(self, name: str) -> Array:
        """Returns the point of this object that is nearest to the other; for objects that meet, a contact point."""
        return self._points[name]


class _Object(NamedTuple):
    geometry: Geometry
    transform: Array


class _Nearest(NamedTuple):
    """Smallest distance of two sets: indices of the pair and their nearest points; None without a pair."""

    distance: float
    pair: Optional[Tuple[int, int]]
    points: Array


def _matrix(transform: Any) -> Array:
    if transform is None:
        return np.eye(4)
    matrix = np.array(_arrays.numbers(transform, "transform", (4, 4), copy=True))
    if not np.isfinite(matrix).all() or not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise InputError(f"transform: it must have finite numbers and the last row 0, 0, 0, 1:\n{matrix}")
    return matrix


def _manager(other: Any) -> "CollisionManager":
    if not isinstance(other, CollisionManager):
        raise InputTypeError(f"other_manager: a {type(other).__name__} is not an octopair.trimesh.CollisionManager")
    return other


def _geometry(mesh: Any) -> Geometry:
    if not hasattr(mesh, "vertices") or not hasattr(mesh, "faces"):
        raise InputTypeError(f"mesh: a {type(mesh).__name__} has not both vertices and faces")
    if len(mesh.faces) == 0:
        raise InputError("mesh: it has no faces")
    return Geometry.mesh(mesh.vertices, mesh.faces)


class CollisionManager:
    """Named objects that collide with each other, with a mesh, or with the objects of another manager."""

    def __init__(self) -> None:
        self._objects: Dict[str, _Object] = {}
        self._engine = Engine("local")
        self._shapes: Optional[Shapes] = None

    def add_object(self, name: str, mesh: Any, transform: Any = None) -> None:
        """Adds an object, or replaces the object of this name.

        Parameters
        ----------
        name : str
            Name.
        mesh : object
            With ``vertices`` (n, 3) and ``faces`` (m, 3).
        transform : array, shape (4, 4), optional
            Homogeneous matrix. Default: identity.
        """
        self._objects[_arrays.text(name, "name")] = _Object(_geometry(mesh), _matrix(transform))
        self._shapes = None

    def remove_object(self, name: str) -> None:
        """Removes an object. Raises a ValueError if there is none of this name."""
        self._object(name)
        del self._objects[name]
        self._shapes = None

    def set_transform(self, name: str, transform: Any) -> None:
        """Places an object. Raises a ValueError if there is none of this name."""
        self._objects[name] = self._object(name)._replace(transform=_matrix(transform))
        self._shapes = None

    def in_collision_single(self, mesh: Any, transform: Any = None, return_names: bool = False, return_data: bool = False) -> Any:
        """Checks a mesh against all objects.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of str
            With `return_names`: objects that collide with the mesh.
        contacts : list of ContactData
            With `return_data`. The name of the mesh is ``"__external"``.
        """
        table = self._collide(_single(mesh, transform), return_data)
        names = list(self._objects)
        found = {names[a] for a in table.a}
        contacts = _contacts(table, names, [EXTERNAL]) if return_data else []
        return _answer(len(table) > 0, (return_names, found), (return_data, contacts))

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Checks the objects against each other.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of (str, str)
            With `return_names`: pairs that collide; the names of a pair are sorted.
        contacts : list of ContactData
            With `return_data`.
        """
        table = self._collide(None, return_data)
        names = list(self._objects)
        found = {_sorted(names[a], names[b]) for a, b in table.pairs}
        contacts = _contacts(table, names, names) if return_data else []
        return _answer(len(table) > 0, (return_names, found), (return_data, contacts))

    def in_collision_other(self, other_manager: "CollisionManager", return_names: bool = False, return_data: bool = False) -> Any:
        """Checks the objects against those of another manager.

        Returns
        -------
        is_collision : bool
            Whether there is a collision.
        names : set of (str, str)
            With `return_names`: pairs of a name of this manager and a name of the other.
        contacts : list of ContactData
            With `return_data`.
        """
        table = self._collide(_manager(other_manager)._all(), return_data)
        names, others = list(self._objects), list(other_manager._objects)
        found = {(names[a], others[b]) for a, b in table.pairs}
        contacts = _contacts(table, names, others) if return_data else []
        return _answer(len(table) > 0, (return_names, found), (return_data, contacts))

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
        nearest = self._nearest(self._all(), _single(mesh, transform))
        names = None if nearest.pair is None else (list(self._objects)[nearest.pair[0]], EXTERNAL)
        return _distance_answer(nearest, names, (return_name, None if names is None else names[0]), return_data)

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
            names = list(self._objects)
            pair = None if nearest.pair is None else (names[nearest.pair[0]], names[nearest.pair[1]])
        else:
            own = self._object(name)
            others = [other for other in self._objects if other != name]
            nearest = self._nearest(_shapes([self._objects[other] for other in others]), _shapes([own]))
            pair = None if nearest.pair is None else (others[nearest.pair[0]], name)
        return _distance_answer(nearest, pair, (return_names, None if pair is None else _sorted(*pair)), return_data)

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
        pair = None
        if nearest.pair is not None:
            pair = (list(self._objects)[nearest.pair[0]], list(other_manager._objects)[nearest.pair[1]])
        return _distance_answer(nearest, pair, (return_names, pair), return_data)

    def __repr__(self) -> str:
        return f"CollisionManager({len(self._objects):,} objects)"

    def _object(self, name: str) -> _Object:
        if name not in self._objects:
            raise InputError(f"{name} is not in this collision manager")
        return self._objects[name]

    def _all(self) -> Shapes:
        if self._shapes is None:
            self._shapes = _shapes(list(self._objects.values()))
        return self._shapes

    def _collide(self, other: Optional[Shapes], contacts: bool) -> Collisions:
        return collide(self._all(), other, stage="features" if contacts else "objects", engine=self._engine)

    def _nearest(self, first: Shapes, second: Optional[Shapes]) -> _Nearest:
        """Returns the smallest distance within a set, or between two sets.

        If objects meet, it is the negative of the largest depth. Otherwise an exact search follows, whose margin is the distance of a pair
        that the boxes suggest: so that the search finds this pair or a nearer one.
        """
        size = len(first) if second is None else len(second)
        if len(first) == 0 or size < (2 if second is None else 1):
            return _Nearest(np.inf, None, np.zeros((2, 3)))
        meeting = collide(first, second, max_contacts=1, engine=self._engine)
        if len(meeting):
            deepest = int(np.argmax(meeting.depth))
            contacts = meeting.contact_points[meeting.contacts(deepest)]
            points = np.repeat(contacts, 2, axis=0) if len(contacts) else np.full((2, 3), np.nan)
            return _Nearest(-float(meeting.depth[deepest]) + 0.0, _pair(meeting, deepest), points)
        table = self._within(first, second, _suggested_distance(first, second))
        best = int(np.argmin(table.distance))
        return _Nearest(float(table.distance[best]), _pair(table, best), table.nearest[best])

    def _within(self, first: Shapes, second: Optional[Shapes], margin: float) -> Collisions:
        """Returns the pairs whose distance is at most `margin`, with their distances."""
        return collide(first, second, margin=margin, stage="objects", engine=self._engine)


def _shapes(objects: List[_Object]) -> Shapes:
    poses = np.array([item.transform for item in objects]).reshape(-1, 4, 4)
    return Shapes([item.geometry for item in objects], poses)


def _single(mesh: Any, transform: Any) -> Shapes:
    return _shapes([_Object(_geometry(mesh), _matrix(transform))])


def _suggested_distance(first: Shapes, second: Optional[Shapes]) -> float:
    """Returns the distance of the objects whose boxes are nearest, or slightly more. Requires: no objects meet."""
    boxes = first.boxes(second)
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
    here_box, there_box = one.boxes(other)
    table = Pipeline().exact_objects(one, farthest, other).run(here_box, there_box, farthest)
    return float(np.nextafter(table.distance[0], np.inf))


def _subset(shapes: Shapes, index: int) -> Shapes:
    return Shapes([shapes.geometries[shapes.geometry[index]]], shapes.poses[index:index + 1])


def _pair(table: Collisions, row: int) -> Tuple[int, int]:
    return int(table.a[row]), int(table.b[row])


def _sorted(a: str, b: str) -> Tuple[str, str]:
    return (a, b) if a <= b else (b, a)


def _contacts(table: Collisions, names: List[str], others: List[str]) -> List[ContactData]:
    found = []
    for row in range(len(table)):
        pair = (names[table.a[row]], others[table.b[row]])
        contacts = table.contacts(row)
        found += [ContactData(pair, table, contact) for contact in range(contacts.start, contacts.stop)]
    return found


def _answer(first: Any, *more: Tuple[bool, Any]) -> Any:
    """Returns the first value, or a tuple of it and those that are wanted."""
    wanted = [value for want, value in more if want]
    return (first, *wanted) if wanted else first


def _distance_answer(nearest: _Nearest, names: Optional[Tuple[str, str]], name: Tuple[bool, Any], return_data: bool) -> Any:
    data = None if names is None else DistanceData(names, nearest.distance, nearest.points)
    return _answer(nearest.distance, name, (return_data, data))


def scene_to_collision(scene: Any) -> Tuple[CollisionManager, Dict[str, Geometry]]:
    """Returns a manager with the objects of a trimesh scene by the names of its nodes, and the geometry of each node."""
    manager = CollisionManager()
    shapes = Shapes.from_trimesh(scene)
    bottom = np.array([[0.0, 0.0, 0.0, 1.0]])
    for index, name in enumerate(shapes.names or []):
        manager._objects[name] = _Object(shapes.geometries[shapes.geometry[index]], np.vstack([shapes.poses[index], bottom]))
    return manager, {name: item.geometry for name, item in manager._objects.items()}
