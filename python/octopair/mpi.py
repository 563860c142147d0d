"""Engines of MPI ranks. The part of octopair that needs MPI; communicators are those of mpi4py.

Every call is collective: all ranks make the same calls in the same order with the same options. Each rank passes its own slice of the
objects; a slice may be empty. An error on one rank is raised on all ranks. Calls run on the calling thread, and Ctrl-C takes effect after
them.

>>> from mpi4py import MPI                                          # doctest: +SKIP
>>> engine = octopair.mpi_engine(MPI.COMM_WORLD)                    # doctest: +SKIP
>>> pairs = engine.find_pairs(my_boxes)         # my piece          # doctest: +SKIP
>>> pairs = engine.gather_pairs(my_boxes)       # all, on rank 0    # doctest: +SKIP
"""

from __future__ import annotations

import contextlib
from typing import Any, Callable, Dict, Iterator, Literal, Optional, Tuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core
from ._engine import Engine
from ._errors import Error, InputTypeError, UsageError
from ._jobs import PairStream
from ._options import Order, call_options
from ._progress import Progress
from ._results import Summary

try:
    from . import _mpi
except ImportError as error:
    raise UsageError(f"this octopair has no MPI: {error}") from error

__all__ = ["MpiEngine", "make_engine"]


class MpiEngine(Engine):
    """An engine of MPI ranks. :func:`octopair.mpi_engine` makes it."""

    @overload
    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ...,
                   padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
                   verify: bool = ..., progress: Progress = ..., copy: bool = ..., return_summary: Literal[False] = ...) -> NDArray[np.uint32]: ...

    @overload
    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = ..., *, margin: float = ..., order: Order = ...,
                   padding: Optional[ArrayLike] = ..., against_padding: Optional[ArrayLike] = ..., limit: Optional[int] = ...,
                   verify: bool = ..., progress: Progress = ..., copy: bool = ...,
                   return_summary: Literal[True]) -> Tuple[NDArray[np.uint32], Summary]: ...

    def find_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                   padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                   verify: bool = False, progress: Progress = None, copy: bool = False,
                   return_summary: bool = False) -> Union[NDArray[np.uint32], Tuple[NDArray[np.uint32], Summary]]:
        """Returns this rank's piece of the pairs. Parameters are those of :func:`octopair.find_pairs`, without progress."""
        options = call_options(margin, order, limit, verify)
        with _errors_on_all_ranks(against, lambda wrong: _mpi.find_pairs(self._ready(), wrong, options)):
            data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        pairs, summary = _mpi.find_pairs(self._ready(), data, options)
        return (pairs, Summary._of(summary)) if return_summary else pairs

    def gather_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                     padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                     copy: bool = False) -> NDArray[np.uint32]:
        """Returns all pairs on rank 0, and none on the other ranks."""
        options = call_options(margin, order, limit)
        with _errors_on_all_ranks(against, lambda wrong: _mpi.gather_pairs(self._ready(), wrong, options)):
            data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return _mpi.gather_pairs(self._ready(), data, options)[0]

    def find_pairs64(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                     indices: Optional[ArrayLike] = None, against_indices: Optional[ArrayLike] = None,
                     padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                     copy: bool = False) -> NDArray[np.uint64]:
        """Returns this rank's piece of the pairs as uint64, for indices of your own, or for more than 2^32 - 1 objects.

        Parameters
        ----------
        indices, against_indices : array-like, shape (n,), integers, optional
            Index of each object, unique in its set. They alone define the order. Default: numbers in rank order.
        """
        options = call_options(margin, order, limit)
        with _errors_on_all_ranks(against, lambda wrong: _mpi.find_pairs64(self._ready(), wrong, (None, None), options)):
            arguments = _arrays.join_input(boxes, against, (padding, against_padding), copy)
            numbers = (_arrays.column(indices, "indices", len(arguments[0]), np.uint64, copy),
                       None if against is None else _arrays.column(against_indices, "against_indices", len(arguments[2]), np.uint64, copy))
        return _mpi.find_pairs64(self._ready(), _core.Input(*arguments), numbers, options)[0]

    def count_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0,
                    padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                    verify: bool = False, progress: Progress = None, copy: bool = False) -> int:
        """Returns the number of pairs of all ranks."""
        return self.find_pairs(boxes, against, margin=margin, padding=padding, against_padding=against_padding, limit=limit,
                               verify=verify, copy=copy, return_summary=True)[1].pairs

    def stream_pairs(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
                     padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
                     verify: bool = False, buffer_bytes: int = 1 << 30, copy: bool = False) -> PairStream:
        """Not supported: streams run on a thread of their own. Use :meth:`find_pairs`."""
        raise UsageError("an engine of MPI ranks does not stream in Python; find_pairs() returns this rank's piece")

    def last_costs(self) -> Dict[str, float]:
        """Returns the costs of the last call on this rank: seconds of each step, bytes and messages sent, and counts of objects."""
        return _mpi.last_costs(self._engine)


@contextlib.contextmanager
def _errors_on_all_ranks(against: Any, call: Callable[[_core.Input], Any]) -> Iterator[None]:
    """Reads the arrays of this rank. After an error, makes the call with an invalid box, so that the other ranks raise an error, too."""
    try:
        yield
    except Error as error:
        wrong = np.zeros((1 + (error.index or 0), 6))
        wrong[-1] = np.nan
        with contextlib.suppress(Error):
            call(_core.Input(wrong) if against is None else _core.Input(wrong, None, np.empty((0, 6)), None))
        raise


def make_engine(comm: Any, *, threads: int = 1) -> MpiEngine:
    """Returns an engine that uses a duplicate of an mpi4py communicator. Collective.

    Parameters
    ----------
    comm : mpi4py.MPI.Comm
        Communicator.
    threads : int
        Threads of each rank; 0: one per core.
    """
    try:
        from mpi4py import MPI
    except ImportError as error:
        raise UsageError("engines of MPI ranks need mpi4py") from error
    if not isinstance(comm, MPI.Comm):
        raise InputTypeError(f"comm: a {type(comm).__name__} is not a communicator of mpi4py")
    made = _mpi.make_engine(MPI._addressof(comm), threads)
    engine = MpiEngine.__new__(MpiEngine)
    engine._start(made, "mpi")
    return engine


