"""Images carried through a map, in the readers."""

import csv

import numpy
import OpenImageIO
from checks import check, need
from PIL import Image as Pillow

SIZE = 256

# Texels by which a carried ramp may be off: filtering, and the texel that stands for a vertex.
TEXELS = 4


def textured(finished):
    """The source and the target, both with texture coordinates."""
    need(finished.knows("transfer", "--normal-map"), "the program carries no images")
    source, target = finished.sides()
    need(len(getattr(source.mesh, "uv", [])), "the source has no texture coordinates")
    need(len(getattr(target.mesh, "uv", [])), "the target has no texture coordinates")
    need((finished.folder / "map.bin").is_file(), "the map at every point is not there")
    return source, target


def plain(spec):
    """Asks for the numbers in the file, which OpenImageIO multiplies with alpha otherwise."""
    spec.attribute("oiio:UnassociatedAlpha", 1)
    return spec


def read(path):
    """Pixels as numbers in OpenImageIO."""
    file = OpenImageIO.ImageInput.open(str(path), plain(OpenImageIO.ImageSpec()))
    assert file is not None, OpenImageIO.geterror()
    pixels = numpy.array(file.read_image(OpenImageIO.UNKNOWN))
    file.close()
    return pixels


def ramp():
    """Texture coordinates as colours, with alpha that falls along u: floats from 0 to 1, row by row from the top."""
    at = (numpy.arange(SIZE) + 0.5) / SIZE
    u, v = numpy.meshgrid(at, 1 - at)
    return numpy.stack([u, v, numpy.zeros_like(u), 1 - u / 2], axis=-1)


def write(path, pixels, kind):
    out = OpenImageIO.ImageOutput.create(str(path))
    assert out is not None, OpenImageIO.geterror()
    assert out.open(str(path), plain(OpenImageIO.ImageSpec(SIZE, SIZE, pixels.shape[2], kind))), out.geterror()
    assert out.write_image(numpy.ascontiguousarray(pixels)), out.geterror()
    out.close()


def vertex_uv(side):
    """A texture coordinate of every vertex, and which vertices have only one."""
    vertices = numpy.concatenate(side.mesh.polygons)
    uv = side.mesh.uv[numpy.concatenate(side.mesh.corner_uv)]
    some = numpy.zeros((len(side.mesh.positions), 2))
    some[vertices] = uv
    alone = numpy.ones(len(some), bool)
    alone[vertices[numpy.abs(some[vertices] - uv).max(1) > 0]] = False
    return some, alone


@check
def carried_images_show_what_the_table_of_points_says(finished):
    source, target = textured(finished)
    with open(finished.folder / "target_on_source.csv", newline="") as file:
        rows = list(csv.reader(file))[1:]
    table = numpy.array([[float(x) for x in row] for row in rows])
    vertices, faces, weights = table[:, 0].astype(int), table[:, 1].astype(int), table[:, 2:]
    fans = [[uv[0], uv[j], uv[j + 1]] for uv in source.mesh.corner_uv for j in range(1, len(uv) - 1)]
    there = (source.mesh.uv[numpy.array(fans)[faces]] * weights[:, :, None]).sum(1)
    uv, alone = vertex_uv(target)
    inner = alone[vertices] & (numpy.abs(uv[vertices] - 0.5).max(1) < 0.5 - 1 / SIZE)
    column, row = (uv[vertices][inner] * [SIZE, -SIZE] + [0, SIZE]).astype(int).T
    expected = numpy.column_stack([there[inner], 0 * there[inner, 0], 1 - there[inner, 0] / 2])
    seen = []
    for name, kind, scale in [("ramp.exr", "float", 1), ("ramp.png", "uint16", 65535)]:
        image, out = finished.scratch / name, finished.scratch / f"carried-{name}"
        write(image, (ramp() * scale).astype({"float": numpy.float32, "uint16": numpy.uint16}[kind]), kind)
        finished.run("transfer", finished.folder, "--texture", image, "--out", out)
        pixels = read(out)
        assert pixels.shape == (SIZE, SIZE, 4) and str(pixels.dtype) in ("float32", "uint16"), (pixels.shape, kind)
        off = numpy.abs(pixels[row, column] / scale - expected).max() * SIZE
        assert off < TEXELS, (name, off)
        seen.append(f"{name} {off:.2f} texels")
    return f"OpenImageIO: {int(inner.sum())} vertices, farthest " + ", ".join(seen)


@check
def flat_normal_maps_stay_flat(finished):
    textured(finished)
    image, out = finished.scratch / "flat.png", finished.scratch / "carried-flat.png"
    flat = numpy.full((SIZE, SIZE, 3), [128, 128, 255], numpy.uint8)
    write(image, flat, "uint8")
    finished.run("transfer", finished.folder, "--texture", image, "--out", out, "--normal-map", "--padding", "infinite")
    pixels = read(out)
    assert numpy.array_equal(pixels, numpy.array(Pillow.open(out))), "OpenImageIO and Pillow differ"
    off = numpy.abs(pixels.astype(int) - flat).max()
    assert off <= 1, off
    return f"OpenImageIO and Pillow: {pixels.shape[1]} x {pixels.shape[0]}, off by {off} of 255"


@check
def a_map_with_a_texture_writes_what_transfer_does(finished):
    source, target = textured(finished)
    landmarks = source.mesh.path.parent / "landmarks.csv"
    need(landmarks.is_file(), "the landmarks are not beside the source")
    image, folder = finished.scratch / "colours.png", finished.scratch / "textured"
    write(image, (ramp()[:, :, :3] * 255).astype(numpy.uint8), "uint8")
    pair = [source.mesh.path, target.mesh.path, "--landmarks", landmarks]
    finished.run("map", *pair, "--out", folder, "--texture", image, "--relax", "none", "--image", 0, "--no-report")
    out = finished.scratch / "carried-colours.png"
    finished.run("transfer", folder, "--texture", image, "--out", out)
    pixels = read(folder / "target_texture.png")
    assert pixels.shape == (SIZE, SIZE, 3) and numpy.array_equal(pixels, read(out))
    return f"OpenImageIO: {pixels.shape[1]} x {pixels.shape[0]}, equal"
