//! Temporal kernels as they are written on a command line.

use fsot::kernel::TemporalKernel;

/// `none`, `gaussian:SIGMA`, `ema:ALPHA`, `box:N`, `binomial:N`, `perceptual:FPS` or `taps:a,b,…`.
pub fn parse(text: &str) -> Result<TemporalKernel, String> {
    let (name, value) = text.split_once(':').unwrap_or((text, ""));
    let number = || value.parse::<f64>().map_err(|_| format!("'{value}' is no number: write {name}:NUMBER"));
    let count = || value.parse::<usize>().map_err(|_| format!("'{value}' is no count: write {name}:FRAMES"));
    match name {
        "none" if value.is_empty() => Ok(TemporalKernel::None),
        "gaussian" => Ok(TemporalKernel::Gaussian { sigma_frames: number()? }),
        "ema" => Ok(TemporalKernel::Ema { alpha: number()? }),
        "box" => Ok(TemporalKernel::Box { frames: count()? }),
        "binomial" => Ok(TemporalKernel::Binomial { frames: count()? }),
        "perceptual" => Ok(TemporalKernel::Perceptual { fps: number()? }),
        "taps" => {
            let taps = value.split(',').map(|tap| tap.trim().parse::<f64>());
            let taps: Result<Vec<f64>, _> = taps.collect();
            taps.map(TemporalKernel::Taps)
                .map_err(|_| format!("'{value}' is no list of numbers: write taps:0.5,0.3,0.2"))
        }
        _ => Err(format!(
            "'{text}' is no temporal kernel: write none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, \
             perceptual:FPS or taps:a,b,…"
        )),
    }
}

/// The kernel that was asked for, or else the eye's at 60 frames per second where there are frames.
pub fn or_default(given: Option<&TemporalKernel>, frames: usize) -> TemporalKernel {
    match given {
        Some(temporal) => temporal.clone(),
        None if frames > 1 => TemporalKernel::Perceptual { fps: 60.0 },
        None => TemporalKernel::None,
    }
}
