"""Shapes: exact geometry of objects."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._errors import InputError, InputTypeError


class Geometry:
    """A shape that is prepared for exact tests. Objects of equal shape should share one. Made by its class methods.

    A shape is centred at the origin of its local space; an axis is the z axis. All shapes but planes and open meshes are solid.
    """

    def __init__(self, geometry: _core.Geometry, kind: str) -> None:
        if not isinstance(geometry, _core.Geometry):
            raise InputTypeError("a Geometry is made by its class methods: Geometry.sphere(1), Geometry.mesh(vertices, faces) ...")
        self._geometry = geometry
        self._kind = kind

    @classmethod
    def sphere(cls, radius: float) -> "Geometry":
        """Returns a ball."""
        return cls(_core.Geometry.sphere(_arrays.real(radius, "radius")), "sphere")

    @classmethod
    def box(cls, half_extents: Sequence[float]) -> "Geometry":
        """Returns a box with these half extents in x, y, z."""
        return cls(_core.Geometry.box(_triple(half_extents, "half_extents")), "box")

    @classmethod
    def capsule(cls, radius: float, length: float) -> "Geometry":
        """Returns all points within `radius` of the segment from z = -length / 2 to length / 2."""
        return cls(_core.Geometry.capsule(_arrays.real(radius, "radius"), _arrays.real(length, "length")), "capsule")

    @classmethod
    def cylinder(cls, radius: float, length: float) -> "Geometry":
        """Returns a cylinder from z = -length / 2 to length / 2."""
        return cls(_core.Geometry.cylinder(_arrays.real(radius, "radius"), _arrays.real(length, "length")), "cylinder")

    @classmethod
    def cone(cls, radius: float, length: float) -> "Geometry":
        """Returns a cone from z = -length / 2, its base, to z = length / 2, its tip."""
        return cls(_core.Geometry.cone(_arrays.real(radius, "radius"), _arrays.real(length, "length")), "cone")

    @classmethod
    def ellipsoid(cls, radii: Sequence[float]) -> "Geometry":
        """Returns an ellipsoid with these radii along x, y, z."""
        return cls(_core.Geometry.ellipsoid(_triple(radii, "radii")), "ellipsoid")

    @classmethod
    def plane(cls, normal: Sequence[float], offset: float) -> "Geometry":
        """Returns the points x with ``normal * x = offset``: a surface without an interior."""
        return cls(_core.Geometry.plane(_triple(normal, "normal"), _arrays.real(offset, "offset")), "plane")

    @classmethod
    def hull(cls, points: Any) -> "Geometry":
        """Returns the convex hull of points, shape (n, 3)."""
        return cls(_core.Geometry.hull(_arrays.numbers(points, "points", (None, 3), copy=True)), "hull")

    @classmethod
    def mesh(cls, vertices: Any, faces: Any, *, weld: float = 0) -> "Geometry":
        """Returns a triangle mesh.

        Parameters
        ----------
        vertices : array, shape (n, 3)
            Corners.
        faces : array, shape (m, 3), integers
            Triangles, counterclockwise seen from outside.
        weld : float
            Joins vertices at the edges of gaps that are at most this apart.
        """
        return cls(_core.Geometry.mesh(_arrays.numbers(vertices, "vertices", (None, 3), copy=True),
                                       face_array(faces), _arrays.length(weld, "weld")), "mesh")

    @property
    def closed(self) -> bool:
        """False if a part of a mesh is not closed. Such a part has no inside. True for other shapes."""
        return self._geometry.closed

    @property
    def kind(self) -> str:
        """Name of the shape."""
        return self._kind

    def __repr__(self) -> str:
        return f"Geometry({self._kind}{'' if self.closed else ', open'})"


def _triple(value: Any, name: str) -> List[float]:
    array = _arrays.numbers(value, name, (3,), copy=True)
    return [float(number) for number in array]


def face_array(faces: Any, name: str = "faces") -> Array:
    """Returns triangles as uint32, shape (m, 3)."""
    array = _arrays.array_of(faces, name, copy=True)
    if array.size == 0:
        array = array.reshape(-1, 3).astype(np.uint32)
    if array.dtype.kind not in "iu":
        raise InputTypeError(f"{name}: the dtype is {array.dtype}; it must be an integer")
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name}: the shape is {array.shape}; it must be (n, 3)")
    if array.size and (array.min() < 0 or array.max() > 0xFFFFFFFF):
        raise InputError(f"{name}: an index is below 0 or above 4294967295")
    return np.ascontiguousarray(array, dtype=np.uint32)


def pose_array(poses: Any, name: str = "poses") -> Array:
    """Returns poses of shape (n, 3, 4), float64, from (n, 3, 4) or (n, 4, 4)."""
    array = _arrays.array_of(poses, name, copy=True)
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise InputError(f"{name}: the shape is {array.shape}; it must be (n, 3, 4) or (n, 4, 4)")
    if array.shape[1] == 4 and not np.array_equal(array[:, 3], np.broadcast_to([0, 0, 0, 1], (len(array), 4))):
        wrong = int(np.flatnonzero((array[:, 3] != [0, 0, 0, 1]).any(axis=1))[0])
        raise InputError(f"{name}: object {wrong}: the last row of the matrix is {array[wrong, 3]}, not [0 0 0 1]", wrong)
    found = np.array(_arrays.numbers(array[:, :3], name, (None, 3, 4), copy=True))
    found.flags.writeable = False
    return found


def make_poses(places: Any, rotations: Any = None) -> Array:
    """Returns poses of shape (n, 3, 4), float64, that rotate and then move.

    Parameters
    ----------
    places : array, shape (n, 3)
        Translations.
    rotations : array, shape (n, 4), optional
        Quaternions w, x, y, z of any length but 0.

    Examples
    --------
    >>> import octopair as op
    >>> op.make_poses([[1, 2, 3]])[0]
    array([[1., 0., 0., 1.],
           [0., 1., 0., 2.],
           [0., 0., 1., 3.]])
    """
    points = _arrays.numbers(places, "places", (None, 3), copy=True)
    turns = None if rotations is None else _arrays.numbers(rotations, "rotations", (len(points), 4), copy=True)
    return _core.make_poses(points, turns)


class Shapes:
    """Objects with shapes: object `i` has the geometry ``geometries[geometry[i]]`` and the pose ``poses[i]``. Never changes; arrays are
    copied.

    Parameters
    ----------
    geometries : sequence of Geometry
        Shapes.
    poses : array, shape (n, 3, 4) or (n, 4, 4)
        Affine maps. Meshes and hulls accept any map; other shapes only rotation and translation.
    geometry : array, shape (n,), integers, optional
        Which shape each object has. Default: object `i` has shape `i`.
    end_poses : array, shape of `poses`, optional
        Poses at time 1, for moving objects.
    padding : array, shape (n,), float64, or float, optional
        Clearance of each object.
    names : sequence of str, optional
        Names of the objects.

    Examples
    --------
    >>> import octopair as op
    >>> balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0], [1.5, 0, 0], [9, 0, 0]]), [0, 0, 0])
    >>> op.collide(balls)
    Collisions(1: 1 penetrating; 1 contacts)
    """

    def __init__(self, geometries: Sequence[Geometry], poses: Any, geometry: Any = None, *, end_poses: Any = None,
                 padding: Any = None, names: Optional[Sequence[str]] = None) -> None:
        try:
            shapes = list(geometries)
        except TypeError:
            raise InputTypeError(f"geometries: a {type(geometries).__name__} is not a sequence; pass [geometry]") from None
        for number, shape in enumerate(shapes):
            if not isinstance(shape, Geometry):
                raise InputTypeError(f"geometries: element {number} is a {type(shape).__name__}, not a Geometry")
        self._geometries = shapes
        self._poses = pose_array(poses)
        size = len(self._poses)
        numbers = np.arange(size) if geometry is None else _arrays.array_of(geometry, "geometry", copy=True)
        if numbers.ndim != 1 or len(numbers) != size:
            raise InputError(f"geometry: the shape is {numbers.shape}; it must be ({size},), one number per pose")
        if size and (numbers.dtype.kind not in "iu" or numbers.min() < 0 or numbers.max() > 0xFFFFFFFF):
            raise InputError("geometry: it must have integers that are not below 0")
        self._geometry = np.array(numbers, dtype=np.uint32)
        self._end_poses = None if end_poses is None else pose_array(end_poses, "end_poses")
        if self._end_poses is not None and len(self._end_poses) != size:
            raise InputError(f"end_poses: {len(self._end_poses)} poses for {size} objects")
        column = _arrays.column(padding, "padding", size, np.float64, copy=True)
        self._padding = None if column is None else np.array(column)
        for array in (self._geometry, self._padding):
            if array is not None:
                array.flags.writeable = False
        if isinstance(names, str) or (names is not None and not hasattr(names, "__iter__")):
            raise InputTypeError(f"names: {names!r} is not a sequence of str")
        self._names = None if names is None else [str(name) for name in names]
        if self._names is not None and len(self._names) != size:
            raise InputError(f"names: {len(self._names)} names for {size} objects")
        self._shapes = _core.Shapes([shape._geometry for shape in shapes],
                                    (self._geometry, self._poses, self._end_poses, self._padding))

    @property
    def geometries(self) -> List[Geometry]:
        """Shapes."""
        return list(self._geometries)

    @property
    def poses(self) -> Array:
        """Pose of each object, shape (n, 3, 4), float64; read-only."""
        return self._poses

    @property
    def geometry(self) -> Array:
        """Number of each object's shape, uint32; read-only."""
        return self._geometry

    @property
    def end_poses(self) -> Optional[Array]:
        """Poses at time 1, or None; read-only."""
        return self._end_poses

    @property
    def padding(self) -> Optional[Array]:
        """Clearance of each object, or None; read-only."""
        return self._padding

    @property
    def names(self) -> Optional[List[str]]:
        """Names of the objects, or None."""
        return None if self._names is None else list(self._names)

    @classmethod
    def from_trimesh(cls, source: Any, *, weld: float = 0) -> "Shapes":
        """Returns the objects of a trimesh.Trimesh or trimesh.Scene, or of an object with the same interface.

        Parameters
        ----------
        source : object
            A mesh has ``vertices`` and ``faces``. A scene has ``geometry`` (a dict of meshes) and ``graph`` (``nodes_geometry`` and
            ``graph[node]`` = matrix and name of the geometry). Geometries without faces (paths, point clouds) are left out.
        weld : float
            As in :meth:`Geometry.mesh`.
        """
        if hasattr(source, "vertices") and hasattr(source, "faces"):
            return cls([Geometry.mesh(source.vertices, source.faces, weld=weld)], np.eye(4)[None], names=["mesh"])
        if not hasattr(source, "graph") or not hasattr(source, "geometry"):
            raise InputTypeError(f"a {type(source).__name__} has neither vertices and faces nor graph and geometry")
        numbers: Dict[str, int] = {}
        geometries: List[Geometry] = []
        for name, mesh in source.geometry.items():
            if hasattr(mesh, "faces"):
                numbers[name] = len(geometries)
                geometries.append(Geometry.mesh(mesh.vertices, mesh.faces, weld=weld))
        found = [(node, *source.graph[node]) for node in source.graph.nodes_geometry]
        found = [(node, matrix, name) for node, matrix, name in found if name in numbers]
        poses = np.array([matrix for _, matrix, _ in found], dtype=np.float64).reshape(-1, 4, 4)
        return cls(geometries, poses, [numbers[name] for _, _, name in found], names=[str(node) for node, _, _ in found])

    def boxes(self, against: Optional["Shapes"] = None) -> Any:
        """Returns the boxes of the objects, shape (n, 6), float64, without padding, rounded outward; with `against`, of both sets.

        The box of a moving object contains its whole motion.
        """
        if against is not None and not isinstance(against, Shapes):
            raise InputTypeError(f"against: a {type(against).__name__} is not a Shapes")
        return self._shapes.boxes() if against is None else self._shapes.boxes_with(against._shapes)

    def __len__(self) -> int:
        """Returns the number of objects."""
        return len(self.poses)

    def __repr__(self) -> str:
        return f"Shapes({len(self):,} objects, {len(self.geometries):,} geometries)"
