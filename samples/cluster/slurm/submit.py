#!/usr/bin/env python3
"""Submits a job script of Snakemake to Slurm and prints the number of the job.

Waits for a controller that is away. A job of this shard that still waits or runs, of a workflow that was
killed, is taken instead of a second one: two processes would write the same files.
"""

import hashlib
import json
import os
import subprocess
import sys
import time

WAIT = 600  # seconds for the controller to come back

script = sys.argv[-1]
with open(script, encoding="utf-8") as file:
    job = next(json.loads(line.split("=", 1)[1]) for line in file if line.startswith("# properties"))
if job["type"] == "group":
    what = next(output.split("/")[1] for output in job["output"])
else:
    what = job["rule"]
name = f"krok-{hashlib.sha256(os.getcwd().encode()).hexdigest()[:8]}-{what}"
resources = job.get("resources", {})
command = ["sbatch", "--parsable", f"--job-name={name}", "--dependency=singleton", "--requeue",
           f"--cpus-per-task={job.get('threads', 1)}", "--output=slurm/%x.%j.log"]
if "mem_mb" in resources:
    command.append(f"--mem={resources['mem_mb']}")
if "runtime" in resources:
    command.append(f"--time={resources['runtime']}")
os.makedirs("slurm", exist_ok=True)

start = time.monotonic()
while True:
    known = subprocess.run(["squeue", "-h", "-o", "%A", "-n", name, "-t", "PENDING,CONFIGURING,RUNNING,COMPLETING"],
                           capture_output=True, text=True)
    if known.returncode == 0 and known.stdout.strip():
        print(known.stdout.split()[0])
        break
    if known.returncode == 0:
        sent = subprocess.run(command + [script], capture_output=True, text=True)
        if sent.returncode == 0:
            print(sent.stdout.strip().split(";")[0])
            break
        why = sent.stderr
        if "contact" not in why and "timed out" not in why and "connect" not in why:
            sys.exit(why)  # refused: it would be refused again
    else:
        why = known.stderr
    if time.monotonic() - start > WAIT:
        sys.exit(why)
    time.sleep(1)
