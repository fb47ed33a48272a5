//! QEMU plugin (TCG plugin interface, version 1): counts executed guest instructions, exactly, per phase and function.
//!
//! ```text
//! qemu-system-arm ... -plugin libsplatline_counter.so,symbols=FILE -d plugin
//! ```
//!
//! FILE is the output of `llvm-nm -S` of the image: `address size type name`. A function whose name begins with
//! `phase_` opens the phase of that name when it is entered; all instructions until the next belong to it. At the end
//! the plugin writes one line per phase, and under it one per function: `phase NAME entries COUNT instructions COUNT`,
//! ` function NAME instructions COUNT`.
//!
//! With `addresses=FILE` it also writes `address count` for every executed instruction, to be laid beside a
//! disassembly.
//!
//! Every instruction has its own counter, which QEMU increments inline; the counters are only read when a phase ends.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fmt::Write;
use std::sync::{Mutex, PoisonError};

/// Version of the plugin interface that is used.
#[unsafe(no_mangle)]
pub static qemu_plugin_version: c_int = 1;

type BlockCallback = extern "C" fn(u64, *mut c_void);
type InstructionCallback = extern "C" fn(u32, *mut c_void);

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(id: u64, callback: BlockCallback);
    fn qemu_plugin_register_atexit_cb(id: u64, callback: BlockCallback, data: *mut c_void);
    fn qemu_plugin_tb_n_insns(block: *const c_void) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const c_void, index: usize) -> *mut c_void;
    fn qemu_plugin_insn_vaddr(instruction: *const c_void) -> u64;
    fn qemu_plugin_register_vcpu_insn_exec_inline(
        instruction: *mut c_void,
        operation: c_int,
        counter: *mut u64,
        amount: u64,
    );
    fn qemu_plugin_register_vcpu_insn_exec_cb(
        instruction: *mut c_void,
        callback: InstructionCallback,
        flags: c_int,
        data: *mut c_void,
    );
    fn qemu_plugin_outs(text: *const c_char);
}

struct Function {
    first: u64,
    last: u64,
    name: String,
}

/// One instruction's counter, which lives as long as the emulator, and what of it earlier phases have taken.
struct Counter {
    count: *mut u64,
    taken: u64,
}

// SAFETY: boards with one core; the pointers lead to leaked memory.
unsafe impl Send for Counter {}

#[derive(Default)]
struct Phase {
    entries: u64,
    functions: BTreeMap<String, u64>,
}

#[derive(Default)]
struct State {
    functions: Vec<Function>,
    counters: BTreeMap<u64, Counter>,
    phases: BTreeMap<String, Phase>,
    current: String,
    addresses: Option<String>,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

fn with_state<T>(work: impl FnOnce(&mut State) -> T) -> T {
    let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    work(state.get_or_insert_default())
}

impl State {
    /// Functions by ascending address; bit 0 of Arm's symbols says Thumb.
    fn read_symbols(&mut self, file: &str) -> Result<(), String> {
        let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
        for line in text.lines() {
            let fields: Vec<&str> = line.split_whitespace().collect();
            let [first, size, "t" | "T" | "W", name] = fields[..] else {
                continue;
            };
            let number =
                |text| u64::from_str_radix(text, 16).map_err(|_| format!("{file}: {line}"));
            let (first, size) = (number(first)? & !1, number(size)?);
            // A label within a function has no size.
            if size == 0 {
                continue;
            }
            self.functions.push(Function {
                first,
                last: first + size,
                name: name.to_owned(),
            });
        }
        self.functions.sort_by_key(|function| function.first);
        Ok(())
    }

    fn function_at(&self, address: u64) -> &str {
        let after = self.functions.partition_point(|f| f.first <= address);
        match self.functions[..after].last() {
            Some(function) if address < function.last => &function.name,
            _ => "(no function)",
        }
    }

    /// Books what has been executed since the last phase began.
    fn close_phase(&mut self) {
        let mut phase = self.phases.remove(&self.current).unwrap_or_default();
        let mut counters = std::mem::take(&mut self.counters);
        for (address, counter) in &mut counters {
            // SAFETY: leaked memory.
            let count = unsafe { *counter.count };
            let new = count - std::mem::replace(&mut counter.taken, count);
            if new > 0 {
                let name = self.function_at(*address).to_owned();
                *phase.functions.entry(name).or_default() += new;
            }
        }
        self.counters = counters;
        self.phases.insert(self.current.clone(), phase);
    }

    fn write_addresses(&self) {
        let Some(file) = &self.addresses else {
            return;
        };
        let counters = self.counters.iter();
        let lines = counters.map(|(address, one)| format!("{address:08x} {}\n", one.taken));
        let lines: String = lines.collect();
        if let Err(error) = std::fs::write(file, lines) {
            eprintln!("splatline_counter: {file}: {error}");
        }
    }

    fn report(&self) -> String {
        let mut text = String::new();
        for (name, phase) in &self.phases {
            let total: u64 = phase.functions.values().sum();
            let entries = phase.entries;
            let _ = writeln!(text, "phase {name} entries {entries} instructions {total}");
            let mut functions: Vec<_> = phase.functions.iter().collect();
            functions.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
            for (function, count) in functions {
                let _ = writeln!(text, "  function {function} instructions {count}");
            }
        }
        text
    }
}

extern "C" fn translated(_: u64, block: *mut c_void) {
    with_state(|state| {
        // SAFETY: the emulator's own objects, used while it translates the block.
        let instructions = (0..unsafe { qemu_plugin_tb_n_insns(block) })
            // SAFETY: the index is below the block's count.
            .map(|index| unsafe { qemu_plugin_tb_get_insn(block, index) });
        for instruction in instructions {
            // SAFETY: an instruction of this block.
            let address = unsafe { qemu_plugin_insn_vaddr(instruction) };
            let new = || Counter {
                count: Box::leak(Box::new(0)),
                taken: 0,
            };
            let count = state.counters.entry(address).or_insert_with(new).count;
            let place = state.functions.partition_point(|f| f.first < address);
            let entered = state.functions.get(place).filter(|f| f.first == address);
            // SAFETY: an instruction of this block; the count is leaked, so that it outlives the emulator's code, and
            // the callback takes its number as it is.
            unsafe {
                if entered.is_some_and(|f| f.name.starts_with("phase_")) {
                    let place = place as *mut c_void;
                    qemu_plugin_register_vcpu_insn_exec_cb(instruction, phase_entered, 0, place);
                }
                qemu_plugin_register_vcpu_insn_exec_inline(instruction, 0, count, 1);
            }
        }
    });
}

extern "C" fn phase_entered(_: u32, function: *mut c_void) {
    with_state(|state| {
        state.close_phase();
        state.current = state.functions[function as usize].name.clone();
        let phase = state.phases.entry(state.current.clone());
        phase.or_default().entries += 1;
    });
}

extern "C" fn finished(_: u64, _: *mut c_void) {
    let text = with_state(|state| {
        state.close_phase();
        state.write_addresses();
        state.report()
    });
    let text = CString::new(text).unwrap_or_default();
    // SAFETY: a string that ends with a zero.
    unsafe { qemu_plugin_outs(text.as_ptr()) };
}

/// Called by the emulator with the arguments after the plugin's name.
///
/// # Safety
/// `arguments` leads to `count` strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: u64,
    _: *const c_void,
    count: c_int,
    arguments: *const *const c_char,
) -> c_int {
    for index in 0..count as usize {
        // SAFETY: the function's own contract.
        let argument = unsafe { CStr::from_ptr(*arguments.add(index)) }.to_string_lossy();
        if let Some(file) = argument.strip_prefix("addresses=") {
            with_state(|state| state.addresses = Some(file.to_owned()));
            continue;
        }
        let Some(file) = argument.strip_prefix("symbols=") else {
            let expected = "expected symbols=FILE or addresses=FILE";
            eprintln!("splatline_counter: {expected}, not '{argument}'");
            return 1;
        };
        if let Err(error) = with_state(|state| state.read_symbols(file)) {
            eprintln!("splatline_counter: {error}");
            return 1;
        }
    }
    with_state(|state| state.current = "phase_start".to_owned());
    // SAFETY: the callbacks live as long as the plugin.
    unsafe {
        qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
        qemu_plugin_register_atexit_cb(id, finished, std::ptr::null_mut());
    }
    0
}
