#!/usr/bin/env python3
"""Checks that includes run one way: each layer uses only itself and the layers that the table below lists for it.

    include_stack.py [--print] [ROOT]     ROOT: the project's directory; default: the parent of tools/

A layer is a folder of src/ with the public headers (include/octopair) that it implements. A file that includes a public
header uses the layer of this header. The folders of bench/ that octopair-bench is made of are layers, too; nothing in
src/ may use these layers. Public headers use only public headers and the standard library. Headers of an adapter use only
public headers, headers of their host, and the standard library. Sources of the Python package and of the interface for C use only public
headers, pybind11, Python and the system's headers. Prints one line for each
include that breaks a rule, and if the stack of docs/design.md is an older one, and exits 1. With --print, prints the current stack.
"""
import pathlib
import re
import sys

DESIGN = "docs/design.md"

# Layers from the bottom up: their purpose, and their public headers.
LAYERS = {
    "base": ("errors, buffers, checked casts", ["error", "limits"]),
    "parallel": ("threads; the only layer that uses oneTBB", []),
    "geometry": ("points, vectors, poses", ["pose"]),
    "boxes": ("boxes, pairs, and the rule of pairs", ["box_array", "input", "objects", "options", "spheres", "summary"]),
    "octree": ("how the octree's steps are run", []),
    "octree/plan": ("octal codes, the space, the octants", ["octal_code"]),
    "octree/build": ("encode, scatter, count", []),
    "octree/sweep": ("the pairs of one octant's entries", []),
    "octree/scan": ("the pairs of all octants", []),
    "octree/dynamic": ("the octree that changes", []),
    "verification": ("a second algorithm that checks results", []),
    "engine": ("what all engines share", ["engine", "job", "pair_list"]),
    "engine/output": ("counts, lists and buckets of pairs", []),
    "engine/threads": ("the engine of threads", ["octants"]),
    "engine/processes": ("the engine of worker processes", ["processes"]),
    "engine/mpi": ("the engine of MPI ranks", ["mpi"]),
    "scene": ("objects that persist and move", ["queries", "scene"]),
    "narrow_phase": ("exact tests of shapes", ["collision", "shapes"]),
    "pipeline": ("filters behind any engine", ["filters", "pipeline"]),
    "verification/shapes": ("certificates that check collisions", []),
    "viewer/scene": ("scenes as data of a page", []),
    "viewer": ("scenes in a browser", ["view"]),
    "samples": ("seeded scenes", []),
    "io": ("scene and result files", []),
    "service/protocol": ("messages between client and server", []),
    "service/client": ("an engine behind a socket", ["client", "job_client", "remote_scene", "scene_watcher"]),
    "service/server": ("jobs of many clients", []),
    "cli/command": ("options, numbers, progress, signals", []),
    "cli/ranks": ("a program as a rank of MPI", []),
    "cli": ("the program octopair", []),
    "bench/machine": ("what measured", []),
    "bench/baselines": ("the known algorithms", []),
    "bench/paper": ("the paper's section 5 again", []),
    "bench/cluster": ("what ranks cost", []),
    "bench/scaling": ("time by threads and ranks", []),
    "bench/program": ("the program octopair-bench", []),
}
# Public headers without a layer, and the layer whose rules apply: octopair.hpp includes all of octopair::octopair,
# version.hpp includes nothing.
WHOLE = {"octopair": "scene", "version": "base"}

OCTREE = ["octree", "octree/plan", "octree/build", "octree/sweep", "octree/scan", "octree/dynamic"]

# Layers that each layer may use, in addition to itself.
USES = {
    "base": [],
    "parallel": ["base"],
    "geometry": ["base"],
    "boxes": ["base", "geometry"],
    "octree": ["base", "boxes"],
    "octree/plan": ["base", "boxes", "octree"],
    "octree/build": ["base", "boxes", "octree", "octree/plan"],
    "octree/sweep": ["base", "boxes", "octree", "octree/plan"],
    "octree/scan": ["base", "boxes", "octree", "octree/plan", "octree/build", "octree/sweep"],
    "octree/dynamic": ["base", "boxes", "octree", "octree/plan", "octree/build"],
    "verification": ["base", "parallel"],
    "engine": ["base", "boxes", "verification"],
    "engine/output": ["base", "boxes", "octree", "engine"],
    "engine/threads": ["base", "parallel", "boxes", *OCTREE, "engine", "engine/output"],
    "engine/processes": ["base", "boxes", *OCTREE, "engine", "engine/output", "engine/threads"],
    "engine/mpi": ["base", "parallel", "boxes", *OCTREE, "engine", "engine/threads"],
    "scene": ["base", "parallel", "geometry", "boxes", *OCTREE, "verification", "engine", "engine/threads"],
    "narrow_phase": ["base", "geometry"],
    "pipeline": ["base", "parallel", "geometry", "boxes", "narrow_phase"],
    "verification/shapes": ["base", "parallel", "verification"],
    "viewer/scene": [],
    "viewer": ["viewer/scene"],
    "samples": ["base"],
    "io": ["base", "geometry", "boxes"],
    "service/protocol": ["base", "engine"],
    "service/client": ["base", "engine", "scene", "service/protocol"],
    "service/server": ["base", "engine", "scene", "service/protocol"],
    "cli/command": ["base"],
    "cli/ranks": ["base", "engine/mpi", "cli/command"],
    "cli": ["base", "parallel", "boxes", *OCTREE, "verification", "verification/shapes", "engine", "engine/mpi", "scene", "viewer/scene", "viewer", "samples", "io",
            "service/protocol", "service/client", "service/server", "cli/command", "cli/ranks"],
    "bench/machine": ["base"],
    "bench/baselines": OCTREE,
    "bench/paper": ["base", "samples", "bench/machine", "bench/baselines"],
    "bench/cluster": ["base", "engine/mpi", "samples", "bench/machine", "bench/baselines", "bench/paper"],
    "bench/scaling": ["base", "samples", "bench/machine", "bench/cluster"],
    "bench/program": ["base", "samples", "io", "cli/command", "cli/ranks", "bench/paper", "bench/cluster", "bench/scaling"],
}
# Layers from which a layer may use only public headers.
PUBLIC = {
    "verification": ["boxes"],  # a check that shares code with what it checks would share its errors
    "narrow_phase": ["boxes"],
    "pipeline": ["engine"],
    "verification/shapes": ["geometry", "boxes", "narrow_phase"],
    "samples": ["geometry", "boxes", "narrow_phase"],
    "io": ["narrow_phase", "pipeline"],
    "service/client": ["boxes"],
    "service/server": ["boxes"],
    "viewer/scene": ["base", "geometry", "boxes", "octree/plan", "engine", "engine/threads", "narrow_phase"],
    "viewer": ["base", "geometry", "boxes", "octree/plan", "engine", "engine/threads", "scene", "narrow_phase"],
    "cli": ["pipeline", "engine/processes", "narrow_phase"],
    "cli/ranks": ["boxes"],
    "bench/baselines": ["boxes"],
    "bench/paper": ["engine"],
    "bench/cluster": ["boxes", "octree/plan"],
    "bench/scaling": ["engine/mpi"],
}

# First part of a third-party include: the layers that may use it.
THIRD_PARTY = {
    "tbb": {"parallel", "bench/baselines"}, "oneapi": {"parallel"},
    "hwy": {"boxes", "octree", "engine/mpi", "scene", "narrow_phase"},
    "assimp": {"io"}, "expat.h": {"io"}, "Eigen": {"narrow_phase"}, "boost": {"narrow_phase", "viewer"}, "zlib.h": {"io", "viewer"}, "minizip": {"io"},
    "grpc": {"service"}, "grpcpp": {"service"}, "google": {"service"}, "openssl": {"service"}, "xxhash.h": {"service", "io"},
    "prometheus": {"service/server"}, "spdlog": {"service/server", "cli"}, "systemd": {"cli"},
    "CLI": {"cli"}, "fmt": {"io", "cli", "bench"}, "nlohmann": {"io", "service", "viewer", "cli", "bench"},
}
# Third-party headers that a public header may include, because every user of its component has them.
IN_PUBLIC = {"mpi.hpp": {"mpi.h"}}
# Hosts of adapters: the first parts of includes of their headers.
ADAPTERS = {"cgal": set(), "fcl": {"fcl", "Eigen"}, "bullet": {"BulletCollision", "LinearMath"}}
# Host of the Python package: the first parts of includes of its headers.
PYTHON = {"pybind11", "Python.h"}
SYSTEM = {"sys", "linux", "netinet", "arpa", "sanitizer"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)

LAYER_OF_HEADER = {header: layer for layer, (_, headers) in LAYERS.items() for header in headers} | WHOLE


def includes_of(path):
    """Yields (line number, is quoted, name) for each include of a file."""
    text = path.read_text(encoding="utf-8")
    return [(text.count("\n", 0, m.start(2)) + 1, m[1] == '"', m[2]) for m in INCLUDE.finditer(text)]


def layer_of(folder):
    """Returns the layer of a folder, named from src/ or from the root for bench/; None if it has no layer."""
    parts = folder.split("/")
    return next((layer for n in (2, 1) if (layer := "/".join(parts[:n])) in LAYERS), None)


def layer_included(name):
    """Returns (layer of a quoted include, whether it is a public header)."""
    folder, _, file = name.rpartition("/")
    if folder == "octopair":
        return LAYER_OF_HEADER.get(file.removesuffix(".hpp")), True
    return layer_of(folder) or layer_of("bench/" + folder), False


def complaint_quoted(layer, is_public_header, name):
    """Returns the violation if a file of `layer` includes the project's `name`, or None."""
    used, from_public = layer_included(name)
    if used is None:
        return "no layer has this header; write includes from src/, bench/ or include/"
    if is_public_header and not from_public:
        return "a public header uses only public headers and the standard library"
    if used == layer or used in USES[layer] or (from_public and used in PUBLIC.get(layer, ())):
        return None
    return f"{layer} may not use {used}"


def complaint_angled(layer, is_public_header, path, name):
    """Returns the violation for an include in angle brackets, or None."""
    if is_public_header and name in IN_PUBLIC.get(path.name, ()):
        return None
    library, _, rest = name.partition("/")
    standard = not rest and "." not in name
    system = name.endswith(".h") and (not rest or library in SYSTEM) and library not in THIRD_PARTY
    if standard or (system and not is_public_header):
        return None
    if is_public_header:
        return "a public header uses only public headers and the standard library"
    allowed = THIRD_PARTY.get(library, ())
    return None if {layer, layer.partition("/")[0]} & set(allowed) else f"{layer} may not use <{library}>"


def complaint_of_adapter(host, quoted, name):
    """Returns the violation if a header of an adapter includes `name`, or None."""
    folder, _, file = name.rpartition("/")
    public = folder == "octopair" and file.removesuffix(".hpp") in LAYER_OF_HEADER
    if quoted:
        return None if public or folder == f"octopair/{host}" else "an adapter uses only octopair's public headers"
    standard = "/" not in name and "." not in name
    return None if standard or name.partition("/")[0] in ADAPTERS[host] else f"the adapter of {host} may not use <{name}>"


def check_adapters(root):
    """Returns violations of the adapters as text, and their number of files."""
    complaints, count = [], 0
    for host in ADAPTERS:
        for path in sorted((root / "adapters" / host / "include").rglob("*.hpp")):
            count += 1
            for line, quoted, name in includes_of(path):
                if wrong := complaint_of_adapter(host, quoted, name):
                    complaints.append(f"{path.relative_to(root)}:{line}: {name}: {wrong}")
    return complaints, count


def check_bindings(root):
    """Returns violations of the Python package and the interface for C as text, and their number of files."""
    complaints, count = [], 0
    for path in sorted([*(root / "python" / "src").glob("*.[ch]pp"), *(root / "c" / "src").glob("*.[ch]pp")]):
        count += 1
        for line, quoted, name in includes_of(path):
            folder, _, file = name.rpartition("/")
            if quoted:
                right = (folder == "octopair" and file.removesuffix(".hpp") in LAYER_OF_HEADER) or name == "octopair.h" or (path.parent / name).is_file()
            else:
                right = (name.endswith(".h") and not folder) or "." not in name or name.partition("/")[0] in PYTHON
            if not right:
                complaints.append(f"{path.relative_to(root)}:{line}: {name}: a binding uses only public headers, and those of its language")
    return complaints, count


def files_of(root):
    """Yields (path, layer or None, whether it is a public header) for each checked file."""
    for path in sorted((root / "include").rglob("*.hpp")):
        yield path, LAYER_OF_HEADER.get(path.stem), True
    for path in sorted((root / "src").rglob("*.[ch]pp")):
        yield path, layer_of(path.parent.relative_to(root / "src").as_posix()), False
    for layer in LAYERS:
        if layer.startswith("bench/"):
            for path in sorted((root / layer).rglob("*.[ch]pp")):
                yield path, layer, False


def check(root):
    """Returns violations as text, the layers and libraries used by each layer, and the number of files."""
    complaints, used, count = [], {}, 0
    for path, layer, is_public_header in files_of(root):
        where = path.relative_to(root)
        count += 1
        if layer is None:
            complaints.append(f"{where}: it has no layer in the stack")
            continue
        names = used.setdefault(layer, set())
        for line, quoted, name in includes_of(path):
            wrong = (complaint_quoted(layer, is_public_header, name) if quoted
                     else complaint_angled(layer, is_public_header, path, name))
            if wrong:
                complaints.append(f"{where}:{line}: {name}: {wrong}")
            library = name.partition("/")[0]
            if quoted and (other := layer_included(name)[0]) not in (None, layer):
                names.add(other)
            elif not quoted and library in THIRD_PARTY:
                names.add(f"<{library}>")
    return complaints, used, count


def stack_of(used):
    """Returns the stack as text, from top to bottom."""
    order = list(LAYERS)
    lines = []
    for layer in reversed([layer for layer in order if layer in used]):
        names = sorted(used[layer], key=lambda n: (n[0] == "<", order.index(n) if n in order else 0, n))
        lines.append(f"    {layer:<19} {LAYERS[layer][0]:<42} uses {' '.join(names) or '-'}\n")
    return "".join(lines)


def main():
    arguments = [a for a in sys.argv[1:] if a != "--print"]
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    complaints, used, count = check(root)
    for found, files in (check_adapters(root), check_bindings(root)):
        complaints += found
        count += files
    printing = "--print" in sys.argv
    if not printing and stack_of(used) not in (root / DESIGN).read_text(encoding="utf-8"):
        complaints.append(f"{DESIGN}: its stack of layers differs from that of the files; copy what include_stack.py --print prints")
    for complaint in complaints:
        print(complaint)
    if printing:
        print(stack_of(used), end="")
    elif not complaints:
        print(f"{count} files, every include runs down the stack")
    return 1 if complaints or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
