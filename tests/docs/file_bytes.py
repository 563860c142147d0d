"""Compares the bytes of a file with lines of a page that show and explain them.

    0..5      93 "NUMPY"           magic
    8..9      76 00                length of the text
    66..126   20 x61               spaces
    127       0A                   newline
    136..143  ?                    checksum

A line has the positions of the first and the last byte, then the bytes, then two spaces or more and an explanation. Bytes are
hexadecimal numbers and texts in double quotes; `BYTE xN` is N equal bytes; `?` stands for any bytes. The lines cover the file
without a gap. `end` is the last position of the file.
"""
import re

LINE = re.compile(r"^(\d+)(?:\.\.(\d+|end))? +(.+?)(?:  +.*)?$")
TOKEN = re.compile(r'"([^"]*)"|([0-9A-F]{2}) x(\d+)|([0-9A-F]{2})|(\?)| +')


class Difference(Exception):
    def __init__(self, line, message):
        super().__init__(message)
        self.line = line


def bytes_of(text):
    """Returns the bytes that a line shows, or None for any bytes."""
    made, at = b"", 0
    while at < len(text):
        token = TOKEN.match(text, at)
        if token is None:
            raise ValueError(f"not bytes: {text[at:]}")
        if token[5]:
            return None
        made += (token[1].encode() if token[1] is not None else bytes([int(token[2], 16)]) * int(token[3]) if token[2]
                 else bytes([int(token[4], 16)]) if token[4] else b"")
        at = token.end()
    return made


def check(lines, data):
    """Raises Difference, with the number of the line, unless the lines show the data."""
    next_position = 0
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        parts = LINE.match(line)
        if parts is None:
            raise Difference(number, f"not a line of bytes: {line}")
        first = int(parts[1])
        last = len(data) - 1 if parts[2] == "end" else int(parts[2] or first)
        if first != next_position or last < first or last >= len(data):
            raise Difference(number, f"bytes {first} to {last}, but the next is {next_position} of {len(data)}")
        try:
            shown = bytes_of(parts[3])
        except ValueError as error:
            raise Difference(number, str(error)) from None
        if shown is not None and shown != data[first:last + 1]:
            raise Difference(number, f"bytes {first} to {last} are {data[first:last + 1].hex(' ').upper()}")
        next_position = last + 1
    if next_position != len(data):
        raise Difference(len(lines), f"bytes from {next_position} to {len(data) - 1} are not shown")
