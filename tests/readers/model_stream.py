"""Reads model streams (docs/formats.md), as a test of their description."""
import dataclasses
import struct


@dataclasses.dataclass
class Shape:
    error: float
    vertices: list
    triangles: list

    def volume_and_middle(self):
        """Returns the volume and the centre of mass of the solid, from the tetrahedra of its triangles and the origin."""
        volume, sums = 0.0, [0.0, 0.0, 0.0]
        for triangle in self.triangles:
            a, b, c = (self.vertices[i] for i in triangle)
            part = (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
            volume += part
            for axis in range(3):
                sums[axis] += part * (a[axis] + b[axis] + c[axis]) / 4
        return volume, [total / volume for total in sums]


@dataclasses.dataclass
class Instance:
    shape: int
    transform: tuple
    name: str

    def place(self, point):
        rows = [self.transform[4 * i:4 * i + 4] for i in range(3)]
        return [row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3] for row in rows]


def read_stream(data):
    """Returns the shapes and the instances of a model stream."""
    if data[:12] != b"OPMODEL\n" + struct.pack("<I", 1):
        raise ValueError("no model stream")
    shapes, instances = [], []
    at, kind = 12, None
    while at < len(data):
        kind, length = struct.unpack_from("<IQ", data, at)
        content = data[at + 12:at + 12 + length]
        at += 12 + length
        if kind == 2:
            error, vertices, triangles = struct.unpack_from("<dII", content)
            shapes.append(Shape(error, list(struct.iter_unpack("<3d", content[16:16 + 24 * vertices])),
                                list(struct.iter_unpack("<3I", content[16 + 24 * vertices:]))))
            if len(shapes[-1].triangles) != triangles:
                raise ValueError("a shape has another length")
        elif kind == 3:
            length_of_name = struct.unpack_from("<I", content, 132)[0]
            instances.append(Instance(struct.unpack_from("<I", content)[0], struct.unpack_from("<16d", content, 4),
                                      content[136:136 + length_of_name].decode()))
    if kind != 7 or at != len(data):
        raise ValueError("the stream has no end")
    return shapes, instances
