# Completion in bash for the programs of vismap. Options, verbs and choices are read from --help of the program, so that
# they are those of the installed version.

# _vismap_words PROGRAM [VERB]: options and verbs, one per line.
_vismap_words() {
  "$@" --help 2>/dev/null | awk '
    /^Subcommands:/ { verbs = 1; next }
    /^[A-Z][A-Za-z ]*:/ { verbs = 0 }
    verbs && /^  [a-z]/ { print $1 }
    /^  -/ {
      for (i = 1; i <= NF && $i ~ /^-/; i++) {
        count = split($i, names, ",")
        for (j = 1; j <= count; j++) if (names[j] != "") print names[j]
      }
    }'
}

# _vismap_choices OPTION PROGRAM [VERB]: the words that the option accepts, if it has a list of them.
_vismap_choices() {
  local option="$1"
  shift
  "$@" --help 2>/dev/null | awk -v option="$option" '
    /^  -/ && $2 ~ /\|/ { count = split($1, names, ","); for (i = 1; i <= count; i++) if (names[i] == option) { gsub(/\|/, " ", $2); print $2 } }'
}

_vismap() {
  local current="${COMP_WORDS[COMP_CWORD]}" previous="${COMP_WORDS[COMP_CWORD - 1]}" program="${COMP_WORDS[0]}"
  local command=("$program") word words
  local -a verbs
  mapfile -t verbs < <(_vismap_words "$program" | grep -v '^-')
  for word in "${COMP_WORDS[@]:1:COMP_CWORD - 1}"; do
    [[ " ${verbs[*]} " == *" $word "* ]] && command=("$program" "$word") && break
  done
  words="$(_vismap_choices "$previous" "${command[@]}")"
  # The name of a file may follow an option with a value, and every word that is no option and no verb.
  [[ -n "$words" ]] || words="$(_vismap_words "${command[@]}")"
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}

complete -o default -F _vismap vismap-adapter vismap-bridge vismap-depth-segmenter vismap-detector vismap-doctor \
  vismap-hub vismap-log vismap-map vismap-map-server vismap-octomap-exporter vismap-offline-mapper vismap-sensor-replay \
  vismap-viewer vismap-launch vismap-deploy-check
