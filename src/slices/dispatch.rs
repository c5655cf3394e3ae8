//! Every instruction set gives the same bits.

use pulp::Simd;

use super::*;
use crate::config::{Config, Slicing};
use crate::random;
use crate::table::domain::Domain;
use crate::table::extent::Extent;

/// Samples, moves and squares of all slices of a step.
fn transported<S: Simd>(
    simd: S,
    objective: &Objective,
    points: &[f32],
    pick: Picked,
) -> (Vec<u32>, Vec<u32>, u64) {
    let (mut orders, mut draws) = (Vec::new(), Vec::new());
    let (mut chunk, mut scratch) = (Chunk::default(), Scratch::default());
    objective.draw_subsets(1, 2, pick, &mut orders, &mut draws);
    simd.vectorize(Transport {
        objective,
        seed: 1,
        step: 2,
        points,
        draws: draws.iter(),
        chunk: &mut chunk,
        scratch: &mut scratch,
    });
    let moves = chunk.moves.iter().map(|moved| moved.to_bits()).collect();
    (chunk.samples, moves, chunk.squares.to_bits())
}

#[test]
fn instruction_sets_agree() {
    for (spp, dims) in [(1, 1), (1, 2), (4, 2), (1, 3), (2, 4), (1, 6)] {
        let extent = Extent { frames: 2, height: 17, width: 13, spp };
        for (directions, axis_share, domain) in
            [(16, 0.0, Domain::Interval), (16, 0.3, Domain::Torus), (7, 0.0, Domain::Interval)]
        {
            let slicing = Slicing { directions, axis_share, batch_slices: Some(2000) };
            let config = Config::new(extent, dims).with_domain(domain).with_slicing(slicing);
            let objective = Objective::new(&config).unwrap();
            let points = random::uniforms(3, extent.samples() * dims);
            for pick in
                [Picked::Batch(Role::Descend), Picked::Batch(Role::Balance), Picked::Each(Role::Balance)]
            {
                let baseline = transported(pulp::Scalar, &objective, &points, pick);
                // A step may be none of the whole table's turns, and sweeps balance an interval without.
                assert!(pick.role() == Role::Balance || !baseline.1.is_empty());
                #[cfg(target_arch = "x86_64")]
                {
                    let avx2 = pulp::x86::V3::try_new();
                    let avx512 = pulp::x86::V4::try_new();
                    let case = format!("{spp} samples, {dims} dimensions, {directions} directions, {pick:?}");
                    if let Some(simd) = avx2 {
                        assert!(transported(simd, &objective, &points, pick) == baseline, "AVX2, {case}");
                    }
                    if let Some(simd) = avx512 {
                        assert!(transported(simd, &objective, &points, pick) == baseline, "AVX-512, {case}");
                    }
                }
            }
        }
    }
}
