"""Small scenes in every format that octopair reads. Each has two contents, whose answers differ."""
import base64
import dataclasses
import io
import json
import struct
import zipfile

# A tetrahedron and its faces. A mesh has two of them, at different places on the x axis.
CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 2))
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def _corners(places):
    return [(x + place, y, z) for place in places for x, y, z in CORNERS]


def _faces(places):
    return [[4 * part + corner for corner in face] for part in range(len(places)) for face in FACES]


def _npy(shape, numbers):
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + struct.pack(f"<{len(numbers)}d", *numbers)


def _rows(places):
    return [number for x in places for number in (x, 0, 0, x + 1, 1, 1)]


def boxes_npy(places):
    return _npy((len(places), 6), _rows(places))


def boxes_csv(places):
    return "".join(f"{x:.2f},0,0,{x + 1:.2f},1,1\n" for x in places).encode()


def paddings(values):
    return _npy((len(values),), values)


def _ball(name, x):
    return {"name": name, "shape": {"type": "sphere", "radius": 1}, "position": [x, 0, 0]}


def balls(places):
    return json.dumps({"objects": [_ball("abcdef"[i], x) for i, x in enumerate(places)]}).encode()


def obj(places):
    parts = []
    for part, place in enumerate(places):
        parts.append(f"o part{part}\n" + "".join("v {} {} {}\n".format(*corner) for corner in _corners([place])))
        parts.append("".join("f " + " ".join(str(4 * part + corner + 1) for corner in face) + "\n" for face in FACES))
    return "".join(parts).encode()


def three_mf(places):
    objects, items = [], []
    for part, place in enumerate(places):
        vertices = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*corner) for corner in _corners([place]))
        triangles = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in FACES)
        objects.append(f'<object id="{part + 1}"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>')
        items.append(f'<item objectid="{part + 1}"/>')
    model = (f'<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>{"".join(objects)}</resources>'
             f'<build>{"".join(items)}</build></model>')
    relationships = ('<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
                     'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model"/></Relationships>')
    package = io.BytesIO()
    with zipfile.ZipFile(package, "w") as archive:
        for name, text in (("_rels/.rels", relationships), ("3D/3dmodel.model", model)):
            archive.writestr(zipfile.ZipInfo(name), text)
    return package.getvalue()


def stl(places):
    solids = []
    for part, place in enumerate(places):
        corners = _corners([place])
        facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corners[corner]) for corner in face) +
                         "endloop\nendfacet\n" for face in FACES)
        solids.append(f"solid part{part}\n{facets}endsolid part{part}\n")
    return "".join(solids).encode()


def _vertices_and_faces(places):
    return "".join("{} {} {}\n".format(*corner) for corner in _corners(places)) + "".join("3 {} {} {}\n".format(*face) for face in _faces(places))


def ply(places):
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
    return (head + "element face 8\nproperty list uchar int vertex_indices\nend_header\n" + _vertices_and_faces(places)).encode()


def off(places):
    return ("OFF\n8 8 0\n" + _vertices_and_faces(places)).encode()


def gltf_data(width):
    corners = [coordinate * (width if axis == 0 else 1) for corner in CORNERS for axis, coordinate in enumerate(corner)]
    return struct.pack("<12f", *corners) + struct.pack("<12H", *(corner for face in FACES for corner in face))


def gltf(place, uri=None):
    """Two instances of one tetrahedron, the second at a place on the x axis."""
    uri = uri or "data:application/octet-stream;base64," + base64.b64encode(gltf_data(1)).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [place, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 2]},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": 72, "uri": uri}]}).encode()


@dataclasses.dataclass(frozen=True)
class Format:
    """A file that changes, and the command that reads it.

    old, new: contents of the file of the same length.
    more: what the file may grow by, besides an end of line.
    others: other files of the command.
    """
    name: str
    arguments: tuple
    old: bytes
    new: bytes
    more: bytes = b"x"
    others: tuple = ()

    def __post_init__(self):
        assert len(self.old) == len(self.new) and self.old != self.new, self.name


NEAR, FAR = (0, 0.5, 5, 5.5), (0, 0.5, 5, 8.5)
PARTS_NEAR, PARTS_FAR = (0, 0.25), (0, 2.25)
BALLS = ("balls.json", balls(NEAR))
WITH_BIN = ("scene.gltf", gltf(0.5, "mesh.bin"))


def _baseline(first, second):
    return f'{{"a":{first},"b":{second}}}\n'.encode()


FORMATS = (
    Format("boxes.npy", ("detect", "boxes.npy"), boxes_npy(NEAR), boxes_npy(FAR), bytes(48)),
    Format("frames.npy", ("detect", "frames.npy"), _npy((2, 2, 6), _rows(NEAR)), _npy((2, 2, 6), _rows(FAR)), bytes(48)),
    Format("spheres.npy", ("detect", "spheres.npy"), _npy((2, 4), (0, 0, 0, 1, 1, 0, 0, 1)), _npy((2, 4), (0, 0, 0, 1, 4, 0, 0, 1)), bytes(32)),
    Format("boxes.csv", ("detect", "boxes.csv"), boxes_csv(NEAR), boxes_csv(FAR), b"0,0,0,9,9,9\n"),
    Format("against.csv", ("detect", "boxes.npy", "--against", "against.csv"), boxes_csv(NEAR), boxes_csv(FAR), b"0,0,0,9,9,9\n",
           (("boxes.npy", boxes_npy(NEAR)),)),
    Format("padding.npy", ("detect", "boxes.npy", "--padding", "padding.npy"), paddings((0, 0, 0, 9)), paddings((0, 0, 0, 0)), bytes(8),
           (("boxes.npy", boxes_npy(NEAR)),)),
    Format("scene.json", ("detect", "scene.json", "--stage", "features"), balls(NEAR), balls(FAR), b" "),
    Format("part.obj", ("detect", "scene.json"), obj(PARTS_NEAR), obj((5, 5.25)), b"v 0 0 0\n",
           (("scene.json", json.dumps({"objects": [_ball("a", 0), {"shape": {"type": "mesh", "file": "part.obj"}, "position": [0, 0, 0.9]}]}).encode()),)),
    Format("mesh.obj", ("detect", "mesh.obj", "--stage", "features"), obj(PARTS_NEAR), obj(PARTS_FAR), b"v 0 0 0\n"),
    Format("mesh.3mf", ("detect", "mesh.3mf", "--stage", "features"), three_mf(PARTS_NEAR), three_mf(PARTS_FAR), b" "),
    Format("mesh.stl", ("detect", "mesh.stl"), stl(PARTS_NEAR), stl(PARTS_FAR), b"solid c\nendsolid c\n"),
    Format("mesh.ply", ("detect", "mesh.ply", "--objects", "triangle", "--stage", "pairs"), ply(PARTS_NEAR), ply(PARTS_FAR), b"0 0 0\n"),
    Format("mesh.off", ("detect", "mesh.off", "--objects", "triangle", "--stage", "pairs"), off(PARTS_NEAR), off(PARTS_FAR), b"# end\n"),
    Format("whole.gltf", ("detect", "whole.gltf"), gltf(0.5), gltf(7.5), b" "),
    Format("scene.gltf", ("detect", "scene.gltf"), gltf(0.5, "mesh.bin"), gltf(7.5, "mesh.bin"), b" ", (("mesh.bin", gltf_data(1)),)),
    Format("mesh.bin", ("detect", "scene.gltf"), gltf_data(1), gltf_data(0.25), b"\0", (WITH_BIN,)),
    Format("rules.json", ("detect", "balls.json", "--exclude", "rules.json"), b'{"ignored_pairs": [["a", "b"]]}', b'{"ignored_pairs": [["c", "d"]]}', b" ",
           (BALLS,)),
    Format("old.jsonl", ("detect", "balls.json", "--baseline", "old.jsonl"), b'{"a_name":"a","b_name":"b","a":0,"b":1}\n',
           b'{"a_name":"c","b_name":"d","a":2,"b":3}\n', b'{"a_name":"a","b_name":"d","a":0,"b":3}\n', (BALLS,)),
)
VIEWED = (
    Format("viewed.npy", ("view", "viewed.npy", "--export", "page.html"), boxes_npy(NEAR), boxes_npy(FAR), bytes(48)),
    Format("viewed.json", ("view", "viewed.json", "--export", "page.html"), balls(NEAR), balls(FAR), b" "),
)
