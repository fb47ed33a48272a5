/* Splat primitive behind AXI4-Stream and AXI4-Lite. Registers are 32 bits; a write elsewhere is answered and does nothing, a read elsewhere gives 0.
   Written by registers.py from registers.json. */
#ifndef SPLAT_AXI_H
#define SPLAT_AXI_H

#include <stdint.h>

/* Writing begins or ends a tile; reading gives the state. (read-write) */
#define SPLAT_AXI_CONTROL 0x00u
/* Write 1: begin a tile with the window in first and last. Read: 1 while a begin waits for the tile before. */
#define SPLAT_AXI_CONTROL_BEGIN 0x1u
/* Write 1: end the tile; while none has begun, or is to begin, this does nothing. Read: 1 while an end waits for packets under way. */
#define SPLAT_AXI_CONTROL_END 0x2u
/* Read: every pixel is written and known to be. */
#define SPLAT_AXI_CONTROL_IDLE 0x4u
/* Read: no splat, row or pixel is under way before the tile buffer. */
#define SPLAT_AXI_CONTROL_RASTER_IDLE 0x8u
/* Version of packets that are taken. (read-only) */
#define SPLAT_AXI_VERSION 0x04u
/* Window of the next tile, within one aligned block of 32 x 32 pixels and from its first column and row on. (read-write) */
#define SPLAT_AXI_FIRST 0x08u
/* First column. */
#define SPLAT_AXI_FIRST_COLUMN 0xffffu
/* First row. */
#define SPLAT_AXI_FIRST_ROW 0xffff0000u
/* One past the window's end. (read-write) */
#define SPLAT_AXI_LAST 0x0cu
/* One past the last column. */
#define SPLAT_AXI_LAST_COLUMN 0xffffu
/* One past the last row. */
#define SPLAT_AXI_LAST_ROW 0xffff0000u
/* Largest opacity, UQ1.alpha (BlendConstants::alpha_max of the kernel). (write-only) */
#define SPLAT_AXI_ALPHA_MAX 0x10u
/* A pixel is finished when its transmittance is at most this, UQ1.transmittance (BlendConstants::minimum_transmittance). (write-only) */
#define SPLAT_AXI_MINIMUM_TRANSMITTANCE 0x14u
/* Low word of the smallest product of peak and kernel that is drawn, UQ4.(peak + weight) (BlendConstants::opacity_min). (write-only) */
#define SPLAT_AXI_LEAST 0x18u
/* High word of least. (write-only) */
#define SPLAT_AXI_LEAST_HIGH 0x1cu
/* Rules of one bit. (write-only) */
#define SPLAT_AXI_FLAGS 0x20u
/* The splat that would finish a pixel is left out. */
#define SPLAT_AXI_FLAGS_OMIT_FINISHING 0x1u
/* The footprint table ends at r = 16 instead of r = 4. */
#define SPLAT_AXI_FLAGS_WIDE_TABLE 0x2u
/* Entry of the footprint table that is written next. (write-only) */
#define SPLAT_AXI_TABLE_INDEX 0x24u
/* Kernel at the entry's left end, UQ1.weight. (write-only) */
#define SPLAT_AXI_TABLE_LOW 0x28u
/* Step down to the kernel at its right end; writing it writes the entry and goes to the next. (write-only) */
#define SPLAT_AXI_TABLE_STEP 0x2cu
/* Packets taken. (read-only) */
#define SPLAT_AXI_PACKETS 0x30u
/* Packets of another version, dropped; counted modulo 65536. (read-only) */
#define SPLAT_AXI_FOREIGN 0x34u
/* Packets whose tlast came too early or too late, dropped whole. (read-only) */
#define SPLAT_AXI_BROKEN 0x38u
/* Pixels read out. (read-only) */
#define SPLAT_AXI_PIXELS 0x3cu
/* Cycles of the clock since reset. (read-only) */
#define SPLAT_AXI_CYCLES 0x40u

static inline uint32_t splat_axi_read(uintptr_t base, uint32_t offset) { return *(volatile const uint32_t *)(base + offset); }
static inline void splat_axi_write(uintptr_t base, uint32_t offset, uint32_t value) { *(volatile uint32_t *)(base + offset) = value; }

/* Begins the tile of columns first .. last and rows top .. end (each one past the last); its packets follow on the stream. */
static inline void splat_axi_begin(uintptr_t base, uint32_t first, uint32_t top, uint32_t last, uint32_t end) {
  splat_axi_write(base, SPLAT_AXI_FIRST, top << 16 | first);
  splat_axi_write(base, SPLAT_AXI_LAST, end << 16 | last);
  splat_axi_write(base, SPLAT_AXI_CONTROL, SPLAT_AXI_CONTROL_BEGIN);
}

/* Writes an entry of the footprint table. */
static inline void splat_axi_table(uintptr_t base, uint32_t index, uint32_t low, uint32_t step) {
  splat_axi_write(base, SPLAT_AXI_TABLE_INDEX, index);
  splat_axi_write(base, SPLAT_AXI_TABLE_LOW, low);
  splat_axi_write(base, SPLAT_AXI_TABLE_STEP, step);
}

#endif
