"""Ranks: each test runs ranks.py with mpirun."""
import shutil
import subprocess
import sys

import pytest

pytest.importorskip("mpi4py")
pytestmark = pytest.mark.skipif(shutil.which("mpirun") is None, reason="mpirun is not installed")


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_ranks_find_the_same_bytes(ranks, folder):
    found = subprocess.run(["mpirun", "-n", str(ranks), sys.executable, str(folder / "ranks.py")], capture_output=True, text=True,
                           timeout=120)
    assert found.returncode == 0, found.stdout + found.stderr
    assert found.stdout.splitlines() == ["equal"] * 13
