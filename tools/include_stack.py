#!/usr/bin/env python3
"""Checks that includes run one way: each folder of src/ uses only those below it in the stack, and so do the folders of
bench/ that the program is built with.

    include_stack.py [--print] [ROOT]     ROOT: the project's directory, default the one this file lies in

The stack, from the bottom up, and where third-party headers may be used, stand in the two tables below. Public headers
(include/octopair) may be used by all and use only each other and the standard library. Prints what breaks the rule, one
line each, and exits 1; with --print it prints the stack as it is, for docs/design.md.
"""
import pathlib
import re
import sys

# What each folder may use, beside itself and the public headers. Part of an engine: its own folder and engine/ alone.
CORE = ["base", "parallel", "geometry", "octree", "pipeline", "verification", "engine", "scene", "service"]
USES = {folder: set(CORE[:i]) for i, folder in enumerate(CORE)}
USES["verification"] = {"base", "parallel"}  # a check that shares code with what it checks would share its errors
USES["samples"] = {"base", "geometry"}
USES["io"] = {"base", "geometry"}
BENCH = ["baselines", "machine", "paper", "cluster", "scaling"]
USES["baselines"] = {"base", "octree"}
USES["machine"] = set()
USES["paper"] = {"base", "baselines", "machine", "samples"}
USES["cluster"] = {"base", "engine", "machine", "paper", "samples"}
USES["scaling"] = {"machine", "samples", "cluster"}
USES["cli"] = set(CORE) | {"samples", "io", "paper", "cluster", "scaling"}

PURPOSE = {
    "base": "errors, buffers, checked casts", "parallel": "the one place that knows oneTBB",
    "geometry": "boxes, shapes, and how they are judged", "octree": "octal codes, encode, sort, merge, scan",
    "pipeline": "filters and their composition", "verification": "a second algorithm that checks results",
    "engine": "where and how pairs are found",
    "scene": "objects that persist and move", "service": "jobs over a socket", "samples": "seeded scenes",
    "io": "scene and result files", "baselines": "the known algorithms", "machine": "what measured",
    "paper": "the paper's section 5 again", "cluster": "what ranks cost", "scaling": "time by threads and ranks",
    "cli": "the program",
}

# First part of a third-party include: the folders that may use it.
THIRD_PARTY = {
    "tbb": {"parallel", "baselines"}, "oneapi": {"parallel"}, "hwy": {"geometry", "octree", "engine", "scene"}, "assimp": {"io"},
    "grpc": {"service"}, "grpcpp": {"service"}, "google": {"service"}, "openssl": {"service"}, "xxhash.h": {"service"},
    "prometheus": {"service"}, "spdlog": {"service", "cli"},
    "ccd": {"geometry"}, "Eigen": {"geometry"}, "boost": {"geometry"},
    "CLI": {"cli"}, "fmt": {"io", "paper", "cluster", "scaling", "cli"},
    "nlohmann": {"io", "machine", "paper", "cluster", "scaling", "service", "cli"},
}
# What a public header of a component cannot do without: its users have it.
IN_PUBLIC = {"mpi.hpp": {"mpi.h"}}
SYSTEM = {"sys", "linux", "netinet", "arpa", "sanitizer"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)


def includes_of(path):
    """(line number, is quoted, name) of each include of a file."""
    text = path.read_text(encoding="utf-8")
    return [(text.count("\n", 0, m.start(2)) + 1, m[1] == '"', m[2]) for m in INCLUDE.finditer(text)]


def complaint_quoted(folder, part, name):
    """What is wrong with a file of `folder` (and engine part) including the project's `name`, or None."""
    target, _, rest = name.partition("/")
    if not rest:
        return "includes are written from src/, bench/ or include/"
    if target == "octopair":
        return None
    if folder == "public":
        return "a public header uses only public headers and the standard library"
    if target == folder:
        other = rest.split("/")[0] if "/" in rest else ""
        if folder == "engine" and other and other != part:
            return f"engine/{part or ''} may not use engine/{other}"
        return None
    return None if target in USES.get(folder, ()) else f"{folder} may not use {target}"


def complaint_angled(folder, path, name):
    """The same for an include in angle brackets."""
    if folder == "public" and name in IN_PUBLIC.get(path.name, ()):
        return None
    library, _, rest = name.partition("/")
    standard = not rest and "." not in name
    system = name.endswith(".h") and (not rest or library in SYSTEM)
    if standard or (system and folder != "public"):
        return None
    if folder == "public":
        return "a public header uses only public headers and the standard library"
    return None if folder in THIRD_PARTY.get(library, ()) else f"{folder} may not use <{library}>"


def check(root):
    """Complaints as text, and for each folder the folders and libraries it uses."""
    complaints, used = [], {}
    files = [(p, "public", "") for p in sorted((root / "include").rglob("*.hpp"))]
    for top in [root / "src", *(root / "bench" / folder for folder in BENCH)]:
        for path in sorted(top.rglob("*.[ch]pp")):
            parts = path.relative_to(root).parts[1:]
            files.append((path, parts[0], parts[1] if len(parts) > 2 else ""))
    for path, folder, part in files:
        where = path.relative_to(root)
        if folder != "public" and folder not in USES:
            complaints.append(f"{where}: folder {folder} has no place in the stack")
            continue
        for line, quoted, name in includes_of(path):
            wrong = complaint_quoted(folder, part, name) if quoted else complaint_angled(folder, path, name)
            if wrong:
                complaints.append(f"{where}:{line}: {name}: {wrong}")
            target = name.split("/")[0]
            if quoted and target != folder or target in THIRD_PARTY:
                used.setdefault(folder, set()).add(target if quoted else f"<{target}>")
        used.setdefault(folder, set())
    return complaints, used, len(files)


def print_stack(used):
    order = [f for f in ["base", "parallel", "geometry", "samples", "io", "octree", "pipeline", "verification", "engine",
                         "scene", "service", *BENCH, "cli"] if f in used]
    for folder in reversed(order):
        names = sorted(used[folder] - {"octopair"}, key=lambda n: (n[0] == "<", order.index(n) if n in order else 0, n))
        print(f"    {folder:<12} {PURPOSE[folder]:<40} uses {' '.join(names) or '-'}")
    print(f"    {'octopair':<12} {'the public headers':<40} uses std alone")


def main():
    arguments = [a for a in sys.argv[1:] if a != "--print"]
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    complaints, used, count = check(root)
    for complaint in complaints:
        print(complaint)
    if "--print" in sys.argv:
        print_stack(used)
    elif not complaints:
        print(f"{count} files, every include runs down the stack")
    return 1 if complaints or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
