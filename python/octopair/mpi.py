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

from typing import Any, Dict, Optional

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._engine import Engine, PairStream
from ._errors import InputTypeError, UsageError
from ._options import Order, call_options
from ._results import Summary

try:
    from . import _mpi
except ImportError as error:
    raise UsageError(f"this octopair has no MPI: {error}") from error

__all__ = ["MpiEngine", "make_engine"]


class MpiEngine(Engine):
    """An engine of MPI ranks. :func:`octopair.mpi_engine` makes it."""

    def find_pairs(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *,
                   padding: Any = None, against_padding: Any = None, limit: Optional[int] = None, verify: bool = False,
                   progress: Any = None, copy: bool = False, return_summary: bool = False) -> Any:
        """Returns this rank's piece of the pairs. Parameters are those of :func:`octopair.find_pairs`, without progress."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        pairs, summary = _mpi.find_pairs(self._ready(), data, call_options(margin, order, limit, verify))
        return (pairs, Summary._of(summary)) if return_summary else pairs

    def gather_pairs(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *, padding: Any = None,
                     against_padding: Any = None, limit: Optional[int] = None, copy: bool = False) -> Array:
        """Returns all pairs on rank 0, and none on the other ranks."""
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        return _mpi.gather_pairs(self._ready(), data, call_options(margin, order, limit))[0]

    def find_pairs64(self, boxes: Any, against: Any = None, margin: float = 0, order: Order = "ascending", *, indices: Any = None,
                     against_indices: Any = None, padding: Any = None, against_padding: Any = None, limit: Optional[int] = None,
                     copy: bool = False) -> Array:
        """Returns this rank's piece of the pairs as uint64, for indices of your own, or for more than 2^32 - 1 objects.

        Parameters
        ----------
        indices, against_indices : array, shape (n,), uint64, optional
            Index of each object, unique in its set. They alone define the order. Default: numbers in rank order.
        """
        arguments = _arrays.join_input(boxes, against, (padding, against_padding), copy)
        numbers = (_arrays.column(indices, "indices", len(arguments[0]), np.uint64, copy),
                   None if against is None else _arrays.column(against_indices, "against_indices", len(arguments[2]), np.uint64, copy))
        return _mpi.find_pairs64(self._ready(), _core.Input(*arguments), numbers, call_options(margin, order, limit))[0]

    def count_pairs(self, *arguments: Any, **options: Any) -> int:
        """Returns the number of pairs of all ranks."""
        return self.find_pairs(*arguments, **options, return_summary=True)[1].pairs

    def stream_pairs(self, *arguments: Any, **options: Any) -> PairStream:
        """Not supported: streams run on a thread of their own. Use :meth:`find_pairs`."""
        raise UsageError("an engine of MPI ranks does not stream in Python; find_pairs() returns this rank's piece")

    def last_costs(self) -> Dict[str, float]:
        """Returns the costs of the last call on this rank: seconds of each step, bytes and messages sent, and counts of objects."""
        return _mpi.last_costs(self._engine)


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


