"""Token files of clients, by docs/server.md: a token, and blanks or ends of lines around it."""
import re

from values import Refused, text


def make(source):
    """Returns a valid file."""
    token = "".join(source.choice("0123456789abcdefXYZ+/=.-") for _ in range(source.choice((16, 64))))
    return (token + source.choice(("", "", "\n", "\r\n", " "))).encode()


def read(data):
    """Returns the token."""
    token = data.strip(b" \t\r\n")
    if not re.fullmatch(rb"[!-~]+", token):
        raise Refused
    return [text(token)]
