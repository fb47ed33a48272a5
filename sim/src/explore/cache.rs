//! What has been made once and is asked for again, by what it depends on. Threads share it; what two of them miss at a time both make.

use anyhow::Result;
use std::collections::{HashMap, VecDeque};
use std::hash::Hash;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Results by what they depend on, as long as all take no more than so many bytes: the oldest leave first.
pub struct Cache<K, V> {
    most: usize,
    bytes: fn(&V) -> usize,
    kept: Mutex<Kept<K, V>>,
}

/// What is kept, its keys as they came, and its bytes.
struct Kept<K, V> {
    known: HashMap<K, V>,
    order: VecDeque<K>,
    bytes: usize,
}

impl<K: Hash + Eq + Clone, V: Clone> Cache<K, V> {
    /// Nothing known yet; `bytes` tells how many a result takes.
    pub fn new(most: usize, bytes: fn(&V) -> usize) -> Cache<K, V> {
        let kept = Kept {
            known: HashMap::new(),
            order: VecDeque::new(),
            bytes: 0,
        };
        Cache {
            most,
            bytes,
            kept: Mutex::new(kept),
        }
    }

    /// Of what is so small that all of it stays.
    pub fn of_all() -> Cache<K, V> {
        Cache::new(usize::MAX, |_| 0)
    }

    /// What is known already.
    pub fn known(&self, key: &K) -> Option<V> {
        self.kept().known.get(key).cloned()
    }

    fn kept(&self) -> MutexGuard<'_, Kept<K, V>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is known, or else made and kept.
    pub fn get(&self, key: K, make: impl FnOnce() -> Result<V>) -> Result<V> {
        if let Some(known) = self.known(&key) {
            return Ok(known);
        }
        // Not under the lock: others may look meanwhile.
        let made = make()?;
        let bytes = (self.bytes)(&made);
        let mut kept = self.kept();
        while kept.bytes.saturating_add(bytes) > self.most
            && let Some(oldest) = kept.order.pop_front()
        {
            let left = kept.known.remove(&oldest);
            kept.bytes -= left.as_ref().map_or(0, self.bytes);
        }
        // Another one may have made it meanwhile.
        if kept.known.insert(key.clone(), made.clone()).is_none() {
            kept.bytes += bytes;
            kept.order.push_back(key);
        }
        Ok(made)
    }
}
