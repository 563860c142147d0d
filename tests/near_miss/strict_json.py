"""Reads JSON as RFC 8259 has it, in UTF-8, without repeated keys and without numbers beyond float64."""
import json
import math

from values import Refused

LEVELS = 16


class Signed(int):
    """A whole number that is written with a sign."""


def _whole(digits):
    try:
        value = int(digits)
        float(value)
    except (ValueError, OverflowError) as error:
        raise Refused from error
    return Signed(value) if digits[0] == "-" else value


def _decimal(digits):
    value = float(digits)
    if math.isinf(value):
        raise Refused
    return value


def _constant(_):
    raise Refused


def _once(pairs):
    if len({key for key, _ in pairs}) != len(pairs):
        raise Refused
    return dict(pairs)


def _check(value, level=0):
    """Refuses deep values, and texts with half a surrogate pair."""
    if isinstance(value, str):
        value.encode()  # raises UnicodeEncodeError, which is a ValueError
    if isinstance(value, (list, dict)):
        if level >= LEVELS:
            raise Refused
        for item in value:
            _check(item, level + 1)
    if isinstance(value, dict):
        for item in value.values():
            _check(item, level + 1)


def load(data):
    """Returns the value of a file. Raises: Refused."""
    try:
        text = data.removeprefix(b"\xef\xbb\xbf").decode()
        value = json.loads(text, parse_int=_whole, parse_float=_decimal, parse_constant=_constant, object_pairs_hook=_once)
        _check(value)
    except (ValueError, RecursionError) as error:
        raise Refused from error
    return value


def write(source, value):
    """Returns a file with the value, written in one of the usual ways."""
    indent = source.choice((None, None, 1, 2))
    text = json.dumps(value, indent=indent, ensure_ascii=source.random() < 0.5, separators=source.choice(((",", ":"), (", ", ": "))))
    return source.choice((b"", b"", b"", b"", b"\xef\xbb\xbf")) + text.encode() + source.choice((b"", b"\n", b"\r\n"))


def fields(value, allowed, required=()):
    """Returns an object that has only allowed keys, and all required ones."""
    if not isinstance(value, dict) or not set(value) <= set(allowed) or not set(required) <= set(value):
        raise Refused
    return value


def text(value):
    if not isinstance(value, str):
        raise Refused
    return value


def array(value, length=None):
    if not isinstance(value, list) or length not in (None, len(value)):
        raise Refused
    return value


def number(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Refused
    return float(value)


def whole(value, most=4294967295):
    if type(value) is not int or not 0 <= value <= most:
        raise Refused
    return value
