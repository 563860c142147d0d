"""Collisions: the table of pairs that filters return."""

from __future__ import annotations

import copy
import dataclasses
import operator
from typing import TYPE_CHECKING, Any, Dict, ItemsView, Iterator, KeysView, List, Mapping, NoReturn, Optional, Tuple, ValuesView, overload

import numpy as np
from numpy.typing import NDArray

from ._arrays import Array
from ._errors import InputTypeError, UsageError
from ._results import COLLISION_CLASSES, DEPTH_KINDS, THICKNESS_KINDS, PipelineSummary, html_table

_NO_FEATURE = 0xFFFFFFFF

if TYPE_CHECKING:
    _Columns = Mapping[str, Array]
else:
    class _Columns(Mapping, dict):
        """A read-only mapping that is also a dict, because pandas makes columns only of dicts.

        The values of the dict itself are None. So everything that would read or change them is defined here, or by Mapping. The names are
        in the dict, because functions of C ask it whether it is empty.
        """

        def __post_init__(self):
            for name in self:
                dict.__setitem__(self, name, None)

        def _refuse(self, *_: object, **__: object) -> NoReturn:
            raise InputTypeError("a table of collisions does not change; dict(table) and table.to_pandas() return copies of its columns")

        __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse
        __eq__, __ne__, __hash__ = object.__eq__, object.__ne__, object.__hash__

        def __or__(self, other):
            return dict(self) | dict(other)

        def __ror__(self, other):
            return dict(other) | dict(self)

        def copy(self):
            return copy.copy(self)


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Collisions(_Columns):
    """Pairs with what exact filters found: a mapping of columns with an element per pair, like a DataFrame of pandas.

    ``list(table)`` are the names of the columns, ``table["depth"]`` is a column, ``dict(table)`` are all columns, ``len(table)`` is the
    number of pairs, and ``table[0]`` is a row as a dict. ``pandas.DataFrame(table)`` has a row for each pair. The columns are a, b, name_a and
    name_b (of objects with names), class, distance, depth, depth_kind, depth_at_most, thickness, thickness_kind, time, and contacts, which are
    numbers of contacts.

    Attributes are the same columns and further arrays; ``table["nearest"]`` is another form of ``table.nearest``, and so on. Lengths are in
    the caller's unit. A value that no filter computed is 0.

    Attributes
    ----------
    pairs : numpy.ndarray
        Indices of the objects, shape (m, 2), uint32.
    class_codes : numpy.ndarray
        Positions in ``COLLISION_CLASSES``, uint8.
    distance : numpy.ndarray
        Distance of objects that do not meet, float64.
    nearest : numpy.ndarray
        Nearest points of objects that do not meet, shape (m, 2, 3), float64.
    depth : numpy.ndarray
        Penetration depth of objects that meet, float64. 0 for duplicates: equal objects in one place.
    depth_kind : numpy.ndarray
        Positions in ``DEPTH_KINDS``, uint8: whether the depth is the least one, or a lower bound. The column has the names.
    depth_at_most : numpy.ndarray
        Length of a translation that was found to separate the objects, float64.
    thickness : numpy.ndarray
        Diameter of the largest ball in both objects, as far as a tolerance > 0 was compared with it, float64.
    thickness_kind : numpy.ndarray
        Positions in ``THICKNESS_KINDS``, uint8: whether the thickness is an upper or a lower bound. The column has the names.
    open : numpy.ndarray
        Whether the first and the second object are meshes with a part that is not closed, shape (m, 2), bool.
    time : numpy.ndarray
        Time of impact of moving objects, 0 to 1, float64.
    more_contacts : numpy.ndarray
        True where contacts were left out because of a limit.
    note : numpy.ndarray
        Free for filters of C++.
    contact_offsets : numpy.ndarray
        The contacts of row `i` are at ``contact_offsets[i]`` to ``contact_offsets[i + 1]``; shape (m + 1,), int64. Objects that are contained
        or duplicate have no contacts.
    contact_points, contact_normals : numpy.ndarray
        Shape (contacts, 3), float64. A normal is a unit vector from a to b.
    contact_depths : numpy.ndarray
        If b moves by this along the normal, the contact ends; float64.
    contact_features : numpy.ndarray
        Indices of the triangles of a and b, shape (contacts, 2), uint32; 0xFFFFFFFF: the object is not a mesh.
    summary : PipelineSummary or None
        Counts and times of the whole run; None for a batch.
    names, against_names : list of str or None
        Names of the objects that `a` and `b` number. They are the same without a second set.

    Examples
    --------
    >>> import octopair as op
    >>> balls = op.Shapes([op.Geometry.sphere(1)], op.make_poses([[0, 0, 0], [1.5, 0, 0], [9, 0, 0]]), [0, 0, 0])
    >>> table = op.collide(balls)
    >>> list(table)
    ['a', 'b', 'class', 'distance', 'depth', 'depth_kind', 'depth_at_most', 'thickness', 'thickness_kind', 'time', 'contacts']
    >>> table["depth"], table[0]["class"], table[0]["contacts"][0]["point"]
    (array([0.5]), 'penetrating', [0.75, 0.0, 0.0])
    """

    pairs: NDArray[np.uint32]
    class_codes: NDArray[np.uint8]
    distance: NDArray[np.float64]
    nearest: NDArray[np.float64]
    depth: NDArray[np.float64]
    depth_kind: NDArray[np.uint8]
    depth_at_most: NDArray[np.float64]
    thickness: NDArray[np.float64]
    thickness_kind: NDArray[np.uint8]
    open: NDArray[np.bool_]
    time: NDArray[np.float64]
    more_contacts: NDArray[np.bool_]
    note: NDArray[np.uint64]
    contact_offsets: NDArray[np.int64]
    contact_points: NDArray[np.float64]
    contact_normals: NDArray[np.float64]
    contact_depths: NDArray[np.float64]
    contact_features: NDArray[np.uint32]
    summary: Optional[PipelineSummary] = None
    names: Optional[List[str]] = None
    against_names: Optional[List[str]] = None

    @property
    def a(self) -> NDArray[np.uint32]:
        """Index of the first object of each pair."""
        return self.pairs[:, 0]

    @property
    def b(self) -> NDArray[np.uint32]:
        """Index of the second object of each pair."""
        return self.pairs[:, 1]

    @property
    def class_(self) -> NDArray[np.str_]:
        """Name of each row's class."""
        return np.array(COLLISION_CLASSES)[self.class_codes]

    def contacts(self, row: int) -> slice:
        """Returns the positions of the contacts of a row in the ``contact_`` arrays."""
        row = self._row(row)
        return slice(int(self.contact_offsets[row]), int(self.contact_offsets[row + 1]))

    def columns(self) -> Dict[str, Array]:
        """Returns the columns as a dict: the same as ``dict(table)``."""
        return {name: self[name] for name in self}

    def contact_columns(self) -> Dict[str, Array]:
        """Returns a table of all contacts as columns with an element per contact.

        ``row`` is the row of the collision. The others are a, b, x, y, z, normal_x, normal_y, normal_z, depth, feature_a and feature_b.
        """
        rows = np.repeat(np.arange(len(self)), self["contacts"])
        found: Dict[str, Array] = {"row": rows, "a": self.a[rows], "b": self.b[rows]}
        found.update(zip("xyz", self.contact_points.T))
        found.update(zip(("normal_x", "normal_y", "normal_z"), self.contact_normals.T))
        found["depth"] = self.contact_depths
        found.update(zip(("feature_a", "feature_b"), self.contact_features.T))
        return found

    def to_pandas(self, *, contacts: bool = False) -> Any:
        """Returns a pandas.DataFrame of the columns with a row per collision; with `contacts`, of :meth:`contact_columns`."""
        try:
            import pandas
        except ImportError as error:
            raise UsageError(f"to_pandas() needs pandas: {error}") from error
        return pandas.DataFrame(self.contact_columns() if contacts else self.columns())

    def to_dicts(self) -> List[Dict[str, Any]]:
        """Returns the rows as dicts of plain values, for example for :func:`json.dumps`.

        A row has the columns, the nearest points, ``open`` and ``more_contacts``. Its contacts are dicts of point, normal, depth and
        features (the triangles of a and b; None: the object is not a mesh).
        """
        return self._rows(0, len(self))

    def _rows(self, begin: int, end: int) -> List[Dict[str, Any]]:
        """Returns the rows begin to end."""
        offsets = self.contact_offsets[begin:end + 1].tolist()
        some = slice(offsets[0], offsets[-1])
        found = [{"point": point, "normal": normal, "depth": depth, "features": [None if i == _NO_FEATURE else i for i in features]}
                 for point, normal, depth, features in zip(self.contact_points[some].tolist(), self.contact_normals[some].tolist(),
                                                           self.contact_depths[some].tolist(), self.contact_features[some].tolist())]
        names = [*self, "nearest", "open", "more_contacts"]
        values = [self._column(name, slice(begin, end)).tolist() for name in names]
        rows = [dict(zip(names, row)) for row in zip(*values)]
        for row, first, last in zip(rows, offsets, offsets[1:]):
            row["contacts"] = found[first - some.start:last - some.start]
        return rows

    def _column(self, name: str, rows: slice) -> Array:
        """Returns the rows of a column, or of another array. Throws KeyError."""
        if name == "class":
            return np.array(COLLISION_CLASSES)[self.class_codes[rows]]
        if name == "depth_kind":
            return np.array(DEPTH_KINDS)[self.depth_kind[rows]]
        if name == "thickness_kind":
            return np.array(THICKNESS_KINDS)[self.thickness_kind[rows]]
        if name == "contacts":
            return np.diff(self.contact_offsets)[rows]
        if name in ("name_a", "name_b"):
            names, column = (self.names, self.a) if name == "name_a" else (self.against_names, self.b)
            if names is not None:
                return np.array([names[index] for index in column[rows]], dtype=object)
        value = getattr(self, name, None)
        if not isinstance(value, np.ndarray):
            raise KeyError(f"there is no column {name!r}; there are {', '.join(self)}")
        return value[rows]

    def _row(self, row: Any) -> int:
        """Returns the number of a row, which may count from the end."""
        number, size = operator.index(row), len(self)
        if not -size <= number < size:
            raise IndexError(f"row {number} of {size}")
        return number % size

    @overload
    def __getitem__(self, key: str) -> Array: ...

    @overload
    def __getitem__(self, key: int) -> Dict[str, Any]: ...

    def __getitem__(self, key: Any) -> Any:
        """Returns a column or another array by its name, or a row by its number, as in :meth:`to_dicts`."""
        if isinstance(key, str):
            return self._column(key, slice(None))
        if not hasattr(key, "__index__") or getattr(key, "ndim", None):
            raise InputTypeError(f"table[{key!r}]: neither the name of a column nor the number of a row; there are the columns "
                                 f"{', '.join(self)}")
        row = self._row(key)
        return self._rows(row, row + 1)[0]

    def __iter__(self) -> Iterator[str]:
        """Iterates over the names of the columns."""
        names = ["name_a"] if self.names is not None else []
        names += ["name_b"] if self.against_names is not None else []
        return iter(["a", "b", *names, "class", "distance", "depth", "depth_kind", "depth_at_most", "thickness", "thickness_kind", "time",
                     "contacts"])

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and self._column(name, slice(0)) is not None
        except KeyError:
            return False

    def keys(self) -> KeysView[str]:
        """Returns the names of the columns."""
        return dict.fromkeys(self).keys()

    def values(self) -> ValuesView[Array]:
        """Returns the columns."""
        return self.columns().values()

    def items(self) -> ItemsView[str, Array]:
        """Returns pairs of name and column."""
        return self.columns().items()

    def __len__(self) -> int:
        """Returns the number of rows."""
        return len(self.pairs)

    def __reduce__(self) -> Tuple[Any, ...]:
        return Collisions, tuple(getattr(self, field.name) for field in dataclasses.fields(self))

    def __repr__(self) -> str:
        counts = np.bincount(self.class_codes, minlength=len(COLLISION_CLASSES))
        classes = ", ".join(f"{count:,} {name}" for name, count in zip(COLLISION_CLASSES, counts) if count)
        return f"Collisions({len(self):,}{': ' + classes if classes else ''}; {len(self.contact_depths):,} contacts)"

    def _repr_html_(self) -> str:
        if self.summary is not None:
            return self.summary._repr_html_()
        return html_table("collisions", [("rows", f"{len(self):,}"), ("contacts", f"{len(self.contact_depths):,}")])
