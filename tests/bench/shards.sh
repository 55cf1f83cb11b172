#!/usr/bin/env bash
# Nodes per second of a build by workers and by shards, two shards at a time, each with
# one worker: tests/bench/shards.sh BIN-FOLDER SCENE.toml [SHARDS ...]. The longest shard
# fits serial + parallel / shards by least squares; from that, and from the merge's time
# per shard, follows what 64 nodes of one core each would take.
set -euo pipefail
bin=$(realpath "$1") scene=$(realpath "$2")
shift 2
counts=("${@:-1}")
[ $# -gt 0 ] || counts=(1 2 4 8)
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

value() { tr ',{' '\n\n' < "$1" | awk -F: -v key="\"$2\"" '$1 == key { print $2 + 0 }'; }
now() { date +%s.%N; }

printf "%-12s %9s %10s %12s %10s\n" "" "wall [s]" "nodes/s" "longest [s]" "merge [s]"
row() {  # NAME WALL NODES LONGEST MERGE
  awk -v name="$1" -v wall="$2" -v nodes="$3" -v longest="$4" -v merge="$5" \
    'BEGIN { printf "%-12s %9.1f %10.2f %12.1f %10.2f\n", name, wall, nodes / wall, longest, merge }'
}

for workers in 1 2; do
  begin=$(now)
  "$bin/palpate-precompute" build "$scene" -o "$work/w$workers.h5" --threads $workers --json \
    > "$work/json" 2> "$work/err" || { cat "$work/err"; exit 1; }
  wall=$(awk -v a="$begin" -v b="$(now)" 'BEGIN { print b - a }')
  nodes=$(value "$work/json" nodes)
  row "workers: $workers" "$wall" "$nodes" "$(value "$work/json" seconds)" 0
done
cmp "$work/w1.h5" "$work/w2.h5"

for count in "${counts[@]}"; do
  rm -f "$work"/shard-*
  begin=$(now)
  seq 0 $((count - 1)) | xargs -P 2 -I {} sh -c \
    "'$bin/palpate-precompute' build '$scene' -o '$work/shard-{}.h5' --threads 1 \
      --shard {}/$count --json > '$work/shard-{}.json' 2> '$work/shard-{}.err'"
  solved=$(now)
  if [ "$count" = 1 ]; then
    cp "$work/shard-0.h5" "$work/whole.h5"
  else
    "$bin/palpate-db" merge "$work"/shard-*.h5 -o "$work/whole.h5" > /dev/null
  fi
  end=$(now)
  cmp "$work/w1.h5" "$work/whole.h5"
  longest=$(for i in "$work"/shard-*.json; do value "$i" seconds; done | sort -g | tail -n 1)
  merge=$(awk -v a="$solved" -v b="$end" 'BEGIN { print b - a }')
  row "shards: $count" "$(awk -v a="$begin" -v b="$end" 'BEGIN { print b - a }')" "$nodes" \
    "$longest" "$merge"
  echo "$count $longest $merge" >> "$work/fit"
done

awk '{ x = 1 / $1; n += 1; sx += x; sy += $2; sxx += x * x; sxy += x * $2; merge = $3 / $1 }
  END {
    if (n < 2) exit
    parallel = (n * sxy - sx * sy) / (n * sxx - sx * sx)
    serial = (sy - parallel * sx) / n
    t = serial + parallel / 64 + 64 * merge
    printf "longest shard = %.2f s + %.1f s / shards; serial share %.1f %%\n", serial, parallel,
      100 * serial / (serial + parallel)
    printf "64 nodes of one core, on paper: %.1f s, %.1f times as fast as one\n", t,
      (serial + parallel) / t
  }' "$work/fit"
