#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Coverage-guided fuzzing of all that reads messages, files and images from elsewhere, under AddressSanitizer,
# UndefinedBehaviorSanitizer and LeakSanitizer (libFuzzer; see docs/testing.md).
#   scripts/fuzz.sh [--runs N] [--seconds S] [--build DIR] [--no-build] [TARGET...]
# Each TARGET (default: all) is executed N times in all (default 1000000), or for S seconds of this call (default: no
# limit), whichever comes first. What was done before counts, as long as the program is the same; so a call that was
# interrupted (Ctrl-C) is gone on with by the same call. Everything is in DIR (default build-fuzz): found/TARGET has the
# inputs that break it, corpus/TARGET what libFuzzer keeps. A table at the end; exit code 1 if anything was found.
set -eu
cd "$(dirname "$0")/.."

runs=1000000
seconds=0
build=build-fuzz
make=true
targets=""
while [ $# -gt 0 ]; do
  case $1 in
    --runs) runs=$2; shift ;;
    --seconds) seconds=$2; shift ;;
    --build) build=$2; shift ;;
    --no-build) make=false ;;
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "error: $1: no such option; --help lists them" >&2; exit 2 ;;
    *) targets="$targets $1" ;;
  esac
  shift
done

most_findings=5  # of a target: what comes after is mostly the same again
longest_s=60     # an execution, on the clock; of CPU time a step has a second (fuzz/target.h)
rss_mb=2560      # the sanitizers keep what was freed

if $make; then
  scripts/install_dependencies.sh clang-14 libclang-rt-14-dev llvm-14
  cmake -S . -B "$build" -G Ninja -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DRUMI_FUZZ=ON \
    -DRUMI_TESTS=OFF -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1" >/dev/null
  cmake --build "$build" -j "${JOBS:-$(nproc)}" --target fuzzers
fi
build=$(cd "$build" && pwd)
all=$(cd fuzz/targets && ls ./*.cpp | sed 's|^\./||; s|\.cpp$||')
[ -n "$targets" ] || targets=$all
for target in $targets; do
  [ -x "$build/fuzz/fuzz_$target" ] || { echo "error: $target: no such target; there are:" $all >&2; exit 2; }
done

# Targets read files: in memory, and gone with us.
TMPDIR=$(mktemp -d "$( [ -w /dev/shm ] && echo /dev/shm || echo /tmp )/rumi_fuzz_XXXXXX")
export TMPDIR
child=""
interrupted=false
trap 'rm -rf "$TMPDIR"' EXIT
trap 'interrupted=true; [ -z "$child" ] || kill -INT "$child" 2>/dev/null || true' INT TERM
export ASAN_OPTIONS="allocator_may_return_null=0:detect_leaks=1:symbolize=1"
export UBSAN_OPTIONS="print_stacktrace=1"
export LSAN_OPTIONS="suppressions=$PWD/tests/lsan.supp:print_suppressions=0"
ASAN_SYMBOLIZER_PATH=$(command -v llvm-symbolizer-14 || true)
export ASAN_SYMBOLIZER_PATH

run() {  # its output to a log; waits however often a signal comes
  log=$1
  shift
  "$@" >"$log" 2>&1 &
  child=$!
  while :; do
    code=0
    wait "$child" || code=$?
    kill -0 "$child" 2>/dev/null || break
  done
  child=""
  return "$code"
}

# Executions so far, of this very program.
counted() {
  if [ "$(cut -d' ' -f1 "$state" 2>/dev/null)" = "$version" ]; then cut -d' ' -f2 "$state"; else echo 0; fi
}

# What the round's log tells of: a kind and the input.
take_finding() {
  input=$(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)
  [ -n "$input" ] && [ -f "$input" ] || return 1
  cp "$log" "$input.log"
}

# What no longer breaks this program is an input like others.
forget_mended() {
  find "$work/found" -type f ! -name '*.log' | while read -r input; do
    if "$program" -timeout=$longest_s -rss_limit_mb=$rss_mb "$input" >/dev/null 2>&1; then
      mv "$input" "$work/corpus/"
      rm -f "$input.log"
    fi
  done
}

fuzz() {
  program=$build/fuzz/fuzz_$1
  work=$build/fuzz/work/$1
  state=$work/executions
  mkdir -p "$work/corpus" "$work/found"
  version=$(cksum <"$program" | tr ' ' '-')
  done_runs=$(counted)
  echo "$1: $done_runs executions so far" >&2
  forget_mended
  cp "$build/fuzz/seeds/$1"/* "$work/corpus/" 2>/dev/null || true
  end=$(($(date +%s) + seconds))
  while ! $interrupted && [ "$done_runs" -lt "$runs" ] && [ "$(count_found)" -lt "$most_findings" ]; do
    left=$((end - $(date +%s)))
    [ "$seconds" -eq 0 ] || [ "$left" -gt 0 ] || break
    [ "$seconds" -ne 0 ] || left=0
    code=0
    run "$work/log" "$program" -runs=$((runs - done_runs)) -max_total_time=$left -timeout=$longest_s \
      -rss_limit_mb=$rss_mb -malloc_limit_mb=1024 -print_final_stats=1 -reload=0 \
      -artifact_prefix="$work/found/" "$work/corpus" || code=$?
    executed=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/log" | tail -n 1)
    done_runs=$((done_runs + ${executed:-0}))
    echo "$version $done_runs" >"$state"
    # On a signal libFuzzer ends with 72.
    [ "$code" -eq 0 ] || [ "$code" -eq 72 ] || take_finding || { echo "$1: ended with $code; see $work/log" >&2; broken=true; return; }
  done
}

count_found() { find "$work/found" -type f ! -name '*.log' | wc -l; }

row() {
  work=$build/fuzz/work/$1
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$work/log" 2>/dev/null | tail -n 1)
  kinds=$(find "$work/found" -type f ! -name '*.log' 2>/dev/null | sed 's|.*/||; s|-.*||')
  number() { echo "$kinds" | grep -c "$1" || true; }
  slow=$(grep -la 's of CPU time' "$work"/found/*.log 2>/dev/null | wc -l)
  printf '%-24s %12s %8s %8s %6s %9s %5s\n' "$1" "$(cut -d' ' -f2 "$work/executions" 2>/dev/null || echo 0)" \
    "${edges:-0}" "$(($(number crash) - slow))" "$(number leak)" "$(($(number timeout) + slow))" "$(number oom)"
}

mkdir -p "$build/fuzz/seeds"
"$build/fuzz/write_seeds" "$build/fuzz/seeds"
broken=false
for target in $targets; do
  $interrupted || fuzz "$target"
done

printf '%-24s %12s %8s %8s %6s %9s %5s\n' target executions edges crashes leaks timeouts oom
for target in $targets; do row "$target"; done
found=$(for target in $targets; do find "$build/fuzz/work/$target/found" -type f ! -name '*.log' 2>/dev/null; done)
if [ -n "$found" ]; then
  echo "what was found, each with its log beside it:"
  echo "$found"
fi
! $interrupted || exit 130
[ -z "$found" ] && ! $broken
