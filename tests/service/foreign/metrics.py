"""The page of metrics that `octopair serve --metrics` serves."""
import re
import socket
import urllib.request


def free_port():
    """Returns a TCP port that no process uses at the moment."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def page(port, seconds=20):
    """Returns the text of the page. Raises OSError if it does not arrive within `seconds`."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=seconds) as answer:
        return answer.read().decode()


def metric(port, name):
    """Returns the value of a metric without labels."""
    return float(re.search(rf"^{name} (\S+)$", page(port), re.MULTILINE).group(1))
