"""Engines, jobs and streams, and the calls that need no engine."""

from __future__ import annotations

import os
import pathlib
import threading
from typing import Any, Literal, Optional, Tuple, Union, overload

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._errors import InputError, UsageError
from ._options import MOST_THREADS, Order, call_options, float_dtype
from ._progress import Progress, reporter
from ._results import JobResult, Summary


def _find(engine: _core.Engine, data: _core.Input, options: _core.Options, progress: Progress) -> Tuple[Array, Tuple[Any, ...]]:
    """Returns the pairs and the row of the summary."""
    if not progress:
        return engine.find_pairs(data, options)
    with reporter(progress) as report:
        return engine.find_pairs(data, options, report)


def worker_program() -> str:
    """Returns the path of the worker program in this package; empty if the library finds it."""
    program = pathlib.Path(__file__).parent / "bin" / "octopair-worker"
    return str(program) if program.exists() and "OCTOPAIR_WORKER" not in os.environ else ""


class PairStream:
    """The pairs of a search in chunks, in order: an iterator over arrays of shape (m, 2), uint32.

    The search runs while the caller handles a chunk, but not far ahead: memory is bounded. Until the stream has ended or is closed, its
    engine makes no other call. Also a context manager, which closes the stream.
    """

    def __init__(self, engine: "Engine", stream: _core.Stream) -> None:
        self._engine = engine
        self._stream = stream
        engine._streams += 1
        self._open = True

    def __iter__(self) -> "PairStream":
        return self

    def __next__(self) -> Array:
        """Returns the next chunk."""
        try:
            return self._stream.next()
        except UsageError:
            raise  # the call was refused, and the stream goes on
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Cancels the search, if it has not ended."""
        self._stream.close()
        self._end()

    def _end(self) -> None:
        if self._open:
            self._open = False
            self._engine._streams -= 1

    @property
    def summary(self) -> Optional[Summary]:
        """Counts and times, after the last chunk; before that None."""
        row = self._stream.summary
        return None if row is None else Summary._of(row)

    def __enter__(self) -> "PairStream":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_open", False):
            self.close()

    def __repr__(self) -> str:
        return f"PairStream({'open' if self._open else 'ended'})"


class Job:
    """A search that runs while Python does other work. :meth:`Engine.submit` makes it.

    The job holds references to its arrays, which must not change until it has ended. A job that is garbage-collected is cancelled.
    Thread safety: any thread may call any method.
    """

    def __init__(self, job: _core.Job) -> None:
        self._job = job
        self._lock = threading.Lock()
        self._result: Optional[JobResult] = None

    @property
    def state(self) -> str:
        """``"queued"``, ``"running"``, ``"done"``, ``"failed"`` or ``"cancelled"``."""
        return self._job.state

    @property
    def progress(self) -> float:
        """Fraction of the work that is done, 0 to 1; never decreases."""
        return self._job.progress

    def done(self) -> bool:
        """Returns True if the job has ended: done, failed or cancelled."""
        return self.state not in ("queued", "running")

    def wait(self, timeout: Optional[float] = None) -> bool:
        """Waits until the job has ended.

        Parameters
        ----------
        timeout : float, optional
            Longest wait in seconds; None: no limit.

        Returns
        -------
        bool
            True if the job has ended.
        """
        seconds = -1.0 if timeout is None else _arrays.real(timeout, "timeout")
        if seconds != seconds:
            raise InputError("timeout: nan is not a number of seconds")
        return self._job.wait(seconds if timeout is None else max(seconds, 0.0))

    def cancel(self) -> None:
        """Requests that the job ends, and returns at once. A running job ends within 200 ms."""
        self._job.cancel()

    def result(self, timeout: Optional[float] = None) -> JobResult:
        """Waits until the job has ended, and returns its result. Later calls return the same object.

        Parameters
        ----------
        timeout : float, optional
            Longest wait in seconds; None: no limit.

        Raises
        ------
        TimeoutError
            If the job has not ended after this time. The job goes on.
        Error
            The job's error if it failed; :class:`CancelledError` if it was cancelled.
        """
        if not self.wait(timeout):
            raise TimeoutError(f"the job has not ended after {timeout} s; its progress is {self.progress:.0%}")
        with self._lock:
            if self._result is None:
                pairs, summary = self._job.take_result()
                self._result = JobResult(pairs, Summary._of(summary))
            return self._result

    def __repr__(self) -> str:
        return f"Job({self.state}, {self.progress:.0%})"


class Engine:
    """Finds all pairs of overlapping boxes. Keeps its threads and its memory from call to call.

    Every engine returns the same bytes. Calls of several Python threads run one after another; engines are independent of each other.
    While a stream of the engine is open, its other calls raise :class:`UsageError`. So do calls within a callback of the engine.

    Parameters
    ----------
    kind : str
        ``"local"``: threads of this process. ``"processes"``: worker processes, whose crash does not end this process. An address,
        ``"unix:PATH"`` or ``"HOST:PORT"``: a server (``octopair serve``).
    threads : int
        Threads of a local engine; 0: one per core.
    workers : int
        Processes of ``"processes"``; 0: one per core.
    **client
        Options of a connection (:func:`octopair.remote.client_options`), such as ``token``, ``authority`` and ``tls``.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> boxes = np.array([[0, 0, 0, 1, 1, 1], [5, 5, 5, 6, 6, 6], [1, 0, 0, 2, 1, 1]], dtype=np.float32)
    >>> engine = op.Engine("local", threads=2)
    >>> engine.find_pairs(boxes)
    array([[0, 2]], dtype=uint32)
    >>> engine.count_pairs(boxes, margin=4)
    3
    """

    def __init__(self, kind: str = "local", *, threads: int = 0, workers: int = 0, **client: Any) -> None:
        if ":" in _arrays.text(kind, "kind"):
            if threads or workers:
                raise UsageError("threads and workers are settings of the server, not of a connection")
            from . import remote
            self._start(remote._connect(kind, **client), kind)
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
        self._streams = 0

    @classmethod
    def _of(cls, engine: _core.Engine, kind: str) -> "Engine":
        made = cls.__new__(cls)
        made._start(engine, kind)
        return made

    @property
    def kind(self) -> str:
        """Kind of the engine, or the address of its server."""
        return self._kind

    def _ready(self) -> _core.Engine:
        if self._streams:
            raise UsageError("a stream of this engine has not ended; close it first, or use another engine")
        return self._engine

    @overload
    def find_pairs(self, boxes: Any, against: Any = ..., margin: float = ..., order: Order = ..., *, padding: Any = ...,
                   against_padding: Any = ..., limit: Optional[int] = ..., verify: bool = ..., progress: Progress = ...,
                   copy: bool = ..., return_summary: Literal[False] = ...) -> Array: ...

    @overload
    def find_pairs(self, boxes: Any, against: Any = ..., margin: float = ..., order: Order = ..., *, padding: Any = ...,
                   against_padding: Any = ..., limit: Optional[int] = ..., verify: bool = ..., progress: Progress = ...,
                   copy: bool = ..., return_summary: Literal[True]) -> Tuple[Array, Summary]: ...

    def find_pairs(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *, padding: Any = None,
                   against_padding: Any = None, limit: Optional[int] = None, verify: bool = False, progress: Progress = None,
                   copy: bool = False, return_summary: bool = False) -> Union[Array, Tuple[Array, Summary]]:
        """Like :func:`octopair.find_pairs`, on this engine."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        pairs, summary = _find(self._ready(), data, call_options(margin, order, limit, verify), progress)
        return (pairs, Summary._of(summary)) if return_summary else pairs

    def count_pairs(self, boxes: Any, against: Any = None, margin: float = 0, *, padding: Any = None, against_padding: Any = None,
                    limit: Optional[int] = None, verify: bool = False, progress: Progress = None, copy: bool = False) -> int:
        """Like :func:`octopair.count_pairs`, on this engine."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        with reporter(progress) as report:
            return self._ready().count_pairs(data, call_options(margin, limit=limit, verify=verify), report)[0]

    def stream_pairs(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *, padding: Any = None,
                     against_padding: Any = None, limit: Optional[int] = None, verify: bool = False,
                     buffer_bytes: int = 1 << 30, copy: bool = False) -> PairStream:
        """Like :func:`octopair.stream_pairs`, on this engine, which makes no other call until the stream has ended."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return PairStream(self, _core.Stream(self._ready(), data, call_options(margin, order, limit, verify, buffer_bytes)))

    def submit(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *, padding: Any = None,
               against_padding: Any = None, limit: Optional[int] = None, verify: bool = False, copy: bool = False) -> Job:
        """Starts a search and returns its job at once. Jobs of an engine run one after another.

        Parameters are those of :func:`octopair.find_pairs`. The arrays must not change until the job has ended.
        """
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return Job(_core.Job(self._ready(), data, call_options(margin, order, limit, verify)))

    def allocate_boxes(self, count: int, dtype: Any = "float32") -> Array:
        """Returns an uninitialised array of shape (count, 6) that this engine reads without copying. The array may outlive the engine.

        Other engines read every array without copying; worker processes need boxes in shared memory.
        """
        return self._engine.allocate_boxes(_arrays.whole(count, "count"), float_dtype(dtype) == np.float64)

    def worker_faults(self) -> Tuple[int, int, Tuple[int, ...]]:
        """Returns the faults of worker processes so far: number of workers that died, number that were stopped, and the numbers by the
        step that they were running (prepare, encode, count, scan, order)."""
        return self._engine.worker_faults()

    def __repr__(self) -> str:
        return f"Engine({self._kind!r})"


def _engine_for(threads: int) -> Engine:
    return Engine._of(_core.Engine.local(_arrays.whole(threads, "threads", MOST_THREADS)), "local")


@overload
def find_pairs(boxes: Any, against: Any = ..., margin: float = ..., order: Order = ..., threads: int = ..., *, padding: Any = ...,
               against_padding: Any = ..., limit: Optional[int] = ..., verify: bool = ..., progress: Progress = ..., copy: bool = ...,
               return_summary: Literal[False] = ...) -> Array: ...


@overload
def find_pairs(boxes: Any, against: Any = ..., margin: float = ..., order: Order = ..., threads: int = ..., *, padding: Any = ...,
               against_padding: Any = ..., limit: Optional[int] = ..., verify: bool = ..., progress: Progress = ..., copy: bool = ...,
               return_summary: Literal[True]) -> Tuple[Array, Summary]: ...


def find_pairs(boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", threads: int = 0, *,
               padding: Any = None, against_padding: Any = None, limit: Optional[int] = None, verify: bool = False,
               progress: Progress = None, copy: bool = False,
               return_summary: bool = False) -> Union[Array, Tuple[Array, Summary]]:
    """Finds all pairs of overlapping boxes. Boxes are closed: boxes that touch are a pair.

    For repeated calls keep an :class:`Engine`, which keeps its memory.

    Parameters
    ----------
    boxes : array, shape (n, 6), float32 or float64
        Rows of min x, y, z, max x, y, z, in any unit. C-contiguous; read where it lies.
    against : array, shape (k, 6), optional
        A second set. Then `a` is an index in `boxes` and `b` an index in `against`.
    margin : float
        Largest gap, per axis, at which a pair counts.
    order : {"ascending", "octal"}
        ``"ascending"`` sorts by a, then b. ``"octal"`` is the order of the octree, and is cheaper. Both are deterministic.
    threads : int
        0: one per core.
    padding, against_padding : array, shape (n,) or (k,), float64, or float, optional
        Clearance of each object. The gap of a pair may be the margin and both paddings.
    limit : int, optional
        Maximum number of pairs; the first ones in `order`. The summary says whether more exist.
    verify : bool
        True: a second algorithm that shares no code with the octree checks the result.
    progress : callable or bool
        Receives the fraction that is done, on this thread. True: a bar.
    copy : bool
        True: converts arrays of another dtype or layout, and sequences, instead of refusing them.
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
        Also a ValueError for invalid boxes, options and shapes, and a TypeError for other dtypes. ``index`` is the first invalid box.
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


def count_pairs(boxes: Any, against: Any = None, margin: float = 0, threads: int = 0, *, padding: Any = None,
                against_padding: Any = None, limit: Optional[int] = None, verify: bool = False, progress: Progress = None,
                copy: bool = False) -> int:
    """Returns the number of pairs, at most `limit`. Stores none of them.

    Parameters are those of :func:`find_pairs`.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> op.count_pairs(np.zeros((1000, 6)))
    499500
    """
    return _engine_for(threads).count_pairs(boxes, against, margin, padding=padding, against_padding=against_padding, limit=limit,
                                            verify=verify, progress=progress, copy=copy)


def stream_pairs(boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", threads: int = 0, *,
                 padding: Any = None, against_padding: Any = None, limit: Optional[int] = None, verify: bool = False,
                 buffer_bytes: int = 1 << 30, copy: bool = False) -> PairStream:
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
    return _engine_for(threads).stream_pairs(boxes, against, margin, order, padding=padding, against_padding=against_padding,
                                             limit=limit, verify=verify, buffer_bytes=buffer_bytes, copy=copy)
