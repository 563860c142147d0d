#!/usr/bin/env python3
"""Judges octopair's classes of all pairs of closed objects in a duplex house whose boxes meet, by manifold-3d (judge.mjs).

    judge_test.py PROGRAM NODE INSTALL NPM

PROGRAM: octopair. NODE: node. INSTALL: viewer/install.mjs. NPM: folder of installed libraries; a missing one comes from npm's registry.
"""
import pathlib
import subprocess
import sys
import tempfile

import duplex_test

HERE = pathlib.Path(__file__).resolve().parent


def main(program, node, install, npm):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([node, install, npm, folder, HERE], check=True)
        model = duplex_test.unpack(pathlib.Path(folder))
        result = duplex_test.detect(program, model, duplex_test.TOLERANCE, 1)
        judge = subprocess.run([node, HERE / "judge.mjs", f"{folder}/node_modules", model, result, duplex_test.TOLERANCE],
                               stdout=subprocess.PIPE, text=True)
    print(judge.stdout)
    assert "\n194 of 215 objects are judged\n" in judge.stdout, "the judge left out closed objects"
    return judge.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
