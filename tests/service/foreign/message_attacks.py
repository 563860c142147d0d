"""Attacks by messages: malformed, senseless, compressed, or too large."""
import itertools
import random
import struct
import zlib

import http2
import protocol
import recording
from attack_case import AttackCase, MEBIBYTE
from boxes import find_pairs, make_boxes
from client import new_id, spec_of, uploads
from mutations import is_malformed
from server import TOKENS

MALFORMED = [b"\0", b"\xff", b"\xff" * 100, b"\x0a\xff\xff\xff\xff\x07", b"\x0b" * 1000, b"\x0a\x05xx", b"\x0a", b"\x09\0",
             b"\x0a\x03\x0a\x01\xff", b"\x12\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", b"\x07", b"\x0c"]


def malformed_for(method, count=30, seed=1):
    """Returns bytes that are no message of the method: known examples, and random bytes."""
    generator = random.Random(seed)
    noise = (generator.randbytes(generator.randrange(1, 200)) for _ in itertools.count())
    candidates = itertools.chain(MALFORMED, noise)
    return list(itertools.islice((one for one in candidates if is_malformed(method.request, one)), count))


class Malformed(AttackCase):
    """Bytes that are no message get INVALID_ARGUMENT."""

    def check_method(self, name):
        codes = {data.hex(): self.anna.call(name, data).code.name for data in malformed_for(protocol.methods()[name])}
        wrong = {code: data for data, code in codes.items() if code != "INVALID_ARGUMENT"}
        self.assertFalse(wrong, f"{name}: codes of malformed messages, each with an example")

    def test_without_a_token(self):
        """A malformed message without a token is refused like every message without a token."""
        stranger = self.client(None)
        codes = {name: stranger.call(name, b"\xff").code.name for name in protocol.methods()}
        self.assertEqual(codes, dict.fromkeys(protocol.methods(), "UNAUTHENTICATED"))

    def test_after_a_valid_message(self):
        boxes = make_boxes(100, seed=1)
        for name in ("Detect", "Submit"):
            for data in malformed_for(protocol.methods()[name], 10):
                answer = self.anna.call(name, *uploads(boxes, 1000, id=new_id())[:1], data)
                self.assert_code(answer, "INVALID_ARGUMENT")
        for data in malformed_for(protocol.methods()["Scene"], 10):
            self.assert_code(self.anna.call("Scene", *recording.scene_uploads(boxes), data), "INVALID_ARGUMENT")

    def test_damaged_recordings(self):
        upload = protocol.messages().SceneUpload
        for calls in (b"x" * 100, recording.head()[:-1] + b"x", recording.head() + bytes(100), recording.head(float("nan")),
                      recording.head() + recording.record(99), recording.head() + recording.record(2, b"\xff" * 40),
                      recording.head() + struct.pack("<IIQ", 1, 0, 1 << 63)):
            self.assert_code(self.anna.call("Scene", upload(calls=calls)), "INVALID_ARGUMENT")

    def test_a_valid_scene(self):
        boxes = make_boxes(100, seed=1)
        answer = self.anna.call("Scene", *recording.scene_uploads(boxes))
        self.assert_code(answer, "OK")
        self.assertEqual(answer.pairs(), find_pairs(boxes))
        self.assertEqual(answer.messages[-1].result.began, len(find_pairs(boxes)))


def _test_of(name):
    def test(self):
        self.check_method(name)
    test.__doc__ = f"Malformed messages of {name}."
    return test


for _name in ("Describe", "Detect", "DetectSmall", "Submit", "Status", "Wait", "Result", "Cancel", "Release", "List", "Scene",
              "ListScenes", "WatchScene"):
    setattr(Malformed, f"test_{_name.lower()}", _test_of(_name))


class Senseless(AttackCase):
    """Messages that can be parsed, with values that make no sense."""

    options = ("--max-memory", "256M")
    boxes = make_boxes(50, seed=2)

    def test_values_of_a_spec(self):
        messages, nan = protocol.messages(), float("nan")
        sets = messages.ObjectSet
        wrong = [dict(id=""), dict(id="x" * MEBIBYTE), dict(id="../../../etc/passwd"), dict(id="\n\0" + new_id()),
                 dict(id=new_id().upper()), dict(id="{" + new_id() + "}"), dict(order=7), dict(order=-1), dict(margin=nan),
                 dict(margin=-1), dict(margin=float("inf")), dict(first=sets(objects=50, precision=9)),
                 dict(second=sets(objects=1, precision=-5)), dict(first=sets(objects=50, precision=2**31 - 1))]
        for fields, name in itertools.product(wrong, ("Detect", "Submit", "DetectSmall")):
            if name == "DetectSmall" and fields.get("id") == "":
                continue  # DetectSmall needs no id
            with self.subTest(method=name, fields=str(fields)[:60]):
                spec = spec_of(50, **{"id": new_id(), **{k: v for k, v in fields.items() if k != "first"}})
                spec.first.MergeFrom(fields.get("first", sets()))
                answer = self.anna.call(name, messages.Upload(spec=spec, data=self.boxes.tobytes()))
                self.assert_code(answer, "INVALID_ARGUMENT")

    def check_counts(self, client):
        """Checks specs whose data do not come, with counts whose sizes in bytes exceed every integer."""
        sets, upload = protocol.messages().ObjectSet, protocol.messages().Upload
        counts = [2**63, 2**64 - 1, 2**62, 2**60, (2**64) // 24 + 1, (2**64) // 48 + 1, (2**64) // 56 + 1, 2**32]
        for count, name in itertools.product(counts, ("Detect", "Submit", "DetectSmall")):
            for second, padded, precision in ((None, False, 0), (2**64 - count, True, 1), (count, False, 1)):
                spec = spec_of(count, id=new_id())
                spec.first.padded, spec.first.precision = padded, precision
                if second is not None:
                    spec.second.CopyFrom(sets(objects=second))
                answer = client.call(name, upload(spec=spec, data=b"x" * 24))
                self.assert_limit(answer, "objects", "input_bytes", "memory_bytes", "memory_bytes_per_client",
                                  "state_bytes", "state_bytes_per_client")

    def test_very_many_objects(self):
        self.check_counts(self.anna)

    def test_very_many_objects_without_limits(self):
        server = self.start("--max-objects", 0, "--max-input", 0, "--max-pairs", 0, "--max-memory", "1G", "--max-state", "1G")
        self.check_counts(self.client(server=server))
        self.assert_serves(self.client(server=server))

    def test_job_names_that_do_not_exist(self):
        for job_id in ("", "x", "../state", new_id(), new_id().upper(), "\0", "\r\n2026-01-01T00:00:00.000Z info x",
                       "\N{GRINNING FACE}" * 1000, "y" * MEBIBYTE, "%s%n"):
            for name in ("Status", "Wait", "Result", "Cancel", "Release", "WatchScene"):
                answer = self.anna.call(name, protocol.methods()[name].request(id=job_id))
                self.assert_code(answer, "INVALID_ARGUMENT")
                self.assertLess(len(answer.text), 10_000, "the error repeats a huge id")
            self.assert_code(self.anna.call("ListScenes", protocol.messages().ListScenesRequest(after=job_id)), "OK",
                             "INVALID_ARGUMENT")
            self.assert_code(self.anna.call("List", protocol.messages().ListRequest(after=job_id)), "OK", "INVALID_ARGUMENT")

    def test_times_to_wait(self):
        job_id, request = new_id(), protocol.messages().WaitRequest
        self.anna.submit(self.boxes, job_id)
        self.anna.wait(job_id)
        for seconds in (float("nan"), float("inf"), -float("inf"), -1.0, 1e308, 5e-324):
            self.assert_code(self.anna.call("Wait", request(id=job_id, seconds=seconds)), "OK", "INVALID_ARGUMENT")

    def test_scenes_and_steps_to_wait_for(self):
        request = protocol.messages().WatchSceneRequest
        with recording.running_scene(self.anna, self.boxes) as scene_id:
            for seconds in (float("nan"), -float("inf"), -1.0, 5e-324):
                answer = self.anna.call("WatchScene", request(id=scene_id, after_step=2**64 - 1, seconds=seconds))
                self.assert_code(answer, "OK")
                self.assertEqual(answer.messages, [], "no step is newer")
            for limit in (0, 1, 2**63, 2**64 - 1):
                answer = self.anna.call("WatchScene", request(id=scene_id, pair_limit=limit, seconds=float("inf")))
                self.assert_code(answer, "OK")
                self.assertEqual(answer.messages[0].head.listed, min(limit, len(find_pairs(self.boxes))))

    def test_offsets_and_hashes(self):
        job_id, pairs = new_id(), find_pairs(self.boxes)
        self.anna.submit(self.boxes, job_id)
        self.anna.wait(job_id)
        found = self.anna.result(job_id).messages[0].head.hash
        for offset in (0, 1, len(pairs) - 1, len(pairs)):
            self.assertEqual(self.anna.result(job_id, offset=offset, hash=found).pairs(), pairs[offset:])
        for offset in (len(pairs) + 1, 2**61, 2**63, 2**64 - 1):
            answer = self.anna.result(job_id, offset=offset)
            self.assert_code(answer, "OK", "INVALID_ARGUMENT")
            self.assertEqual(answer.pairs(), [])
        for wrong in (b"x", found[:-1], found + b"x", found[::-1], bytes(16), b"x" * MEBIBYTE):
            self.assert_code(self.anna.result(job_id, hash=wrong), "INVALID_ARGUMENT")


def gzip_bomb(mebibytes):
    """Returns the compressed form of this many MiB of zeros: about a thousandth of their size."""
    zeros, pack = bytes(16 * MEBIBYTE), zlib.compressobj(9, zlib.DEFLATED, -15)
    piece, check = pack.compress(zeros) + pack.flush(zlib.Z_FULL_FLUSH), 0
    for _ in range(mebibytes // 16):
        check = zlib.crc32(zeros, check)
    trailer = struct.pack("<II", check, mebibytes * MEBIBYTE & 0xFFFFFFFF)
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + piece * (mebibytes // 16) + pack.flush() + trailer


class Large(AttackCase):
    """Messages that are too large, or become large when they are decompressed."""

    def send_bomb(self, token, mebibytes):
        """Sends a compressed message, and reads until the call ends or the connection is cut."""
        open_connection = http2.admitted if token else lambda address, _: http2.Connection(address).greet()
        with open_connection(self.server.address, token) as connection:
            connection.send(http2.call_head(3, "DetectSmall", token, grpc_encoding="gzip"))
            connection.send_data(3, http2.message(gzip_bomb(mebibytes), compressed=1))
            self.assertTrue(connection.wait_for_end(1, 60) or connection.closed, "the call does not end")

    def test_compressed_messages_are_not_expanded(self):
        for token, mebibytes in ((None, 256), (TOKENS["anna"], 512)):
            with self.subTest(token=bool(token)), self.assert_memory_grows_less_than(100):
                self.send_bomb(token, mebibytes)
        self.assert_serves(self.anna)

    def test_oversized_messages(self):
        data = b"\x7a\x81\x80\x80\x02" + bytes(protocol.MESSAGE_BYTES)
        self.assert_serves(self.anna)  # a connection whose first call is large may be a stranger's, and is cut
        for name in protocol.ordinary_methods():
            with self.subTest(method=name):
                self.assert_code(self.anna.call(name, data), "RESOURCE_EXHAUSTED")

    def test_messages_that_claim_to_be_large(self):
        """gRPC keeps a message until it is complete. gRPC's memory has a limit of its own, so other clients are served."""
        held = []
        with self.assert_memory_grows_less_than(400):
            for name in ("Detect", "DetectSmall", "Status"):
                connection = http2.admitted(self.server.address, TOKENS["greedy"])
                held.append(connection)
                connection.send(http2.call_head(3, name, TOKENS["greedy"]))
                connection.send_data(3, http2.message(bytes(160 * MEBIBYTE), length=2**32 - 1), 0, seconds=1)
                self.assert_serves()
        for connection in held:
            connection.socket.close()
