#!/usr/bin/env python3
"""Plants faults in a small site. links.py must report each of them."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

RIGHT = """<html><head><link rel="stylesheet" href="style.css?digest=1"><script src="code.js"></script></head><body>
<h1 id="top">A page</h1><a href="#top">top</a><a href="other.html#part">part</a><a href="https://example.org/">elsewhere</a>
<picture><source srcset="dark.webp 1x, dark.webp 2x"><img src="light.webp"></picture></body></html>"""
FAULTS = [
    ("#top\"", "#bottom\"", "#bottom: no such anchor"),
    ("other.html#part", "other.html#none", "other.html#none: no such anchor"),
    ("other.html#part", "missing.html", "missing.html: no such file"),
    ("other.html#part", "../outside.html", "../outside.html: no such file"),
    ("style.css?digest=1", "https://example.org/style.css", "link loads https://example.org/style.css"),
    ("code.js", "//example.org/code.js", "script loads //example.org/code.js"),
    ("code.js", "none.js", "none.js: no such file"),
    ("light.webp", "none.webp", "none.webp: no such file"),
    ("dark.webp 2x", "none.webp 2x", "none.webp: no such file"),
    ("dark.webp 1x", "https://example.org/dark.webp 1x", "source loads https://example.org/dark.webp"),
    ("<h1 id=\"top\">", "<h1 id=\"top\" style=\"background: url(https://example.org/a.png)\">", "a style loads https://example.org/a.png"),
]


def run(page, sheet="p { color: red }"):
    with tempfile.TemporaryDirectory() as folder:
        site = pathlib.Path(folder)
        (site / "index.html").write_text(page)
        (site / "other.html").write_text('<h2 id="part">Part</h2>')
        (site / "style.css").write_text(sheet)
        for name in ("code.js", "light.webp", "dark.webp"):
            (site / name).write_text("")
        return subprocess.run([sys.executable, str(pathlib.Path(__file__).parent / "links.py"), folder], capture_output=True, text=True)


class Faults(unittest.TestCase):
    def test_site_without_fault(self):
        done = run(RIGHT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_planted_faults(self):
        for right, wrong, message in FAULTS:
            with self.subTest(message):
                done = run(RIGHT.replace(right, wrong, 1))
                self.assertEqual(done.returncode, 1)
                self.assertIn(message, done.stdout)

    def test_style_sheet(self):
        for address in ("https://example.org/font.css", "/javascript/normalize.css", "file:///usr/share/normalize.css"):
            self.assertIn(f"style.css: loads {address}", run(RIGHT, f'@import "{address}";').stdout)
        self.assertEqual(run(RIGHT, "p { background: url(code.js) }").returncode, 0)


if __name__ == "__main__":
    unittest.main()
