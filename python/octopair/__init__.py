"""octopair: every colliding pair among millions of moving 3D objects, exactly.

>>> import numpy as np, octopair as op
>>> boxes = np.array([[0, 0, 0, 1, 1, 1], [5, 5, 5, 6, 6, 6], [1, 0, 0, 2, 1, 1]], dtype=np.float32)
>>> op.find_pairs(boxes)
array([[0, 2]], dtype=uint32)

A box is a row of min x, y, z, max x, y, z; a sphere is a row of centre x, y, z, radius. Boxes are closed: boxes that touch are a pair. No
pair is missing and none is extra; the bytes are the same for every engine and any number of threads.

===================  ============================================================================
to do this           use
===================  ============================================================================
find pairs           :func:`find_pairs`, :func:`count_pairs`, :func:`stream_pairs`
find them often      :class:`Engine`; in the background :meth:`Engine.submit`
follow moves         :class:`Scene`: pairs that begin and end, and queries
collide shapes       :class:`Shapes` and :func:`collide`; filters: :class:`Pipeline`
check a mesh         :func:`self_intersections`
see the octree       :func:`list_octants`, :meth:`Scene.octants`
replace python-fcl   :class:`octopair.trimesh.CollisionManager`
tables for pandas    :meth:`Collisions.to_pandas`; ``dict(table)``, ``pandas.DataFrame(table)``
look at a scene      :class:`View`: a running scene in a browser
read files           :func:`detect`, :func:`generate`, :func:`replay`: what the program does
use a server         ``Engine("unix:PATH")``, :class:`octopair.remote.JobClient`
use MPI              :func:`mpi_engine` with a communicator of mpi4py
===================  ============================================================================

The calls release the GIL. Ctrl-C ends a call within 200 ms; not interrupted are the preparation of a large
mesh, a single query with very many answers, and Python code in callbacks. In an event loop of asyncio use
``await engine.submit(boxes)``. Calls in a process that was forked after octopair was used raise
:class:`UsageError`; use the start method ``spawn`` of multiprocessing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List

from ._arrays import id_dtype
from ._collisions import Collisions
from ._core import OctalCode, __version__
from ._engine import Engine, count_pairs, find_pairs, stream_pairs
from ._errors import (CancelledError, EngineError, Error, FileError, InputError, InputTypeError, ResourceLimitError, UsageError)
from ._jobs import Job, PairStream
from ._octants import Octants, list_octants
from ._pipeline import Pipeline, collide, self_intersections
from ._program import Detection, detect, generate, replay
from ._results import (COLLISION_CLASSES, DEPTH_KINDS, THICKNESS_KINDS, Answers, FilterCounts, Hits, JobResult, Neighbors, PipelineSummary,
                       StepResult, StepSeconds, Summary)
from ._scene import Scene
from ._shapes import Geometry, Shapes, make_poses
from ._viewer import View

__all__ = [
    "COLLISION_CLASSES", "DEPTH_KINDS", "Answers", "CancelledError", "Collisions", "Detection", "Engine", "EngineError", "Error", "FileError",
    "FilterCounts", "Geometry", "Hits", "InputError", "InputTypeError", "Job", "JobResult", "Neighbors", "OctalCode", "Octants", "PairStream",
    "Pipeline", "PipelineSummary", "ResourceLimitError", "Scene", "Shapes", "StepResult", "StepSeconds", "Summary", "THICKNESS_KINDS", "UsageError",
    "View", "__version__", "collide", "count_pairs", "detect", "find_pairs", "generate", "id_dtype", "list_octants", "make_poses", "mpi_engine", "replay",
    "self_intersections", "stream_pairs",
]
_MODULES = ("mpi", "remote", "trimesh")  # imported when they are used

if TYPE_CHECKING:
    from . import mpi as mpi, remote as remote, trimesh as trimesh
else:
    def __getattr__(name: str) -> Any:
        if name not in _MODULES:
            raise AttributeError(f"module 'octopair' has no attribute {name!r}")
        import importlib
        try:
            return importlib.import_module("." + name, __name__)
        except UsageError as error:  # this octopair was built without it
            raise AttributeError(f"module 'octopair' has no attribute {name!r}: {error}") from error


def __dir__() -> List[str]:
    """Returns the names of the interface."""
    return sorted([*__all__, *_MODULES])


def mpi_engine(comm: Any, *, threads: int = 1) -> Engine:
    """Returns an engine that uses the ranks of an mpi4py communicator. Collective.

    Each rank passes its own slice of the boxes; all slices in rank order are the objects of the call. Each rank receives a piece of the
    pairs; all pieces in rank order are the same bytes as from every engine. See :mod:`octopair.mpi`.

    Parameters
    ----------
    comm : mpi4py.MPI.Comm
        Communicator; the engine uses a duplicate of it.
    threads : int
        Threads of each rank; 0: one per core.
    """
    from . import mpi
    return mpi.make_engine(comm, threads=threads)
