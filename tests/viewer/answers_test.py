#!/usr/bin/python3
"""Compares the answers and the exported pages of `octopair view` with its input and with `octopair detect`.

    answers_test.py --program PATH [CLASS[.TEST]...]
"""
import base64
import gzip
import itertools
import json
import math
import os
import pty
import re
import shutil
import subprocess
import time

import scene_files
from view_case import InFolder, main, numbers, pairs_in, relative_rows
from view_process import WebSocket, read_all


class Answers(InFolder):
    def assert_boxes(self, rows, objects, boxes):
        self.assertEqual(len(rows), len(objects))
        for row, index in zip(rows, objects):
            for found, expected in zip(row, boxes[index]):
                self.assertAlmostEqual(found, expected, places=5)

    def shown(self, view, scene):
        if scene['shown'] == scene['objects']:
            status, _, body = view.request('/shown.u32')
            return list(range(scene['objects'])) if status == 404 else numbers('I', body)
        return numbers('I', view.get('shown.u32'))

    def check_frame(self, view, scene, number, boxes):
        pairs = scene_files.true_pairs(boxes)
        shown = self.shown(view, scene)
        self.assertEqual(sorted(shown), list(range(len(boxes))))
        frame = view.get(f'frame/{number}.json')
        self.assertEqual((frame['frame'], frame['pairs'], frame['pairs_listed']), (number, len(pairs), len(pairs)))
        self.assert_boxes(relative_rows(view.get(f'frame/{number}.f32'), scene['origin']), shown, boxes)
        self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), pairs)
        partners = [sum(1 for pair in pairs if index in pair) for index in range(len(boxes))]
        self.assertEqual(numbers('I', view.get(f'partners/{number}.u32')), [partners[index] for index in shown])
        self.check_octants(view, scene, number, boxes, shown)
        rows = view.get(f'collisions/{number}.json?count=1000')
        self.assertEqual([(row['a'], row['b']) for row in rows['rows']], pairs)
        one = view.get(f'object/{number}/3.json')
        self.assertEqual((one['index'], one['row'], one['partner_count']), (3, shown.index(3), partners[3]))
        self.assertEqual(one['box'], {'min': list(boxes[3][:3]), 'max': list(boxes[3][3:])})
        return pairs

    def check_octants(self, view, scene, number, boxes, shown):
        summary = view.get(f'octants/{number}.json')
        levels = view.get(f'levels/{number}.u8')
        homes = {}
        for level, described in enumerate(summary['levels']):
            words = numbers('I', view.get(f'octants/{number}/{level}.bin'))
            self.assertEqual(len(words), 11 * described['listed'])
            for i in range(0, len(words), 11):
                homes[(level, words[i + 9] << 32 | words[i + 10])] = words[i + 7]
        self.assertEqual(sum(homes.values()), len(boxes))
        for row, index in list(enumerate(shown))[:20]:
            one = view.get(f'object/{number}/{index}.json')
            self.assertEqual(one['level'], levels[row])
            digits = [int(digit) - 1 for digit in one['code'].strip('{}').split(',') if digit]
            key = sum(digit << 60 - 3 * i for i, digit in enumerate(digits))
            self.assertGreater(homes[(len(digits), key)], 0)

    def test_boxes(self):
        boxes = scene_files.random_boxes(1, 120)
        scene_files.save_boxes(self.path('boxes.npy'), boxes)
        with self.view(self.path('boxes.npy')) as view:
            scene = view.get('view.json')
            self.assertEqual((scene['title'], scene['kind'], scene['objects'], scene['frames']), ('boxes.npy', 'scene', 120, 1))
            for end, choose in (('min', min), ('max', max)):
                for axis in range(3):
                    self.assertEqual(scene['bounds'][end][axis], choose(box[axis + (3 if end == 'max' else 0)] for box in boxes))
            pairs = self.check_frame(view, scene, 0, boxes)
            self.assertEqual(scene['summary']['pairs'], len(pairs))
            rows = self.detected(self.path('boxes.npy'))
            self.assertEqual([(int(row['a']), int(row['b'])) for row in rows], pairs)
            for address in ('timeline.json', 'began/0.u32', 'names.json', 'groups.u32', 'shapes.json', 'poses/0.f32', 'nothing',
                            'frame/1.json', 'shape/0', 'favicon.ico'):
                self.assertEqual(view.request('/' + address)[0], 404, address)
            self.assertEqual(view.get('search.json?q=7')['found'], [{'index': 7, 'name': ''}])

    def test_page(self):
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 5))
        with self.view(self.path('boxes.npy')) as view:
            status, headers, body = view.request('/')
            self.assertEqual((status, headers['content-type']), (200, 'text/html; charset=utf-8'))
            self.assertIn(b'octopair', body)
            policy = re.search(rb'http-equiv="Content-Security-Policy" content="([^"]*)"', body)[1]
            self.assertTrue(policy.startswith(b"default-src 'none'; "), policy)
            self.assertNotRegex(policy, rb'https?:|\*|unsafe-eval')
            self.assertEqual(headers['x-frame-options'], 'DENY')
            self.assertEqual(headers['x-content-type-options'], 'nosniff')
            self.assertEqual(headers['cache-control'], 'no-store')
            self.assertEqual(view.request('/', headers=['Accept-Encoding: gzip, br'])[2], body)
            for given, compressed in (('gzip', True), ('GZIP;q=0.001', True), ('br, x-gzip;q=1', True), ('*', True), ('*;q=0, gzip', True),
                                      ('', False), ('gzip;q=0', False), ('gzip; q=0.000', False), ('*;q=0', False), ('gzip;q=0, *', False),
                                      ('identity', False), ('gzipped', False)):
                headers = view.request('/', headers=[f'Accept-Encoding: {given}'])[1]
                self.assertEqual(headers.get('content-encoding') == 'gzip', compressed, given)
            self.assertEqual(view.request('/?anything=1')[2], body)
            status, headers, empty = view.request('/', method='HEAD')
            self.assertEqual((status, empty, headers['content-length']), (200, b'', str(len(body))))
            with view.connect() as connection:  # one connection, several requests
                request = f'GET /view.json HTTP/1.1\r\nHost: {view.endpoint}\r\n\r\n'.encode()
                connection.sendall(request * 2 + request.replace(b'\r\n\r\n', b'\r\nConnection: close\r\n\r\n'))
                self.assertEqual(read_all(connection).count(b'HTTP/1.1 200'), 3)
            with WebSocket(view) as web_socket:
                self.assertEqual(json.loads(web_socket.read()[1]), {'event': 'ready'})

    def test_moving_scene(self):
        frames = scene_files.moving_boxes(2, 8, 60)
        scene_files.save_moving(self.path('moving.npy'), frames)
        events = self.detected(self.path('moving.npy'), '--events')
        with self.view(self.path('moving.npy')) as view:
            scene = view.get('view.json')
            self.assertEqual((scene['frames'], scene['has']['events']), (8, True))
            before = []
            for number in (0, 1, 2, 7, 4):
                pairs = self.check_frame(view, scene, number, frames[number])
                before = scene_files.true_pairs(frames[number - 1]) if number else []
                began = pairs_in(view.get(f'began/{number}.u32'))
                self.assertEqual(began, sorted(set(pairs) - set(before)))
                self.assertEqual(pairs_in(view.get(f'ended/{number}.u32')), sorted(set(before) - set(pairs)))
                told = sorted((int(row['a']), int(row['b'])) for row in events
                              if int(row['frame']) == number and row['event'] == 'begin')
                self.assertEqual(began, told)
                first = view.get(f'collisions/{number}.json?sort=began&count=1000')['rows']
                self.assertEqual([row.get('change') for row in first], ['began'] * len(began) + [None] * (len(pairs) - len(began)))
            end = time.monotonic() + 20
            while (timeline := view.get('timeline.json'))['done'] < 8 and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(timeline['pairs'], [len(scene_files.true_pairs(boxes)) for boxes in frames])
            self.assertEqual(timeline['began'][0], timeline['pairs'][0])

    def test_mesh_scene(self):
        scene_files.write_cubes_obj(self.path('cubes.obj'))
        with self.view(self.path('cubes.obj'), '--up', 'y') as view:
            scene = view.get('view.json')
            self.assertEqual((scene['objects'], scene['up']), (3, 'y'))
            self.assertEqual(scene['has'], scene['has'] | {'names': True, 'shapes': True, 'contacts': True})
            shown = self.shown(view, scene)
            self.assertEqual([view.get('names.json')[shown.index(i)] for i in range(3)], [f'cubes.obj/{name}' for name in ('hull', 'deck </script>', 'mast')])
            rows = view.get('collisions/0.json')['rows']
            self.assertEqual([(row['a'], row['b'], row['name_b'], row['class']) for row in rows],
                             [(0, 1, 'cubes.obj/deck </script>', 'penetrating')])
            self.assertGreater(len(rows[0]['contacts']), 0)
            for contact in rows[0]['contacts']:
                self.assertTrue(0.75 - 1e-9 <= contact['point'][0] <= 1 + 1e-9)
            self.check_shapes(view, scene, shown)

    def check_shapes(self, view, scene, shown):
        """Places the vertices of each object by its pose. Their bounds must be its box."""
        shapes = view.get('shapes.json')['shapes']
        geometry = numbers('I', view.get('geometry.u32'))
        poses = numbers('f', view.get('poses/0.f32'))
        for row, index in enumerate(shown):
            described = shapes[geometry[row]]
            data = view.get(f'shape/{geometry[row]}')
            self.assertEqual(len(data), 12 * (described['vertices'] + described['triangles']))
            vertices = numbers('f', data[:12 * described['vertices']])
            triangles = numbers('I', data[12 * described['vertices']:])
            self.assertLess(max(triangles), described['vertices'])
            pose = poses[12 * row:12 * row + 12]
            placed = [[sum(pose[3 * column + axis] * vertices[i + column] for column in range(3)) + pose[9 + axis]
                       + scene['origin'][axis] for axis in range(3)] for i in range(0, len(vertices), 3)]
            box = view.get(f'object/0/{index}.json')['box']
            size = max(high - low for low, high in zip(box['min'], box['max']))
            for axis in range(3):  # a polyhedron in place of a sphere is a little smaller
                self.assertAlmostEqual(min(p[axis] for p in placed), box['min'][axis], delta=0.05 * size)
                self.assertAlmostEqual(max(p[axis] for p in placed), box['max'][axis], delta=0.05 * size)

    def test_json_scene(self):
        scene_files.write_json_scene(self.path('scene.json'))
        with self.view(self.path('scene.json')) as view:
            scene = view.get('view.json')
            self.assertEqual(view.get('search.json?q=BLO')['found'], [{'index': 1, 'name': 'block'}])
            self.assertEqual(pairs_in(view.get('pairs/0.u32')), [(0, 1)])
            self.check_shapes(view, scene, self.shown(view, scene))

    def test_results(self):
        scene_files.write_cubes_obj(self.path('cubes.obj'))
        detected = self.run_program('detect', self.path('cubes.obj'), '--stage', 'features', '--quiet', '--output', self.path('found.jsonl'))
        self.assertEqual(detected.returncode, 0)
        for inputs in ((self.path('found.jsonl'),), (self.path('cubes.obj'), self.path('found.jsonl'))):
            with self.view(*inputs) as view:
                scene = view.get('view.json')
                self.assertEqual(pairs_in(view.get('pairs/0.u32')), [(0, 1)])
                row = view.get('collisions/0.json')['rows'][0]
                self.assertEqual((row['class'], row['name_a'], row['name_b']), ('penetrating', 'cubes.obj/hull', 'cubes.obj/deck </script>'))
                self.assertEqual(scene['objects'], 2 if len(inputs) == 1 else 3)
                rows = relative_rows(view.get('frame/0.f32'), scene['origin'])
                self.assertEqual(len(rows), scene['shown'])
                self.assertFalse(any(math.isnan(value) for box in rows for value in box))

    def test_results_as_pairs(self):
        boxes = scene_files.random_boxes(5, 50)
        pairs = scene_files.true_pairs(boxes)
        scene_files.save_boxes(self.path('boxes.npy'), boxes)
        for name in ('pairs.npy', 'pairs.csv', 'pairs.jsonl'):
            self.assertEqual(self.run_program('detect', self.path('boxes.npy'), '--quiet', '--output', self.path(name)).returncode, 0)
            with self.view(self.path('boxes.npy'), self.path(name)) as view:
                self.assertEqual(pairs_in(view.get('pairs/0.u32')), pairs, name)
            with self.view(self.path(name)) as view:
                self.assertEqual(pairs_in(view.get('pairs/0.u32')), pairs, name)
                self.assertIn('nothing is drawn', view.get('view.json')['notices'][0])
                self.assertEqual(view.get('octants/0.json')['entries'], 0)

    def test_results_with_events(self):
        frames = scene_files.moving_boxes(6, 6, 40)
        scene_files.save_moving(self.path('moving.npy'), frames)
        for name in ('events.csv', 'events.jsonl'):
            done = self.run_program('detect', self.path('moving.npy'), '--events', '--quiet', '--output', self.path(name))
            self.assertEqual(done.returncode, 0, done.stderr)
            with self.view(self.path('moving.npy'), self.path(name)) as view:
                for number, boxes in enumerate(frames):
                    self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), scene_files.true_pairs(boxes), (name, number))

    def test_results_whose_last_events_are_early(self):
        first = [[0, 0, 0, 1, 1, 1], [0.5, 0, 0, 1.5, 1, 1], [5, 0, 0, 6, 1, 1]]
        moved = [[0, 0, 0, 1, 1, 1], [4.5, 0, 0, 5.5, 1, 1], [5, 0, 0, 6, 1, 1]]
        scene_files.save_moving(self.path('scene.npy'), [first, moved, moved, moved])
        self.assertEqual(self.run_program('detect', self.path('scene.npy'), '--events', '--quiet', '--output', self.path('events.csv')).returncode, 0)
        with self.view(self.path('scene.npy'), self.path('events.csv')) as view:
            for number, pairs in enumerate([[(0, 1)], [(1, 2)], [(1, 2)], [(1, 2)]]):
                self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), pairs, number)

    def test_a_result_of_one_frame(self):
        frames = scene_files.moving_boxes(4, 3, 40)
        scene_files.save_moving(self.path('scene.npy'), frames)
        self.assertEqual(self.run_program('detect', self.path('scene.npy'), '--quiet', '--output', self.path('pairs.npy')).returncode, 0)
        # The number in the name of another result is no frame.
        scene_files.save_boxes(self.path('boxes.npy'), frames[2])
        shutil.copy(self.path('pairs.000002.npy'), self.path('pairs.20261127.npy'))
        with self.view(self.path('boxes.npy'), self.path('pairs.20261127.npy')) as view:
            self.assertEqual(pairs_in(view.get('pairs/0.u32')), scene_files.true_pairs(frames[2]))
        with self.view(self.path('scene.npy'), self.path('pairs.000002.npy')) as view:
            for number, boxes in enumerate([[], [], frames[2]]):
                self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), scene_files.true_pairs(boxes), number)
        with self.view(self.path('pairs.000002.npy')) as view:
            self.assertEqual(view.get('view.json')['frames'], 1)
            self.assertEqual(pairs_in(view.get('pairs/0.u32')), scene_files.true_pairs(frames[2]))

    def test_results_of_other_programs(self):
        with open(self.path('table.csv'), 'w', encoding='utf-8-sig') as file:
            file.write('a,b,a_name,points\r\n2,1,"a ""wide""\nname, with comma",1 2 3;4 5 6\r\n')
        with self.view(self.path('table.csv')) as view:
            row = view.get('collisions/0.json')['rows'][0]
            self.assertEqual((row['a'], row['b'], row['name_b']), (1, 2, 'a "wide"\nname, with comma'))

    def test_contacts_without_normals(self):
        with open(self.path('table.csv'), 'w', encoding='utf-8') as file:
            file.write('a,b,class,depth,points\n0,1,penetrating,0.5,1 2 3;4 5 6\n')
        with self.view(self.path('table.csv'), '--up', 'y') as view:
            self.assertEqual(view.get('view.json')['up'], 'y')
            row = view.get('collisions/0.json')['rows'][0]
            self.assertEqual((row['depth'], row['contacts']), (0.5, [{'point': [1, 2, 3]}, {'point': [4, 5, 6]}]))

    def test_a_later_frame_that_is_wrong(self):
        frames = scene_files.moving_boxes(3, 6, 10)
        frames[4][2] = (math.nan, *frames[4][2][1:])
        scene_files.save_moving(self.path('scene.npy'), frames)
        with self.view(self.path('scene.npy')) as view:
            end = time.monotonic() + 20
            while 'failed' not in (timeline := view.get('timeline.json')) and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(timeline['done'], 4)
            self.assertIn('frame 4', timeline['failed'])
            self.assertEqual(pairs_in(view.get('pairs/3.u32')), scene_files.true_pairs(frames[3]))
        self.assertIn(timeline['failed'], view.errors)

    def test_results_with_repeated_events(self):
        rows = [(0, 'begin', 1, 2), (0, 'begin', 1, 2), (1, 'end', 0, 1), (1, 'begin', 0, 1), (2, 'begin', 2, 1), (2, 'end', 2, 3),
                (3, 'end', 1, 2), (3, 'begin', 1, 2), (4, 'end', 1, 2), (4, 'end', 1, 2), (6, 'begin', 1, 2), (7, 'end', 0, 1)]
        expected = [{(1, 2)}, {(0, 1), (1, 2)}, {(0, 1), (1, 2)}, {(0, 1), (1, 2)}, {(0, 1)}, {(0, 1)}, {(0, 1), (1, 2)}, {(1, 2)}]
        with open(self.path('events.csv'), 'w', encoding='utf-8') as file:
            file.write('frame,event,a,b\n' + ''.join(f'{frame},{event},{a},{b}\n' for frame, event, a, b in reversed(rows)))
        with self.view(self.path('events.csv')) as view:
            for number, pairs in enumerate(expected):
                self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), sorted(pairs), number)

    def test_results_by_frame(self):
        rows = [(2, 3, 4), (0, 5, 1), (2, 0, 9), (0, 1, 5), (2, 3, 4)]
        with open(self.path('rows.csv'), 'w', encoding='utf-8') as file:
            file.write('frame,a,b\n' + ''.join(f'{frame},{a},{b}\n' for frame, a, b in rows))
        with self.view(self.path('rows.csv')) as view:
            for number, pairs in enumerate([[(1, 5)], [], [(0, 9), (3, 4)]]):
                self.assertEqual(pairs_in(view.get(f'pairs/{number}.u32')), pairs, number)


class Export(InFolder):
    @staticmethod
    def data_of(path):
        with open(path, encoding='utf-8') as file:
            text = file.read()
        found = re.findall(r'<script type="application/octet-stream" data-address="([^"]*)">([A-Za-z0-9+/=]*)</script>', text)
        return {address: gzip.decompress(base64.b64decode(data)) for address, data in found}, text

    def check_export(self, *inputs):
        done = self.run_program('view', *inputs, '--export', self.path('page.html'), '--quiet')
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, '', ''))
        data, text = self.data_of(self.path('page.html'))
        self.run_program('view', *inputs, '--export', self.path('again.html'), '--quiet')
        with open(self.path('page.html'), 'rb') as first, open(self.path('again.html'), 'rb') as again:
            self.assertTrue(first.read() == again.read(), 'the same input gives the same page')
        with self.view(*inputs) as view:
            self.wait_for_timeline(view)
            for address, body in data.items():
                if address == 'view.json':
                    continue
                if address.startswith('frame/') and address.endswith('.json'):
                    answer = json.loads(view.request(f'/{address}')[2])
                    answer.pop('seconds', None)
                    self.assertEqual(json.loads(body), answer, address)
                    continue
                query = '?count=200000&sort=worst' if address.startswith('collisions/') else ''
                self.assertEqual(body, view.request(f'/{address}{query}')[2], address)
        scene = json.loads(data['view.json'])
        for frame in range(scene['frames']):
            for address in (f'frame/{frame}.json', f'frame/{frame}.f32', f'pairs/{frame}.u32', f'octants/{frame}/0.bin'):
                self.assertIn(address, data)
        self.assertEqual((scene['has']['search'], scene['has']['near']), (False, False))
        self.assertEqual(os.listdir(self.folder).count('page.html'), 1)
        return scene, text

    @staticmethod
    def wait_for_timeline(view):
        end = time.monotonic() + 20
        while time.monotonic() < end:
            status, _, body = view.request('/timeline.json')
            if status == 404 or json.loads(body)['done'] == json.loads(body)['frames']:
                return
            time.sleep(0.02)

    def test_each_kind(self):
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 80))
        self.check_export(self.path('boxes.npy'))
        scene_files.save_moving(self.path('moving.npy'), scene_files.moving_boxes(2, 5, 30))
        self.assertEqual(self.check_export(self.path('moving.npy'))[0]['frames'], 5)
        scene_files.write_cubes_obj(self.path('cubes.obj'))
        text = self.check_export(self.path('cubes.obj'))[1]
        self.assertNotIn('deck </script>', text)
        scene_files.write_json_scene(self.path('scene.json'))
        self.check_export(self.path('scene.json'))
        self.run_program('detect', self.path('cubes.obj'), '--stage', 'features', '--quiet', '--output', self.path('found.jsonl'))
        self.check_export(self.path('found.jsonl'))
        self.check_export(self.path('cubes.obj'), self.path('found.jsonl'))

    def test_options_of_detect(self):
        """Options of a search give the collisions that `octopair detect` finds with them."""
        for name, places in (('s.json', (0, 1.5, 3.9, 9)), ('t.json', (0.5, 4.5))):
            with open(self.path(name), 'w', encoding='utf-8') as file:
                json.dump({'objects': [{'name': f'{name[0]}{x}', 'shape': {'type': 'sphere', 'radius': 1}, 'position': [x, 0, 0]} for x in places]}, file)
        with open(self.path('rules.json'), 'w', encoding='utf-8') as file:
            json.dump({'exclude': [{'a': 's0', 'b': '*'}]}, file)
        seen = set()
        for options in ([], ['--against', self.path('t.json')], ['--margin', '0.5'], ['--tolerance', '0.6'], ['--min-depth', '0.6', '--margin', '0.5'],
                        ['--exclude', self.path('rules.json')], ['--against', self.path('t.json'), '--exclude', self.path('rules.json')]):
            run = [self.path('s.json'), *options, '--quiet']
            self.run_program('detect', *run, '--stage', 'features', '-o', self.path('r.jsonl'))
            with open(self.path('r.jsonl'), encoding='utf-8') as file:
                expected = [json.loads(line) for line in file]
            self.assertEqual(self.run_program('view', *run, '--export', self.path('page.html')).stderr, '')
            data, _ = self.data_of(self.path('page.html'))
            second = json.loads(data['view.json']).get('second_set', 0)
            self.assertEqual(second, 4 if '--against' in options else 0)
            rows = sorted(json.loads(data['collisions/0.json'])['rows'], key=lambda row: (row['a'], row['b']))
            self.assertEqual([(row['a'], row['b'] - second, row['class'], row.get('depth')) for row in rows],
                             [(row['a'], row['b'], row['class'], row.get('depth')) for row in expected])
            seen.add(data['collisions/0.json'])
        self.assertEqual(len(seen), 7, 'each option changes the result')

    def test_options_of_a_search_need_a_search(self):
        scene_files.write_cubes_obj(self.path('cubes.obj'))
        self.run_program('detect', self.path('cubes.obj'), '--quiet', '-o', self.path('found.jsonl'))
        for options in (['--tolerance', '1'], ['--against', self.path('cubes.obj')], ['--objects', 'triangle'], ['--same-parent', 'exclude']):
            done = self.run_program('view', self.path('cubes.obj'), self.path('found.jsonl'), *options, '--export', self.path('page.html'))
            self.assertEqual((done.returncode, done.stderr), (2, f'octopair: {options[0]}: not with a result, whose pairs are known\n'))

    def written(self, *inputs):
        """Exports a page, and returns what the line on standard error says after the name and the size."""
        page = self.path('page.html')
        done = self.run_program('view', *inputs, '--export', page)
        self.assertEqual((done.returncode, done.stdout), (0, ''), done.stderr)
        found = re.fullmatch(re.escape(f'wrote {page} (') + r'([\d.]+) (kB|MB)\): (.*)\n', done.stderr)
        self.assertIsNotNone(found, done.stderr)
        unit = {'kB': 1e3, 'MB': 1e6}[found[2]]
        self.assertAlmostEqual(float(found[1]), os.path.getsize(page) / unit, delta=0.051)
        return found[3]

    def test_says_what_was_written(self):
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 80))
        pairs = len(self.detected(self.path('boxes.npy')))
        self.assertEqual(self.written(self.path('boxes.npy')), f'80 objects, {pairs} pairs')
        scene_files.save_moving(self.path('moving.npy'), scene_files.moving_boxes(2, 5, 30))
        pairs = len(self.detected(self.path('moving.npy')))
        self.assertEqual(self.written(self.path('moving.npy')), f'30 objects in each of 5 frames, {pairs} pairs')
        scene_files.write_cubes_obj(self.path('cubes.obj'))
        self.assertEqual(len(self.detected(self.path('cubes.obj'))), 1)
        self.assertRegex(self.written(self.path('cubes.obj')), '^[0-9]+ objects, 1 collision$')

    def test_shows_progress_on_a_terminal(self):
        scene_files.save_moving(self.path('moving.npy'), scene_files.moving_boxes(2, 5, 30))
        terminal, errors = pty.openpty()
        with open(terminal, 'rb', buffering=0) as screen:
            with subprocess.Popen([self.program, 'view', self.path('moving.npy'), '--export', self.path('page.html')],
                                  stderr=errors) as process:
                os.close(errors)
                shown = b''
                try:
                    while part := screen.read(65536):
                        shown += part
                except OSError:  # the program has ended
                    pass
        self.assertEqual(process.returncode, 0)
        activities = [match[0].decode() for match in itertools.groupby(re.findall(rb'\r([a-z ]+) \[[# ]*\] +\d+%', shown))]
        self.assertEqual(activities, ['reading', 'preparing', 'finding pairs', 'counting pairs', 'writing'])
        self.assertIn(b'wrote ', shown)

    def test_names_of_files_cannot_become_page(self):
        name = 'x<script>alert(1)<.npy'
        scene_files.save_boxes(self.path(name), scene_files.random_boxes(1, 8))
        scene, text = self.check_export(self.path(name))
        self.assertEqual(scene['title'], name)
        self.assertNotIn('alert(1)', text)

    def test_failures_leave_nothing_behind(self):
        scene_files.save_boxes(self.path('boxes.npy'), scene_files.random_boxes(1, 8))
        scene_files.save_boxes(self.path('nan.npy'), [(0, 0, 0, 1, 1, math.nan)])
        before = sorted(os.listdir(self.folder))
        for status, arguments in ((4, [self.path('boxes.npy'), '--export', self.path('none/page.html')]),
                                  (3, [self.path('nan.npy'), '--export', self.path('page.html')]),
                                  (4, [self.path('boxes.npy'), '--export', '/proc/page.html'])):
            done = self.run_program('view', *arguments, '--quiet')
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), before)
        if os.geteuid() != 0:
            os.mkdir(self.path('locked'), 0o500)
            done = self.run_program('view', self.path('boxes.npy'), '--export', self.path('locked/page.html'), '--quiet')
            self.assertEqual((done.returncode, os.listdir(self.path('locked'))), (4, []))


if __name__ == '__main__':
    main(__doc__)
