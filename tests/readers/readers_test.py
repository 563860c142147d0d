#!/usr/bin/env python3
"""Tests octopair-ifc and octopair-step through octopair.

    readers_test.py PROGRAM READERS SAMPLES     PROGRAM: octopair; READERS: the folder of the readers; SAMPLES: the program of step_samples.cpp

IFC files are written by ifc_writer.py, which states their coordinates. Samples of STEP and IGES are written by Open CASCADE, whose exact
geometry has other volumes than the triangles of the reader. floors_2x3.ifc.xz and those of examples/models are models of others.
"""
import csv
import json
import lzma
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile

from ifc_writer import IfcWriter
from model_stream import read_stream

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM, READERS, SAMPLES = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [triangle for a, b, c, d in FACES for triangle in ((a, b, c), (a, c, d))]


def as1():
    """Returns the STEP file of an assembly with 18 parts."""
    models = HERE.parent.parent / "examples" / "models"
    return lzma.decompress((models / "as1_pe_203.stp.xz").read_bytes()).decode()


def cube(low, size):
    return [tuple(a + size * b for a, b in zip(low, corner)) for corner in CUBE]


def house(schema):
    """A wall of 4 x 0.2 x 3 m with a door in its opening, two beams that share a shape, a column, a plinth and a space; in millimetres."""
    file = IfcWriter(schema)
    newer = schema != "IFC2X3"
    last = "$,$" if newer else "$"
    wall = file.element("IFCWALL", "Wall", file.represent([file.block((0, 0, 0), (4000, 200, 3000))]), last, "W" * 22)
    hole = file.element("IFCOPENINGELEMENT", "Hole", file.represent([file.block((1000, -50, 0), (2000, 250, 2000))]), last, contained=False)
    door = file.element("IFCDOOR", "Door", file.represent([file.block((1000, 50, 0), (2000, 100, 2000))]),
                        "$,$,$,$,$,$" if newer else "$,$,$", "D" * 22)
    file.add(f"IFCRELVOIDSELEMENT({file.root('')},$,{wall},{hole})")
    file.add(f"IFCRELFILLSELEMENT({file.root('')},$,{hole},{door})")
    beam = file.mapped(file.block((0, 0, 0), (100, 4000, 200)))
    for k in (0, 1):
        file.element("IFCBEAM", f"Beam {k}", beam((5000 + 1000 * k, 0, 2500)), last)
    corners = cube((8000, 0, 0), 500)
    column = file.triangles(corners, TRIANGLES) if newer else file.brep(corners, FACES)
    file.element("IFCCOLUMN", "B\\X2\\00FC\\X0\\ro", file.represent([column], "Tessellation" if newer else "Brep"), last)
    cut = file.difference(file.block((10000, 0, 0), (12000, 1000, 500)), file.block((10500, -10, 100), (11500, 1010, 600)))
    file.element("IFCFOOTING", "Plinth", file.represent([cut], "CSG"), "$,.NOTDEFINED.")
    file.element("IFCSPACE", "Room", file.represent([file.block((0, 200, 0), (4000, 4000, 3000))]),
                 "$,.ELEMENT.,.INTERNAL.,$" if not newer else "$,.ELEMENT.,.INTERNAL.,$", contained=False)
    return file.text()


class Readers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *words, readers=READERS, status=0, stdin=""):
        path = f"{readers}:{os.environ['PATH']}" if readers else os.environ["PATH"]
        ended = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False, cwd=self.folder, input=stdin,
                               env={**os.environ, "PATH": path})
        self.assertEqual(ended.returncode, status, ended.stderr)
        return ended

    def info(self, name, *words):
        """Returns what `octopair info` says, by the names of its lines."""
        text = self.run_program("info", name, *words).stdout
        return dict(re.match(r"(\S+(?: \S+)*)  +(.*)", line).groups() for line in text.splitlines() if "  " in line)

    def rows(self, name, *words):
        self.run_program("detect", name, "--stage", "features", "--quiet", *words, "--output", "found.csv")
        with open(self.folder / "found.csv", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def stream(self, reader, *words):
        return subprocess.run([READERS / reader, *words], capture_output=True, check=True, cwd=self.folder).stdout

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")

    def test_schemas(self):
        for schema in ("IFC2X3", "IFC4", "IFC4X3_ADD2"):
            with self.subTest(schema):
                self.write("house.ifc", house(schema))
                facts = self.info("house.ifc")
                self.assertEqual(facts["format"], "IFC, read by octopair-ifc")
                self.assertEqual((facts["unit"], facts["axes"]), ("m", "z is up"))
                self.assertEqual(facts["elements"], "6 of 6 with geometry were read")
                self.assertEqual(facts["open meshes"], "0")
                bounds = [round(float(word), 12) for word in facts["bounds"].split() if word != "to"]
                self.assertEqual(bounds, [0, 0, 0, 12, 4, 3])
                self.assertIn("IFCSPACE (1)", facts["not read"])
                # The door is snug in its opening: it touches the wall at both sides and above.
                rows = self.rows("house.ifc", "--tolerance", "1e-6")
                self.assertEqual([(row["a_label"], row["b_label"], row["class"]) for row in rows], [("Wall", "Door", "touching")])
                self.assertEqual(self.rows("house.ifc", "--exclude", "fills"), [])

    def test_shapes_are_shared_and_named(self):
        self.write("house.ifc", house("IFC4"))
        shapes = self.run_program("detect", "house.ifc", "house.ifc", "--stage", "features", "--quiet", "--output", "all.jsonl")
        self.assertEqual(shapes.stdout, "")
        names = {row["a_label"] for row in map(json.loads, (self.folder / "all.jsonl").read_text(encoding="utf-8").splitlines())}
        self.assertIn("Büro", names)
        stream = self.stream("octopair-ifc", "house.ifc")
        shapes, instances = read_stream(stream)
        self.assertEqual((len(shapes), len(instances)), (5, 6))
        # The same stream, read from a file.
        (self.folder / "house.opmodel").write_bytes(stream)
        self.assertEqual(self.info("house.opmodel")["objects"], self.info("house.ifc")["objects"])

    def test_spaces_on_demand(self):
        self.write("house.ifc", house("IFC4"))
        rows = self.rows("house.ifc", "--include-type", "IfcSpace", "--tolerance", "1e-6")
        self.assertIn(("Wall", "Room", "touching"), {(row["a_label"], row["b_label"], row["class"]) for row in rows})

    def test_units_do_not_change_the_tolerance(self):
        found = []
        for prefix, scale in ((".MILLI.", 1000), ("$", 1)):
            file = IfcWriter("IFC4", prefix)
            for k, (low, high) in enumerate((((0, 0, 0), (30, 1, 3)), ((29.999, 0, 0), (60, 1, 3)))):
                block = file.block(*(tuple(scale * c for c in corner) for corner in (low, high)))
                file.element("IFCWALL", f"Wall {k}", file.represent([block]), "$,$")
            self.write("walls.ifc", file.text())
            found.append([(row["class"], round(float(row["depth"]), 6)) for row in self.rows("walls.ifc")])
        self.assertEqual(found, 2 * [[("penetrating", 0.001)]])

    def test_openings_are_cut_from_their_elements_alone(self):
        for first in (True, False):
            file = IfcWriter("IFC4")
            wall = file.mapped(file.block((0, 0, 0), (4000, 200, 3000)))
            for k, y in enumerate((0, 1000)):
                added = file.element("IFCWALL", f"Wall {k}", wall((0, y, 0)), "$,$")
                if first == (k == 0):
                    hole = file.element("IFCOPENINGELEMENT", "Hole", file.represent([file.block((1000, y - 50, 0), (2000, y + 250, 2000))]),
                                        "$,$", contained=False)
                    file.add(f"IFCRELVOIDSELEMENT({file.root('')},$,{added},{hole})")
            self.write("walls.ifc", file.text())
            shapes, instances = read_stream(self.stream("octopair-ifc", "walls.ifc"))
            volumes = [round(shapes[instance.shape].volume_and_middle()[0] / 1e9, 6) for instance in instances]
            self.assertEqual(volumes, [2.0, 2.4] if first else [2.4, 2.0])

    def test_materials_of_types(self):
        file = IfcWriter("IFC4")
        wall = file.element("IFCWALL", "Wall", file.represent([file.block((0, 0, 0), (4000, 200, 3000))]), "$,$")
        kind = file.add(f"IFCWALLTYPE({file.root('Kind')},$,$,$,$,$,$,.STANDARD.)")
        file.add(f"IFCRELDEFINESBYTYPE({file.root('')},$,({wall}),{kind})")
        concrete = file.add("IFCMATERIAL('Concrete',$,$)")
        file.add(f"IFCRELASSOCIATESMATERIAL({file.root('')},$,({kind}),{concrete})")
        self.write("wall.ifc", file.text())
        self.run_program("detect", "wall.ifc", "wall.ifc", "--stage", "features", "--quiet", "--output", "all.jsonl")
        self.assertEqual(json.loads((self.folder / "all.jsonl").read_text(encoding="utf-8"))["a_material"], "Concrete")

    def test_what_is_no_body(self):
        file = IfcWriter("IFC4")
        body = file.represent([file.block((0, 0, 0), (1000, 1000, 1000))])
        others = []
        for kind in ("Clearance", "Body-Fallback"):
            other = file.represent([file.block((0, -3000, 0), (1000, 0, 1000))])
            file.lines[int(other[1:]) - 1] = file.lines[int(other[1:]) - 1].replace("'Body'", f"'{kind}'")
            others.append(other)
        file.element("IFCPUMP", "Pump", ",".join([body, *others]), "$,$")
        self.write("pump.ifc", file.text())
        self.assertEqual(self.info("pump.ifc")["triangles"], "12")

    def test_lost_elements_are_named(self):
        file = IfcWriter("IFC4")
        file.element("IFCWALL", "Whole", file.represent([file.block((0, 0, 0), (1000, 200, 3000))]), "$,$")
        file.add(f"IFCWALL({file.root('Lost')},$,$,$,#99999,$,$)")
        self.write("lost.ifc", file.text())
        facts = self.info("lost.ifc")
        self.assertEqual(facts["elements"], "1 of 2 with geometry were read")
        self.assertIn("Lost", self.run_program("info", "lost.ifc").stdout)

    def test_archives(self):
        with zipfile.ZipFile(self.folder / "house.ifczip", "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("model.ifc", house("IFC4"))
        self.assertEqual(self.info("house.ifczip")["elements"], "6 of 6 with geometry were read")

    def test_standard_input_and_odd_names(self):
        text = house("IFC4")
        count = self.run_program("detect", "-", "--count-only", "--quiet", stdin=text).stdout
        for name in ("-house.ifc", "a 'b' \"c\".ifc", "line\nbreak.ifc"):
            self.write(name, text)
            self.assertEqual(self.run_program("detect", f"./{name}", "--count-only", "--quiet").stdout, count)
            self.assertEqual(self.run_program("detect", f"./{name}", "--count-only", "--quiet", "--reader",
                                              str(READERS / "octopair-ifc")).stdout, count)

    def test_damage(self):
        text = house("IFC4")
        self.write("cut.ifc", text[:len(text) // 2])
        self.assertIn("cut.ifc: is cut", self.run_program("info", "cut.ifc", status=3).stderr)
        self.write("other.ifc", text.replace("'IFC4'", "'IFC9'"))
        self.assertIn("other.ifc: ", self.run_program("info", "other.ifc", status=3).stderr)
        self.write("cut.stp", as1()[:40000])
        self.assertIn("cut.stp: ", self.run_program("info", "cut.stp", status=3).stderr)

    def test_floors(self):
        (self.folder / "floors.ifc").write_bytes(lzma.decompress((HERE / "floors_2x3.ifc.xz").read_bytes()))
        self.assertEqual(self.info("floors.ifc")["objects"], "59 meshes")
        classes = {row["class"] for row in self.rows("floors.ifc", "--tolerance", "0.002")}
        self.assertLessEqual(classes, {"touching", "penetrating"})

    def test_as1(self):
        text = as1()
        self.write("as1.stp", text)
        facts = self.info("as1.stp")
        self.assertEqual((facts["format"], facts["unit"]), ("STEP, read by octopair-step", "mm"))
        self.assertEqual((facts["objects"], facts["open meshes"]), ("18 meshes", "0"))
        self.assertEqual(facts["elements"], "18 of 18 with geometry were read")
        rows = self.rows("as1.stp")
        self.assertEqual({row["class"] for row in rows}, {"touching"})
        labels = {row[side] for row in rows for side in ("a_label", "b_label")}
        self.assertEqual({re.sub(r"\d+$", "", label.lower()) for label in labels} & {"bolt", "nut"}, {"bolt", "nut"}, labels)

    def test_a_moved_bolt(self):
        text = as1()
        # The place of a bolt with its nut in its bracket, which occurs twice. Lengths are inches.
        place = "#2410=CARTESIAN_POINT('',(0.E0,1.E1,2.E1));"
        self.assertIn(place, text)
        self.write("moved.stp", text.replace(place, f"#2410=CARTESIAN_POINT('',({1 / 25.4:.17f},1.E1,2.E1));"))
        rows = self.rows("moved.stp", "--classes", "penetrating,contained,duplicate")
        self.assertEqual(len(rows), 4)
        for row in rows:
            self.assertIn("BOLT", row["a_name"] + row["b_name"])
            self.assertAlmostEqual(float(row["depth"]), 1, delta=0.001)

    def test_samples_have_their_exact_volumes(self):
        lines = subprocess.run([SAMPLES, self.folder], capture_output=True, text=True, check=True).stdout.splitlines()
        wanted = [json.loads(line) for line in lines]
        for name in ("ap203.step", "ap214.stp", "ap242.stp", "solids.igs", "surfaces.iges"):
            with self.subTest(name):
                facts = self.info(name)
                self.assertEqual((facts["objects"], facts["open meshes"]), ("9 meshes", "0"))
                shapes, instances = read_stream(self.stream("octopair-step", "--chord", "0.02", name))
                left = list(wanted)
                for instance in instances:
                    shape = shapes[instance.shape]
                    volume, middle = shape.volume_and_middle()
                    middle = instance.place(middle)
                    part = min(left, key=lambda one: math.dist(one["middle"], middle))
                    left.remove(part)
                    # The triangles are at most the error away from the surface.
                    self.assertLess(abs(volume - part["volume"]), part["area"] * shape.error, part)
                    self.assertLess(math.dist(part["middle"], middle), shape.error, part)
                    if not name.startswith("s"):
                        self.assertEqual(instance.name, part["name"])
                self.assertEqual(left, [])
        # Open CASCADE writes the names of some solids alone into IGES.
        names = {instance.name for instance in read_stream(self.stream("octopair-step", "solids.igs"))[1]}
        self.assertLessEqual({"Sample/Ball", "Sample/Ring", "Sample/Pin"}, names)
        self.assertEqual(len(names), 9)

    def test_errors_are_true(self):
        subprocess.run([SAMPLES, self.folder], capture_output=True, check=True)
        for chord in ((), ("--chord", "1")):
            shapes, instances = read_stream(self.stream("octopair-step", *chord, "ap203.step"))
            ball = shapes[next(instance.shape for instance in instances if instance.name == "Sample/Ball")]
            for triangle in ball.triangles:
                corners = [ball.vertices[i] for i in triangle]
                middle = [sum(coordinates) / 3 for coordinates in zip(*corners)]
                self.assertLess(15 - math.hypot(*middle), ball.error * (1 + 1e-9))

    def test_a_part_in_a_housing_is_free(self):
        subprocess.run([SAMPLES, self.folder], capture_output=True, check=True)
        for name in ("ap203.step", "solids.igs", "surfaces.iges"):
            self.assertEqual(self.rows(name), [])
        self.assertIn("are read as cavities, not as objects: 1\n", self.run_program("info", "surfaces.iges").stdout)

    def test_odd_parts(self):
        subprocess.run([SAMPLES, self.folder], capture_output=True, check=True)
        shapes, instances = read_stream(self.stream("octopair-step", "odd.stp"))
        names = [instance.name for instance in instances]
        self.assertEqual(names, ["Odd/Speck", "Odd/Same", "Odd/Same#2", "Odd/Same#2#2"])
        self.assertAlmostEqual(shapes[instances[0].shape].volume_and_middle()[0], 1.25e-10, delta=1e-12)

    def test_odd_names_in_iges(self):
        subprocess.run([SAMPLES, self.folder], capture_output=True, check=True)
        text = (self.folder / "solids.igs").read_bytes()
        for name, read in ((b"4HB\xfcll;", "Sample/B\u00fcll"), (b";      ", None)):
            self.assertEqual(text.count(b"406,1,4HBall;"), 1)
            (self.folder / "names.igs").write_bytes(text.replace(b"406,1,4HBall;", b"406,1," + name))
            names = {instance.name for instance in read_stream(self.stream("octopair-step", "names.igs"))[1]}
            self.assertEqual(len(names), 9)
            self.assertTrue(read is None or read in names, names)

    def test_chord(self):
        subprocess.run([SAMPLES, self.folder], capture_output=True, check=True)
        counts = [sum(len(shape.triangles) for shape in read_stream(self.stream("octopair-step", *words, "ap203.step"))[0])
                  for words in ((), ("--chord", "0.1"), ("--chord", "1"))]
        self.assertEqual(counts, sorted(counts, reverse=True))
        self.assertGreater(counts[0], 5 * counts[2])
        self.run_program("detect", "ap203.step", "--stage", "features", "--chord", "0.5", "--quiet", "--stats", "s.json", "--output", "p.csv")
        self.assertAlmostEqual(json.loads((self.folder / "s.json").read_text(encoding="utf-8"))["tolerance"], 1.0, places=12)

    def test_lost_solids_are_counted(self):
        text = as1()
        shells = re.findall(r"#\d+=CLOSED_SHELL\([^;]*;", text)
        self.assertEqual(len(shells), 5)
        self.write("lost.stp", text.replace(shells[1], ""))  # of the bracket, which occurs twice
        facts = self.info("lost.stp")
        self.assertEqual((facts["objects"], facts["elements"]), ("16 meshes", "16 of 17 with geometry were read"))
        shown = self.run_program("info", "lost.stp").stdout
        self.assertIn("1 of 17 elements with geometry were not read: 1 solid, the first is #", shown)
        self.assertIn("Open CASCADE finds 2 faults, so parts may be missing", shown)

    def test_missing_readers(self):
        self.write("as1.stp", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\n")
        refused = self.run_program("info", "as1.stp", readers=None, status=3).stderr
        self.assertIn("install octopair-step", refused)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
