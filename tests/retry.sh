#!/usr/bin/env bash
# Runs the tests, and those that failed once more, each alone: tests/retry.sh REPORT COMMAND...
# COMMAND is a test command that passes its arguments to `cargo test --no-fail-fast`. What passes alone goes to the file
# REPORT, under FLAKY, with its first failure, and does not count; what fails again does. So do a build that fails, a
# binary that crashes, an example in the documentation, and more than 20 failures, which are no accident.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,5p' "$0" >&2; exit 2; }
report=$1; shift
most=20
failed_awk=$(dirname "$0")/failed.awk
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
: >"$report"
export CARGO_TERM_COLOR=never

status=0
"$@" 2>&1 | tee "$folder/log" || status=$?
[ "$status" -ne 0 ] || exit 0

awk -f "$failed_awk" "$folder/log" >"$folder/failed"
count=$(wc -l <"$folder/failed")
again() { printf 'retry: %s\n' "$*" >&2; }
if [ "$count" -eq 0 ]; then
    again "the tests were not run"
    exit "$status"
fi
if [ "$count" -gt "$most" ]; then
    again "$count tests failed; more than $most are not run again"
    exit "$status"
fi

real=0
while IFS=$'\t' read -r option name; do
    if [ -z "$name" ] || [ "$option" = --doc ]; then
        again "$option ${name:-did not end as it should}: not run again"
        real=1
        continue
    fi
    again "$option $name: once more, alone"
    # The option may be two words. With a workspace, several binaries may be run, of which one has the test.
    # shellcheck disable=SC2086
    if "$@" $option -- --exact "$name" >"$folder/again" 2>&1 </dev/null && grep -qE '^test result: ok\. [1-9]' "$folder/again"; then
        { echo "FLAKY $option $name: failed, and passed alone. The first failure:"
          awk -f "$failed_awk" -v target="$option" -v test="$name" "$folder/log"; } >>"$report"
    else
        cat "$folder/again"
        again "$option $name: FAILED again"
        real=1
    fi
done <"$folder/failed"
exit "$real"
