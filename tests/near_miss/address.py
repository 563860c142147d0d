"""Addresses of servers, by docs/server.md."""
import ipaddress
import re

from values import Refused, text

PLACE = re.compile(rb"(?:\[(?P<wide>[0-9A-Fa-f:.]+)(?P<zone>%[A-Za-z0-9._-]+)?\]|(?P<name>[A-Za-z0-9._-]+)):(?P<port>[0-9]{1,5})")


def make(source):
    """Returns a valid address."""
    port = source.choice((0, 80, 7788, 65535))
    host = source.choice(("127.0.0.1", "0.0.0.0", "localhost", "pairs.example.org", "db-1", "my_host", "[::1]", "[fe80::1%eth0]", "[2001:db8::8:800]",
                          "10.1.200.30", "[::ffff:1.2.3.4]", "192.168.0.1.nip.io"))
    return source.choice((f"{host}:{port}", f"{host}:{port}", "unix:" + source.choice(("/run/octopair/socket", "a b", "x:80", "tür"))) ).encode()


def _check(host, family):
    try:
        family(host.decode())
    except ValueError as error:
        raise Refused from error


def read(data):
    """Returns path, host and port."""
    if data.startswith(b"unix:"):
        path = data[5:]
        if not 1 <= len(path) <= 107 or b"\0" in path:
            raise Refused
        return [text(path), text(""), text("")]
    match = PLACE.fullmatch(data)
    if not match or int(match["port"]) > 65535:
        raise Refused
    host = match["name"] or match["wide"] + (match["zone"] or b"")
    if match["wide"]:
        _check(match["wide"], ipaddress.IPv6Address)
    elif re.fullmatch(rb"(?:[0-9]+|0[xX][0-9A-Fa-f]*)", host.removesuffix(b".").rsplit(b".")[-1]):
        _check(host, ipaddress.IPv4Address)  # functions of the system would read 127.1 and 0x7f.0.0.1, too
    return [text(""), text(host), text(match["port"])]
