"""Attacks by a greedy client with a token: it takes what its limits allow. Other clients keep their share."""
import time

import hostile
import http2
import protocol
from attack_case import AttackCase
from boxes import equal_boxes, find_pairs, make_boxes
from client import new_id, uploads
from server import TOKENS

RESULT_BOXES = 3000  # equal boxes, 36 MB of pairs


class Sharing(AttackCase):
    """Memory and time are shared among clients."""

    options = ("--max-memory", "256M", "--threads", 1)

    def setUp(self):
        super().setUp()
        self.greedy = self.client("greedy")

    def test_unread_results_leave_memory(self):
        job_id = new_id()
        self.assert_code(self.greedy.submit(equal_boxes(RESULT_BOXES), job_id), "OK")
        self.assert_code(self.greedy.wait(job_id), "OK")
        connections = [hostile.start_unread_results(self.server.address, TOKENS["greedy"], job_id, 100) for _ in range(7)]
        boxes = make_boxes(30_000, seed=1, size=0.01)
        for _ in range(5):
            answer = self.anna.detect(boxes)
            self.assert_code(answer, "OK")
        self.assert_serves(self.anna)
        for connection in connections:
            connection.socket.close()

    def test_inputs_leave_memory(self):
        """Uploads of the greedy client reserve memory for input that does not come."""
        token = TOKENS["greedy"]
        with http2.admitted(self.server.address, token) as connection:
            for stream in range(3, 103, 2):
                spec = uploads(bytes(24), id=new_id())[0]
                spec.spec.first.objects = 400_000
                connection.send(http2.call_head(stream, "Detect", token))
                connection.send_data(stream, http2.message(spec.SerializeToString()), 0)
            self.assert_becomes_true(lambda: "limit=memory_bytes_per_client" in self.server.log(), "never refused")
            self.assert_code(self.anna.detect(make_boxes(30_000, seed=1, size=0.01)), "OK")

    def test_large_jobs_leave_turns(self):
        """The next client's job waits for the job that runs, and not for the others before it."""
        boxes, ids = equal_boxes(60_000), [new_id() for _ in range(8)]
        for job_id in ids:
            self.assert_code(self.greedy.submit(boxes, job_id, count_only=True), "OK")
        small, large = make_boxes(1000, seed=1), make_boxes(30_000, seed=2, size=0.01)
        begin = time.monotonic()
        self.assertEqual(self.anna.detect_small(small).pairs(), find_pairs(small))
        self.assert_code(self.anna.detect(large), "OK")
        reports = [self.greedy.job("Status", job_id).messages[0] for job_id in ids]
        done = sum(report.state == protocol.messages().DONE for report in reports)
        self.assertLess(done, 5, f"anna waited {time.monotonic() - begin:.1f} s for {done} jobs of the greedy client")

    def test_many_jobs_and_calls_are_refused(self):
        """The greedy client exceeds its limit on jobs. Another client submits meanwhile."""
        token, spec = TOKENS["greedy"], uploads(bytes(24), id=new_id())[0]
        spec.spec.first.objects = 100
        connections = [http2.admitted(self.server.address, token) for _ in range(2)]
        for connection in connections:
            for stream in range(3, 253, 2):
                spec.spec.id = new_id()
                connection.send(http2.call_head(stream, "Detect", token))
                connection.send_data(stream, http2.message(spec.SerializeToString()), 0)
        self.assert_becomes_true(lambda: "limit=jobs_per_client" in self.server.log()
                                 or "limit=calls_per_client" in self.server.log(), "never refused")
        self.assert_serves(self.anna)
        for connection in connections:
            connection.socket.close()
