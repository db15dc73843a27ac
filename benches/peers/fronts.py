"""Times a multi-source front beside SciPy's `dijkstra(min_only=True)`, and beside a queue of buckets and a binary heap in C++
(`fronts.cpp`), on the same graph: a sphere's faces, joined across edges.

`homeo`'s times come from `cargo bench --bench stages -- front`; the others get the graph ready made, `homeo` makes it from the
mesh.
"""

import re
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SITES = 100
RUNS = 5


def sphere(subdivisions):
    """An icosahedron divided so often: vertices on the unit sphere, and triangles."""
    golden = (1 + 5**0.5) / 2
    around = np.array([[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0]])
    vertices = np.vstack([around, np.roll(around, 1, axis=1), np.roll(around, 2, axis=1)])
    distance = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    near = distance < 2.1
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if near[a, b] and near[b, c] and near[c, a]
    ]
    faces = np.array(faces)
    for _ in range(subdivisions):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, inverse = np.unique(edges, axis=0, return_inverse=True)
        middle = inverse.reshape(3, -1).T + len(vertices)
        vertices = np.vstack([vertices, vertices[unique].mean(axis=1)])
        a, b, c = faces.T
        p, q, r = middle.T
        faces = np.concatenate([np.stack(t, axis=1) for t in [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]])
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def dual(vertices, faces):
    """The graph of the faces; steps between centroids."""
    centroids = vertices[faces].mean(axis=1)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    one, other = (order % len(faces)).reshape(-1, 2).T
    steps = np.linalg.norm(centroids[one] - centroids[other], axis=1)
    rows, columns = np.concatenate([one, other]), np.concatenate([other, one])
    return coo_matrix((np.concatenate([steps, steps]), (rows, columns)), shape=(len(faces),) * 2).tocsr()


def sites_of(graph):
    return np.random.default_rng(1).choice(graph.shape[0], SITES, replace=False)


def scipy_seconds(graph):
    sites = sites_of(graph)
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        dijkstra(graph, indices=sites, min_only=True, return_predecessors=True)
        times.append(time.perf_counter() - start)
    return sorted(times)[RUNS // 2]


def compiled(scratch):
    """The program in C++."""
    program = Path(scratch) / "fronts"
    compiler = ["c++", "-O3", "-march=native", "-std=c++17"]
    subprocess.run([*compiler, str(HERE / "fronts.cpp"), "-o", str(program)], check=True)
    return program


def cpp_seconds(program, graph):
    """Median seconds of the buckets in f32 and of the heap in f64."""
    file = program.with_suffix(".graph")
    sites = sites_of(graph)
    with file.open("wb") as out:
        for numbers in ([graph.shape[0], graph.nnz, len(sites)], graph.indptr, graph.indices):
            out.write(np.asarray(numbers, "<u4").tobytes())
        out.write(graph.data.astype("<f8").tobytes())
        out.write(np.asarray(sites, "<u4").tobytes())
    told = subprocess.run([str(program), str(file)], check=True, capture_output=True, text=True).stdout.split()
    return [float(seconds) for seconds in told]


def homeo_seconds():
    """Median seconds by number of triangles."""
    bench = ["cargo", "bench", "--bench", "stages", "--", "^front/"]
    lines = subprocess.run(bench, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    unit = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}
    found = re.findall(r"front/(\d+)\s+time:\s+\[\S+ \S+ (\S+) (\S+) \S+ \S+\]", lines)
    return {int(faces): float(value) * unit[which] for faces, value, which in found}


def main():
    ours = homeo_seconds()
    print("| triangles | homeo | SciPy | ratio | C++, buckets in f32 | ratio | C++, heap in f64 | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch:
        program = compiled(scratch)
        for subdivisions in [5, 6, 7, 8]:
            graph = dual(*sphere(subdivisions))
            own = ours[graph.shape[0]]
            others = [scipy_seconds(graph), *cpp_seconds(program, graph)]
            cells = " | ".join(f"{1e3 * theirs:.1f} ms | {own / theirs:.2f}" for theirs in others)
            print(f"| {graph.shape[0]:,} | {1e3 * own:.1f} ms | {cells} |", flush=True)


if __name__ == "__main__":
    main()
