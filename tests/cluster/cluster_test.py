#!/usr/bin/env python3
"""Runs samples/cluster on one machine and under a Slurm of its own, with processes killed at random.

  cluster_test.py TOOLS MAKE_WALK SOURCE [--kills N] [--captures N] [--seed N]

Would fail if a second run did anything, if one changed capture redid more than its shard, if a broken
capture stopped the others, or if a run in which jobs, daemons and the workflow itself are killed ended
with other bytes than an undisturbed one. Slurm's daemons live in namespaces of their own (loopback
network alone), so all processes end with the test in any case. Prints "skipped" and exits with 77 where
Snakemake, Slurm or namespaces are not to be had.
"""

import argparse
import fcntl
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

MINUTES_OF_A_ROUND = 10
SECONDS_TO_REGISTER = 15  # more than BatchStartTimeout
PROGRAMS = ("snakemake", "munged", "slurmctld", "slurmd", "sbatch", "unshare")
NAMESPACES = ["unshare", "--net", "--pid", "--uts", "--mount-proc", "--fork", "--kill-child"]

SLURM = """
ClusterName=test
SlurmctldHost=localhost
AuthType=auth/munge
AuthInfo=socket={root}/munge.socket
SlurmUser=root
StateSaveLocation={root}/state
SlurmdSpoolDir={root}/spool
SlurmctldPidFile={root}/slurmctld.pid
SlurmdPidFile={root}/slurmd.pid
SlurmctldLogFile={root}/slurmctld.log
SlurmdLogFile={root}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=1
SlurmdParameters=config_overrides
NodeName=localhost CPUs=2 RealMemory=8000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def fail(message):
    print("FAILED:", message)
    sys.exit(1)


def make_captures(make_walk, folder, count):
    """Walks of some lengths and cadences in two sub-folders; each 25th is no capture at all."""
    for number in range(count):
        path = f"{folder}/{'ab'[number % 2]}/walk {number}.bvh"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        if number % 25 == 7:
            with open(path, "w") as file:
                file.write("HIERARCHY\nnothing\n")
            continue
        subprocess.run([make_walk, "-q", "--steps", "5", "--rate", "30", "--step-length", f"{50 + number % 4 * 7}cm",
                        "--cadence", str(90 + number % 3 * 12), "--noise-angle", "0.2deg", "--seed", str(number),
                        "--contacts", "/dev/null", "-o", path], check=True)


class Workflow:
    def __init__(self, given, root, name):
        self.out = f"{root}/{name}"
        self.log = f"{root}/{name}.log"
        self.command = ["snakemake", "-s", f"{given.source}/samples/cluster/Snakefile", "--config",
                        f"collection={root}/captures", f"out={self.out}", f"bin={given.tools}",
                        f"shards={given.shards}"]
        self.root = root

    def start(self, *options):
        # CI: Snakemake asks for the state of jobs each second instead of each tenth.
        with open(self.log, "a") as log:
            return subprocess.Popen(self.command + list(options), stdout=log, stderr=log, cwd=self.root,
                                    env=os.environ | {"CI": "true"})

    def run(self, *options):
        begin = os.path.getsize(self.log) if os.path.exists(self.log) else 0
        status = self.start(*options).wait(timeout=600)
        with open(self.log) as log:
            log.seek(begin)
            text = log.read()
        if status:
            fail(f"snakemake: exit code {status}\n{text[-3000:]}")
        return text

    def files(self):
        """The results: {path: bytes}. Journals and reports tell what a run did, and may differ."""
        found = {}
        for folder, folders, names in os.walk(self.out):
            if folder == self.out:
                folders[:] = [name for name in folders if name in ("motions", "sheets")]
            for name in names:
                path = os.path.join(folder, name)
                if name not in ("walking.fit.json",):
                    with open(path, "rb") as file:
                        found[os.path.relpath(path, self.out)] = file.read()
        return found


def check_one_machine(given, root):
    """The undisturbed run, a second one, one with a changed capture. Returns the first one's files."""
    local = Workflow(given, root, "local")
    local.run("--cores", "2")
    files = local.files()
    motions = [name for name in files if name.endswith(".anim")]
    broken = -(-(given.captures - 7) // 25)
    table = files["index.csv"].decode().splitlines()
    if len(motions) != given.captures - broken or len(table) != given.captures + 1:
        fail(f"{len(motions)} motions, {len(table) - 1} rows of {given.captures} captures, {broken} of them broken")
    if sum(",failed," in row for row in table) != broken or "walking.steps" not in files:
        fail("broken captures are not in the index, or there is no library")
    if "Nothing to be done" not in local.run("--cores", "2"):
        fail("a second run did something")
    changed = f"{root}/captures/a/walk 2.bvh"
    with open(changed, "rb") as file:
        before, times = file.read(), os.stat(changed)
    with open(changed, "ab") as file:
        file.write(b"\n")
    text = local.run("--cores", "2")
    rules = sorted(line.split()[1].rstrip(":") for line in text.splitlines() if line.startswith("rule "))
    if rules != ["index", "keys", "library", "motions", "sheet"]:
        fail(f"one changed capture redid {rules}")
    with open(changed, "wb") as file:
        file.write(before)
    os.utime(changed, ns=(times.st_atime_ns, times.st_mtime_ns))
    print(f"one machine: {given.captures} captures, {given.shards} shards; one changed capture redid", *rules)
    return files


class Slurm:
    def __init__(self, root):
        self.root = root
        for name in ("state", "spool"):
            os.mkdir(f"{root}/{name}")
        with open(f"{root}/munge.key", "wb") as file:
            os.fchmod(file.fileno(), 0o400)
            file.write(os.urandom(1024))
        with open(f"{root}/slurm.conf", "w") as file:
            file.write(SLURM.format(root=root))
        os.environ["SLURM_CONF"] = f"{root}/slurm.conf"
        self.daemons = {}
        self.daemon("munged", "--foreground", "--force", *(f"--{name}={root}/munge.{name.split('-')[0]}" for name in
                    ("key-file", "socket", "pid-file", "log-file", "seed-file")))
        while not os.path.exists(f"{root}/munge.socket"):
            self.check("munged")
        self.start("slurmctld")
        self.start("slurmd")

    def daemon(self, name, *options):
        with open(f"{self.root}/{name}.out", "a") as log:
            self.daemons[name] = subprocess.Popen([name, *options], stdout=log, stderr=log)

    def start(self, name):
        self.daemon(name, "-D")

    def check(self, name):
        time.sleep(0.1)
        if self.daemons[name].poll() is not None:
            with open(f"{self.root}/{name}.out") as log:
                fail(f"{name} ended\n{log.read()[-2000:]}")

    def register(self):
        """A killed controller comes back with its last saved state, in which jobs that have ended since
        still run. It drops them when their node registers, which it else does rarely.
        A job that it could not launch, it holds."""
        subprocess.run(["scontrol", "reconfigure"], stderr=subprocess.DEVNULL)
        jobs = subprocess.run(["squeue", "-h", "-t", "PENDING", "-o", "%A %r"], capture_output=True, text=True).stdout
        for job, reason in (line.split(" ", 1) for line in jobs.splitlines()):
            if "held" in reason.lower():
                subprocess.run(["scontrol", "release", job], stderr=subprocess.DEVNULL)

    def resume(self):
        """What an administrator does with a node that Slurm took out of use after a crash."""
        node = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout.strip()
        if node.startswith(("drain", "down")):
            subprocess.run(["scontrol", "update", "nodename=localhost", "state=resume"], stderr=subprocess.DEVNULL)

    def ready(self):
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            node = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout
            if node.strip() in ("idle", "mixed", "allocated"):
                return
            for name in self.daemons:
                self.check(name)
        fail("slurm does not get ready: " + node)


def job_processes():
    """Processes of jobs: Krok's tools and the scripts that run them. Not slurmstepd, which the kernel's
    out-of-memory killer spares, too: Slurm notices that one is gone after some minutes only."""
    found = {}
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat") as file:
                name, state = file.read().split("(", 1)[1].rsplit(")", 1)
            if state.split()[0] != "Z" and (name.startswith("krok-") or name == "slurm_script"):
                found[int(entry)] = name
        except (OSError, ValueError):
            pass
    return found


def check_kills(given, root, expected):
    slurm = Slurm(root)
    slurm.ready()
    profile = ["--profile", f"{given.source}/samples/cluster/slurm", "--latency-wait", "5"]
    left = given.kills
    killed = {}
    rounds = 0
    while left > 0 or not rounds:
        rounds += 1
        workflow = Workflow(given, root, f"killed_{rounds}")
        attempts = 0
        running = workflow.start(*profile)
        pause = time.monotonic() + 2
        looked = registered = deadline = time.monotonic()
        while True:
            status = running.poll()
            if status == 0:
                break
            if status is not None:
                attempts += 1
                if attempts > 5 + given.kills:
                    with open(workflow.log) as log:
                        fail(f"the workflow does not end\n{log.read()[-3000:]}")
                workflow.start("--unlock").wait()
                running = workflow.start(*profile)
            time.sleep(0.05)
            now = time.monotonic()
            if now > deadline + MINUTES_OF_A_ROUND * 60:
                with open(workflow.log) as log:
                    fail(f"round {rounds} does not end\n{log.read()[-3000:]}")
            if now > looked + 2:
                slurm.resume()
                looked = now
            if now > registered + SECONDS_TO_REGISTER:
                slurm.register()
                registered = now
            if left <= 0 or time.monotonic() < pause:
                continue
            kind = random.choice(["tool", "tool", "job", "slurmctld", "slurmd", "workflow"])
            jobs = job_processes()
            if kind == "tool":  # they are short
                until = time.monotonic() + 5
                while time.monotonic() < until and not any(name != "slurm_script" for name in jobs.values()):
                    time.sleep(0.002)
                    jobs = job_processes()
                jobs = {process: name for process, name in jobs.items() if name != "slurm_script"}
                kind = "job"
            if kind == "job" and not jobs:
                continue
            if kind == "job":
                process = random.choice(sorted(jobs))
                kind = jobs[process]
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    continue
            elif kind == "workflow":
                running.kill()
            else:
                slurm.daemons[kind].kill()
                slurm.daemons[kind].wait()
                time.sleep(random.uniform(0, 1.5))
                slurm.start(kind)
            killed[kind] = killed.get(kind, 0) + 1
            left -= 1
            pause = time.monotonic() + random.uniform(0.2, given.pause)
        files = workflow.files()
        differing = [name for name in sorted(expected.keys() | files.keys()) if expected.get(name) != files.get(name)]
        if differing:
            fail(f"round {rounds}: {len(differing)} files differ: {differing[:5]}")
        shutil.rmtree(workflow.out)
    print(f"slurm: {rounds} rounds, the same {len(expected)} files after", given.kills, "kills:",
          ", ".join(f"{count} {kind}" for kind, count in sorted(killed.items())))


def loopback_up():
    """Slurm wants an address beside 127.0.0.1 (AI_ADDRCONFIG), on which nothing else is."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        address = struct.pack("16sHH4s8x", b"lo:1", socket.AF_INET, 0, socket.inet_aton("10.0.0.1"))
        fcntl.ioctl(control, 0x8914, struct.pack("16sh14x", b"lo", 0x1 | 0x40))  # SIOCSIFFLAGS: up, running
        fcntl.ioctl(control, 0x8916, address)  # SIOCSIFADDR


def reap_orphans():
    """Goes on in a child; this process, the first of its namespace, ends what the daemons leave behind."""
    child = os.fork()
    if child == 0:
        return
    while True:
        ended, status = os.wait()
        if ended == child:
            os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("tools")
    options.add_argument("make_walk")
    options.add_argument("source")
    options.add_argument("--kills", type=int, default=5)
    options.add_argument("--captures", type=int, default=16)
    options.add_argument("--shards", type=int, default=4)
    options.add_argument("--pause", type=float, default=3, help="seconds between kills, at most")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    given = options.parse_args()
    given.tools, given.source = os.path.abspath(given.tools), os.path.abspath(given.source)
    missing = [name for name in PROGRAMS if not shutil.which(name)]
    if missing:
        print("skipped: no", ", ".join(missing), "(apt install snakemake slurm-wlm munge)")
        return 77
    if not given.inside:
        namespaces = NAMESPACES + ([] if os.geteuid() == 0 else ["--user", "--map-root-user"])
        if subprocess.run(namespaces + ["true"], stderr=subprocess.DEVNULL).returncode:
            print("skipped: no namespaces for processes and network here")
            return 77
        return subprocess.run([*namespaces, sys.executable, *sys.argv, "--inside"]).returncode
    reap_orphans()
    loopback_up()
    socket.sethostname("localhost")
    random.seed(given.seed)
    with tempfile.TemporaryDirectory(prefix="krok_cluster_") as root:
        make_captures(given.make_walk, f"{root}/captures", given.captures)
        expected = check_one_machine(given, root)
        check_kills(given, root, expected)
    return 0


if __name__ == "__main__":
    sys.exit(main())
