#!/usr/bin/env python3
"""Reads octopair.h as cffi does, and calls the library through what it made of the header.

    header_test.py HEADER LIBRARY
"""
import re
import subprocess
import sys

import cffi

header, library_path = sys.argv[1:]
# cffi wants the declarations alone: after the preprocessor, without what the system's headers bring and without attributes.
text = subprocess.run(["cc", "-E", "-D__attribute__(x)=", header], capture_output=True, text=True, check=True).stdout
kept, own = [], False
for line in text.splitlines():
    if line.startswith("#"):
        own = header in line
    elif own:
        kept.append(line)
ffi = cffi.FFI()
ffi.cdef("\n".join(kept))
library = ffi.dlopen(library_path)

functions = set(re.findall(r"\b(octopair_\w+)\(", " ".join(kept)))
missing = [name for name in sorted(functions) if not hasattr(library, name)]
assert not missing and len(functions) > 35, missing

boxes = ffi.new("float[18]", [0, 0, 0, 1, 1, 1, 5, 5, 5, 6, 6, 6, 1, 0, 0, 2, 1, 1])
objects = ffi.new("octopair_objects *", {"size": ffi.sizeof("octopair_objects"), "boxes": boxes, "count": 3})
engine = ffi.new("octopair_engine **")
assert library.octopair_engine_create(b"local", ffi.NULL, engine) == library.OCTOPAIR_OK
found = []


@ffi.callback("octopair_sink")
def sink(_, pairs, count):
    found.extend((pairs[i].a, pairs[i].b) for i in range(count))
    return 0


assert library.octopair_stream_pairs(engine[0], objects, ffi.NULL, ffi.NULL, sink, ffi.NULL, ffi.NULL) == 0
library.octopair_engine_destroy(engine[0])
assert found == [(0, 2)], found
print(f"{len(functions)} functions")
