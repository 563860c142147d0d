"""What an independent reading of a file gives: the words of values.hpp, or Refused."""
import math
import struct


class Refused(Exception):
    """The file is not valid."""


def number(value):
    """Word of a float64."""
    return f"d{struct.pack('>d', value + 0.0).hex()}"


def computed(value):
    """Word of a float64 that was computed; rounding may differ."""
    return f"~{struct.pack('>d', value + 0.0).hex()}"


def text(value):
    """Word of a text, given as str or bytes."""
    return "t" + (value if isinstance(value, bytes) else value.encode()).hex()


def same_words(first, second):
    return len(first) == len(second) and all(a == b or _nearly(a, b) for a, b in zip(first, second))


def _nearly(first, second):
    if first[:1] != "~" or second[:1] != "~":
        return False
    a, b = (struct.unpack(">d", bytes.fromhex(word[1:]))[0] for word in (first, second))
    return math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-12)


def finite(digits):
    """Returns the number that decimal digits give. Raises: Refused, if float64 has no such number."""
    value = float(digits)
    mantissa = digits.lower().split("e")[0]
    if math.isinf(value) or (value == 0 and any(digit in mantissa for digit in "123456789")):
        raise Refused
    return value
