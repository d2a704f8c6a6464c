"""Compiles alone and lints what changed: every source and header that differs from the commit in
tests/arch/passed_commit, the newest that CI passed, those changed last first; where the history has no
such commit, from the newest older than three days.

Usage: check_changed.py SOURCE_FOLDER LINT_BUILD [--alone BUILD] [--base COMMIT] [--jobs N] [--seconds N]
                        [--syntax-only | --lint-only]

LINT_BUILD is configured with the preset lint: no unity, no precompiled headers, warnings are errors;
BUILD is the same with precompiled headers of other libraries, which take two thirds of the time. A header is compiled by itself with the options of a source beside it. A benchmark counts as changed if a
header that it includes has, since no other build compiles benchmarks. clang-tidy takes the changed
sources of a folder as one, since nine tenths of its time go into their headers; it stops after so many
seconds, and names what it did not reach. Exit code 1 where anything is found.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import shlex
import subprocess
import sys
import time


def git(folder, *arguments):
    return subprocess.run(["git", "-C", folder, *arguments], capture_output=True, text=True, check=True).stdout


def changed_files(folder, base):
    """Paths below the folder, newest change first."""
    files = git(folder, "diff", "--name-only", "--diff-filter=d", base, "--", "*.cpp", "*.h").split()
    files += git(folder, "ls-files", "--others", "--exclude-standard", "*.cpp", "*.h").split()
    order = {}
    for commit in git(folder, "log", "--format=", "--name-only", f"{base}..HEAD").split():
        order.setdefault(commit, len(order))
    # Compiled outside this build, or text for another compiler.
    files = [f for f in files if not re.match(r"tests/(consumer|minutes)/|packaging/", f)]
    return sorted(dict.fromkeys(files), key=lambda f: (order.get(f, -1), f))


def with_benchmarks(folder, changed):
    headers = {f for f in changed if f.endswith(".h")}
    for bench in git(folder, "ls-files", "tests/bench/*.cpp").split():
        if bench in changed:
            continue
        for included in re.findall(r'#include "([^"]+)"', (folder / bench).read_text()):
            if headers & {included, f"lib/{included}", f"tests/{included}"}:
                changed.append(bench)
                break
    return changed


class Options:
    """Of each source, as the build has them, without what names outputs."""

    def __init__(self, folder, build):
        self.folder = folder
        self.by_file = {}
        for entry in json.loads((build / "compile_commands.json").read_text()):
            arguments = shlex.split(entry["command"])
            start = next(i for i, a in enumerate(arguments) if re.search(r"(\+\+|g\+\+|clang\+\+)(-\d+)?$", a))
            keep, skip = [arguments[start]], False
            for argument in arguments[start + 1:]:
                if skip or argument in ("-c", "-o", entry["file"]):
                    skip = argument == "-o"
                    continue
                keep.append(argument)
            path = pathlib.Path(entry["file"])
            if path.is_relative_to(folder):
                self.by_file[str(path.relative_to(folder))] = keep

    def of(self, path):
        """Its own, else those of the source whose folder is nearest."""
        if path in self.by_file:
            return self.by_file[path]
        parts = pathlib.PurePath(path).parts

        def nearness(other):
            theirs = pathlib.PurePath(other).parts
            return next((i for i, (a, b) in enumerate(zip(parts, theirs)) if a != b), min(len(parts), len(theirs)))

        return self.by_file[max(sorted(self.by_file), key=nearness)]


def compile_alone(folder, options, path):
    command = options.of(path) + ["-fsyntax-only", "-Wno-invalid-pch"]
    if path.endswith(".h"):
        # Included, not compiled: a main file that is a header has warnings of its own.
        source = f'#include "{folder / path}"\n'
        done = subprocess.run(command + ["-x", "c++", "-"], input=source, capture_output=True, text=True, cwd=folder)
    else:
        done = subprocess.run(command + [path], capture_output=True, text=True, cwd=folder)
    return path, done.returncode == 0, done.stderr


def lint(folder, options, build, unit, sources, seconds):
    """None where it takes longer."""
    file = build / "changed" / f"UnifiedSource_{unit}.cpp"  # by this word the analyzer follows what is included
    file.parent.mkdir(exist_ok=True)
    file.write_text("".join(f'#include "{folder / source}"\n' for source in sources))
    command = ["clang-tidy", "--quiet", "--checks=-bugprone-suspicious-include", str(file), "--",
               *options.of(sources[0])[1:]]
    command = [a for a in command if not a.startswith(("-fpch-", "--param", "-Wno-restrict", "-Wno-stringop"))]
    try:
        done = subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None
    return ", ".join(sources), done.returncode == 0, done.stdout + done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--alone", type=pathlib.Path)
    parser.add_argument("--base")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=60, help="that clang-tidy may take")
    parser.add_argument("--syntax-only", action="store_true")
    parser.add_argument("--lint-only", action="store_true")
    arguments = parser.parse_args()
    folder, build = arguments.folder.resolve(), arguments.build.resolve()
    passed = folder / "tests/arch/passed_commit"
    base = arguments.base or (passed.read_text().strip() if passed.exists() else "")
    if subprocess.run(["git", "-C", folder, "merge-base", "--is-ancestor", base, "HEAD"],
                      capture_output=True).returncode != 0:
        base = git(folder, "rev-list", "-1", "--before=3 days ago", "HEAD").strip()
    if not base:  # a young or shallow history: everything
        base = git(folder, "hash-object", "-t", "tree", "/dev/null").strip()
    changed = changed_files(folder, base)
    options = Options(folder, build)
    alone_options = Options(folder, arguments.alone.resolve()) if arguments.alone else options
    failed = []  # what, and what was printed about it

    def judge(results):
        for what, good, output in results:
            if not good:
                print(f"{what}: failed", flush=True)
                failed.append((what, output))

    def finish():
        """The reasons come last: where only the end of a log is kept, it names them."""
        for what, output in failed:
            print(f"{what}:\n{output}")
        sys.exit(1 if failed else 0)

    alone = [] if arguments.lint_only else with_benchmarks(folder, list(changed))
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        judge(pool.map(lambda path: compile_alone(folder, alone_options, path), alone))
        print(f"compiled alone: {len(alone)} sources and headers changed since {base[:9]}, {len(failed)} failed", flush=True)
        if arguments.syntax_only:
            finish()
        units = {}
        for path in changed:
            if path.endswith(".cpp") and path in options.by_file:
                program = re.search(r"^int main\(", (folder / path).read_text(), re.M)  # one to a unit
                unit = pathlib.PurePath(path).with_suffix("") if program else pathlib.PurePath(path).parent
                units.setdefault(str(unit).replace("/", "_"), []).append(path)
        until, unreached = time.monotonic() + arguments.seconds, []

        def lint_in_time(unit):
            left = until - time.monotonic()
            found = lint(folder, options, build, unit, units[unit], left) if left > 0 else None
            if found is None:
                unreached.extend(units[unit])
            return found or (unit, True, "")

        judge(pool.map(lint_in_time, units))
    linted = sum(map(len, units.values())) - len(unreached)
    print(f"clang-tidy: {linted} sources")
    if unreached:
        print(f"NOT LINTED, no time left: {len(unreached)} sources: {' '.join(unreached)}")
    finish()


main()
