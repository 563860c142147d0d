"""The pipeline of filters, and the calls that are made of it."""

from __future__ import annotations

from typing import Any, Callable, Dict, Literal, Mapping, Optional, Sequence, Tuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._arrays import Array
from ._collisions import Collisions
from ._engine import Engine
from ._errors import InputError, InputTypeError, UsageError
from ._options import MOST_THREADS, Order, call_options
from ._progress import Progress, reporter
from ._results import PipelineSummary
from ._shapes import Shapes

Adjacent = Literal["beyond_shared", "exclude", "include"]
ADJACENT = ("beyond_shared", "exclude", "include")
"""Treatments of triangles that share corners: kept if they also meet elsewhere, dropped, kept."""


class Pipeline:
    """Runs filters on the pairs of an engine. Pairs go in, collisions come out.

    The methods that add a filter return the pipeline. In all of them `against` describes the second set of a join. Arrays and shapes must
    not change while the pipeline is used.

    Parameters
    ----------
    threads : int
        Threads that run filters; 0: one per core.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> boxes = np.zeros((4, 6))
    >>> pipeline = op.Pipeline().parents([0, 0, 1, 1]).keep(lambda batch: batch.a == 0)
    >>> pipeline.run(boxes).pairs
    array([[0, 2],
           [0, 3]], dtype=uint32)
    """

    def __init__(self, *, threads: int = 0) -> None:
        self._pipeline = _core.Pipeline(_arrays.whole(threads, "threads", MOST_THREADS))
        self._filters: list[str] = []
        self._joins: list[Tuple[str, bool]] = []
        self._names: Tuple[Optional[Sequence[str]], Optional[Sequence[str]]] = (None, None)

    def _added(self, name: str, join: Optional[bool] = None) -> "Pipeline":
        """Notes a filter. `join`: whether it has a second set; None: it does not matter."""
        self._filters.append(name)
        if join is not None:
            self._joins.append((name, join))
        return self

    def _check_join(self, against: Any) -> None:
        for name, join in self._joins:
            if join and against is None:
                raise UsageError(f"filter {name!r} has a second set, but the boxes have none; pass against to run()")
            if not join and against is not None:
                raise UsageError(f"filter {name!r} has no second set, but the boxes have; pass against to the filter")

    def keep(self, condition: Callable[[Collisions], Any], *, name: str = "") -> "Pipeline":
        """Adds a filter of your own.

        Parameters
        ----------
        condition : callable
            Receives a batch of pairs with what earlier filters found, and returns an array of bool, one per pair: True keeps the pair. The
            effect on a pair may depend only on that pair. Threads of the library call this, one at a time. It may not use this pipeline
            and its engine. An interrupt takes effect after it returns.
        name : str
            Name in the summary. Default: the name of the callable.
        """
        if not callable(condition):
            raise InputTypeError(f"condition: a {type(condition).__name__} is not callable")
        label = str(name or getattr(condition, "__name__", "keep"))

        def keep_batch(columns: Dict[str, Any]) -> Array:
            batch = Collisions(**columns)
            mask = np.asarray(condition(batch))
            if mask.dtype != np.bool_ or mask.shape != (len(batch),):
                raise InputTypeError(f"filter {label!r}: it returned an array of {mask.dtype} of the shape {mask.shape}; it must return "
                                     f"bool of the shape ({len(batch)},)")
            return np.ascontiguousarray(mask)

        self._pipeline.add_callable(label, keep_batch)
        return self._added(label)

    def groups(self, groups: ArrayLike, mask: ArrayLike, *, against: Optional[Tuple[ArrayLike, ArrayLike]] = None) -> "Pipeline":
        """Keeps pairs where b's mask has a bit of a's groups, and a's mask has a bit of b's groups. Integers of 32 bits for each object;
        `against`: a pair of groups and mask."""
        if against is not None and (not isinstance(against, (tuple, list)) or len(against) != 2):
            raise InputTypeError("against: it must be (groups, mask)")
        first = (_integers(groups, "groups"), _integers(mask, "mask"))
        second = None if against is None else (_integers(against[0], "groups"), _integers(against[1], "mask"))
        self._pipeline.add_groups(first, second)
        return self._added("groups", against is not None)

    def ignored_pairs(self, pairs: ArrayLike, *, join: bool = False) -> "Pipeline":
        """Drops these pairs, integers of shape (m, 2). Without `join`, (a, b) also drops (b, a)."""
        self._pipeline.add_ignored_pairs(_arrays.integers(pairs, "pairs", (None, 2)), bool(join))
        return self._added("ignored pairs", bool(join))

    def name_rules(self, names: Sequence[str], rules: Sequence[Tuple[str, str]], *,
                   against: Optional[Sequence[str]] = None) -> "Pipeline":
        """Drops pairs whose names match a rule: a pair of patterns, where ``*`` stands for any characters and ``?`` for one."""
        patterns = []
        for rule in _pairs(rules, "rules"):
            a, b = (_arrays.text(pattern, "rules") for pattern in rule)
            patterns.append((a, b))
        second = None if against is None else _arrays.texts(against, "against")
        self._pipeline.add_names(_arrays.texts(names, "names"), patterns, second)
        return self._added("name rules", second is not None)

    def column_rules(self, columns: Mapping[str, Sequence[str]], rules: Sequence[Tuple[Mapping[str, str], Mapping[str, str]]], *,
                     against: Optional[Mapping[str, Sequence[str]]] = None) -> "Pipeline":
        """Drops pairs whose objects match a rule in several columns of texts.

        Parameters
        ----------
        columns : dict of str to sequence of str
            Texts of each object, for example names and types; empty: the object has none.
        rules : sequence of (dict, dict)
            Patterns of one object and of the other by column, as in :meth:`name_rules`. Columns without a pattern do not matter; ``*`` also
            matches an empty text.
        against : dict, optional
            The same columns of the second set.

        Examples
        --------
        >>> import numpy as np, octopair as op
        >>> parts = {"name": ["wall", "pipe 1", "pipe 2"], "level": ["1", "1", "2"]}
        >>> rule = ({"name": "pipe*"}, {"name": "wall", "level": "1"})
        >>> op.Pipeline().column_rules(parts, [rule]).run(np.zeros((3, 6))).pairs
        array([[1, 2]], dtype=uint32)
        """
        for given in (columns,) if against is None else (columns, against):
            if not isinstance(given, Mapping):
                raise InputTypeError(f"columns: a {type(given).__name__} is not a dict of columns")
        names = _arrays.texts(columns, "columns")
        if not names:
            raise InputError("columns: there are none")
        if against is not None and set(against) != set(names):
            raise InputError(f"against: its columns are {', '.join(against)}; they must be {', '.join(names)}")
        patterns = []
        for rule in _pairs(rules, "rules"):
            if not all(isinstance(side, Mapping) for side in rule):
                raise InputTypeError("rules: each must be a pair of dicts")
            for name in (*rule[0], *rule[1]):
                if name not in names:
                    raise InputError(f"rules: there is no column {name!r}; there are {', '.join(names)}")
            a, b = ([_arrays.text(side[name], "rules") if name in side else None for name in names] for side in rule)
            patterns.append((a, b))
        self._pipeline.add_columns(_text_columns(columns, names, "columns"), patterns,
                                   None if against is None else _text_columns(against, names, "against"))
        return self._added("name rules", against is not None)

    def parents(self, parents: ArrayLike, against: Optional[ArrayLike] = None) -> "Pipeline":
        """Keeps pairs of objects with different parents: any number per object, such as that of a body."""
        self._pipeline.add_parents(_integers(parents, "parents"), None if against is None else _integers(against, "against"))
        return self._added("same parent", against is not None)

    def bounding_spheres(self, shapes: Shapes, against: Optional[Shapes] = None, *, margin: float = 0) -> "Pipeline":
        """Drops pairs whose bounding spheres are further apart than margin and paddings."""
        return self._shapes("bounding spheres", (shapes, against), (margin, 0, 0.0, None))

    def oriented_boxes(self, shapes: Shapes, against: Optional[Shapes] = None, *, margin: float = 0) -> "Pipeline":
        """Drops pairs whose oriented boxes are further apart than margin and paddings."""
        return self._shapes("oriented boxes", (shapes, against), (margin, 0, 0.0, None))

    def exact_objects(self, shapes: Shapes, against: Optional[Shapes] = None, *, margin: float = 0) -> "Pipeline":
        """Keeps objects that meet, or whose distance is at most margin and paddings. Computes class, distance and nearest points; for
        moving objects, the time of impact."""
        return self._shapes("exact object", (shapes, against), (margin, 0, 0.0, None))

    def exact_features(self, shapes: Shapes, against: Optional[Shapes] = None, *, margin: float = 0, max_contacts: int = 16,
                       tolerance: float = 0, duplicate_tolerance: Optional[float] = None) -> "Pipeline":
        """Computes the class, the depth and the contacts of each pair. Requires :meth:`exact_objects` before it.

        Parameters
        ----------
        max_contacts : int
            Contacts that are stored per pair, the deepest first.
        tolerance : float
            Objects are touching if a translation of at most this length is proven to separate them.
        duplicate_tolerance : float, optional
            Objects of the same geometry are duplicates if no corner is further from its counterpart. Default: the tolerance.
        """
        return self._shapes("exact feature", (shapes, against), (margin, max_contacts, tolerance, duplicate_tolerance))

    def _shapes(self, kind: str, sets: Tuple[Shapes, Optional[Shapes]], options: Tuple[Any, ...]) -> "Pipeline":
        first, second = sets
        if not isinstance(first, Shapes):
            raise InputTypeError(f"shapes: a {type(first).__name__} is not a Shapes")
        if second is not None and not isinstance(second, Shapes):
            raise InputTypeError(f"against: a {type(second).__name__} is not a Shapes{_margin_hint(second)}")
        margin, contacts, tolerance, duplicate = options
        self._pipeline.add_shapes(kind, first._shapes, None if second is None else second._shapes,
                                  (_arrays.margin_of(margin), _arrays.whole(contacts, "max_contacts"),
                                   _arrays.real(tolerance, "tolerance"),
                                   None if duplicate is None else _arrays.real(duplicate, "duplicate_tolerance")))
        self._names = (first.names, None if second is None else second.names)
        return self._added(kind, second is not None)

    def min_depth(self, least: float) -> "Pipeline":
        """Drops pairs that are certainly less deep. Requires :meth:`exact_features` or :meth:`triangles` before it."""
        self._pipeline.add_depth(_arrays.real(least, "min_depth"))
        return self._added("depth")

    def triangles(self, triangles: ArrayLike, *, owners: Optional[ArrayLike] = None, adjacent: Adjacent = "beyond_shared",
                  margin: float = 0, features: bool = False, tolerance: float = 0,
                  against: Optional[Tuple[ArrayLike, Optional[ArrayLike]]] = None) -> "Pipeline":
        """Keeps triangles that meet, or whose distance is at most the margin.

        Parameters
        ----------
        triangles : array-like, shape (n, 3, 3)
            Corners of each triangle.
        owners : array-like of integers, shape (n,), optional
            Number of each triangle's mesh. Default: all are of one mesh.
        adjacent : {"beyond_shared", "exclude", "include"}
            Triangles of one mesh that share corners: kept if they also meet elsewhere, dropped, kept.
        margin : float
            Largest distance at which triangles that are not adjacent are kept.
        features : bool
            True: computes contact and depth, and distinguishes penetrating from touching.
        tolerance : float
            With `features`: triangles that a translation of at most this length separates only touch.
        against : tuple, optional
            Triangles and owners of the second set; the owners may be None.
        """
        if against is not None and (not isinstance(against, (tuple, list)) or len(against) != 2):
            raise InputTypeError("against: it must be (triangles, owners)")
        if _arrays.text(adjacent, "adjacent") not in ADJACENT:
            raise InputError(f"adjacent: {adjacent!r} is none of {', '.join(ADJACENT)}")
        first = (_triangles(triangles), None if owners is None else _integers(owners, "owners"))
        second = None
        if against is not None:
            second = (_triangles(against[0]), None if against[1] is None else _integers(against[1], "owners"))
        self._pipeline.add_triangles(first, second, (ADJACENT.index(adjacent), _arrays.margin_of(margin), bool(features),
                                                  _arrays.length(tolerance, "tolerance")))
        return self._added("exact triangle", second is not None)

    def run(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
            padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
            verify: bool = False, engine: Optional[Engine] = None, sink: Optional[Callable[[Collisions], Any]] = None,
            progress: Progress = None, copy: bool = False) -> Collisions:
        """Finds pairs, filters them, and returns the collisions.

        Parameters are those of :func:`octopair.find_pairs`, and:

        Parameters
        ----------
        engine : Engine, optional
            Default: a temporary local engine.
        sink : callable, optional
            Receives the collisions of each batch, in order, on a thread of the library. The result then has none, and memory is bounded.
        limit : int, optional
            Maximum number of collisions.
        """
        self._check_join(against)
        if sink is not None and not callable(sink):
            raise InputTypeError(f"sink: a {type(sink).__name__} is not callable")
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        receive = None if sink is None else lambda columns: sink(Collisions(**columns))
        with reporter(progress) as report:
            columns, summary = self._pipeline.run(_core_engine(engine), data, call_options(margin, order, limit, verify),
                                                  (report, receive))
        names, others = self._names
        return Collisions(**columns, summary=PipelineSummary._of(summary), names=_list(names),
                          against_names=_list(names if against is None else others))

    def count(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, padding: Optional[ArrayLike] = None,
              against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None, verify: bool = False,
              engine: Optional[Engine] = None, progress: Progress = None, copy: bool = False) -> PipelineSummary:
        """Like :meth:`run`, but only counts the collisions, and returns the summary."""
        self._check_join(against)
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        with reporter(progress) as report:
            return PipelineSummary._of(self._pipeline.count(_core_engine(engine), data,
                                                            call_options(margin, limit=limit, verify=verify), report))

    def __repr__(self) -> str:
        return f"Pipeline({' > '.join(self._filters)})"


def _pairs(values: Any, name: str) -> list[Tuple[Any, Any]]:
    """Returns a list of pairs."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        raise InputTypeError(f"{name}: {values!r} is not a sequence of pairs")
    found = list(values)
    for value in found:
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise InputTypeError(f"{name}: {value!r} is not a pair")
    return [(a, b) for a, b in found]


def _text_columns(columns: Mapping[str, Sequence[str]], names: Sequence[str], name: str) -> list[list[str]]:
    found = [_arrays.texts(columns[column], f"{name}[{column!r}]") for column in names]
    if len({len(texts) for texts in found}) > 1:
        raise InputError(f"{name}: the columns have different lengths")
    return found


def _list(names: Optional[Sequence[str]]) -> Optional[list[str]]:
    return None if names is None else list(names)


def _integers(value: Any, name: str) -> Array:
    return _arrays.integers(value, name, (None,))


def _triangles(value: Any) -> Array:
    return _arrays.numbers(value, "triangles", (None, 3, 3))


def _margin_hint(value: Any) -> str:
    """Returns what to do about a number where a second set is expected."""
    return f"; for a margin pass margin={value!r}" if isinstance(value, (int, float)) else ""


def _core_engine(engine: Optional[Engine]) -> _core.Engine:
    if engine is None:
        return _core.Engine.local(0)
    if not isinstance(engine, Engine):
        raise InputTypeError(f"engine: a {type(engine).__name__} is not an octopair.Engine")
    return engine._ready()


def collide(shapes: Shapes, against: Optional[Shapes] = None, *, margin: float = 0, max_contacts: int = 16, tolerance: float = 0,
            min_depth: Optional[float] = None, stage: Literal["objects", "features"] = "features",
            keep: Optional[Callable[[Collisions], Any]] = None, order: Order = "ascending", limit: Optional[int] = None,
            engine: Optional[Engine] = None, progress: Progress = None) -> Collisions:
    """Finds the objects that collide, exactly, with class, depth, distance and contacts.

    Parameters
    ----------
    shapes : Shapes
        Objects. A trimesh mesh or scene is converted with :meth:`Shapes.from_trimesh`.
    against : Shapes, optional
        A second set. Then `a` is in `shapes` and `b` in `against`.
    margin : float
        Largest distance at which a pair counts, besides paddings.
    max_contacts : int
        Contacts that are stored per pair, the deepest first.
    tolerance : float
        Objects are touching if a translation of at most this length is proven to separate them.
    min_depth : float, optional
        Leaves out pairs that are certainly less deep. Pairs that do not meet, within the margin, have no depth and are kept.
    stage : {"features", "objects"}
        ``"objects"`` computes no depth and no contacts.
    keep : callable, optional
        A filter before the exact stages, as in :meth:`Pipeline.keep`.
    order, limit, engine, progress
        As in :meth:`Pipeline.run`.

    Returns
    -------
    Collisions
        A table of arrays.

    Examples
    --------
    >>> import octopair as op
    >>> cube = op.Geometry.box([1, 1, 1])
    >>> shapes = op.Shapes([cube], op.make_poses([[0, 0, 0], [1.5, 0, 0], [4, 0, 0]]), [0, 0, 0])
    >>> table = op.collide(shapes, margin=0.75)
    >>> table.pairs
    array([[0, 1],
           [1, 2]], dtype=uint32)
    >>> table["class"], table.depth, table.distance
    (array(['penetrating', 'clearance'], dtype='<U11'), array([0.5, 0. ]), array([0. , 0.5]))
    """
    if isinstance(against, (int, float)):
        raise InputTypeError(f"against: {against!r} is not a Shapes{_margin_hint(against)}")
    first = shapes if isinstance(shapes, Shapes) else Shapes.from_trimesh(shapes)
    second = against if against is None or isinstance(against, Shapes) else Shapes.from_trimesh(against)
    if _arrays.text(stage, "stage") not in ("objects", "features"):
        raise InputError(f"stage: {stage!r} is neither 'objects' nor 'features'")
    pipeline = Pipeline()
    if keep is not None:
        pipeline.keep(keep)
    pipeline.oriented_boxes(first, second, margin=margin).exact_objects(first, second, margin=margin)
    if stage == "features":
        pipeline.exact_features(first, second, margin=margin, max_contacts=max_contacts, tolerance=tolerance)
    if min_depth is not None:
        if stage == "objects":
            raise UsageError("min_depth: the stage 'objects' computes no depth")
        pipeline.min_depth(min_depth)
    boxes = first.boxes(second)
    here, there = (boxes, None) if second is None else boxes
    return pipeline.run(here, there, margin=margin, order=order, padding=first.padding,
                        against_padding=None if second is None else second.padding, limit=limit, engine=engine, progress=progress)


@overload
def self_intersections(vertices: ArrayLike, faces: ArrayLike, *, adjacent: Adjacent = ..., margin: float = ...,
                       features: Literal[False] = ..., tolerance: float = ..., limit: Optional[int] = ..., engine: Optional[Engine] = ...,
                       progress: Progress = ...) -> NDArray[np.uint32]: ...


@overload
def self_intersections(vertices: ArrayLike, faces: ArrayLike, *, adjacent: Adjacent = ..., margin: float = ...,
                       features: Literal[True], tolerance: float = ..., limit: Optional[int] = ..., engine: Optional[Engine] = ...,
                       progress: Progress = ...) -> Collisions: ...


def self_intersections(vertices: ArrayLike, faces: ArrayLike, *, adjacent: Adjacent = "beyond_shared", margin: float = 0,
                       features: bool = False, tolerance: float = 0, limit: Optional[int] = None, engine: Optional[Engine] = None,
                       progress: Progress = None) -> Union[NDArray[np.uint32], Collisions]:
    """Finds the triangles of a mesh that meet each other, with exact arithmetic.

    Parameters
    ----------
    vertices : array-like, shape (n, 3)
        Corners.
    faces : array-like of integers, shape (m, 3)
        Triangles.
    adjacent, margin, tolerance
        As in :meth:`Pipeline.triangles`.
    features : bool
        True: returns a table with contact, depth and class instead of pairs.
    limit, engine, progress
        As in :meth:`Pipeline.run`.

    Returns
    -------
    numpy.ndarray or Collisions
        Pairs of indices of triangles, shape (k, 2), uint32.

    Examples
    --------
    >>> import octopair as op
    >>> vertices = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, -1], [0.5, 0.5, 1], [3, 3, 1]]
    >>> op.self_intersections(vertices, [[0, 1, 2], [3, 4, 5]])
    array([[0, 1]], dtype=uint32)
    """
    corners = _arrays.numbers(vertices, "vertices", (None, 3))
    numbers = _arrays.integers(faces, "faces", (None, 3))
    if numbers.size and numbers.max() >= len(corners):
        wrong = int(np.flatnonzero((numbers >= len(corners)).any(axis=1))[0])
        raise InputError(f"faces: triangle {wrong} has the vertex {numbers[wrong].max()} of {len(corners)}", wrong)
    triangles = np.ascontiguousarray(corners[numbers])
    pipeline = Pipeline().triangles(triangles, adjacent=adjacent, margin=margin, features=features, tolerance=tolerance)
    found = pipeline.run(_core.triangle_boxes(triangles), margin=margin, limit=limit, engine=engine, progress=progress)
    return found if features else found.pairs
