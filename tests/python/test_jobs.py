"""Jobs, streams, progress, and threads of Python that share engines and scenes."""
import threading

import numpy as np
import pytest
from conftest import brute_force, random_boxes

import octopair as op


def test_threads_share_engines_and_scenes():
    boxes = random_boxes(3000)
    expected = brute_force(boxes)
    engine, scene = op.Engine(), op.Scene()
    ids = scene.add(boxes)
    failures = []

    def work():
        own = op.Engine(threads=1)
        for _ in range(30):
            if not np.array_equal(engine.find_pairs(boxes), expected) or not np.array_equal(own.find_pairs(boxes), expected):
                failures.append("engine")
            scene.move(ids, boxes)
            scene.step()
            if not np.array_equal(scene.pairs(), expected):
                failures.append("scene")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def test_progress_is_reported_on_this_thread():
    seen = []
    op.count_pairs(np.zeros((20_000, 6), np.float32), progress=lambda done: seen.append((done, threading.get_ident())))
    assert seen[-1][0] == 1 and {thread for _, thread in seen} == {threading.get_ident()}
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_jobs():
    boxes = random_boxes(5000)
    engine = op.Engine(threads=1)
    slow = engine.submit(np.zeros((100_000, 6), np.float32), limit=10**9)
    job = engine.submit(boxes, margin=0.01)
    assert job.state == "queued" and not job.wait(0.01) and not job.done()
    with pytest.raises(TimeoutError):
        job.result(timeout=0.01)
    slow.cancel()
    assert slow.wait(10) and slow.state == "cancelled"
    with pytest.raises(op.CancelledError):
        slow.result()
    with pytest.raises(op.InputError):
        job.wait(float("nan"))
    result = job.result()
    assert job.state == "done" and job.progress == 1 and job.result() is result
    assert result.pairs.tobytes() == op.find_pairs(boxes, margin=0.01).tobytes() and not result.truncated
    boxes[7, 0] = np.nan
    failed = engine.submit(boxes)
    with pytest.raises(op.InputError) as caught:
        failed.result()
    assert caught.value.index == 7 and failed.state == "failed"
    del engine, job
    assert result.summary.pairs == len(result.pairs)


def test_streams_end_early():
    engine = op.Engine()
    stream = engine.stream_pairs(np.zeros((20_000, 6), np.float32), order="octal", buffer_bytes=1 << 20)
    assert len(next(stream)) > 0 and stream.summary is None
    with pytest.raises(op.UsageError, match="stream"):
        engine.count_pairs(np.zeros((2, 6)))
    stream.close()
    with pytest.raises(StopIteration):
        next(stream)
    assert engine.count_pairs(np.zeros((2, 6))) == 1
    for chunk in engine.stream_pairs(np.zeros((20_000, 6), np.float32), order="octal"):
        break
    del chunk
    assert engine.count_pairs(np.zeros((2, 6))) == 1
    with pytest.raises(op.InputError):
        next(engine.stream_pairs(np.full((5, 6), np.nan)))
    assert engine.count_pairs(np.zeros((2, 6))) == 1


def test_engines_work_in_threads_that_are_not_the_main_thread():
    found = []
    thread = threading.Thread(target=lambda: found.append(op.find_pairs(np.zeros((3, 6)), progress=lambda done: None)))
    thread.start()
    thread.join()
    assert len(found[0]) == 3


def test_a_stream_may_be_closed_by_another_thread():
    for _ in range(5):
        stream = op.stream_pairs(np.zeros((3000, 6)), buffer_bytes=1 << 20)
        ends = []

        def read():
            try:
                for _ in stream:
                    pass
                ends.append("end")
            except op.CancelledError:
                ends.append("cancelled")

        thread = threading.Thread(target=read)
        thread.start()
        stream.close()
        thread.join(20)
        assert len(ends) == 1


def test_a_pipeline_may_be_extended_by_another_thread():
    pipeline = op.Pipeline()
    boxes = np.zeros((500, 6))
    thread = threading.Thread(target=lambda: [pipeline.parents(np.arange(500)) for _ in range(50)])
    thread.start()
    for _ in range(20):
        assert pipeline.count(boxes).collisions == 500 * 499 // 2
    thread.join()
