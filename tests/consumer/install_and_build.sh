#!/usr/bin/env bash
# Installs the build into a fresh folder, builds the program of the folder `program` against it and
# runs it. Usage: install_and_build.sh BUILD_FOLDER PROGRAM_FOLDER SCRATCH_FOLDER
set -euo pipefail
build=$1 program=$2 scratch=$3
rm -rf "$scratch"
cmake --install "$build" --prefix "$scratch/prefix" > /dev/null
cmake -S "$program" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" > /dev/null
cmake --build "$scratch/build"
"$scratch/build/consumer"
# The same by pkg-config, where that is installed.
if pkg-config --version > /dev/null 2>&1; then
  PKG_CONFIG_PATH=$(dirname "$(find "$scratch/prefix" -name krok.pc)") pkg-config --cflags --libs krok |
    xargs c++ -std=c++20 "$program/main.cpp" -o "$scratch/by_pkg_config"
  "$scratch/by_pkg_config"
fi
for tool in "$scratch"/prefix/bin/krok*; do
  "$tool" --version
done
"$(dirname "$0")/complete.sh" "$scratch/prefix"
