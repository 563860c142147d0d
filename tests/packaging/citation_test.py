#!/usr/bin/env python3
"""Checks CITATION.cff against version 1.2.0 of the Citation File Format: citation_test.py FILE VERSION

VERSION: the version of the project, which the file must have. Checks the fields that the file uses, and the title, authors and licence
of the software against the files LICENSE and pyproject.toml beside it.
"""
import pathlib
import re
import sys

import yaml

# Fields of the format, with their types.
SOFTWARE = {"cff-version": str, "message": str, "type": str, "title": str, "abstract": str, "version": str, "license": str,
            "authors": list, "keywords": list, "references": list}
REFERENCE = {"type": str, "title": str, "authors": list, "journal": str, "publisher": dict, "volume": int, "issue": int, "month": int,
             "year": int, "start": int, "end": int}
PERSON = {"family-names": str, "given-names": str, "name-suffix": str, "affiliation": str}
ENTITY = {"name": str}


def check_fields(what, value, known, required):
    """Checks that a mapping has known fields of the right types, and all required ones."""
    assert isinstance(value, dict), f"{what} is no mapping"
    assert set(value) <= set(known), f"{what}: unknown fields {set(value) - set(known)}"
    assert set(required) <= set(value), f"{what}: no field {set(required) - set(value)}"
    for name, item in value.items():
        assert isinstance(item, known[name]) and item, f"{what}: {name} is no {known[name].__name__}, or empty"


def check_authors(what, authors):
    for number, author in enumerate(authors):
        known = ENTITY if isinstance(author, dict) and "name" in author else PERSON
        check_fields(f"{what}, author {number}", author, known, ["name"] if known is ENTITY else ["family-names", "given-names"])


def check(path, version):
    citation = yaml.safe_load(path.read_text(encoding="utf-8"))
    check_fields("the file", citation, SOFTWARE, ["cff-version", "message", "title", "authors", "version", "license", "references"])
    assert citation["cff-version"] == "1.2.0" and citation.get("type", "software") == "software"
    assert citation["version"] == version, f"version {citation['version']}, but the project has {version}"
    check_authors("the file", citation["authors"])
    holder = re.search(r"Copyright \(c\) \d+, (.*)", path.with_name("LICENSE").read_text(encoding="utf-8"))[1]
    assert [author.get("name") for author in citation["authors"]] == [holder], f"LICENSE names {holder}"
    project = path.with_name("pyproject.toml").read_text(encoding="utf-8")
    assert f'name = "{citation["title"]}"' in project, "pyproject.toml has another name"
    assert citation["license"] == "BSD-3-Clause" and "BSD 3-Clause" in path.with_name("LICENSE").read_text(encoding="utf-8")
    for number, reference in enumerate(citation["references"]):
        what = f"reference {number}"
        check_fields(what, reference, REFERENCE, ["type", "title", "authors"])
        check_authors(what, reference["authors"])
        assert 1 <= reference.get("month", 1) <= 12 and reference.get("start", 0) <= reference.get("end", 0)
    paper = citation["references"][0]
    names = [author["family-names"] for author in paper["authors"]]
    readme = path.with_name("README.md").read_text(encoding="utf-8")
    assert paper["title"] in readme and all(name in readme for name in names) and f"({paper['year']})" in readme, \
        "README.md names another paper"


if __name__ == "__main__":
    check(pathlib.Path(sys.argv[1]), sys.argv[2])
    print("CITATION.cff is valid")
