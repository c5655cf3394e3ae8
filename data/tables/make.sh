#!/usr/bin/env bash
# Makes the released tables again, bit for bit on the same platform: about two minutes on two cores.
# Then `cargo test --release --test released -- --nocapture` prints their figures for data/README.md.
set -euo pipefail
cd "$(dirname "$0")/../.."

make() {
    cargo run --release --quiet -p fsot-cli -- table --out "data/tables/$1.npy" "${@:2}"
}

make 64x64x1_1spp_2d --frames 1 --sweeps 8000
make 64x64x1_4spp_2d --frames 1 --spp 4 --sweeps 2000
make 128x128x1_1spp_2d --frames 1 --width 128 --height 128 --sweeps 4000
make 64x64x1_1spp_4d --frames 1 --dims 4 --sweeps 3000
make 64x64x1_1spp_1d --frames 1 --dims 1 --sweeps 20000
make 64x64x16_1spp_2d_ema --frames 16 --temporal ema:0.1 --frame-sweeps 2000 --sweeps 300
make 64x64x16_4spp_2d_ema --frames 16 --spp 4 --temporal ema:0.1 --frame-sweeps 800 --sweeps 20
make 64x64x64_1spp_1d_ema --frames 64 --dims 1 --temporal ema:0.1 --frame-sweeps 10000 --sweeps 100
make 128x128x64_1spp_1d_ema --frames 64 --width 128 --height 128 --dims 1 --temporal ema:0.1 \
    --frame-sweeps 4000 --sweeps 40
make 128x128x64_1spp_2d_perceptual60 --frames 64 --width 128 --height 128 --frame-sweeps 2000 --sweeps 60
