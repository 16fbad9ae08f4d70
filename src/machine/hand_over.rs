//! Ends of the wait-free queues between the loop and ordinary threads.
//!
//! The loop holds its own [`Producer`] or [`Consumer`]. Its operations end after a fixed number of steps, whatever
//! the thread at the other end does. A queue that waits for the other thread to complete its operation would hold the
//! processor for ever if that thread has a lower priority and was preempted on the same processor.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rtrb::{Consumer, Producer, PushError, RingBuffer};

/// Creates a queue from ordinary threads to the loop.
pub fn to_loop<T>(capacity: usize) -> (ToLoop<T>, Consumer<T>) {
    let (producer, consumer) = RingBuffer::new(capacity);
    (ToLoop(Arc::new(Mutex::new(producer))), consumer)
}

/// Creates a queue from the loop to ordinary threads.
pub fn from_loop<T>(capacity: usize) -> (Producer<T>, FromLoop<T>) {
    let (producer, consumer) = RingBuffer::new(capacity);
    (producer, FromLoop(Arc::new(Mutex::new(consumer))))
}

/// The end of ordinary threads, which may share it. Its lock orders these threads; the loop never locks it.
#[derive(Debug)]
pub struct ToLoop<T>(Arc<Mutex<Producer<T>>>);

/// The end of ordinary threads, which may share it. Its lock orders these threads; the loop never locks it.
#[derive(Debug)]
pub struct FromLoop<T>(Arc<Mutex<Consumer<T>>>);

impl<T> ToLoop<T> {
    /// Sends a value.
    ///
    /// # Errors
    /// Returns the value if the queue is full.
    pub fn try_send(&self, value: T) -> Result<(), T> {
        self.end().push(value).map_err(|PushError::Full(value)| value)
    }

    /// Returns whether the loop's end was dropped.
    pub fn is_abandoned(&self) -> bool {
        self.end().is_abandoned()
    }

    fn end(&self) -> MutexGuard<'_, Producer<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> FromLoop<T> {
    pub fn try_recv(&self) -> Option<T> {
        self.end().pop().ok()
    }

    /// Returns the waiting values, oldest first.
    pub fn try_iter(&self) -> impl Iterator<Item = T> {
        std::iter::from_fn(|| self.try_recv())
    }

    /// Returns the number of waiting values.
    pub fn waiting(&self) -> usize {
        self.end().slots()
    }

    /// Returns whether the loop's end was dropped and no value is waiting. Values that it sent before are returned
    /// first.
    pub fn has_ended(&self) -> bool {
        let end = self.end();
        // Check in this order: once the loop's end is dropped, no further value can arrive.
        end.is_abandoned() && end.is_empty()
    }

    fn end(&self) -> MutexGuard<'_, Consumer<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> Clone for ToLoop<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Clone for FromLoop<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_arrive_in_order_and_those_sent_before_the_end_are_not_lost() {
        let (mut producer, out) = from_loop(3);
        for value in 0..3 {
            producer.push(value).unwrap();
        }
        assert!(producer.push(3).is_err(), "full");
        assert_eq!(out.waiting(), 3);
        assert_eq!(out.clone().try_recv(), Some(0));
        drop(producer);
        assert!(!out.has_ended(), "two still wait");
        assert_eq!(out.try_iter().collect::<Vec<_>>(), [1, 2]);
        assert!(out.has_ended());

        let (into, mut consumer) = to_loop(2);
        let other = into.clone();
        assert_eq!((into.try_send(1), other.try_send(2), into.try_send(3)), (Ok(()), Ok(()), Err(3)));
        assert_eq!((consumer.pop(), consumer.pop()), (Ok(1), Ok(2)));
        assert!(!into.is_abandoned());
        drop(consumer);
        assert!(other.is_abandoned());
    }
}
