#!/usr/bin/env bash
# What `plan` says against what `build` takes: tests/bench/plan.sh BIN-FOLDER DATA-FOLDER
# [WORKERS]. The demo's organ (linear) and a small organ of neo-Hookean gel. Ratios are
# estimate over measurement; the times should lie within 0.5 to 2.
set -euo pipefail
bin=$(realpath "$1")
data=$(realpath "$2")
workers=${3:-0}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

cp "$data/organ.toml" "$data/organ.obj" "$work"
mkdir "$work/small"
"$bin/palpate-precompute" body organ --levels 2 -o "$work/small/organ.obj" > /dev/null
cat > "$work/small/organ.toml" <<SCENE
[body]
mesh = "organ.obj"
length_unit = "m"
[[material]]
region = "body"
law = "neo-hookean"
youngs_modulus_pa = 6000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.002]]
kind = "fixed"
[[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.02
[reach]
box_m = [[-1.0, -1.0, 0.010], [1.0, 1.0, 1.0]]
depth_max_m = 0.006
[accuracy]
force_relative = 0.05
SCENE

# The number under a key of a one-line JSON report.
number() { tr ',{' '\n\n' < "$1" | awk -F: -v key="\"$2\"" '$1 == key { value = $2 } END { print value + 0 }'; }

missed=0
for scene in "$work/organ.toml" "$work/small/organ.toml"; do
  name=$([[ $scene == */small/* ]] && echo "small organ, neo-Hookean" || echo "organ, linear")
  "$bin/palpate-precompute" plan "$scene" --workers "$workers" --json \
    > "$work/plan.json" 2> /dev/null
  "$bin/palpate-precompute" build "$scene" --workers "$workers" -o "$work/out.h5" --json \
    > "$work/build.json" 2> "$work/err" || tail -n 1 "$work/err"
  awk -v name="$name" -v plan_s="$(number "$work/plan.json" plan_seconds)" \
      -v said_s="$(number "$work/plan.json" seconds)" \
      -v took_s="$(number "$work/build.json" seconds)" \
      -v said_b="$(number "$work/plan.json" peak_memory_bytes)" \
      -v took_b="$(number "$work/build.json" peak_memory_bytes)" '
    BEGIN {
      time = said_s / took_s
      printf "%-25s  time %.1f s said, %.1f s taken: ratio %.2f%s; memory %.0f MB said, " \
             "%.0f MB taken: ratio %.2f; planning took %.1f s\n", name, said_s, took_s, time,
             (time >= 0.5 && time <= 2 ? "" : " (MISSED)"), said_b / 1e6, took_b / 1e6,
             said_b / took_b, plan_s
      exit !(time >= 0.5 && time <= 2) }' || missed=1
done
exit $missed
