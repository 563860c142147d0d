"""Role files of servers, by docs/server.md."""
import re

from values import Refused, text

WORD = re.compile(rb'"((?:[^"\\]|\\["\\])+)"|([^ \t"]+)')
LINE = re.compile(rb'[ \t]*(?:#.*|(?P<words>(?:(?:"(?:[^"\\]|\\["\\])+"|[^ \t"#][^ \t"]*)(?:[ \t]+(?:"(?:[^"\\]|\\["\\])+"|[^ \t"]+))*))[ \t]*)?', re.DOTALL)
CLIENT = re.compile(rb"local|(?:token|certificate(?:-uri|-email|-dns)?):.+", re.DOTALL)
NAMES = ("token:anna", "token:dashboard", "certificate:Carl Smith", 'certificate:a "b" \\c', "certificate-uri:spiffe://x/y", "certificate-email:a@b.org",
         "certificate-dns:a.example.org", "local", "token:tür")


def _written(source, name):
    if source.random() < 0.8 and not re.search(r'[ "]', name):
        return name
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'


def make(source):
    """Returns a valid file."""
    lines = []
    for name in source.sample(NAMES, source.randrange(1, 4)):
        if source.random() < 0.2:
            lines.append(source.choice(("# who", "", "\t# \"x", "  ")))
        role = source.choice(("owner", "operator", "none", "reader " + _written(source, source.choice(NAMES))))
        lines.append(source.choice(("", "", " ")) + _written(source, name) + source.choice((" ", "\t", "    ")) + role + source.choice(("", "", " ")))
    end = source.choice(("\n", "\n", "\r\n"))
    return (end.join(lines) + source.choice((end, end, ""))).encode()


def _words(line):
    match = LINE.fullmatch(line)
    if not match or re.search(rb"[\0-\x08\x0a-\x1f\x7f]", line):
        raise Refused
    return [re.sub(rb'\\(["\\])', rb"\1", quoted) if quoted else plain for quoted, plain in WORD.findall(match["words"] or b"")]


def read(data):
    """Returns the clients in the order of their names, with role and owner."""
    clients = {}
    for line in data.split(b"\n"):
        words = _words(line.removesuffix(b"\r"))
        if not words:
            continue
        name, role, *owner = words if len(words) > 1 else (*words, b"")
        known = len(owner) == 1 if role == b"reader" else role in (b"owner", b"operator", b"none") and not owner
        if not known or not all(CLIENT.fullmatch(one) for one in (name, *owner)) or name in clients:
            raise Refused
        clients[name] = [text(name), role.decode(), text(owner[0] if owner else b"")]
    return [word for name in sorted(clients) for word in clients[name]]
