//! What has been made once and is asked for again, by what it depends on. Threads share it; what two of them miss at a
//! time both make.

use anyhow::Result;
use std::collections::{HashMap, VecDeque};
use std::hash::Hash;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a mutex guards: whoever panicked with it left it whole.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Results by what they depend on, as long as all take no more than so many bytes: the oldest leave first.
pub struct Cache<K, V> {
    most: usize,
    bytes: fn(&V) -> usize,
    store: Mutex<Store<K, V>>,
}

/// What is kept, its keys as they came, and its bytes.
struct Store<K, V> {
    known: HashMap<K, V>,
    order: VecDeque<K>,
    bytes: usize,
}

impl<K: Hash + Eq + Clone, V: Clone> Cache<K, V> {
    /// Nothing known yet; `bytes` tells how many a result takes.
    pub fn new(most: usize, bytes: fn(&V) -> usize) -> Cache<K, V> {
        let store = Store {
            known: HashMap::new(),
            order: VecDeque::new(),
            bytes: 0,
        };
        Cache {
            most,
            bytes,
            store: Mutex::new(store),
        }
    }

    /// Of what is so small that all of it stays.
    pub fn of_all() -> Cache<K, V> {
        Cache::new(usize::MAX, |_| 0)
    }

    /// What is known already.
    pub fn known(&self, key: &K) -> Option<V> {
        locked(&self.store).known.get(key).cloned()
    }

    /// What is known, or else made and kept.
    pub fn get(&self, key: K, make: impl FnOnce() -> Result<V>) -> Result<V> {
        if let Some(known) = self.known(&key) {
            return Ok(known);
        }
        // Not under the lock: others may look meanwhile.
        let made = make()?;
        let bytes = (self.bytes)(&made);
        let mut store = locked(&self.store);
        while store.bytes.saturating_add(bytes) > self.most
            && let Some(oldest) = store.order.pop_front()
        {
            let left = store.known.remove(&oldest);
            store.bytes -= left.as_ref().map_or(0, self.bytes);
        }
        // Another one may have made it meanwhile.
        if store.known.insert(key.clone(), made.clone()).is_none() {
            store.bytes += bytes;
            store.order.push_back(key);
        }
        Ok(made)
    }
}
