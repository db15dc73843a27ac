#!/bin/bash
#SBATCH --job-name=homeo
#SBATCH --array=1-@SHARDS@
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --requeue
#
# Runs the shards of a homeo batch as an array, one task a shard:
#
#   sbatch plan_slurm.sh
#
# and when the array has ended joins their results:
#
#   sbatch --dependency=afterany:JOBID --array=1 plan_slurm.sh merge
#
# A task that is requeued skips what was finished. Exit code 6 means that some jobs failed; they are in failed-I-of-N.jsonl.

set -euo pipefail

homeo="${HOMEO:-homeo}"

if [ "${1:-}" = merge ]; then
    exec "$homeo" batch --merge @OUT@
fi

exec "$homeo" @ARGUMENTS@ --shard "${SLURM_ARRAY_TASK_ID:?run this with sbatch}/@SHARDS@"
