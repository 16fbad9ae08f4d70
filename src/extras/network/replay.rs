//! A window over the numbers of received datagrams: each is accepted once, and none older than the window.

/// Numbers in the window.
pub const WINDOW: u64 = 2048;
/// One word more than the length requires, because the window starts and ends within words.
const WORDS: usize = (WINDOW / 64) as usize + 1;

/// Why a number is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayRefusal {
    /// The number has been accepted before.
    Replayed,
    Old,
}

/// The numbers accepted recently.
#[derive(Clone, Debug)]
pub struct ReplayWindow {
    /// One more than the highest accepted number.
    next: u64,
    seen: [u64; WORDS],
}

impl Default for ReplayWindow {
    fn default() -> Self {
        Self { next: 0, seen: [0; WORDS] }
    }
}

const fn place(number: u64) -> (usize, u64) {
    ((number / 64) as usize % WORDS, 1 << (number % 64))
}

impl ReplayWindow {
    /// Returns one more than the highest accepted number; 0 before the first.
    pub const fn next(&self) -> u64 {
        self.next
    }

    /// Checks whether the number may be accepted.
    ///
    /// # Errors
    /// [`ReplayRefusal`] with the cause.
    pub const fn check(&self, number: u64) -> Result<(), ReplayRefusal> {
        if number >= self.next {
            return Ok(());
        }
        if self.next - number > WINDOW {
            return Err(ReplayRefusal::Old);
        }
        let (word, bit) = place(number);
        if self.seen[word] & bit == 0 { Ok(()) } else { Err(ReplayRefusal::Replayed) }
    }

    /// Accepts the number; call it only after its datagram has proven authentic.
    ///
    /// # Errors
    /// As [`ReplayWindow::check`].
    pub fn accept(&mut self, number: u64) -> Result<(), ReplayRefusal> {
        self.check(number)?;
        let (word, bit) = place(number);
        if number >= self.next {
            // Clear the entries that enter the window, at most all of them.
            let old_word = self.next.saturating_sub(1) / 64;
            let fresh = (number / 64).saturating_sub(old_word).min(WORDS as u64);
            for back in 0..fresh {
                self.seen[place(number - back * 64).0] = 0;
            }
            self.next = number.saturating_add(1);
        }
        self.seen[word] |= bit;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn it_agrees_with_a_set_of_all_numbers() {
        let mut rng = fastrand::Rng::with_seed(1);
        for base in [0_u64, 1 << 32] {
            let mut window = ReplayWindow::default();
            let mut set = HashSet::new();
            let mut highest = 0;
            for i in 0..100_000_u64 {
                let jump = if rng.u32(..1000) == 0 { rng.u64(..10_000) } else { 0 };
                let number = (base + i + jump).saturating_sub(rng.u64(..3000));
                let expected = if !set.is_empty() && highest >= WINDOW && number <= highest - WINDOW {
                    Err(ReplayRefusal::Old)
                } else if set.contains(&number) {
                    Err(ReplayRefusal::Replayed)
                } else {
                    Ok(())
                };
                assert_eq!(window.accept(number), expected, "{number} of {highest}");
                if expected.is_ok() {
                    set.insert(number);
                    highest = highest.max(number);
                }
            }
        }
    }
}
