#!/usr/bin/env python3
"""Plants wrong figures in the project's pages and headers. tools/figures.py must report each of them, and accept the committed files."""
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import figure_table
import figures

# File, the right text, the wrong text, and what the message must have.
FAULTS = [
    ("include/octopair/engine.hpp", "within 200 ms after", "within 300 ms after",
     "'within 300 ms after a stop request': figure 'cancellation' of tests/support/cancel_time.hpp is 200: correct this text"),
    ("docs/memory.md", "at most 44 per object", "at most 56 per object", "figure 'search on threads' of tests/engine/large_test.cpp is 44"),
    ("docs/memory.md", "at most 44 per object", "at least 44 per object", "'44 per object'"),
    ("docs/memory.md", "| pair | 8 |", "| pair | 16 |", "figure 'pair'"),
    ("docs/octree.md", "an eighth of\nthe objects", "a ninth of\nthe objects",
     "figure 'logged changes' of src/base/tuning.hpp is 0.125 or 1/8"),
    ("docs/view.md", "at most a hundredth of the time", "at most a tenth of the time", "figure 'time of copies'"),
    ("docs/view.md", "Of more than 200,000 objects", "Of more than 100,000 objects", "is 200,000"),
    ("docs/server.md", "a job runs | 600 |", "a job runs | 300 |",
     "figure 'seconds of a job' of src/service/server/server_options.hpp is 600"),
    ("docs/memory.md", "slack 24 more", "slack 25 more", "'25 more per object'"),
    ("docs/proofs.md", "2e-6 s; if l", "3e-6 s; if l", "'3e-6 s'"),
    ("README.md", "\n## ", "\nA search takes 7 ms.\n\n## ", "is no figure of tools/figure_table.py: add one"),
    ("README.md", "\n## ", "\nA search takes half the time of others.\n\n## ", "'half the'"),
    ("README.md", "\n## ", "\nIt is twice as fast.\n\n## ", "'twice as'"),
    ("README.md", "\n## ", "\n| scene | ms |\n|---|--:|\n| a | 12 |\n\n## ", "'12'"),
    ("include/octopair/scene.hpp", "// Threads ", "// Memory    It takes\n// 12 bytes.\n// Threads ", "'12 bytes'"),
    ("python/octopair/_engine.py", "Within 200 ms", "Within 2 s", "'2 s'"),
]


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.texts = figures.load(ROOT)

    def faults(self, changed, right, wrong):
        text = self.texts[changed]
        self.assertIn(right, text)
        return figures.check({changed: text.replace(right, wrong, 1)}, ROOT)[0]

    def test_committed_files(self):
        self.assertEqual(figures.check(self.texts, ROOT)[0], [])

    def test_planted_faults(self):
        for name, right, wrong, message in FAULTS:
            with self.subTest(message):
                faults = self.faults(name, right, wrong)
                self.assertIn(f"{name}:", "\n".join(faults))
                self.assertIn(message, "\n".join(faults))

    def test_the_line_is_that_of_the_number(self):
        lines = self.texts["HACKING.md"].splitlines(keepends=True)
        at = lines.index("## Document\n")
        text = "".join([*lines[:at], "A test\ntakes 3 ns.\n\n", *lines[at:]])
        self.assertTrue(figures.check({"HACKING.md": text}, ROOT)[0][0].startswith(f"HACKING.md:{at + 2}: '3 ns'"))

    def test_code_and_generated_blocks_are_left_out(self):
        text = ("```text\n7 ms\n```\n\n    a sample of 7 ms\n\n"
                "<!-- begin frames -->\n| 7 ms |\n<!-- end frames -->\n\n`7 ms` and [a link](7 ms)\n")
        self.assertEqual([fault for fault in figures.check({"docs/a.md": text}, ROOT)[0] if "docs/a.md" in fault], [])
        self.assertIn("docs/a.md:12: '7 ms'", figures.check({"docs/a.md": text + "7 ms\n"}, ROOT)[0][0])

    def test_a_constant_that_no_source_has(self):
        lost = figure_table.Constant("lost", "README.md", r"never = (\d+)", ["{} ms"])
        with mock.patch.object(figure_table, "CONSTANTS", [lost]), mock.patch.object(figure_table, "STATED", []):
            self.assertIn("README.md: figure 'lost': no text like", figures.check({}, ROOT)[0][0])

    def test_a_phrase_that_no_page_has(self):
        with mock.patch.object(figure_table, "STATED", [*figure_table.STATED, figure_table.Stated("gone", ["7 ms or so"])]):
            self.assertEqual(figures.check(self.texts, ROOT)[0],
                             ["tools/figure_table.py: no page has the phrase '7 ms or so': remove the phrase"])


class Write(unittest.TestCase):
    """A small tree with one measured value."""

    def run_in_tree(self, *words):
        table = [figure_table.Measured("step", "step.json", lambda result: f"1/{result['share']}", ["about {} of a detection"])]
        with mock.patch.object(figure_table, "figures", lambda: table), mock.patch("builtins.print") as printed:
            status = figures.main([*words, self.folder.name])
        return status, "\n".join(call.args[0] for call in printed.call_args_list)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.page = pathlib.Path(self.folder.name, "README.md")
        self.page.write_text("A step takes about\n1/19 of a detection. A step takes about 1/18 of a detection.\n", encoding="utf-8")
        pathlib.Path(self.folder.name, "step.json").write_text('{"share": 20}', encoding="utf-8")

    def test_measured_values_are_mended(self):
        status, printed = self.run_in_tree()
        self.assertEqual(status, 1)
        self.assertIn("README.md:2: 'about 1/19 of a detection': figure 'step' of step.json is 1/20: run tools/figures.py --write", printed)
        self.assertEqual(self.run_in_tree("--write")[0], 0)
        self.assertEqual(self.page.read_text(encoding="utf-8"),
                         "A step takes about\n1/20 of a detection. A step takes about 1/20 of a detection.\n")
        self.assertEqual(self.run_in_tree()[0], 0)

    def test_other_faults_stay(self):
        self.page.write_text("A step takes 7 ms, about 1/19 of a detection.\n", encoding="utf-8")
        status, printed = self.run_in_tree("--write")
        self.assertEqual(status, 1)
        self.assertIn("README.md:1: '7 ms'", printed)
        self.assertEqual(self.page.read_text(encoding="utf-8"), "A step takes 7 ms, about 1/20 of a detection.\n")


if __name__ == "__main__":
    unittest.main()
