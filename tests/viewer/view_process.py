"""Runs `octopair view`, and reads its server by HTTP and WebSocket from raw sockets. Standard library only."""
import base64
import errno
import gzip
import json
import os
import re
import select
import socket
import struct
import subprocess

TIMEOUT = 10  # seconds for each answer


class ViewProcess:
    """A running `octopair view`. Its address is in `host` and `port`."""

    def __init__(self, program, arguments, limit_files=None):
        def limit():
            import resource
            resource.setrlimit(resource.RLIMIT_NOFILE, (limit_files, limit_files))
        self.process = subprocess.Popen([program, 'view', *arguments, '--no-browser', '--quiet'], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, preexec_fn=limit if limit_files else None)
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT)
        self.line = self.process.stdout.readline().decode().strip() if ready else ''
        found = re.fullmatch(r'http://([^/]+):(\d+)/(?:\?token=(\w+))?', self.line)
        if not found:
            self.process.kill()
            raise RuntimeError(f'no address: {self.line!r} {self.process.communicate()}')
        self.host, self.port, self.token = found[1], int(found[2]), found[3]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.is_alive():
            self.process.terminate()
        try:
            self.process.wait(TIMEOUT)
        finally:
            self.process.kill()
            self.process.stdout.close()
            self.errors = self.process.stderr.read().decode()
            self.process.stderr.close()

    @property
    def endpoint(self):
        return f'{self.host}:{self.port}'

    def is_alive(self):
        return self.process.poll() is None

    def memory(self):
        """Returns the resident memory in bytes."""
        with open(f'/proc/{self.process.pid}/status', encoding='utf-8') as status:
            return int(re.search(r'VmRSS:\s+(\d+) kB', status.read())[1]) * 1024

    def files(self):
        return len(os.listdir(f'/proc/{self.process.pid}/fd'))

    def connect(self):
        return socket.create_connection((self.host, self.port), TIMEOUT)

    def send(self, data):
        """Sends bytes on a new connection, and returns all that the server answers until it closes."""
        with self.connect() as connection:
            try:
                connection.sendall(data)
                return read_all(connection)
            except ConnectionError:
                return b''

    def request(self, target='/', method='GET', headers=(), host=None):
        """Returns status, headers and body of an answer."""
        lines = [f'{method} {target} HTTP/1.1', f'Host: {self.endpoint if host is None else host}', *headers,
                 'Connection: close', '', '']
        return parsed(self.send('\r\n'.join(lines).encode('latin-1')))

    def get(self, address):
        """Returns the body of a good answer; JSON is decoded."""
        status, headers, body = self.request('/' + address)
        if status != 200:
            raise AssertionError(f'{address}: {status} {body!r}')
        return json.loads(body) if headers['content-type'] == 'application/json' else body


def send_and_end(connection, data):
    """Sends data and ends this direction. The server may end the connection before it has read everything."""
    try:
        connection.sendall(data)
        connection.shutdown(socket.SHUT_WR)
    except OSError as error:
        if error.errno not in (errno.ECONNRESET, errno.EPIPE, errno.ENOTCONN):
            raise


def read_all(connection):
    parts = []
    try:
        while part := connection.recv(1 << 20):
            parts.append(part)
    except ConnectionError:
        pass
    return b''.join(parts)


def parsed(answer):
    """Splits an answer of HTTP. Status 0: no answer."""
    head, _, body = answer.partition(b'\r\n\r\n')
    if not head:
        return 0, {}, b''
    lines = head.decode('latin-1').split('\r\n')
    headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(':') for line in lines[1:])}
    if headers.get('content-encoding') == 'gzip':
        body = gzip.decompress(body)
    return int(lines[0].split()[1]), headers, body


class WebSocket:
    """A client that can also break the protocol."""

    def __init__(self, view, path='/socket', headers=(), host=None):
        self.connection = view.connect()
        lines = [f'GET {path} HTTP/1.1', f'Host: {host or view.endpoint}', 'Upgrade: websocket', 'Connection: Upgrade',
                 f'Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}', 'Sec-WebSocket-Version: 13',
                 *headers, '', '']
        self.connection.sendall('\r\n'.join(lines).encode('latin-1'))
        self.rest = b''
        while b'\r\n\r\n' not in self.rest:
            part = self.connection.recv(65536)
            if not part:
                break
            self.rest += part
        head, _, self.rest = self.rest.partition(b'\r\n\r\n')
        self.status = int(head.split()[1]) if head else 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.connection.close()

    def send(self, payload, opcode=1, fin=True, masked=True, length=None):
        """Sends a frame. `length`: announced in place of the true length, with eight bytes."""
        head = bytes([(0x80 if fin else 0) | opcode])
        size = len(payload)
        mask_bit = 0x80 if masked else 0
        if length is not None:
            head += bytes([mask_bit | 127]) + struct.pack('>Q', length)
        elif size < 126:
            head += bytes([mask_bit | size])
        elif size < 65536:
            head += bytes([mask_bit | 126]) + struct.pack('>H', size)
        else:
            head += bytes([mask_bit | 127]) + struct.pack('>Q', size)
        mask = os.urandom(4) if masked else b''
        if masked:
            payload = bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))
        self.connection.sendall(head + mask + payload)

    def take(self, count):
        while len(self.rest) < count:
            part = self.connection.recv(1 << 20)
            if not part:
                raise ConnectionError('closed')
            self.rest += part
        taken, self.rest = self.rest[:count], self.rest[count:]
        return taken

    def read(self):
        """Returns opcode and payload of the next frame."""
        first, second = self.take(2)
        length = second & 127
        if length == 126:
            length = struct.unpack('>H', self.take(2))[0]
        elif length == 127:
            length = struct.unpack('>Q', self.take(8))[0]
        return first & 15, self.take(length)

    def is_ended(self):
        """Reads on. Returns whether the server closes the connection."""
        try:
            while self.read()[0] != 8:
                pass
        except ConnectionError:
            pass
        except TimeoutError:
            return False
        return True
