#!/usr/bin/env python3
"""Prints success, failed or running for a job of Slurm, as Snakemake asks for it."""

import re
import subprocess
import sys

ENDED = ("BOOT_FAIL", "CANCELLED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "TIMEOUT")

asked = subprocess.run(["scontrol", "-o", "show", "job", sys.argv[1]], capture_output=True, text=True)
state = re.search(r"JobState=(\w+)", asked.stdout)
if state:
    state = state[1]
    print("success" if state == "COMPLETED" else "failed" if state in ENDED else "running")
elif "Invalid job id" in asked.stderr:
    print("failed")  # lost or long past: done again, which costs little
else:
    print("running")  # the controller is away
