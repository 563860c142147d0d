"""Jobs and streams: searches that run while Python does other work."""

from __future__ import annotations

import contextlib
import itertools
import threading
import weakref
from typing import TYPE_CHECKING, Any, Callable, Dict, Generator, List, Optional

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _core
from ._errors import InputError, InputTypeError, UsageError
from ._results import JobResult, Summary

if TYPE_CHECKING:
    from ._engine import Engine


class PairStream:
    """The pairs of a search in chunks, in order: an iterator over arrays of shape (m, 2), uint32.

    The search runs while the caller handles a chunk, but not far ahead: memory is bounded. Until the stream has ended or is closed, its
    engine makes no other call. Also a context manager, which closes the stream.
    """

    def __init__(self, engine: Engine, stream: _core.Stream) -> None:
        self._engine = engine
        self._stream = stream
        engine._streams[id(self)] = weakref.ref(self)
        self._open = True

    def __iter__(self) -> PairStream:
        return self

    def __next__(self) -> NDArray[np.uint32]:
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
            self._engine._streams.pop(id(self), None)

    @property
    def summary(self) -> Optional[Summary]:
        """Counts and times, after the last chunk; before that None."""
        row = self._stream.summary
        return None if row is None else Summary._of(row)

    def __enter__(self) -> PairStream:
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

    The job holds references to its arrays, which must not change until it has ended. A job that is garbage-collected is cancelled, unless
    it has a callback. Thread safety: any thread may call any method.

    In a coroutine of asyncio, ``await job`` returns :meth:`result`, or raises the job's error. If the task that awaits is cancelled, so is
    the job.

    Examples
    --------
    >>> import asyncio, numpy as np, octopair as op
    >>> async def search(boxes):
    ...     with op.Engine() as engine:
    ...         return (await engine.submit(boxes)).pairs
    >>> asyncio.run(search(np.zeros((2, 6))))
    array([[0, 1]], dtype=uint32)
    """

    def __init__(self, job: _core.Job) -> None:
        self._job = job
        self._lock = threading.Lock()
        self._result: Optional[JobResult] = None
        self._callbacks: List[Callable[[Job], Any]] = []
        self._called_back = False  # callbacks that are added from now on run at once

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

    def add_done_callback(self, function: Callable[[Job], Any]) -> None:
        """Calls ``function(job)`` when the job has ended: done, failed or cancelled.

        If the job has ended before, the call is made at once, on this thread. Otherwise one thread makes the calls of all jobs, so a
        function should return soon. Until then the job is kept, also without other references. An exception of a function is logged, as
        by :mod:`concurrent.futures`, and the other functions are called nevertheless.

        Parameters
        ----------
        function : callable
            Receives the job.
        """
        if not callable(function):
            raise InputTypeError(f"function: a {type(function).__name__} is not callable")
        with self._lock:
            if not self._called_back:
                if self._callbacks or _watcher.watch(self):
                    self._callbacks.append(function)
                    return
                self._called_back = True
        self._job.wait()  # the job may be ending
        self._call(function)

    def _call_back(self) -> None:
        """Runs the callbacks. Requires: the job has ended, or is ending."""
        self._job.wait()
        with self._lock:
            functions, self._callbacks = self._callbacks, []
            self._called_back = True
        for function in functions:
            try:
                self._call(function)
            except BaseException:  # SystemExit of a function ends neither the others nor the thread
                self._log_failure()

    def _call(self, function: Callable[[Job], Any]) -> None:
        try:
            function(self)
        except Exception:
            self._log_failure()

    def _log_failure(self) -> None:
        """Logs the exception that is being handled."""
        import logging  # takes 10 ms
        logging.getLogger("octopair").exception("a callback of %r raised an exception", self)

    def __await__(self) -> Generator[Any, None, JobResult]:
        import asyncio  # takes 60 ms
        loop = asyncio.get_running_loop()
        ended = loop.create_future()

        def wake() -> None:
            if not ended.done():
                ended.set_result(None)

        def wake_loop(job: Job) -> None:
            with contextlib.suppress(Exception):
                job.result()  # copies the pairs on this thread, not on that of the loop
            with contextlib.suppress(RuntimeError):  # the loop is closed
                loop.call_soon_threadsafe(wake)

        self.add_done_callback(wake_loop)
        try:
            yield from ended
        except asyncio.CancelledError:
            self.cancel()
            raise
        return self.result()

    def __repr__(self) -> str:
        return f"Job({self.state}, {self.progress:.0%})"


class _Watcher:
    """Runs the callbacks of all jobs, on one thread that starts with the first callback."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._jobs: Dict[int, Job] = {}
        self._numbers = itertools.count()
        self._thread: Optional[threading.Thread] = None

    def watch(self, job: Job) -> bool:
        """Calls ``job._call_back()`` when the job ends. Returns False if the job is ending or has ended."""
        with self._lock:
            if self._thread is None:
                thread = threading.Thread(target=self._run, name="octopair callbacks", daemon=True)
                thread.start()
                self._thread = thread
            number = next(self._numbers)
            self._jobs[number] = job
            watched = job._job.watch(number)
            if not watched:
                del self._jobs[number]
            return watched

    def _run(self) -> None:
        while True:
            try:
                number = _core.next_ended_job()
            except UsageError:  # the process was forked, which watch() says
                return
            job = self._jobs.pop(number)
            try:
                job._call_back()
            except BaseException:  # nothing ends the thread
                job._log_failure()
            del job


_watcher = _Watcher()
