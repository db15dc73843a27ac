"""A finished map and its files, as other people's readers see them."""

import json
import subprocess
import warnings
from functools import cache
from pathlib import Path

import numpy
import OpenEXR
import OpenImageIO
import trimesh

# Polygons with other vertices than triangles make trimesh take means of nothing when it reads texture coordinates.
warnings.filterwarnings("ignore", category=RuntimeWarning, module="trimesh")


class Mesh:
    """Positions and polygons in the order of the file."""

    def __init__(self, path):
        self.path = Path(path)
        if self.path.suffix.lower() == ".obj":
            self.positions, self.polygons, self.corner_uv, self.uv = parse_obj(self.path)
        else:
            loaded = load(self.path)
            self.positions, self.polygons = numpy.array(loaded.vertices), loaded.faces.tolist()
        fans = [[p[0], p[j], p[j + 1]] for p in self.polygons for j in range(1, len(p) - 1)]
        self.triangles = numpy.array(fans)

    @property
    def diagonal(self):
        used = self.positions[numpy.unique(self.triangles)]
        return numpy.linalg.norm(used.max(0) - used.min(0))


def parse_obj(path):
    """Vertices, polygons, texture coordinates per corner, and their values, without any library."""
    positions, polygons, uv, corner_uv = [], [], [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            positions.append([float(x) for x in rest[:3]])
        elif word == "vt":
            uv.append([float(x) for x in rest[:2]])
        elif word == "f":
            corners = [corner.split("/") for corner in rest]
            count = [len(positions), len(uv)]
            number = lambda text, k: int(text) - 1 if int(text) > 0 else count[k] + int(text)
            polygons.append([number(c[0], 0) for c in corners])
            corner_uv.append([number(c[1], 1) if len(c) > 1 and c[1] else -1 for c in corners])
    return numpy.array(positions), polygons, corner_uv, numpy.array(uv)


def load(path):
    """A mesh as trimesh reads it, nothing merged or reordered."""
    return trimesh.load(path, process=False, maintain_order=True, force="mesh")


class Image:
    """An EXR file in both readers."""

    def __init__(self, path):
        self.path = path
        with OpenEXR.File(str(path), separate_channels=True) as file:
            self.parts = len(file.parts)
            self.header = dict(file.header())  # emptied when the file is closed
            self.channels = {name: numpy.array(channel.pixels) for name, channel in file.channels().items()}
        file = OpenImageIO.ImageInput.open(str(path))
        assert file is not None, OpenImageIO.geterror()
        self.spec = file.spec()
        self.oiio_attribute = self.spec.getattribute("homeo")
        pixels = file.read_image(OpenImageIO.UNKNOWN)
        self.oiio = {name: pixels[:, :, k] for k, name in enumerate(self.spec.channelnames)}
        file.close()
        self.metadata = json.loads(self.header["homeo"])

    def rgb(self, names="RGB"):
        return numpy.stack([self.channels[name] for name in names], axis=-1)


class Side:
    """The source or the target: its name, its file, and its column in layout.json."""

    def __init__(self, name, mesh):
        self.name, self.mesh = name, mesh


class FinishedMap:
    """The output folder of a map, and the program that wrote it."""

    def __init__(self, folder, program, readers, scratch, layered=None):
        self.folder, self.program, self.readers = Path(folder), program, Path(readers)
        self.name = self.folder.name if self.folder.name != "map" else self.folder.parent.name
        self.layered_folder = layered
        self.scratch = Path(scratch) / f"checks-{self.name}"
        self.scratch.mkdir(parents=True, exist_ok=True)
        self.report = json.loads((self.folder / "report.json").read_text())
        self.layout = json.loads((self.folder / "layout.json").read_text())

    @cache
    def side(self, name):
        """The input called source or target; None if its file is not where it was."""
        named = Path(self.report[name]["file"])
        places = [named, self.folder / named.name, self.folder.parent / named.name]
        found = [place for place in places if place.is_file()]
        return Side(name, Mesh(found[0])) if found else None

    def sides(self):
        from checks import need

        both = [self.side("source"), self.side("target")]
        need(all(both), "the input files are not where they were")
        return both

    def images(self):
        return sorted(path.stem for path in (self.folder / "geometry").glob("*.exr"))

    @cache
    def image(self, name):
        return Image(self.folder / "geometry" / f"{name}.exr")

    @cache
    def layered(self):
        """The layered file of the same map, if there is one."""
        place = Path(self.layered_folder or self.folder) / "geometry" / "geometry.exr"
        return Image(place) if place.is_file() else None

    @cache
    def help(self, command=""):
        arguments = [self.program, *command.split(), "--help"]
        return subprocess.run(arguments, capture_output=True, text=True, check=False).stdout

    def knows(self, command, *flags):
        """True if the program has the command, with these flags."""
        listed = [line for line in self.help().splitlines() if line.split()[:1] == [command]]
        return bool(listed) and all(flag in self.help(command) for flag in flags)

    def run(self, *arguments):
        """Runs the program, which must succeed."""
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"exit code {done.returncode}: {done.stderr.strip()}"
        return done.stdout
