"""Token files of servers, by docs/server.md."""
import datetime
import hashlib
import re

from values import Refused, text

WORD = re.compile(rb"[!-~]+")
HASH = re.compile(rb"sha256:([0-9a-fA-F]{64})")
# Words that look like a hash in another form: its name and a sign, or a name with sha before many digits.
OTHER_HASH = re.compile(rb"(?:[^:=$]*[:=$][0-9a-fA-F]{32,}|sha[0-9-]{0,4}[:=$].*|sha.*[0-9a-f]{32})", re.IGNORECASE)
TIME = re.compile(rb"until=([0-9]{4})-([0-9]{2})-([0-9]{2})(?:T([0-9]{2}):([0-9]{2}):([0-9]{2})Z)?")
FIRST_YEAR, LAST_YEAR = 1970, 2261


def _hex(source, digits):
    return "".join(source.choice("0123456789abcdef") for _ in range(digits))


def make(source):
    """Returns a valid file."""
    lines = []
    for name in source.sample(("anna", "bea", "carl.smith", "tür", "r2-d2", "long_name_of_a_client"), source.randrange(1, 4)):
        if source.random() < 0.2:
            lines.append(source.choice(("# clients", "", "#anna 0123456789abcdef0123")))
        token = source.choice(("sha256:" + _hex(source, 64), "sha256:" + _hex(source, 64), _hex(source, source.choice((16, 40))), "Aw9+/" + _hex(source, 12) + "=="))
        day = f"{source.choice((1999, 2026, 2027, 2100))}-{source.randrange(1, 13):02}-{source.randrange(1, 29):02}"
        until = source.choice(("", "", f" until={day}", f" until={day}T{source.randrange(24):02}:00:59Z"))
        lines.append(f"{name}{source.choice((' ', '  ', chr(9)))}{token}{until}")
    end = source.choice(("\n", "\n", "\r\n"))
    return (end.join(lines) + source.choice((end, end, ""))).encode()


def _until(word):
    match = TIME.fullmatch(word)
    if not match:
        raise Refused
    year, month, day, *clock = (int(part or 0) for part in match.groups())
    try:
        # Years from 0 to 9999; those that Python lacks begin and end as 4 and 2000 do.
        moment = datetime.datetime(year or 4, month, day, *clock, tzinfo=datetime.timezone.utc)
    except ValueError as error:
        raise Refused from error
    if year > LAST_YEAR:
        return "late"
    if year < FIRST_YEAR:
        return "early"
    return str(int(moment.timestamp()) + (0 if match[4] else 86400))


def _digest(word):
    match = HASH.fullmatch(word)
    if match:
        return bytes.fromhex(match[1].decode())
    if not WORD.fullmatch(word) or word.startswith(b"sha256:") or OTHER_HASH.fullmatch(word) or len(word) < 16:
        raise Refused
    return hashlib.sha256(word).digest()


def read(data):
    """Returns name, digest and end of each token."""
    tokens, names, digests = [], set(), set()
    for line in data.split(b"\n"):
        found = [word for word in re.split(rb"[ \t]+", line.removesuffix(b"\r")) if word]
        if not found or found[0].startswith(b"#"):
            continue
        if len(found) not in (2, 3) or re.search(rb"[\0-\x1f\x7f]", found[0]) or found[0].startswith((b"\xef\xbb\xbf", b"token:")):
            raise Refused
        digest = _digest(found[1])
        if found[0] in names or digest in digests:
            raise Refused
        names.add(found[0])
        digests.add(digest)
        tokens += [text(found[0]), text(digest), _until(found[2]) if len(found) == 3 else "always"]
    if not tokens:
        raise Refused
    return tokens
