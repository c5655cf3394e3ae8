//! Work that its caller may break off.

use std::cell::RefCell;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::ControlFlow;

/// Bytes after which the caller is asked again.
const STRIDE: usize = 1 << 16;

/// Whom to ask whether to go on, and how far the work is.
pub(super) struct Watch<'a> {
    inner: RefCell<Inner<'a>>,
}

struct Inner<'a> {
    observe: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    share: f64,
    stopped: bool,
}

impl<'a> Watch<'a> {
    pub(super) fn new(observe: &'a mut dyn FnMut(f64) -> ControlFlow<()>) -> Self {
        Self { inner: RefCell::new(Inner { observe, share: 0.0, stopped: false }) }
    }

    /// The share of the files that are complete.
    pub(super) fn reach(&self, share: f64) {
        self.inner.borrow_mut().share = share;
    }

    /// Asks, unless the caller has broken off already: whether to stop.
    pub(super) fn stops(&self) -> bool {
        let Inner { observe, share, stopped } = &mut *self.inner.borrow_mut();
        *stopped = *stopped || observe(*share).is_break();
        *stopped
    }

    /// Whether the caller has broken off.
    pub(super) fn stopped(&self) -> bool {
        self.inner.borrow().stopped
    }
}

/// A file that is not written on when the caller breaks off.
pub(super) struct Watched<'a, W> {
    pub(super) out: W,
    pub(super) watch: &'a Watch<'a>,
    /// Bytes since the caller was asked.
    pub(super) bytes: usize,
}

impl<W: Write> Write for Watched<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.bytes >= STRIDE {
            self.bytes = 0;
            if self.watch.stops() {
                // Whoever sees this error asks the watch what it means.
                return Err(io::Error::other("broken off"));
            }
        }
        let count = self.out.write(bytes)?;
        self.bytes += count;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Seek> Seek for Watched<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}
