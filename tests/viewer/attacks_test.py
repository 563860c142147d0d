#!/usr/bin/python3
"""Attacks the server of `octopair view` and gives the command wrong inputs.

    attacks_test.py --program PATH [CLASS[.TEST]...]
"""
import contextlib
import json
import math
import os
import threading
import time

import scene_files
from view_case import InFolder, main, pairs_in
from view_process import WebSocket, parsed, read_all, send_and_end


class Access(InFolder):
    def setUp(self):
        super().setUp()
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 20))

    def test_foreign_hosts_and_origins(self):
        with self.view(self.path('boxes.npy')) as view:
            for host in ('evil.example', f'evil.example:{view.port}', '127.0.0.1', f'127.0.0.1:{view.port + 1}', '',
                         f'127.0.0.1:{view.port}.evil.example', f'localhost.evil.example:{view.port}'):
                for address in ('/', '/view.json', '/nothing'):
                    self.assertEqual(view.request(address, host=host)[0], 403, host)
                self.assert_web_socket(view, 403, host=host or 'x')
            self.assertEqual(view.request('/view.json', host=f'localhost:{view.port}')[0], 200)
            for origin in ('null', '', 'http://evil.example', f'https://{view.endpoint}', 'http://127.0.0.1',
                           f'http://127.0.0.1:{view.port + 1}', f'http://localhost:{view.port}'):
                self.assertEqual(view.request('/view.json', headers=[f'Origin: {origin}'])[0], 403, origin)
                self.assert_web_socket(view, 403, headers=[f'Origin: {origin}'])
            self.assertEqual(view.request('/view.json', headers=[f'Origin: http://{view.endpoint}'])[0], 200)
            self.assert_web_socket(view, 101, headers=[f'Origin: http://{view.endpoint}'])
            # Two headers, of which one is right.
            both = [f'Origin: http://{view.endpoint}', 'Origin: http://evil.example']
            self.assertIn(view.request('/view.json', headers=both[::-1])[0], (0, 400, 403))
            no_host = view.send(b'GET / HTTP/1.0\r\n\r\n')
            self.assertEqual(parsed(no_host)[0], 403)

    def test_token(self):
        with self.view(self.path('boxes.npy'), '--listen', '127.0.0.1:0') as view:
            self.assertRegex(view.token, r'^[0-9a-f]{32}$')
            for address in ('/', '/view.json', '/?token=', '/?token=' + '0' * 32, '/?token=' + view.token[:-1]):
                self.assertEqual(view.request(address)[0], 403, address)
            self.assert_web_socket(view, 403)
            status, headers, _ = view.request('/?token=' + view.token)
            self.assertEqual((status, headers['location']), (303, '/'))
            cookie = headers['set-cookie']
            self.assertIn('HttpOnly', cookie)
            self.assertIn('SameSite=Strict', cookie)
            pair = cookie.split(';')[0]
            for header in (f'Cookie: {pair}', f'Cookie: other=1; {pair}', f'Authorization: Bearer {view.token}'):
                self.assertEqual(view.request('/view.json', headers=[header])[0], 200, header)
                self.assert_web_socket(view, 101, headers=[header])
            for header in (f'Cookie: {pair}x', f'Cookie: x{pair}', f'Authorization: {view.token}', 'Authorization: Bearer '):
                self.assertEqual(view.request('/view.json', headers=[header])[0], 403, header)
            self.assertEqual(view.request('/view.json', headers=[f'Cookie: {pair}', 'Origin: http://evil.example'])[0], 403)
            # The address that follows a token stays on this server, and has no line of its own.
            for address in ('//evil.example/', '/%2f%2fevil.example/', '/%0d%0aX-Evil:1', '/%5cevil.example', '/a%0d%0ab/'):
                status, headers, _ = view.request(f'{address}?token={view.token}')
                self.assertNotIn('x-evil', headers)
                self.assertFalse(headers.get('location', '').startswith(('//', '/\\')), address)
        with self.view(self.path('boxes.npy'), '--listen', '127.0.0.1:0') as other:
            self.assertNotEqual(other.token, view.token)

    def test_strangers_do_not_keep_the_owner_out(self):
        """Connections without the token: silent ones, ones with a half request, and ones that ask again and again."""
        refused = b'GET /view.json HTTP/1.1\r\nHost: x\r\n\r\n'
        with self.view(self.path('boxes.npy'), '--listen', '127.0.0.1:0') as view, WebSocket(
                view, headers=[f'Authorization: Bearer {view.token}']) as page, contextlib.ExitStack() as strangers:
            self.assertEqual(page.status, 101)
            for first in (b'', refused[:20], refused):
                for _ in range(300):
                    connection = strangers.enter_context(view.connect())
                    with contextlib.suppress(ConnectionError):
                        connection.sendall(first)
                for _ in range(20):
                    self.assertEqual(view.request('/view.json', headers=[f'Authorization: Bearer {view.token}'])[0], 200)
            with view.connect() as connection:
                connection.sendall(refused)
                self.assertEqual(parsed(read_all(connection))[0], 403)  # until the server ends the connection
            page.send(b'still there?', opcode=9)
            while page.read()[0] != 10:  # an answer to the ping; before, messages may come
                pass

    def test_addresses(self):
        with self.view(self.path('boxes.npy')) as view:
            for address in ('/../etc/passwd', '/..%2f..%2fetc/passwd', '/%2e%2e/%2e%2e/etc/passwd', '/.%2e/x', '/frame/../view.json',
                            '/./view.json', '/%', '/%2', '/%zz', '/view.json?%', '/%00', '/view.json%00', '/x?a=%00'):
                self.assertEqual(view.request(address)[0], 400, address)
            for address in ('/..../etc/passwd', '/etc/passwd', '/%252e%252e/view.json', '/view.json/', '//view.json', '/\\..\\view.json',
                            '/proc/self/environ', '/frame/0.f32/..%5c'):
                self.assertIn(view.request(address)[0], (200, 404), address)
                self.assertNotIn(b'root:x:0', view.request(address)[2])
            self.assertEqual(view.request('http://evil.example/view.json')[0], 400)
            self.assertEqual(view.request('*')[0], 400)
            for address in ('/collisions/0.json?from=x', '/collisions/0.json?sort=x', '/near/0.bin', '/near/0.bin?min=1,2,3&max=nan,1,1'):
                self.assertEqual(view.request(address)[0], 400, address)
            for address in ('/frame/99999999999999999999.json', '/frame/-1.f32', '/object/0/20.json', '/octants/0/22.bin', '/shape/-1'):
                self.assertEqual(view.request(address)[0], 404, address)

    def test_methods_and_sizes(self):
        with self.view(self.path('boxes.npy')) as view:
            for method in ('POST', 'PUT', 'DELETE', 'OPTIONS', 'PATCH', 'TRACE', 'CONNECT'):
                self.assertEqual(view.request('/view.json', method=method, headers=['Content-Length: 0'])[0], 405, method)
            self.assertIn(view.request('/view.json', method='MADE-UP')[0], (0, 400, 405))
            self.assertEqual(view.request('/view.json', headers=['X: ' + 'a' * 20_000])[0], 431)
            self.assertEqual(view.request('/' + 'a' * 20_000)[0], 431)
            self.assertEqual(view.request('/view.json', headers=[f'X-{i}: {i}' for i in range(5000)])[0], 431)
            self.assertEqual(view.request('/view.json', method='POST', headers=['Content-Length: 5'])[0], 413)
            self.assertEqual(view.request('/view.json', method='POST', headers=['Content-Length: 99999999999999'])[0], 413)
            chunked = view.send(f'POST / HTTP/1.1\r\nHost: {view.endpoint}\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nabcde\r\n0\r\n\r\n'
                                .encode())
            self.assertIn(parsed(chunked)[0], (0, 400, 405, 413))
            for garbage in (b'\r\n', b'\0' * 100, b'GET\r\n\r\n', b'GET / HTTP/9.9\r\n\r\n', b'\x16\x03\x01\x02\x00\x01\x00', b'x' * 100_000,
                            b'GET / HTTP/1.1\r\nHost: a\r\n b\r\n\r\n', b'GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n',
                            b'GET / HTTP/1.1\nHost: ' + view.endpoint.encode() + b'\n\n', b'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n'):
                with view.connect() as connection:
                    send_and_end(connection, garbage)
                    read_all(connection)
                self.assertEqual(view.get('view.json')['objects'], 20)


class WebSockets(InFolder):
    def setUp(self):
        super().setUp()
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 20))
        self.server = self.view(self.path('boxes.npy'))
        self.addCleanup(self.server.__exit__)

    def attack(self, *frames):
        """Sends frames. The server must end this connection, and answer others."""
        with WebSocket(self.server) as web_socket:
            self.assertEqual(web_socket.status, 101)
            try:
                for frame in frames:
                    web_socket.send(**frame)
            except ConnectionError:
                pass
            self.assertTrue(web_socket.is_ended(), frames[0])
        self.assertTrue(self.server.is_alive())
        self.assertEqual(self.server.get('view.json')['objects'], 20)

    def test_frames_that_break_the_protocol(self):
        good = b'{"want": -1}'
        for frames in ([{'payload': good, 'masked': False}], [{'payload': b'', 'length': 1 << 20}], [{'payload': b'', 'length': 1 << 63}],
                       [{'payload': b'', 'length': (1 << 64) - 1}], [{'payload': b'', 'length': (1 << 63) - 1}],
                       [{'payload': b'a' * 1025}], [{'payload': b'{"want": -1' + b' ' * 2000 + b'}'}],
                       [{'payload': good, 'opcode': 2}], [{'payload': b'{"want": "\xff\xfe"}'}], [{'payload': b'\xff'}], [{'payload': b'not json'}],
                       [{'payload': b'[' * 1000}], [{'payload': b'{}'}], [{'payload': b''}], [{'payload': b'a' * 126, 'opcode': 9}],
                       [{'payload': b'', 'opcode': 9, 'fin': False}], [{'payload': b'', 'opcode': 3}], [{'payload': b'', 'opcode': 11}],
                       [{'payload': good, 'opcode': 0}], [{'payload': b'{', 'fin': False}, {'payload': good}],
                       [{'payload': b'x' * 600, 'fin': False}, {'payload': b'x' * 600, 'opcode': 0, 'fin': False}],
                       [{'payload': b'\x03', 'opcode': 8}], [{'payload': b'\x00\x00', 'opcode': 8}], [{'payload': b'', 'opcode': 8}]):
            with self.subTest(str(frames)[:80]):
                self.attack(*frames)

    def test_frames_that_are_right(self):
        with WebSocket(self.server) as web_socket:
            self.assertEqual(web_socket.read(), (1, b'{"event":"ready"}'))
            web_socket.send(b'hello', opcode=9)
            self.assertEqual(web_socket.read(), (10, b'hello'))
            web_socket.send(b'{"wa', fin=False)
            web_socket.send(b'between', opcode=9)
            web_socket.send(b'nt": -1}', opcode=0)
            self.assertEqual(web_socket.read(), (10, b'between'))
            for _ in range(1000):  # a scene of a file has no live frames
                web_socket.send(b'{"want": -1}')
            web_socket.send(b'last', opcode=9)
            self.assertEqual(web_socket.read(), (10, b'last'))

    def test_other_paths(self):
        for path in ('/', '/view.json', '/socketx', '/x'):
            self.assert_web_socket(self.server, 404, path=path)
        for path in ('/scene/7/socket', '/a/b/socket'):
            with WebSocket(self.server, path=path) as web_socket:
                self.assertIn(web_socket.status, (101, 404), path)
        self.assertEqual(self.server.request('/socket')[0], 404)


class Endurance(InFolder):
    def setUp(self):
        super().setUp()
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 200))

    def test_many_connections(self):
        with self.view(self.path('boxes.npy')) as view:
            files = view.files()
            connections = [view.connect() for _ in range(300)]
            time.sleep(0.5)
            self.assertLessEqual(view.files() - files, 256)
            for connection in connections:
                connection.close()
            self.assert_recovers(view, files)
            sockets = []
            for _ in range(300):
                try:
                    sockets.append(WebSocket(view))
                except ConnectionError:
                    pass
            self.assertEqual(sum(web_socket.status == 101 for web_socket in sockets), 256)
            for web_socket in sockets:
                web_socket.connection.close()
            self.assert_recovers(view, files)

    def assert_recovers(self, view, files):
        end = time.monotonic() + 10
        while view.files() > files and time.monotonic() < end:
            time.sleep(0.02)
        self.assertLessEqual(view.files(), files)
        self.assertEqual(view.get('view.json')['objects'], 200)

    def test_garbage(self):
        with self.view(self.path('boxes.npy')) as view:
            files = view.files()
            view.get('frame/0.f32')
            memory = None
            for i in range(3000):
                garbage = os.urandom(i % 300) if i % 3 else b'GET /' + os.urandom(i % 50) + b' HTTP/1.1\r\nHost: ' + view.endpoint.encode() + b'\r\n\r\n'
                with view.connect() as connection:
                    try:
                        if i % 5 == 0:
                            send_and_end(connection, garbage)
                            connection.recv(4096)
                        else:
                            connection.sendall(garbage)
                    except ConnectionError:
                        pass
                if i == 1000:
                    memory = view.memory()
            self.assert_recovers(view, files)
            self.assertLess(view.memory(), memory + (8 << 20))

    def test_answers_are_not_kept(self):
        with self.view(self.path('boxes.npy')) as view:
            memory = None
            for i in range(600):
                for address in ('frame/0.f32', 'octants/0.json', 'collisions/0.json?count=1000', f'object/0/{i % 200}.json', '?x'):
                    self.assertEqual(view.request('/' + address)[0], 200)
                if i == 200:
                    memory = view.memory()
            self.assertLess(view.memory(), memory + (4 << 20))

    def test_slow_requests_end(self):
        with self.view(self.path('boxes.npy')) as view:
            connections = [view.connect() for _ in range(20)]
            begin = time.monotonic()
            for connection in connections:
                connection.settimeout(60)
                connection.sendall(b'GET / HT')
            self.assertEqual(view.get('view.json')['objects'], 200)
            for _ in range(3):
                time.sleep(1)
                for connection in connections:
                    connection.sendall(b'T')
            for connection in connections:  # bytes that come slowly do not keep a connection open
                self.assertEqual(read_all(connection), b'')
                connection.close()
            self.assertLess(time.monotonic() - begin, 20)

    def test_clients_that_do_not_read(self):
        scene_files.save_boxes(self.path('large.npy'), scene_files.random_boxes(2, 20_000, 200.0))
        with self.view(self.path('large.npy')) as view:
            request = f'GET /frame/0.f32 HTTP/1.1\r\nHost: {view.endpoint}\r\n\r\n'.encode()
            connections = [view.connect() for _ in range(100)]
            for connection in connections:
                connection.sendall(request * 5)
            self.assertEqual(view.get('view.json')['objects'], 20_000)
            time.sleep(1)
            self.assertLess(view.memory(), 400 << 20)
            for connection in connections:
                connection.close()
            self.assertEqual(view.get('view.json')['objects'], 20_000)

    def test_few_open_files(self):
        with self.view(self.path('boxes.npy'), limit_files=40) as view:
            connections = [view.connect() for _ in range(100)]
            time.sleep(0.2)
            before = self.cpu(view)
            time.sleep(1)
            self.assertLess(self.cpu(view) - before, 0.3)  # it does not poll
            for connection in connections:
                connection.close()
            time.sleep(0.5)
            self.assertEqual(view.get('view.json')['objects'], 200)

    @staticmethod
    def cpu(view):
        """Returns the seconds of processor time."""
        with open(f'/proc/{view.process.pid}/stat', encoding='utf-8') as stat:
            fields = stat.read().rsplit(')', 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')

    def test_parallel_readers(self):
        frames = scene_files.moving_boxes(3, 30, 40)
        scene_files.save_moving(self.path('moving.npy'), frames)
        faults = []
        with self.view(self.path('moving.npy')) as view:
            def read(first):
                try:
                    for number in range(first, 30):
                        found = pairs_in(view.get(f'pairs/{number}.u32'))
                        if found != scene_files.true_pairs(frames[number]):
                            faults.append(number)
                except Exception as error:  # pylint: disable=broad-except
                    faults.append(error)
            threads = [threading.Thread(target=read, args=(i,)) for i in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(faults, [])

    def test_ends_on_a_signal(self):
        with self.view(self.path('boxes.npy')) as view:
            connections = [view.connect() for _ in range(10)]
            with WebSocket(view) as web_socket:
                while json.loads(web_socket.read()[1])['event'] != 'ready':
                    pass
                view.process.terminate()
                self.assertEqual(json.loads(web_socket.read()[1]), {'event': 'closed'})
                view.process.wait(10)
            for connection in connections:
                connection.close()


class BadInput(InFolder):
    def refused(self, status, *arguments):
        done = self.run_program('view', *arguments, '--no-browser', '--quiet')
        self.assertEqual(done.returncode, status, (arguments, done.stdout, done.stderr))
        self.assertEqual(done.stdout, '')
        self.assertEqual(len(done.stderr.strip().split('\n')), 1, done.stderr)
        self.assertTrue(done.stderr.startswith('octopair: '), done.stderr)
        return done.stderr

    def write(self, name, text):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)
        return self.path(name)

    def test_inputs(self):
        scene_files.save_boxes(self.path('good.npy'), scene_files.random_boxes(1, 10))
        self.refused(4, self.path('missing.npy'))
        self.refused(4, self.path('missing.jsonl'))
        self.refused(4, self.folder + '/none/x.csv')
        scene_files.save_boxes(self.path('nan.npy'), [(0, 0, 0, 1, 1, 1), (0, 0, 0, math.nan, 1, 1)])
        self.assertIn('1', self.refused(3, self.path('nan.npy')))
        scene_files.save_boxes(self.path('turned.npy'), [(0, 0, 0, 1, 1, -1)])
        self.refused(3, self.path('turned.npy'))
        self.write('scene.xyz', 'x')
        self.assertIn(self.run_program('view', self.path('scene.xyz'), '--no-browser', '--quiet').returncode, (2, 3))
        self.refused(3, self.write('empty.npy', ''))
        self.refused(3, self.write('bad.json', '{'))
        self.refused(3, self.write('bad.csv', 'a,b,c\n1,2'))
        self.assertEqual(self.run_program('view', '--no-browser').returncode, 2)

    def test_options_that_do_not_fit(self):
        scene_files.save_boxes(self.path('good.npy'), scene_files.random_boxes(1, 10))
        good, pairs = self.path('good.npy'), self.write('pairs.csv', 'a,b\n0,1\n')
        for stage in ('objects', 'features'):
            self.assertIn('only boxes', self.refused(2, good, '--stage', stage))
        for options in (('--margin', '1'), ('--stage', 'pairs'), ('--objects', 'triangle')):
            self.assertIn(options[0], self.refused(2, good, pairs, *options))
        self.assertIn('alone', self.refused(2, good, 'unix:none.socket'))
        self.assertIn('--up', self.refused(2, 'unix:none.socket', '--up', 'y'))
        self.assertIn('--export', self.refused(2, 'unix:none.socket', '--export', self.path('x.html')))
        self.assertIn('--port', self.refused(2, good, '--export', self.path('x.html'), '--port', '7'))
        for address in ('foo:1', ':8080', '8080'):
            self.refused(2, good, '--listen', address)

    def test_results(self):
        scene_files.save_boxes(self.path('good.npy'), scene_files.random_boxes(1, 10))
        good = self.path('good.npy')
        self.assertIn('10', self.refused(3, good, self.write('beyond.jsonl', '{"a":0,"b":10}\n')))
        self.refused(3, good, self.write('frame.jsonl', '{"frame":1,"a":0,"b":1}\n'))
        scene_files.save_moving(self.path('moving.npy'), scene_files.moving_boxes(1, 3, 10))
        self.assertIn('which of the 3 frames', self.refused(3, self.path('moving.npy'), self.write('pairs.csv', 'a,b\n0,1\n')))
        self.refused(3, self.write('same.jsonl', '{"a":5,"b":5}\n'))
        for row in ('{', '[]', '{"a":0}', '{"a":0,"b":-1}', '{"a":0,"b":1.5}', '{"a":0,"b":4294967295}', '{"a":0,"b":4294967296}', '{"a":0,"b":1,"contacts":3}',
                    '{"a":0,"b":1,"contacts":[{"point":[1,2]}]}', '{"a":0,"b":1,"depth":"x"}', '{"a":0,"b":1,"frame":1000000}',
                    '{"a":0,"b":1,"contacts":[{"point":[1e999,0,0]}]}'):
            self.assertIn('line 2', self.refused(3, self.write('row.jsonl', '{"a":0,"b":1}\n' + row + '\n')), row)
        for row in ('0', '0,1,2,3,4', 'x,1', '0,-1', '0,4294967296', ',', '0,1x'):
            self.assertIn('line 3', self.refused(3, self.write('row.csv', 'a,b\n0,1\n' + row + '\n')), row)
        self.assertIn('line 2', self.refused(3, self.write('row.csv', 'a,b,depth\n0,1,deep\n')))
        self.assertIn('line 2', self.refused(3, self.write('row.csv', 'a,b,points\n0,1,inf 0 0\n')))
        self.assertIn('line 2', self.refused(3, self.write('row.csv', 'a,b,points\n0,1,1 2\n')))
        scene_files.write_npy(self.path('wrong.npy'), (2, 2), [0, 1, 3, 3], '<u4')
        self.refused(3, self.path('wrong.npy'))
        self.refused(2, self.write('one.jsonl', '{"a":0,"b":1}\n'), self.write('two.jsonl', '{"a":0,"b":1}\n'))

    def test_results_with_wrong_events(self):
        begin = '{"frame":0,"event":"begin","a":0,"b":1}\n'
        self.assertIn('line 2', self.refused(3, self.write('word.jsonl', begin + begin.replace('begin', 'began'))))
        self.assertIn('some have none', self.refused(3, self.write('mixed.jsonl', begin + '{"frame":1,"a":0,"b":1}\n')))

    def test_small_results_do_not_take_all_memory(self):
        self.refused(5, self.write('far.jsonl', '{"a":0,"b":4294967294}\n'))
        rows = ''.join(f'{{"frame":0,"event":"begin","a":{i},"b":{i + 1}}}\n' for i in range(200))
        with self.view(self.write('long.jsonl', rows + '{"frame":999999,"event":"end","a":0,"b":1}\n')) as view:
            self.assertEqual(len(pairs_in(view.get('pairs/999998.u32'))), 200)
            self.assertEqual(len(pairs_in(view.get('pairs/999999.u32'))), 199)
            self.assertLess(view.memory(), 500e6)

    def test_options(self):
        scene_files.save_boxes(self.path('good.npy'), scene_files.random_boxes(1, 10))
        good = self.path('good.npy')
        for arguments in (['--port', '65536'], ['--port', 'x'], ['--listen', 'x'], ['--listen', '127.0.0.1'], ['--listen', '127.0.0.1:99999'],
                          ['--listen', 'localhost:0'], ['--listen', '127.0.0.1:0', '--port', '5'], ['--up', 'x'], ['--margin', '-1'],
                          ['--export', self.path('page.txt')], ['--screenshot', self.path('picture.jpg')], ['--unknown'],
                          ['--export', good], ['--stage', 'x'], ['--listen', ':0']):
            done = self.run_program('view', good, *arguments, '--no-browser', '--quiet')
            self.assertEqual(done.returncode, 2, (arguments, done.stderr))
        done = self.run_program('view', good, '--screenshot', self.path('picture.png'), '--quiet', environment={'TMPDIR': '/missing'})
        self.assertEqual((done.returncode, os.path.exists(self.path('picture.png'))), (4, False))
        self.assertIn('TMPDIR', done.stderr)
        self.assertEqual(self.run_program('view', good, '--listen', '192.0.2.1:0', '--no-browser', '--quiet').returncode, 4)
        with self.view(good) as view:
            self.refused(4, good, '--port', str(view.port))


if __name__ == '__main__':
    main(__doc__)
