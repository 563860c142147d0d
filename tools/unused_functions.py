#!/usr/bin/env python3
"""Finds functions, constants, macros and data members that nothing uses, in C++, Python, TypeScript and JavaScript.

    unused_functions.py [ROOT]     ROOT: the project's directory; default: the parent of tools/

Universal Ctags lists the definitions and declarations. A name is used if it occurs anywhere else: in code, not in a comment or in a
text of C++. Uses by tests do not count, because a function that only its tests use is dead code. Names of the public interfaces count
as used. The check compares names, so it does not find an unused function that has the same name as one that is used.

ROOT/tools/unused_functions.txt lists exceptions, with reasons. Prints one line for each unused name and for each exception that is
none, and exits 1.
"""
import collections
import pathlib
import re
import subprocess
import sys

# Folders whose code must be used, and folders with further uses.
FOLDERS = ["adapters", "bench", "c", "docs/site", "include", "packaging", "python", "scripts", "setup.py", "src", "tools", "viewer"]
USERS = ["CMakeLists.txt", "cmake", "examples", "pyproject.toml"]
CODE = {".cpp", ".hpp", ".h", ".py", ".ts", ".mjs", ".js"}
TEXT = CODE | {".in", ".txt", ".cmake", ".proto", ".html", ".sh", ".map", ".toml", ""}
C_LIKE = {".cpp", ".hpp", ".h", ".in", ".proto"}
EXCEPTIONS = "unused_functions.txt"
SKIPPED = {"node_modules", "__pycache__", EXCEPTIONS}
# Names in these places are interfaces: other projects use them.
PUBLIC = ["include/octopair/", "c/include/", "adapters/", "python/octopair/", "packaging/conan/", "docs/site/conf.py"]

KINDS = "--kinds-C++=dfmepvx --kinds-Python=fmv --kinds-JavaScript=fmvC --kinds-TypeScript=fmvCp".split()
# What is no code: comments; raw, other and character literals of C++; documentation of Python, but not its formatted strings.
C_IGNORED = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
SCRIPT_IGNORED = re.compile(r"(?<!:)//[^\n]*|/\*.*?\*/", re.DOTALL)
PYTHON_IGNORED = re.compile(r'\b[fF][rR]?"""(?P<kept>.*?)"""|""".*?"""|(?m:(?:^|\s)#[^\n"\']*$)', re.DOTALL)
NAME = re.compile(r"\b[A-Za-z_]\w*")
OVERRIDES = re.compile(r"[^;{]*\b(?:override|final)\b")


def files(root, folders):
    for folder in folders:
        top = root / folder
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            if path.is_file() and path.suffix in TEXT and not SKIPPED & set(path.relative_to(root).parts):
                yield path


def code_of(path):
    """Returns the text of a file without comments, and for C++ without literals. Line numbers stay."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if path.suffix in C_LIKE:
        ignored = C_IGNORED
    elif path.suffix in (".ts", ".mjs", ".js", ".html"):
        ignored = SCRIPT_IGNORED
    else:
        ignored = PYTHON_IGNORED
    return ignored.sub(lambda match: match.groupdict().get("kept") or "\n" * match[0].count("\n") or " ", text)


def occurrences(texts):
    """Returns the number of times that each name occurs in each line: name -> {(path, line): times}."""
    found = collections.defaultdict(collections.Counter)
    for path, text in texts.items():
        for number, line in enumerate(text.split("\n"), 1):
            for name in NAME.findall(line):
                found[name][path, number] += 1
    return found


def definitions(paths):
    """Returns the definitions and declarations that Universal Ctags finds: name -> {(path, line): kind}."""
    listed = subprocess.run(["ctags-universal", "-x", "--_xformat=%N\t%K\t%n\t%F", "-L", "-", "-f", "-", "--langmap=C++:+.h", *KINDS],
                            input="\n".join(map(str, paths)), capture_output=True, text=True, check=True).stdout
    found = collections.defaultdict(dict)
    for line in listed.splitlines():
        name, kind, number, path = line.split("\t")
        # Ctags takes calls of macros for functions, and gives lambdas a name.
        if NAME.fullmatch(name) and not name.startswith("__") and (kind == "macro" or not name.isupper()):
            found[name][pathlib.Path(path), int(number)] = kind
    return found


def overrides(places, texts):
    """Returns whether a function implements one of another library: some declaration overrides, and none is virtual."""
    lines = [texts[path].split("\n")[number - 1:number + 4] for path, number in places]
    return (any(OVERRIDES.match("\n".join(part)) for part in lines)
            and not any(part[0].lstrip().startswith("virtual ") for part in lines))


def exceptions(root):
    """Returns the listed exceptions: name -> reason."""
    path = root / "tools" / EXCEPTIONS
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return dict(line.split(None, 1) for line in lines if line and not line.startswith("#"))


def unused_names(root):
    """Yields (path, line, kind, name) for each name that nothing uses."""
    texts = {path: code_of(path) for path in files(root, FOLDERS + USERS)}
    used = occurrences(texts)
    public = tuple(str(root / place) for place in PUBLIC)
    for name, places in definitions([path for path in files(root, FOLDERS) if path.suffix in CODE]).items():
        if not name.startswith("_") and any(str(path).startswith(public) for path, _ in places):
            continue
        own = sum(1 for place in places if used[name][place])
        if own and sum(used[name].values()) == own and not overrides(places, texts):
            (path, line), kind = next(iter(places.items()))
            yield path, line, kind, name


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    allowed = exceptions(root)
    unused = sorted(unused_names(root))
    wrong = [f"{path.relative_to(root)}:{line}: {kind} '{name}': nothing uses it but tests: remove it"
             for path, line, kind, name in unused if name not in allowed]
    wrong += [f"tools/{EXCEPTIONS}: '{name}' is used or does not exist: remove the line"
              for name in sorted(allowed.keys() - {name for _, _, _, name in unused})]
    print("\n".join(wrong) if wrong else "every function is used")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
