#!/usr/bin/env bash
# The README's figures for a real organ: tests/bench/liver.sh BIN-FOLDER TEST-DATA-FOLDER.
# A liver of human size, held at its back, a ball of 8 mm pressed 5 mm at every free vertex.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
cat > "$work/liver.toml" <<SCENE
[body]
mesh = "$(realpath "$2")/meshes/sofa_liver2.obj"
length_unit = "dm"
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.46]]
kind = "fixed"
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.008
friction = 0.3
presliding_m = 0.0005
[reach]
depth_max_m = 0.005
force_max_n = 8.0
[accuracy]
force_relative = 0.05
SCENE
"$1/palpate-precompute" build "$work/liver.toml" -o "$work/liver.h5"
"$1/palpate-run" simulate "$work/liver.h5" --seconds 10
