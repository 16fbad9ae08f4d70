//! The short queue of a client, which keeps the newest data.

use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

/// Maximum number of waiting answers and states; beyond it the oldest is dropped. A slow client gets the newest state
/// instead of a growing backlog.
const MAX_MESSAGES: usize = 64;

/// Between the hub and a client's writer. Neither waits for the other: the lock is held only for adding or removing an
/// entry.
#[derive(Debug, Default)]
pub(super) struct Mailbox {
    mail: Mutex<QueuedMail>,
    comes: Condvar,
}

#[derive(Debug, Default)]
struct QueuedMail {
    report: VecDeque<Vec<u8>>,
    bundle: Option<Vec<u8>>,
    image: Option<Vec<u8>>,
    /// Number of batches and images replaced by newer ones, and of dropped answers.
    replaced: u64,
    ends: bool,
    /// No more entries are taken in, and the end comes after those that wait.
    is_last: bool,
}

impl Mailbox {
    fn mail(&self) -> MutexGuard<'_, QueuedMail> {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an answer or a state.
    pub(super) fn report(&self, bytes: Vec<u8>) {
        let mut mail = self.mail();
        if mail.is_last {
            return;
        }
        if mail.report.len() >= MAX_MESSAGES {
            mail.report.pop_front();
            mail.replaced += 1;
        }
        mail.report.push_back(bytes);
        self.comes.notify_one();
    }

    /// Sets the newest bundle.
    pub(super) fn bundle(&self, bytes: Vec<u8>) {
        let mut mail = self.mail();
        if mail.is_last {
            return;
        }
        mail.replaced += u64::from(mail.bundle.replace(bytes).is_some());
        self.comes.notify_one();
    }

    /// Sets the newest image.
    pub(super) fn image(&self, bytes: Vec<u8>) {
        let mut mail = self.mail();
        if mail.is_last {
            return;
        }
        mail.replaced += u64::from(mail.image.replace(bytes).is_some());
        self.comes.notify_one();
    }

    /// Returns whether an image is waiting, so that another one would be wasted.
    pub(super) fn has_image(&self) -> bool {
        self.mail().image.is_some()
    }

    /// Returns the number of replaced and dropped entries.
    #[cfg(test)]
    pub(super) fn replaced(&self) -> u64 {
        self.mail().replaced
    }

    /// Closes the mailbox.
    pub(super) fn end(&self) {
        self.mail().ends = true;
        self.comes.notify_one();
    }

    /// Closes the mailbox after this last answer; whatever else is waiting is dropped.
    pub(super) fn end_with(&self, bytes: Vec<u8>) {
        let mut mail = self.mail();
        mail.report.push_back(bytes);
        mail.bundle = None;
        mail.image = None;
        mail.is_last = true;
        self.comes.notify_one();
    }

    /// Waits for the next entry. `None` at the end.
    pub(super) fn next(&self) -> Option<Vec<u8>> {
        let mut mail = self.mail();
        loop {
            if mail.ends {
                return None;
            }
            let next = mail.report.pop_front().or_else(|| mail.bundle.take()).or_else(|| mail.image.take());
            if next.is_some() || mail.is_last {
                return next;
            }
            mail = self.comes.wait(mail).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_bundle_takes_the_place_of_the_one_before_and_answers_keep_their_order() {
        let mailbox = Mailbox::default();
        for number in 0..10 {
            mailbox.bundle(vec![number]);
            mailbox.image(vec![100 + number]);
            mailbox.report(vec![50 + number]);
        }
        assert!(mailbox.has_image() && mailbox.replaced() == 18);
        let taken: Vec<u8> = (0..12).filter_map(|_| mailbox.next()).flatten().collect();
        assert_eq!(taken, [50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 9, 109]);
        mailbox.end();
        assert_eq!(mailbox.next(), None);
    }

    #[test]
    fn the_last_answer_comes_last() {
        let mailbox = Mailbox::default();
        mailbox.report(vec![1]);
        mailbox.bundle(vec![2]);
        mailbox.end_with(vec![3]);
        mailbox.bundle(vec![4]);
        mailbox.report(vec![5]);
        assert_eq!([mailbox.next(), mailbox.next(), mailbox.next()], [Some(vec![1]), Some(vec![3]), None]);
    }

    #[test]
    fn a_client_that_takes_nothing_costs_no_more_memory() {
        let mailbox = Mailbox::default();
        for number in 0..10_000_u32 {
            mailbox.report(number.to_be_bytes().to_vec());
        }
        assert_eq!(mailbox.mail().report.len(), MAX_MESSAGES);
        assert_eq!(mailbox.next(), Some((10_000 - MAX_MESSAGES as u32).to_be_bytes().to_vec()));
    }
}
