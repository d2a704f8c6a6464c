#!/usr/bin/env python3
"""What the Snakefile needs beside Krok's tools: the plan, lists for the tools, and the index.

  collection.py keys IMPORT.json      the list of krok-keys: motions that krok-import has written
  collection.py sheet IMPORT.json     at most twelve of them
  collection.py index                 index.csv and index.json from the reports of all shards
  collection.py library               walking.steps from walks of the index, if it has some

The current folder is that of the results.
"""

import csv
import json
import os
import subprocess
import sys
import zlib

ENDINGS = (".bvh", ".amc")
SHARDS = 32  # three jobs each, and three more: below 100
WALKS = 16  # captures whose steps are the examples of the library

COLUMNS = ["path", "status", "frames", "rate", "duration", "joints", "stature", "humanoid", "unit", "up",
           "warnings", "cycles", "cadence", "motion", "xxh3", "error"]


def write_if_changed(path, text):
    """Keeps the file's time, by which Snakemake decides what to do, if it has this text already."""
    data = os.fsencode(text)
    try:
        with open(path, "rb") as file:
            if file.read() == data:
                return
    except FileNotFoundError:
        os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path + ".new", "wb") as file:
        file.write(data)
    os.replace(path + ".new", path)


def files_below(folder):
    """(path relative to the folder, size, time) of all files but hidden ones."""
    folders = [""]
    while folders:
        inside = folders.pop()
        with os.scandir(os.path.join(folder, inside)) as entries:
            for entry in entries:
                if entry.name.startswith("."):
                    continue
                path = os.path.join(inside, entry.name)
                if entry.is_dir(follow_symlinks=False):
                    folders.append(path)
                elif entry.is_file():
                    yield path, entry.stat().st_size, entry.stat().st_mtime_ns


def plan(source, count):
    """Writes the list of each shard if it has changed; {shard: {files, bytes, largest}}.

    A capture belongs to the shard that a checksum of its name gives, so it stays there when others are
    added or removed. Sizes and times are comments of the list: a changed capture changes the list of its
    shard alone.
    """
    if not os.path.isdir(source):
        sys.exit(f"{source}: error: no such folder\n  hint: --config collection=FOLDER")
    count = count or read_plan("shards") or SHARDS
    captures, skeletons = [], {}
    for path, size, time in files_below(source):
        name, ending = os.path.splitext(path)
        if "\t" in path or "\n" in path:
            sys.exit(f"{path!r}: error: a tab or a line break in a name, which a list cannot have")
        if ending.lower() in ENDINGS:
            captures.append((name, ending, size, time))
        elif ending.lower() == ".asf":
            skeletons.setdefault(os.path.dirname(path), []).append(f"# {size} {time} {path}\n")
    if not captures:
        sys.exit(f"{source}: error: no captures ({', '.join(ENDINGS)}) in it")
    lists, shards = {}, {}
    for name, ending, size, time in sorted(captures):
        shard = f"{zlib.crc32(os.fsencode(name)) % count:04d}"
        sizes = shards.setdefault(shard, {"files": 0, "bytes": 0, "largest": 0})
        sizes["files"] += 1
        sizes["bytes"] += size
        sizes["largest"] = max(sizes["largest"], size)
        beside = skeletons.get(os.path.dirname(name), []) if ending.lower() == ".amc" else []
        lists.setdefault(shard, []).append(
            "".join(sorted(beside)) + f"# {size} {time}\n{os.path.join(source, name + ending)}"
            f"\t{os.path.join('../../motions', name + '.anim')}\n")
    for shard, lines in lists.items():
        write_if_changed(f"shards/{shard}/list.tsv", "".join(lines))
    write_if_changed("plan.json", json.dumps({"source": source, "shards": count,
                                              "plan": dict(sorted(shards.items()))}, indent=1))
    return dict(sorted(shards.items()))


def read_plan(key="plan"):
    try:
        with open("plan.json", "rb") as file:
            return json.loads(file.read().decode("utf-8", "surrogateescape"))[key]
    except FileNotFoundError:
        return None


def report(path):
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        return json.load(file)["files"]


def motions(path):
    return [file["output"] for file in report(path) if file["status"] != "failed"]


def keys(path):
    for motion in motions(path):
        print(motion, motion.removesuffix(".anim") + ".keys.json", sep="\t")


def sheet(path):
    found = motions(path)
    for motion in found[:: -(-len(found) // 12) or 1]:
        print(os.path.normpath(os.path.join(os.path.dirname(path), motion)))


def error_of(file):
    return next((issue["message"] for issue in file["issues"] if issue["severity"] == "error"), "")


def index():
    """A row for each capture, in the order of their paths: from the reports, so no motion is read."""
    rows = []
    source = read_plan("source")
    for shard in read_plan():
        gaits = {file["input"]: file for file in report(f"shards/{shard}/keys.json")}
        for file in report(f"shards/{shard}/import.json"):
            failed = file["status"] == "failed"
            row = {"path": os.path.relpath(file["input"], source), "status": "failed" if failed else "done",
                   "warnings": sum(issue["severity"] == "warning" for issue in file["issues"])}
            if failed:
                row["error"] = error_of(file)
            else:
                facts = file["result"]
                row |= {key: facts[key] for key in ("frames", "rate", "duration", "joints", "humanoid")}
                row["stature"] = (facts.get("stature") or {}).get("metres")
                row["unit"] = (facts.get("unit") or {}).get("name")
                row["up"] = (facts.get("up") or {}).get("choice")
                row["motion"] = file["output"].removeprefix("../../")
                row["xxh3"] = file["inputs"][0]["xxh3"]
                feet = gaits[file["output"]]
                gait = (feet["result"] or {}).get("gait") or {} if feet["status"] != "failed" else {}
                row["cycles"] = gait.get("cycles", 0)
                row["cadence"] = gait.get("cadence")
            rows.append({column: row.get(column) for column in COLUMNS})
    rows.sort(key=lambda row: row["path"])
    with open("index.csv", "w", newline="", encoding="utf-8", errors="surrogateescape") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    failed = sum(row["status"] == "failed" for row in rows)
    with open("index.json", "w", encoding="utf-8", errors="surrogateescape") as file:
        head = {"captures": len(rows), "failed": failed, "frames": sum(row["frames"] or 0 for row in rows),
                "seconds": sum(row["duration"] or 0 for row in rows)}
        file.write('{"totals": ' + json.dumps(head) + ',\n"captures": [\n')
        file.write(",\n".join(json.dumps(row) for row in rows) + "\n]}\n")
    print(f"{len(rows)} captures, {failed} failed: index.csv, index.json")


def library():
    """A library of steps by length and duration; not made again while its examples are the same."""
    with open("index.json", encoding="utf-8", errors="surrogateescape") as file:
        walks = [row for row in json.load(file)["captures"] if (row["cycles"] or 0) >= 2]
    walks = walks[:: -(-len(walks) // WALKS) or 1]
    if len(walks) < 4:
        result = {"made": False, "walks": len(walks), "why": "fewer than 4 walks with two gait cycles"}
    else:
        description = json.dumps({
            "schema": "krok.library/1", "name": "walking", "steps": "auto", "mirror": True,
            "parameters": [{"name": "length", "measures": "step.length", "tolerance": "1mm"},
                           {"name": "duration", "measures": "duration", "tolerance": "5ms"}],
            "examples": [{"clip": row["motion"]} for row in walks]}, indent=1)
        result = {"made": True, "walks": len(walks), "why": None, "from": [row["xxh3"] for row in walks]}
        try:
            with open("walking.made.json", encoding="utf-8") as file:
                old = json.load(file)
        except (FileNotFoundError, ValueError):
            old = None
        write_if_changed("walking.json", description)
        if old != result or not os.path.exists("walking.steps"):
            run = subprocess.run(["krok-fit", "walking.json", "-o", "walking.steps", "--keep-going", "-q", "-j", "1",
                                  "--json=walking.fit.json"], stderr=subprocess.PIPE, text=True)
            sys.stderr.write(run.stderr)
            if run.returncode not in (0, 2, 3):
                sys.exit(run.returncode)
            if run.returncode == 2:
                result |= {"made": False, "why": run.stderr.strip().split("\n")[0]}
        if result["made"]:
            write_if_changed("walking.made.json", json.dumps(result))
    with open("library.json", "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)


if __name__ == "__main__":
    steps = {"keys": keys, "sheet": sheet, "index": index, "library": library}
    if len(sys.argv) < 2 or sys.argv[1] not in steps:
        sys.exit(__doc__)
    steps[sys.argv[1]](*sys.argv[2:])
