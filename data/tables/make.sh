#!/usr/bin/env bash
# Makes the released tables again, bit for bit on the same platform: about two minutes on two cores.
# Then `cargo test --release --test released -- --nocapture` prints their figures for data/README.md.
set -euo pipefail
cd "$(dirname "$0")/../.."

make() {
    cargo run --release --quiet --example spatiotemporal_table -- --out "data/tables/$1.npy" "${@:2}"
}

make 64x64x1_1spp_2d --frames 1 --slices-per-class 6000 --sweeps 3000
make 64x64x1_4spp_2d --frames 1 --spp 4 --slices-per-class 1500 --sweeps 300
make 128x128x1_1spp_2d --frames 1 --width 128 --height 128 --slices-per-class 2000 --sweeps 1000
make 128x128x1_4spp_2d --frames 1 --width 128 --height 128 --spp 4 --slices-per-class 600 --sweeps 120
make 64x64x1_1spp_4d --frames 1 --dims 4 --slices-per-class 4000 --sweeps 500
make 64x64x16_1spp_2d_perceptual60 --frames 16 --temporal perceptual:60 --slices-per-class 300 --sweeps 150
make 64x64x16_1spp_2d_ema --frames 16 --temporal ema:0.1 --slices-per-class 60 --sweeps 60
