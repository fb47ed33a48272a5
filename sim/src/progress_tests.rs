//! What bars said on this thread, for tests, whose standard error is no terminal.

use std::cell::RefCell;

thread_local! {
    static LINES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

pub(super) fn note(line: String) {
    LINES.with_borrow_mut(|lines| lines.push(line));
}

/// All that was said since the last call.
pub fn take() -> Vec<String> {
    LINES.take()
}
