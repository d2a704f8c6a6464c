"""Where the minutes of a build folder go: job seconds by library, tool and test program, from ninja's log,
and seconds of each test program's run, from what the tests reported.

Usage: build_times.py BUILD_FOLDER... [--most N]   N: how many of the slowest tests are listed (20)
"""

import argparse
import json
import pathlib
import re
from collections import Counter


def group_of(output):
    if output.endswith(".gch"):
        return "precompiled headers"
    found = re.search(r"(\w+)/CMakeFiles/([^/]+)\.dir/", output)
    if found:
        return f"{found[1]}: {found[2].removesuffix('_parts')}"
    if output.startswith("man/"):
        return "manual pages"
    return "links and archives" if re.search(r"^(bin|tests|samples|bench)/|\.(a|so)$", output) else "other"


def build_seconds(folder):
    """Each output's newest time; ninja appends to its log."""
    newest = {}
    for line in (folder / ".ninja_log").read_text().splitlines()[1:]:
        start, end, _, output, _ = line.split("\t")
        if (folder / output).exists():  # not what an earlier layout of units left
            newest[output] = (int(end) - int(start)) / 1000
    seconds = Counter()
    for output, time in newest.items():
        seconds[group_of(output)] += time
    return seconds


def test_seconds(folder):
    tests = Counter()
    for path in sorted((folder / "test_results").glob("*.json")):
        for suite in json.loads(path.read_text())["testsuites"]:
            for test in suite["testsuite"]:
                if test["status"] == "RUN":
                    program = path.stem.split(".")[0]
                    tests[program, f"{test['classname']}.{test['name']}"] += float(test["time"].rstrip("s"))
    return tests


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--most", type=int, default=20)
    arguments = parser.parse_args()
    for folder in arguments.folders:
        seconds = build_seconds(folder)
        print(f"== {folder}: {sum(seconds.values()) / 60:.1f} job minutes to build")
        for group, time in seconds.most_common():
            print(f"{time:8.1f} s  {group}")
        tests = test_seconds(folder)
        programs = Counter()
        for (program, _), time in tests.items():
            programs[program] += time
        print(f"== {folder}: {sum(programs.values()) / 60:.1f} minutes of {len(tests)} tests in programs")
        for program, time in programs.most_common():
            print(f"{time:8.1f} s  {program}")
        for (program, test), time in tests.most_common(arguments.most):
            print(f"{time:8.2f} s  {program}: {test}")


if __name__ == "__main__":
    main()
