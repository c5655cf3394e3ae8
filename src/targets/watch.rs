//! How far planning is.

use std::ops::ControlFlow;

/// Tells someone, who may stop it, which share of the planning is done.
pub(crate) struct Watch<'a> {
    observe: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    begin: f64,
    len: f64,
}

/// Planning was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stopped;

impl<'a> Watch<'a> {
    pub(crate) fn new(observe: &'a mut dyn FnMut(f64) -> ControlFlow<()>) -> Self {
        Self { observe, begin: 0.0, len: 1.0 }
    }

    /// A part of what is watched, by its ends in `[0, 1]`.
    pub(crate) fn part(&mut self, from: f64, to: f64) -> Watch<'_> {
        let (begin, len) = (self.begin + self.len * from, self.len * (to - from));
        Watch { observe: &mut *self.observe, begin, len }
    }

    /// Tells that so large a share of it is done.
    pub(crate) fn tell(&mut self, share: f64) -> Result<(), Stopped> {
        match (self.observe)((self.begin + self.len * share).min(1.0)) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stopped),
        }
    }
}
