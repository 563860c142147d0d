"""Mends what the package furo of Debian 12 lacks, after the pages are written. Other packages of Furo stay as they are.

Script   Its script imports another script. Browsers refuse this in scripts that are no modules, and modules in files.
Style    Its style sheet has no dark colours and shows no dark pictures for readers whose system is dark. It also imports a style sheet by
         a path of Debian's file system, which is nowhere on a server or in a folder of pages.
"""
import pathlib
import re

IMPORT = re.compile(r'^import Gumshoe from "\./gumshoe-patched\.js";\n', re.MULTILINE)
EXPORT = re.compile(r"^export default Gumshoe;\n?", re.MULTILINE)
STYLE_IMPORT = re.compile(r"@import url\((/javascript/[^)]+)\);")
DARK = re.compile(r'body\[data-theme="dark"\] \{([^}]*)\}')


def mend_script(folder):
    path = folder / "scripts/furo.js"
    text = path.read_text(encoding="utf-8")
    if IMPORT.search(text):
        imported = EXPORT.sub("", (folder / "scripts/gumshoe-patched.js").read_text(encoding="utf-8"))
        path.write_text(imported + IMPORT.sub("", text), encoding="utf-8")


def mend_style(folder):
    path = folder / "styles/furo.css"
    text = path.read_text(encoding="utf-8")
    text = STYLE_IMPORT.sub(lambda found: pathlib.Path("/usr/share" + found[1]).read_text(encoding="utf-8"), text)
    dark = DARK.search(text)
    if dark and "prefers-color-scheme" not in text:
        # Before the rules that follow, so that they still have the last word.
        page = 'body:not([data-theme="light"])'
        rule = (f"@media screen and (prefers-color-scheme: dark) {{\n  {page} {{{dark[1]}}}\n"
                f"  html {page} .only-light {{ display: none !important; }}\n"
                f"  html {page} .only-dark {{ display: block !important; }} }}\n\n")
        at = text.index("@media not print")
        text = text[:at] + rule + text[at:]
    path.write_text(text, encoding="utf-8")


def mend(app, exception):
    if exception is None:
        folder = pathlib.Path(app.outdir) / "_static"
        mend_script(folder)
        mend_style(folder)


def setup(app):
    app.connect("build-finished", mend)
    return {"parallel_read_safe": True}
