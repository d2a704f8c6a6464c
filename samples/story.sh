# Sourced by samples/*/run.sh. The leading comment of each of these is its --help text.
#
#   bin        folder of the tools: $KROK_BIN, or build/bin
#   generators folder of make-walk and make-gesture: $SAMPLES_BIN, or build/samples
set -euo pipefail

story=$(cd "$(dirname "${BASH_SOURCE[1]}")" && pwd)
bin=${KROK_BIN:-$story/../../build/bin}
generators=${SAMPLES_BIN:-$story/../../build/samples}

# Prints the leading comment of the script.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$story/run.sh"; }

fail() {
  echo "run.sh: error: $1" >&2
  [ $# -lt 2 ] || echo "  hint: $2" >&2
  exit 2
}

say() { printf '\n%s\n' "$1"; }

# need_tools VERB...: fails unless each krok-VERB exists.
need_tools() {
  local tool
  for tool in "$@"; do
    [ -x "$bin/krok-$tool" ] || fail "no krok-$tool in $bin" "build with make, or set KROK_BIN"
  done
}

# need_generators PROGRAM...
need_generators() {
  local program
  for program in "$@"; do
    [ -x "$generators/$program" ] ||
      fail "no $program in $generators" "build with make, or set SAMPLES_BIN"
  done
}

# check_arguments MAX ARGUMENTS...: prints the help if requested; fails on more than MAX arguments.
check_arguments() {
  local most=$1
  shift
  case "${1:-}" in -h | --help) usage && exit 0 ;; esac
  [ $# -le "$most" ] ||
    fail "$# arguments, expected at most $most" \
      "put names with spaces in quotes"
}

# enter_folder FOLDER: creates it and changes to it.
enter_folder() {
  mkdir -p -- "$1" || fail "cannot create the folder $1"
  cd -- "$1"
}
