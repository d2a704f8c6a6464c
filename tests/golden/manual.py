"""Each tool's page tells its --help word for word, so that the page cannot go stale.

Usage: manual.py BIN_FOLDER SOURCE_FOLDER [--update]

A page tools/krok-<verb>/README.md holds one ```text block, the help. The table of tools/README.md
has the sentences before the usage, in the order of `krok --help`. --update writes both anew (and
makes a page where there is none).
"""

import pathlib
import re
import subprocess
import sys

binaries, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
update = "--update" in sys.argv
BLOCK = re.compile(r"```text\n.*?```", re.DOTALL)



def help_of(tool):
    return subprocess.run([binaries / tool, "--help"], capture_output=True, text=True, check=True).stdout


def with_help(text, help_text):
    block = "```text\n" + help_text.rstrip() + "\n```"
    return BLOCK.sub(lambda _: block, text, count=1) if BLOCK.search(text) else text + block + "\n"


def with_table(text):
    verbs = re.findall(r"^  (\S+)", help_of("krok").split("Verbs:\n")[1].split("\n\n")[0], re.MULTILINE)
    rows = ""
    for verb in verbs:
        told = help_of(f"krok-{verb}").split("\n\nUsage:")[0].split("\n\n")
        sentences = ". ".join(" ".join(part.split("\n")) for part in told)
        rows += f"| [krok-{verb}](krok-{verb}/README.md) | {sentences.rstrip('.')} |\n"
    return re.sub(r"(\|---\|---\|\n)(\|.*\n)+", lambda head: head[1] + rows, text, count=1)


wanted = {}
for tool in sorted(path.name for path in binaries.glob("krok*")):
    page = source / "tools" / tool / "README.md"
    text = page.read_text(encoding="utf-8") if page.exists() else f"# {tool}\n\n"
    wanted[page] = with_help(text, help_of(tool))
index = source / "tools" / "README.md"
wanted[index] = with_table(index.read_text(encoding="utf-8"))

stale = 0
for page, text in wanted.items():
    if page.exists() and text == page.read_text(encoding="utf-8"):
        continue
    if update:
        page.write_text(text, encoding="utf-8")
        print(f"{page.relative_to(source)}: written")
    else:
        stale += 1
        print(f"{page.relative_to(source)}: is not what --help tells; run make golden")
sys.exit(1 if stale else 0)
