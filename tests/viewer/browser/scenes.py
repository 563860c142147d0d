"""Scenes of Python for the tests of pages: scenes.py record FILE | live | remote ADDRESS | job ADDRESS. Reads commands from standard input."""

import json
import select
import sys

import numpy as np

import octopair as op
import octopair.remote

OBJECTS = 200


def boxes_at(middles):
    return np.hstack([middles - 0.03, middles + 0.03]).astype(np.float32)


def command(seconds):
    """Returns the next line of standard input, or None if none comes in time."""
    ready, _, _ = select.select([sys.stdin], [], [], seconds)
    return sys.stdin.readline().strip() or "stop" if ready else None


def tell(**values):
    print(json.dumps(values), flush=True)


class Dust:
    """Boxes that drift at random."""

    def __init__(self, scene):
        self.scene = scene
        self.random = np.random.default_rng(5)
        self.middles = self.random.random((OBJECTS, 3))
        self.ids = scene.add(boxes_at(self.middles))
        self.steps = 0

    def step(self):
        if self.steps:
            self.middles += self.random.normal(0, 0.004, self.middles.shape)
            self.scene.move(self.ids, boxes_at(self.middles))
        self.steps += 1
        return self.scene.step()


def record(path):
    dust = Dust(op.Scene(recording=path))
    counts = [[int(np.size(dust.scene.pairs(), 0)), len(step.began), len(step.ended)] for step in (dust.step() for _ in range(12))]
    tell(counts=counts)


def run(dust, show):
    """Steps until the command "stop". "pairs" prints the pairs and waits; "go" steps on."""
    running = True
    while (word := command(0.02 if running else 60)) != "stop":
        if word == "pairs":
            running = False
            show(dust.step(), at_once=True)
            tell(steps=dust.steps, pairs=np.asarray(dust.scene.pairs()).tolist())
        elif word == "go":
            running = True
        elif word is None and running:
            show(dust.step(), at_once=False)
        elif word == "steps":
            tell(steps=dust.steps)


def live():
    dust = Dust(op.Scene())
    with op.View(dust.scene, title="dust", names=[f"grain {k}" for k in range(OBJECTS)]) as view:
        tell(address=view.address)
        run(dust, view.show)


def remote(address):
    dust = Dust(op.remote.RemoteScene(address))
    tell(connected=True)
    run(dust, lambda step, at_once: None)


def job(address):
    """Runs a job of 1,000 boxes, and releases it at a command."""
    client = op.remote.JobClient(address)
    job_id = client.submit(boxes_at(np.random.default_rng(6).random((1000, 3))))
    client.wait(job_id)
    tell(id=job_id)
    command(60)
    client.release(job_id)


if __name__ == "__main__":
    {"record": record, "live": live, "remote": remote, "job": job}[sys.argv[1]](*sys.argv[2:])
