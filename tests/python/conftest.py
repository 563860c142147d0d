"""Fixtures of the tests of the Python package. The package is the one on PYTHONPATH, or the installed one."""
import contextlib
import os
import pathlib
import subprocess
import tempfile
import time

import numpy as np
import pytest

import octopair as op
from octopair._program import program_path


def brute_force(boxes, against=None, gap=0.0):
    """Returns the pairs by comparing all boxes, ascending. `gap` is a number or one number per pair of objects."""
    a = np.asarray(boxes, dtype=np.float64)
    b = a if against is None else np.asarray(against, dtype=np.float64)
    apart = np.maximum(a[:, None, :3] - b[None, :, 3:], b[None, :, :3] - a[:, None, 3:])
    meets = (apart <= np.asarray(gap)[..., None] if np.ndim(gap) else apart <= gap).all(axis=2)
    if against is None:
        meets = np.triu(meets, 1)
    return np.argwhere(meets).astype(np.uint32)


def random_boxes(count, seed=1, dtype=np.float32, size=0.1):
    rng = np.random.default_rng(seed)
    low = rng.random((count, 3))
    return np.hstack([low, low + rng.random((count, 3)) * size]).astype(dtype)


@contextlib.contextmanager
def serving(*options):
    """Runs a server on a Unix socket; yields its address."""
    with tempfile.TemporaryDirectory(prefix="octopair-test-") as folder:
        address = "unix:" + os.path.join(folder, "socket")
        command = [program_path(), "serve", "--listen", address, "--quiet", *(option.format(folder=folder) for option in options)]
        log = open(os.path.join(folder, "log"), "w+", encoding="utf-8")
        with subprocess.Popen(command, stdout=log, stderr=log) as server:
            try:
                for _ in range(200):
                    if os.path.exists(os.path.join(folder, "socket")):
                        break
                    if server.poll() is not None:
                        log.seek(0)
                        pytest.fail(f"the server ended: {log.read()}")
                    time.sleep(0.05)
                yield address
            finally:
                server.terminate()
                server.wait(20)
                log.close()


@pytest.fixture(scope="session")
def folder():
    return pathlib.Path(__file__).parent


@pytest.fixture
def boxes():
    return random_boxes(2000)


@pytest.fixture(scope="session", params=["local", "processes"])
def engine(request):
    return op.Engine(request.param)
