"""Program of a rank: compares the pairs of all ranks with those of one process, and prints a word for each comparison."""
import sys

import numpy as np
from conftest import random_boxes
from mpi4py import MPI

import octopair as op

comm = MPI.COMM_WORLD
boxes, others = random_boxes(2000), random_boxes(1000, 2)
ends = np.linspace(0, 2000, comm.size + 1).astype(int)
mine = boxes[ends[comm.rank]:ends[comm.rank + 1]]
my_others = others[ends[comm.rank] // 2:ends[comm.rank + 1] // 2]
engine = op.mpi_engine(comm)


def compare(pieces, expected):
    if comm.rank == 0:
        print("equal" if np.vstack(pieces).tobytes() == expected.tobytes() else "differs", flush=True)


expected = op.find_pairs(boxes)
pairs, summary = engine.find_pairs(mine, return_summary=True)
assert summary.pairs == len(expected) == engine.count_pairs(mine) and engine.last_costs()["objects"] == len(mine)
compare(comm.gather(pairs) or [], expected)
compare(comm.gather(engine.find_pairs(mine, my_others, margin=0.01, order="octal")) or [], op.find_pairs(boxes, others, margin=0.01, order="octal"))
compare([engine.gather_pairs(mine)], expected)
compare(comm.gather(engine.find_pairs64(mine)) or [], expected.astype(np.uint64))
numbers = (np.arange(ends[comm.rank], ends[comm.rank + 1]) + 10**12).astype(np.uint64)
compare(comm.gather(engine.find_pairs64(mine, indices=numbers)) or [], expected.astype(np.uint64) + np.uint64(10**12))

spheres = np.hstack([boxes[:, :3], boxes[:, 3:4] - boxes[:, :1]])
my_spheres = spheres[ends[comm.rank]:ends[comm.rank + 1]]
compare(comm.gather(engine.find_pairs(my_spheres)) or [], op.find_pairs(spheres))
compare(comm.gather(engine.find_pairs(mine.tolist(), np.asfortranarray(my_others))) or [], op.find_pairs(boxes, others))

# An error of one rank is raised on all.
invalid, negative = mine.copy(), my_spheres.copy()
invalid[3], negative[3, 3] = np.nan, -1
calls = [lambda wrong: engine.find_pairs(invalid if wrong else mine), lambda wrong: engine.find_pairs(negative if wrong else my_spheres),
         lambda wrong: engine.find_pairs(my_others, [["a"] * 6] if wrong else mine), lambda wrong: engine.gather_pairs(negative if wrong else mine),
         lambda wrong: engine.find_pairs64(mine, indices=numbers[1:] if wrong else numbers), lambda wrong: engine.count_pairs(negative if wrong else mine)]
for call in calls:
    try:
        call(comm.rank == comm.size - 1)
        raised = False
    except op.Error:
        raised = True
    if all(comm.allgather(raised)) and comm.rank == 0:
        print("equal", flush=True)
for wrong in (lambda: op.mpi_engine(3), lambda: engine.stream_pairs(mine)):
    try:
        wrong()
        sys.exit("no error")
    except op.Error:
        pass
with engine:
    pass
engine.close()
try:
    engine.find_pairs(mine)
    sys.exit("no error")
except op.UsageError:
    pass
