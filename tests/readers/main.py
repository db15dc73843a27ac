"""Checks finished maps with other people's readers; without folders, maps generated pairs first."""

import argparse
import subprocess
import sys
from pathlib import Path

import baked  # noqa: F401, holds checks
import carried  # noqa: F401, holds checks
import images  # noqa: F401, holds checks
import meshes  # noqa: F401, holds checks
from checks import run_all
from finished import FinishedMap


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readers", required=True, help="folder with the environments of run.sh")
    parser.add_argument("--scratch", required=True, help="folder for inputs and outputs")
    parser.add_argument("program")
    parser.add_argument("folders", nargs="*", help="finished maps")
    args = parser.parse_args()
    maps = [(folder, None) for folder in args.folders] or list(generated(args.program, Path(args.scratch)))
    failed = sum(
        run_all(FinishedMap(folder, args.program, args.readers, args.scratch, layered)) for folder, layered in maps
    )
    print(f"{len(maps)} maps, {failed} failed checks")
    return 1 if failed else 0


def generated(program, scratch):
    """The demo's pairs and an open pair, each mapped with flat and with layered images."""
    demo = scratch / "demo"
    run(program, "demo", demo)
    write_open_pair(demo / "caps")
    map_pair(program, demo / "caps", demo / "caps" / "map")
    for pair in sorted(path.parent for path in demo.glob("*/map")):
        map_pair(program, pair, pair / "layered", "--layered")
        yield pair / "map", pair / "layered"


def map_pair(program, pair, out, *flags):
    landmarks = pair / "landmarks.csv"
    run(program, "map", pair / "source.obj", pair / "target.obj", "--landmarks", landmarks, "--out", out, *flags)


def run(program, *arguments):
    subprocess.run([program, *map(str, arguments), "--quiet"], check=True)


def write_open_pair(folder):
    """Two bent squares of quads, the corners and the middle of which correspond."""
    folder.mkdir()
    sizes = {"source": (20, 0.3), "target": (26, -0.5)}
    for name, (n, bend) in sizes.items():
        (folder / f"{name}.obj").write_text(bent_square(n, bend))
    marks = [[0, n, n * (n + 2), n * (n + 1), n // 2 * (n + 2)] for n, _ in sizes.values()]
    rows = [f"mark {i},{s},{t}" for i, (s, t) in enumerate(zip(*marks))]
    (folder / "landmarks.csv").write_text("\n".join(["name,source_vertex,target_vertex", *rows, ""]))


def bent_square(n, bend):
    """The square [-1, 1]^2 of n x n quads, bent into a saddle; vertex (i, j) is number j (n + 1) + i."""
    at = [2 * i / n - 1 for i in range(n + 1)]
    lines = [f"v {x} {y} {bend * (x * x - y * y)}" for y in at for x in at]
    lines += [f"vt {i / n} {j / n}" for j in range(n + 1) for i in range(n + 1)]
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i + 1
            lines.append("f " + " ".join(f"{v}/{v}" for v in (a, a + 1, a + n + 2, a + n + 1)))
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    sys.exit(main())
