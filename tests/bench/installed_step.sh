#!/bin/bash
# installed_step.sh BUILD DATABASE: what a step costs through the installed C interface,
# and inside palpate-run, along the same recorded trajectory: times, and instructions by
# callgrind (valgrind).
set -euo pipefail
here=$(realpath "$(dirname "$0")") build=$(realpath "$1") database=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

cmake --install "$build" --prefix "$folder/prefix" > log
library=$(dirname "$(find prefix -name libpalpate.so)")
export PKG_CONFIG_PATH=$library/pkgconfig
# shellcheck disable=SC2046
cc -std=c99 -O2 "$here/installed_step.c" -o installed_step \
  $(pkg-config --cflags --libs palpate) -Wl,-rpath,"$(realpath "$library")"

run=prefix/bin/palpate-run
$run simulate "$database" --model potential --seconds 4 --limit-stiffness \
  --record run.ticks > simulate.log
/usr/bin/python3 - <<'PY'
import h5py, numpy
with h5py.File('run.ticks') as file:
    positions = file['tick/position_m'][:]
numpy.ascontiguousarray(positions, dtype='<f8').tofile('positions')
PY
read -r ticks contacts median late < <(./installed_step "$database" positions)
echo "installed library  $ticks ticks, $contacts in contact: median $median ns, p99 $late ns of palpate_force()"
echo "palpate-run        $(grep '^step time' simulate.log)"

instructions() {  # FUNCTION COMMAND...: all that it and what it calls executed
  valgrind --tool=callgrind --callgrind-out-file=out --collect-atstart=no \
    --toggle-collect="$1" "${@:2}" > valgrind.log 2>&1 || { cat valgrind.log; return 1; }
  grep -oP '^(totals|summary): \K[0-9]+' out | head -1
}
force=$(instructions palpate_force ./installed_step "$database" positions)
inside=$(instructions 'palpate::step(*' ./installed_step "$database" positions)
step=$(instructions 'palpate::step(*' $run replay run.ticks "$database")
echo "instructions a tick: the step $((inside / ticks)) in the library, $((step / ticks)) in" \
  "palpate-run; palpate_force() with taking in elements and telling its state $((force / ticks))"
