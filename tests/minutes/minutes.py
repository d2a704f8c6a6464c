"""CPU minutes of a run, part by part, against a budget.

Usage:
  minutes.py LOG run PART COMMAND...   runs COMMAND and adds its time to LOG under PART (build, run, check)
  minutes.py LOG reference             measures the machine and adds that to LOG
  minutes.py LOG report                prints the table; exit code 1 above 1.3 of the budget

Machines are shared and differ, so the budget is kept in multiples of a reference that is measured in the
same run: the time to compile reference.cpp beside this file, and to run what came out. Raising it is a
change of BUDGET, with the reason in the commit's message.
"""

import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

# In multiples of the reference: what 42 minutes of building and 26 of running are on a quiet machine.
BUDGET = {"build": 42 * 60 / 5.0, "run": 26 * 60 / 5.0}
FAILS_ABOVE = 1.3


def cpu_of(command):
    """Exit code, CPU seconds (children included) and seconds of a command."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    code = subprocess.call(command)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return code, cpu, time.monotonic() - start


def add(log, part, what, cpu, seconds):
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("a") as file:
        file.write(json.dumps({"part": part, "what": what, "cpu": cpu, "seconds": seconds}) + "\n")


def measure_reference(log):
    source = pathlib.Path(__file__).parent / "reference.cpp"
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "reference")
        compiler = os.environ.get("CXX", "c++")
        compile_command = [compiler, "-std=c++20", "-O2", "-isystem", "/usr/include/eigen3", str(source), "-o", program]
        cpu = 0.0
        for command in (compile_command, [program]):
            code, more, _ = cpu_of(command)
            if code != 0:
                sys.exit(f"minutes.py: {' '.join(command)} ended with {code}")
            cpu += more
    add(log, "reference", "reference", cpu, cpu)


def report(log):
    rows = [json.loads(line) for line in log.read_text().splitlines()]
    references = [row["cpu"] for row in rows if row["part"] == "reference"]
    print("CPU minutes  minutes")
    for row in rows:
        if row["part"] != "reference":
            print(f"{row['cpu'] / 60:11.2f}  {row['seconds'] / 60:7.2f}  {row['what']}")
    if not references:
        return 0
    reference = sum(references) / len(references)
    print(f"reference: {', '.join(f'{cpu:.2f}' for cpu in references)} s")
    code = 0
    for part, budget in BUDGET.items():
        cpu = sum(row["cpu"] for row in rows if row["part"] == part)
        share = cpu / reference / budget
        line = f"{part}: {cpu / 60:.1f} CPU minutes, {cpu / reference:.0f} references, {share:.2f} of the budget of {budget:.0f}"
        print(f"WARNING, OVER BUDGET: {line}" if share > 1 else line)
        if share > FAILS_ABOVE:
            code = 1
    return code


def main():
    log, verb = pathlib.Path(sys.argv[1]), sys.argv[2]
    if verb == "reference":
        measure_reference(log)
    elif verb == "report":
        sys.exit(report(log))
    else:
        part, command = sys.argv[3], sys.argv[4:]
        what = " ".join(command)
        code, cpu, seconds = cpu_of(command)
        add(log, part, what if len(what) < 90 else what[:87] + "...", cpu, seconds)
        sys.exit(code if code >= 0 else 128 - code)


main()
