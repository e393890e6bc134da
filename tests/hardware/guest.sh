# Sourced by the scripts that run in the virtual machine: how they speak, wait and look. They set `out`, the folder of results;
# `log`, of the program; `journal`, its recording, if there is one; and `program`, the process that must go on.

say() { printf '[%4ds] %s\n' "$SECONDS" "$*"; }
picture() { import -window root "$out/$1.png"; }
die() { say "FAILED: $*"; picture failed 2>/dev/null; exit 1; }
# Waits until a command succeeds: within SECONDS, WHAT, COMMAND...
await() {
    local until=$((SECONDS + $1)) what=$2
    shift 2
    while ! "$@"; do
        [ $SECONDS -lt $until ] || die "no $what"
        kill -0 $program 2>/dev/null || die "the program has ended before: $what"
        sleep 0.2
    done
    say "ok: $what"
}
# Lines that match PATTERN in the recording, or in FILE.
count() { grep -cE -- "$1" "${2:-$journal}"; }
# Whether N or more match in the log, or in FILE.
said() { [ "$(count "$2" "${3:-$log}")" -ge "$1" ]; }
# Whether N or more match in the recording.
wrote() { [ "$(count "$2")" -ge "$1" ]; }
pictures() { count 'picture shown' $log; }
# The program draws nothing for two seconds.
rests() {
    local before=$(pictures)
    sleep 2
    [ "$(pictures)" = "$before" ]
}
