#!/usr/bin/env bash
# The demo: a response database for the organ in this folder, then ten seconds of rendering
# on a simulated device. demo.sh BIN-FOLDER [OUTPUT-FOLDER]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$1
out=${2:-$(dirname "$bin")/demo}
mkdir -p "$out"

echo "== 1. responses of an organ, pressed at every node =="
"$bin/palpate-precompute" build "$here/organ.toml" -o "$out/organ.h5"
echo
echo "== 2. what the database holds =="
"$bin/palpate-db" info "$out/organ.h5"
"$bin/palpate-db" picture "$out/organ.h5" -o "$out/organ.svg"
echo
echo "== 3. ten seconds on a simulated device, slow process 100 Hz, fast process 2 kHz =="
"$bin/palpate-run" simulate "$out/organ.h5" --model element --seconds 10
echo
echo "Look at $out/organ.svg. Another model, and the two processes on real threads:"
echo "  $bin/palpate-run simulate $out/organ.h5 --model energy-tank --seconds 10"
echo "  $bin/palpate-run simulate $out/organ.h5 --clock real --seconds 10"
