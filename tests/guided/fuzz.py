"""Runs afl-fuzz on the targets of krok_targets, from examples of the formats.

Usage: fuzz.py KROK_TARGETS [--minutes N] [--jobs N] [--out FOLDER] [TARGET...]

Targets share N minutes of so many processes. Starts from what `krok_targets --seeds` writes, the
examples in the formats' SPEC pages, small files of samples/ and, if it is there, the corpus beside
the project; from the second run on also from what the last one found. Prints per target the inputs
tried, the edges of the code reached and the findings, and for each finding the command that shows
it. Exit code 1 if there are findings. A finding that was mended belongs into
tests/guided/kept/TARGET. coverage.py beside this file prints which lines inputs reach.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# A page's folder, where its name is not the target's.
FOLDERS = {"ground": "height_field", "import_scene": "gltf"}
ENDINGS = {"bvh": [".bvh"], "acclaim_skeleton": [".asf"], "acclaim_motion": [".amc"],
           "csv": [".csv", ".tsv"], "gltf": [".glb", ".gltf"], "obj": [".obj"], "path": [".svg"],
           "import_scene": [".glb", ".gltf"], "image": [".png", ".jpg"], "exr": [".exr"], "zip": [".zip"]}
EXAMPLE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MOST_SEED = 20_000
# Instrumented code is some 30 times slower. An operation is several tools, which may make a body.
SECONDS_TO_HANG = 10
SECONDS_TO_HANG_IN = {"operations": 60}
NUMBERS = ["-1", "1e308", "1e-308", "5e-324", "1e30", "NaN", "Infinity", "2147483648", "4294967295",
           "18446744073709551615", "0.001", "-0", "\\u001b", "1e999"]


def shortened(path, data):
    """A long capture's first frames; nothing of other long files."""
    if len(data) <= MOST_SEED:
        return data
    text = data[:2_000_000]
    at = text.find(b"Frame Time")
    if path.suffix == ".bvh" and at >= 0:
        lines = text[at:].split(b"\n")
        head = re.sub(rb"Frames:\s*\d+", b"Frames: 2", text[:at])
        short = head + b"\n".join(lines[:3]) + b"\n"
        return short if len(short) <= MOST_SEED else None
    if path.suffix == ".amc":
        return text[:text.rfind(b"\n", 0, 5000) + 1]
    return None


def collect(target, folder, program):
    folder.mkdir(parents=True, exist_ok=True)
    page = ROOT / "formats" / FOLDERS.get(target, target) / "SPEC.md"
    if page.exists():
        for number, (_, text) in enumerate(EXAMPLE.findall(page.read_text(encoding="utf-8"))):
            (folder / f"page_{number}").write_text(text, encoding="utf-8")
    places = [ROOT / "samples", ROOT / "tests" / "golden" / "v1", ROOT.parent / "shared" / "corpus"]
    endings = ENDINGS.get(target, [])
    count = 0
    for path in (p for place in places if place.exists() for p in sorted(place.rglob("*"))):
        if path.suffix.lower() not in endings or not path.is_file() or count == 40:
            continue
        data = shortened(path, path.read_bytes())
        if data is not None:
            (folder / f"file_{count}").write_bytes(data)
            count += 1
    if target == "path":
        (folder / "data").write_text("M 0 0 C 10 0 20 10 30 10 A 5 5 0 0 1 40 20 h 5 q 1 2 3 4 Z")
        (folder / "svg").write_text('<svg viewBox="0 0 9 9"><g transform="rotate(3)"><path id="a" '
                                    'd="M1 1 L5 5"/><polyline points="0,0 3,4"/></g></svg>')
    if target == "csv":
        (folder / "quoted").write_text('time [s],"a ""b""",name\n0,1e3,x\n1,,"y\n z"\n')
    if target == "zip":
        with zipfile.ZipFile(folder / "packed", "w") as archive:
            archive.writestr("a/scene.gltf", "{}" * 40, zipfile.ZIP_DEFLATED)
            archive.writestr("b.bin", "stored")
    if not any(folder.iterdir()):
        (folder / "empty_page").write_text('{"schema": "krok.%s/1"}' % target)


def write_dictionary(target, seeds, path):
    """Words and quoted keys of the seeds and of the format's page, and numbers that trouble readers."""
    words = set()
    page = ROOT / "formats" / FOLDERS.get(target, target) / "SPEC.md"
    if page.exists():
        for word in re.findall(r"`([^`\n]{1,40})`", page.read_text(encoding="utf-8")):
            words.add(word.encode())
            if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_-]*", word):
                words.add(f'"{word}"'.encode())
    for seed in seeds.iterdir():
        data = seed.read_bytes()[:MOST_SEED]
        words.update(re.findall(rb'"[A-Za-z_][A-Za-z0-9_./ -]{1,30}"', data))
        words.update(re.findall(rb"[A-Za-z_:][A-Za-z_]{2,20}", data))
    chosen = sorted(words, key=lambda w: (not w.startswith(b'"'), w))[:400]
    lines = []
    for number, word in enumerate(chosen + [n.encode() for n in NUMBERS]):
        escaped = "".join(chr(b) if 32 <= b < 127 and b not in b'"\\' else f"\\x{b:02x}" for b in word)
        lines.append(f'w{number}="{escaped}"')
    path.write_text("\n".join(lines) + "\n")


def fuzz(program, target, seconds, out, seed_source):
    work = out / target
    seeds, queue = work / "seeds", work / "afl" / "default" / "queue"
    # What the last run found goes on: afl-fuzz minds only its own folder's name.
    earlier = work / "earlier"
    if queue.exists():
        shutil.rmtree(earlier, ignore_errors=True)
        shutil.copytree(queue, earlier, ignore=lambda d, names: [n for n in names if n.startswith(".")])
    shutil.rmtree(work / "afl", ignore_errors=True)
    shutil.rmtree(seeds, ignore_errors=True)
    if (seed_source / target).exists():
        shutil.copytree(seed_source / target, seeds)
    collect(target, seeds, program)
    if earlier.exists():
        for number, path in enumerate(sorted(earlier.iterdir())):
            shutil.copy(path, seeds / f"earlier_{number}")
    write_dictionary(target, seeds, work / "dictionary")
    temporary = tempfile.mkdtemp(prefix="krok-fuzz-", dir="/dev/shm" if os.path.isdir("/dev/shm") else None)
    hang = 1000 * SECONDS_TO_HANG_IN.get(target, SECONDS_TO_HANG)
    environment = dict(os.environ, AFL_NO_UI="1", AFL_SKIP_CPUFREQ="1", AFL_NO_AFFINITY="1",
                       AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES="1", AFL_FAST_CAL="1",
                       AFL_IGNORE_PROBLEMS="1", AFL_IGNORE_SEED_PROBLEMS="1",
                       AFL_HANG_TMOUT=str(hang), TMPDIR=temporary,
                       ASAN_OPTIONS="abort_on_error=1:symbolize=0:detect_leaks=0:"
                                    "allocator_may_return_null=0:hard_rss_limit_mb=2048:"
                                    "max_allocation_size_mb=1024",
                       UBSAN_OPTIONS="abort_on_error=1:halt_on_error=1:symbolize=0")
    log = work / "log"
    with open(log, "wb") as stream:
        subprocess.run(["afl-fuzz", "-i", str(seeds), "-o", str(work / "afl"), "-V", str(seconds),
                        "-m", "none", "-c", "0", "-t", str(hang), "-x", str(work / "dictionary"),
                        "--", str(program), target],
                       env=environment, stdout=stream, stderr=subprocess.STDOUT, check=False)
    shutil.rmtree(temporary, ignore_errors=True)
    statistics = work / "afl" / "default" / "fuzzer_stats"
    if not statistics.exists():
        tail = log.read_text(errors="replace")[-800:]
        return target, None, [], f"afl-fuzz did not run: {tail}"
    values = dict(line.split(":", 1) for line in statistics.read_text().splitlines() if ":" in line)
    values = {key.strip(): value.strip() for key, value in values.items()}
    found = [p for kind in ("crashes", "hangs")
             for p in sorted((work / "afl" / "default" / kind).glob("id*"))]
    return target, values, found, ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "fuzz")
    options = parser.parse_intermixed_args()
    program = options.program.resolve()
    known = subprocess.run([program, "--list"], capture_output=True, text=True, check=True).stdout.split()
    unknown = set(options.targets) - set(known)
    if unknown:
        sys.exit(f"no target {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    targets = options.targets or known
    options.out.mkdir(parents=True, exist_ok=True)
    seed_source = options.out / "made_seeds"
    subprocess.run([program, "--seeds", seed_source], check=True)

    rounds = -(-len(targets) // options.jobs)
    seconds = max(5, int(60 * options.minutes / rounds))
    print(f"{len(targets)} targets, {seconds} s each, {options.jobs} at a time", flush=True)
    print(f"{'target':18} {'inputs':>10} {'edges':>7} {'findings':>8}", flush=True)
    findings, failures, total = [], [], 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(fuzz, program, t, seconds, options.out, seed_source) for t in targets]
        for run in concurrent.futures.as_completed(runs):
            target, values, found, failure = run.result()
            if failure:
                failures.append(f"{target}: {failure}")
                print(f"{target:18} {failure}", flush=True)
                continue
            total += int(values["execs_done"])
            findings += [(target, path) for path in found]
            print(f"{target:18} {int(values['execs_done']):10} {int(values['edges_found']):7} "
                  f"{len(found):8}", flush=True)
    print(f"{total} inputs, {len(findings)} findings")
    for target, path in findings:
        print(f"  {os.path.relpath(program)} {target} '{os.path.relpath(path)}'")
    sys.exit(1 if findings or failures else 0)


if __name__ == "__main__":
    main()
