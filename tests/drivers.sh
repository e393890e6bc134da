#!/usr/bin/env bash
# Runs the Vulkan tests on other drivers than the system's: tests/drivers.sh SHARED [PREFIX]
# SHARED is the folder with vulkan/drivers.sh and openxr/monado-prefix.sh, which unpack drivers and layers to
# PREFIX (default: target/drivers; kept between runs) without root. Runs the tests `gpu::` and `golden::`
# of the program, as built last, with a recent validation layer and synchronization validation, on
#   system       the driver that the system prefers
#   mesa25       lavapipe of Mesa 25
#   swiftshader  SwiftShader: 4 bits of sub-pixel precision, other limits
#   discrete     the system's lavapipe posing as a discrete GPU: compute shaders, staging, a small window of
#                mappable memory
# and first makes sure that synchronization validation is active: with barriers dropped it must complain.
# Fails if a test fails anywhere, or if fewer have passed or been ignored than there are.
# VS_DRIVERS="mesa25 discrete" runs these alone. Without SHARED nothing is run, which it says.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,13p' "$0" >&2; exit 2; }
cd "$(dirname "$0")/.."
if [ ! -x "$1/vulkan/drivers.sh" ] && [ ! -f "$1/vulkan/drivers.sh" ]; then
    echo "SKIPPED: the tests on other Vulkan drivers: $1/vulkan/drivers.sh is not there"
    exit 0
fi
shared=$(cd "$1" && pwd)
prefix=${2:-target/drivers}
mkdir -p "$prefix"
prefix=$(cd "$prefix" && pwd)
drivers=${VS_DRIVERS:-system mesa25 swiftshader discrete}
export VS_REQUIRE_VALIDATION=1 VS_SHARED="$shared"

# Unpacks again if that was not completed, or if the folder has moved: the contents hold absolute paths.
unpack() {
    local name=$1 script=$2
    [ "$(cat "$prefix/$name.done" 2>/dev/null)" = "$prefix/$name" ] && return
    rm -rf "${prefix:?}/$name"
    bash "$shared/$script" "$prefix/$name" >"$prefix/$name.log" 2>&1 || {
        echo "drivers: $script failed:" >&2
        tail -n 20 "$prefix/$name.log" >&2
        return 1
    }
    echo "$prefix/$name" >"$prefix/$name.done"
}
unpack vulkan vulkan/drivers.sh
case " $drivers " in *" mesa25 "*) unpack openxr openxr/monado-prefix.sh ;; esac
vulkan=$prefix/vulkan
openxr=$prefix/openxr

# The most recently built test binary of that name.
binary() {
    local found
    for found in $(ls -t "${CARGO_TARGET_DIR:-target}"/debug/deps/"$1"-* 2>/dev/null); do
        case $found in *.*) ;; *) [ -x "$found" ] && { echo "$found"; return; } ;; esac
    done
    echo "drivers: the tests '$1' are not built: cargo test --workspace --no-run" >&2
    return 1
}

# Runs a command with a driver of that name.
with_driver() {
    local driver=$1
    shift
    (
        . "$vulkan/env-newlayer"
        case $driver in
        mesa25)
            local libraries=$openxr/usr/lib/x86_64-linux-gnu
            export VK_DRIVER_FILES=$openxr/lvp.json VK_ICD_FILENAMES=$openxr/lvp.json
            exec "$openxr/lib64/ld-linux-x86-64.so.2" \
                --library-path "$libraries:$openxr/usr/lib:$libraries/pulseaudio" "$@"
            ;;
        swiftshader) . "$vulkan/env-swiftshader" ;;
        discrete)
            . "$vulkan/env-discrete"
            # That layer handles one device at a time and needs another layer below it.
            export VK_INSTANCE_LAYERS=VK_LAYER_FAKE_discrete:VK_LAYER_KHRONOS_validation
            set -- "$@" --test-threads=1
            ;;
        esac
        exec "$@"
    )
}

failed=()
log=$prefix/log
program=$(binary program_tests)
for name in gpu golden; do
    if [ "$name" = gpu ]; then
        case " $drivers " in *" discrete "*)
            if FAKE_DROP=2 with_driver discrete "$program" gpu::device::a_depth_buffer_is_cleared >"$log" 2>&1 ||
                ! grep -q 'WRITE_AFTER_WRITE hazard' "$log"; then
                echo "drivers: synchronization validation does not notice a barrier that is missing" >&2
                failed+=(awake)
            fi
            ;;
        esac
    fi
    count=$("$program" --list "$name::" 2>/dev/null | grep -c ': test$')
    for driver in $drivers; do
        begun=$SECONDS
        with_driver "$driver" "$program" "$name::" >"$log" 2>&1 || true
        result=$(grep '^test result: ' "$log" || true)
        ended=$(sed -n 's/^test result: ok\. \([0-9]*\) passed; 0 failed; \([0-9]*\) ignored; .*/\1 + \2/p' <<<"$result")
        if [ $((${ended:-0})) -ne "$count" ] || [ "$count" -eq 0 ]; then
            failed+=("$driver/$name")
            cp "$log" "$prefix/$driver-$name.log"
            echo "--- $driver, $name: $prefix/$driver-$name.log ends with"
            tail -n 60 "$log"
        fi
        printf 'drivers: %-12s %-7s %s (%d s, %d tests)\n' \
            "$driver" "$name" "${result:-it broke off}" $((SECONDS - begun)) "$count"
    done
done
[ ${#failed[@]} -eq 0 ] || { echo "drivers: FAILED: ${failed[*]}" >&2; exit 1; }
