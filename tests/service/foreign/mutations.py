"""Mutations of messages: random changes of their bytes, which a seed repeats."""
import struct

import google.protobuf.message

# Encoded integers: 0, 2^64 - 1, 2^63, 2^32 - 1, 2^31 - 1.
EXTREME_NUMBERS = (b"\x00", b"\xff" * 9 + b"\x01", b"\x80" * 9 + b"\x01", b"\xff\xff\xff\xff\x0f", b"\xff\xff\xff\xff\x07")
EXTREME_DOUBLES = (float("nan"), float("inf"), float("-inf"), -0.0, -1.0, 1e308, 5e-324)


def _flip(generator, data):
    at = generator.randrange(len(data))
    data[at] ^= 1 << generator.randrange(8)


def _truncate(generator, data):
    del data[generator.randrange(len(data)):]


def _insert(generator, data):
    at = generator.randrange(len(data) + 1)
    data[at:at] = generator.randbytes(generator.randrange(1, 9))


def _delete(generator, data):
    at = generator.randrange(len(data))
    del data[at:at + generator.randrange(1, 9)]


def _repeat(generator, data):
    """Repeats a part: if it is a field, the field occurs twice."""
    fields = field_bounds(bytes(data)) or [(0, len(data))]
    begin, end = generator.choice(fields)
    data[end:end] = data[begin:end] * generator.choice((1, 1, 2, 50))


def _swap(generator, data):
    """Moves a field to another place."""
    fields = field_bounds(bytes(data)) or [(0, len(data))]
    begin, end = generator.choice(fields)
    field = data[begin:end]
    del data[begin:end]
    at = generator.choice(fields)[0] if begin else len(data)
    data[at:at] = field


def _change_length(generator, data):
    """Changes the byte after a tag: mostly the length of a field."""
    fields = field_bounds(bytes(data)) or [(0, len(data))]
    at = min(generator.choice(fields)[0] + 1, len(data) - 1)
    data[at] = generator.choice((0, 1, 0x7F, 0x80, 0xFF, data[at] ^ 1, (data[at] + 1) % 256))


def _large_number(generator, data):
    """Adds a field with an extreme number."""
    data += bytes([generator.randrange(1, 16) << 3]) + generator.choice(EXTREME_NUMBERS)


def _extreme_double(generator, data):
    """Adds a field with an extreme float64."""
    data += bytes([generator.randrange(1, 16) << 3 | 1]) + struct.pack("<d", generator.choice(EXTREME_DOUBLES))


CHANGES = (_flip, _flip, _truncate, _insert, _delete, _repeat, _swap, _change_length, _large_number, _extreme_double)


def mutated(generator, data):
    """Returns a copy of the bytes with 1 to 4 changes."""
    changed = bytearray(data)
    for _ in range(generator.choice((1, 1, 1, 2, 4))):
        change = generator.choice(CHANGES) if changed else _insert
        change(generator, changed)
    return bytes(changed)


def _varint_end(data, at):
    while at < len(data) and data[at] & 0x80:
        at += 1
    return at + 1


def _varint(data, at):
    number = shift = 0
    while at < len(data):
        number |= (data[at] & 0x7F) << shift
        if not data[at] & 0x80:
            break
        at, shift = at + 1, shift + 7
    return number


def field_bounds(data):
    """Returns (begin, end) of each field of a message, as far as the bytes can be read as fields."""
    bounds, at = [], 0
    while at < len(data):
        begin, kind, at = at, data[at] & 7, _varint_end(data, at)
        if kind == 0:
            at = _varint_end(data, at)
        elif kind == 2:
            at = _varint_end(data, at) + _varint(data, at)
        elif kind in (1, 5):
            at += 8 if kind == 1 else 4
        else:
            break
        if at > len(data):
            break
        bounds.append((begin, at))
    return bounds


def is_malformed(message_class, data):
    """Returns whether protobuf cannot parse the bytes."""
    try:
        message_class.FromString(data)
        return False
    except (google.protobuf.message.DecodeError, UnicodeDecodeError):
        return True
