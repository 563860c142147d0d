"""Servers: detached jobs, and errors of connections."""
import asyncio
import threading

import numpy as np
import pytest
from conftest import random_boxes, serving

import octopair as op
from octopair.remote import JobClient, client_options


def test_detached_jobs():
    boxes = random_boxes(3000)
    with serving("--state", "{folder}/state") as address:
        client = JobClient(address)
        seen = []
        job = client.submit(boxes, margin=0.01, progress=seen.append)
        assert seen[-1] == 1
        status = client.wait(job, 20)
        assert status.ended and status.state == "done" and status.objects == 3000 and status.detached and status.error is None
        result = client.result(job)
        assert result.pairs.tobytes() == op.find_pairs(boxes, margin=0.01).tobytes() and result.summary.pairs == status.summary.pairs
        count = client.submit(boxes, count_only=True)
        assert client.wait(count).summary.pairs == op.count_pairs(boxes) and client.status(count).count_only
        assert {row.id for row in client.list()} == {job, count}
        client.release(job)
        with pytest.raises(op.InputError):
            client.status(job)
        crowd = client.submit(np.zeros((300_000, 6), np.float32), count_only=True)
        assert client.cancel(crowd).state == "cancelled"
        with pytest.raises(op.CancelledError):
            client.result(crowd)
        boxes[5] = np.nan
        with pytest.raises(op.InputError) as caught:
            client.result(client.submit(boxes))
        assert caught.value.index == 5
        with pytest.raises(op.UsageError):
            client.drain()


def test_threads_share_a_client():
    boxes = random_boxes(500)
    expected = op.find_pairs(boxes).tobytes()
    with serving("--state", "{folder}/state") as address:
        client = JobClient(address)
        good = []

        def work():
            job = client.submit(boxes)
            good.append(client.result(job).pairs.tobytes() == expected)

        threads = [threading.Thread(target=work) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert good == [True] * 8


def test_jobs_of_a_connection_can_be_awaited_and_it_can_be_closed():
    boxes = random_boxes(500)

    async def search():
        with op.Engine(address, patience=5) as engine:
            result = await engine.submit(boxes)
            assert result.pairs.tobytes() == op.find_pairs(boxes).tobytes()
            crowd = engine.submit(np.zeros((200_000, 6), np.float32), limit=10**9)
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(crowd, 0.05)
            assert crowd.wait(60) and crowd.state == "cancelled"
        with pytest.raises(op.UsageError, match="the engine is closed"):
            engine.find_pairs(boxes)
        assert "closed" in repr(engine)

    with serving() as address:
        asyncio.run(search())


def test_errors_of_connections(tmp_path):
    with pytest.raises(op.EngineError, match="no server answers"):
        op.Engine(f"unix:{tmp_path}/none", connect_timeout=0.2)
    with pytest.raises(op.UsageError):
        op.Engine("localhost:notaport")
    with pytest.raises(op.FileError):
        op.Engine("localhost:1", authority=tmp_path / "none.pem")
    with pytest.raises(TypeError):
        client_options(secret="x")
    with serving() as address:
        with pytest.raises(op.UsageError):
            JobClient(address).submit(random_boxes(10))
