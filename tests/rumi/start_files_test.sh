#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The files that start Rumi by other means than `rumi up`: that systemd and procman can read them, and that what they say
# starts five processes that run and end well. All of it as it is installed. Run by tests/run_in_netns.sh.
#   start_files_test.sh BUILD_DIR
set -eu
build=$1
work=$(mktemp -d)
prefix=$work/prefix
units=$prefix/lib/systemd/system
config=$prefix/share/rumi/config
pids=""
cleanup() {
  for pid in $pids; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap cleanup EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

cmake --install "$build" --prefix "$prefix" --component programs >/dev/null
rumi=$prefix/bin/rumi
for file in bin/rumi libexec/rumi/map_server share/rumi/config/rumi.yaml share/rumi/config/expert.yaml share/rumi/config/cameras/tum_fr1.yaml \
  share/rumi/web/index.html share/rumi/web/main.js \
  share/doc/rumi/README.md share/doc/rumi/LICENSE share/doc/rumi/docs/wire.md; do
  [ -s "$prefix/$file" ] || fail "not installed: $file"
done
[ "$(ls "$prefix/bin")" = rumi ] || fail "only rumi is to be on the PATH, not: $(ls "$prefix/bin")"
"$rumi" map_server --help | grep -q "map_server.database" || fail "rumi map_server does not run the installed program"
if command -v systemd-analyze >/dev/null; then
  said=$(systemd-analyze verify --man=no "$units"/* 2>&1) || true # what it does not understand is no error to it
  [ -z "$said" ] || fail "systemd-analyze verify: $said"
else
  echo "SKIPPED: systemd-analyze is missing, so config/systemd was NOT checked by systemd" >&2
fi
for name in $(sed -n 's/^\(Wants\|After\|Requires\)=//p' "$units"/*); do
  case $name in rumi*) [ -f "$units/$name" ] || fail "there is no $name" ;; esac
done
# There is a man page for `rumi` and for each process.
for page in $(sed -n 's/^Documentation=man:\(.*\)(1)$/\1/p' "$units"/*); do
  [ "$page" = rumi ] || [ -x "$prefix/libexec/rumi/${page#rumi-}" ] || fail "there is no man page $page"
done

# procman's grammar, a statement in a line; every command has a program and a deputy, and scripts name commands.
awk '
  function bad(why) { printf "%s:%d: %s: %s\n", FILENAME, NR, why, $0; failed = 1; exit 1 }
  function name(  parts) { split($0, parts, "\""); return parts[2] }
  { sub(/^[ \t]+/, "") }
  /^(#|$)/ { next }
  /^(group|script) "[^"\/]+" [{]$/ { if (++depth > 1 && /^script/) bad("a script within a group"); next }
  /^cmd "[^"\/]+" [{]$/ { ++depth; command = name(); commands[command]; next }
  /^}$/ { if (command != "" && (!(command in program) || !(command in deputy))) bad(command " lacks exec or deputy")
          command = ""; if (--depth < 0) bad("one too many"); next }
  command != "" && /^exec = "[^"]+";$/ { program[command]; next }
  command != "" && /^deputy = "[^"]+";$/ { deputy[command]; next }
  command != "" && /^auto_respawn = "(true|false)";$/ { next }
  command != "" && /^stop_(signal|time_allowed) = [1-9][0-9]*;$/ { next }
  command == "" && /^(start|stop|restart) cmd "[^"]+"( wait "(running|stopped)")?;$/ {
    if (!(name() in commands)) bad("no such command"); next }
  command == "" && /^wait ms [0-9]+;$/ { next }
  { bad("not understood") }
  END { if (!failed && depth != 0) { print FILENAME ": a } is missing"; exit 1 } }
' "$config/procman/rumi.pmd" || fail "config/procman/rumi.pmd"

"$rumi" synth -q -o "$work/sequence" --seconds 2 --size 320x240
sed 's/^  loop: false/  loop: true/' "$config/rumi.yaml" >"$work/rumi.yaml"
export RUMI_INPUT="$work/sequence" RUMI_CONFIG="$work/rumi.yaml"

# Starts the commands in FILE, waits until all have told that they run, and ends them, last first: run_all NAME FILE.
run_all() {
  echo "$1: $(wc -l <"$2") commands"
  mkdir "$work/$1"
  cd "$work/$1"
  while read -r command; do
    eval "exec $command" </dev/null >>log 2>&1 &
    pids="$! $pids"
  done <"$2"
  tries=0
  until [ "$("$rumi" status --json | grep -c '"state": "running"')" -eq 5 ]; do
    tries=$((tries + 1))
    [ "$tries" -lt 30 ] || { cat log && "$rumi" status && fail "$1: not all five run"; }
  done
  for pid in $pids; do
    kill "$pid"
    code=0
    wait "$pid" || code=$?
    [ "$code" -eq 0 ] || { cat log && fail "$1: exit code $code"; }
  done
  pids=""
  [ -f map.db ] || fail "$1: there is no map"
}
sed -n 's/^ *exec = "\(.*\)";$/\1/p' "$config/procman/rumi.pmd" >"$work/procman.commands"
run_all procman "$work/procman.commands"
for unit in $(sed -n 's/^Wants=//p' "$units/rumi.target"); do
  sed -n 's/^ExecStart=//p' "$units/$unit" | sed "s|/etc/rumi/rumi.yaml|$RUMI_CONFIG|"
done >"$work/systemd.commands"
run_all systemd "$work/systemd.commands"

# `rumi up` starts its own programs, also where others' of the same names are beside it and on the PATH.
for name in map_server camera_driver front_tracker ruminator viewer_offscreen; do
  printf '#!/bin/sh\necho "a stranger is started" >&2\nexit 1\n' >"$prefix/bin/$name"
  chmod 755 "$prefix/bin/$name"
done
mkdir "$work/up" && cd "$work/up"
PATH="$prefix/bin:$PATH" "$rumi" up "$config/rumi.yaml" "$work/sequence" >log 2>&1 || { cat log && fail "rumi up: exit code $?"; }
! grep stranger log || fail "rumi up started others' programs"
[ -f map.db ] || { cat log && fail "rumi up: there is no map"; }
