#!/usr/bin/env bash
# CalculiX beside ours, one node: tests/bench/calculix.sh BIN-FOLDER [TETS...]  (default: 5000)
# A cylinder of neo-Hookean gel (20 mm by 20 mm, E 5 kPa, nu 0.45) held at its bottom, a
# rigid ball of 5 mm pressed 5 mm into the middle of its top in 10 increments, on one
# thread. 5000 quadratic tets take minutes, 20000 the better part of an hour. Ours: every
# free node of that body, a twentieth off in force at most, on one thread as well; and the
# middle one alone, to several budgets.
set -euo pipefail
bin=$(realpath "$1")
shift
for program in ccx /usr/bin/time; do
  if ! command -v "$program" > /dev/null; then
    echo "skipped: $program is not installed (Debian: calculix-ccx, time)"
    exit 0
  fi
done
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

# Upward force on the ball and downward force on the support at each increment, from the
# totals of reaction forces [mm, N]; sideways: on the ball, zero for a perfect mesh.
forces() {
  awk 'BEGIN { depth = 5.0; printf "%10s %14s %14s %14s\n", "depth [mm]", "ball [N]",
                                   "support [N]", "sideways [N]" }
       /total force/ { set = $6; time = $NF; next }
       NF == 3 && set == "BALL" { ball = -$3; side = sqrt($1 * $1 + $2 * $2); set = "" }
       NF == 3 && set == "BOTTOM" {
         printf "%10.3f %14.6g %14.6g %14.2g\n", depth * time, ball, $3, side; set = "" }' "$1"
}

# The same body and load at every free node, on one thread; CPU seconds over nodes.
ours() {
  /usr/bin/time -f "%U %S %e %M" -o "$1.cost" "$bin/palpate-precompute" build "$1.toml" \
    -o "$1.h5" --threads 1 --json > "$1.json" 2> "$1.err" || tail -n 1 "$1.err"
  tr ',{' '\n\n' < "$1.json" | awk -F: -v cost="$(tail -n 1 "$1.cost")" -v out="$1.per_node" '
    { gsub(/"/, "", $1); value[$1] = $2 }
    END {
      split(cost, c, " ")
      nodes = value["solved"] + value["interpolated"]
      printf "ours: %.1f CPU s, %.1f s, peak memory %.0f MB: %d nodes (%d solved, %d " \
             "interpolated, %d failed), error estimate %.1f %% median, %.1f %% at the 95th " \
             "percentile\n", c[1] + c[2], c[3], c[4] / 1024, nodes, value["solved"],
             value["interpolated"], value["failed"], 100 * value["error_median"],
             100 * value["error_p95"]
      print (c[1] + c[2]) / nodes > out }'
}

# The middle node alone to a budget of force: its cost, mesh and forces, between depths by
# a power law.
one_node() {
  sed "s/^force_relative = .*/force_relative = $2/" "$1.toml" > "$1.$2.toml"
  /usr/bin/time -f "%U %S" -o "$1.cost" \
    "$bin/palpate-precompute" indent "$1.$2.toml" --at 0,0,0.02 2> /dev/null |
    awk -v budget="$2" '
      NR == 2 { tets = $1 }
      /^ +[0-9]+\.[0-9]+ / {
        for (x = 1.0; x <= 5.0; x += 1.0)
          if (last > 0 && force > 0 && last < x && x <= $1)
            at[x] = force * (x / last) ^ (log($2 / force) / log($1 / last))
        last = $1; force = $2 }
      END { printf "budget %-6s %6d tets, forces at 1, 2, 3, 4, 5 mm [N]: %.5f %.5f %.5f %.5f %.5f",
                   budget, tets, at[1], at[2], at[3], at[4], at[5] }'
  tail -n 1 "$1.cost" | awk '{ printf ", %.1f CPU s\n", $1 + $2 }'
}

for tets in "${@:-5000}"; do
  echo "== CalculiX, about $tets quadratic tets"
  "$bin/calculix_deck" "$tets" "$work/gel$tets.inp" "$work/gel$tets.obj"
  (cd "$work" && OMP_NUM_THREADS=1 CCX_NPROC_EQUATION_SOLVER=1 CCX_NPROC_RESULTS=1 \
    /usr/bin/time -f "%U %S %e %M" -o cost ccx -i "gel$tets" > "gel$tets.log" 2>&1) ||
    echo "CalculiX failed: $(grep -m 1 -i error "$work/gel$tets.log")"
  forces "$work/gel$tets.dat"
  echo "iterations: $(grep -c '^ iteration' "$work/gel$tets.log" || true)"
  tail -n 1 "$work/cost" | awk '{ printf "CalculiX: %.1f CPU s, %.1f s, peak memory %.0f MB\n",
                                         $1 + $2, $3, $4 / 1024 }'

  cat > "$work/gel$tets.toml" <<SCENE
[body]
mesh = "gel$tets.obj"
length_unit = "m"
[[material]]
region = "body"
law = "neo-hookean"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1e-9]]
kind = "fixed"
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.005
friction = 0.0
[reach]
depth_max_m = 0.005
[accuracy]
force_relative = 0.05
SCENE
  ours "$work/gel$tets"
  for budget in 0.05 0.03 0.02 0.01 0.005; do
    one_node "$work/gel$tets" "$budget"
  done
  awk 'NR == FNR { theirs = $1 + $2; next }
       { printf "ratio: one node costs %.0f times less (%.1f over %.3f CPU s)\n",
                theirs / $1, theirs, $1 }' <(tail -n 1 "$work/cost") "$work/gel$tets.per_node"
done
