"""The options of all tools, as `krok-VERB --list-options` prints them, hold one name for one idea.

Usage: option_names.py BIN_FOLDER

Fails if a name takes values of two kinds, or one idea has two names, beyond those listed here, and if
what is listed here is gone (so that the lists only shrink). Prints the number of names.
"""

import collections
import pathlib
import subprocess
import sys

binaries = pathlib.Path(sys.argv[1])

# Ideas, by words of the help that no other option has, and the names that they still have.
IDEAS = {
    "frame rate of the result": {"--rate", "--fps", "--resample"},
    "chart beside the result": {"--plot", "--plots"},
    "side of the view": {"--sides", "--view", "--front"},
    "contacts of feet": {"--contacts", "--keys", "--find"},
    "actors at their own places": {"--layout", "--together"},
    "how things are matched": {"--match", "--align", "--by-order"},
}
# Names that still take values of several kinds.
KINDS = {
    "--cam", "--clip", "--from", "--ground", "--joints", "--keys", "--margin", "--model", "--order",
    "--set", "--size", "--smooth", "--table", "--to", "--until", "--up", "--view",
}

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
    if len(found) > 1 and name not in KINDS:
        failed = True
        print(f"{name} takes values of several kinds: " +
              "; ".join(f"{kind} in {', '.join(sorted(tools))}" for kind, tools in sorted(found.items())))
for name in sorted(KINDS):
    if len(kinds.get(name, ())) < 2:
        failed = True
        print(f"{name} has one kind now, or is gone: take it out of KINDS in {__file__}")
for idea, names in IDEAS.items():
    for name in sorted(names - kinds.keys()):
        failed = True
        print(f"{idea}: {name} is gone: take it out of IDEAS in {__file__}")
print(f"{len(kinds)} names of options; {len(KINDS)} with several kinds of values; "
      f"{sum(len(names) > 1 for names in IDEAS.values())} ideas with several names")
sys.exit(failed)
