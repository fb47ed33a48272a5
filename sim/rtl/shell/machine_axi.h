/* Whole machine behind AXI4-Lite and AXI4. Registers are 32 bits; a write elsewhere is answered and does nothing, a read elsewhere gives 0. What is written is held steady while a frame is drawn. Addresses are words of 16 bytes.
   Written by registers.py from machine.json. */
#ifndef MACHINE_AXI_H
#define MACHINE_AXI_H

#include <stdint.h>

/* Writing begins a frame; reading gives the state. (read-write) */
#define MACHINE_AXI_CONTROL 0x00u
/* Write 1: begin a frame; while one is drawn this does nothing. Read: 1 in the cycle before it begins. */
#define MACHINE_AXI_CONTROL_BEGIN 0x1u
/* Read: 0 none, 1 geometry, 2 order, 3 raster. After raster it is 0 when the memory has answered every write of the frame. */
#define MACHINE_AXI_CONTROL_PHASE 0x6u
/* Read: the lists had no room, the frame was not drawn. */
#define MACHINE_AXI_CONTROL_FULL 0x8u
/* Read: since the frame began, the memory has answered a transfer with an error. */
#define MACHINE_AXI_CONTROL_FAILED 0x10u
/* Version of packets, as splat_axi has it. (read-only) */
#define MACHINE_AXI_VERSION 0x04u
/* Parameters of the circuit. (read-only) */
#define MACHINE_AXI_SHAPE 0x08u
/* Bits of a byte's address in the memory. */
#define MACHINE_AXI_SHAPE_ADDRESS 0xffu
/* Lanes. */
#define MACHINE_AXI_SHAPE_LANES 0xff00u
/* Cores of setup. */
#define MACHINE_AXI_SHAPE_CORES 0xff0000u
/* Multipliers of the harmonics unit; 0: none. */
#define MACHINE_AXI_SHAPE_HARMONICS 0xff000000u
/* Constant of camera and rules that is written next. (write-only) */
#define MACHINE_AXI_CONSTANT_INDEX 0x10u
/* Low word of its value. (write-only) */
#define MACHINE_AXI_CONSTANT_LOW 0x14u
/* High word of its value. (write-only) */
#define MACHINE_AXI_CONSTANT_HIGH 0x18u
/* Its exponent, 18 bits, signed; writing it writes the constant and goes to the next. (write-only) */
#define MACHINE_AXI_CONSTANT_EXPONENT 0x1cu
/* Largest opacity, UQ1.alpha (BlendConstants::alpha_max of the kernel). (write-only) */
#define MACHINE_AXI_ALPHA_MAX 0x20u
/* A pixel is finished when its transmittance is at most this, UQ1.transmittance (BlendConstants::minimum_transmittance). (write-only) */
#define MACHINE_AXI_MINIMUM_TRANSMITTANCE 0x24u
/* Low word of the smallest product of peak and kernel that is drawn, UQ4.(peak + weight) (BlendConstants::opacity_min). (write-only) */
#define MACHINE_AXI_LEAST 0x28u
/* High word of least. (write-only) */
#define MACHINE_AXI_LEAST_HIGH 0x2cu
/* Rules of one bit. (write-only) */
#define MACHINE_AXI_FLAGS 0x30u
/* The splat that would finish a pixel is left out. */
#define MACHINE_AXI_FLAGS_OMIT_FINISHING 0x1u
/* The footprint table ends at r = 16 instead of r = 4. */
#define MACHINE_AXI_FLAGS_WIDE_TABLE 0x2u
/* Entry of the footprint table that is written next. (write-only) */
#define MACHINE_AXI_TABLE_INDEX 0x34u
/* Kernel at the entry's left end, UQ1.weight. (write-only) */
#define MACHINE_AXI_TABLE_LOW 0x38u
/* Step down to the kernel at its right end; writing it writes the entry and goes to the next. (write-only) */
#define MACHINE_AXI_TABLE_STEP 0x3cu
/* Number of splats. (write-only) */
#define MACHINE_AXI_RECORDS 0x40u
/* Address of the records, 5 words each. (write-only) */
#define MACHINE_AXI_BASE_RECORDS 0x44u
/* Address of the harmonics, (degree + 1)^2 words for each splat; only of a machine that has them. (write-only) */
#define MACHINE_AXI_BASE_HARMONICS 0x48u
/* Degree of the harmonics, 0 to 4. (write-only) */
#define MACHINE_AXI_DEGREE 0x4cu
/* Address of the packets, for each splat as many words as a packet has. (write-only) */
#define MACHINE_AXI_BASE_PACKETS 0x50u
/* Address of the splats to be sorted, a word each. (write-only) */
#define MACHINE_AXI_BASE_A 0x54u
/* Address of as many words beside them. (write-only) */
#define MACHINE_AXI_BASE_B 0x58u
/* Address of the lists, four entries in a word. (write-only) */
#define MACHINE_AXI_BASE_LISTS 0x5cu
/* Address of the frame, a word for each pixel: transmittance with the flag of finished pixels, red, green, blue. (write-only) */
#define MACHINE_AXI_BASE_FRAME 0x60u
/* Entries for which the lists have room, 24 bits. (write-only) */
#define MACHINE_AXI_MOST 0x64u
/* Size of the frame. (write-only) */
#define MACHINE_AXI_SIZE 0x68u
/* Columns. */
#define MACHINE_AXI_SIZE_COLUMNS 0xffffu
/* Rows. */
#define MACHINE_AXI_SIZE_ROWS 0xffff0000u
/* Splats of the frame that are seen. (read-only) */
#define MACHINE_AXI_VISIBLE 0x6cu
/* Entries of its lists. (read-only) */
#define MACHINE_AXI_ENTRIES 0x70u
/* Cycles of the clock in which it was drawn. (read-only) */
#define MACHINE_AXI_CYCLES 0x74u

static inline uint32_t machine_axi_read(uintptr_t base, uint32_t offset) { return *(volatile const uint32_t *)(base + offset); }
static inline void machine_axi_write(uintptr_t base, uint32_t offset, uint32_t value) { *(volatile uint32_t *)(base + offset) = value; }

/* Writes a constant of camera and rules. */
static inline void machine_axi_constant(uintptr_t base, uint32_t index, uint32_t low, uint32_t high, uint32_t exponent) {
  machine_axi_write(base, MACHINE_AXI_CONSTANT_INDEX, index);
  machine_axi_write(base, MACHINE_AXI_CONSTANT_LOW, low);
  machine_axi_write(base, MACHINE_AXI_CONSTANT_HIGH, high);
  machine_axi_write(base, MACHINE_AXI_CONSTANT_EXPONENT, exponent);
}

/* Writes an entry of the footprint table. */
static inline void machine_axi_table(uintptr_t base, uint32_t index, uint32_t low, uint32_t step) {
  machine_axi_write(base, MACHINE_AXI_TABLE_INDEX, index);
  machine_axi_write(base, MACHINE_AXI_TABLE_LOW, low);
  machine_axi_write(base, MACHINE_AXI_TABLE_STEP, step);
}

/* Begins a frame of this size; where everything lies has been written. */
static inline void machine_axi_begin(uintptr_t base, uint32_t columns, uint32_t rows) {
  machine_axi_write(base, MACHINE_AXI_SIZE, rows << 16 | columns);
  machine_axi_write(base, MACHINE_AXI_CONTROL, MACHINE_AXI_CONTROL_BEGIN);
}

#endif
