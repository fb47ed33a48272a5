//! The pixel loop in assembly against its definition, on a board under QEMU: runs of a linear congruential generator,
//! every pixel word.
//!
//! Prints how many runs there were, how many pixels they changed, how many pixels differ and which bits of the
//! registers that a callee must keep were lost: none, both. Where there is no such loop it prints that nothing was
//! compared.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(any(armv6m, armv7em, target_arch = "riscv32"))]
mod image {
    use core::arch::asm;
    use splatline::blend::{Blend, FINISHED, Pixel};
    use splatline::draw::{NarrowLanes, NarrowRun, Painter32};
    use splatline::footprint::Footprint;
    use splatline::kernel::PackedTable;
    use splatline_firmware::design::Firmware16;
    use splatline_firmware::scene::RULES;
    use splatline_firmware::table::PACKED;
    use splatline_firmware::{board, pixel_loop};

    const RUNS: u32 = 3000;
    /// Longer than a block of the rows.
    const LONGEST: usize = 40;
    const LEAD: i64 = PackedTable::lead(&Firmware16::WIDTHS, RULES.table_range) as i64;
    /// Bits of the largest radial index, and the first word beyond.
    const BITS: u32 = Firmware16::WIDTHS.radial as u32 + RULES.table_range as u32;
    const END: i64 = 1 << BITS;
    const LEAST: u32 = Blend::new(&Firmware16::WIDTHS, &RULES)
        .constants()
        .minimum_transmittance
        + 1;

    struct LoopRandom(u32);

    impl LoopRandom {
        /// A number of so many bits; one in two is much smaller.
        fn bits(&mut self, bits: u32) -> u32 {
            let number = self.next() >> (32 - bits);
            let smaller = self.next() >> 27;
            if smaller < bits {
                number >> smaller
            } else {
                number
            }
        }

        fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            self.0 ^ self.0 >> 15
        }

        fn signed(&mut self, bits: u32) -> i64 {
            i64::from(self.bits(bits)) - i64::from(self.bits(bits))
        }

        /// Lanes that stay within twice the table for `length` pixels, as those of footprints do. In one run of four a
        /// pixel lies on the edge.
        fn lanes(&mut self, length: usize) -> NarrowLanes {
            loop {
                let radial = i64::from(self.bits(BITS)) + self.signed(10);
                let (first, second) = (self.signed(BITS - 3), i64::from(self.bits(BITS - 9)));
                let (mut here, mut step) = (radial, first);
                let mut within = (0..2 * END).contains(&here);
                let mut edge = here;
                for _ in 0..length {
                    here += step;
                    step += second;
                    within &= (0..2 * END).contains(&here);
                    edge = if self.bits(3) == 1 { here } else { edge };
                }
                let elsewhere = i64::from(self.bits(BITS)) + LEAD;
                let last = if self.bits(2) == 1 { edge } else { elsewhere };
                if within {
                    return NarrowLanes {
                        radial: radial as i32,
                        first: first as i32,
                        second: second as i32,
                        last: last.min(END - 1) as i32,
                    };
                }
            }
        }

        fn pixel(&mut self) -> Pixel {
            // More than the least one that does not finish a pixel.
            let transmittance = (self.bits(16) + 1).max(LEAST);
            let finished = if self.bits(3) == 7 { FINISHED } else { 0 };
            Pixel {
                colour: [0; 3].map(|_: u32| self.bits(30)),
                transmittance: transmittance | finished,
            }
        }

        fn footprint(&mut self) -> Footprint {
            let peak = if self.bits(1) == 0 { 14 } else { 18 };
            Footprint {
                opacity: self.bits(peak),
                colour: [0; 3].map(|_: u32| self.bits(14)),
                ..Footprint::EMPTY
            }
        }
    }

    #[unsafe(no_mangle)]
    fn image_main() {
        let Ok(painter) = Painter32::new(Firmware16, &RULES, PACKED) else {
            return;
        };
        let widths = Firmware16::WIDTHS;
        let blend = Blend::new(&widths, &RULES);
        let mut random = LoopRandom(1);
        let (mut clamped_runs, mut changed, mut differing) = (0, 0, 0);
        let mut lost = 0;
        for _ in 0..RUNS {
            let mut expected = [Pixel::default(); LONGEST];
            expected.fill_with(|| random.pixel());
            let before = expected;
            let mut got = expected;
            let length = (random.next() % (LONGEST as u32 + 1)) as usize;
            let lanes = random.lanes(length);
            let footprint = &random.footprint();
            let clamped = blend.is_clamped(footprint.opacity, widths.weight);
            clamped_runs += u32::from(clamped);
            let run = |pixels| NarrowRun {
                pixels,
                lanes,
                footprint,
                clamped,
            };
            painter.paint(run(expected.get_mut(..length).unwrap_or_default()));
            let mut run = Some(run(got.get_mut(..length).unwrap_or_default()));
            lost |= registers_lost(&mut run);
            changed += different(&before, &expected);
            differing += different(&expected, &got);
        }
        board::print("runs", RUNS);
        board::print("clamped", clamped_runs);
        board::print("changed", changed);
        board::print("differing", differing);
        board::print("registers_lost", lost);
    }

    extern "C" fn paint(run: &mut Option<NarrowRun>) {
        if let Some(run) = run.take() {
            pixel_loop::paint(run);
        }
    }

    /// Paints with known words in the registers that a callee must keep; what of them changed.
    #[cfg(target_arch = "riscv32")]
    fn registers_lost(run: &mut Option<NarrowRun>) -> u32 {
        let function: extern "C" fn(&mut Option<NarrowRun>) = paint;
        let lost;
        // SAFETY: a call by the calling convention; both registers, which cannot be declared, are kept on the stack.
        unsafe {
            asm!(
                "addi sp, sp, -16",
                "sw s0, 0(sp)",
                "sw s1, 4(sp)",
                "li s0, 0x1234",
                "li s1, 0x4321",
                "jalr a1",
                "li a1, 0x1234",
                "xor a0, s0, a1",
                "li a1, 0x4321",
                "xor a1, s1, a1",
                "or a0, a0, a1",
                "lw s0, 0(sp)",
                "lw s1, 4(sp)",
                "addi sp, sp, 16",
                inout("a0") run => lost,
                inout("a1") function => _,
                clobber_abi("C"),
            )
        }
        lost
    }

    /// Paints with known words in the registers that a callee must keep; what of them changed.
    #[cfg(target_arch = "arm")]
    fn registers_lost(run: &mut Option<NarrowRun>) -> u32 {
        let function: extern "C" fn(&mut Option<NarrowRun>) = paint;
        let lost;
        // SAFETY: a call by the calling convention; every register that is written is declared.
        unsafe {
            asm!(
                "mov r4, r1",
                "mov r5, r1",
                "mov r8, r1",
                "adds r1, #8",
                "mov r9, r1",
                "adds r1, #8",
                "mov r10, r1",
                "adds r1, #8",
                "mov r11, r1",
                "blx r5",
                "eors r5, r4",
                "mov r0, r8",
                "eors r0, r4",
                "orrs r5, r0",
                "adds r4, #8",
                "mov r0, r9",
                "eors r0, r4",
                "orrs r5, r0",
                "adds r4, #8",
                "mov r0, r10",
                "eors r0, r4",
                "orrs r5, r0",
                "adds r4, #8",
                "mov r0, r11",
                "eors r0, r4",
                "orrs r0, r5",
                inout("r0") run => lost,
                inout("r1") function => _,
                out("r4") _, out("r5") _, out("r8") _, out("r9") _, out("r10") _, out("r11") _,
                clobber_abi("C"),
            )
        }
        lost
    }

    fn different(some: &[Pixel], others: &[Pixel]) -> u32 {
        let pairs = some.iter().zip(others);
        pairs.filter(|(one, other)| one != other).count() as u32
    }
}

#[cfg(all(target_os = "none", not(any(armv6m, armv7em, target_arch = "riscv32"))))]
#[unsafe(no_mangle)]
fn image_main() {
    splatline_firmware::board::print("runs", 0);
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("runs=0");
}
