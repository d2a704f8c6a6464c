#!/bin/sh
# Writes the golden files anew:  tests/golden/update.sh [--force] [BUILD_FOLDER]
#
# tests/golden/v1 holds sample files of version 1 of the formats. They are frozen: files that users
# have must stay readable, so these are what a reader of today is tried on. Only files that are missing
# are written; --force replaces those that differ, for use before a release only.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
force=no
build=$source/build
for argument in "$@"; do
  case $argument in
    --force) force=yes ;;
    -*) echo "update.sh: error: unknown option $argument" >&2; exit 2 ;;
    *) build=$argument ;;
  esac
done

program=$build/tests/write_samples
if [ ! -x "$program" ]; then
  echo "update.sh: error: there is no $program; build first, or name the build folder" >&2
  exit 2
fi

fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$program" "$fresh" >/dev/null

frozen=$source/tests/golden/v1
mkdir -p "$frozen"
refused=0
for file in "$fresh"/*; do
  name=$(basename "$file")
  if [ ! -e "$frozen/$name" ]; then
    cp "$file" "$frozen/$name"
    echo "written: tests/golden/v1/$name"
  elif cmp -s "$file" "$frozen/$name"; then
    echo "unchanged: tests/golden/v1/$name"
  elif [ $force = yes ]; then
    cp "$file" "$frozen/$name"
    echo "replaced: tests/golden/v1/$name"
  else
    echo "update.sh: error: tests/golden/v1/$name differs from what is written now; it is frozen, so" \
      "the writer has changed (--force replaces it)" >&2
    refused=1
  fi
done

# JSON Schemas, from the field tables of the readers.
KROK_UPDATE_SCHEMAS=1 "$build/tests/test_golden" --gtest_brief=1 --gtest_filter='Schemas.*'

# Pages that are made from what the programs say of themselves.
if [ -d "$build/bin" ]; then
  python3 "$source/tests/golden/manual.py" "$build/bin" "$source" --update
fi
exit $refused
