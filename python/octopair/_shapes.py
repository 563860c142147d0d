"""Shapes: exact geometry of objects."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Tuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._arrays import Array
from ._errors import InputError, InputTypeError


class Geometry:
    """A shape that is prepared for exact tests. Objects of equal shape should share one. Made by its class methods.

    A shape is centred at the origin of its local space; an axis is the z axis. All shapes but planes and open meshes are solid. Never
    changes; copies are the same object. Can be pickled; the shape is prepared again where it is loaded.
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
    def box(cls, half_extents: ArrayLike) -> "Geometry":
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
    def ellipsoid(cls, radii: ArrayLike) -> "Geometry":
        """Returns an ellipsoid with these radii along x, y, z."""
        return cls(_core.Geometry.ellipsoid(_triple(radii, "radii")), "ellipsoid")

    @classmethod
    def plane(cls, normal: ArrayLike, offset: float) -> "Geometry":
        """Returns the points x with ``normal * x = offset``: a surface without an interior."""
        return cls(_core.Geometry.plane(_triple(normal, "normal"), _arrays.real(offset, "offset")), "plane")

    @classmethod
    def hull(cls, points: ArrayLike) -> "Geometry":
        """Returns the convex hull of points, shape (n, 3)."""
        return cls(_core.Geometry.hull(_arrays.numbers(points, "points", (None, 3))), "hull")

    @classmethod
    def mesh(cls, vertices: ArrayLike, faces: ArrayLike, *, weld: float = 0) -> "Geometry":
        """Returns a triangle mesh.

        Parameters
        ----------
        vertices : array-like, shape (n, 3)
            Corners.
        faces : array-like of integers, shape (m, 3)
            Triangles, counterclockwise seen from outside.
        weld : float
            Joins vertices at the edges of gaps that are at most this apart.
        """
        return cls(_core.Geometry.mesh(_arrays.numbers(vertices, "vertices", (None, 3)), _arrays.integers(faces, "faces", (None, 3)),
                                       _arrays.length(weld, "weld")), "mesh")

    @property
    def closed(self) -> bool:
        """False if a part of a mesh is not closed. Such a part has no inside. True for other shapes."""
        return self._geometry.closed

    @property
    def kind(self) -> str:
        """Name of the shape."""
        return self._kind

    def __reduce__(self) -> Tuple[Any, ...]:
        return _geometry_of, self._geometry.recipe()

    def __copy__(self) -> "Geometry":
        return self

    def __deepcopy__(self, memo: Dict[int, Any]) -> "Geometry":
        return self

    def __repr__(self) -> str:
        return f"Geometry({self._kind}{'' if self.closed else ', open'})"


def _geometry_of(kind: str, *arguments: Any) -> Geometry:
    """Makes a geometry that was pickled."""
    return Geometry(getattr(_core.Geometry, kind)(*arguments), kind)


def _triple(value: ArrayLike, name: str) -> List[float]:
    return [float(number) for number in _arrays.numbers(value, name, (3,))]


def _pose_array(poses: ArrayLike, name: str) -> Array:
    """Returns poses of shape (n, 3, 4), float64, read-only, from (n, 3, 4) or (n, 4, 4)."""
    array = _arrays.array_of(poses, name)
    if array.shape == (0,):
        array = array.reshape(0, 3, 4)
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise InputError(f"{name}: the shape is {array.shape}; it must be (n, 3, 4) or (n, 4, 4)")
    if array.shape[1] == 4 and not np.array_equal(array[:, 3], np.broadcast_to([0, 0, 0, 1], (len(array), 4))):
        wrong = int(np.flatnonzero((array[:, 3] != [0, 0, 0, 1]).any(axis=1))[0])
        raise InputError(f"{name}: object {wrong}: the last row of the matrix is {array[wrong, 3]}, not [0 0 0 1]", wrong)
    return _own(_arrays.numbers(array[:, :3], name, (None, 3, 4)))


def _own(array: Array) -> Array:
    """Returns a read-only copy."""
    found = np.array(array)
    found.flags.writeable = False
    return found


def make_poses(places: ArrayLike, rotations: Optional[ArrayLike] = None) -> NDArray[np.float64]:
    """Returns poses of shape (n, 3, 4), float64, that rotate and then move.

    Parameters
    ----------
    places : array-like, shape (n, 3)
        Translations.
    rotations : array-like, shape (n, 4), optional
        Quaternions w, x, y, z of any length but 0.

    Examples
    --------
    >>> import octopair as op
    >>> op.make_poses([[1, 2, 3]])[0]
    array([[1., 0., 0., 1.],
           [0., 1., 0., 2.],
           [0., 0., 1., 3.]])
    """
    points = _arrays.numbers(places, "places", (None, 3))
    turns = None if rotations is None else _arrays.numbers(rotations, "rotations", (len(points), 4))
    return _core.make_poses(points, turns)


class Shapes:
    """Objects with shapes: object `i` has the geometry ``geometries[geometry[i]]`` and the pose ``poses[i]``. Never changes; arrays are
    copied. Can be pickled; copies are the same object.

    Parameters
    ----------
    geometries : sequence of Geometry
        Shapes.
    poses : array-like, shape (n, 3, 4) or (n, 4, 4)
        Affine maps. Meshes and hulls accept any map; other shapes only rotation and translation.
    geometry : array-like of integers, shape (n,), optional
        Which shape each object has. Default: object `i` has shape `i`.
    end_poses : array-like, shape of `poses`, optional
        Poses at time 1, for moving objects.
    padding : array-like, shape (n,), or float, optional
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

    def __init__(self, geometries: Sequence[Geometry], poses: ArrayLike, geometry: Optional[ArrayLike] = None, *,
                 end_poses: Optional[ArrayLike] = None, padding: Optional[ArrayLike] = None,
                 names: Optional[Sequence[str]] = None) -> None:
        try:
            shapes = list(geometries)
        except TypeError:
            raise InputTypeError(f"geometries: a {type(geometries).__name__} is not a sequence; pass [geometry]") from None
        for number, shape in enumerate(shapes):
            if not isinstance(shape, Geometry):
                raise InputTypeError(f"geometries: element {number} is a {type(shape).__name__}, not a Geometry")
        self._geometries = shapes
        self._poses = _pose_array(poses, "poses")
        size = len(self._poses)
        self._geometry = _own(_arrays.integers(np.arange(size) if geometry is None else geometry, "geometry", (None,)))
        if len(self._geometry) != size:
            raise InputError(f"geometry: {len(self._geometry)} numbers for {size} poses; each object needs one")
        self._end_poses = None if end_poses is None else _pose_array(end_poses, "end_poses")
        if self._end_poses is not None and len(self._end_poses) != size:
            raise InputError(f"end_poses: {len(self._end_poses)} poses for {size} objects")
        column = _arrays.column(padding, "padding", size, np.float64)
        self._padding = None if column is None else _own(column)
        if isinstance(names, str) or (names is not None and not hasattr(names, "__iter__")):
            raise InputTypeError(f"names: {names!r} is not a sequence of str")
        self._names = None if names is None else [str(name) for name in names]
        if self._names is not None and len(self._names) != size:
            raise InputError(f"names: {len(self._names)} names for {size} objects")
        self._shapes = _core.Shapes([shape._geometry for shape in shapes],
                                    (self._geometry, self._poses, self._end_poses, self._padding))

    def __reduce__(self) -> Tuple[Any, ...]:
        return _shapes_of, (self._geometries, self._poses, self._geometry, self._end_poses, self._padding, self._names)

    def __copy__(self) -> "Shapes":
        return self

    def __deepcopy__(self, memo: Dict[int, Any]) -> "Shapes":
        return self

    @property
    def geometries(self) -> List[Geometry]:
        """Shapes."""
        return list(self._geometries)

    @property
    def poses(self) -> NDArray[np.float64]:
        """Pose of each object, shape (n, 3, 4), float64; read-only."""
        return self._poses

    @property
    def geometry(self) -> NDArray[np.uint32]:
        """Number of each object's shape, uint32; read-only."""
        return self._geometry

    @property
    def end_poses(self) -> Optional[NDArray[np.float64]]:
        """Poses at time 1, or None; read-only."""
        return self._end_poses

    @property
    def padding(self) -> Optional[NDArray[np.float64]]:
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

    @overload
    def boxes(self, against: None = ...) -> NDArray[np.float64]: ...

    @overload
    def boxes(self, against: Shapes) -> Tuple[NDArray[np.float64], NDArray[np.float64]]: ...

    def boxes(self, against: Optional[Shapes] = None) -> Any:
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


def _shapes_of(geometries: List[Geometry], poses: Array, geometry: Array, end_poses: Optional[Array], padding: Optional[Array],
               names: Optional[List[str]]) -> Shapes:
    """Makes shapes that were pickled."""
    return Shapes(geometries, poses, geometry, end_poses=end_poses, padding=padding, names=names)
