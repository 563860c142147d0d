#!/usr/bin/env python3
"""Tests that the measurements in docs/results are reduced, and that the tables of the pages are those of these files."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "docs" / "results"
PAGES = [ROOT / "docs" / name for name in ("results.md", "engines.md", "scaling.md")]


def run(script, *words):
    return subprocess.run([sys.executable, ROOT / "bench" / script, *words], capture_output=True, text=True, check=False)


def rank(plan, mpi, octants, sent):
    return {"cpu_seconds": {"plan": plan, "scan": 0.5, "mpi": mpi}, "bytes_sent": sent, "messages_sent": 1, "shared_objects": 2,
            "octants": octants}


class ResultsTest(unittest.TestCase):
    def test_committed_files_are_reduced(self):
        done = run("reduce_results.py", "--check", *sorted(RESULTS.glob("*.json")))
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_pages_show_the_committed_files(self):
        done = run("page.py", "--check", RESULTS, *PAGES)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_another_table_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("<!-- begin scaling -->\nold\n<!-- end scaling -->\n", encoding="utf-8")
            done = run("page.py", "--check", RESULTS, page)
            self.assertEqual(done.returncode, 1)
            self.assertIn("a table differs", done.stderr)
            self.assertIn("old", page.read_text(encoding="utf-8"))

    def test_ranks_are_summed_and_single_measurements_removed(self):
        whole = {"runs": [{"scene": "uniform", "ranks": 2, "alone": [rank(1.0, 9.0, 7, 0), rank(2.0, 9.0, 5, 0)],
                           "together": [rank(0.0, 0.0, 0, 10), rank(0.0, 0.0, 0, 20)]}]}
        peers = {"commit": "0", "results": [{"scene": "dense", "rows": [{"contender": "x", "seconds": [2, 1, 3], "median_seconds": 2}]}]}
        with tempfile.TemporaryDirectory() as folder:
            files = {pathlib.Path(folder) / "cluster.json": whole, pathlib.Path(folder) / "peers_1m_1.json": peers}
            for path, value in files.items():
                path.write_text(json.dumps(value), encoding="utf-8")
            self.assertEqual(run("reduce_results.py", "--check", *files).returncode, 1)
            self.assertEqual(run("reduce_results.py", *files).returncode, 0)
            self.assertEqual(run("reduce_results.py", "--check", *files).returncode, 0)
            cluster, compared = (path.read_text(encoding="utf-8") for path in files)
        self.assertEqual(json.loads(cluster)["runs"], [
            {"scene": "uniform", "ranks": 2, "cpu_seconds": {"plan": 3.0, "scan": 1.0, "mpi": 18.0}, "computing_seconds": 4.0,
             "slowest_seconds": 2.5, "octants": 12, "most_octants": 7, "bytes_sent": 30, "messages_sent": 2, "shared_objects": 4}])
        self.assertEqual(compared, '{\n "commit": "0",\n "results": [\n  {\n   "scene": "dense",\n   "rows": [\n'
                                   '    {"contender": "x", "median_seconds": 2}\n   ]\n  }\n ]\n}\n')


if __name__ == "__main__":
    unittest.main()
