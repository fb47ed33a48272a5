//! Pools of threads that draw.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Bytes of stack of each thread. A tile's vectors lie on the stack, and a program built without optimisation keeps
/// copies of them: more than the two megabytes that threads get otherwise.
const STACK: usize = 16 << 20;

/// A pool of so many threads.
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    let builder = ThreadPoolBuilder::new().stack_size(STACK);
    builder.num_threads(threads.max(1)).build()
}

/// Gives the same stacks to the pool of all that ask for no pool of their own. A program that has started that pool
/// already keeps it.
pub fn deepen_global_stacks() {
    let _ = ThreadPoolBuilder::new().stack_size(STACK).build_global();
}
