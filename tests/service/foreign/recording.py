"""Recordings: the messages of a scene (docs/formats.md, "Recordings")."""
import contextlib
import struct
import threading

import protocol

MASK = (1 << 64) - 1
SEED = 0x9E3779B97F4A7C15
ADD, STEP = 1, 6


def checksum(data):
    """Returns the checksum of bytes that recordings have."""
    words = struct.unpack(f"<{(len(data) + 7) // 8}Q", data + bytes(-len(data) % 8))
    state = SEED
    for word in (*words, len(data)):
        state = (state ^ word) * SEED & MASK
        state ^= state >> 32
    return state


def head(margin=0.0):
    """Returns the head of a recording of float32 boxes."""
    data = b"\x93OCTOREC" + struct.pack("<IId", 1, 32, margin)
    return data + struct.pack("<Q", checksum(data))


def record(kind, payload=b""):
    """Returns a record."""
    check = checksum(struct.pack("<IIQ", kind, 0, len(payload))) & 0xFFFFFFFF
    data = struct.pack("<IIQ", kind, check, len(payload)) + payload
    return data + struct.pack("<Q", checksum(data))


def add(boxes):
    """Returns the record that adds boxes without paddings and traits."""
    return record(ADD, struct.pack("<III", len(boxes) // 6, 0, 0) + boxes.tobytes())


def scene_uploads(boxes):
    """Returns the messages of a scene that adds boxes and makes one step."""
    upload = protocol.messages().SceneUpload
    return [upload(calls=head() + add(boxes)), upload(calls=record(STEP))]


@contextlib.contextmanager
def running_scene(client, boxes):
    """Runs a scene of these boxes, which has made a step, until the block ends. Gives its id. The client has no other scene."""
    end = threading.Event()

    def uploads():
        yield from (one.SerializeToString() for one in scene_uploads(boxes))
        end.wait()

    call = client.open("Scene", uploads(), timeout=None)
    try:
        next(call)
        reports = client.call("ListScenes", protocol.messages().ListScenesRequest()).messages[0].scenes
        yield reports[0].id
    finally:
        end.set()
        call.cancel()
