"""The options of all tools, as `krok-VERB --list-options` prints them, hold one name for one idea.

Usage: option_names.py BIN_FOLDER

Fails if a name takes values of two kinds, or if a name from before (tools/cli/renamed_options.h) is
not refused with the new one as the hint. Prints the number of names.
"""

import collections
import pathlib
import re
import subprocess
import sys

binaries = pathlib.Path(sys.argv[1])
renamed = (pathlib.Path(__file__).parents[2] / "tools/cli/renamed_options.h").read_text()

kinds = collections.defaultdict(lambda: collections.defaultdict(set))
for program in sorted(binaries.glob("krok-*")):
    listed = subprocess.run([program, "--list-options"], capture_output=True, text=True, check=True).stdout
    for line in listed.splitlines():
        names, _, _, _, _, kind = line.split("\t")
        for name in names.split():
            if name.startswith("--"):
                kinds[name][kind].add(program.name)

failed = False
for name, found in sorted(kinds.items()):
    if len(found) > 1:
        failed = True
        print(f"{name} takes values of several kinds: " +
              "; ".join(f"{kind} in {', '.join(sorted(tools))}" for kind, tools in sorted(found.items())))
rows = [(tool, before, now, name)
        for tool, names, now, name in re.findall(r'\{"(krok-\w+)",\s+"([\w -]+)",\s+"((--[\w-]+)[^"]*)"\}', renamed)
        for before in names.split() if before.startswith("--")]
for tool, before, now, name in rows:
    run = subprocess.run([binaries / tool, before], capture_output=True, text=True, check=False)
    if run.returncode != 2 or now not in run.stderr or not any(tool in found for found in kinds[name].values()):
        failed = True
        print(f"{tool} {before}: expected exit 2 and the hint {now}, an option of it: {run.stderr}")
print(f"{len(kinds)} names of options, each with one kind of values; {len(rows)} former names refused")
sys.exit(failed or not rows)
