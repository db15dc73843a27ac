#!/usr/bin/env bash
# Times baking, transfer, fronts and discs beside other people's programs; see README.md beside this file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
peers=${PEERS:-$scratch/peers}

if [[ ! -e $peers/complete ]]; then
    rm -rf "$peers"
    python3 -m venv "$peers"
    "$peers/bin/pip" install --quiet --disable-pip-version-check numpy pillow scipy
    for package in open3d pymeshlab libigl; do
        "$peers/bin/pip" install --quiet --disable-pip-version-check "$package" || echo "run.sh: no $package here" >&2
    done
    touch "$peers/complete"
fi

if (($# == 0)); then
    "$peers/bin/python" -B "$here/fronts.py" || echo "run.sh: no fronts beside others here" >&2
    "$peers/bin/python" -B "$here/discs.py" || echo "run.sh: no discs beside others here" >&2
    (cd "$here/../.." && cargo build --release)
    set -- "${CARGO_TARGET_DIR:-$here/../../target}/release/homeo"
fi
"$peers/bin/python" -B "$here/bake.py" --scratch "$scratch" "$@"
