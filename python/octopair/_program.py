"""Files, as the program octopair handles them: detect, generate, replay. The program runs as a child process."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
from typing import Any, Dict, List, Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._arrays import Array
from ._errors import EngineError, Error, FileError, InputError, ResourceLimitError, UsageError
from ._options import Order, PathLike, path_text
from ._results import html_table

Stage = Literal["pairs", "objects", "features"]
_OF_STATUS = {2: UsageError, 3: InputError, 4: FileError, 5: ResourceLimitError, 6: EngineError}


def program_path() -> str:
    """Returns the path of the program: that of the environment variable OCTOPAIR_PROGRAM, of this package, or of the PATH.

    Raises
    ------
    FileError
        If there is none.
    """
    own = pathlib.Path(__file__).parent / "bin" / "octopair"
    found = os.environ.get("OCTOPAIR_PROGRAM") or (str(own) if own.exists() else shutil.which("octopair"))
    if not found:
        raise FileError("the program octopair is neither in this package nor on the PATH; install it, or set OCTOPAIR_PROGRAM")
    return found


def main() -> None:
    """Runs the program with the arguments of this process: the command ``octopair``."""
    try:
        program = program_path()
    except FileError as error:
        sys.exit(f"octopair: {error}")
    os.execv(program, ["octopair", *sys.argv[1:]])


def _run(arguments: Sequence[str]) -> None:
    """Runs the program. Raises the error that its exit status stands for, with its message."""
    program = program_path()
    try:
        child = subprocess.Popen([program, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    except OSError as error:
        raise FileError(f"cannot run {program}: {error.strerror}") from error
    try:
        messages = child.communicate()[1].decode(errors="replace")
    except BaseException:
        child.send_signal(signal.SIGINT)
        child.wait()
        raise
    if child.returncode == 0:
        return
    lines = [line for line in messages.strip().splitlines() if line]
    text = lines[-1] if lines else f"octopair {arguments[0]} ended with status {child.returncode}"
    prefix = "octopair: "
    raise _OF_STATUS.get(child.returncode, EngineError)(text[len(prefix):] if text.startswith(prefix) else text)


def _option(name: str, value: Any) -> List[str]:
    """Returns the arguments of an option: none for None and False, one for True, one for each element of a list."""
    if isinstance(value, (list, tuple)):
        return [argument for element in value for argument in _option(name, element)]
    flag = "--" + name.replace("_", "-")
    if value is None or value is False:
        return []
    # In one argument, a path that begins with a dash is not an option.
    return [flag if value is True else f"{flag}={os.fspath(value) if isinstance(value, os.PathLike) else value}"]


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class Detection:
    """Result of :func:`detect`.

    Attributes
    ----------
    pairs : numpy.ndarray
        Shape (m, 2), uint32, or uint64 where an index needs it.
    collisions : list of dict or None
        Rows of the exact stages as in a ``.jsonl`` result: names, class, depth, contacts. None for the stage ``"pairs"``.
    stats : dict
        What ``--stats`` writes: counts, times, warnings.
    frame_offsets : numpy.ndarray or None
        Of a moving scene: the pairs of frame `i` are at ``frame_offsets[i]`` to ``frame_offsets[i + 1]``.
    events : numpy.ndarray or None
        With ``events=True``: rows of frame, event (``"begin"`` or ``"end"``), a, b, as a structured array.
    """

    pairs: Array
    collisions: Optional[List[Dict[str, Any]]]
    stats: Dict[str, Any]
    frame_offsets: Optional[Array] = None
    events: Optional[Array] = None

    @property
    def truncated(self) -> bool:
        """True if the limit was reached and more exist."""
        return bool(self.stats.get("truncated", False))

    def __repr__(self) -> str:
        kind = "pairs" if self.collisions is None else "collisions"
        return f"Detection({len(self.pairs):,} {kind}{', truncated' if self.truncated else ''})"

    def _repr_html_(self) -> str:
        return html_table("detect", [("objects", f"{self.stats.get('objects', 0):,}"), ("found", f"{len(self.pairs):,}"),
                                     ("time", f"{self.stats.get('seconds', {}).get('total', 0):.3f} s")])


def detect(*inputs: PathLike, against: Optional[PathLike] = None, stage: Optional[Stage] = None,
           objects: Optional[Literal["node", "triangle"]] = None, reader: Optional[str] = None,
           include_type: Union[None, str, Sequence[str]] = None, margin: Optional[float] = None, padding: Optional[PathLike] = None,
           adjacent: Optional[Literal["beyond_shared", "beyond-shared", "exclude", "include"]] = None, max_contacts: Optional[int] = None,
           tolerance: Optional[float] = None, duplicate_tolerance: Optional[float] = None, chord: Optional[float] = None,
           min_depth: Optional[float] = None, classes: Optional[str] = None, weld: Optional[float] = None,
           exclude: Optional[PathLike] = None, same_parent: Optional[Literal["include", "exclude"]] = None,
           baseline: Optional[PathLike] = None, statuses: Optional[PathLike] = None, report: Optional[PathLike] = None,
           up: Optional[Literal["y", "z"]] = None, unit: Optional[str] = None, events: bool = False,
           index_type: Optional[Literal["uint32", "uint64"]] = None, order: Optional[Order] = None, limit: Optional[int] = None,
           verify: bool = False, engine: Optional[str] = None, threads: Optional[int] = None, workers: Optional[int] = None,
           token_file: Optional[PathLike] = None, token_in_clear: bool = False, server_user: Optional[str] = None, tls: bool = False,
           tls_authority: Optional[PathLike] = None, tls_certificate: Optional[PathLike] = None, tls_key: Optional[PathLike] = None,
           patience: Optional[float] = None) -> Detection:
    """Finds the colliding pairs of files, as ``octopair detect`` does it: boxes, mesh scenes, JSON scenes.

    The keywords are the options of the command, with underscores; ``man octopair`` describes them. None and False: the default of the
    command.

    Parameters
    ----------
    *inputs : path
        Files; several are one set.
    against : path, optional
        File of a second set.
    stage : {"pairs", "objects", "features"}, optional
        How far down the pipeline. Default: pairs for boxes, objects for meshes.
    objects : {"node", "triangle"}, optional
        What counts as one object of a mesh file.
    reader : str, optional
        Command that reads the files and writes a model stream.
    include_type : str or sequence of str, optional
        Types of IFC elements that are read in addition, such as ``"IfcSpace"``.
    margin, padding
        Largest gap at which a pair counts; file with the clearance of each object.
    adjacent, max_contacts, tolerance, duplicate_tolerance, chord, min_depth, classes, weld
        Options of the exact stages: :meth:`Pipeline.triangles`, :meth:`Pipeline.exact_features`, :meth:`Geometry.mesh`. `classes` is a
        list with commas.
    exclude, same_parent
        File with rules on names and relations, or relations of IFC elements such as ``"fills,assembly"``; whether pairs of objects with
        the same parent are left out.
    baseline, statuses, report, up, unit
        File with an older result; file with what people decided, which is read and written; page about the collisions, its upward
        axis, and its unit.
    events : bool
        True: only what began and ended, of a moving scene.
    index_type, order, limit, verify
        Form and number of the pairs; True: a second algorithm checks the result.
    engine, threads, workers
        ``"local"``, ``"processes"`` or an address of a server; number of threads or processes.
    token_file, token_in_clear, server_user, tls, tls_authority, tls_certificate, tls_key, patience
        Options of the connection to a server.

    Raises
    ------
    Error
        With the message of the program.
    """
    options = locals()
    del options["inputs"]
    if not inputs:
        raise UsageError("inputs: there must be at least one file")
    files = [_file(name, "inputs") for name in inputs]
    if against is not None:
        options["against"] = _file(against, "against")
    if isinstance(adjacent, str):
        options["adjacent"] = adjacent.replace("_", "-")
    with tempfile.TemporaryDirectory(prefix="octopair-") as folder:
        form = ".csv" if events else ".jsonl" if (reader is not None or _has_shapes(files)) and stage != "pairs" else ".npy"
        output, stats = os.path.join(folder, "found" + form), os.path.join(folder, "stats.json")
        arguments = [argument for name, value in options.items() for argument in _option(name, value)]
        _run(["detect", *files, *arguments, "--quiet", "--output", output, "--stats", stats])
        with open(stats, encoding="utf-8") as file:
            counts = json.load(file)
        if form == ".csv":
            return _read_events(output, counts)
        return _read_rows(output, counts) if form == ".jsonl" else _read_pairs(pathlib.Path(folder), counts)


def _read_pairs(folder: pathlib.Path, counts: Dict[str, Any]) -> Detection:
    """Reads found.npy, or the files of a moving scene, found.000000.npy and so on."""
    frames = [np.load(path) for path in sorted(folder.glob("found*.npy"))]
    if (folder / "found.npy").exists():
        return Detection(frames[0], None, counts)
    offsets = np.concatenate([[0], np.cumsum([len(frame) for frame in frames])])
    return Detection(np.vstack([np.empty((0, 2), np.uint32), *frames]), None, counts, offsets)


def _read_rows(path: str, counts: Dict[str, Any]) -> Detection:
    with open(path, encoding="utf-8") as file:
        found = [json.loads(line) for line in file]
    return Detection(np.array([(row["a"], row["b"]) for row in found], dtype=np.uint32).reshape(-1, 2), found, counts)


def _read_events(path: str, counts: Dict[str, Any]) -> Detection:
    rows = np.dtype([("frame", np.uint64), ("event", "U5"), ("a", np.uint32), ("b", np.uint32)])
    events = np.atleast_1d(np.loadtxt(path, dtype=rows, delimiter=",", skiprows=1, usecols=(0, 1, 2, 3), ndmin=1))
    return Detection(np.column_stack([events["a"], events["b"]]), None, counts, events=events)


def _file(path: Any, name: str) -> str:
    """Returns a path that is not an option of the program."""
    text = path_text(path, name)
    return os.path.join(".", text) if text.startswith("-") else text


def _has_shapes(inputs: Sequence[str]) -> bool:
    return not any(name.lower().endswith((".npy", ".csv")) for name in inputs)


def generate(kind: str, objects: int, *, seed: int = 0, frames: Optional[int] = None) -> NDArray[np.float32]:
    """Returns the boxes of a sample scene, as ``octopair generate`` makes it.

    Parameters
    ----------
    kind : str
        ``"uniform"``, ``"clustered"``, ``"brownian"`` and others: ``octopair generate --help``.
    objects, seed : int
        Number of objects, and seed of the random numbers.
    frames : int, optional
        Number of frames of a moving scene.

    Returns
    -------
    numpy.ndarray
        Shape (objects, 6), or (frames, objects, 6) with `frames`; float32.
    """
    with tempfile.TemporaryDirectory(prefix="octopair-") as folder:
        path = os.path.join(folder, "boxes.npy")
        if _arrays.text(kind, "kind").startswith("-"):
            raise UsageError(f"kind: {kind!r} is no kind of scene")
        counts = ["--objects", str(_arrays.whole(objects, "objects")), "--seed", str(_arrays.whole(seed, "seed", (1 << 64) - 1))]
        _run(["generate", kind, *counts, *_option("frames", frames), "--quiet", "--output", path])
        return np.load(path)


def replay(recording: PathLike, *, threads: int = 0, check: bool = True) -> None:
    """Runs the recorded calls of a scene again, as ``octopair replay`` does it.

    Parameters
    ----------
    recording : path
        File of ``Scene(recording=...)``.
    threads : int
        0: one per core.
    check : bool
        True: compares each step with the recording.

    Raises
    ------
    EngineError
        With `check`, if a step has another result than recorded.
    InputError
        If the file is not a valid recording.
    """
    _run(["replay", _file(recording, "recording"), *_option("threads", threads), *_option("check", check), "--quiet"])
