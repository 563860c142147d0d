"""A client that was written from octopair.proto alone. It can send any bytes as messages, and records the texts of the server."""
import array
import uuid

import grpc

import protocol
from boxes import FLOATS, pairs_in
from server import TOKENS

PIECE_BYTES = 1 << 20  # of data in an Upload
CALL_SECONDS = 60


class Answer:
    """The outcome of a call: `code` and `text` of its status, `failure` (or None), and the `messages`."""

    def __init__(self, method, raw, error=None):
        self.raw = raw
        self.messages = [method.answer.FromString(one) for one in raw]
        self.code = error.code() if error else grpc.StatusCode.OK
        self.text = (error.details() or "") if error else ""
        self.failure = _failure_in(error) if error else None

    def limit(self):
        """Returns the name of the limit that the call exceeded, or an empty text."""
        return self.failure.limit if self.failure else ""

    def pairs(self):
        """Returns the pairs of all messages."""
        return pairs_in(b"".join(message.pairs for message in self.messages))

    def __str__(self):
        return f"{self.code.name} {self.text!r} limit={self.limit()!r}, {len(self.messages)} messages"


def _failure_in(error):
    for key, value in error.trailing_metadata() or ():
        if key == "grpc-status-details-bin":
            return protocol.messages().Failure.FromString(value)
    return None


def bytes_of(request):
    """Returns the bytes of a message. Bytes are returned unchanged."""
    return request if isinstance(request, bytes) else request.SerializeToString()


class Client:
    """A client with a connection of its own. `token` is the name of a token in TOKENS, or None."""

    def __init__(self, server, token="anna", credentials=None):
        self._server = server
        self.metadata = [("authorization", f"Bearer {TOKENS[token]}")] if token else []
        options = [("grpc.use_local_subchannel_pool", 1), ("grpc.max_receive_message_length", -1)]
        target = server.address
        self.channel = (grpc.secure_channel(target, credentials, options) if credentials
                        else grpc.insecure_channel(target, options))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.channel.close()

    def open(self, name, requests, timeout=CALL_SECONDS, **options):
        """Starts a call and returns gRPC's object of the call. `requests` is a message, or an iterator of a stream's messages."""
        method = protocol.methods()[name]
        kind = {(False, False): self.channel.unary_unary, (False, True): self.channel.unary_stream,
                (True, False): self.channel.stream_unary, (True, True): self.channel.stream_stream}
        make = kind[method.requests_stream, method.answers_stream](method.path)
        options.setdefault("metadata", self.metadata)
        if not method.answers_stream:
            make = make.future
        return make(requests if method.requests_stream else requests[0], timeout=timeout, **options)

    def call(self, name, *requests, **options):
        """Makes a call with these messages, each a message object or bytes. Returns its Answer."""
        raw = [bytes_of(request) for request in requests]
        return self.finish(name, self.open(name, iter(raw) if protocol.methods()[name].requests_stream else raw, **options))

    def finish(self, name, call):
        """Reads a call of open() to its end. Returns its Answer."""
        method, received, error = protocol.methods()[name], [], None
        try:
            if method.answers_stream:
                received.extend(call)
            else:
                received.append(call.result())
        except grpc.RpcError as failed:
            error = failed
            self._server.texts.append((failed.details() or "").encode())
            self._server.texts.extend(value if isinstance(value, bytes) else value.encode()
                                      for _, value in failed.trailing_metadata() or ())
        self._server.texts.extend(one for one in received if len(one) < 10_000)
        return Answer(method, received, error)

    def detect_small(self, boxes, **options):
        """Runs a job by DetectSmall. Returns its Answer."""
        return self.call("DetectSmall", *uploads(boxes), **options)

    def detect(self, boxes, **options):
        """Runs a job by Detect. Returns its Answer."""
        return self.call("Detect", *uploads(boxes, id=new_id()), **options)

    def submit(self, boxes, job_id, **fields):
        """Submits a detached job. Returns the Answer."""
        return self.call("Submit", *uploads(boxes, id=job_id, **fields))

    def job(self, name, job_id, **options):
        """Makes a call about a job: Status, Cancel or Release. Returns its Answer."""
        return self.call(name, protocol.messages().JobName(id=job_id), **options)

    def wait(self, job_id, seconds=CALL_SECONDS / 2):
        """Waits for the end of a job. Returns the Answer."""
        return self.call("Wait", protocol.messages().WaitRequest(id=job_id, seconds=seconds))

    def result(self, job_id, **fields):
        """Downloads the pairs of a job. Returns the Answer."""
        return self.call("Result", protocol.messages().ResultRequest(id=job_id, **fields))

    def ids(self):
        """Returns the ids of all jobs of this client, in the order of the server."""
        found, more = [], True
        while more:
            answer = self.call("List", protocol.messages().ListRequest(after=found[-1] if found else ""))
            found += [job.id for job in answer.messages[0].jobs]
            more = answer.messages[0].more
        return found


def new_id():
    """Returns an id for a job."""
    return str(uuid.uuid4())


def spec_of(objects, **fields):
    """Returns the spec of a job of float32 boxes without paddings."""
    return protocol.messages().JobSpec(first=protocol.messages().ObjectSet(objects=objects), **fields)


def uploads(boxes, piece_bytes=PIECE_BYTES, **fields):
    """Returns the messages that upload a job. The first message has the spec and the first piece of the boxes."""
    data = boxes.tobytes() if isinstance(boxes, array.array) else boxes
    pieces = [data[at:at + piece_bytes] for at in range(0, len(data), piece_bytes)] or [b""]
    spec = spec_of(len(data) // (4 * FLOATS), **fields)
    upload = protocol.messages().Upload
    return [upload(spec=spec, data=pieces[0]), *(upload(data=piece) for piece in pieces[1:])]
