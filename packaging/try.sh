#!/usr/bin/env bash
# Tries Debian packages or the tarball in a root without any of their dependencies: installs, runs the
# package's test, and for packages removes them again and looks for what they left. Needs root; for
# packages a network. Usage: try.sh ROOT.tar KROK.deb...|KROK.tar.gz; a ROOT.tar is made by
#   mmdebstrap --variant=minbase bookworm ROOT.tar
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
root=$(mktemp -d)
trap 'umount -R "$root/proc" "$root/dev" 2> /dev/null; rm -rf "$root"' EXIT
tar -xf "$1" -C "$root"
shift
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --make-rslave "$root/dev"
cp -L /etc/resolv.conf "$root/etc/"
cp "$source/debian/tests/capture-to-character" "$root/root/test"
cp "$@" "$root/root/"

in_root() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C DEBIAN_FRONTEND=noninteractive \
    AUTOPKGTEST_TMP=/root/work chroot "$root" sh -euc "$@"
}
seconds() { date +%s.%N; }
since() { echo "$1 $(seconds)" | awk '{ printf "%.1f s", $2 - $1 }'; }
packages() { in_root 'dpkg-query -W -f "\${Package} \${Installed-Size}\n"' | sort; }

mkdir "$root/root/work"
if [[ $1 == *.deb ]]; then
  in_root 'apt-get update -q > /dev/null'
  before=$(packages)
  begin=$(seconds)
  in_root 'apt-get install -y -q --no-install-recommends /root/*.deb 2>&1' > "$root/root/log" ||
    { tail "$root/root/log"; exit 1; }
  echo "installed in $(since "$begin")"
  in_root 'krok-import /usr/share/doc/krok/examples/captures/walk.bvh -o /root/walk.anim -q
           krok-plot /root/walk.anim --sheet /root/walk.png -q'
  echo "first picture after $(since "$begin")"
  join -v 2 <(echo "$before") <(packages) | sort -k 2 -rn |
    awk '{ total += $2 } NR <= 10 { print "  " $1, $2, "kB" } END { print NR, "packages,", total / 1024, "MiB" }'
  in_root '/root/test'
  in_root 'apt-get purge -y -q "krok*" "*krok*"; apt-get autoremove --purge -y -q' > /dev/null 2>&1
  diff <(echo "$before") <(packages) || { echo "packages differ after the removal"; exit 1; }
  left=$(find "$root" -xdev -path "$root/root" -prune -o -iname '*krok*' -print)
  [ -z "$left" ] || { echo "left behind: $left"; exit 1; }
  echo "removed, nothing left"
else
  in_root 'cd /opt; tar -xzf /root/*.tar.gz'
  echo "unpacked: $(du -sm "$root/opt" | cut -f 1) MB"
  in_root '/root/test /opt/krok-*'
fi
