"""CSV files with boxes, by docs/formats.md."""
import re

from values import Refused, finite, number

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
NOT_FINITE = re.compile(r"[+-]?(?:inf|infinity|nan(?:\([A-Za-z0-9_]*\))?)", re.IGNORECASE)


def _decimal(source):
    value = source.choice((source.uniform(-9, 9), source.randrange(-20, 20), source.uniform(-1, 1) * 10.0**source.randrange(-30, 30)))
    written = source.choice((repr(value), f"{value:.3g}", f"{value:e}", f"{value:.2f}"))
    return written.replace("0.", ".", 1) if written.startswith("0.") and source.random() < 0.2 else written


def make(source):
    """Returns a valid file."""
    end = source.choice(("\n", "\n", "\n", "\r\n"))
    comma = source.choice((",", ",", ", ", "\t,", " , "))
    lines = [comma.join(("min x", "min y", "min z", "max x", "max y", "max z"))] if source.random() < 0.4 else []
    for _ in range(source.randrange(4)):
        lines.append(comma.join(source.choice(("", "", "", "+")) * (field[0] != "-") + field for field in [_decimal(source) for _ in range(6)]))
        if source.random() < 0.1:
            lines.append(source.choice(("", " ", "\t")))
    text = end.join(lines) + source.choice((end, end, ""))
    return source.choice((b"", b"", b"", b"\xef\xbb\xbf")) + text.encode()


def _value(field):
    return None if NOT_FINITE.fullmatch(field) else finite(field)


def read(data):
    """Returns the numbers of all boxes."""
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    words = []
    lines = text.split("\n")
    for i, line in enumerate(lines):
        line = line.removesuffix("\r")
        if not line.strip(" \t"):
            continue
        fields = [field.strip(" \t") for field in line.split(",")]
        if len(fields) != 6:
            raise Refused
        numbers = [bool(NUMBER.fullmatch(field) or NOT_FINITE.fullmatch(field)) for field in fields]
        if i == 0 and not any(numbers):
            continue
        if not all(numbers):
            raise Refused
        values = [_value(field) for field in fields]
        if None in values:
            raise Refused
        words += [number(value) for value in values]
    return words
