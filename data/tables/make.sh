#!/usr/bin/env bash
# Makes the released tables again, bit for bit on the same platform: about a minute on two cores.
# Then `cargo test --release --test released -- --nocapture` prints their figures for data/README.md.
set -euo pipefail
cd "$(dirname "$0")/../.."

make() {
    cargo run --release --quiet -p fsot-cli -- table --out "data/tables/$1.npy" "${@:2}"
}

make 64x64x1_1spp_2d --frames 1 --slices-per-class 6000 --sweeps 4000
make 64x64x1_4spp_2d --frames 1 --spp 4 --slices-per-class 4000 --sweeps 800
make 128x128x1_1spp_2d --frames 1 --width 128 --height 128 --slices-per-class 4000 --sweeps 3000
make 128x128x1_4spp_2d --frames 1 --width 128 --height 128 --spp 4 --slices-per-class 1500 --sweeps 100
make 64x64x1_1spp_4d --frames 1 --dims 4 --slices-per-class 4000 --sweeps 1500
make 64x64x16_1spp_2d_perceptual60 --frames 16 --temporal perceptual:60 --slices-per-class 1000 --sweeps 600
make 64x64x16_1spp_2d_ema --frames 16 --temporal ema:0.1 --slices-per-class 150 --sweeps 150
