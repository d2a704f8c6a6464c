"""Each tool's page tells its --help word for word, so that the page cannot go stale.

Usage: manual.py BIN_FOLDER SOURCE_FOLDER [--update]

A page tools/krok-<verb>/README.md holds one ```text block, the help. --update writes it anew (and
makes the page where there is none).
"""

import pathlib
import re
import subprocess
import sys

binaries, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
update = "--update" in sys.argv
BLOCK = re.compile(r"```text\n.*?```", re.DOTALL)

stale = 0
for tool in sorted(binaries.glob("krok*")):
    help_text = subprocess.run([tool, "--help"], capture_output=True, text=True, check=True).stdout
    block = "```text\n" + help_text.rstrip() + "\n```"
    page = source / "tools" / tool.name / "README.md"
    text = page.read_text(encoding="utf-8") if page.exists() else f"# {tool.name}\n\n{block}\n"
    wanted = BLOCK.sub(lambda _: block, text, count=1)
    if page.exists() and wanted == page.read_text(encoding="utf-8") and block in wanted:
        continue
    if update:
        page.write_text(wanted, encoding="utf-8")
        print(f"{page.relative_to(source)}: written")
    else:
        stale += 1
        print(f"{page.relative_to(source)}: does not hold `{tool.name} --help`; run make golden")
sys.exit(1 if stale else 0)
