#!/usr/bin/env bash
# Packs the tools with all shared libraries but those of glibc, so that they run where none of their
# dependencies is installed. The same build gives the same bytes.
# Usage: tarball.sh BUILD_FOLDER OUTPUT_FOLDER; prints the path of the archive.
set -euo pipefail
build=$(cd "$1" && pwd) output=$(mkdir -p "$2" && cd "$2" && pwd)
source=$(cd "$(dirname "$0")/.." && pwd)
version=$("$build/bin/krok" --version | cut -d ' ' -f 2)
name=krok-$version-linux-$(uname -m)
root=$output/$name
epoch=${SOURCE_DATE_EPOCH:-$(git -C "$source" log -1 --format=%ct)}

rm -rf "$root" "$root.tar.gz"
cmake --install "$build" --prefix "$root" --strip > /dev/null
own=$(find "$root/lib" -name 'libkrok-tools.so.*' -type f)
mv "$own" "$root/"
rm -rf "$root/include" "$root/lib"
mkdir -p "$root"/{lib,licenses} "$root/share/doc/krok/examples"
mv "$root/$(basename "$own")" "$root/lib/"
cp "$source"/{LICENSE,README.md,CHANGELOG.md} "$root/"
cp -r "$source/samples/captures" "$root/share/doc/krok/examples/"

# What is compiled or linked in: headers, static libraries, the font, and three.js in the pages.
packages=$(cat <<'END'
fonts-dejavu-core libceres-dev libcli11-dev libeigen3-dev libfast-float-dev libhwy-dev libtinygltf-dev
nlohmann-json3-dev
END
)
libraries=$(LD_LIBRARY_PATH=$root/lib ldd "$root"/bin/* | awk '/=> not found/ { print $1; exit 1 } /=> \// { print $3 }') ||
  { echo "tarball.sh: $libraries is not installed" >&2; exit 1; }
libraries=$(sort -u <<< "$libraries")
while read -r library; do
  [[ $library != "$root"/lib/* ]] || continue
  file=$(readlink -f "$library")
  package=$(dpkg -S "$file" "${file#/usr}" 2> /dev/null | head -n 1 | cut -d : -f 1 || true)
  [ -n "$package" ] || { echo "tarball.sh: $file belongs to no package: its licence is not known" >&2; exit 1; }
  [ "$package" != libc6 ] || continue
  cp "$file" "$root/lib/$(basename "$library")"
  packages+=" $package"
done <<< "$libraries"
for package in $packages; do
  cp "/usr/share/doc/$package/copyright" "$root/licenses/$package"
done
cp "$build/lib/page/node_modules/three/LICENSE" "$root/licenses/three.js"
# DT_RPATH, which comes before LD_LIBRARY_PATH.
patchelf --force-rpath --set-rpath '$ORIGIN/../lib' "$root"/bin/*
patchelf --force-rpath --set-rpath '$ORIGIN' "$root"/lib/*

chmod -R u=rwX,go=rX "$root"
tar -C "$output" --sort=name --mtime="@$epoch" --owner=0 --group=0 --numeric-owner --format=gnu -cf - "$name" |
  gzip -9n > "$root.tar.gz"
rm -rf "$root"
echo "$root.tar.gz"
