//! What tables of [`fsot`] are compared with: a minimal renderer with known answers, the samplers of the
//! literature, the published loop, and what the programs `lecture`, `ablation`, `race` and `compare` share.

pub mod draw;
pub mod figures;
pub mod judge;
pub mod names;
pub mod program;
pub mod published;
mod random;
pub mod render;
pub mod samplers;
mod simd;
