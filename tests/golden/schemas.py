"""Holds the JSON Schemas of the formats against what is written of these formats.

Usage: schemas.py SOURCE_FOLDER. Each formats/*/NAME.schema.json must be a JSON Schema, and must
accept the examples of its SPEC.md and the files of samples/ that say they are of that schema.
Prints what is wrong, exit code 1 if anything is, 77 (skipped) without the package jsonschema.
"""

import json
import pathlib
import re
import subprocess
import sys

try:
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import SchemaError
except ImportError:
    print("skipped: the Python package jsonschema is not installed")
    sys.exit(77)

EXAMPLE = re.compile(r"^```json\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def faults_of(validator, document):
    for fault in validator.iter_errors(document):
        yield f"{fault.json_path}: {fault.message}"


def main():
    root = pathlib.Path(sys.argv[1])
    faults, checked = [], 0
    validators = {}
    for path in sorted(root.glob("formats/*/*.schema.json")):
        name = path.relative_to(root)
        schema = json.loads(path.read_text(encoding="utf-8"))
        try:
            Draft202012Validator.check_schema(schema)
        except SchemaError as fault:
            faults.append(f"{name}: no JSON Schema: {fault.message}")
            continue
        validator = Draft202012Validator(schema)
        named = schema["properties"]["schema"]["const"]
        validators[named] = validator
        page = path.parent / "SPEC.md"
        # A page may be of several formats.
        examples = [example for example in EXAMPLE.findall(page.read_text(encoding="utf-8"))
                    if f'"{named}"' in example]
        if not examples:
            faults.append(f"{page.relative_to(root)}: has no example")
        for number, example in enumerate(examples, 1):
            checked += 1
            for fault in faults_of(validator, json.loads(example)):
                faults.append(f"{page.relative_to(root)}: example {number}: {fault}")
        # A misspelt key must not get past the schema.
        wrong = {**json.loads(examples[0]), "mispelt": 1} if examples else {}
        if not list(faults_of(validator, wrong)):
            faults.append(f"{name}: accepts a key that is not known")

    tracked = subprocess.run(
        ["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard",
         "samples/*.json"], capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, tracked):
        document = json.loads((root / name).read_text(encoding="utf-8"))
        validator = validators.get(document.get("schema")) if isinstance(document, dict) else None
        if validator is None:
            continue
        checked += 1
        faults += [f"{name}: {fault}" for fault in faults_of(validator, document)]

    for fault in faults:
        print(fault)
    print(f"{len(validators)} schemas, {checked} documents checked, {len(faults)} faults")
    return 1 if faults or checked == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
