#!/usr/bin/env python3
"""Reads a BCF 2.1 file without code of octopair, checks it against the schemas of this folder, and prints its topics as JSON.

    read_bcf.py FILE.bcf

Needs xmllint.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile

SCHEMAS = pathlib.Path(__file__).parent


def check(schema, files):
    """Ends the program unless all files have the schema."""
    done = subprocess.run(["xmllint", "--noout", "--relaxng", str(SCHEMAS / schema), *map(str, files)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{schema}: {done.stderr}")


def vector(camera, name):
    return [float(camera.findtext(f"{name}/{axis}")) for axis in "XYZ"]


def components(parent):
    return [one.get("IfcGuid") or one.findtext("AuthoringToolId") for one in parent.findall("Component")]


def topic_of(folder):
    markup = ElementTree.parse(folder / "markup.bcf").getroot()
    topic, viewpoint = markup.find("Topic"), markup.find("Viewpoints")
    assert topic.get("Guid") == folder.name, "the folder of a topic has its GUID"
    view = ElementTree.parse(folder / viewpoint.findtext("Viewpoint")).getroot()
    assert view.get("Guid") == viewpoint.get("Guid")
    camera = view.find("PerspectiveCamera")
    return {
        "guid": folder.name, "status": topic.get("TopicStatus"), "title": topic.findtext("Title"),
        "labels": [label.text for label in topic.findall("Labels")], "description": topic.findtext("Description"),
        "files": [(file.findtext("Filename"), file.get("IfcProject")) for file in markup.findall("Header/File")],
        "comments": [comment.findtext("Comment") for comment in markup.findall("Comment")],
        "selection": components(view.find("Components/Selection")),
        "visible": components(view.find("Components/Visibility/Exceptions")),
        "place": vector(camera, "CameraViewPoint"), "direction": vector(camera, "CameraDirection"), "up": vector(camera, "CameraUpVector"),
    }


def main(path):
    with tempfile.TemporaryDirectory() as name, zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        assert all(entry.date_time == (1980, 1, 1, 0, 0, 0) for entry in archive.infolist())
        folder = pathlib.Path(name)
        archive.extractall(folder)
        check("version.rng", [folder / "bcf.version"])
        topics = sorted(one for one in folder.iterdir() if one.is_dir())
        if topics:
            check("markup.rng", [topic / "markup.bcf" for topic in topics])
            check("viewpoint.rng", [topic / "viewpoint.bcfv" for topic in topics])
        assert 1 + 2 * len(topics) == len(archive.namelist()), "no other entries"
        json.dump([topic_of(topic) for topic in topics], sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1])
