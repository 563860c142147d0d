"""Damages a file by one edit, such as a slip of the hand, of an editor or of a transfer makes."""

# Bytes that parsers often treat specially: signs, quotes, separators, blanks of other kinds, ends of lines, marks of encodings.
SPECIAL = (b"\0", b"\r", b"\n", b"\r\n", b"\t", b" ", b"\v", b"\f", b"\x1a", b"\x7f", b"\x85", b"\xff", b"\xef\xbb\xbf", b"\xc2\xa0", b"\xe2\x88\x92",
           b"\xe2\x80\x9c", b"\xef\xbc\x91", b"'", b'"', b"\\", b"+", b"-", b"--", b".", b",", b";", b":", b"=", b"#", b"//", b"/*", b"_", b"%", b"@", b"/",
           b"(", b")", b"[", b"]", b"{", b"}", b"<", b"0", b"00", b"0x", b"1", b"9", b"e", b"e9", b"e999", b"e-999", b"E", b"L", b"f", b"K", b"j",
           b"nan", b"NaN", b"inf", b"Infinity", b"null", b"true", b"None", b"a", b"z", b"\\u0000", b"\\ud800", b"\\n")
DIGITS = b"0123456789"


def _lines(data):
    return data.splitlines(keepends=True) or [b""]


def _at(source, data):
    return source.randrange(len(data)) if data else 0


def _place(source, data, wanted):
    """Returns a random position of a byte that is wanted, or of any byte if there is none."""
    places = [i for i, byte in enumerate(data) if byte in wanted]
    return source.choice(places) if places else _at(source, data)


def delete(source, data):
    at = _at(source, data)
    return data[:at] + data[at + 1:]


def insert(source, data):
    at = source.randrange(len(data) + 1)
    return data[:at] + source.choice(SPECIAL) + data[at:]


def replace(source, data):
    at = _at(source, data)
    return data[:at] + source.choice(SPECIAL) + data[at + 1:]


def random_byte(source, data):
    at = _at(source, data)
    return data[:at] + bytes([source.randrange(256)]) + data[at + 1:]


def swap(source, data):
    at = _at(source, data)
    return data[:at] + data[at + 1:at + 2] + data[at:at + 1] + data[at + 2:]


def double(source, data):
    at = _at(source, data)
    return data[:at + 1] + data[at:]


def duplicate_line(source, data):
    lines = _lines(data)
    at = source.randrange(len(lines))
    return b"".join(lines[:at + 1] + lines[at:])


def delete_line(source, data):
    lines = _lines(data)
    at = source.randrange(len(lines))
    return b"".join(lines[:at] + lines[at + 1:])


def swap_lines(source, data):
    lines = _lines(data)
    at = source.randrange(len(lines))
    return b"".join(lines[:at] + lines[at + 1:at + 2] + lines[at:at + 1] + lines[at + 2:])


def change_case(source, data):
    at = _place(source, data, b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
    return data[:at] + data[at:at + 1].swapcase() + data[at + 1:]


def change_digit(source, data):
    at = _place(source, data, DIGITS)
    return data[:at] + bytes([source.choice(DIGITS)]) + data[at + 1:]


def mistake_digit(source, data):
    """Writes a letter that looks like a digit, or a digit instead of a mark."""
    at = _place(source, data, DIGITS + b".,-:")
    return data[:at] + source.choice((b"O", b"l", b"o", b"5", b"3")) + data[at + 1:]


def delete_mark(source, data):
    at = _place(source, data, b"\"'{}[](),:;=# \t\r\n-.")
    return data[:at] + data[at + 1:]


def replace_mark(source, data):
    at = _place(source, data, b"\"'{}[](),:;=# \t\r\n-.")
    return data[:at] + source.choice((b"\"", b"'", b"{", b"}", b"[", b"]", b",", b":", b";", b"=", b"#", b" ", b"\t", b"\r", b"\n", b".")) + data[at + 1:]


def truncate(source, data):
    return data[:_at(source, data)]


def append(source, data):
    return data + source.choice(SPECIAL)


def prepend(source, data):
    return source.choice(SPECIAL) + data


EDITS = (delete, insert, insert, replace, replace, random_byte, swap, double, duplicate_line, delete_line, swap_lines, change_case, change_digit,
         mistake_digit, delete_mark, replace_mark, truncate, append, prepend)


def damaged(source, data):
    """Returns the data after one edit, and the name of the edit. `source` is a random.Random. The edit may leave the data as they are."""
    edit = source.choice(EDITS)
    return edit(source, data), edit.__name__
