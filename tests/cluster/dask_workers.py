"""Runs a Dask plan on a scheduler with two workers in processes of their own, and kills one of them half way.

  dask_workers.py PLAN OUT
"""

import glob
import os
import signal
import subprocess
import sys
import time

plan, out = sys.argv[1:]


def start(*command):
    return subprocess.Popen([sys.executable, "-m", *command], stderr=subprocess.DEVNULL, start_new_session=True)


def finished_jobs():
    return len(glob.glob(os.path.join(out, "job_*", "report.json")))


address = "tcp://127.0.0.1:18786"
scheduler = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "18786", "--no-dashboard")
worker = ("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
workers = [start(*worker) for _ in range(2)]
try:
    run = subprocess.Popen([sys.executable, plan, address])
    deadline = time.monotonic() + 300
    while finished_jobs() < 3 and run.poll() is None and time.monotonic() < deadline:
        time.sleep(0.05)
    assert run.poll() is None, "the plan ended before a worker could be killed"
    # Only the worker: what it has started goes on, as it does when a worker is out of memory.
    os.kill(workers[0].pid, signal.SIGKILL)
    print(f"killed worker {workers[0].pid} after {finished_jobs()} jobs", flush=True)
    code = run.wait(timeout=600)
    assert code == 0, f"the plan ended with exit code {code}"
finally:
    for process in [*workers, scheduler]:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
