#!/usr/bin/env bash
# Fuzzes one target, or all: run.sh [TARGET [SECONDS]].
set -euo pipefail
cd "$(dirname "$0")/.."
targets=${1:-obj ply stl off gltf container history sequence log camera}
seconds=${2:-900}
cargo run --quiet -p mt-tests --example seeds -- fuzz/seeds
for target in $targets; do
    mkdir -p "fuzz/corpus/$target"
    seeds=("fuzz/seeds/$target")
    if [ -n "${MT_DATA:-}" ] && [ -d "$MT_DATA/bad" ]; then seeds+=("$MT_DATA/bad"); fi
    words=()
    if [ -f "fuzz/dict/$target.dict" ]; then words=("-dict=fuzz/dict/$target.dict"); fi
    cargo +nightly fuzz run "$target" "fuzz/corpus/$target" "${seeds[@]}" -- "${words[@]}" \
        -max_total_time="$seconds" -runs=10000000 -rss_limit_mb=2048 -malloc_limit_mb=1024 -timeout=20 -max_len=65536 \
        -print_final_stats=1
done
