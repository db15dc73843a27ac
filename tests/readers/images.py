"""Geometry images: what the readers see, and whether it agrees with the tile table and the meshes."""

import subprocess
from pathlib import Path

import numpy
import trimesh
from checks import check, need

GREY = {"mask", "stretch"}

# Share of the diagonal by which a pixel may be off the surface: positions are single precision.
ROUNDING = 1e-6


def images(finished):
    names = [name for name in finished.images() if name != "geometry"]
    need(names, "no flat images")
    return {name: finished.image(name) for name in names}


def all_files(finished):
    files = {name: finished.image(name) for name in finished.images()}
    if finished.layered() is not None:
        files["geometry"] = finished.layered()
    need(files, "no images")
    return files


def tile_pixels(table):
    """For every tile its number, its entry, and the row and column of its top left pixel."""
    for number, tile in enumerate(table["tiles"]):
        row, column = divmod(number, table["columns"])
        yield tile, row * table["tile_size"], column * table["tile_size"]


def halves(tile):
    return [half for half in (tile["first"], tile["second"]) if half is not None]


def corner_pixels(table):
    """(landmark, row, column) of the corners of every patch, by the tile table alone."""
    last = table["tile_size"] - 1
    for tile, top, left in tile_pixels(table):
        for half, places in zip(halves(tile), ([(last, last), (0, 0), (last, 0)], [(0, 0), (last, last), (0, last)])):
            for k, (row, column) in enumerate(places):
                yield half["corners"][(half["side"] + k) % 3], top + row, left + column


def side_pixels(table):
    """(arc, rows, columns) of the three sides of every patch, each in the direction of its arc."""
    last = table["tile_size"] - 1
    steps = numpy.arange(last + 1)
    for tile, top, left in tile_pixels(table):
        for number, half in enumerate(halves(tile)):
            ends = [[(last, last), (0, 0), (last, 0)], [(0, 0), (last, last), (0, last)]][number]
            for k in range(3):
                (r0, c0), (r1, c1) = ends[k], ends[(k + 1) % 3]
                rows, columns = top + r0 + (r1 - r0) * steps // last, left + c0 + (c1 - c0) * steps // last
                arc = half["arcs"][(half["side"] + k) % 3]
                yield arc["arc"], *((rows[::-1], columns[::-1]) if arc["reversed"] else (rows, columns))


def expected_mask(table):
    size = table["tile_size"]
    mask = numpy.zeros((table["rows"] * size, table["columns"] * size), bool)
    right, up = numpy.meshgrid(numpy.arange(size), size - 1 - numpy.arange(size))
    for tile, top, left in tile_pixels(table):
        mask[top : top + size, left : left + size] = True if tile["second"] else right + up <= size - 1
    return mask


@check
def channels_are_32_bit_floats(finished):
    seen = []
    for name, image in all_files(finished).items():
        assert image.parts == 1 and all(c.dtype == numpy.float32 for c in image.channels.values()), name
        assert str(image.spec.format) == "float" and not image.spec.channelformats, name
        if name == "geometry":
            layers = {c for c in image.channels if "." in c}
            assert set(image.channels) - layers == {"R", "G", "B"}, image.channels.keys()
        else:
            expected = ("Y",) if name in GREY else ("R", "G", "B")
            assert set(image.channels) == set(expected) and image.spec.channelnames == expected, name
        seen.append(f"{name} {len(image.channels)}")
    return "channels: " + ", ".join(seen)


@check
def data_and_display_windows_agree(finished):
    for name, image in all_files(finished).items():
        assert numpy.array_equal(image.header["dataWindow"], image.header["displayWindow"]), name
        assert numpy.array_equal(image.header["dataWindow"][0], [0, 0]), name
        s = image.spec
        assert (s.x, s.y, s.width, s.height) == (s.full_x, s.full_y, s.full_width, s.full_height), name
        assert "chromaticities" not in image.header, name
    return f"{len(all_files(finished))} files, {s.width} x {s.height}"


@check
def readers_agree_bit_for_bit(finished):
    for name, image in all_files(finished).items():
        assert set(image.channels) == set(image.oiio), name
        for channel, values in image.channels.items():
            assert values.tobytes() == numpy.ascontiguousarray(image.oiio[channel]).tobytes(), (name, channel)
        assert image.oiio_attribute == image.header["homeo"], name
    return "OpenEXR and OpenImageIO, values and attribute"


@check
def metadata_holds_the_tile_table_of_the_layout(finished):
    for name, image in all_files(finished).items():
        data = image.metadata
        assert (data["version"], data["image"], data["colorInteropID"]) == (1, name, "data"), name
        assert data["atlas"] == finished.layout["atlas"], name
        assert (image.spec.width, image.spec.height) == tuple(
            data["atlas"][key] * data["atlas"]["tile_size"] for key in ("columns", "rows")
        ), name
    return f"{len(data['atlas']['tiles'])} tiles of {data['atlas']['tile_size']}"


@check
def landmark_pixels_are_the_landmark_vertices(finished):
    flat, landmarks = images(finished), finished.layout["landmarks"]
    count = 0
    for side in finished.sides():
        pixels = flat[f"{side.name}_position"].rgb()
        for l, row, column in corner_pixels(finished.layout["atlas"]):
            if l < len(landmarks):
                vertex = side.mesh.positions[landmarks[l][f"{side.name}_vertex"]].astype(numpy.float32)
                assert numpy.array_equal(pixels[row, column], vertex), (side.name, l, row, column)
                count += 1
    return f"{count} corners of tiles, equal in single precision"


@check
def borders_of_tiles_agree(finished):
    flat, count = images(finished), 0
    for name, image in flat.items():
        known = {}
        values = numpy.stack([image.channels[c] for c in sorted(image.channels)], axis=-1)
        for arc, rows, columns in side_pixels(finished.layout["atlas"]):
            samples = values[rows, columns]
            assert numpy.array_equal(known.setdefault(arc, samples), samples), (name, arc)
            count += 1
    return f"{count} sides of patches, bit for bit along {len(known)} arcs"


@check
def mask_is_zero_or_one_as_the_tile_table_says(finished):
    mask = images(finished)["mask"].channels["Y"]
    assert set(numpy.unique(mask)) <= {0.0, 1.0}
    assert numpy.array_equal(mask == 1, expected_mask(finished.layout["atlas"]))
    return f"{int(mask.sum())} of {mask.size} pixels inside"


@check
def pixels_lie_on_the_surface(finished):
    flat, worst = images(finished), 0.0
    chosen = numpy.random.default_rng(1)
    for side in finished.sides():
        pixels = flat[f"{side.name}_position"].rgb().reshape(-1, 3).astype(float)
        assert numpy.isfinite(pixels).all(), side.name
        mesh = trimesh.Trimesh(side.mesh.positions, side.mesh.triangles, process=False)
        points = pixels[chosen.choice(len(pixels), min(3000, len(pixels)), replace=False)]
        _, distance, _ = trimesh.proximity.closest_point(mesh, points)
        worst = max(worst, distance.max() / side.mesh.diagonal)
    assert worst < ROUNDING, worst
    return f"farthest {worst:.1e} of the diagonal"


@check
def normals_have_length_one_and_stretch_is_positive(finished):
    flat = images(finished)
    for name in ("source_normal", "target_normal"):
        length = numpy.linalg.norm(flat[name].rgb().astype(float), axis=-1)
        assert numpy.abs(length - 1).max() < 1e-5, name
    stretch = flat["stretch"].channels["Y"]
    assert numpy.isfinite(stretch).all() and stretch.min() > 0
    return f"stretch {stretch.min():.3g} to {stretch.max():.3g}"


@check
def layers_equal_the_flat_files(finished):
    layered = finished.layered()
    need(layered is not None, "no layered file")
    flat, compared = images(finished), 3
    for channel, first in zip("RGB", flat["source_position"].rgb().transpose(2, 0, 1)):
        assert numpy.array_equal(layered.channels[channel], first), channel
    for name, image in flat.items():
        letters = [("Y", "Y")] if name in GREY else [("R", "X"), ("G", "Y"), ("B", "Z")]
        if name.endswith("_uv"):
            letters = [("R", "U"), ("G", "V")]
            assert not image.channels["B"].any(), name
        for letter, axis in letters:
            layer = f"{name.replace('_', '.')}.{axis}"
            assert layered.channels[layer].tobytes() == image.channels[letter].tobytes(), layer
            compared += 1
    assert compared == len(layered.channels), layered.channels.keys()
    return f"{compared} channels"


@check
def blender_sees_the_same(finished):
    python = finished.readers / "blender" / "bin" / "python"
    need((python.parent.parent / "complete").is_file(), "Blender is not installed")
    name, compatible = "source_position", finished.folder / "source_on_target.obj"
    path = images(finished)[name].path
    script = Path(__file__).with_name("blender.py")
    out = finished.scratch / "blender.npz"
    done = subprocess.run([python, "-B", script, path, compatible, out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-500:]
    seen = numpy.load(out)
    assert numpy.array_equal(seen["pixels"][::-1, :, :3], finished.image(name).rgb())
    report = finished.report["source"]
    assert seen["counts"][0] >= report["vertices"], seen["counts"]
    return f"Blender {seen['version']}: {name} bit for bit, {seen['counts'][0]} vertices of source_on_target.obj"
