"""Maps baked into a mesh's own texture coordinates."""

import numpy
from checks import check, need
from finished import Image

SIZE = 128

# Pixels looked at, and the share of the diagonal by which a position may be off: values are single precision.
SAMPLES, ROUNDING = 500, 1e-6


def covering(uv, points):
    """(triangle, barycentric coordinates) for points in texture space, by looking at every triangle."""
    a, b, c = (uv[:, k][:, None] for k in range(3))
    cross = lambda p, q: p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
    parts = numpy.stack([cross(b - points, c - points), cross(c - points, a - points), cross(a - points, b - points)])
    with numpy.errstate(divide="ignore", invalid="ignore"):
        weights = parts / cross(b - a, c - a)
    triangle = numpy.nan_to_num(weights.min(0), nan=-numpy.inf).argmax(0)
    return triangle, weights[:, triangle, numpy.arange(len(points))].T


@check
def baked_positions_are_those_of_the_texture_coordinates(finished):
    need(finished.knows("bake", "--map"), "the program bakes no maps")
    source = finished.sides()[0].mesh
    need(len(getattr(source, "uv", [])), "the source has no texture coordinates")
    out = finished.scratch / "baked.exr"
    finished.run("bake", source.path, "--out", out, "--map", "position", "--size", SIZE)
    image, mask = Image(out), Image(out.with_name("baked_mask.exr"))
    assert image.spec.channelnames == ("R", "G", "B") and mask.spec.channelnames == ("Y",)
    for each in (image, mask):
        assert (each.spec.width, each.spec.height) == (each.spec.full_width, each.spec.full_height) == (SIZE, SIZE)
        assert all(each.channels[c].tobytes() == each.oiio[c].tobytes() for c in each.channels)
    inside = mask.channels["Y"]
    assert set(numpy.unique(inside)) <= {0.0, 1.0} and inside.any()
    rows, columns = numpy.nonzero(inside)
    chosen = numpy.random.default_rng(1).choice(len(rows), min(SAMPLES, len(rows)), replace=False)
    rows, columns = rows[chosen], columns[chosen]
    points = numpy.stack([(columns + 0.5) / SIZE, 1 - (rows + 0.5) / SIZE], axis=-1)
    fans = [[uv[0], uv[j], uv[j + 1]] for uv in source.corner_uv for j in range(1, len(uv) - 1)]
    triangle, weights = covering(source.uv[numpy.array(fans)], points)
    there = (source.positions[source.triangles[triangle]] * weights[:, :, None]).sum(1)
    off = numpy.linalg.norm(image.rgb()[rows, columns] - there, axis=1).max() / source.diagonal
    assert off < ROUNDING, off
    return f"{len(rows)} of {int(inside.sum())} covered texels, farthest {off:.1e} of the diagonal"
