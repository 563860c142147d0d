"""Engines, and the calls that need no engine."""

from __future__ import annotations

import os
import pathlib
import weakref
from typing import Any, Dict, Literal, Optional, Tuple, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays, _core
from ._errors import UsageError
from ._jobs import Job, PairStream
from ._options import MOST_THREADS, Order, PathLike, call_options, float_dtype
from ._progress import Progress, reporter
from ._results import Summary

_Engine = TypeVar("_Engine", bound="Engine")


def _find(engine: _core.Engine, data: _core.Input, options: _core.Options,
          progress: Progress) -> Tuple[NDArray[np.uint32], Tuple[Any, ...]]:
    """Returns the pairs and the row of the summary."""
    if not progress:
        return engine.find_pairs(data, options)
    with reporter(progress) as report:
        return engine.find_pairs(data, options, report)


def worker_program() -> str:
    """Returns the path of the worker program in this package; empty if the library finds it."""
    program = pathlib.Path(__file__).parent / "bin" / "octopair-worker"
    return str(program) if program.exists() and "OCTOPAIR_WORKER" not in os.environ else ""


class Engine:
    """Finds all pairs of overlapping boxes. Keeps its threads and its memory from call to call.

    Every engine returns the same bytes. Calls of several Python threads run one after another; engines are independent of each other.
    While a stream of the engine is open, its other calls raise :class:`UsageError`. So do calls within a callback of the engine.

    :meth:`close`, or the end of a ``with`` block, ends its jobs, its processes or its connection, and frees its memory.

    Parameters
    ----------
    kind : str
        ``"local"``: threads of this process. ``"processes"``: worker processes, whose crash does not end this process. An address,
        ``"unix:PATH"`` or ``"HOST:PORT"``: a server (``octopair serve``).
    threads : int
        Threads of a local engine; 0: one per core.
    workers : int
        Processes of ``"processes"``; 0: one per core.
    token, server_user, token_in_clear, owner, authority, certificate, key, tls, connect_timeout, patience
        Options of a connection: :func:`octopair.remote.client_options`.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> boxes = np.array([[0, 0, 0, 1, 1, 1], [5, 5, 5, 6, 6, 6], [1, 0, 0, 2, 1, 1]], dtype=np.float32)
    >>> with op.Engine("local", threads=2) as engine:
    ...     print(engine.find_pairs(boxes), engine.count_pairs(boxes, margin=4))
    [[0 2]] 3
    """

    def __init__(self, kind: str = "local", *, threads: int = 0, workers: int = 0, token: Optional[str] = None,
                 server_user: Optional[str] = None, token_in_clear: Optional[bool] = None, owner: Optional[str] = None,
                 authority: Optional[PathLike] = None, certificate: Optional[PathLike] = None, key: Optional[PathLike] = None,
                 tls: Optional[bool] = None, connect_timeout: Optional[float] = None, patience: Optional[float] = None) -> None:
        options = {"token": token, "server_user": server_user, "token_in_clear": token_in_clear, "owner": owner, "authority": authority,
                   "certificate": certificate, "key": key, "tls": tls, "connect_timeout": connect_timeout, "patience": patience}
        client: Dict[str, Any] = {name: value for name, value in options.items() if value is not None}
        if ":" in _arrays.text(kind, "kind"):
            if threads or workers:
                raise UsageError("threads and workers are settings of the server, not of a connection")
            from . import remote
            self._start(remote._connect(kind, remote.client_options(**client)), kind)
            return
        if client:
            raise UsageError(f"{', '.join(client)}: only connections to servers have such options")
        if kind == "local":
            if workers:
                raise UsageError("workers: a local engine has threads; pass threads")
            self._start(_core.Engine.local(_arrays.whole(threads, "threads", MOST_THREADS)), "local")
        elif kind == "processes":
            if threads:
                raise UsageError("threads: this engine has worker processes; pass workers")
            self._start(_core.Engine.processes(_arrays.whole(workers, "workers", 256), worker_program()), "processes")
        else:
            raise UsageError(f"kind: {kind!r} is neither 'local' nor 'processes' nor an address (unix:PATH or HOST:PORT)")

    def _start(self, engine: _core.Engine, kind: str) -> None:
        self._engine = engine
        self._kind = kind
        self._streams: Dict[int, "weakref.ref[PairStream]"] = {}  # open streams
        self._closed = False

    @classmethod
    def _of(cls, engine: _core.Engine, kind: str) -> Engine:
        made = cls.__new__(cls)
        made._start(engine, kind)
        return made

    @property
    def kind(self) -> str:
        """Kind of the engine, or the address of its server."""
        return self._kind

    def close(self) -> None:
        """Ends the engine: its processes or its connection, and its memory. Later calls raise :class:`UsageError`.

        Waits for a call of another thread. Jobs that have not ended are cancelled; the results of others can still be taken. Streams are
        closed. A second call does nothing. Collective for an engine of MPI ranks.
        """
        for stream in [*self._streams.values()]:
            opened = stream()
            if opened is not None:
                opened.close()
        self._engine.close()
        self._closed = True

    def __enter__(self: _Engine) -> _Engine:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ready(self) -> _core.Engine:
        if self._streams:
            raise UsageError("a stream of this engine has not ended; close it first, or use another engine")
        return self._engine

    @overload
    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ...,
                   padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
                   verify: bool = ..., progress: Progress = ..., copy: bool = ...,
                   return_summary: Literal[False] = ...) -> NDArray[np.uint32]: ...

    @overload
    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ...,
                   padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
                   verify: bool = ..., progress: Progress = ..., copy: bool = ...,
                   return_summary: Literal[True]) -> Tuple[NDArray[np.uint32], Summary]: ...

    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                   padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                   verify: bool = False, progress: Progress = None, copy: bool = False,
                   return_summary: bool = False) -> Union[NDArray[np.uint32], Tuple[NDArray[np.uint32], Summary]]:
        """Like :func:`octopair.find_pairs`, on this engine."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        pairs, summary = _find(self._ready(), data, call_options(margin, order, limit, verify), progress)
        return (pairs, Summary._of(summary)) if return_summary else pairs

    def count_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0,
                    padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                    verify: bool = False, progress: Progress = None, copy: bool = False) -> int:
        """Like :func:`octopair.count_pairs`, on this engine."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        with reporter(progress) as report:
            return self._ready().count_pairs(data, call_options(margin, limit=limit, verify=verify), report)[0]

    def stream_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                     padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                     verify: bool = False, buffer_bytes: int = 1 << 30, copy: bool = False) -> PairStream:
        """Like :func:`octopair.stream_pairs`, on this engine, which makes no other call until the stream has ended."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return PairStream(self, _core.Stream(self._ready(), data, call_options(margin, order, limit, verify, buffer_bytes)))

    def submit(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
               padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
               verify: bool = False, copy: bool = False) -> Job:
        """Starts a search and returns its job at once. Jobs of an engine run one after another.

        Parameters are those of :func:`octopair.find_pairs`. The arrays must not change until the job has ended.
        """
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return Job(_core.Job(self._ready(), data, call_options(margin, order, limit, verify)))

    def allocate_boxes(self, count: int, *, dtype: DTypeLike = "float32") -> NDArray[Any]:
        """Returns an uninitialised array of shape (count, 6) that this engine reads without copying. The array may outlive the engine.

        Other engines read every array without copying; worker processes need boxes in shared memory.
        """
        return self._engine.allocate_boxes(_arrays.whole(count, "count"), float_dtype(dtype) == np.float64)

    def worker_faults(self) -> Tuple[int, int, Tuple[int, ...]]:
        """Returns the faults of worker processes so far: number of workers that died, number that were stopped, and the numbers by the
        step that they were running (prepare, encode, count, scan, order)."""
        return self._engine.worker_faults()

    def __repr__(self) -> str:
        return f"Engine({self._kind!r}{', closed' if self._closed else ''})"


def _engine_for(threads: int) -> Engine:
    return Engine._of(_core.Engine.local(_arrays.whole(threads, "threads", MOST_THREADS)), "local")


@overload
def find_pairs(boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ..., threads: int = ...,
               padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
               verify: bool = ..., progress: Progress = ..., copy: bool = ...,
               return_summary: Literal[False] = ...) -> NDArray[np.uint32]: ...


@overload
def find_pairs(boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ..., threads: int = ...,
               padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
               verify: bool = ..., progress: Progress = ..., copy: bool = ...,
               return_summary: Literal[True]) -> Tuple[NDArray[np.uint32], Summary]: ...


def find_pairs(boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
               threads: int = 0, padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None,
               limit: Optional[int] = None, verify: bool = False, progress: Progress = None, copy: bool = False,
               return_summary: bool = False) -> Union[NDArray[np.uint32], Tuple[NDArray[np.uint32], Summary]]:
    """Finds all pairs of overlapping boxes. Boxes are closed: boxes that touch are a pair.

    For repeated calls keep an :class:`Engine`, which keeps its memory.

    Parameters
    ----------
    boxes : array-like, shape (n, 6) or (n, 4)
        Boxes as rows of min x, y, z, max x, y, z, or spheres as rows of centre x, y, z, radius; in any unit. The box of a sphere is centre
        ± radius, rounded outward. C-contiguous boxes of float32 or float64 are read where they lie. Other arrays and sequences are
        converted if no value changes.
    against : array-like, shape (k, 6) or (k, 4), optional
        A second set. Then `a` is an index in `boxes` and `b` an index in `against`.
    margin : float
        Largest gap, per axis, at which a pair counts.
    order : {"ascending", "octal"}
        ``"ascending"`` sorts by a, then b. ``"octal"`` is the order of the octree, and is cheaper. Both are deterministic.
    threads : int
        0: one per core.
    padding, against_padding : array-like, shape (n,) or (k,), or float, optional
        Clearance of each object. The gap of a pair may be the margin and both paddings.
    limit : int, optional
        Maximum number of pairs; the first ones in `order`. The summary says whether more exist.
    verify : bool
        True: a second algorithm that shares no code with the octree checks the result.
    progress : callable or bool
        Receives the fraction that is done, on this thread. True: a bar.
    copy : bool
        True: rounds floats of other dtypes, such as numpy.longdouble, to the nearest float64 instead of refusing them.
    return_summary : bool
        True: also returns a :class:`Summary`.

    Returns
    -------
    pairs : numpy.ndarray
        Shape (m, 2), uint32; ``a < b`` without `against`. It owns its memory.
    summary : Summary
        Only if `return_summary` is true.

    Raises
    ------
    Error
        Also a ValueError for invalid boxes, options and shapes, and a TypeError for what is not numbers. ``index`` is the first invalid
        box.
    KeyboardInterrupt
        Within 200 ms after Ctrl-C.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> boxes = np.array([[0, 0, 0, 1, 1, 1], [5, 5, 5, 6, 6, 6], [1, 0, 0, 2, 1, 1]], dtype=np.float32)
    >>> op.find_pairs(boxes)
    array([[0, 2]], dtype=uint32)
    >>> op.find_pairs(boxes[:1], against=boxes)
    array([[0, 0],
           [0, 2]], dtype=uint32)
    >>> pairs, summary = op.find_pairs(boxes, margin=4, limit=1, return_summary=True)
    >>> pairs, summary.truncated
    (array([[0, 1]], dtype=uint32), True)
    """
    engine = _core.Engine.local(_arrays.whole(threads, "threads", MOST_THREADS))
    data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
    pairs, summary = _find(engine, data, call_options(margin, order, limit, verify), progress)
    return (pairs, Summary._of(summary)) if return_summary else pairs


def count_pairs(boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, threads: int = 0,
                padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                verify: bool = False, progress: Progress = None, copy: bool = False) -> int:
    """Returns the number of pairs, at most `limit`. Stores none of them.

    Parameters are those of :func:`find_pairs`.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> op.count_pairs(np.zeros((1000, 6)))
    499500
    """
    return _engine_for(threads).count_pairs(boxes, against, margin=margin, padding=padding, against_padding=against_padding, limit=limit,
                                            verify=verify, progress=progress, copy=copy)


def stream_pairs(boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                 threads: int = 0, padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None,
                 limit: Optional[int] = None, verify: bool = False, buffer_bytes: int = 1 << 30, copy: bool = False) -> PairStream:
    """Finds all pairs, and returns an iterator over chunks of them, in order. Memory does not grow with the number of pairs.

    The order ``"octal"`` yields the first chunk soonest; the ascending order counts the pairs of each object before.

    Parameters are those of :func:`find_pairs`, and:

    Parameters
    ----------
    buffer_bytes : int
        Maximum memory for pairs, at least 1 MiB.

    Returns
    -------
    PairStream
        Yields arrays of shape (m, 2), uint32, at most 8 MiB each. They own their memory.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> sum(len(chunk) for chunk in op.stream_pairs(np.zeros((1000, 6))))
    499500
    """
    return _engine_for(threads).stream_pairs(boxes, against, margin=margin, order=order, padding=padding, against_padding=against_padding,
                                             limit=limit, verify=verify, buffer_bytes=buffer_bytes, copy=copy)
