"""Runs a batch into a local server that speaks S3, in two shards and then again, and compares with a folder.

  s3_store.py PROGRAM MANIFEST FOLDER      FOLDER: the same batch's results on this machine
"""

import json
import os
import subprocess
import sys
import time

import boto3

program, manifest, folder = sys.argv[1:]
port = "18787"
server = subprocess.Popen(
    [os.path.join(os.path.dirname(sys.executable), "moto_server"), "-H", "127.0.0.1", "-p", port],
    stdout=subprocess.DEVNULL,
    stderr=subprocess.DEVNULL,
)
os.environ.update(
    AWS_ENDPOINT=f"http://127.0.0.1:{port}",
    AWS_ALLOW_HTTP="true",
    AWS_ACCESS_KEY_ID="test",
    AWS_SECRET_ACCESS_KEY="test",
    AWS_REGION="us-east-1",
)
VARYING = ("report.json", "report.html")  # times and memory


def homeo(*arguments):
    done = subprocess.run([program, *arguments, "--json"], capture_output=True, text=True)
    assert done.returncode == 0, f"{arguments}: {done.returncode}: {done.stderr}"
    return json.loads(done.stdout)


def batch(*more):
    options = ["--relax", "patch", "--image", "0", "--threads", "1", "--no-report"]
    return homeo("batch", manifest, "--out", "s3://scans/first/night", *options, *more)


try:
    client = boto3.client("s3", endpoint_url=os.environ["AWS_ENDPOINT"], region_name="us-east-1")
    for _ in range(100):
        try:
            client.create_bucket(Bucket="scans")
            break
        except Exception:
            time.sleep(0.1)
    done = [batch("--shard", f"{part}/2")["ok"] for part in (1, 2)]
    merged = homeo("batch", "--merge", "s3://scans/first/night", "--no-report")
    assert merged["ok"] == sum(done), merged
    again = [batch("--shard", f"{part}/2") for part in (1, 2)]
    assert all(run["ok"] == 0 and run["failed"] == 0 for run in again), again
    assert sum(run["skipped"] for run in again) == sum(done), again

    keys = [o["Key"] for page in client.get_paginator("list_objects_v2").paginate(Bucket="scans") for o in page.get("Contents", [])]
    names = {key.removeprefix("first/night/") for key in keys}
    compared = 0
    for root, _, files in os.walk(folder):
        for file in files:
            name = os.path.relpath(os.path.join(root, file), folder)
            if not name.startswith("job_") or file in VARYING:
                continue
            stored = client.get_object(Bucket="scans", Key=f"first/night/{name}")["Body"].read()
            with open(os.path.join(root, file), "rb") as local:
                assert stored == local.read(), f"{name} differs"
            compared += 1
    assert compared > 5 * sum(done), compared
    assert not any(".tmp-" in name for name in names), names
    rows = client.get_object(Bucket="scans", Key="first/night/results.jsonl")["Body"].read().decode().splitlines()
    ids = [json.loads(row)["id"] for row in rows]
    assert len(ids) == len(set(ids)) == sum(done), ids
    print(f"{sum(done)} jobs, {compared} objects equal to files", flush=True)
finally:
    server.kill()
