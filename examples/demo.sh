#!/bin/sh
# From taint list to patch on the shuttle: every command is printed before it runs.
# BIN: directory with the commands of TARL, if they are not on PATH
set -eu
cd "$(dirname "$0")/shuttle"
[ -z "${BIN:-}" ] || PATH="$BIN:$PATH"
rm -rf .tarl
# The demo does not need these plugins of the development environment, and they would print additional lines
export PYTEST_ADDOPTS="-p no:asyncio -p no:randomly -p no:rerunfailures"

# run EXPECTED COMMAND...: print and run a command; stop the demo if its exit code is not the expected one
run() {
    expected=$1
    shift
    printf '\n$ %s\n' "$*"
    code=0
    "$@" || code=$?
    if [ "$code" -ne "$expected" ]; then
        echo "demo: expected exit code $expected, got $code" >&2
        exit 1
    fi
}

test=test_shuttle.py::test_delivers
run 1 tarl-lint traveller.py                                       # 1: there is a flow, and no baseline yet
run 0 python -m pytest -q "$test"                                  # without flags, it is an ordinary test
run 0 python -m pytest -q "$test" --tarl-record
run 1 python -m pytest -q "$test" --tarl-online                    # 1: the mud makes it fail
run 1 python -m pytest -q "$test" --tarl-online --tarl-repair --tarl-search sweep --tarl-search epsilon-greedy

patch=$(ls .tarl/patches/*.patch)
report=$(ls .tarl/report/*.html)
printf '\n$ cat %s\n' "$patch"
cat "$patch"
printf '\nreport page: examples/shuttle/%s\n' "$report"
printf 'git apply examples/shuttle/%s\n' "$patch"
