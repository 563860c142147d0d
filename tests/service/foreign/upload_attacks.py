"""Attacks by uploads: half, slow, too short or too long; and by jobs that contradict each other."""
import threading
import time

import http2
import protocol
import recording
from attack_case import AttackCase, together
from boxes import equal_boxes, find_pairs, make_boxes
from client import bytes_of, new_id, uploads
from metrics import free_port, metric
from server import TOKENS


class Stalls(AttackCase):
    """A client that stops or slows down in the middle of a call loses the call after --stall seconds."""

    options = ("--stall", 1)

    def upload_slowly(self, name, first, then, pause):
        """Sends `first`, and then `then` again and again (None: nothing), until the call ends. Returns the Answer."""
        over = threading.Event()

        def requests():
            yield from map(bytes_of, first)
            while not over.wait(pause):
                if then is not None:
                    yield then

        try:
            return self.anna.finish(name, self.anna.open(name, requests()))
        finally:
            over.set()

    def check_stalls(self, calls):
        """Makes the calls (name, first messages, repeated message) at a time, and checks that each is ended in time."""
        begin = time.monotonic()
        answers = together(lambda call: self.upload_slowly(*call, pause=0.05), calls)
        self.assertLess(time.monotonic() - begin, 30)
        for call, answer in zip(calls, answers):
            with self.subTest(method=call[0], messages=len(call[1]), repeated=call[2]):
                self.assert_limit(answer, "stall_seconds")
        self.assert_serves()

    def test_an_upload_that_stops_half_way(self):
        half = [uploads(make_boxes(1000, seed=1), 6000, id=new_id())[:2] for _ in range(2)]
        self.check_stalls([("Detect", half[0], None), ("Submit", half[1], None), ("Detect", [], None), ("Submit", [], None),
                           ("Scene", recording.scene_uploads(make_boxes(100, seed=1))[:1], None)])

    def test_a_byte_now_and_then(self):
        self.check_stalls([(name, uploads(make_boxes(1000, seed=1), 1, id=new_id())[:1], then)
                           for name in ("Detect", "Submit") for then in (b"\x7a\x01x", b"")])

    def send_a_byte_now_and_then(self, name):
        """Sends a message of 1000 bytes byte by byte. Returns whether the server ends the call."""
        token, end = TOKENS["anna"], time.monotonic() + 30
        with http2.admitted(self.server.address, token) as connection:
            connection.send(http2.call_head(3, name, token) + http2.frame(http2.DATA, http2.message(b"", length=1000), 0, 3))
            while time.monotonic() < end:
                connection.send(http2.frame(http2.DATA, b"x", 0, 3))
                if connection.wait_for_end(1, 0.05):
                    return True
        return False

    def test_a_message_that_never_ends(self):
        self.assertEqual(together(self.send_a_byte_now_and_then, ("Detect", "Submit", "Scene")), [True] * 3)

    def test_a_result_that_nobody_reads(self):
        """The memory of the result is given back, and the call ends."""
        port = free_port()
        server = self.start("--stall", 1, "--metrics", f"127.0.0.1:{port}")
        client = self.client(server=server)
        job = uploads(equal_boxes(3000), id=new_id())  # 36 MB of pairs
        call = client.open("Detect", iter([bytes_of(one) for one in job]))
        self.assert_becomes_true(lambda: metric(port, "octopair_memory_bytes") > 0, "the job does not begin")
        self.assert_becomes_true(lambda: metric(port, "octopair_memory_bytes") == 0, "the memory is not given back")
        self.assert_code(client.finish("Detect", call), "CANCELLED", "RESOURCE_EXHAUSTED")


class Uploads(AttackCase):
    """Uploads must have exactly the bytes of the spec."""

    boxes = make_boxes(100, seed=1)

    def test_surplus_and_missing_bytes(self):
        data, wrong = self.boxes.tobytes(), {}
        for label, bytes_sent in (("none", b""), ("missing", data[:-1]), ("surplus", data + b"x"), ("twice", data * 2)):
            for name in ("Detect", "Submit", "DetectSmall"):
                messages = uploads(self.boxes, id=new_id())
                messages[0].data = bytes_sent
                answer = self.anna.call(name, *messages)
                if answer.code.name != "INVALID_ARGUMENT":
                    wrong[label, name] = str(answer)
        self.assertEqual(wrong, {})

    def test_surplus_bytes_in_a_later_message(self):
        """The surplus arrives while the job runs."""
        for name in ("Detect", "Submit"):
            for more in (uploads(b"", id=new_id())[0], b"\x7a\x01x"):
                messages = uploads(equal_boxes(100_000), id=new_id(), count_only=True)
                self.assert_code(self.anna.call(name, *messages, more), "INVALID_ARGUMENT")
                self.assert_code(self.anna.call(name, *messages[1:]), "INVALID_ARGUMENT")

    def test_pieces_of_any_size(self):
        for size in (1, 23, 24, 1000):
            answer = self.anna.call("Detect", *uploads(self.boxes, size, id=new_id()))
            self.assertEqual(answer.pairs(), find_pairs(self.boxes))

    def test_boxes_that_are_no_boxes(self):
        for value in (float("nan"), float("inf"), 2.0):
            boxes = make_boxes(10, seed=1)
            boxes[6 * 4] = value
            for name in ("Detect", "DetectSmall"):
                answer = self.anna.call(name, *uploads(boxes, id=new_id()))
                self.assert_code(answer, "INVALID_ARGUMENT")
                self.assertIn("object 4", answer.text)


class DetachedJobs(AttackCase):
    """Calls about detached jobs that contradict each other."""

    options = ("--threads", 1)
    boxes = make_boxes(100, seed=1)

    def test_an_id_with_other_input(self):
        job_id = new_id()
        self.assert_code(self.anna.submit(self.boxes, job_id), "OK")
        self.assert_code(self.anna.submit(self.boxes, job_id), "OK")
        for boxes, fields in ((make_boxes(100, seed=2), {}), (make_boxes(99, seed=1), {}), (self.boxes, dict(margin=0.5)),
                              (self.boxes, dict(count_only=True)), (self.boxes, dict(limit=1)), (self.boxes, dict(order=1))):
            self.assert_code(self.anna.submit(boxes, job_id, **fields), "INVALID_ARGUMENT")
        self.anna.wait(job_id)
        self.assertEqual(self.anna.result(job_id).pairs(), find_pairs(self.boxes))
        self.assertEqual(self.anna.ids(), [job_id])

    def test_release_before_the_end(self):
        first, second = new_id(), new_id()
        for job_id in (first, second):
            self.assert_code(self.anna.submit(equal_boxes(100_000), job_id, count_only=True), "OK")
        for job_id in (second, first):
            self.assert_code(self.anna.job("Release", job_id), "INVALID_ARGUMENT")
            self.assert_code(self.anna.job("Status", job_id), "OK")
        for job_id in (second, first):
            self.assert_code(self.anna.job("Cancel", job_id), "OK")
            self.assert_code(self.anna.wait(job_id), "OK")
            self.assert_code(self.anna.job("Release", job_id), "OK")
            self.assert_code(self.anna.job("Release", job_id), "INVALID_ARGUMENT")

    def test_many_calls_about_one_job(self):
        """Clients submit, cancel, release and read one job at the same time."""
        job_id, codes = new_id(), set()

        def work(name):
            client = self.client()
            for _ in range(40):
                answer = (client.submit(self.boxes, job_id) if name == "Submit" else client.result(job_id)
                          if name == "Result" else client.job(name, job_id))
                codes.add((name, answer.code.name))

        threads = [threading.Thread(target=work, args=(name,)) for name in ("Submit", "Submit", "Cancel", "Release", "Result")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        allowed = {"OK", "INVALID_ARGUMENT", "CANCELLED", "UNAVAILABLE"}  # UNAVAILABLE: released during its upload
        self.assertLessEqual({code for _, code in codes}, allowed, codes)


class DamagedState(AttackCase):
    """Damaged files of jobs: the errors that clients get name no path of the server."""

    def damage(self, ending, change):
        """Submits a job, changes its file with this ending, restarts the server, and reads the job."""
        job_id, client = new_id(), self.client()
        self.assert_code(client.submit(make_boxes(500, seed=9), job_id), "OK")
        client.wait(job_id)
        self.server.kill()
        for file in self.server.state.glob(f"*{ending}"):
            change(file)
        self.server.start()
        client = self.client()
        for name in ("Status", "Wait", "Result", "Cancel"):
            client.call(name, protocol.methods()[name].request(id=job_id))
        client.ids()
        client.job("Release", job_id)
        self.assert_serves()

    def test_results(self):
        self.damage(".result", lambda file: file.write_bytes(file.read_bytes()[:-1] + b"x"))
        self.damage(".result", lambda file: file.write_bytes(file.read_bytes()[:40]))
        self.damage(".result", lambda file: file.write_bytes(file.read_bytes()[:40] + b"xx" + file.read_bytes()[42:]))

    def test_inputs(self):
        self.damage(".job", lambda file: file.write_bytes(file.read_bytes()[:-1] + b"x"))
        self.damage(".job", lambda file: (file.write_bytes(file.read_bytes()[:-40]), remove_results(file)))

    def test_files_that_vanish(self):
        job_id = new_id()
        self.anna.submit(make_boxes(500, seed=9), job_id)
        self.anna.wait(job_id)
        for file in self.server.state.glob("*.result"):
            file.unlink()
        self.anna.result(job_id)
        self.anna.job("Release", job_id)

    def test_a_state_folder_that_vanishes(self):
        self.server.state.rename(self.server.folder / "elsewhere")
        answer = self.anna.submit(make_boxes(500, seed=9), new_id())
        self.assertNotEqual(answer.code.name, "OK")


def remove_results(job_file):
    """Removes the result of a job, so that the next server runs the job again."""
    job_file.with_suffix(".result").unlink(missing_ok=True)
