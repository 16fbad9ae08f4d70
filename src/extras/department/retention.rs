//! The last minutes of a session, for watchers that join late or have missed data.

use std::{collections::VecDeque, sync::Arc};

use nima_session::remote_copy::{Bundle, SessionHead};

use crate::keys::{pack, unpack};

/// Maximum bytes of stored bundles, compressed: about ten minutes of two arms.
const MAX_BYTES: usize = 64 << 20;

/// The stored part of a session.
#[derive(Debug)]
pub(crate) struct RetainedSession {
    head: SessionHead,
    bundles: VecDeque<Arc<[u8]>>,
    bytes: usize,
    max_bytes: usize,
}

impl RetainedSession {
    /// Creates the beginning of a session.
    pub(crate) const fn new(head: SessionHead) -> Self {
        Self { head, bundles: VecDeque::new(), bytes: 0, max_bytes: MAX_BYTES }
    }

    #[cfg(test)]
    pub(crate) const fn with_room(head: SessionHead, max_bytes: usize) -> Self {
        Self { head, bundles: VecDeque::new(), bytes: 0, max_bytes }
    }

    /// Adds the next batch; returns its compressed bytes.
    pub(crate) fn add(&mut self, bundle: &Bundle) -> Arc<[u8]> {
        let packed: Arc<[u8]> = pack(&bundle.pack()).into();
        self.bytes += packed.len();
        self.bundles.push_back(Arc::clone(&packed));
        while self.bytes > self.max_bytes && self.bundles.len() > 1 {
            let Some(oldest) = self.bundles.pop_front() else { break };
            self.bytes -= oldest.len();
            // Unpacking cannot fail, because the batch was packed here.
            if let Some(bundle) = unpack(&oldest).and_then(|bytes| Bundle::read(&bytes).ok()) {
                self.head.outlive(bundle);
            }
        }
        packed
    }

    /// Returns the head needed to begin with the oldest stored bundle.
    pub(crate) fn head(&self) -> Vec<u8> {
        pack(&self.head.pack())
    }

    pub(crate) fn session(&self) -> u64 {
        self.head.session
    }

    /// Returns the batches from this one on, with their numbers: about this many bytes, but at least one batch.
    pub(crate) fn from(&self, number: u64, max_bytes: usize) -> Vec<(u64, Arc<[u8]>)> {
        let Some(skipped) = number.checked_sub(self.head.first) else { return Vec::new() };
        let skipped = usize::try_from(skipped).unwrap_or(usize::MAX);
        let mut bytes = 0;
        let mut fits = |packed: &Arc<[u8]>| {
            let fits = bytes < max_bytes;
            bytes += packed.len();
            fits
        };
        let kept = self.bundles.iter().skip(skipped);
        (number..).zip(kept.take_while(|packed| fits(packed)).cloned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use nima_session::remote_copy::FilePart;

    use super::*;

    fn bundle(number: u64) -> Bundle {
        let table = FilePart::table(&format!("table {number}"), &BTreeMap::new());
        let random: Vec<u8> = std::iter::repeat_with(|| fastrand::u8(..)).take(1000).collect();
        Bundle::new(1, number, vec![table, FilePart::message(0, number, &random)], false)
    }

    #[test]
    fn what_is_too_old_goes_and_its_tables_stay() {
        let mut kept = RetainedSession::with_room(SessionHead::new(1, "test", 0), 5000);
        for number in 0..10 {
            kept.add(&bundle(number));
        }
        let head = SessionHead::read(&unpack(&kept.head()).unwrap()).unwrap();
        assert!(head.lacks && (5..8).contains(&head.first), "{}", head.first);
        let all = kept.from(head.first, usize::MAX);
        assert_eq!(all.iter().map(|(number, _)| *number).collect::<Vec<_>>(), (head.first..10).collect::<Vec<_>>());
        let first = Bundle::read(&unpack(&all[0].1).unwrap()).unwrap();
        assert_eq!(first.number, head.first);
        for number in 0..=head.first {
            assert!(head.table(&first, &format!("table {number}")).is_some(), "{number}");
        }
        assert_eq!(kept.from(9, 1).len(), 1);
        assert_eq!(kept.from(8, 1).len(), 1);
        assert!(kept.from(0, usize::MAX).is_empty() && kept.from(10, usize::MAX).is_empty());
    }
}
