"""Times one disc laid flat with little stretch beside libigl's SLIM, CGAL's iterative authalic parameterization, and
Yoshizawa's iteration in C++ with Eigen.

`homeo`'s times come from `cargo bench --bench discs`, which also writes the mesh. Yoshizawa's iteration goes on until it gets
no better, as `homeo`'s does; CGAL's as often as it does by itself; SLIM until its normalised L2 stretch is no more than
`homeo`'s with a free boundary, or gets no better. Seconds are those of all threads.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# An iteration that lowers the stretch by a smaller share is the last.
SETTLED = 1e-4
# Of SLIM, at most.
ITERATIONS = 100
# Of CGAL's iteration, its own default.
AUTHALIC = 15


def l2_stretch(points, faces, uv):
    """Root of the mean squared stretch by area, 1 for an isometry up to scale."""
    u, v = uv[faces[:, 1]] - uv[faces[:, 0]], uv[faces[:, 2]] - uv[faces[:, 0]]
    p, q = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    planar = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    spatial = 0.5 * np.linalg.norm(np.cross(p, q), axis=1)
    inverse = 0.5 / planar
    by_x = (p * v[:, 1:] - q * u[:, 1:]) * inverse[:, None]
    by_y = (q * u[:, :1] - p * v[:, :1]) * inverse[:, None]
    squared = 0.5 * ((by_x**2).sum(axis=1) + (by_y**2).sum(axis=1))
    if (planar <= 0).any():
        return np.inf
    return float(np.sqrt((squared * spatial).sum() / spatial.sum() * planar.sum() / spatial.sum()))


def compiled(name, scratch, *flags):
    """A program in C++ beside this file."""
    program = scratch / name
    eigen = subprocess.run(["pkg-config", "--cflags", "eigen3"], capture_output=True, text=True).stdout.split()
    compiler = ["c++", "-O3", "-march=native", "-std=c++17", *(eigen or ["-I/usr/include/eigen3"])]
    subprocess.run([*compiler, str(HERE / f"{name}.cpp"), "-o", str(program), *flags], check=True)
    return program


def told(program, *arguments):
    """What a program prints in its last line; files that it leaves behind stay beside it."""
    command = [str(word) for word in (program, *arguments)]
    lines = subprocess.run(command, check=True, capture_output=True, text=True, cwd=program.parent).stdout
    return lines.strip().splitlines()[-1].split()


def yoshizawa(mesh, scratch):
    """Seconds, stretch and number of solutions of the iteration in C++."""
    seconds, stretch, solved = told(compiled("yoshizawa", scratch), mesh)
    return float(seconds), float(stretch), int(solved)


def authalic(mesh, scratch):
    """Seconds and stretch of CGAL's iteration."""
    program = compiled("authalic", scratch, "-DNDEBUG", "-DCGAL_EIGEN3_ENABLED", "-lgmp", "-lmpfr")
    seconds, stretch = told(program, mesh, AUTHALIC)
    return float(seconds), float(stretch)


def slim(mesh, goal):
    """Seconds, stretch and iterations of SLIM from a harmonic map to the circle, its boundary free."""
    import igl

    points, faces = igl.read_triangle_mesh(str(mesh))
    start = time.process_time()
    boundary = igl.boundary_loop(faces)
    circle = igl.map_vertices_to_circle(np.asfortranarray(points), boundary.astype(np.int32))
    first = igl.harmonic(points, faces, boundary, np.ascontiguousarray(circle), 1)
    area = 0.5 * np.linalg.norm(np.cross(*(points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))), axis=1).sum()
    flat = np.asfortranarray(first * np.sqrt(area / np.pi))
    energy = igl.MappingEnergyType.SYMMETRIC_DIRICHLET
    none = np.zeros(0, dtype=np.int32), np.zeros((0, 2), order="F")
    corners = np.asfortranarray(faces.astype(np.int32))
    data = igl.slim_precompute(np.asfortranarray(points), corners, flat, energy, *none, 0.0)
    seconds = time.process_time() - start
    last = np.inf
    for done in range(1, ITERATIONS + 1):
        start = time.process_time()
        uv = igl.slim_solve(data, 1)[:, :2]
        seconds += time.process_time() - start
        stretch = l2_stretch(points, faces, uv)
        print(f"  SLIM {done:3}: {seconds:7.2f} s  L2 {stretch:.4f}", flush=True)
        if stretch <= goal or stretch > last * (1 - SETTLED):
            break
        last = stretch
    return seconds, stretch, done


def main():
    asked = sys.argv[1:] or ["100000"]
    with tempfile.TemporaryDirectory() as scratch:
        bench = ["cargo", "bench", "--bench", "discs", "--", *asked, "--write", scratch]
        lines = subprocess.run(bench, check=True, capture_output=True, text=True, cwd=ROOT).stdout
        print(lines, end="")
        found = re.findall(r"(\w+) +(\d+) +\S+ s +(\S+) s of threads +L2 (\S+)", lines)
        ours = {way: (float(seconds), float(stretch)) for way, _, seconds, stretch in found}
        mesh = Path(scratch) / "disc.obj"
        seconds, stretch, done = yoshizawa(mesh, Path(scratch))
        share = ours["circle"][0] / seconds
        print(f"circle: Eigen {seconds:.2f} s, solved {done} times, L2 {stretch:.4f}; homeo's share {share:.2f}", flush=True)
        try:
            seconds, stretch = authalic(mesh, Path(scratch))
            share = ours["circle"][0] / seconds
            told_of = f"{AUTHALIC} iterations, L2 {stretch:.4f}; homeo's share {share:.3f}"
            print(f"circle: CGAL {seconds:.2f} s, {told_of}", flush=True)
        except subprocess.CalledProcessError:
            print("SKIPPED: no CGAL here", file=sys.stderr)
        seconds, stretch, done = slim(mesh, ours["free"][1])
        share = ours["free"][0] / seconds
        print(f"free: SLIM {seconds:.2f} s, {done} iterations, L2 {stretch:.4f}; homeo's share {share:.2f}")


if __name__ == "__main__":
    main()
