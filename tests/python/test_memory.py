"""Memory does not grow from call to call."""
import gc
import resource

import numpy as np
from conftest import random_boxes

import octopair as op


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def test_many_calls_do_not_grow():
    boxes, tiny = random_boxes(300), np.zeros((2, 6), np.float32)
    engine, scene = op.Engine(threads=1), op.Scene(threads=1)
    ids = scene.add(boxes)
    balls = op.Shapes([op.Geometry.sphere(0.1)], op.make_poses(boxes[:50, :3]), np.zeros(50, int))

    def work(calls):
        for _ in range(calls):
            engine.find_pairs(tiny)
        for _ in range(calls // 100):
            engine.find_pairs(boxes, return_summary=True)
            scene.move(ids[:3], boxes[:3])
            scene.step()
            scene.nearest(boxes[:5, :3], k=3)
            engine.submit(tiny).result()
            list(engine.stream_pairs(tiny))
            try:
                op.find_pairs(boxes[:, :5])
            except op.Error:
                pass
        for _ in range(calls // 1000):
            op.find_pairs(boxes)
            op.find_pairs(tiny, threads=1)
            op.collide(balls)
            op.Pipeline().keep(lambda batch: batch.a > 3).run(boxes, engine=engine)

    work(20_000)
    gc.collect()
    before = resident()
    work(1_000_000)
    gc.collect()
    assert resident() - before < 4 << 20


def test_large_results_are_freed():
    boxes = np.zeros((8000, 6), np.float32)
    engine = op.Engine()
    for _ in range(3):
        assert len(engine.find_pairs(boxes)) == 8000 * 7999 // 2
    before = resident()
    for _ in range(10):
        engine.find_pairs(boxes)
        engine.submit(boxes).result()
    assert resident() - before < 64 << 20
