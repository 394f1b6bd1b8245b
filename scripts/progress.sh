# Signs of life of work that takes minutes; sourced by other scripts.

# say TEXT...: one line, with the name of the script in front.
say() { echo "scripts/$(basename "$0"): $*"; }

# failed_recently STAMP CONTENT: whether the file STAMP says that this very attempt failed within the last day.
failed_recently() {
  [ "$(cat "$1" 2>/dev/null || true)" = "$2" ] && [ -n "$(find "$1" -mmin -1440 2>/dev/null)" ]
}

# with_progress DESCRIBE LOG COMMAND...: runs COMMAND. On a terminal, COMMAND shows its own progress. Elsewhere its output
# goes to the file LOG, and every 30 s one line says what the function DESCRIBE reads from LOG.
with_progress() {
  local describe="$1" log="$2" watcher status=0
  shift 2
  mkdir -p "$(dirname "$log")"
  if [ -t 1 ]; then
    "$@"
    return
  fi
  : >"$log"
  (
    trap 'kill "$!"; exit' TERM
    while true; do
      sleep 30 >/dev/null 2>&1 &
      wait "$!"
      kill -0 $$ 2>/dev/null || exit
      say "$("$describe" "$log")"
    done
  ) &
  watcher=$!
  "$@" >"$log" 2>&1 </dev/null || status=$?
  kill "$watcher"
  wait "$watcher" 2>/dev/null || true
  return "$status"
}

# build_progress LOG: how far ninja is.
build_progress() {
  local steps
  steps="$(tail -c 4000 "$1" | sed -n 's|^\[\([0-9]*\)/\([0-9]*\)\].*|\1 of \2|p' | tail -n 1)"
  [ -z "$steps" ] && echo "The build has not finished a step yet." || echo "The build has finished step $steps."
}

# packages_progress LOG: how far apt-get is.
packages_progress() {
  local unpacked
  unpacked="$(grep -c '^Unpacking' "$1" || true)"
  echo "Debian packages are being installed; $unpacked of them are unpacked so far."
}

# tests_progress LOG: how far ctest is.
tests_progress() {
  local ended failed
  ended="$(sed -n 's|^ *\([0-9]*\)/\([0-9]*\) Test .*|\1 of \2|p' "$1" | tail -n 1)"
  failed="$(grep -c -E '^ *[0-9]+/[0-9]+ Test .*\*\*\*(Failed|Timeout|Exception|Not Run)' "$1" || true)"
  [ -z "$ended" ] && echo "No test has ended yet." || echo "Tests: $ended have ended; $failed of them failed."
}
