# Reads the output of `cargo test --no-fail-fast` and prints what failed, a line each:
#   TARGET<tab>TEST      a test of a binary that ended as it should; TARGET is cargo's option for it (--lib, --test NAME)
#   TARGET<tab>          a binary of which it is not known what failed: it crashed, or is no binary of tests
# With -v target=TARGET -v test=TEST it prints that test's failure instead.
# Nothing is printed for output in which no binary failed, as after a build that failed.

# The last list of failures is the harness's own: a failed test may print those of a process that it started.
/^failures:$/ { count = 0; listing = 1; last_list = lines + 1 }
listing && /^    ./ { names[++count] = substr($0, 5) }
/^test result: / { listing = 0; concluded = 1 }
/^error: (test|doctest) failed, to rerun pass / { conclude() }
/^ +(Running|Doc-tests) / { begin() }
{ text[++lines] = $0 }

function begin() { count = 0; listing = 0; concluded = 0; lines = 0; last_list = 0 }

function conclude(   option, i) {
    option = $0
    sub(/^[^`]*`/, "", option)
    sub(/`.*$/, "", option)
    # A package alone would be built with other features.
    sub(/^-p [^ ]+ */, "", option)
    if (!concluded || count == 0) names[count = 1] = ""
    for (i = 1; i <= count; i++) {
        if (test == "") print option "\t" names[i]
        else if (option == target && names[i] == test) print_failure(count)
    }
    begin()
}

function print_failure(count,   i, name, is_shown) {
    for (i = 1; i < last_list; i++) {
        name = header(text[i])
        if (name == test) is_shown = 1
        else if (is_shown && name != "" && is_listed(name, count)) return
        if (is_shown) print text[i]
    }
}

# The test of which this line is the header: `---- NAME ----`, or `---- NAME stdout ----`.
function header(line) {
    if (line !~ /^---- .* ----$/) return ""
    line = substr(line, 6, length(line) - 10)
    sub(/ stdout$/, "", line)
    return line
}

function is_listed(name, count,   i) {
    for (i = 1; i <= count; i++) if (names[i] == name) return 1
    return 0
}
