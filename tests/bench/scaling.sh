#!/usr/bin/env bash
# How a linear build of all nodes grows: tests/bench/scaling.sh BIN-FOLDER DATA-FOLDER
# [OUTPUT-FOLDER]. The demo's organ, remeshed to four sizes of edge; one mesh for all nodes,
# as fine as the surface itself. Writes scaling.csv and scaling.svg, prints exponents.
set -euo pipefail
bin=$(realpath "$1")
data=$(realpath "$2")
out=$(realpath "${3:-.}")
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

number() { tr ',{' '\n\n' < "$1" | awk -F: -v key="\"$2\"" '$1 == key { value = $2 } END { print value + 0 }'; }

echo "nodes,tets,cpu_seconds,peak_memory_bytes" > "$out/scaling.csv"
printf "%8s %8s %10s %12s %12s\n" nodes tets "CPU [s]" "ms per node" "memory [MB]"
for edge_m in 0.0085 0.006 0.0043 0.003; do
  "$bin/palpate-precompute" remesh "$data/organ.obj" --length-unit m --edge-m $edge_m \
    -o "$work/organ.obj" > /dev/null
  # A contact that the coarsest surface resolves: none is subdivided.
  sed -e 's/^contact_resolution.*/contact_resolution = 0.5\nrefine = "global"\nverify = 0/' \
    -e '/^force_relative/s/=.*/= 0.5/' "$data/organ.toml" > "$work/organ.toml"
  /usr/bin/time -f "%U %S" -o "$work/cpu" "$bin/palpate-precompute" build \
    "$work/organ.toml" -o "$work/organ.h5" --json > "$work/build.json" 2> "$work/err" ||
    tail -n 1 "$work/err"
  nodes=$(number "$work/build.json" solved)
  tets=$(number "$work/build.json" tets)
  bytes=$(number "$work/build.json" peak_memory_bytes)
  cpu=$(tail -n 1 "$work/cpu" | awk '{ print $1 + $2 }')
  echo "$nodes,$tets,$cpu,$bytes" >> "$out/scaling.csv"
  awk -v n="$nodes" -v t="$tets" -v c="$cpu" -v b="$bytes" \
    'BEGIN { printf "%8d %8d %10.1f %12.1f %12.0f\n", n, t, c, 1000 * c / n, b / 1e6 }'
done
"$bin/scaling_study" "$out/scaling.csv" "$out/scaling.svg"
