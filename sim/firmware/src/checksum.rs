//! FNV-1a over 32-bit words: order and value of every word count.

/// A checksum in progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum(u32);

impl Default for Checksum {
    fn default() -> Self {
        Checksum(0x811c_9dc5)
    }
}

impl Checksum {
    /// Takes one word in.
    pub fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0193);
    }

    /// The checksum of all words so far.
    pub fn value(self) -> u32 {
        self.0
    }
}
