#!/usr/bin/env bash
# Times baking, transfer and fronts beside other people's programs; see README.md beside this file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
peers=${PEERS:-$scratch/peers}

if [[ ! -e $peers/complete ]]; then
    rm -rf "$peers"
    python3 -m venv "$peers"
    "$peers/bin/pip" install --quiet --disable-pip-version-check numpy pillow scipy
    for package in open3d pymeshlab; do
        "$peers/bin/pip" install --quiet --disable-pip-version-check "$package" || echo "run.sh: no $package here" >&2
    done
    touch "$peers/complete"
fi

if (($# == 0)); then
    "$peers/bin/python" -B "$here/fronts.py"
    (cd "$here/../.." && cargo build --release)
    set -- "${CARGO_TARGET_DIR:-$here/../../target}/release/homeo"
fi
"$peers/bin/python" -B "$here/bake.py" --scratch "$scratch" "$@"
