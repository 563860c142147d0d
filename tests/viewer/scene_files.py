"""Writes scenes for tests of `octopair view`, and finds their pairs by brute force."""
import json
import random
import struct


def write_npy(path, shape, values, kind='<f8'):
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    header = header + ' ' * (-(len(header) + 11) % 64) + '\n'
    code = {'<f8': 'd', '<f4': 'f', '<u4': 'I', '<u8': 'Q'}[kind]
    with open(path, 'wb') as file:
        file.write(b'\x93NUMPY\x01\x00' + struct.pack('<H', len(header)) + header.encode())
        file.write(struct.pack(f'<{len(values)}{code}', *values))


def random_boxes(seed, count, extent=5.0):
    source = random.Random(seed)
    boxes = []
    for _ in range(count):
        low = [source.uniform(0, extent) for _ in range(3)]
        boxes.append((*low, *(c + source.uniform(0, 1) for c in low)))
    return boxes


def moving_boxes(seed, frames, count):
    source = random.Random(seed)
    boxes = random_boxes(seed, count)
    all_frames = []
    for _ in range(frames):
        all_frames.append(boxes)
        boxes = [box if source.random() < 0.7 else tuple(c + w for c, w in zip(box, [source.uniform(-1, 1)] * 6))
                 for box in boxes]
    return all_frames


def save_boxes(path, boxes):
    write_npy(path, (len(boxes), 6), [c for box in boxes for c in box])


def save_moving(path, frames):
    write_npy(path, (len(frames), len(frames[0]), 6), [c for boxes in frames for box in boxes for c in box])


def true_pairs(boxes):
    pairs = []
    for b, y in enumerate(boxes):
        for a in range(b):
            x = boxes[a]
            if all(x[i] <= y[i + 3] and y[i] <= x[i + 3] for i in range(3)):
                pairs.append((a, b))
    return sorted(pairs)


def write_cubes_obj(path):
    """Three named cubes: the first two penetrate, the third is apart."""
    faces = [(1, 3, 2), (1, 4, 3), (5, 6, 7), (5, 7, 8), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 4, 8),
             (3, 8, 7), (4, 1, 5), (4, 5, 8)]
    with open(path, 'w', encoding='utf-8') as file:
        for k, x in enumerate((0.0, 0.75, 10.0)):
            file.write(f'o {["hull", "deck </script>", "mast"][k]}\n')
            for z in (0, 1):
                for (dx, dy) in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    file.write(f'v {x + dx} {dy} {z}\n')
            for face in faces:
                file.write('f ' + ' '.join(str(8 * k + i) for i in face) + '\n')


def write_json_scene(path):
    objects = [{'name': 'ball', 'shape': {'type': 'sphere', 'radius': 1}},
               {'name': 'block', 'shape': {'type': 'box', 'half_extents': [1, 1, 1]}, 'position': [1.5, 0, 0]},
               {'name': 'far', 'shape': {'type': 'sphere', 'radius': 1}, 'position': [50, 0, 0]}]
    with open(path, 'w', encoding='utf-8') as file:
        json.dump({'objects': objects}, file)
