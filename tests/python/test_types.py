"""Types, stubs, docstrings, and what notebooks show."""
import doctest
import importlib
import inspect
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest
from conftest import random_boxes

import octopair as op

PACKAGE = pathlib.Path(op.__file__).parent
ROOT = pathlib.Path(__file__).parents[2]
MODULES = ["octopair", "octopair._engine", "octopair._octants", "octopair._pipeline", "octopair._scene", "octopair._shapes", "octopair.mpi",
           "octopair.remote", "octopair.trimesh"]


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings(name):
    module = pytest.importorskip(name) if name in ("octopair.mpi", "octopair.remote") else importlib.import_module(name)
    assert doctest.testmod(module).failed == 0


def test_examples_of_the_guide():
    assert doctest.testfile(str(ROOT / "docs" / "python.md"), module_relative=False).failed == 0


def test_the_example_of_the_readme(capsys):
    example = (ROOT / "README.md").read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(example, {})
    words = capsys.readouterr().out.split()
    assert words[1] == "pairs;" and int(words[0]) > 50_000 and int(words[2]) + int(words[5]) > 0


def run(*command):
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "MYPYPATH": str(PACKAGE.parent)}
    found = subprocess.run(command, capture_output=True, text=True, cwd=PACKAGE.parent, env=environment)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.skipif(shutil.which("mypy") is None, reason="mypy is not installed")
def test_types(folder, tmp_path):
    run("mypy", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(tmp_path), "octopair")
    modules = [f"octopair.{name}" for name in ("_core", "_remote", "_mpi") if list(PACKAGE.glob(f"{name}.*.so"))]
    run("stubtest", "--mypy-config-file", str(ROOT / "pyproject.toml"), "--allowlist", str(folder / "stubtest_allowed.txt"), *modules)
    use = tmp_path / "use.py"
    use.write_text("import octopair as op\nfrom typing import Any\nboxes: Any = None\nreveal_type(op.find_pairs(boxes))\n"
                   "reveal_type(op.find_pairs(boxes, return_summary=True))\nreveal_type(op.Scene().step().began)\n")
    shown = subprocess.run(["mypy", "--cache-dir", str(tmp_path), str(use)], capture_output=True, text=True,
                           env={**os.environ, "MYPYPATH": str(PACKAGE.parent)}).stdout
    assert shown.count("ndarray") == 3 and "Tuple" in shown and "Summary" in shown


def public(owner):
    for name, member in vars(owner).items():
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, (classmethod, property))):
            yield name, member


def test_everything_public_has_a_docstring():
    from octopair import remote, trimesh
    missing = []
    for module in (op, remote, trimesh):
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isclass(thing) or inspect.isfunction(thing):
                if not inspect.getdoc(thing):
                    missing.append(name)
                if inspect.isclass(thing):
                    missing += [f"{name}.{member}" for member, value in public(thing) if not inspect.getdoc(value)]
    assert not missing


def test_reprs_tell_sizes():
    boxes = random_boxes(2000)
    engine, scene = op.Engine(), op.Scene(0.5)
    scene.add(boxes)
    step, job = scene.step(), engine.submit(boxes)
    result = job.result()
    shapes = op.Shapes([op.Geometry.sphere(1)], op.make_poses(np.zeros((2000, 3))), np.zeros(2000, int))
    few = op.Shapes(shapes.geometries, shapes.poses[:3], shapes.geometry[:3])
    table = op.collide(few)
    shown = [repr(x) for x in (engine, scene, step, job, result, shapes, few.geometries[0], table, scene.overlaps([0, 0, 0, 9, 9, 9]))]
    assert shown == ["Engine('local')", "Scene(2,000 objects, dtype='float32', margin=0.5)",
                     f"StepResult({len(step.began):,} began, 0 ended, 0 persisting)", "Job(done, 100%)",
                     f"JobResult({len(result.pairs):,} pairs)", "Shapes(2,000 objects, 1 geometries)", "Geometry(sphere)",
                     "Collisions(3: 3 duplicate; 0 contacts)", "Answers(2,000 answers to 1 queries)"]
    for thing in (step, result, result.summary, table, table.summary):
        page = thing._repr_html_()
        assert page.startswith("<table>") and page.count("<tr>") >= 3


def test_import_is_fast_and_light():
    code = ("import numpy, time, sys; b = time.perf_counter(); import octopair; print(time.perf_counter() - b); "
            "print([m for m in ('scipy', 'tqdm', 'mpi4py', 'octopair._remote', 'octopair._mpi', 'trimesh') if m in sys.modules])")
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.splitlines()
    assert shown[1] == "[]"
