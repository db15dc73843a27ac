"""Compatible meshes, tables of points, rebuilt meshes and morphs in the readers."""

import csv
import json
import shutil
import subprocess
from pathlib import Path

import numpy
import trimesh
from checks import check, need
from finished import Mesh, load

# Share of the diagonal by which double-precision sums may differ.
ROUNDING = 1e-12

# Share by which the volume (or, for open meshes, the area) of a rebuilt mesh may differ from the surface's.
COARSENESS = 0.05


def pairs(finished):
    """(name, its side, the other side) of both compatible meshes, unless vertices were appended."""
    need(not (finished.folder / "source_refined.obj").exists(), "the map is refined")
    source, target = finished.sides()
    return [("source_on_target", source, target), ("target_on_source", target, source)]


@check
def compatible_meshes_keep_order_and_number(finished):
    seen = []
    for name, own, _ in pairs(finished):
        path = finished.folder / f"{name}.obj"
        mesh, plain = load(path), Mesh(path)
        assert len(mesh.vertices) == len(own.mesh.positions) == finished.report[own.name]["vertices"], name
        assert numpy.array_equal(mesh.vertices, plain.positions), f"{name}: vertices in another order"
        assert plain.polygons == own.mesh.polygons, f"{name}: other polygons"
        if max(map(len, plain.polygons)) == 3:
            assert numpy.array_equal(mesh.faces, own.mesh.triangles), f"{name}: faces in another order"
        original = trimesh.Trimesh(own.mesh.positions, own.mesh.triangles, process=False)
        assert (mesh.is_watertight, mesh.euler_number) == (original.is_watertight, original.euler_number), name
        seen.append(f"{name} {len(mesh.vertices)}")
    return "trimesh: vertices: " + ", ".join(seen)


@check
def landmarks_of_compatible_meshes_meet(finished):
    for name, own, other in pairs(finished):
        moved = Mesh(finished.folder / f"{name}.obj").positions
        for landmark in finished.layout["landmarks"]:
            here, there = landmark[f"{own.name}_vertex"], landmark[f"{other.name}_vertex"]
            assert numpy.array_equal(moved[here], other.mesh.positions[there]), (name, landmark)
    return f"{len(finished.layout['landmarks'])} landmarks, exactly, both ways"


@check
def barycentric_tables_reproduce_the_positions(finished):
    worst = 0.0
    for name, own, other in pairs(finished):
        with open(finished.folder / f"{name}.csv", newline="") as file:
            rows = list(csv.reader(file))
        assert rows[0] == ["vertex", "face", "b0", "b1", "b2"], rows[0]
        table = numpy.array([[float(x) for x in row] for row in rows[1:]])
        vertices, faces, weights = table[:, 0].astype(int), table[:, 1].astype(int), table[:, 2:]
        assert len(numpy.unique(vertices)) == len(vertices) <= len(own.mesh.positions), name
        assert weights.min() >= 0 and numpy.abs(weights.sum(1) - 1).max() < 1e-12, name
        corners = other.mesh.positions[other.mesh.triangles[faces]]
        points = (corners * weights[:, :, None]).sum(1)
        moved = Mesh(finished.folder / f"{name}.obj").positions[vertices]
        worst = max(worst, numpy.linalg.norm(points - moved, axis=1).max() / other.mesh.diagonal)
    assert worst < ROUNDING, worst
    return f"farthest {worst:.1e} of the diagonal"


def rebuilt(finished):
    """(side, its rebuilt mesh, the image) from every file that holds positions."""
    need(finished.knows("bake", "--rebuild"), "the program has no bake --rebuild")
    files = [(f"{side.name}_position", side, []) for side in finished.sides()]
    sources = [(finished.folder / "geometry" / f"{name}.exr", side, flags) for name, side, flags in files]
    if finished.layered() is not None:
        sources += [(finished.layered().path, side, ["--layer", side.name]) for side in finished.sides()]
    for path, side, flags in sources:
        if path.is_file():
            out = finished.scratch / f"{path.stem}-{side.name}.obj"
            finished.run("bake", "--rebuild", path, "--out", out, *flags)
            yield side, out, path


@check
def rebuilt_meshes_are_watertight(finished):
    seen = []
    for side, path, image in rebuilt(finished):
        mesh = load(path)
        original = trimesh.Trimesh(side.mesh.positions, side.mesh.triangles, process=False)
        assert mesh.is_winding_consistent and mesh.is_watertight == original.is_watertight, image.name
        assert mesh.euler_number == original.euler_number, (image.name, mesh.euler_number, original.euler_number)
        assert boundary_loops(mesh) == boundary_loops(original), f"{image.name}: boundary loops"
        measure = (lambda m: abs(m.volume)) if original.is_watertight else (lambda m: m.area)
        assert abs(measure(mesh) / measure(original) - 1) < COARSENESS, (image.name, measure(mesh), measure(original))
        assert not original.is_watertight or mesh.volume > 0, f"{image.name}: inside out"
        told = f"{len(mesh.vertices)} vertices, Euler number {mesh.euler_number}, {boundary_loops(mesh)} loops"
        seen.append(f"{image.stem} ({side.name}) {told}")
    return "trimesh: " + "; ".join(seen)


def boundary_loops(mesh):
    """How many pieces the edges with one face fall into."""
    edges = mesh.edges_sorted[trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)]
    return len(trimesh.graph.connected_components(edges)) if len(edges) else 0


@check
def rebuilt_vertices_are_the_pixels_at_their_texture_coordinates(finished):
    count = between = 0
    for side, path, image in rebuilt(finished):
        if image.stem == "geometry":
            continue
        mesh, pixels = Mesh(path), finished.image(image.stem).rgb()
        height, width = pixels.shape[:2]
        uv = mesh.uv[numpy.concatenate(mesh.corner_uv)]
        at = numpy.stack([(1 - uv[:, 1]) * height - 0.5, uv[:, 0] * width - 0.5], axis=-1)
        whole = numpy.abs(at - at.round()).max(1) < 1e-6  # others are the middles of split edges
        row, column = at[whole].round().astype(int).T
        vertices = mesh.positions[numpy.concatenate(mesh.polygons)][whole]
        assert numpy.array_equal(vertices, pixels[row, column].astype(float)), image.name
        count, between = count + int(whole.sum()), between + int((~whole).sum())
    assert between <= count / 20, (between, count)
    return f"{count} corners, exactly; {between} on split edges"


@check
def meshlab_finds_the_rebuilt_meshes_sound(finished):
    python = finished.readers / "meshlab" / "bin" / "python"
    need((python.parent.parent / "complete").is_file(), "PyMeshLab is not installed")
    script = (
        "import json, pymeshlab, sys\nmeshes = pymeshlab.MeshSet()\nmeshes.load_new_mesh(sys.argv[1])\n"
        "print('measures', json.dumps(meshes.get_topological_measures()))"
    )
    seen = []
    for side, path, image in rebuilt(finished):
        done = subprocess.run([python, "-B", "-c", script, path], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-500:]
        measures = json.loads(done.stdout.rsplit("measures ", 1)[1])
        assert measures["non_two_manifold_edges"] == measures["non_two_manifold_vertices"] == 0, measures
        report = finished.report[side.name]
        assert measures["number_holes"] == report["boundary_loops"], measures
        if report["boundary_loops"] == 0:
            assert measures["genus"] == report["genus"], measures
        seen.append(f"{image.stem} ({side.name}) {measures['number_holes']} holes")
    return "MeshLab: manifold: " + ", ".join(seen)


@check
def morph_is_valid_gltf(finished):
    listed = next((line for line in finished.help().splitlines() if line.split()[:1] == ["morph"]), "")
    need(listed and "later version" not in listed, "the program has no morph")
    path = finished.scratch / "morph.glb"
    finished.run("morph", finished.folder, "--out", path)
    mesh = load(path)
    assert len(mesh.faces) == finished.report["source"]["faces"], len(mesh.faces)
    validator = finished.readers / "npm" / "node_modules" / "gltf-validator"
    need(shutil.which("node") and validator.is_dir(), "the glTF validator is not installed")
    script = Path(__file__).with_name("validate.mjs")
    command = ["node", script, validator.parent.parent, path]
    issues = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert issues["numErrors"] == 0, issues["messages"][:3]
    return f"validator: no errors, {issues['numWarnings']} warnings; trimesh: {len(mesh.faces)} faces"
