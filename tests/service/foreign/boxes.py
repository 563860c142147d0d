"""Boxes of jobs, and their pairs by an algorithm of this folder, to compare answers of the server with."""
import array
import random

FLOATS = 6  # min x, y, z, max x, y, z


def make_boxes(count, seed, size=0.1):
    """Returns `count` boxes in the unit cube with edges of at most `size`, as an array of float32. Equal seeds give equal boxes."""
    generator = random.Random(seed)
    boxes = array.array("f")
    for _ in range(count):
        lower = [generator.random() for _ in range(3)]
        boxes.extend(lower)
        boxes.extend(low + size * generator.random() for low in lower)
    return boxes


def equal_boxes(count):
    """Returns `count` equal unit boxes: every pair of them touches."""
    return array.array("f", [0, 0, 0, 1, 1, 1] * count)


def find_pairs(boxes):
    """Returns all pairs of touching boxes, ascending, by a sweep along x."""
    rows = [tuple(boxes[i:i + FLOATS]) for i in range(0, len(boxes), FLOATS)]
    order = sorted(range(len(rows)), key=lambda i: rows[i][0])
    pairs = []
    for place, i in enumerate(order):
        _, y, z, max_x, max_y, max_z = rows[i]
        for j in order[place + 1:]:
            other = rows[j]
            if other[0] > max_x:
                break
            if other[1] <= max_y and other[4] >= y and other[2] <= max_z and other[5] >= z:
                pairs.append((i, j) if i < j else (j, i))
    return sorted(pairs)


def pairs_in(data):
    """Returns the pairs that the bytes of an answer hold."""
    numbers = array.array("I", data)
    return list(zip(numbers[::2], numbers[1::2]))
