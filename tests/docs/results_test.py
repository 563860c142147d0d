#!/usr/bin/env python3
"""Tests that the results in docs/results are reduced and of one commit, and that the tables of the pages are those of these files."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "docs" / "results"
sys.path.insert(0, str(ROOT / "bench"))
import origin
import tables

ORIGIN = {"commit": "0123456789ab", "compiler": "GNU 12", "cores": 2, "date": "2026-12-01", "processor": "EPYC", "version": "1.0.0"}


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
        done = run("page.py", "--check")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_each_table_is_on_a_page(self):
        pages = "".join(path.read_text(encoding="utf-8") for path in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
        self.assertEqual([name for name in tables.BLOCKS if f"<!-- begin {name} -->" not in pages], [])

    def test_committed_files_are_of_a_commit_of_this_repository(self):
        commit = origin.of(RESULTS / "paper.json")["commit"]
        self.assertRegex(commit, "^[0-9a-f]{12}$")
        shallow = subprocess.run(["git", "-C", ROOT, "rev-parse", "--is-shallow-repository"], capture_output=True, text=True, check=False)
        if shallow.stdout.strip() != "false":
            self.skipTest("no history to look into: an archive, or a shallow clone")
        self.assertIn(f"{commit}\n", origin.git("log", "--format=%h", "--abbrev=12"))

    def origins(self, *others):
        """Returns the differences of files with ORIGIN and with the origins of `others`."""
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for number, other in enumerate([ORIGIN, *others]):
                paths.append(pathlib.Path(folder) / f"{number}.json")
                paths[-1].write_text(json.dumps({"measured": other} if other else {}), encoding="utf-8")
            return origin.differences(paths)

    def test_results_of_another_commit_or_machine_are_found(self):
        self.assertEqual(self.origins({**ORIGIN, "date": "2026-12-02"}), [])
        self.assertEqual(self.origins({**ORIGIN, "commit": "ba9876543210"}), ["1.json has the commit ba9876543210, 0.json has 0123456789ab"])
        self.assertEqual(self.origins({**ORIGIN, "processor": "Xeon"}), ["1.json has the processor Xeon, 0.json has EPYC"])
        self.assertEqual(self.origins(None), ["1.json does not say where it was measured"])

    def test_a_program_of_another_commit_is_refused(self):
        self.assertEqual(origin.stamped("a", '{"commit": "0123456", "x": 1}', ORIGIN)["x"], 1)
        with self.assertRaises(ValueError):
            origin.stamped("a", '{"machine": {"commit": "ba98765"}}', ORIGIN)
        with self.assertRaises(ValueError):
            origin.stamped("a", '{"commit": "0123456-dirty"}', ORIGIN)

    def test_a_checkout_with_changes_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            shutil.copytree(ROOT / "bench", root / "bench")
            for words in (["init", "-q"], ["add", "."], ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "a"]):
                subprocess.run(["git", *words], cwd=root, check=True)
            (root / "new.txt").write_text("new", encoding="utf-8")
            done = subprocess.run([sys.executable, root / "bench" / "results", "scenes"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("the checkout has changes (new.txt)", done.stderr)

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
