#!/bin/bash
# Usage: run_kept.sh KROK_TARGETS. Runs each target on what fuzzing found before, kept/TARGET/*.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
count=0
for folder in "$here"/kept/*/; do
  target=$(basename "$folder")
  timeout 60 "$1" "$target" "$folder"
  count=$((count + $(find "$folder" -type f | wc -l)))
done
[ "$count" -gt 0 ] || { echo "no kept inputs"; exit 1; }
echo "$count kept inputs"
