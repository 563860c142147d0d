#!/usr/bin/env python3
"""Checks the built site: each link and each picture leads to a file and an anchor of the site, and nothing is loaded from other sites.

    links.py FOLDER
"""
import functools
import pathlib
import re
import sys
import urllib.parse

import bs4

LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src", "object": "data", "video": "src", "audio": "src"}
ADDRESS = re.compile(r"^(?:https?:)?//")
# An address of another site, or a path of the file system.
IN_CSS = re.compile(r"""(?:url\(\s*|@import\s+)["']?((?:https?:/|file:/)?/[^"')]+)""")


@functools.lru_cache(maxsize=None)
def soup(path):
    return bs4.BeautifulSoup(path.read_text(encoding="utf-8"), "lxml")


@functools.lru_cache(maxsize=None)
def anchors(path):
    return {element.get("id") or element.get("name") for element in soup(path).find_all(lambda tag: tag.get("id") or tag.get("name"))}


def wrong_link(page, target, folder):
    """Returns what is wrong with a link to a place in the site; empty: nothing."""
    address, _, anchor = target.partition("#")
    address = address.partition("?")[0]
    path = (page.parent / urllib.parse.unquote(address)).resolve() if address else page
    if not path.is_relative_to(folder) or not path.is_file():
        return "no such file"
    if anchor and path.suffix == ".html" and urllib.parse.unquote(anchor) not in anchors(path):
        return "no such anchor"
    return ""


def loaded_by(element):
    """Yields the addresses that a browser loads for an element."""
    yield element.get(LOADED.get(element.name, ""), "")
    # Candidates are divided by commas. After an address, a candidate may have a width or a density.
    for candidate in element.get("srcset", "").split(","):
        yield candidate.strip().partition(" ")[0]


def complaints_of(page, folder):
    for element in soup(page).find_all(True):
        for loaded in loaded_by(element):
            if ADDRESS.match(loaded):
                yield f"{element.name} loads {loaded}"
            elif loaded and not loaded.startswith("data:"):
                yield from (f"{loaded}: {wrong}" for wrong in [wrong_link(page, loaded, folder)] if wrong)
        if element.name == "style" or element.get("style"):
            yield from (f"a style loads {found}" for found in IN_CSS.findall(element.get("style") or element.string or ""))
        href = element.get("href", "") if element.name == "a" else ""
        if href and not urllib.parse.urlsplit(href).scheme:
            yield from (f"{href}: {wrong}" for wrong in [wrong_link(page, href, folder)] if wrong)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    pages = sorted(folder.rglob("*.html"))
    wrong = 0
    for page in pages:
        for complaint in complaints_of(page, folder):
            wrong += 1
            print(f"{page.relative_to(folder)}: {complaint}")
    for sheet in folder.rglob("*.css"):
        for found in IN_CSS.findall(sheet.read_text(encoding="utf-8")):
            wrong += 1
            print(f"{sheet.relative_to(folder)}: loads {found}")
    if not wrong:
        print(f"{len(pages)} pages: all links lead to a place in the site")
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
