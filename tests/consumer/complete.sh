#!/usr/bin/env bash
# Types the begin of commands in shells that find the installed completion files by themselves, and
# checks what they complete: bash (with bash-completion where that is installed), fish and zsh where
# they are. Usage: complete.sh PREFIX
set -euo pipefail
prefix=$(cd "$1" && pwd)
home=$(mktemp -d)
trap 'rm -rf "$home"' EXIT
export HOME=$home TERM=dumb PATH=$prefix/bin:$PATH XDG_DATA_DIRS=$prefix/share:/usr/share
unset XDG_CONFIG_HOME XDG_DATA_HOME ZDOTDIR

# Loads only the file of the command's name, as a shell that was just started does.
in_bash() {
  bash --norc --noprofile -c '
    if [[ -r /usr/share/bash-completion/bash_completion ]]; then
      . /usr/share/bash-completion/bash_completion
      _completion_loader "$2" || true
    else
      . "$1/share/bash-completion/completions/$2"
    fi
    shift
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    $(complete -p "$1" | sed "s/.*-F \([^ ]*\) .*/\1/")
    printf "%s\n" "${COMPREPLY[@]}"' bash "$prefix" "$@"
}

in_fish() {
  fish -c 'complete -C "$argv"' -- "$@" | cut -f 1
}

# In a terminal of its own: Tab, then Enter, which shows the words as they are then.
in_zsh() {
  zsh -f -c '
    wait_for() {
      local text part
      repeat 200; do
        zpty -r -t shell part && text+=$part
        [[ $text == *$~1* ]] && break
        sleep 0.05
      done
      print -r -- $text
    }
    zmodload zsh/zpty
    zpty -b shell zsh -f -i
    zpty -w shell "fpath=(${(q)1}/share/zsh/*(N) \$fpath); autoload -U compinit; compinit -D -u"
    zpty -w shell "${2}() { print -r -- \"words: \$* .\" }; print rea\"\"dy"
    wait_for ready > /dev/null
    zpty -w -n shell "${@[2,-1]}"$'"'\\t\\n'"'
    wait_for "words: *." | grep -o "words: .*" | tr -d "\\r"
    zpty -d shell' zsh "$prefix" "$@"
}

shells=()
for shell in bash fish zsh; do
  command -v $shell > /dev/null || continue
  shells+=("$shell")
  # What is typed, and a word that it completes to.
  while read -r word typed; do
    offered=$(in_$shell $typed)
    [[ " ${offered//$'\n'/ } " == *" $word "* ]] ||
      { echo "$shell: '$typed' completes to '$offered', not to '$word'"; exit 1; }
  done <<'END'
import krok imp
--quantize krok skin --quan
pose krok-skin --as p
END
done
echo "completed in ${shells[*]}"
