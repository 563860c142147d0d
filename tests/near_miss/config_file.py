"""Configuration files, by docs/server.md. The options are those of option_readers.cpp."""
import re

from option_values import Bytes, Length, Threads
from values import Refused, number, text

LINE = re.compile(rb"""[ \t]*(?:(?P<name>[a-z0-9-]+)[ \t]*=[ \t]*
                       (?:"(?P<double>[^"\\]*)"[ \t]*|'(?P<single>[^']*)'[ \t]*|(?P<word>[^ \t"'\#,;=\[\]{}]+)(?:[ \t]+|$))
                       (?:\#.*)?|\#.*)?""", re.VERBOSE | re.DOTALL)
CONTROL = re.compile(rb"[\0-\x08\x0a-\x1f\x7f]")


def _choice(*words):
    def value(data):
        if data not in words:
            raise Refused
        return data
    return value


def _text(data):
    if not data:
        raise Refused
    return data


VALUES = {b"listen": _text, b"state": _text, b"log": _choice(b"text", b"json"), b"threads": Threads.value, b"max-memory": Bytes.value,
          b"grace": Length.value, b"quiet": _choice(b"true", b"false")}


def _written(source, value):
    ways = [value.join(quotes) for quotes in ('""', "''")]
    if re.fullmatch(r"[\w./:-]+", value):
        ways += [value] * 2
    return source.choice(ways)


def make(source):
    """Returns a valid file."""
    values = {"listen": source.choice(("127.0.0.1:7788", "unix:/run/a b/socket", "systemd", "[::1]:80", "{}")), "state": source.choice(("jobs", "/var/lib/ö", "a b")),
              "log": source.choice(("text", "json")), "threads": str(source.randrange(65)), "max-memory": source.choice(("8G", "65536", "0")),
              "grace": source.choice(("30", "1.5", "0")), "quiet": source.choice(("true", "false"))}
    lines = []
    for name in source.sample(sorted(values), source.randrange(5)):
        if source.random() < 0.2:
            lines.append(source.choice(("", "# limits", "\t# 'x' = \"y", "#quiet = true", "  ")))
        end = source.choice(("", "", "", " ", " # why", "\t#"))
        lines.append(source.choice(("", "", " ")) + name + source.choice((" = ", "=", "\t=  ")) + _written(source, values[name]) + end)
    line_end = source.choice(("\n", "\n", "\r\n"))
    return (line_end.join(lines) + source.choice((line_end, line_end, ""))).encode()


def read(data):
    """Returns the values of all options."""
    found = {}
    for line in data.split(b"\n"):
        line = line.removesuffix(b"\r")
        match = LINE.fullmatch(line)
        if not match or CONTROL.search(line):
            raise Refused
        name = match["name"]
        if name is None:
            continue
        if name in found or name not in VALUES:
            raise Refused
        found[name] = VALUES[name](next(match[way] for way in ("double", "single", "word") if match[way] is not None))
    words = [text(found.get(name, b"none")) for name in (b"listen", b"state", b"log")]
    return words + [str(found.get(b"threads", 0)), str(found.get(b"max-memory", 0)), number(found.get(b"grace", 0.0)),
                    found.get(b"quiet", b"false").decode()]
