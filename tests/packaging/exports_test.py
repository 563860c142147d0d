#!/usr/bin/env python3
"""Checks which symbols the shared libraries export.

    exports_test.py HEADERS VERSION SOVERSION LIBRARY...     HEADERS: the folder of the public headers

- Every library has a SONAME with the number SOVERSION.
- Every exported symbol belongs to octopair, and has the version of the interface. Only the core also exports symbols under the
  private version of the release.
- Nothing under the private version is declared in a public header: programs need public symbols alone.
- liboctopair_c exports the functions of octopair.h alone.
"""
import pathlib
import re
import subprocess
import sys

INTERFACE_OF_C = "liboctopair_c.so"


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def exported(library):
    """Yields (demangled name, version) of the symbols that a library exports."""
    for line in output("nm", "-DC", "--defined-only", library).splitlines():
        kind, symbol = line.split(" ", 2)[1:]
        if kind != "A":  # the versions themselves
            name, _, version = symbol.partition("@@")
            yield name, version


def public_names(headers):
    """Returns the names of classes and functions that the public headers declare in the namespace octopair itself."""
    text = "\n".join(path.read_text() for path in headers.glob("*.hpp"))
    text = re.sub(r"namespace detail \{.*?\n\}  // namespace detail", "", text, flags=re.S)
    text = re.sub(r"//.*", "", text)
    classes = re.findall(r"^(?:class|struct) (\w+)", text, re.M)
    functions = re.findall(r"^(?!using|namespace)\w[\w:<>,&\* ]*?\b(\w+)\(", text, re.M)
    return set(classes) | set(functions)


def faults_of(library, version, soversion, public):
    name = pathlib.Path(library).name
    interface, private = "OCTOPAIR_" + soversion, "OCTOPAIR_PRIVATE_" + version
    if name == INTERFACE_OF_C:
        interface = "OCTOPAIR_C_" + soversion
    soname = re.search(r"SONAME\s+(\S+)", output("objdump", "-p", library))
    if not soname or soname[1] != f"{name}.{soversion}":
        yield f"the SONAME is {soname and soname[1]}"
    symbols = list(exported(library))
    if not symbols:
        yield "exports nothing"
    for symbol, its_version in symbols:
        own = re.match(r"(?:typeinfo for |typeinfo name for |vtable for )?octopair(?:::|_)(\w+)", symbol)
        if not own:
            yield f"exports a symbol that is not octopair's: {symbol}"
        elif its_version == private and name == "liboctopair.so":
            if own[1] in public and "octopair::detail::" not in symbol:
                yield f"public, but under the private version (src/octopair.map): {symbol}"
        elif its_version != interface:
            yield f"version {its_version or 'missing'}: {symbol}"


def main():
    headers, version, soversion, *libraries = sys.argv[1:]
    public = public_names(pathlib.Path(headers))
    assert {"Scene", "Engine", "find_pairs", "make_pose"} <= public, public
    bad = [f"{library}: {fault}" for library in libraries for fault in faults_of(library, version, soversion, public)]
    print("\n".join(bad) or f"{len(libraries)} libraries export what they should")
    sys.exit(bool(bad))


main()
