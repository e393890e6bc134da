#!/usr/bin/env bash
# Lists the tests that fail now and then: tests/flaky.sh N [ARGUMENT...]
# Runs all tests N times beside two busy loops, and lists what ever failed, how often, with the folder of the logs.
# Arguments go to `cargo test`, as those of test.sh do. Fails if a test failed, or a run for another reason.
set -euo pipefail
[[ "${1:-}" =~ ^[1-9][0-9]*$ ]] || { sed -n '2,4p' "$0" >&2; exit 2; }
runs=$1; shift
cd "$(dirname "$0")/.."
export CARGO_TERM_COLOR=never
command=${VS_TEST_COMMAND:-./test.sh}
logs=target/flaky
rm -rf "$logs"
mkdir -p "$logs"

loops=()
trap '[ ${#loops[@]} -eq 0 ] || kill "${loops[@]}" 2>/dev/null' EXIT
for _ in 1 2; do
    while :; do :; done &
    loops+=($!)
done

unknown=0
for ((run = 1; run <= runs; run++)); do
    status=0
    "$command" "$@" >"$logs/$run.log" 2>&1 || status=$?
    awk -f tests/failed.awk "$logs/$run.log" >"$logs/$run.failed"
    count=$(wc -l <"$logs/$run.failed")
    if [ "$status" -ne 0 ] && [ "$count" -eq 0 ]; then
        unknown=1
        tail -n 5 "$logs/$run.log"
    fi
    printf 'run %d of %d: %d failed, status %d\n' "$run" "$runs" "$count" "$status"
done

cat "$logs"/*.failed | sort | uniq -c | sort -rn | sed "s/\t\$/\tthe binary did not end as it should/" >"$logs/ever"
if [ -s "$logs/ever" ]; then
    printf 'failed at least once in %d runs (logs: %s):\n' "$runs" "$logs"
    cat "$logs/ever"
    exit 1
fi
[ "$unknown" -eq 0 ] || { echo "no test failed, but a run did (logs: $logs)"; exit 1; }
echo "no test failed in $runs runs"
