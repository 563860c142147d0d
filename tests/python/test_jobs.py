"""Jobs, streams, progress, the ends of engines, and threads of Python that share engines and scenes."""
import asyncio
import contextlib
import gc
import logging
import os
import pathlib
import threading
import weakref

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


@pytest.fixture
def slow_engine():
    """An engine with one thread, and a job that runs until it is cancelled."""
    engine = op.Engine(threads=1)
    job = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)
    yield engine, job
    engine.close()


def test_callbacks_run_when_a_job_has_ended(slow_engine):
    engine, slow = slow_engine
    job, ended, seen = engine.submit(random_boxes(100)), threading.Event(), []
    job.add_done_callback(lambda job: seen.append((job, job.state, threading.get_ident())))
    job.add_done_callback(lambda job: ended.set())
    slow_ended = threading.Event()
    slow.add_done_callback(lambda job: slow_ended.set())
    assert not seen and not slow_ended.is_set()
    slow.cancel()
    assert ended.wait(60) and slow_ended.is_set()  # in the order of the ends
    assert seen[0][:2] == (job, "done") and seen[0][2] != threading.get_ident()
    job.add_done_callback(lambda job: seen.append((job, job.result(), threading.get_ident())))
    assert len(seen) == 2 and seen[1] == (job, job.result(), threading.get_ident())
    with pytest.raises(op.InputTypeError, match="callable"):
        job.add_done_callback(3)


def test_callbacks_run_for_queued_jobs_that_are_cancelled_and_for_jobs_that_fail(slow_engine):
    engine, _ = slow_engine
    queued, ended = engine.submit(random_boxes(100)), threading.Event()
    queued.add_done_callback(lambda job: ended.set())
    queued.cancel()
    assert ended.wait(60) and queued.state == "cancelled"
    failed, states, ended = op.Engine().submit(np.full((3, 6), np.nan)), [], threading.Event()
    failed.add_done_callback(lambda job: (states.append(job.state), ended.set()))
    assert ended.wait(60) and states == ["failed"]


def test_a_job_with_a_callback_is_kept_and_others_are_not(slow_engine):
    engine, slow = slow_engine
    ended, found = threading.Event(), []
    engine.submit(random_boxes(100)).add_done_callback(lambda job: (found.append(job.result().pairs), ended.set()))
    gc.collect()
    slow.cancel()
    assert ended.wait(60) and np.array_equal(found[0], op.find_pairs(random_boxes(100)))
    job = engine.submit(random_boxes(100))
    job.add_done_callback(lambda job: None)
    job.wait()
    reference = weakref.ref(job)
    del job
    done = threading.Event()
    engine.submit(random_boxes(100)).add_done_callback(lambda job: done.set())  # the callbacks before have been called
    assert done.wait(60)
    gc.collect()
    assert reference() is None


def test_an_exception_of_a_callback_is_logged_and_others_run(slow_engine, caplog):
    engine, slow = slow_engine
    ended = threading.Event()

    def fail(job):
        raise (KeyError if job is slow else SystemExit)("mine")

    job = engine.submit(random_boxes(10))
    for each in (slow, job):
        each.add_done_callback(fail)
    called = []
    job.add_done_callback(called.append)
    last = engine.submit(random_boxes(10))
    last.add_done_callback(lambda job: ended.set())
    with caplog.at_level(logging.ERROR, "octopair"):
        slow.cancel()
        assert ended.wait(60)
        slow.add_done_callback(fail)
    assert [record.exc_info[0] for record in caplog.records] == [KeyError, SystemExit, KeyError]
    assert called == [job]


def test_many_jobs_share_one_thread():
    with op.Engine(threads=1) as engine:
        slow = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)
        counted = threading.Semaphore(0)
        jobs = [engine.submit(np.zeros((2, 6))) for _ in range(300)]
        before = threading.active_count()
        for job in jobs:
            job.add_done_callback(lambda job: counted.release())
        assert threading.active_count() <= before + 1
        slow.cancel()
        for _ in jobs:
            assert counted.acquire(timeout=60)


def test_jobs_can_be_awaited():
    boxes = random_boxes(2000)
    expected = brute_force(boxes)

    async def search():
        with op.Engine(threads=1) as engine:
            slow, ticks = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9), []

            async def tick():
                for _ in range(3):
                    await asyncio.sleep(0)
                    ticks.append(slow.done())
                slow.cancel()

            with pytest.raises(op.CancelledError):
                await asyncio.gather(slow, tick())
            assert ticks == [False] * 3  # the loop ran meanwhile
            jobs = [engine.submit(boxes) for _ in range(20)]
            for result in await asyncio.gather(*jobs, *jobs):
                assert np.array_equal(result.pairs, expected)
            assert (await jobs[0]) is jobs[0].result()
            boxes[7] = np.nan
            with pytest.raises(op.InputError) as caught:
                await engine.submit(boxes)
            assert caught.value.index == 7

    asyncio.run(search())


def test_cancelling_a_task_cancels_the_job_that_it_awaits():
    async def search():
        with op.Engine(threads=1) as engine:
            job = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)
            task = asyncio.ensure_future(job)
            await asyncio.sleep(0)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert job.wait(60) and job.state == "cancelled"
            other = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(other, 0.01)
            assert other.wait(60) and other.state == "cancelled"
            return engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)

    left = asyncio.run(search())
    assert left.wait(60) and left.state == "cancelled"  # by the end of the engine


def test_a_loop_may_end_before_a_job(caplog):
    engine = op.Engine(threads=1)
    job = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)

    async def leave():
        job.__await__().send(None)

    asyncio.run(leave())
    ended = threading.Event()
    job.cancel()
    job.add_done_callback(lambda job: ended.set())
    assert ended.wait(60) and not caplog.records


def test_engines_end(slow_engine):
    engine, slow = slow_engine
    done = op.Engine()
    finished = done.submit(random_boxes(100))
    finished.wait()
    stream = done.stream_pairs(np.zeros((3000, 6)), buffer_bytes=1 << 20)
    next(stream)
    queued = engine.submit(random_boxes(100))
    with done as same:
        assert same is done
    engine.close()
    assert slow.state == queued.state == "cancelled"
    assert np.array_equal(finished.result().pairs, op.find_pairs(random_boxes(100)))
    with pytest.raises(StopIteration):
        next(stream)
    for closed in (engine, done):
        closed.close()
        calls = [lambda: closed.find_pairs(np.zeros((2, 6))), lambda: closed.count_pairs(np.zeros((2, 6))), lambda: closed.submit(np.zeros((2, 6))),
                 lambda: closed.stream_pairs(np.zeros((2, 6))), lambda: closed.allocate_boxes(3), closed.worker_faults,
                 lambda: op.Pipeline().run(np.zeros((2, 6)), engine=closed), lambda: op.Pipeline().count(np.zeros((2, 6)), engine=closed)]
        for call in calls:
            with pytest.raises(op.UsageError, match="the engine is closed"):
                call()
        assert repr(closed) == "Engine('local', closed)"


def workers():
    """Returns the numbers of the worker processes of this process."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            pid, rest = path.read_text(encoding="ascii", errors="replace").split(" (octopair-worke", 1)
            if int(rest.split(")")[1].split()[1]) == os.getpid():
                found.append(int(pid))
    return found


def test_the_end_of_a_block_ends_worker_processes():
    with pytest.raises(KeyError):
        with op.Engine("processes", workers=2) as engine:
            engine.find_pairs(random_boxes(10))
            assert len(workers()) >= 2
            raise KeyError
    assert not workers()


def test_an_engine_ends_after_the_call_of_another_thread():
    engine, boxes = op.Engine(threads=1), np.zeros((30_000, 6), np.float32)
    began, counts = threading.Event(), []
    thread = threading.Thread(target=lambda: counts.append(engine.count_pairs(boxes, progress=lambda done: began.set())))
    thread.start()
    assert began.wait(60)
    engine.close()
    thread.join(60)
    assert counts == [30_000 * 29_999 // 2]
    with pytest.raises(op.UsageError, match="closed"):
        engine.count_pairs(boxes)


def test_an_engine_may_not_end_in_its_callback():
    engine = op.Engine()
    with pytest.raises(op.UsageError, match="callback"):
        op.Pipeline().run(np.zeros((5, 6)), engine=engine, sink=lambda batch: engine.close())
    assert engine.count_pairs(np.zeros((2, 6))) == 1


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
