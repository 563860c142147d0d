"""CSV files with boxes, by docs/formats.md."""
import re

from values import Refused, finite, number

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eEdD][+-]?[0-9]+)?")
NOT_FINITE = re.compile(r"[+-]?(?:inf|infinity|nan(?:\([A-Za-z0-9_]*\))?)", re.IGNORECASE)


def _decimal(source):
    value = source.choice((source.uniform(-9, 9), source.randrange(-20, 20), source.uniform(-1, 1) * 10.0**source.randrange(-30, 30)))
    written = source.choice((repr(value), f"{value:.3g}", f"{value:e}", f"{value:.2f}"))
    if source.random() < 0.1:
        written = written.replace("e", "D")
    if source.random() < 0.1:
        return f'"{written}"'
    return written.replace("0.", ".", 1) if written.startswith("0.") and source.random() < 0.2 else written


def make(source):
    """Returns a valid file."""
    end = source.choice(("\n", "\n", "\n", "\r\n", "\r"))
    comma = source.choice((",", ",", ", ", "\t,", " , "))
    lines = [comma.join(("min x", "min y", "min z", "max x", "max y", "max z"))] if source.random() < 0.4 else []
    for _ in range(source.randrange(4)):
        lines.append(comma.join(source.choice(("", "", "", "+")) * (field[0] not in '-"') + field for field in [_decimal(source) for _ in range(6)]))
        if source.random() < 0.1:
            lines.append(source.choice(("", " ", "\t")))
    text = end.join(lines) + source.choice((end, end, ""))
    return source.choice((b"", b"", b"", b"\xef\xbb\xbf")) + text.encode()


def _value(field):
    return None if NOT_FINITE.fullmatch(field) else finite(re.sub("[dD]", "e", field))


def _fields(line):
    """Returns the fields of a line. A comma in quotes separates none."""
    fields, quoted = [""], False
    for character in line:
        quoted ^= character == '"'
        if character == "," and not quoted:
            fields.append("")
        else:
            fields[-1] += character
    fields = [field.strip(" \t") for field in fields]
    return [field[1:-1].strip(" \t") if len(field) > 1 and field[0] == field[-1] == '"' else field for field in fields]


def _is_header(fields):
    """Returns whether some fields are not empty, and in none the first letter or digit is a digit."""
    first = [re.search("[A-Za-z0-9]", field) for field in fields]
    return any(fields) and not any(found and found.group().isdigit() for found in first)


def read(data):
    """Returns the numbers of all boxes."""
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    words = []
    for i, line in enumerate(re.split("\r\n|\r|\n", text)):
        if not line.strip(" \t"):
            continue
        fields = _fields(line)
        if len(fields) != 6:
            raise Refused
        numbers = [bool(NUMBER.fullmatch(field) or NOT_FINITE.fullmatch(field)) for field in fields]
        if i == 0 and not any(numbers) and _is_header(fields):
            continue
        if not all(numbers):
            raise Refused
        values = [_value(field) for field in fields]
        if None in values:
            raise Refused
        words += [number(value) for value in values]
    return words
