"""Attacks on the access: callers without a name or a token, and callers who try to reach jobs of others."""
import grpc

import protocol
import recording
from attack_case import AttackCase
from boxes import equal_boxes, find_pairs, make_boxes, pairs_in
from certificates import Authority
from client import Client, new_id, uploads
from server import TOKENS

JOB_CALLS = ("Status", "Wait", "Result", "Cancel", "Release")


def call_about(client, name, job_id):
    """Makes a call of JOB_CALLS about a job. Returns the Answer."""
    return client.call(name, protocol.methods()[name].request(id=job_id))


class JobCase(AttackCase):
    """Has checks of the jobs of two clients."""

    boxes = make_boxes(100, seed=3)

    def submit(self, client):
        """Submits a job and waits for its end. Returns its id."""
        job_id = new_id()
        self.assert_code(client.submit(self.boxes, job_id), "OK")
        self.assert_code(client.wait(job_id), "OK")
        return job_id

    def check_strangers(self, owner, stranger):
        """Checks that calls of the stranger about a job of the owner fail, reveal nothing, and change nothing."""
        job_id, unknown = self.submit(owner), new_id()
        for name in JOB_CALLS:
            answer, about_none = call_about(stranger, name, job_id), call_about(stranger, name, unknown)
            self.assert_code(answer, "INVALID_ARGUMENT")
            self.assertEqual(answer.text.replace(job_id, unknown), about_none.text, "the answer reveals whether the job exists")
        self.assertNotIn(job_id, stranger.ids())
        self.assertIn(job_id, owner.ids())
        self.assertEqual(owner.result(job_id).pairs(), find_pairs(self.boxes))
        return job_id


class Jobs(JobCase):
    """A client cannot reach jobs of another client."""

    def test_tokens_separate_clients(self):
        berta = self.client("berta")
        job_id = self.check_strangers(self.anna, berta)
        other = make_boxes(50, seed=4)
        self.assert_code(berta.submit(other, job_id), "OK")
        berta.wait(job_id)
        self.assertEqual(berta.result(job_id).pairs(), find_pairs(other), "both have a job with this id")
        self.assertEqual(self.anna.result(job_id).pairs(), find_pairs(self.boxes))

    def test_an_attached_job_of_another_client_is_not_replaced(self):
        """Both clients run the same job with the same id. For one client, the second call would replace the first."""
        boxes, count = equal_boxes(60_000), 60_000 * 59_999 // 2
        messages = [one.SerializeToString() for one in uploads(boxes, id=new_id(), count_only=True)]
        first = self.anna.open("Detect", iter(messages))
        next(first)  # the job runs
        answers = [self.client("berta").call("Detect", *messages), self.anna.finish("Detect", first)]
        for answer in answers:
            self.assert_code(answer, "OK")
            self.assertEqual(answer.messages[-1].summary.pairs, count)


class Scenes(AttackCase):
    """A client receives the state of its scenes, and cannot reach scenes of another client."""

    boxes = make_boxes(1000, seed=5, size=0.2)

    def watch(self, client, scene_id, **fields):
        request = protocol.messages().WatchSceneRequest(id=scene_id, **fields)
        return client.call("WatchScene", request)

    def test_a_snapshot_has_the_layout_of_the_protocol(self):
        pairs = find_pairs(self.boxes)
        with recording.running_scene(self.anna, self.boxes) as scene_id:
            answer = self.watch(self.anna, scene_id, pair_limit=1_000_000, seconds=30)
        self.assert_code(answer, "OK")
        head, data = answer.messages[0].head, b"".join(message.data for message in answer.messages)
        self.assertEqual((head.step, head.indices, head.pairs, head.listed), (1, 1000, len(pairs), len(pairs)))
        self.assertEqual((head.began, head.ended), (len(pairs), 0))
        boxes = self.boxes.tobytes()
        self.assertEqual(data[:125], b"\xff" * 125, "presence")
        self.assertEqual(data[125:125 + len(boxes)], boxes)
        self.assertEqual(pairs_in(data[125 + len(boxes):]), pairs)

    def test_tokens_separate_clients(self):
        berta, unknown = self.client("berta"), new_id()
        with recording.running_scene(self.anna, self.boxes) as scene_id:
            self.assertEqual(len(berta.call("ListScenes", b"").messages[0].scenes), 0)
            answer, about_none = self.watch(berta, scene_id), self.watch(berta, unknown)
            self.assert_code(answer, "INVALID_ARGUMENT")
            self.assertEqual(answer.text.replace(scene_id, unknown), about_none.text, "the answer reveals the scene")


class Tokens(AttackCase):
    """Only a token in the scheme Bearer gives access."""

    def refused(self, *metadata):
        for name in protocol.methods():
            with self.subTest(method=name, metadata=metadata):
                answer = self.client(None).call(name, b"", metadata=list(metadata))
                self.assert_code(answer, "UNAUTHENTICATED")

    def test_no_token(self):
        self.refused()

    def test_wrong_credentials(self):
        token = TOKENS["anna"]
        for value in ("Bearer wrong-0123456789abcdef", f"Basic {token}", f"Token   {token}", token, f"Bearer{token}",
                      f"Bearer {token}x", f"Bearer {token[:-1]}", "Bearer ", "", f"Bearer  {token}", f"{token} Bearer",
                      "Bearer " + "x" * 4000):
            with self.subTest(value=value[:40]):
                answer = self.client(None).call("Describe", b"", metadata=[("authorization", value)])
                self.assert_code(answer, "UNAUTHENTICATED")
                self.assertNotIn(token, answer.text)

    def test_the_scheme_has_any_case(self):
        for scheme in ("Bearer", "bearer", "BEARER"):
            answer = self.client(None).call("Describe", b"", metadata=[("authorization", f"{scheme} {TOKENS['anna']}")])
            self.assert_code(answer, "OK")

    def test_an_ordinary_client_cannot_end_the_server(self):
        self.assert_code(self.anna.call("Drain", b""), "PERMISSION_DENIED", "UNIMPLEMENTED")
        self.assert_serves()

    def test_a_stub_as_programs_use_it(self):
        stub = protocol.stub(self.anna.channel)
        description = stub.Describe(protocol.messages().DescribeRequest(), metadata=self.anna.metadata, timeout=60)
        self.assertTrue(description.detached)
        self.assertEqual(description.limits.message_bytes, protocol.MESSAGE_BYTES)
        with self.assertRaises(grpc.RpcError):
            stub.Describe(protocol.messages().DescribeRequest(), timeout=60)


class CertificateCase(JobCase):
    """Has an authority, and a server with TLS that requires client certificates."""

    tokens = False

    @classmethod
    def setUpClass(cls):
        cls.authority = Authority()
        cls.addClassCleanup(cls.authority.remove)

    def setUp(self):
        self.server = self.start(*self.authority.server_options(require_client_certificates=True), tokens=self.tokens)

    def holder(self, subject, alternative_names="", token=None):
        """Returns a client with a new certificate."""
        client = Client(self.server, token, self.authority.credentials(subject, alternative_names))
        self.addCleanup(client.channel.close)
        return client

    def assert_serves(self, client=None, **options):
        super().assert_serves(client or self.holder("/CN=anna"), **options)


class Certificates(CertificateCase):
    """A name of the certificate identifies a client, in the order URI, e-mail, DNS, common name."""

    def test_nameless_certificates_are_refused(self):
        for subject, names in (("/O=anna", ""), ("/O=anna", "IP:127.0.0.1"), ("/", "")):
            for method in protocol.methods():
                self.assert_code(self.holder(subject, names).call(method, b""), "UNAUTHENTICATED")
        self.assert_serves()

    def test_each_kind_of_name_identifies(self):
        kinds = [("/O=x", "URI:spiffe://example.org/anna"), ("/O=x", "email:anna@example.org"), ("/O=x", "DNS:anna"),
                 ("/CN=anna", "")]
        stranger = self.holder("/CN=stranger")
        for subject, names in kinds:
            with self.subTest(subject=subject, names=names):
                owner = self.holder(subject, names)
                job_id = self.check_strangers(owner, stranger)
                self.assertEqual(self.holder(subject, names).ids(), [job_id], "an equal name is the same client")
        for subject, names in kinds:
            self.assertEqual(len(self.holder(subject, names).ids()), 1, "equal words of another kind are another client")

    def test_the_order_of_names(self):
        """The first name in the order URI, e-mail, DNS, common name counts, and the others are ignored."""
        job_id = self.submit(self.holder("/CN=anna"))
        for names in ("DNS:else", "email:else@example.org", "URI:spiffe://example.org/else"):
            self.assertEqual(self.holder("/CN=anna", names).ids(), [], f"{names} is another client than /CN=anna")
        self.assertEqual(self.holder("/CN=anna", "IP:127.0.0.1").ids(), [job_id])

    def test_certificates_of_another_authority(self):
        other = Authority()
        self.addCleanup(other.remove)
        pair = other.credentials("/CN=anna")
        with Client(self.server, None, pair) as client:
            self.assert_code(client.call("Describe", b"", timeout=5), "UNAVAILABLE", "DEADLINE_EXCEEDED")
        with Client(self.server, None, self.authority.credentials()) as client:
            self.assert_code(client.call("Describe", b"", timeout=5), "UNAVAILABLE", "DEADLINE_EXCEEDED")
        self.assert_serves()


class TokensAndCertificates(CertificateCase):
    """With tokens, the name of the token counts. A certificate alone, or a token alone, gives no access."""

    tokens = True

    def test_the_token_counts(self):
        self.assert_code(self.holder("/CN=anna").call("Describe", b""), "UNAUTHENTICATED")
        self.check_strangers(self.holder("/CN=same", token="anna"), self.holder("/CN=same", token="berta"))
        with Client(self.server, "anna", self.authority.credentials()) as client:
            self.assert_code(client.call("Describe", b"", timeout=5), "UNAVAILABLE", "DEADLINE_EXCEEDED")
