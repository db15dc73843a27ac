"""Times `homeo bake` and `homeo transfer` beside Open3D's bake and MeshLab's transfer, on wavy sheets made here.

Every program starts from the files of the meshes; `homeo` and MeshLab end with files as well, Open3D with an image in memory.
Times are the least of several runs, one program after the other.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

import numpy

# Quads along a side: 10082, 100352 and 500000 triangles.
LADDER = [71, 224, 500]
SIZES = [1024, 4096]
# The map for `homeo transfer` takes a while to make, and its time does not matter here.
MAPPED = [71, 224]
RUNS = 3


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scratch", required=True, type=Path)
    parser.add_argument("--ladder", type=int, nargs="*", default=LADDER, help="quads along a side of the sheets")
    parser.add_argument("program")
    args = parser.parse_args()
    open3d, pymeshlab = found("open3d"), found("pymeshlab")
    print("| job | triangles | texels | homeo | the other | ratio |\n| --- | --- | --- | --- | --- | --- |")
    for n in args.ladder:
        mesh = args.scratch / f"sheet-{n}.obj"
        write_sheet(mesh, n, 0.1)
        for size in SIZES:
            bake(args.program, mesh, n, size, open3d)
    for n in set(args.ladder) & set(MAPPED):
        folder = mapped(args.program, args.scratch, n)
        for size in SIZES:
            transfer(args.program, args.scratch, folder, n, size, pymeshlab)


def found(name):
    """A package, or None and a line that says why."""
    try:
        return __import__(name)
    except (ImportError, OSError) as error:
        print(f"SKIPPED: {name}: {error}", file=sys.stderr)
        return None


def least(job, runs=RUNS):
    """Seconds of the fastest run."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        job()
        times.append(time.perf_counter() - start)
    return min(times)


def run(program, *arguments):
    subprocess.run([program, *map(str, arguments), "--quiet"], check=True)


def row(job, n, size, ours, theirs, other):
    speed = lambda seconds: f"{size * size / seconds / 1e6:.1f} M texels/s ({seconds:.2f} s)"
    told = f"{other}: {speed(theirs)} | {theirs / ours:.1f}" if theirs else f"{other}: skipped | -"
    print(f"| {job} | {2 * n * n} | {size} x {size} | {speed(ours)} | {told} |", flush=True)


def bake(program, mesh, n, size, open3d):
    out = mesh.with_suffix(".exr")
    common = ["bake", mesh, "--out", out, "--size", size, "--padding", 2, "--device", "cpu"]
    theirs = None
    if open3d:
        theirs = least(lambda: by_open3d(open3d, mesh, size), 1 if size > 2048 else RUNS)
    for compression in ("none", "zip"):
        ours = least(lambda: run(program, *common, "--compression", compression))
        row(f"positions, file with compression {compression}", n, size, ours, theirs, "Open3D, which writes none")


def by_open3d(open3d, mesh, size):
    """From the file of the mesh to an image in memory."""
    sheet = open3d.t.io.read_triangle_mesh(str(mesh))
    sheet.vertex["place"] = sheet.vertex.positions
    sheet.bake_vertex_attr_textures(size, {"place"}, margin=2.0, update_material=False)


def mapped(program, scratch, n):
    """The folder of a map from a sheet to one of another shape; with the source's texture beside it."""
    from PIL import Image

    source, target, out = (scratch / name for name in (f"source-{n}.obj", f"target-{n}.obj", f"map-{n}"))
    write_sheet(source, n, 0.1, scratch / "texture.png")
    write_sheet(target, n + 1, 0.09)
    marks = [[0, k, (k + 1) * (k + 1) - 1, k * (k + 1)] for k in (n, n + 1)]
    rows = [f"corner {i},{s},{t}" for i, (s, t) in enumerate(zip(*marks))]
    (scratch / "landmarks.csv").write_text("\n".join(["name,source_vertex,target_vertex", *rows, ""]))
    u, v = numpy.meshgrid(numpy.linspace(0, 1, 1024), numpy.linspace(0, 1, 1024))
    picture = numpy.stack([u, v, 0.5 + 0.5 * numpy.sin(60 * u) * numpy.sin(60 * v)], axis=-1)
    Image.fromarray((255 * picture).astype(numpy.uint8)).save(scratch / "texture.png")
    quick = ["--relax", "none", "--image", 0, "--no-report", "--device", "cpu"]
    run(program, "map", source, target, "--landmarks", scratch / "landmarks.csv", "--out", out, *quick)
    return out


def transfer(program, scratch, folder, n, size, pymeshlab):
    texture, out = scratch / "texture.png", scratch / "carried.png"
    job = lambda: run(program, "transfer", folder, "--texture", texture, "--out", out, "--size", size, "--device", "cpu")
    ours, theirs = least(job), None
    if pymeshlab:
        name = f"meshlab-{size}.png"
        theirs = least(lambda: by_meshlab(pymeshlab, scratch, n, name, size), 1 if size > 2048 else RUNS)
    row("colours to another mesh", n, size, ours, theirs, "MeshLab")


def by_meshlab(pymeshlab, scratch, n, name, size):
    """The source's texture to the target by closest points, which is what MeshLab does."""
    meshes = pymeshlab.MeshSet()
    for side in ("source", "target"):
        meshes.load_new_mesh(str(scratch / f"{side}-{n}.obj"))
    meshes.compute_texcoord_transfer_wedge_to_vertex()
    meshes.transfer_attributes_to_texture_per_vertex(
        sourcemesh=0,
        targetmesh=1,
        attributeenum="Texture Color",
        upperbound=pymeshlab.PercentageValue(5),
        textname=name,
        textw=size,
        texth=size,
        overwrite=False,
        pullpush=True,
    )
    meshes.set_current_mesh(1)
    meshes.save_current_mesh(str(scratch / "meshlab.obj"), save_textures=True)


def write_sheet(path, n, height, texture=None):
    """The square of n x n halved quads as waves; inner vertices are off the grid. Texture coordinates keep a margin."""
    steps = numpy.linspace(0, 1, n + 1)
    u, v = (grid.ravel() for grid in numpy.meshgrid(steps, steps))
    inner = (u > 0) & (u < 1) & (v > 0) & (v < 1)
    noise = numpy.random.default_rng(1)
    u, v = (x + inner * (noise.random(x.size) - 0.5) * 0.4 / n for x in (u, v))
    z = height * numpy.sin(9 * u) * numpy.sin(7 * v)
    i, j = (grid.ravel() for grid in numpy.meshgrid(numpy.arange(n), numpy.arange(n)))
    a = j * (n + 1) + i + 1
    corners = numpy.concatenate([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]], axis=1).T
    with open(path, "w") as file:
        if texture:
            path.with_suffix(".mtl").write_text(f"newmtl skin\nmap_Kd {texture.name}\n")
            file.write(f"mtllib {path.with_suffix('.mtl').name}\nusemtl skin\n")
        numpy.savetxt(file, numpy.stack([u, v, z], axis=1), "v %.9g %.9g %.9g")
        numpy.savetxt(file, 0.02 + 0.96 * numpy.stack([u, v], axis=1), "vt %.9g %.9g")
        numpy.savetxt(file, numpy.repeat(corners, 2, axis=1), "f %d/%d %d/%d %d/%d")


if __name__ == "__main__":
    main()
