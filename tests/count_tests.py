"""Adds up what the test programs reported and prints it as the last line: "2891 passed, 0 failed".

Usage: count_tests.py RESULTS_FOLDER. Exit code 1 where a test failed, none ran, or a report is cut
short; names those that failed or were skipped.
"""

import json
import pathlib
import sys
from collections import Counter

count = Counter()
for path in sorted(pathlib.Path(sys.argv[1]).glob("*.json")):
    try:
        report = json.loads(path.read_text())
    except ValueError:
        print(f"{path.name}: the program ended before its report was written")
        count["failed"] += 1
        continue
    for suite in report["testsuites"]:
        for test in suite["testsuite"]:
            if test["status"] != "RUN":
                continue
            outcome = ("failed" if test.get("failures") else
                       "skipped" if test["result"] == "SKIPPED" else "passed")
            count[outcome] += 1
            if outcome == "failed":
                print(f"failed: {test['classname']}.{test['name']} ({path.stem})")
            if outcome == "skipped":
                why = test.get("skipped", [{}])[0].get("message", "").split("\n")
                print(f"skipped: {test['classname']}.{test['name']}: {' '.join(why[1:]).strip()}")
skipped = f", {count['skipped']} skipped" if count["skipped"] else ""
print(f"{count['passed']} passed, {count['failed']} failed{skipped}")
sys.exit(1 if count["failed"] or not count["passed"] else 0)
