"""Files of NumPy. The reading takes every Python literal, as NumPy does; `is_plain` says which of them octopair must take, too."""
import ast
import re
import struct

from values import Refused

SIZES = {"<f4": 4, "<f8": 8, ">f4": 4, ">f8": 8}
LENGTH = "(?:0|[1-9][0-9]*)L?"
ITEM = rf" *'(?:descr' *: *'[<>]f[48]'|fortran_order' *: *(?:False|True)|shape' *: *\( *{LENGTH}(?: *, *{LENGTH})+ *(?:, *)?\)) *"
PLAIN = re.compile(rf" *\{{{ITEM},{ITEM},{ITEM}(?:, *)?\}} *\n")


def make(source):
    """Returns a valid file with few boxes or spheres."""
    shape = source.choice(((2, 6), (0, 6), (1, 4), (12, 6), (2, 1, 6), (3, 4), (10, 6)))
    descr = source.choice(("<f4", "<f4", "<f8", "<f8", ">f4", ">f8"))
    lengths = f"({', '.join(f'{length}L' for length in shape)})" if source.random() < 0.2 else shape  # Python 2 wrote 3L
    items = [f"'descr': '{descr}'", f"'fortran_order': {source.random() < 0.2}", f"'shape': {lengths}"]
    if source.random() < 0.3:
        source.shuffle(items)
    text = "{" + source.choice((", ", ",", " , ")).join(items) + source.choice((", }", ",}", "}", " }"))
    version = source.choice((1, 1, 1, 2, 3))
    head = 8 + (2 if version == 1 else 4)
    text += " " * (source.choice((-(head + len(text) + 1) % 64, 0, 5))) + "\n"
    count = 1
    for length in shape:
        count *= length
    length = struct.pack("<H" if version == 1 else "<I", len(text))
    return b"\x93NUMPY" + bytes((version, 0)) + length + text.encode() + bytes(count * SIZES[descr])


def _parts(data):
    """Returns the text and where the data begin."""
    if data[:6] != b"\x93NUMPY" or len(data) < 12 or data[6] not in (1, 2, 3) or data[7] != 0:
        raise Refused
    begin = 10 if data[6] == 1 else 12
    length = int.from_bytes(data[8:begin], "little")
    if begin + length > len(data) or begin + length > 65536:
        raise Refused
    return data[begin:begin + length].decode("utf-8" if data[6] == 3 else "latin-1"), begin + length


def _without_l(text):
    """Returns the text without the L after lengths, which Python 3 does not know."""
    return re.sub(r"\([^()']*\)", lambda shape: re.sub("([0-9])L", r"\1", shape.group()), text)


def is_plain(data):
    """Returns whether octopair must take the file if read() does."""
    return bool(PLAIN.fullmatch(_parts(data)[0]))


def read(data):
    """Returns the type and order of the array, its kind, and its numbers of frames and objects."""
    try:
        text, begin = _parts(data)
        fields = ast.literal_eval(_without_l(text))
    except (SyntaxError, ValueError, MemoryError, RecursionError, UnicodeDecodeError) as error:
        raise Refused from error
    if not isinstance(fields, dict) or set(fields) != {"descr", "fortran_order", "shape"} or not text.endswith("\n"):
        raise Refused
    shape, descr = fields["shape"], fields["descr"]
    lengths_are_whole = isinstance(shape, tuple) and all(type(length) is int and 0 <= length < 1 << 64 for length in shape)
    if not lengths_are_whole or descr not in SIZES or not isinstance(fields["fortran_order"], bool):
        raise Refused
    is_boxes = len(shape) == 2 and shape[1] in (4, 6)
    is_moving = len(shape) == 3 and shape[2] == 6 and shape[0] <= 1000000
    count = SIZES[descr]
    for length in shape:
        count *= length
    if not (is_boxes or is_moving) or begin + count != len(data):
        raise Refused
    kind = "moving" if is_moving else "spheres" if shape[1] == 4 else "boxes"
    frames, objects = (shape[0], shape[1]) if is_moving else (1, shape[0])
    return [descr, "F" if fields["fortran_order"] else "C", kind, str(frames), str(objects), str(begin)]
