#!/usr/bin/env bash
# The demo: an organ that can be pressed in a page within seconds, while its responses are
# computed; then ten seconds of rendering on a simulated device. demo.sh BIN-FOLDER [OUTPUT-FOLDER]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$1
out=${2:-$(dirname "$bin")/demo}
mkdir -p "$out"
rm -rf "$out/organ.h5" "$out/organ.h5.partial" "$out/view.log"

echo "== 1. responses of an organ, to be pressed at once: open this address =="
"$bin/palpate-run" view "$here/organ.toml" -o "$out/organ.h5" 2>"$out/view.log" &
view=$!
trap 'kill -INT $view 2>/dev/null || true' EXIT
while [ ! -f "$out/organ.h5" ]; do
  kill -0 $view 2>/dev/null || { cat "$out/view.log" >&2; exit 4; }
  sleep 0.2
done
echo
echo "== 2. all is computed; what the database holds =="
"$bin/palpate-db" info "$out/organ.h5"
"$bin/palpate-db" picture "$out/organ.h5" -o "$out/organ.svg"
echo
echo "== 3. ten seconds on a simulated device, slow process 100 Hz, fast process 2 kHz =="
"$bin/palpate-run" simulate "$out/organ.h5" --model element --seconds 10
echo
if [ -f "$bin/../share/palpate/palpate.wasm" ]; then  # by ./bootstrap page
  "$bin/palpate-db" export "$out/organ.h5" --page "$out/organ.html"
fi
echo "Look at $out/organ.svg. Another model, and the two processes on real threads:"
echo "  $bin/palpate-run simulate $out/organ.h5 --model energy-tank --seconds 10"
echo "  $bin/palpate-run simulate $out/organ.h5 --clock real --seconds 10"
if [ -t 0 ] && [ -t 1 ]; then
  echo "The page stays until Ctrl-C."
  wait $view
fi
