#!/usr/bin/env bash
# Checks outputs with other people's readers; see README.md beside this file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
readers=${READERS:-$scratch/readers}
mkdir -p "$readers"

# Makes the environment $1 with the packages that follow, unless it is there.
environment() {
    local place=$readers/$1
    shift
    [[ -e $place/complete ]] && return 0
    rm -rf "$place"
    python3 -m venv "$place"
    "$place/bin/pip" install --quiet --disable-pip-version-check "$@" && touch "$place/complete"
}

environment main OpenEXR OpenImageIO trimesh numpy scipy rtree pillow
environment meshlab pymeshlab || echo "run.sh: no PyMeshLab here" >&2
[[ ${BLENDER:-yes} == no ]] || environment blender bpy || echo "run.sh: no Blender here" >&2
if command -v npm >/dev/null && [[ ! -d $readers/npm/node_modules/gltf-validator ]]; then
    npm install --silent --prefix "$readers/npm" gltf-validator >&2 || echo "run.sh: no glTF validator here" >&2
fi

if (($# == 0)); then
    (cd "$here/../.." && cargo build --release)
    set -- "${CARGO_TARGET_DIR:-$here/../../target}/release/homeo"
fi
"$readers/main/bin/python" -B "$here/main.py" --readers "$readers" --scratch "$scratch" "$@"
