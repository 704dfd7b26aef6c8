//! A box for one letter: a new one takes the place of the old one, and whoever waits gets the latest.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// The box.
#[derive(Debug)]
pub struct Mailbox<T> {
    slot: Mutex<Slot<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Slot<T> {
    letter: Option<T>,
    closed: bool,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self { slot: Mutex::new(Slot { letter: None, closed: false }), changed: Condvar::new() }
    }
}

impl<T> Mailbox<T> {
    /// Puts a letter in; the one before is thrown away.
    pub fn put(&self, letter: T) {
        self.lock().letter = Some(letter);
        self.changed.notify_all();
    }

    /// Whether there is a letter, or will be none any more: whatever is done should be left.
    pub fn has_news(&self) -> bool {
        let slot = self.lock();
        slot.letter.is_some() || slot.closed
    }

    /// Waits for a letter. None when the box is closed.
    pub fn wait(&self) -> Option<T> {
        let mut slot = self.lock();
        loop {
            if slot.closed {
                return None;
            }
            if let Some(letter) = slot.letter.take() {
                return Some(letter);
            }
            slot = self.changed.wait(slot).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// No letter will come any more.
    pub fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_all();
    }

    /// A letter is whole or not there, whatever happened to those who held the lock.
    fn lock(&self) -> MutexGuard<'_, Slot<T>> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_letter_arrives_and_a_closed_box_ends_the_wait() {
        let mailbox = Mailbox::default();
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| std::iter::from_fn(|| mailbox.wait()).last());
            (0..100).for_each(|letter| mailbox.put(letter));
            while mailbox.has_news() {
                std::thread::yield_now();
            }
            mailbox.close();
            assert_eq!(reader.join().expect("does not panic"), Some(99));
        });
        assert!(mailbox.has_news());
    }
}
