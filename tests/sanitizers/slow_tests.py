"""Lists the tests that `make sanitize` leaves out: the slowest, until the others take SECONDS.

Usage: slow_tests.py RELEASE_BUILD SANITIZED_BUILD [SECONDS]

Both builds have what their test programs reported. SECONDS (800) are those under the sanitizers; a test
of the list beside this file, which did not run there, takes FACTOR times its seconds of the release
build, as is usual, and not less than before: what tests share is made by the first that runs. Each line
is the program's kind, the test, and its seconds.
"""

import pathlib
import sys

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent / "minutes"))
from build_times import test_seconds  # noqa: E402

# Stay although they are slow: what they alone reach is 1.5 % of the lines (make coverage).
KEPT = {
    ("unit", "CleanWalk.SpikesInBlocksAsInOne"),
    ("unit", "GeneratedWalks.OnEveryRig"),
    ("unit", "Grounds/Settle.LiesAndCrawlsWithoutHoverOrDepth/1"),
    ("unit", "HumanBody.AReferencePoseThatIsNoneGivesWayToATPose"),
    ("unit", "HumanBody.IsBoundToBonesOfItsOwnSide"),
    ("unit", "NoiseFilter.TheSameBytesForAnyNumberOfThreads"),
    ("unit", "Runs.AWalkBecomesARunAndAWalkAgain"),
    ("unit", "Settle.StandsUprightOnASlope"),
    ("unit", "StepStyle.IsTheLabelledOneWithItsDurations"),
}
KINDS = ("unit", "property", "fuzz", "cli")
FACTOR = 6

release, sanitized = (test_seconds(pathlib.Path(folder)) for folder in sys.argv[1:3])
tests = {key: time for key, time in sanitized.items() if key[0] in KINDS}
for line in (here / "slow_tests.txt").read_text().splitlines():
    kind, test, seconds = line.split()
    tests.setdefault((kind, test), max(float(seconds), FACTOR * release[kind, test]))
left, most = sum(tests.values()), float(sys.argv[3]) if len(sys.argv) > 3 else 800
for (kind, test), time in sorted(tests.items(), key=lambda item: (-item[1], item[0])):
    if left <= most:
        break
    if (kind, test) in KEPT:
        continue
    left -= time
    print(f"{kind} {test} {time:.2f}")
