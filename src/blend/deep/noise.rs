//! Noise for dithered rounding: a hash of pixel position and layer, so that no pixel keeps a generator's state.
//!
//! The same pixel and layer always round the same way: pictures are repeatable, and independent of tiles and threads.
//! The mixer is C. Wellons' `lowbias32` (two multiplications, three shifts), whose avalanche bias is 0.11 of 32 bits
//! in a thousand; multiplying each coordinate by its own odd constant keeps (x, y, layer) and (y, x, layer) apart.

/// 32 uniform bits for pixel (x, y) and the number of the layer. Wrapping throughout.
#[inline(always)]
pub const fn noise(x: u16, y: u16, layer: u32) -> u32 {
    let place = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    mix(mix(place ^ 0x5bd1_e995) ^ layer.wrapping_mul(0xc2b2_ae3d))
}

#[inline(always)]
const fn mix(mut word: u32) -> u32 {
    word ^= word >> 16;
    word = word.wrapping_mul(0x21f0_aaad);
    word ^= word >> 15;
    word = word.wrapping_mul(0xd35a_2d97);
    word ^ (word >> 15)
}
