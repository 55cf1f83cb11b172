#!/usr/bin/env bash
# The README's figures for a real organ:
# tests/bench/liver.sh BIN-FOLDER TEST-DATA-FOLDER [linear|neo-hookean] [BUILD-OPTION...].
# A liver of human size, held at its back. Linear: a ball of 8 mm with friction, pressed
# 5 mm at every free vertex, then rendered for 10 s. Neo-Hookean, Poisson's ratio 0.49: a
# ball of 5 mm, pressed 5 mm.
set -euo pipefail
law=${3:-linear}
case $law in
  linear) poisson=0.45 radius=0.008 friction='friction = 0.3
presliding_m = 0.0005' ;;
  neo-hookean) poisson=0.49 radius=0.005 friction='' ;;
  *)
    echo "liver.sh: no law \"$law\", there are: linear, neo-hookean" >&2
    exit 2
    ;;
esac
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
cat > "$work/liver.toml" <<SCENE
[body]
mesh = "$(realpath "$2")/meshes/sofa_liver2.obj"
length_unit = "dm"
[[material]]
region = "body"
law = "$law"
youngs_modulus_pa = 5000.0
poissons_ratio = $poisson
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.46]]
kind = "fixed"
[[tool]]
name = "ball"
shape = "sphere"
radius_m = $radius
$friction
[reach]
depth_max_m = 0.005
force_max_n = 8.0
[accuracy]
force_relative = 0.05
SCENE
"$1/palpate-precompute" build "$work/liver.toml" -o "$work/liver.h5" "${@:4}"
if [[ $law == linear ]]; then
  "$1/palpate-run" simulate "$work/liver.h5" --seconds 10
fi
