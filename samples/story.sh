# What the scripts of the stories share. Sourced by samples/*/run.sh, which begin with a comment that
# says what they do.
#
#   bin        where the tools are: $KROK_BIN, or build/bin
#   generators where make-walk and make-gesture are: $SAMPLES_BIN, or build/samples
set -euo pipefail

story=$(cd "$(dirname "${BASH_SOURCE[1]}")" && pwd)
bin=${KROK_BIN:-$story/../../build/bin}
generators=${SAMPLES_BIN:-$story/../../build/samples}

# The comment that the script begins with.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$story/run.sh"; }

fail() {
  echo "run.sh: error: $1" >&2
  [ $# -lt 2 ] || echo "  hint: $2" >&2
  exit 2
}

say() { printf '\n%s\n' "$1"; }

# need_tools VERB...: krok-VERB must be there.
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

# check_arguments MOST ARGUMENTS...: help where it is asked for, at most MOST arguments.
check_arguments() {
  local most=$1
  shift
  case "${1:-}" in -h | --help) usage && exit 0 ;; esac
  [ $# -le "$most" ] ||
    fail "$# arguments, at most $most $([ "$most" = 1 ] && echo is || echo are) taken" \
      "put names with spaces in quotes"
}

# enter_folder FOLDER: makes it and goes there; relative names are then those in it.
enter_folder() {
  mkdir -p -- "$1" || fail "cannot make the folder $1"
  cd -- "$1"
}
