"""Runs the shards of a homeo batch on a Dask cluster and merges their results.

  python plan_dask.py [SCHEDULER]      the scheduler's address; without it two workers are started here

Every worker does one shard at a time. A shard whose worker dies is taken up by another one, which skips what was
finished. Needs dask and distributed.
"""

import os
import subprocess
import sys
import time

from dask.distributed import Client, LocalCluster, as_completed

ARGUMENTS = @ARGUMENTS@
OUT = @OUT@
SHARDS = @SHARDS@
FAILED_JOBS = 6  # homeo's exit code for a batch that finished with failed jobs


def program():
    return os.environ.get("HOMEO", "homeo")


def run_shard(part):
    """Runs one shard to its end; raises if homeo itself could not run it."""
    command = [program(), *ARGUMENTS, "--shard", f"{part}/{SHARDS}"]
    while True:
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if "another run writes to this folder" not in done.stderr:
            break
        time.sleep(5)  # what a worker that died has left running still finishes its jobs
    if done.returncode not in (0, FAILED_JOBS):
        raise RuntimeError(f"shard {part}: exit code {done.returncode}: {done.stderr[-2000:]}")
    return part, done.returncode


def main():
    if len(sys.argv) > 1:
        client = Client(sys.argv[1])
    else:
        client = Client(LocalCluster(n_workers=2, threads_per_worker=1))
    parts = client.map(run_shard, range(1, SHARDS + 1), retries=2, pure=False)
    lost = 0
    for future in as_completed(parts):
        if future.status == "finished":
            part, code = future.result()
            print(f"shard {part}/{SHARDS}: {'done' if code == 0 else 'done, with failed jobs'}", flush=True)
        else:
            lost += 1
            print(f"lost: {future.exception()}", file=sys.stderr, flush=True)
    client.close()
    if lost:
        sys.exit(f"{lost} shards did not end: run this again, finished jobs are skipped")
    sys.exit(subprocess.run([program(), "batch", "--merge", OUT]).returncode)


if __name__ == "__main__":
    main()
