"""Reads the reports that tools wrote during the tests, with a parser that is not theirs, and holds
them against the schema of formats/report where the package jsonschema is installed.

Usage: check_reports.py FOLDER. Prints what is wrong with them; exit code 1 if anything is, or if
there is no report.
"""

import json
import pathlib
import sys

try:
    from jsonschema import Draft202012Validator
    SCHEMA = pathlib.Path(__file__).parents[2] / "formats/report/report.schema.json"
    VALIDATOR = Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))
except ImportError:
    VALIDATOR = None


def refuse_constant(text):
    raise ValueError(f"the number {text}")


def refuse_repeats(pairs):
    keys = [key for key, _ in pairs]
    if len(keys) != len(set(keys)):
        raise ValueError(f"a key twice in {keys}")
    return dict(pairs)


def finite(text):
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise ValueError(f"the number {text}, which no double holds")
    return value


def strings(value):
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield key
            yield from strings(item)
    elif isinstance(value, list):
        for item in value:
            yield from strings(item)


# A unit in a key's name, or another name for what the reports of other tools have.
OTHER_WORDS = ("_mm", "_cm", "_deg", "_degrees", "_rad", "_radians", "_per_second", "_ms", "_fps")
OTHER_NAMES = {"fps": "rate", "frame_rate": "rate", "least": "smallest", "most": "largest",
               "low": "smallest", "high": "largest", "begin": "start"}


def other_conventions(value, key=""):
    """Numbers of a result in other units or under other names than everywhere: angles are degrees,
    lengths metres, times seconds. Lists of a motion's own joints or clips keep their names."""
    if isinstance(value, dict):
        for name, item in value.items():
            if isinstance(item, (int, float)) and not isinstance(item, bool):
                if name in OTHER_NAMES:
                    yield f"'{name}' is called '{OTHER_NAMES[name]}'"
                if name.endswith(OTHER_WORDS):
                    yield f"'{name}' has its unit in its name"
                if name != "rate" and isinstance(item, float) and float(f"{item:.9g}") != item:
                    yield f"'{name}' is {item!r}, more than nine digits"
            if name == "unit" and item == "rad":
                yield "a unit of radians"
            yield from other_conventions(item, name)
    elif isinstance(value, list):
        for item in value:
            yield from other_conventions(item, key)


def fault_of(data):
    try:
        report = json.loads(data.decode("utf-8"), parse_constant=refuse_constant, parse_float=finite,
                            object_pairs_hook=refuse_repeats)
    except ValueError as fault:  # also of decode()
        return str(fault)
    for key in ("schema", "tool", "version", "issues", "result"):
        if key not in report:
            return f"no '{key}'"
    for text in strings(report):
        if any(0xD800 <= ord(c) < 0xE000 for c in text):
            return "half of a surrogate pair"
    for fault in other_conventions(report["result"]):
        return fault
    if VALIDATOR is not None and report["schema"] == "krok.report/1":
        for fault in VALIDATOR.iter_errors(report):
            return f"{fault.json_path}: {fault.message}"
    return ""


def main():
    reports = sorted(pathlib.Path(sys.argv[1]).glob("*.json"))
    faults = 0
    for path in reports:
        fault = fault_of(path.read_bytes())
        if fault:
            faults += 1
            print(f"{path}: {fault}")
    print(f"{len(reports)} reports, {faults} faults")
    sys.exit(1 if faults or not reports else 0)


if __name__ == "__main__":
    main()
