"""Types, stubs, docstrings, and what notebooks show."""
import dataclasses
import doctest
import importlib
import inspect
import os
import pathlib
import shutil
import subprocess
import sys
import typing

import numpy as np
import numpy.typing as npt
import pytest
from conftest import random_boxes

import octopair as op

PACKAGE = pathlib.Path(op.__file__).parent
ROOT = pathlib.Path(__file__).parents[2]
MODULES = ["octopair", "octopair._collisions", "octopair._engine", "octopair._jobs", "octopair._octants", "octopair._pipeline", "octopair._scene", "octopair._shapes", "octopair.mpi",
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


@pytest.fixture(scope="module")
def mypy_cache(tmp_path_factory):
    """Folder of what mypy knows of the modules that it has read, which takes 10 s."""
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    return str(tmp_path_factory.mktemp("mypy"))


def test_types(folder, tmp_path, mypy_cache):
    run("mypy", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", mypy_cache, "octopair")
    modules = [f"octopair.{name}" for name in ("_core", "_remote", "_mpi") if list(PACKAGE.glob(f"{name}.*.so"))]
    run("stubtest", "--mypy-config-file", str(ROOT / "pyproject.toml"), "--allowlist", str(folder / "stubtest_allowed.txt"), *modules)
    use = tmp_path / "use.py"
    use.write_text("import octopair as op\nfrom typing import Any\nboxes: Any = None\nreveal_type(op.find_pairs(boxes))\n"
                   "reveal_type(op.find_pairs(boxes, return_summary=True))\nreveal_type(op.Scene().step().began)\n")
    shown = subprocess.run(["mypy", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", mypy_cache, str(use)], capture_output=True, text=True,
                           env={**os.environ, "MYPYPATH": str(PACKAGE.parent)}).stdout
    assert shown.count("ndarray") == 3 and "Tuple" in shown and "Summary" in shown


CALLS = {
    "op.find_pairs(boxes, boxes, {})": "margin=1.0, order='octal', threads=1, padding=boxes, against_padding=boxes, limit=3, verify=True, progress=True, copy=True, return_summary=True",
    "op.count_pairs(boxes, boxes, {})": "margin=1.0, threads=1, padding=boxes, against_padding=boxes, limit=3, verify=True, progress=True, copy=True",
    "op.stream_pairs(boxes, boxes, {})": "margin=1.0, order='octal', threads=1, padding=boxes, limit=3, verify=True, buffer_bytes=1, copy=True",
    "engine.find_pairs(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, verify=True, progress=True, return_summary=False",
    "engine.count_pairs(boxes, boxes, {})": "margin=1.0, padding=boxes, limit=3, verify=True, progress=True",
    "engine.stream_pairs(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, verify=True, buffer_bytes=1",
    "engine.submit(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, verify=True",
    "engine.allocate_boxes(3, {})": "dtype='float64'",
    "op.Engine('local', {})": "threads=1, workers=1, token='a', server_user='a', token_in_clear=True, owner='a', authority='a', certificate='a', key='a', tls=True, "
                              "connect_timeout=1.0, patience=1.0",
    "op.mpi_engine(None, {})": "threads=1",
    "ranks.find_pairs(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, verify=True, return_summary=True",
    "ranks.gather_pairs(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3",
    "ranks.find_pairs64(boxes, boxes, {})": "margin=1.0, order='octal', indices=boxes, against_indices=boxes, padding=boxes, limit=3",
    "ranks.count_pairs(boxes, boxes, {})": "margin=1.0, padding=boxes, limit=3",
    "op.list_octants(boxes, {})": "margin=1.0, threads=1, padding=boxes, copy=True",
    "op.Scene({})": "margin=1.0, dtype='float64', threads=1, recording='a', slack=1.0",
    "scene.add(boxes, {})": "groups=1, mask=boxes, fixed=True, padding=boxes, copy=True",
    "scene.move(boxes, boxes, {})": "copy=True",
    "scene.sweep(boxes, boxes, {})": "copy=True",
    "scene.set_traits(boxes, {})": "groups=1, mask=boxes, fixed=True, copy=True",
    "scene.overlaps(boxes, {})": "groups=1",
    "scene.first_hits(boxes, boxes, {})": "longest=1.0, groups=1",
    "scene.all_hits(boxes, boxes, {})": "longest=boxes, groups=1",
    "scene.nearest(boxes, {})": "k=1, within=1.0, groups=1",
    "op.View(scene, {})": "title='a', names=['a'], up='z', unit='m', host='a', port=1, token='a', frames_per_second=1.0, open_browser=True",
    "view.show(scene.step(), {})": "at_once=True",
    "op.Pipeline({})": "threads=1",
    "op.Pipeline().keep(len, {})": "name='a'",
    "op.Pipeline().groups(boxes, boxes, {})": "against=(boxes, boxes)",
    "op.Pipeline().ignored_pairs(boxes, {})": "join=True",
    "op.Pipeline().name_rules(['a'], [('a', 'b')], {})": "against=['a']",
    "op.Pipeline().column_rules({{}}, [], {})": "against={}",
    "op.Pipeline().bounding_spheres(shapes, shapes, {})": "margin=1.0",
    "op.Pipeline().oriented_boxes(shapes, shapes, {})": "margin=1.0",
    "op.Pipeline().exact_objects(shapes, shapes, {})": "margin=1.0",
    "op.Pipeline().exact_features(shapes, shapes, {})": "margin=1.0, max_contacts=1, tolerance=1.0, duplicate_tolerance=1.0",
    "op.Pipeline().triangles(boxes, {})": "owners=boxes, adjacent='include', margin=1.0, features=True, tolerance=1.0, against=(boxes, None)",
    "op.Pipeline().run(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, verify=True, engine=engine, sink=print, progress=True, copy=True",
    "op.Pipeline().count(boxes, boxes, {})": "margin=1.0, padding=boxes, limit=3, verify=True, engine=engine, progress=True, copy=True",
    "op.collide(shapes, shapes, {})": "margin=1.0, max_contacts=1, tolerance=1.0, min_depth=1.0, stage='objects', keep=len, order='octal', limit=3, engine=engine, "
                                      "progress=True",
    "op.self_intersections(boxes, boxes, {})": "adjacent='include', margin=1.0, features=True, tolerance=1.0, limit=3, engine=engine, progress=True",
    "op.Geometry.mesh(boxes, boxes, {})": "weld=1.0",
    "op.Shapes([], boxes, boxes, {})": "end_poses=boxes, padding=1.0, names=['a']",
    "op.Shapes.from_trimesh(boxes, {})": "weld=1.0",
    "op.detect('a', 'b', {})": "against='a', stage='pairs', margin=1.0, same_parent='exclude', events=True, engine='local', threads=1",
    "op.generate('uniform', 3, {})": "seed=1, frames=3",
    "op.replay('a', {})": "threads=1, check=True",
    "table.to_pandas({})": "contacts=True",
    "op.remote.JobClient('a:1', {})": "token='a', tls=True, patience=1.0",
    "op.remote.client_options({})": "token='a', server_user='a', token_in_clear=True, owner='a', tls=True, connect_timeout=1.0, patience=1.0",
    "client.submit(boxes, boxes, {})": "margin=1.0, order='octal', padding=boxes, limit=3, count_only=True, id='a', progress=True",
    "op.remote.RemoteScene('a:1', {})": "margin=1.0, dtype='float64', token='a', tls=True, patience=1.0",
}
# One call a line follows; each variable has its type.
OBJECTS = """import numpy as np
import octopair as op
from octopair.mpi import MpiEngine
from numpy.typing import NDArray
boxes: NDArray[np.float64] = np.zeros((2, 6))
def use(engine: op.Engine, ranks: MpiEngine, scene: op.Scene, view: op.View, shapes: op.Shapes, table: op.Collisions,
        client: op.remote.JobClient) -> None:
"""


def mypy_errors(path, lines, cache):
    """Returns the numbers of the lines that mypy --strict complains about, each as often as it does."""
    path.write_text(OBJECTS + "".join(f"    {line}\n" for line in lines))
    shown = subprocess.run(["mypy", "--strict", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", cache, str(path)],
                           capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(PACKAGE.parent)}).stdout
    found = [int(line.split(":")[1]) - OBJECTS.count("\n") - 1 for line in shown.splitlines() if ": error: " in line]
    assert found or "Success" in shown, shown
    return found, shown


def in_calls(change):
    """Returns the calls, with the keywords changed."""
    return [call.format(change(keywords)) for call, keywords in CALLS.items()]


def test_a_type_checker_sees_every_keyword(tmp_path, mypy_cache):
    right = in_calls(lambda keywords: keywords)
    misspelt = in_calls(lambda keywords: keywords.replace("=", "x=", 1)) + in_calls(lambda keywords: "nonsense=1")
    positional = in_calls(lambda keywords: "1.5")
    found, shown = mypy_errors(tmp_path / "calls.py", right + misspelt + positional, mypy_cache)
    lines = right + misspelt + positional
    begin, end = len(right), len(right) + len(misspelt)
    expected = [*range(begin, end)]
    assert [i for i in found if i < end] == expected, [lines[i] for i in range(end) if found.count(i) != (i >= begin)] + [shown]
    assert {i for i in found if i >= end} == {*range(end, len(lines))}, [lines[i] for i in range(end, len(lines)) if i not in found]


def calls_of(owner):
    for name in getattr(owner, "__all__", None) or [name for name in vars(owner) if not name.startswith("_")]:
        member = getattr(owner, name)
        if inspect.isclass(member) and not issubclass(member, Exception):
            yield name, member.__init__
            yield from ((f"{name}.{inner}", call) for inner, call in calls_of(member))
        elif inspect.isroutine(member):
            yield name, member


def test_everything_after_the_data_is_a_keyword():
    from octopair import mpi, remote
    data = {"self", "boxes", "against", "ids", "indices", "queries", "origins", "directions", "places", "rotations", "vertices", "faces", "points",
            "shapes", "geometries", "poses", "geometry", "groups", "mask", "pairs", "names", "columns", "rules", "parents", "triangles", "source", "scene",
            "step", "job", "id", "address", "kind", "objects", "recording", "comm", "condition", "function", "count", "row", "octant", "least",
            "timeout", "radius", "length", "radii", "half_extents", "normal", "offset"}
    seen = 0
    for module in (op, remote, mpi):
        for name, call in calls_of(module):
            try:
                parameters = inspect.signature(call).parameters.values()
            except ValueError:
                continue  # of C++
            if dataclasses.is_dataclass(getattr(module, name.split(".")[0])) and call.__name__ == "__init__":
                continue  # made by octopair
            for parameter in parameters:
                assert parameter.kind is not parameter.VAR_KEYWORD or name == "View.__exit__", name
                if parameter.kind is parameter.POSITIONAL_OR_KEYWORD and name not in ("Job", "PairStream"):
                    assert parameter.name in data, f"{name}: {parameter.name}"
                    seen += 1
    assert seen > 100


def test_signatures_name_array_likes():
    for call in (op.find_pairs, op.Engine.find_pairs):
        signature = str(inspect.signature(call))
        assert "boxes: 'ArrayLike'" in signature and "against: 'Optional[ArrayLike]'" in signature and "NDArray[np.uint32]" in signature
        assert "Any" not in signature
        hints = typing.get_type_hints(call)
        assert hints["boxes"] == npt.ArrayLike and npt.NDArray[np.uint32] in typing.get_args(hints["return"])


def test_dir_shows_the_interface_alone():
    assert dir(op) == sorted([*op.__all__, "mpi", "remote", "trimesh"]) and len(set(op.__all__)) == len(op.__all__)
    for name in dir(op):
        if name not in ("mpi", "remote"):
            assert getattr(op, name) is not None
    assert op.trimesh.CollisionManager and not hasattr(op, "nonsense")
    with pytest.raises(AttributeError, match="nonsense"):
        op.nonsense


def test_tracebacks_name_the_errors_of_users():
    shown = subprocess.run([sys.executable, "-c", "import octopair; octopair.find_pairs([['a'] * 6])"], capture_output=True, text=True).stderr
    assert shown.splitlines()[-1].startswith("octopair.InputTypeError: boxes: the dtype is <U1")


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
    engine, scene = op.Engine(), op.Scene(margin=0.5)
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
