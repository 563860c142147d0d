"""Runs a command and fails if LeakSanitizer reports memory that the modules of octopair allocated.

    leak_check.py COMMAND...

Python and its other modules keep memory until the process ends. A suppression of Python's frames would also suppress octopair's leaks,
because Python calls octopair.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

with tempfile.TemporaryDirectory() as folder:
    options = f"exitcode=0:log_path={folder}/leaks"
    status = subprocess.run(sys.argv[1:], env={**os.environ, "LSAN_OPTIONS": options}, check=False).returncode
    reports = [path.read_text(errors="replace") for path in pathlib.Path(folder).iterdir()]
blocks = [block for report in reports for block in report.split("\n\n")]
ours = [block for block in blocks if "leak of" in block and "/octopair/_" in block and "PyInit_" not in block]
print(*ours, sep="\n\n")
sys.exit(status or (1 if ours else 0))
