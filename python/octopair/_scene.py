"""Scenes: objects that persist and move."""

from __future__ import annotations

import os
from typing import Any, Optional, Tuple, Union

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._errors import InputError, InputTypeError
from ._options import MOST_THREADS, float_dtype, path_text
from ._octants import Octants
from ._results import Answers, Hits, Neighbors, StepResult

ALL_GROUPS = 0xFFFFFFFF


class SceneCalls:
    """Calls of local and remote scenes."""

    _scene: Any
    _dtype: np.dtype[Any]
    _margin: float

    def add(self, boxes: Any, *, groups: Any = None, mask: Any = None, fixed: Any = None, padding: Any = None,
            copy: bool = False) -> Array:
        """Adds objects and returns their ids.

        Parameters
        ----------
        boxes : array, shape (n, 6)
            In the scene's dtype.
        groups, mask : array, shape (n,), uint32, or int, optional
            Objects can form a pair if each one's mask has a bit of the other's groups. Defaults: 1 and all bits.
        fixed : array, shape (n,), bool, or bool, optional
            Two fixed objects never form a pair.
        padding : array, shape (n,), float64, or float, optional
            Clearance of each object.
        copy : bool
            True: converts arrays of another dtype or layout instead of refusing them.

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

    def move(self, ids: Any, boxes: Any, *, copy: bool = False) -> None:
        """Gives objects new boxes.

        Parameters
        ----------
        ids : array, shape (n,), id_dtype
            If an object is there twice, its last box counts.
        boxes : array, shape (n, 6)
            In the scene's dtype.
        copy : bool
            True: converts arrays of another dtype or layout instead of refusing them.
        """
        self._scene.move(_arrays.ids(ids), self._boxes(boxes, copy))

    def sweep(self, ids: Any, boxes: Any, *, copy: bool = False) -> None:
        """Like :meth:`move`, but in the next step the box of an object is the union of its old and its new box."""
        self._scene.sweep(_arrays.ids(ids), self._boxes(boxes, copy))

    def remove(self, ids: Any) -> None:
        """Removes objects."""
        self._scene.remove(_arrays.ids(ids))

    def set_traits(self, ids: Any, *, groups: Any = None, mask: Any = None, fixed: Any = None, copy: bool = False) -> None:
        """Replaces groups, mask and fixed of objects. What is not given becomes the default of :meth:`add`."""
        objects = _arrays.ids(ids)
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

    def pairs(self) -> Array:
        """Returns all pairs of the last step, ascending; shape (m, 2), uint32."""
        return self._scene.pairs()

    def persisting(self) -> Array:
        """Returns the pairs of the last step that existed before it."""
        return self._scene.persisting()

    def contains(self, ids: Any) -> Array:
        """Returns for each id whether its object is in the scene; shape (n,), bool."""
        return self._scene.contains(_arrays.ids(ids))

    def ids(self, indices: Any) -> Array:
        """Returns the ids of the objects with these indices (uint32), for example of ``pairs()[:, 0]``."""
        array = np.ascontiguousarray(_arrays.array_of(indices, "indices", copy=True))
        if array.size == 0:
            array = array.reshape(-1).astype(np.uint32)
        if array.dtype.kind not in "iu" or array.ndim != 1:
            raise InputTypeError("indices: it must be an array of integers of the shape (n,)")
        if array.size and (array.min() < 0 or array.max() > ALL_GROUPS):
            raise InputError("indices: an index is below 0 or above 4294967295")
        ids = np.empty(len(array), dtype=_arrays.id_dtype)
        self._scene.ids_at(array.astype(np.uint32), ids)
        return ids

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
        data = _arrays.boxes(boxes, "boxes", copy)
        if data.dtype == self._dtype:
            return data
        if not copy:
            raise InputTypeError(f"boxes: the dtype is {data.dtype}, but the scene has {self._dtype}; pass "
                                 f"boxes.astype(numpy.{self._dtype}), or pass copy=True")
        return data.astype(self._dtype)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self):,} objects, dtype={self._dtype.name!r}, margin={self._margin:g})"


def _traits(size: int, columns: Tuple[Any, Any, Any], copy: bool) -> Tuple[Optional[Array], ...]:
    groups, mask, fixed = columns
    return (_arrays.column(groups, "groups", size, np.uint32, copy), _arrays.column(mask, "mask", size, np.uint32, copy),
            _arrays.column(fixed, "fixed", size, np.bool_, copy))


def _rows(value: Any, name: str, width: int) -> Array:
    """Returns queries of shape (n, width), float64; a single query may have the shape (width,)."""
    array = _arrays.array_of(value, name, copy=True)
    if array.ndim == 1:
        array = array.reshape(1, -1)
    return _arrays.numbers(array, name, (None, width), copy=True)


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

    def __init__(self, margin: float = 0, dtype: Any = "float32", *, threads: int = 0,
                 recording: Union[None, str, "os.PathLike[str]"] = None, slack: float = 0) -> None:
        self._dtype = float_dtype(dtype)
        self._margin = _arrays.real(margin, "margin")
        self._scene = _core.Scene({"threads": _arrays.whole(threads, "threads", MOST_THREADS), "float64": self._dtype == np.float64, "margin": self._margin,
                                   "recording": "" if recording is None else path_text(recording, "recording"), "slack": _arrays.real(slack, "slack")})

    def enlarged_pairs(self) -> Array:
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

    def boxes(self) -> Array:
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

    def overlaps(self, queries: Any, *, groups: int = ALL_GROUPS) -> Answers:
        """Finds the objects that overlap boxes or balls, touching included. Uses the current boxes, without margin and padding.

        Parameters
        ----------
        queries : array, shape (n, 6) or (n, 4)
            Boxes, or balls as centre x, y, z and radius; converted to float64. A single query may have one axis.
        groups : int
            Considers only objects that have one of these bits in their groups.

        Returns
        -------
        Answers
            Ascending by index for each query.
        """
        array = _arrays.array_of(queries, "queries", copy=True)
        width = 4 if array.ndim and array.shape[-1] == 4 else 6
        return Answers(*self._scene.overlaps(_rows(array, "queries", width), _arrays.whole(groups, "groups")))

    def first_hits(self, origins: Any, directions: Any, *, longest: Any = np.inf, groups: int = ALL_GROUPS) -> Hits:
        """Finds the first object that each ray hits, if there is one: the points ``origin + along * direction``.

        Parameters
        ----------
        origins, directions : array, shape (n, 3)
            Converted to float64. Directions of any length but 0.
        longest : array, shape (n,), or float
            Largest `along`.
        groups : int
            As in :meth:`overlaps`.
        """
        return self._hits(origins, directions, longest, (False, _arrays.whole(groups, "groups")))

    def all_hits(self, origins: Any, directions: Any, *, longest: Any = np.inf, groups: int = ALL_GROUPS) -> Hits:
        """Finds all objects that each ray hits, ascending by `along`. Parameters are those of :meth:`first_hits`."""
        return self._hits(origins, directions, longest, (True, _arrays.whole(groups, "groups")))

    def _hits(self, origins: Any, directions: Any, longest: Any, which: Tuple[bool, int]) -> Hits:
        begins, ways = _rows(origins, "origins", 3), _rows(directions, "directions", 3)
        if len(begins) != len(ways):
            raise InputError(f"{len(begins)} origins and {len(ways)} directions; each ray needs both")
        if longest is None:
            raise InputTypeError("longest: None is not a number; leave it out for rays without end")
        most: Any = _arrays.column(longest, "longest", len(begins), np.float64, copy=True)
        indices, along, offsets = self._scene.hits(np.column_stack([begins, ways, most]), *which)
        return Hits(indices, offsets, along)

    def nearest(self, places: Any, k: int = 1, *, within: float = np.inf, groups: int = ALL_GROUPS) -> Neighbors:
        """Finds the `k` objects that are nearest to each place, by the distance between boxes; fewer if there are fewer.

        Parameters
        ----------
        places : array, shape (n, 3) or (n, 6)
            Points or boxes; converted to float64.
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
        array = _arrays.array_of(places, "places", copy=True)
        width = 3 if array.ndim and array.shape[-1] == 3 else 6
        rows = _rows(array, "places", width)
        if width == 3:
            rows = np.hstack([rows, rows])
        limits = (_arrays.whole(k, "k"), _arrays.real(within, "within"))
        indices, distances, offsets = self._scene.nearest(rows, limits, _arrays.whole(groups, "groups"))
        return Neighbors(indices, offsets, distances)
