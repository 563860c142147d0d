"""Makes a page for each component of the library, from its public headers.

A section for a header has the comment at the head of the header. Breathe adds the declarations (conf.py).
"""
import re

COMPONENTS = [
    ("core", "octopair: boxes to pairs", "CMake target `octopair::octopair`. Engines find the pairs of boxes; a `Scene` keeps "
     "objects from step to step.",
     ["octopair", "engine", "objects", "input", "options", "pair_list", "summary", "box_array", "job", "scene", "queries", "pose",
      "octal_code", "arrangement", "error"]),
    ("pipeline", "pipeline: filters and exact tests", "CMake target `octopair::pipeline`. Filters run behind any engine. Exact "
     "tests of shapes return contacts and depth.",
     ["pipeline", "filters", "shapes", "collision"]),
    ("processes", "processes: worker processes", "CMake target `octopair::processes`. When to use this engine: "
     "[engines](../docs/engines.md).", ["processes"]),
    ("mpi", "mpi: ranks of a cluster", "CMake target `octopair::mpi`. When to use this engine: "
     "[engines](../docs/engines.md#ranks).", ["mpi"]),
    ("client", "client: a server finds the pairs", "CMake target `octopair::client`. How to run a server: "
     "[server](../docs/server.md).", ["client", "job_client", "remote_scene"]),
    ("adapters", "adapters: FCL, CGAL, Bullet", "CMake targets `octopair::fcl`, `octopair::cgal` and `octopair::bullet`. The "
     "guides say what changes: [FCL](../docs/adapters/fcl.md), [CGAL](../docs/adapters/cgal.md), "
     "[Bullet](../docs/adapters/bullet.md).",
     ["fcl/broad_phase_manager", "cgal/box_intersection_d", "bullet/broadphase"]),
]
# Parts of adapters that users do not call.
INTERNAL = {"fcl/near_pairs", "fcl/object_boxes", "fcl/object_set", "cgal/boxes", "bullet/proxies"}
WORD = re.compile(r"^([A-Z][a-z]+(?: [a-z]+)?)(?:  +| (?=octopair::))(.*)$")


def head_lines(text):
    """Returns the lines of the comment at the head of a header, without comment signs."""
    lines = text.split("\n")
    if lines[0].startswith("/*"):
        end = next(i for i, line in enumerate(lines) if line.rstrip().endswith("*/"))
        return [re.sub(r"^(/\*| \*/?) ?", "", line).rstrip() for line in lines[:end]]
    end = next(i for i, line in enumerate(lines) if not line.startswith("//"))
    return [line[2:].removeprefix(" ").rstrip() for line in lines[:end]]


def markdown(lines):
    """Returns the head as Markdown: paragraphs with a fixed word in front become a list of definitions."""
    made = []
    defined = False
    for line in lines:
        word = WORD.match(line)
        if word and not line.startswith(" "):
            made += ["", word[1], ":   " + word[2].strip()]
            defined = True
        elif defined and line.startswith("      "):
            made.append("    " + line.strip())
        else:
            defined = defined and not line
            made.append(line)
    return "\n".join(made) + "\n"


def section(root, header, name):
    head = markdown(head_lines((root / header).read_text(encoding="utf-8")))
    return f"## {name}\n\n{head}\n```{{doxygenfile}} {name}\n:sections: briefdescription innerclass define typedef enum func var user-defined public* \n```\n\n"


def pages(root):
    headers = {}
    for path in [*root.glob("include/octopair/*.hpp"), *root.glob("adapters/*/include/octopair/*/*.hpp")]:
        name = str(path.relative_to(root))
        headers[name.rpartition("include/octopair/")[2].removesuffix(".hpp")] = name
    listed = {name for component in COMPONENTS for name in component[3]}
    if listed | INTERNAL != set(headers):
        raise SystemExit(f"api_pages.py: headers without a page, or pages without a header: {set(headers) ^ (listed | INTERNAL)}")
    for component, title, text, names in COMPONENTS:
        sections = [section(root, headers[name], f"octopair/{name}.hpp") for name in names]
        yield f"api/{component}.md", f"# {title}\n\n{text}\n\n" + "".join(sections)
    yield "api/c.md", "# The interface for C\n\n" + section(root, "c/include/octopair.h", "octopair.h")
