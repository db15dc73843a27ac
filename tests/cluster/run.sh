#!/usr/bin/env bash
# Runs batches on other people's engines; see README.md beside this file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
engines=${ENGINES:-$scratch/engines}
if [[ ! -e $engines/complete ]]; then
    rm -rf "$engines"
    python3 -m venv "$engines"
    "$engines/bin/pip" install --quiet --disable-pip-version-check dask distributed openjd-cli 'moto[server]' boto3
    touch "$engines/complete"
fi

if (($# == 0)); then
    (cd "$here/../.." && cargo build --release --features object-storage)
    set -- "${CARGO_TARGET_DIR:-$here/../../target}/release/homeo"
fi
HOMEO=$(realpath "$1")
export HOMEO

say() { printf 'run.sh: %s\n' "$*"; }

# The demo's pairs many times over, as one manifest.
"$HOMEO" demo "$scratch/demo" --quiet
jobs=12
{
    echo id,source,target,landmarks
    for ((i = 0; i < jobs; i++)); do
        printf 'job_%02d,demo/quadrupeds/source.obj,demo/quadrupeds/target.obj,demo/quadrupeds/landmarks.csv\n' "$i"
    done
} >"$scratch/manifest.csv"
batch() {
    "$HOMEO" batch "$scratch/manifest.csv" --out "$scratch/$1" --relax patch --image 0 --threads 1 --no-report "${@:2}"
}
exactly_once() {
    [[ $(wc -l <"$scratch/$1/results.jsonl") -eq $jobs ]]
    [[ $(find "$scratch/$1" -name report.json | wc -l) -eq $jobs ]]
    [[ -z $(find "$scratch/$1" -maxdepth 1 -name '.*.tmp-*') ]]
}

batch dask --plan dask --shards 6
"$engines/bin/python" "$here/dask_workers.py" "$scratch/dask/plan_dask.py" "$scratch/dask"
exactly_once dask
say "ok: Dask, one worker killed half way"

batch slurm --plan slurm --shards 3
bash -n "$scratch/slurm/plan_slurm.sh"
for part in 1 2 3; do
    SLURM_ARRAY_TASK_ID=$part bash "$scratch/slurm/plan_slurm.sh"
done
bash "$scratch/slurm/plan_slurm.sh" merge
exactly_once slurm
say "ok: Slurm's script, its array run by a loop"

batch openjd --plan openjd --shards 3
"$engines/bin/openjd" check "$scratch/openjd/plan_openjd.yaml"
for step in shards merge; do
    "$engines/bin/openjd" run "$scratch/openjd/plan_openjd.yaml" --step "$step" -p "Program=$HOMEO" >"$scratch/openjd.log" ||
        { cat "$scratch/openjd.log"; exit 1; }
done
exactly_once openjd
say "ok: Open Job Description, checked and run"

if "$HOMEO" batch "$scratch/manifest.csv" --out s3://none/none 2>&1 | grep -q "no object storage"; then
    say "SKIPPED: object storage, which this program was built without"
else
    batch folder
    "$engines/bin/python" "$here/s3_store.py" "$HOMEO" "$scratch/manifest.csv" "$scratch/folder"
    say "ok: object storage"
fi
