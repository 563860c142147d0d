"""Makes a page for each component of the library, from its public headers.

A section for a header has the comment at the head of the header, and a directive of Breathe for each declaration, in the order of
the header. Doxygen's XML names the declarations.
"""
import re
import xml.etree.ElementTree as ElementTree

COMPONENTS = [
    ("core", "octopair: boxes to pairs", "CMake target `octopair::octopair`. Engines find the pairs of boxes; a `Scene` keeps "
     "objects from step to step.",
     ["octopair", "engine", "objects", "spheres", "input", "options", "pair_list", "summary", "box_array", "job", "scene", "queries", "pose",
      "octal_code", "octants", "limits", "error"]),
    ("pipeline", "pipeline: filters and exact tests", "CMake target `octopair::pipeline`. Filters run behind any engine. Exact "
     "tests of shapes return contacts and depth.",
     ["pipeline", "filters", "shapes", "collision"]),
    ("processes", "processes: worker processes", "CMake target `octopair::processes`. When to use this engine: "
     "[engines](../docs/engines.md).", ["processes"]),
    ("mpi", "mpi: ranks of a cluster", "CMake target `octopair::mpi`. When to use this engine: "
     "[engines](../docs/engines.md#ranks).", ["mpi"]),
    ("client", "client: a server finds the pairs", "CMake target `octopair::client`. How to run a server: "
     "[server](../docs/server.md).", ["client", "job_client", "remote_scene", "scene_watcher"]),
    ("viewer", "viewer: a scene in a browser", "CMake target `octopair::viewer`. A program shows its "
     "running scene.", ["view"]),
    ("adapters", "adapters: FCL, CGAL, Bullet", "CMake targets `octopair::fcl`, `octopair::cgal` and `octopair::bullet`. The "
     "guides say what changes: [FCL](../docs/adapters/fcl.md), [CGAL](../docs/adapters/cgal.md), "
     "[Bullet](../docs/adapters/bullet.md).",
     ["fcl/broad_phase_manager", "cgal/box_intersection_d", "bullet/broadphase"]),
]
# Headers without a page: parts of adapters that users do not call, and the attribute of exported symbols.
INTERNAL = {"fcl/near_pairs", "fcl/object_boxes", "fcl/object_set", "cgal/boxes", "bullet/proxies"}
# A word in front of a paragraph, in a column of its own: 10 characters wide in C++, 12 in C.
WORD = re.compile(r"^([A-Z][A-Za-z]+) +(?:(?<=^.{10})|(?<=^.{12}))(\S.*)$")
# In C, a comment that an empty line follows describes the declarations below it.
GROUP = re.compile(r"^/\* ((?:(?!\*/).)*?) ?\*/\n(?=\n)", re.DOTALL | re.MULTILINE)
LONGEST_TITLE = 60


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
        if word:
            made += ["", word[1], ":   " + word[2]]
            defined = True
        elif defined and line.startswith("      "):
            made.append("    " + line.strip())
        else:
            defined = defined and not line
            made.append(line)
    return "\n".join(made) + "\n"


def arguments(member):
    """Returns the parameters of a function without defaults, as Breathe compares them."""
    types = ["".join(parameter.find("type").itertext()) for parameter in member.findall("param") if parameter.find("type") is not None]
    const = " const" if member.get("const") == "yes" else ""
    return f"({', '.join(types)}){const}"


def declarations_of_namespaces(xml):
    """Yields (file, line, directive, name, argument) for each declaration of a namespace."""
    for path in sorted(xml.glob("namespace*.xml")):
        compound = ElementTree.parse(path).getroot().find("compounddef")
        for member in compound.iter("memberdef"):
            place = member.find("location")
            name = f"{compound.findtext('compoundname')}::{member.findtext('name')}"
            kind = member.get("kind")
            yield (place.get("declfile") or place.get("file"), int(place.get("declline") or place.get("line")), kind, name,
                   name + (arguments(member) if kind == "function" else ""))
        for inner in compound.findall("innerclass"):
            made = ElementTree.parse(xml / f"{inner.get('refid')}.xml").getroot().find("compounddef")
            place = made.find("location")
            yield place.get("file"), int(place.get("line")), made.get("kind"), inner.text, inner.text


def directives(declarations):
    """Returns the Markdown for declarations: one heading for each name."""
    made, last = [], None
    for _, _, kind, name, argument in sorted(declarations, key=lambda found: found[1]):
        short = re.sub(r"^octopair::", "", name)
        if short != last:
            made.append(f"### {short}\n\n")
        last = short
        members = ":members:\n:undoc-members:\n" if kind in ("class", "struct") else ""
        made.append(f"```{{doxygen{kind}}} {argument}\n{members}```\n\n")
    return "".join(made)


def section(root, header, name, declarations):
    head = markdown(head_lines((root / header).read_text(encoding="utf-8")))
    return f"## {name}\n\n{head}\nThe file: [{header}](../{header})\n\n{declarations}"


def c_interface(root, xml):
    """Returns the page of the header for C: its declarations and the titles between them, in the order of the header."""
    header = "c/include/octopair.h"
    text = (root / header).read_text(encoding="utf-8")
    parts = []  # line, Markdown
    for group in GROUP.finditer(text):
        title = group[1].removesuffix(".")
        shown = f"### {title}\n\n" if len(title) <= LONGEST_TITLE else f"{title}.\n\n"
        parts.append((text.count("\n", 0, group.start()), shown))
    compound = ElementTree.parse(xml / "octopair_8h.xml").getroot().find("compounddef")
    for member in compound.iter("memberdef"):
        if member.findtext("name") != "OCTOPAIR_API":
            place = int(member.find("location").get("line"))
            parts.append((place, f"```{{doxygen{member.get('kind')}}} {member.findtext('name')}\n```\n\n"))
    for inner in compound.findall("innerclass"):
        made = ElementTree.parse(xml / f"{inner.get('refid')}.xml").getroot().find("compounddef")
        place = int(made.find("location").get("line"))
        parts.append((place, f"```{{doxygenstruct}} {inner.text}\n:members:\n:undoc-members:\n```\n\n"))
    declarations = "".join(shown for _, shown in sorted(parts))
    return "# The interface for C\n\n" + section(root, header, "octopair.h", declarations)


def pages(root, xml):
    """Yields (name, text) of each page. `xml` is the folder that Doxygen wrote."""
    headers = {}
    for path in [*root.glob("include/octopair/*.hpp"), *root.glob("adapters/*/include/octopair/*/*.hpp")]:
        name = str(path.relative_to(root))
        headers[name.rpartition("include/octopair/")[2].removesuffix(".hpp")] = name
    listed = {name for component in COMPONENTS for name in component[3]}
    if listed != set(headers) - INTERNAL:
        raise SystemExit(f"api_pages.py: headers without a page, or pages without a header: {(set(headers) - INTERNAL) ^ listed}")
    declared = list(declarations_of_namespaces(xml))
    for component, title, text, names in COMPONENTS:
        sections = [section(root, headers[name], f"octopair/{name}.hpp",
                            directives([one for one in declared if one[0] == headers[name]])) for name in names]
        yield f"api/{component}.md", f"# {title}\n\n{text}\n\n" + "".join(sections)
    yield "api/c.md", c_interface(root, xml)
