#!/usr/bin/env bash
# Checks the grammar in a temporary copy: `check.sh [tree-sitter]`. Prints one line for each thing that holds.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tree_sitter=$(realpath "$(command -v "${1:-tree-sitter}")")
jobs=$here/../../jobs

temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
# The program looks for a grammar by the name of its folder, and keeps what it builds in the cache.
copy=$temporary/tree-sitter-impeller
export XDG_CONFIG_HOME=$temporary/config XDG_CACHE_HOME=$temporary/cache
mkdir -p "$copy" "$XDG_CONFIG_HOME/tree-sitter"
printf '{ "parser-directories": ["%s"] }\n' "$temporary" > "$XDG_CONFIG_HOME/tree-sitter/config.json"
cp -r "$here"/{grammar.js,package.json,tree-sitter.json,queries,test} "$copy"
cd "$copy"

fail() {
    printf 'tree-sitter: %s\n' "$*" >&2
    exit 1
}

# Programs before version 0.24 read package.json, later ones tree-sitter.json.
node -e '
    const [old] = require("./package.json")["tree-sitter"];
    const { name, ...now } = require("./tree-sitter.json").grammars[0];
    require("node:assert").deepStrictEqual(old, now);
'
"$tree_sitter" generate > log 2>&1 || { cat log; fail "no parser"; }
echo "tree-sitter: the parser is generated without a conflict"

"$tree_sitter" test > log 2>&1 || { cat log; fail "tests"; }
echo "tree-sitter: $(grep -c '✓' log) tests of trees and colours pass"

shopt -s nullglob
good=("$jobs"/[!_]*/*.imp)
[ ${#good[@]} -ge 20 ] || fail "only ${#good[@]} jobs"
"$tree_sitter" parse --quiet "${good[@]}" > log 2>&1 || { cat log; fail "jobs that do not parse"; }
echo "tree-sitter: all ${#good[@]} jobs parse without an error"

for bad in "$jobs"/_errors/{IMP0103,IMP0104,IMP0106,IMP0108}*.imp; do
    ! "$tree_sitter" parse --quiet "$bad" > log 2>&1 || fail "$bad parses"
done
echo "tree-sitter: faults of brackets, quotes and items are seen"

# Every name of every job has a colour: as many are captured as there are.
printf '(name) @name\n' > names.scm
for job in "${good[@]}"; do
    "$tree_sitter" query names.scm "$job" > names 2> log || { cat log; fail "names of $job"; }
    "$tree_sitter" query queries/highlights.scm "$job" > colours 2> log || { cat log; fail "colours of $job"; }
    # The places of the names are among those that have a colour, each once.
    place='start: \(([0-9]+, [0-9]+)\)'
    grep -oE "$place" names | sort > places
    grep -oE "$place" colours | sort > coloured
    [ -s places ] || fail "no names in $job"
    [ -z "$(uniq -d coloured)" ] || fail "two colours in $job at $(uniq -d coloured | head -n 1)"
    [ -z "$(comm -23 places coloured)" ] || fail "no colour in $job at $(comm -23 places coloured | head -n 1)"
done
echo "tree-sitter: every name of every job has one colour"
"$tree_sitter" highlight --html "${good[0]}" > page.html 2> log || { cat log; fail "highlight"; }
grep -q "<span style='[^']*'>operation</span>" page.html || fail "no colours by tree-sitter highlight"
echo "tree-sitter: tree-sitter highlight colours a job"
