"""Numbers that options have as values."""
import re

from values import Refused, finite, number

LENGTH = re.compile(rb"-?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


class Count:
    """A whole number from 0 to `most`."""

    most = 4294967295

    @staticmethod
    def make(source):
        return str(source.choice((0, 7, 64, 1024, 65536, 4294967295, source.randrange(1 << source.randrange(1, 33))))).encode()

    @classmethod
    def value(cls, data):
        if not re.fullmatch(rb"[0-9]+", data) or int(data) > cls.most:
            raise Refused
        return int(data)

    @classmethod
    def read(cls, data):
        return [str(cls.value(data))]


class Threads(Count):
    """The value of --threads."""

    most = 4096


class Bytes:
    """A number of bytes, with a suffix or without."""

    @staticmethod
    def make(source):
        return str(source.randrange(1 << source.randrange(1, 24))).encode() + source.choice((b"", b"K", b"M", b"G", b"T"))

    @staticmethod
    def value(data):
        match = re.fullmatch(rb"([0-9]+)([KMGT]?)", data)
        value = int(match[1]) << 10 * b" KMGT".index(match[2] or b" ") if match else 1 << 64
        if value >= 1 << 64:
            raise Refused
        return value

    @classmethod
    def read(cls, data):
        return [str(cls.value(data))]


class Length:
    """A finite number >= 0."""

    @staticmethod
    def make(source):
        value = source.choice((0, 3, 0.25, source.uniform(0, 9), 10.0**source.randrange(-30, 30)))
        return source.choice((repr(value), f"{value:e}", f"{value:.3g}")).encode()

    @staticmethod
    def value(data):
        if not LENGTH.fullmatch(data):
            raise Refused
        value = finite(data.decode())
        if value < 0:
            raise Refused
        return value

    @classmethod
    def read(cls, data):
        return [number(cls.value(data))]
