//! A ring buffer of the latest values.

/// Stores the latest values and returns the one that was pushed exactly `n` pushes ago.
///
/// Preallocated: [`DelayLine::push`] and [`DelayLine::get`] take constant time and allocate nothing.
///
/// ```
/// use nima_core::signal::DelayLine;
///
/// let mut line = DelayLine::new(3, 0);
/// for value in 1..=5 {
///     line.push(value);
/// }
/// assert_eq!(line.get(0), Some(&5));
/// assert_eq!(line.get(3), Some(&2), "exactly three ticks ago");
/// assert_eq!(line.get(4), None, "older than the line is long");
/// ```
#[derive(Clone, Debug)]
pub struct DelayLine<T> {
    ring: Vec<T>,
    newest: usize,
    filled: usize,
}

impl<T: Copy> DelayLine<T> {
    /// Creates a line that stores the last `max_delay` pushes; `blank` only initialises the memory and is never
    /// returned.
    pub fn new(max_delay: usize, blank: T) -> Self {
        // One more slot than the delay: the newest value is 0 pushes old. Starts at the last slot, so that the first
        // push goes to the first.
        Self { ring: vec![blank; max_delay + 1], newest: max_delay, filled: 0 }
    }

    /// Adds the newest value; if the line is full, the oldest one is overwritten.
    #[inline]
    pub fn push(&mut self, value: T) {
        *self.push_slot() = value;
    }

    /// Makes room for the newest value and returns a reference to it, which still contains an overwritten value (so
    /// that large values can be written in place).
    #[inline]
    pub fn push_slot(&mut self) -> &mut T {
        // A comparison instead of a remainder: a division per push is slower.
        self.newest = if self.newest + 1 >= self.ring.len() { 0 } else { self.newest + 1 };
        self.filled = (self.filled + 1).min(self.ring.len());
        &mut self.ring[self.newest]
    }

    /// Returns the value that was pushed `delay` pushes before the newest (0: the newest itself); `None` if fewer
    /// values were pushed or the line is too short.
    #[inline]
    pub fn get(&self, delay: usize) -> Option<&T> {
        if delay >= self.filled {
            return None;
        }
        // The age counts backwards through the ring, so it may wrap once.
        let index = if delay <= self.newest { self.newest - delay } else { self.newest + self.ring.len() - delay };
        self.ring.get(index)
    }

    /// Returns the value pushed `delay` pushes ago, or the oldest one stored; `None` only if nothing was pushed yet.
    #[inline]
    pub fn get_or_oldest(&self, delay: usize) -> Option<&T> {
        // `None` only for an empty line.
        self.get(delay.min(self.filled.checked_sub(1)?))
    }

    pub fn len(&self) -> usize {
        self.filled
    }

    /// Returns whether nothing was pushed since construction or [`DelayLine::clear`].
    pub fn is_empty(&self) -> bool {
        self.filled == 0
    }

    pub fn max_delay(&self) -> usize {
        self.ring.len() - 1
    }

    pub fn clear(&mut self) {
        // The values stay in memory but cannot be read, because nothing counts as filled.
        self.filled = 0;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn gives_back_exactly_what_went_in(max_delay in 0_usize..40, pushes in 0_usize..200) {
            let mut line = DelayLine::new(max_delay, usize::MAX);
            for value in 0..pushes {
                line.push(value);
                for delay in 0..max_delay + 3 {
                    let expected = (delay <= max_delay && delay <= value).then(|| value - delay);
                    prop_assert_eq!(line.get(delay).copied(), expected);
                }
                prop_assert_eq!(line.get_or_oldest(usize::MAX).copied(), Some(value.saturating_sub(max_delay)));
            }
            line.clear();
            prop_assert_eq!(line.get(0), None);
            prop_assert_eq!(line.get_or_oldest(0), None);
        }
    }
}
