"""Scenes: objects that persist and move."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, Optional, Tuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays, _core
from ._arrays import Array
from ._errors import InputError, InputTypeError
from ._options import MOST_THREADS, PathLike, float_dtype, path_text
from ._octants import Octants
from ._results import Answers, Hits, Neighbors, StepResult

if TYPE_CHECKING:
    from ._viewer import View

ALL_GROUPS = 0xFFFFFFFF
Ids = NDArray[np.void]
_Scene = TypeVar("_Scene", bound="SceneCalls")


class SceneCalls:
    """Calls of local and remote scenes. Objects are named by the ids that :meth:`add` returned, or by their indices."""

    _scene: Any
    _dtype: np.dtype[Any]
    _margin: float
    _closed: bool

    def _start(self, margin: float, dtype: DTypeLike) -> None:
        self._dtype = float_dtype(dtype)
        self._margin = _arrays.margin_of(margin)
        self._closed = False

    def add(self, boxes: ArrayLike, *, groups: Optional[ArrayLike] = None, mask: Optional[ArrayLike] = None,
            fixed: Optional[ArrayLike] = None, padding: Optional[ArrayLike] = None, copy: bool = False) -> Ids:
        """Adds objects and returns their ids.

        Parameters
        ----------
        boxes : array-like, shape (n, 6) or (n, 4)
            Boxes or spheres, as in :func:`octopair.find_pairs`. Arrays of another dtype are converted to that of the scene if no value
            changes; numbers in lists are rounded to it.
        groups, mask : array-like of integers, shape (n,), or int, optional
            Objects can form a pair if each one's mask has a bit of the other's groups. 32 bits. Defaults: 1 and all bits.
        fixed : array-like of bool, shape (n,), or bool, optional
            Two fixed objects never form a pair.
        padding : array-like, shape (n,), or float, optional
            Clearance of each object.
        copy : bool
            True: rounds the numbers of all arrays to the scene's dtype.

        Returns
        -------
        numpy.ndarray
            Shape (n,), dtype :data:`octopair.id_dtype`. ``ids["index"]`` are the numbers that pairs and queries use.
        """
        data = self._boxes(boxes, copy)
        column = _arrays.column(padding, "padding", len(data), np.float64, copy)
        ids = np.empty(len(data), dtype=_arrays.id_dtype)
        traits = _traits(len(data), (groups, mask, fixed), copy)
        self._scene.add(_core.Input(data, column), ids, traits)
        return ids

    def move(self, ids: ArrayLike, boxes: ArrayLike, *, copy: bool = False) -> None:
        """Gives objects new boxes.

        Parameters
        ----------
        ids : array-like, shape (n,)
            Ids, or indices. If an object is there twice, its last box counts. An index stands for the object that has it now; an
            index without an object is an error.
        boxes : array-like, shape (n, 6) or (n, 4)
            As in :meth:`add`.
        copy : bool
            As in :meth:`add`.
        """
        self._scene.move(self._ids(ids), self._boxes(boxes, copy))

    def sweep(self, ids: ArrayLike, boxes: ArrayLike, *, copy: bool = False) -> None:
        """Like :meth:`move`, but in the next step the box of an object is the union of its old and its new box."""
        self._scene.sweep(self._ids(ids), self._boxes(boxes, copy))

    def remove(self, ids: ArrayLike) -> None:
        """Removes objects. `ids`: as in :meth:`move`."""
        self._scene.remove(self._ids(ids))

    def set_traits(self, ids: ArrayLike, *, groups: Optional[ArrayLike] = None, mask: Optional[ArrayLike] = None,
                   fixed: Optional[ArrayLike] = None, copy: bool = False) -> None:
        """Replaces groups, mask and fixed of objects. What is not given becomes the default of :meth:`add`."""
        objects = self._ids(ids)
        traits = _traits(len(objects), (groups, mask, fixed), copy)
        if all(column is None for column in traits):
            traits = (np.ones(len(objects), dtype=np.uint32), None, None)
        self._scene.set_traits(objects, traits)

    def step(self) -> StepResult:
        """Finds the pairs that began and ended since the last step.

        Raises
        ------
        MemoryError
            The pairs, or the arrays of the result, do not fit into memory. Call :meth:`step` again. Until then, calls that change or
            search the scene, or that list pairs, may raise :class:`UsageError`.
        """
        return StepResult(*self._scene.step())

    def pairs(self) -> NDArray[np.uint32]:
        """Returns all pairs of the last step, ascending; shape (m, 2), uint32."""
        return self._scene.pairs()

    def persisting(self) -> NDArray[np.uint32]:
        """Returns the pairs of the last step that existed before it."""
        return self._scene.persisting()

    def contains(self, ids: ArrayLike) -> NDArray[np.bool_]:
        """Returns for each id whether its object is in the scene, or for each index whether it has an object; shape (n,), bool."""
        named = _named(ids)
        return self._scene.contains(named) if named.dtype == _arrays.id_dtype else self._scene.exist(named)

    def ids_at(self, indices: ArrayLike) -> Ids:
        """Returns the ids of the objects with these indices, for example of ``pairs()[:, 0]``.

        Raises
        ------
        InputError
            If an index has no object.
        """
        return self._found(_arrays.integers(indices, "indices", (None,)), "indices")

    def ids(self, indices: ArrayLike) -> Ids:
        """Another name of :meth:`ids_at`."""
        return self.ids_at(indices)

    def _found(self, indices: Array, name: str) -> Ids:
        ids = np.empty(len(indices), dtype=_arrays.id_dtype)
        try:
            self._scene.ids_at(indices, ids)
        except InputError as error:
            raise InputError(f"{name}: {error}", error.index) from None
        return ids

    def _ids(self, value: Any) -> Ids:
        """Returns ids of ids or indices."""
        named = _named(value)
        return named if named.dtype == _arrays.id_dtype else self._found(named, "ids")

    def close(self) -> None:
        """Ends the scene and its connection. Later calls raise :class:`UsageError`.

        Waits for a call of another thread. A second call does nothing.
        """
        self._scene.close()
        self._closed = True

    def __enter__(self: _Scene) -> _Scene:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __len__(self) -> int:
        """Returns the number of objects."""
        return self._scene.size()

    @property
    def indices(self) -> int:
        """Upper bound of the indices: every index is smaller."""
        return self._scene.indices()

    @property
    def dtype(self) -> np.dtype[Any]:
        """dtype of the boxes."""
        return self._dtype

    @property
    def margin(self) -> float:
        """Largest gap, per axis, at which a pair counts."""
        return self._margin

    def _boxes(self, boxes: Any, copy: bool) -> Array:
        return _arrays.boxes(boxes, "boxes", copy, self._dtype)

    def __repr__(self) -> str:
        objects = "closed" if self._closed else f"{len(self):,} objects"
        return f"{type(self).__name__}({objects}, dtype={self._dtype.name!r}, margin={self._margin:g})"


def _named(value: Any) -> Array:
    """Returns ids, or indices as uint32; shape (n,). A single id or index may have no axis."""
    if type(value) is np.ndarray and value.dtype == _arrays.id_dtype and value.ndim == 1 and value.flags.c_contiguous and value.flags.aligned:
        return value  # the usual case
    array = np.asarray(value) if isinstance(value, (int, np.integer)) else _arrays.array_of(value, "ids")
    if array.ndim == 0:
        array = array.reshape(1)
    if array.dtype != _arrays.id_dtype:
        if array.size and array.dtype.kind not in "iu":
            remedy = "of a mask, pass ids[mask]" if array.dtype.kind == "b" else "scene.ids_at(indices) returns ids"
            raise InputTypeError(f"ids: the dtype is {array.dtype}; pass ids that add() returned, or indices as integers; {remedy}")
        return _arrays.integers(array, "ids", (None,))
    return _arrays.contiguous(_arrays.shaped(array, "ids", (None,)))


def _traits(size: int, columns: Tuple[Any, Any, Any], copy: bool) -> Tuple[Optional[Array], ...]:
    groups, mask, fixed = columns
    return (_arrays.column(groups, "groups", size, np.uint32, copy), _arrays.column(mask, "mask", size, np.uint32, copy),
            _arrays.column(fixed, "fixed", size, np.bool_, copy))


def _rows(value: Any, name: str, widths: Tuple[int, ...]) -> Array:
    """Returns queries of shape (n, width), float64; a single query may have the shape (width,)."""
    array = _arrays.array_of(value, name)
    if array.ndim == 1 and array.size:
        array = array.reshape(1, -1)
    width = array.shape[-1] if array.ndim == 2 and array.shape[1] in widths else widths[-1]
    return _arrays.numbers(array, name, (None, width))


class Scene(SceneCalls):
    """Objects that persist and move, and the pairs that begin and end from step to step.

    The cost of a step follows the number of objects that moved. Calls of several Python threads run one after another.

    Parameters
    ----------
    margin : float
        Largest gap, per axis, at which a pair counts.
    dtype : {"float32", "float64"}
        dtype of the boxes.
    threads : int
        0: one per core.
    recording : path, optional
        File that records all calls, for :func:`octopair.replay`. An existing file is overwritten.
    slack : float
        Length by which the scene enlarges the boxes that it searches. Saves time if most objects move a little in each step.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> scene = op.Scene(dtype="float64")
    >>> ids = scene.add(np.array([[0, 0, 0, 1, 1, 1], [3, 0, 0, 4, 1, 1.0]]))
    >>> scene.step().began
    array([], shape=(0, 2), dtype=uint32)
    >>> scene.move(ids[1:], np.array([[1, 0, 0, 2, 1, 1.0]]))
    >>> scene.step().began
    array([[0, 1]], dtype=uint32)
    """

    def __init__(self, *, margin: float = 0, dtype: DTypeLike = "float32", threads: int = 0, recording: Optional[PathLike] = None,
                 slack: float = 0) -> None:
        self._start(margin, dtype)
        self._scene = _core.Scene({"threads": _arrays.whole(threads, "threads", MOST_THREADS), "float64": self._dtype == np.float64, "margin": self._margin,
                                   "recording": "" if recording is None else path_text(recording, "recording"), "slack": _arrays.real(slack, "slack")})
        self._views: "weakref.WeakSet[View]" = weakref.WeakSet()

    def close(self) -> None:
        """Ends the scene: closes its views, completes its recording, and frees its memory. Later calls raise :class:`UsageError`.

        Waits for a call of another thread. A second call does nothing.
        """
        for view in [*self._views]:
            view.close()
        super().close()

    def enlarged_pairs(self) -> NDArray[np.uint32]:
        """Returns the pairs of the boxes that the last step searched: with slack, enlarged boxes. They contain :meth:`pairs`."""
        return self._scene.enlarged_pairs()

    def verify(self) -> None:
        """Compares :meth:`pairs` with the pairs that a second algorithm finds, which shares no code with the octree.

        Call it directly after :meth:`step`.

        Raises
        ------
        EngineError
            if a pair is wrong or missing; the message names the pair
        UsageError
            if there was no step yet, or if an object was added, changed or removed after the last step
        """
        self._scene.verify()

    def boxes(self) -> NDArray[Any]:
        """Returns a copy of the current boxes by index; shape (:attr:`indices`, 6), in the scene's dtype.

        Rows of indices without an object are NaN. A swept object has its union box until the next step.
        """
        boxes, exists = self._scene.boxes()
        boxes[~exists] = np.nan
        return boxes

    def octants(self) -> Octants:
        """Lists the octants that a full search of the current boxes uses, without slack: :func:`octopair.list_octants` of these
        boxes, with indices as objects. A step may use other octants, because it searches only around what moved."""
        return Octants(*self._scene.octants())

    def overlaps(self, queries: ArrayLike, *, groups: int = ALL_GROUPS) -> Answers:
        """Finds the objects that overlap boxes or balls, touching included. Uses the current boxes, without margin and padding.

        Parameters
        ----------
        queries : array-like, shape (n, 6) or (n, 4)
            Boxes, or balls as centre x, y, z and radius. A single query may have one axis.
        groups : int
            Considers only objects that have one of these bits in their groups.

        Returns
        -------
        Answers
            Ascending by index for each query.
        """
        return Answers(*self._scene.overlaps(_rows(queries, "queries", (4, 6)), _arrays.whole(groups, "groups")))

    def first_hits(self, origins: ArrayLike, directions: ArrayLike, *, longest: ArrayLike = np.inf, groups: int = ALL_GROUPS) -> Hits:
        """Finds the first object that each ray hits, if there is one: the points ``origin + along * direction``.

        Parameters
        ----------
        origins, directions : array-like, shape (n, 3)
            Directions of any length but 0.
        longest : array-like, shape (n,), or float
            Largest `along`.
        groups : int
            As in :meth:`overlaps`.
        """
        return self._hits(origins, directions, longest, (False, _arrays.whole(groups, "groups")))

    def all_hits(self, origins: ArrayLike, directions: ArrayLike, *, longest: ArrayLike = np.inf, groups: int = ALL_GROUPS) -> Hits:
        """Finds all objects that each ray hits, ascending by `along`. Parameters are those of :meth:`first_hits`."""
        return self._hits(origins, directions, longest, (True, _arrays.whole(groups, "groups")))

    def _hits(self, origins: Any, directions: Any, longest: Any, which: Tuple[bool, int]) -> Hits:
        begins, ways = _rows(origins, "origins", (3,)), _rows(directions, "directions", (3,))
        if len(begins) != len(ways):
            raise InputError(f"{len(begins)} origins and {len(ways)} directions; each ray needs both")
        if longest is None:
            raise InputTypeError("longest: None is not a number; leave it out for rays without end")
        most: Any = _arrays.column(longest, "longest", len(begins), np.float64)
        indices, along, offsets = self._scene.hits(np.column_stack([begins, ways, most]), *which)
        return Hits(indices, offsets, along)

    def nearest(self, places: ArrayLike, *, k: int = 1, within: float = np.inf, groups: int = ALL_GROUPS) -> Neighbors:
        """Finds the `k` objects that are nearest to each place, by the distance between boxes; fewer if there are fewer.

        Parameters
        ----------
        places : array-like, shape (n, 3) or (n, 6)
            Points or boxes.
        k : int
            Maximum number of objects. A single query is not interrupted, so Ctrl-C may take longer for a very large `k`.
        within : float
            Maximum distance.
        groups : int
            As in :meth:`overlaps`.

        Returns
        -------
        Neighbors
            Ascending by distance for each place.
        """
        rows = _rows(places, "places", (3, 6))
        if rows.shape[1] == 3:
            rows = np.hstack([rows, rows])
        limits = (_arrays.whole(k, "k"), _arrays.real(within, "within"))
        indices, distances, offsets = self._scene.nearest(rows, limits, _arrays.whole(groups, "groups"))
        return Neighbors(indices, offsets, distances)
