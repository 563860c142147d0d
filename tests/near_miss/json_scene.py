"""JSON scenes, by docs/formats.md."""
import math

import strict_json
from values import Refused, computed, number, text

OBJECT_KEYS = ("name", "shape", "position", "rotation", "end_position", "end_rotation", "padding", "group", "mask", "parent")
NAMES = ("ball", "rad vorn", "tür", "a/b", 'x "y"', "")


def _length(source):
    return source.choice((1, 0.5, 2.25, 1e-3, 3e2, round(source.uniform(0.1, 5), 3)))


def _point(source):
    return [source.choice((0, -1, 2.5, round(source.uniform(-9, 9), 2), 1e3)) for _ in range(3)]


def _triangles(source, vertices):
    return [[source.randrange(vertices) for _ in range(3)] for _ in range(source.randrange(3))]


def _shape(source):
    kind = source.choice(("sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "plane", "convex_hull", "mesh", "file"))
    if kind == "sphere":
        return {"type": kind, "radius": _length(source)}
    if kind == "box":
        return {"type": kind, "half_extents": [_length(source) for _ in range(3)]}
    if kind in ("capsule", "cylinder", "cone"):
        return {"type": kind, "radius": _length(source), "length": _length(source)}
    if kind == "ellipsoid":
        return {"type": kind, "radii": [_length(source) for _ in range(3)]}
    if kind == "plane":
        return {"type": kind, "normal": [0, source.choice((1, -0.5)), 0], "offset": source.choice((0, -2, 1.5))}
    if kind == "convex_hull":
        return {"type": kind, "points": [_point(source) for _ in range(source.randrange(1, 4))]}
    if kind == "file":
        return {"type": "mesh", "file": source.choice(("a.obj", "sub/b.stl"))}
    vertices = [_point(source) for _ in range(source.randrange(3, 5))]
    return {"type": kind, "vertices": vertices, "triangles": _triangles(source, len(vertices))}


def _object(source, shared):
    made = {"shape": source.choice(shared) if shared and source.random() < 0.5 else _shape(source)}
    choices = {
        "name": lambda: source.choice(NAMES),
        "position": lambda: _point(source),
        "rotation": lambda: [source.choice((1, 0.5, -0.7071, 0)) for _ in range(3)] + [2],
        "end_position": lambda: _point(source),
        "end_rotation": lambda: [source.choice((1, 0.5)), 0, 0, source.choice((0, -1))],
        "padding": lambda: source.choice((0, 0.25, 1)),
        "group": lambda: source.choice((0, 1, 6, 4294967295)),
        "mask": lambda: source.choice((0, 3, 255)),
        "parent": lambda: source.choice(NAMES),
    }
    for key, make_value in choices.items():
        if source.random() < 0.3:
            made[key] = make_value()
    return made


def make(source):
    """Returns a valid file."""
    scene = {}
    shared = source.sample(("wheel", "rad", "s p"), source.randrange(3))
    if shared or source.random() < 0.2:
        scene["shapes"] = {name: _shape(source) for name in shared}
    scene["objects"] = [_object(source, shared) for _ in range(source.randrange(1, 4))]
    return strict_json.write(source, scene)


def _above_zero(value):
    value = strict_json.number(value)
    if not value > 0:
        raise Refused
    return value


def _at_least_zero(value):
    value = strict_json.number(value)
    if not value >= 0:
        raise Refused
    return value


def _numbers(value, length, read=strict_json.number):
    return [read(item) for item in strict_json.array(value, length)]


class _Shapes:
    """Reads shapes. `files` are words of the mesh files that they name, in their order."""

    def __init__(self):
        self.files = []

    def words(self, value):
        kind = strict_json.text(value.get("type")) if isinstance(value, dict) else ""
        readers = {"sphere": self._round, "capsule": self._round, "cylinder": self._round, "cone": self._round, "box": self._sides,
                   "ellipsoid": self._sides, "plane": self._plane, "convex_hull": self._hull, "mesh": self._mesh}
        if kind not in readers:
            raise Refused
        return [kind, *readers[kind](kind, value)]

    @staticmethod
    def _round(kind, value):
        keys = ("radius",) if kind == "sphere" else ("radius", "length")
        strict_json.fields(value, ("type", *keys), keys)
        words = [number(_above_zero(value["radius"]))]
        if kind != "sphere":
            words.append(number((_at_least_zero if kind == "capsule" else _above_zero)(value["length"])))
        return words

    @staticmethod
    def _sides(kind, value):
        key = "half_extents" if kind == "box" else "radii"
        strict_json.fields(value, ("type", key), (key,))
        return [number(side) for side in _numbers(value[key], 3, _above_zero)]

    @staticmethod
    def _plane(_, value):
        strict_json.fields(value, ("type", "normal", "offset"), ("normal", "offset"))
        normal = _numbers(value["normal"], 3)
        if not any(normal):
            raise Refused
        return [number(item) for item in (*normal, strict_json.number(value["offset"]))]

    @staticmethod
    def _points(value):
        return [number(item) for point in strict_json.array(value) for item in _numbers(point, 3)]

    def _hull(self, _, value):
        strict_json.fields(value, ("type", "points"), ("points",))
        words = self._points(value["points"])
        if not words:
            raise Refused
        return words

    def _mesh(self, _, value):
        if "file" in value:
            strict_json.fields(value, ("type", "file"))
            self.files += ["file", text(strict_json.text(value["file"]))]
            return []
        strict_json.fields(value, ("type", "vertices", "triangles"), ("vertices", "triangles"))
        words = self._points(value["vertices"])
        for corners in strict_json.array(value["triangles"]):
            words += [str(strict_json.whole(corner, len(value["vertices"]) - 1)) for corner in strict_json.array(corners, 3)]
        return words


def _pose(place, turn):
    """Returns the words of three rows of a matrix, of a place and a quaternion w, x, y, z."""
    length = math.hypot(*turn)
    if not 0 < length < math.inf:
        raise Refused
    w, x, y, z = (part / length for part in turn)
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)), (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return [word for row, shift in zip(rows, place) for word in (*map(computed, row), number(shift))]


def _poses(value):
    place = _numbers(value.get("position", [0, 0, 0]), 3)
    turn = _numbers(value.get("rotation", [1, 0, 0, 0]), 4)
    end_place = _numbers(value["end_position"], 3) if "end_position" in value else place
    end_turn = _numbers(value["end_rotation"], 4) if "end_rotation" in value else turn
    return _pose(place, turn) + _pose(end_place, end_turn)


class _Parents:
    """Gives numbers to parents. An object without a parent has a number of its own."""

    def __init__(self):
        self._known, self._next = {}, 0

    def number_of(self, name):
        if name in self._known:
            return self._known[name]
        self._next += 1
        if name is not None:
            self._known[name] = self._next - 1
        return self._next - 1


def read(data):
    """Returns the objects with their shapes and poses."""
    root = strict_json.fields(strict_json.load(data), ("objects", "shapes"), ("objects",))
    shapes, parents, words = _Shapes(), _Parents(), []
    shared = root.get("shapes", {})
    if not isinstance(shared, dict):
        raise Refused
    shared = {name: shapes.words(shared[name]) for name in sorted(shared, key=str.encode)}
    for value in strict_json.array(root["objects"]):
        value = strict_json.fields(value, OBJECT_KEYS, ("shape",))
        words.append(text(strict_json.text(value.get("name", ""))))
        if isinstance(value["shape"], str):
            if value["shape"] not in shared:
                raise Refused
            words += shared[value["shape"]]
        else:
            words += shapes.words(value["shape"])
        words += _poses(value)
        words.append(number(_at_least_zero(value.get("padding", 0))))
        words += [str(strict_json.whole(value.get("group", 1))), str(strict_json.whole(value.get("mask", 4294967295)))]
        parent = strict_json.text(value["parent"]) if "parent" in value else None
        words += [str(parents.number_of(parent)), text(parent or "")]
    return shapes.files + words
