"""Share of the lines of lib and formats that ran, from what a build with --coverage left.

Usage: line_coverage.py SOURCE_FOLDER BUILD_FOLDER [--against FILE] [--save FILE]

FILE keeps the lines that ran; --against prints which of those did not run now.
"""

import argparse
import gzip
import json
import pathlib
import subprocess
import tempfile
from collections import defaultdict


def lines_of(source, build):
    ran = defaultdict(dict)  # file -> line -> whether
    files = [str(f) for layer in ("lib", "formats") for f in (build / layer).rglob("*.gcda")]
    with tempfile.TemporaryDirectory() as folder:
        for start in range(0, len(files), 8):
            subprocess.run(["gcov", "--json-format", *files[start:start + 8]], cwd=folder, check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            for path in pathlib.Path(folder).glob("*.gcov.json.gz"):
                report = json.loads(gzip.open(path).read())
                for entry in report["files"]:
                    file = (pathlib.Path(report["current_working_directory"]) / entry["file"]).resolve()
                    if not file.is_relative_to(source) or file.relative_to(source).parts[0] not in ("lib", "formats"):
                        continue
                    lines = ran[str(file.relative_to(source))]
                    for line in entry["lines"]:
                        number = line["line_number"]
                        lines[number] = lines.get(number, False) or line["count"] > 0
                path.unlink()
    return ran


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--against", type=pathlib.Path)
    parser.add_argument("--save", type=pathlib.Path)
    arguments = parser.parse_args()
    ran = lines_of(arguments.source.resolve(), arguments.build.resolve())
    all_lines = sum(len(lines) for lines in ran.values())
    now = {f"{file}:{line}" for file, lines in ran.items() for line, yes in lines.items() if yes}
    print(f"{len(now)} of {all_lines} lines ran, {100 * len(now) / max(all_lines, 1):.2f} %")
    if arguments.save:
        arguments.save.write_text("\n".join(sorted(now)))
    if arguments.against:
        lost = defaultdict(int)
        for place in set(arguments.against.read_text().split("\n")) - now:
            lost[place.rsplit(":", 1)[0]] += 1
        print(f"{sum(lost.values())} lines ran before and not now")
        for file, count in sorted(lost.items(), key=lambda item: -item[1])[:20]:
            print(f"{count:6d}  {file}")


main()
