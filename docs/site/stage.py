#!/usr/bin/python3
"""Collects the sources of the site: the pages of the repository, at their paths, and generated pages.

    stage.py ROOT XML TARGET     XML: the folder that Doxygen wrote

Copied pages   README.md, docs/*.md and the others of PAGES. They stay as they are, but for two things. Links to files that are not
               pages lead to pages that show the file. An element <picture> with a light and a dark picture becomes two images, of which
               the theme shows one.
Generated      api/ (api_pages.py), man/ (man_pages.py), files/ (repository files that a page links)
Errors         A link or a picture whose file does not exist is an error with the page and its line.
"""
import pathlib
import posixpath
import re
import shutil
import sys

import api_pages
import man_pages

PAGES = ["*.md", "docs/*.md", "docs/adapters/*.md", "docs/results/*.md", "docs/tutorials/*.md", "packaging/proxy/README.md"]
PICTURES = ["docs/images/*.svg", "docs/images/*.png", "docs/images/*.webp"]
LINK = re.compile(r"(\]\()([^)\s]+)(\))")
# On GitHub, the picture follows the system. On the site, it also follows the switch of the theme.
SOURCE = re.compile(r'<source media="\(prefers-color-scheme: dark\)" srcset="([^"]+)">')
IMAGE = re.compile(r'<img src="([^"]+)"(?: width="\d+")? alt="([^"]*)">')
FENCE = re.compile(r"^ *(```|~~~)")
LEXERS = {".hpp": "cpp", ".h": "c", ".cpp": "cpp", ".py": "python", ".json": "json", ".sh": "bash", ".proto": "proto",
          ".toml": "toml", ".c": "c", ".conf": "nginx"}
LONGEST_SHOWN = 50_000  # bytes; of a longer file, a page shows the beginning


class Site:
    def __init__(self, root, xml, target):
        self.root, self.xml, self.target = root, xml, target
        self.pages = {str(path.relative_to(root)) for pattern in PAGES for path in root.glob(pattern)}
        self.shown = set()  # repository files and folders that need a page
        self.errors = []
        self.dark = ""  # dark variant of the <picture> that is read

    def write(self, name, text):
        path = self.target / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def link(self, page, place, destination):
        """Returns the destination of a link of a page in the site."""
        path, hash_sign, anchor = destination.partition("#")
        if "://" in path or not path:
            return destination
        folder = posixpath.dirname(page)
        name = posixpath.normpath(posixpath.join(folder, path))
        if not (self.root / name).exists() or name.startswith(".."):
            self.errors.append(f"{page}:{place}: no file {name}")
            return destination
        if name in self.pages or (self.target / name).is_file():
            return destination
        if name.startswith("docs/") and name.endswith(".1"):
            shown = f"man/{posixpath.basename(name)}.md"
        else:
            self.shown.add(name)
            shown = f"files/{name}.md"
        return posixpath.relpath(shown, folder or ".") + hash_sign + anchor

    def picture_line(self, page, place, line):
        """Returns the text for a line of an element <picture>."""
        dark, light = SOURCE.search(line), IMAGE.search(line)
        if dark:
            self.dark = self.link(page, place, dark[1])
        elif light:
            alt = light[2]
            return "\n".join(f"```{{image}} {path}\n:class: only-{theme}\n:alt: {alt}\n```\n"
                             for theme, path in (("light", self.link(page, place, light[1])), ("dark", self.dark)))
        elif line not in ("<picture>", "</picture>"):
            self.errors.append(f"{page}:{place}: not a line of a <picture> that stage.py knows")
        return ""

    def add_page(self, name, text):
        lines, inside, in_picture = [], False, False
        for place, line in enumerate(text.split("\n"), 1):
            if FENCE.match(line):
                inside = not inside
            in_picture = in_picture or (not inside and line == "<picture>")
            if in_picture:
                in_picture = line != "</picture>"
                line = self.picture_line(name, place, line)
            elif not inside:
                line = LINK.sub(lambda found: found[1] + self.link(name, place, found[2]) + found[3], line)
            lines.append(line)
        self.write(name, "\n".join(lines))

    def show_file(self, name):
        try:
            text = (self.root / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            size = (self.root / name).stat().st_size
            self.write(f"files/{name}.md", f"---\norphan: true\n---\n# {name}\n\nThis file is no text. It has {size:,} bytes.\n")
            return
        note = ""
        if len(text) > LONGEST_SHOWN:
            text = text[:text.rindex("\n", 0, LONGEST_SHOWN)]
            note = "The file is long. This page shows its beginning.\n\n"
        path = pathlib.PurePath(name)
        lexer = LEXERS.get(path.suffix, "cmake" if path.name == "CMakeLists.txt" else "text")
        self.write(f"files/{name}.md", f"---\norphan: true\n---\n# {name}\n\n{note}~~~~~~{lexer}\n{text}\n~~~~~~\n")

    def show_folder(self, name):
        members = sorted(path.name for path in (self.root / name).iterdir() if path.name != "__pycache__")
        rows = []
        for member in members:
            self.show(f"{name}/{member}")
            page = f"{name}/{member}" if f"{name}/{member}" in self.pages else f"files/{name}/{member}"
            rows.append(f"- [{member}]({posixpath.relpath(page.removesuffix('.md') + '.md', posixpath.dirname('files/' + name))})\n")
        self.write(f"files/{name}.md", f"---\norphan: true\n---\n# {name}\n\n{''.join(rows)}")

    def show(self, name):
        if name in self.pages:
            return
        if (self.root / name).is_dir():
            self.show_folder(name)
        else:
            self.show_file(name)

    def build(self):
        if self.target.exists():
            shutil.rmtree(self.target)
        for pattern in PICTURES:
            for path in self.root.glob(pattern):
                copy = self.target / path.relative_to(self.root)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, copy)
        generated = [*api_pages.pages(self.root, self.xml), *man_pages.pages(self.root)]
        for name in sorted(self.pages):
            self.add_page(name, (self.root / name).read_text(encoding="utf-8"))
        for name, text in generated:
            self.add_page(name, text)
        for name in sorted(self.shown):
            self.show(name)
        shutil.copyfile(self.root / "docs/site/index.md", self.target / "index.md")


def main():
    site = Site(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:4]))
    site.build()
    for error in site.errors:
        print(error, file=sys.stderr)
    return 1 if site.errors else 0


if __name__ == "__main__":
    sys.exit(main())
