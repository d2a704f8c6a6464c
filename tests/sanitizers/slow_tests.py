"""Lists the tests that `make sanitize` leaves out: the slowest, until the others take SECONDS.

Usage: slow_tests.py RESULTS_FOLDER [SECONDS]

The folder has what the test programs reported. SECONDS (100) are those of the release build, of which
the sanitizers take two to three times as many. Each line is the program's kind, the test, and its
seconds.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "minutes"))
from build_times import test_seconds  # noqa: E402

KINDS = ("unit", "property", "fuzz", "cli")

tests = {key: time for key, time in test_seconds(pathlib.Path(sys.argv[1]).parent).items() if key[0] in KINDS}
left, most = sum(tests.values()), float(sys.argv[2]) if len(sys.argv) > 2 else 100
for (kind, test), time in sorted(tests.items(), key=lambda item: (-item[1], item[0])):
    if left <= most:
        break
    left -= time
    print(f"{kind} {test} {time:.2f}")
