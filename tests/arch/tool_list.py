"""`krok --help` names every tool that was built, and no other.

Usage: tool_list.py BIN_FOLDER
"""

import pathlib
import re
import subprocess
import sys

folder = pathlib.Path(sys.argv[1])
text = subprocess.run([folder / "krok", "--help"], capture_output=True, text=True, check=True).stdout
section = text.split("Verbs:\n")[1].split("\n\n")[0]
listed = set(re.findall(r"^  (\S+)", section, re.MULTILINE))
built = {path.name.removeprefix("krok-") for path in folder.glob("krok-*")}
print("listed:", sorted(listed), "built:", sorted(built))
sys.exit(0 if listed == built else 1)
