//! How much memory there is, so that work that cannot fit is refused with a number instead of ending in an abort.
//!
//! An allocation that fails ends the process without a message, and one that the system grants without having the
//! memory ends in its killing something. Whoever asks for much therefore estimates first. The limit is the least of
//! what the system says is available, what the process may still take (`ulimit -v`), what its control group leaves, and
//! what the user grants ([`limit_to`]); where none of them is known nothing is refused.

use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};

/// Why work is not begun: what takes how much memory, what is available, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct TooLarge(String);

const MEGABYTE: u64 = 1_000_000;
/// Granted without asking the system, which takes some microseconds.
const SMALL: u64 = MEGABYTE;
/// What readers advise.
pub const FIX: &str = "give a smaller file, or raise --memory if the machine has more";

/// The user's limit: a process has one memory, so that it has one limit as well.
static GRANTED: AtomicU64 = AtomicU64::new(u64::MAX);

/// From now on this process is to take so many bytes at most.
pub fn limit_to(bytes: u64) {
    GRANTED.store(bytes, Ordering::Relaxed);
}

/// Is there room for so many bytes?
pub fn room_for(bytes: u64, what: &str, fix: &'static str) -> Result<(), TooLarge> {
    if bytes <= SMALL {
        return Ok(());
    }
    within(bytes, available(), what, fix)
}

/// Is there room for a reader's `count` records of so many bytes each?
pub fn room_for_records(count: u64, each: usize, what: &str) -> Result<(), TooLarge> {
    room_for(count.saturating_mul(each as u64), what, FIX)
}

/// Is there room for what is made of a JSON text? An empty object is a structure of 100 to 200 bytes.
pub fn room_for_json(text: &[u8]) -> Result<(), TooLarge> {
    const EACH: usize = 200;
    let values = text.iter().filter(|byte| b"{[,".contains(byte)).count();
    room_for_records(values as u64, EACH, "the values of the JSON text")
}

/// An empty list with room for `count` records, refused if there is none.
pub fn list<T>(count: u64, what: &str) -> Result<Vec<T>, TooLarge> {
    room_for_records(count, size_of::<T>(), what)?;
    let mut list = Vec::new();
    match usize::try_from(count).map(|count| list.try_reserve_exact(count)) {
        Ok(Ok(())) => Ok(list),
        _ => {
            let bytes = count.saturating_mul(size_of::<T>() as u64);
            Err(too_large(bytes, available().unwrap_or(0), what, FIX))
        }
    }
}

/// Adds to a list of which nobody knows how long it will be: whenever it is to grow, there must be room.
pub fn push<T>(list: &mut Vec<T>, item: T, what: &str) -> Result<(), TooLarge> {
    if list.len() == list.capacity() {
        room_for_records(2 * list.len() as u64, size_of::<T>(), what)?;
    }
    list.push(item);
    Ok(())
}

fn within(bytes: u64, limit: Option<u64>, what: &str, fix: &'static str) -> Result<(), TooLarge> {
    match limit {
        Some(limit) if bytes > limit => Err(too_large(bytes, limit, what, fix)),
        _ => Ok(()),
    }
}

fn too_large(bytes: u64, limit: u64, what: &str, fix: &'static str) -> TooLarge {
    let (needed, limit) = (bytes.div_ceil(MEGABYTE), limit / MEGABYTE);
    // The user's own number: what the process has left of it would read as another limit.
    let of = granted().map(|bytes| format!("of the {} MB granted ", bytes / MEGABYTE));
    let of = of.unwrap_or_default();
    TooLarge(format!(
        "{what} would take about {needed} MB of memory, {of}{limit} MB are available: {fix}"
    ))
}

/// What the user grants, if anything.
fn granted() -> Option<u64> {
    Some(GRANTED.load(Ordering::Relaxed)).filter(|bytes| *bytes < u64::MAX)
}

/// Bytes that this process can still take, if the system says.
pub fn available() -> Option<u64> {
    let text = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let group = |name: &str| number(&text(&format!("/sys/fs/cgroup/memory.{name}")));
    let [limits, status] = ["limits", "status"].map(|name| text(&format!("/proc/self/{name}")));
    let system = kilobytes(&text("/proc/meminfo"), "MemAvailable:");
    // The soft limits; none where they are `unlimited`.
    let soft =
        |limit: &str, used: &str| difference(after(&limits, limit), kilobytes(&status, used));
    let address_space = soft("Max address space", "VmSize:");
    let data = soft("Max data size", "VmData:");
    // What is cached for files counts as used in a group, and would be given up.
    let cached = after(&text("/sys/fs/cgroup/memory.stat"), "inactive_file ").unwrap_or(0);
    let used = group("current").map(|bytes| bytes.saturating_sub(cached));
    let granted = difference(granted(), kilobytes(&status, "VmRSS:"));
    let left = difference(group("max"), used);
    [system, address_space, data, left, granted]
        .into_iter()
        .flatten()
        .min()
}

fn difference(limit: Option<u64>, used: Option<u64>) -> Option<u64> {
    Some(limit?.saturating_sub(used.unwrap_or(0)))
}

/// `Name:   1234 kB`.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    Some(after(text, name)?.saturating_mul(1024))
}

fn after(text: &str, name: &str) -> Option<u64> {
    text.lines()
        .find_map(|line| line.strip_prefix(name))
        .and_then(number)
}

fn number(text: &str) -> Option<u64> {
    text.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_systems_texts_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max data size             unlimited            unlimited            bytes\n\
                      Max address space         4000000000           unlimited            bytes\n";
        assert_eq!(after(limits, "Max address space"), Some(4_000_000_000));
        assert_eq!(after(limits, "Max data size"), None);
        assert_eq!(
            kilobytes("VmPeak:\t 9 kB\nVmSize:\t  12 kB\n", "VmSize:"),
            Some(12_288)
        );
        assert_eq!(difference(Some(5), Some(7)), Some(0));
    }

    #[test]
    fn what_does_not_fit_is_refused_with_both_numbers() {
        let refused = within(
            3_000_000_000,
            Some(2_500_000_000),
            "a picture",
            "ask for less",
        );
        assert_eq!(
            refused.unwrap_err().to_string(),
            "a picture would take about 3000 MB of memory, 2500 MB are available: ask for less"
        );
        assert!(within(u64::MAX, None, "", "").is_ok());
        assert!(list::<u64>(u64::MAX, "everything").is_err());
        assert!(within(7, Some(7), "", "").is_ok());
    }
}
