//! The verilated sorter and its memory behind a safe function.
#![allow(unsafe_code)]

use anyhow::{Context, Result, ensure};
use libloading::Library;
use std::path::Path;

/// Where everything lies, and how the memory behaves; `OrderPicture` of order_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct OrderPicture {
    /// Words at which the splats' two regions begin.
    pub bases: [u32; 2],
    /// Word at which the lists begin.
    pub lists: u32,
    /// Tiles in a row.
    pub tile_columns: u32,
    /// Tiles.
    pub tiles: u32,
    /// Entries for which there is room.
    pub most: u32,
    /// Cycles from a request to its word, and from a word to its place.
    pub latency: u32,
    /// How many of 8 cycles the memory holds a request back.
    pub pauses: u32,
    /// Cycles from a splat to the next one at least.
    pub interval: u32,
    /// How often all of it is done, one picture after the other.
    pub rounds: u32,
}

/// What came of it; `OrderOutcome` of order_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct OrderOutcome {
    /// Splats taken.
    pub splats: u32,
    /// List entries.
    pub entries: u32,
    /// Word at which the sorted splats begin.
    pub sorted: u32,
    /// Was there no room for the lists?
    pub full: u32,
    /// Did it never end?
    pub hangs: u32,
    /// Padding.
    pub spare: u32,
    /// Cycles until the last splat was taken.
    pub taken: u64,
    /// Cycles until the lists were written.
    pub done: u64,
    /// Words read.
    pub read: u64,
    /// Words written.
    pub written: u64,
    /// Accesses beyond the memory.
    pub beyond: u64,
}

type OrderRun = unsafe extern "C" fn(
    u32,
    *const OrderPicture,
    *const [u32; 4],
    u64,
    *mut [u32; 4],
    u64,
    *mut u32,
    *mut OrderOutcome,
);

/// A circuit in a shared library.
pub struct OrderModel {
    run: OrderRun,
    /// Keeps the code loaded.
    _library: Library,
}

impl OrderModel {
    /// Loads it.
    pub fn new(path: &Path) -> Result<OrderModel> {
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbol has the shim's type.
        unsafe {
            let library = Library::new(path).context("the sorter's library")?;
            Ok(OrderModel {
                run: *library.get(b"order_run")?,
                _library: library,
            })
        }
    }

    /// Orders `splats` in `memory`; gives the end of each tile's list too.
    pub fn run(
        &self,
        seed: u32,
        picture: &OrderPicture,
        splats: &[[u32; 4]],
        memory: &mut [[u32; 4]],
    ) -> Result<(OrderOutcome, Vec<u32>)> {
        let mut ends = vec![0; picture.tiles as usize];
        let mut outcome = OrderOutcome::default();
        // SAFETY: the structs mirror the shim's; every slice is passed with its length, `ends` with that of the picture's tiles, and the
        // shim keeps accesses of the circuit within them.
        unsafe {
            (self.run)(
                seed,
                picture,
                splats.as_ptr(),
                splats.len() as u64,
                memory.as_mut_ptr(),
                memory.len() as u64,
                ends.as_mut_ptr(),
                &mut outcome,
            );
        }
        ensure!(outcome.hangs == 0, "the sorter hangs");
        Ok((outcome, ends))
    }
}
