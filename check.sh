#!/usr/bin/env bash
# Checks the house rules that need no test run: formatting, lints, in how many files the methods of a type stand, names of
# public types, places of `unsafe`, the generated reference of the brushes, and the dependencies (cargo-deny).
# Usage: check.sh [--no-lints]   (--no-lints leaves out clippy and the reference, which compile the workspace)
set -euo pipefail
cd "$(dirname "$0")"
PATH="$PATH:$HOME/.cargo/bin"
max_files=3
failed=()

lints=true
case "${1:-}" in
"") ;;
--no-lints) lints= ;;
*) sed -n '2,4p' "$0" >&2; exit 2 ;;
esac

cargo fmt --all --check || failed+=(formatting)

# Counts the files beside the one that defines the type, which is known by its room (the folder or file below src) and its
# name.
scattered=$(git ls-files 'src/*.rs' 'core/src/*.rs' 'tracking/src/*.rs' | xargs awk -v max=$max_files '
    FNR == 1 { room = FILENAME; sub(/^.*src\//, "", room); sub(/[\/.].*$/, "", room); tests = 0 }
    /^#\[cfg\(test\)\]/ { tests = 1 }
    !tests && match($0, /^impl(<[^>]*>)? [A-Z][A-Za-z0-9]*(<[^>]*>)? \{/) {
        name = substr($0, RSTART, RLENGTH); sub(/^impl(<[^>]*>)? /, "", name); sub(/[<{ ].*$/, "", name)
        type = room " " name
        if (!here[name, FILENAME] && !seen[type, FILENAME]++) { count[type]++; files[type] = files[type] "\n    " FILENAME }
    }
    match($0, /^(pub(\([a-z]+\))? )?(struct|enum|union) [A-Za-z0-9]+/) {
        name = substr($0, RSTART, RLENGTH); sub(/^.* /, "", name); here[name, FILENAME] = 1
    }
    END { for (type in count) if (count[type] >= max) print "  " type ":" files[type] }')
[ -z "$scattered" ] || {
    printf 'check: methods of a type in more than %d files; these and its own:\n%s\n' "$max_files" "$scattered" >&2
    failed+=(scattered)
}

# `Result` is the alias of each room that has an error of its own.
twice=$(git ls-files 'src/*.rs' 'core/src/*.rs' 'tracking/src/*.rs' | grep -vE '(^|[/_])tests?(\.rs|/)|test_' | xargs awk '
    FNR == 1 { crate = FILENAME; sub(/src\/.*$/, "", crate); tests = 0 }
    /^#\[cfg\(test\)\]/ { tests = 1 }
    !tests && match($0, /^pub(\([a-z ]+\))? (struct|enum|union|trait|type) [A-Z][A-Za-z0-9]*/) {
        name = substr($0, RSTART, RLENGTH); sub(/^.* /, "", name)
        if (name != "Result") { count[crate name]++; files[crate name] = files[crate name] "\n    " FILENAME }
    }
    END { for (type in count) if (count[type] > 1) print "  " type ":" files[type] }')
[ -z "$twice" ] || {
    printf 'check: public types of a crate that share a name:\n%s\n' "$twice" >&2
    failed+=(names)
}

stray=$(git ls-files 'src/*.rs' 'core/src/*.rs' 'tracking/src/*.rs' | grep -vE '^src/(gpu|screen)/' |
    xargs grep -nE '\bunsafe (\{|fn|impl|extern|trait)' || true)
[ -z "$stray" ] || { printf 'check: unsafe outside src/gpu and src/screen:\n%s\n' "$stray" >&2; failed+=(unsafe); }

if [ -n "$lints" ]; then
    # With the features of the whole workspace, as the tests build it.
    cargo build --quiet --workspace --locked --bin virtual-sculpture &&
        "${CARGO_TARGET_DIR:-target}/debug/virtual-sculpture" commands --markdown |
        cmp --quiet - docs/tools.md || {
        echo "check: docs/tools.md is stale; make it anew: virtual-sculpture commands --markdown > docs/tools.md" >&2
        failed+=(reference)
    }
fi

if cargo deny --version >/dev/null 2>&1; then
    cargo deny --locked check licenses bans sources || failed+=(dependencies)
    # The list of advisories is fetched from the network.
    if cargo deny --locked fetch db >/dev/null 2>&1; then
        cargo deny --locked --offline check advisories || failed+=(advisories)
    else
        echo "check: NOT RUN: advisories; the advisory database could not be fetched" >&2
    fi
else
    echo "check: NOT RUN: licences, duplicates, sources, advisories; install cargo-deny" >&2
fi

if [ -n "$lints" ]; then
    cargo clippy --workspace --all-targets --locked -- -D warnings || failed+=(lints)
fi

[ ${#failed[@]} -eq 0 ] || { echo "check: FAILED: ${failed[*]}" >&2; exit 1; }
