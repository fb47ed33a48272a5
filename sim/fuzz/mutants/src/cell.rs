//! Which mutant runs. This file joins the mutated copy of the kernel and no other.

extern crate std as host;

/// Number of mutants beyond which the table of reached ones does not go.
const MOST: usize = 1 << 14;
/// Instead of a mutant: note which ones are reached.
const RECORD: u32 = u32::MAX;
/// For what the compiler evaluates: the mutant of this build.
const COMPILED: u32 = number(option_env!("MUTANT_COMPILED"));

static mut CHOSEN: u32 = 0;
static REACHED: [core::sync::atomic::AtomicBool; MOST] = [const { core::sync::atomic::AtomicBool::new(false) }; MOST];

/// True if mutant `n` is to run.
#[inline(always)]
pub const fn at(n: u32) -> bool {
    core::intrinsics::const_eval_select((n,), compiled, chosen)
}

const fn compiled(n: u32) -> bool {
    n == COMPILED
}

#[inline(always)]
fn chosen(n: u32) -> bool {
    // Written once, before `main`.
    let chosen = unsafe { CHOSEN };
    chosen == n || (chosen == RECORD && record(n))
}

#[cold]
#[inline(never)]
fn record(n: u32) -> bool {
    REACHED[n as usize].store(true, core::sync::atomic::Ordering::Relaxed);
    false
}

const fn number(text: Option<&str>) -> u32 {
    let Some(text) = text else { return 0 };
    let (mut value, mut i) = (0, 0);
    while i < text.len() {
        value = 10 * value + (text.as_bytes()[i] - b'0') as u32;
        i += 1;
    }
    value
}

#[used]
#[unsafe(link_section = ".init_array")]
static BEGIN: extern "C" fn() = begin;

extern "C" fn begin() {
    unsafe extern "C" {
        fn atexit(f: extern "C" fn()) -> i32;
    }
    let chosen = match host::env::var("MUTANT") {
        Ok(number) => number.parse().expect("a number of a mutant"),
        Err(_) if host::env::var_os("MUTANT_RECORD").is_some() => RECORD,
        // What was compiled in runs at run time too.
        Err(_) => COMPILED,
    };
    unsafe {
        CHOSEN = chosen;
        if chosen == RECORD {
            atexit(end);
        }
    }
}

extern "C" fn end() {
    use core::fmt::Write;
    let mut numbers = host::string::String::new();
    for (n, reached) in REACHED.iter().enumerate() {
        if reached.load(core::sync::atomic::Ordering::Relaxed) {
            let _ = write!(numbers, "{n} ");
        }
    }
    if let Some(path) = host::env::var_os("MUTANT_RECORD") {
        let _ = host::fs::write(path, numbers);
    }
}
