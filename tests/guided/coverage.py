"""Which lines of the sources a target reaches with given inputs.

Usage: coverage.py KROK_TARGETS TARGET INPUTS... [--under FOLDER] [--lines]

INPUTS are files or folders, such as out/fuzz/bvh/afl/default/queue. Prints for each source file how many of
its edges ran, in files that ran at all or in all of FOLDER (formats/bvh, several by commas), and with
--lines also the lines that did not. For a program of the preset fuzz.
"""

import argparse
import collections
import os
import pathlib
import pickle
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CALL = re.compile(rb"^\s*[0-9a-f]+:\s+call.*<__sanitizer_cov_trace_pc>")
ADDRESS = re.compile(rb"^\s*([0-9a-f]+):")


def all_places(program):
    """File and line by the address behind each call for an edge; kept beside the program."""
    kept = program.with_suffix(".places")
    if kept.exists() and kept.stat().st_mtime > program.stat().st_mtime:
        return pickle.loads(kept.read_bytes())
    code = subprocess.Popen(["objdump", "-d", "--no-show-raw-insn", str(program)], stdout=subprocess.PIPE)
    behind, called = [], False
    for line in code.stdout:
        if called and (found := ADDRESS.match(line)):
            behind.append(int(found.group(1), 16))
        called = CALL.match(line) is not None
    asked = "\n".join(hex(address - 1) for address in behind)
    lines = subprocess.run(["addr2line", "-e", str(program)], input=asked, capture_output=True, text=True,
                           check=True).stdout.splitlines()
    places = {}
    for address, line in zip(behind, lines):
        name, _, number = line.partition(" ")[0].rpartition(":")
        name = os.path.normpath(name)
        for folder in ("formats", "lib", "tools"):
            at = name.find(f"/{folder}/")
            if at >= 0 and "/include/" not in name and "/gcc/" not in name and number.isdigit():
                places[address] = (name[at + 1:], int(number))
                break
    kept.write_bytes(pickle.dumps(places))
    return places


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("target")
    parser.add_argument("inputs", nargs="+")
    parser.add_argument("--under", default="")
    parser.add_argument("--lines", action="store_true")
    options = parser.parse_args()
    program = options.program.resolve()
    places = all_places(program)
    with tempfile.NamedTemporaryFile() as list_file:
        subprocess.run([str(program), options.target, *options.inputs], check=True, stderr=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL,
                       env=dict(os.environ, KROK_PLACES=list_file.name, ASAN_OPTIONS="detect_leaks=0"))
        ran = {int(line, 16) for line in pathlib.Path(list_file.name).read_text().split()}
    edges, reached = collections.defaultdict(collections.Counter), collections.defaultdict(collections.Counter)
    for address, (name, line) in places.items():
        edges[name][line] += 1
        if address in ran:
            reached[name][line] += 1
    folders = tuple(folder.rstrip("/") + "/" for folder in options.under.split(",") if folder)
    total = total_reached = 0
    for name in sorted(edges):
        if not name.startswith(folders) if folders else not reached[name]:
            continue
        count, ran_here = sum(edges[name].values()), sum(reached[name].values())
        total, total_reached = total + count, total_reached + ran_here
        print(f"{ran_here:6} of {count:6}  {100 * ran_here // count:3} %  {name}")
        missed = sorted(line for line in edges[name] if not reached[name][line])
        source = (ROOT / name).read_text(encoding="utf-8").splitlines() if options.lines else []
        for line in missed if options.lines else []:
            print(f"    {line:5} {source[line - 1] if line <= len(source) else ''}")
    print(f"{total_reached:6} of {total:6}  {100 * total_reached // max(total, 1):3} %  in all")


if __name__ == "__main__":
    main()
