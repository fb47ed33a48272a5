//! SHA-256: tells whether two things are the same without keeping either. The build script digests the sources by it as
//! well.

use sha2::{Digest as _, Sha256};

/// Takes bytes in any portions.
#[derive(Default)]
pub struct Digest(Sha256);

impl Digest {
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// A piece with its length before it, so that no two lists of pieces are the same bytes.
    pub fn piece(&mut self, bytes: &[u8]) {
        self.add(&(bytes.len() as u64).to_le_bytes());
        self.add(bytes);
    }

    /// 64 hexadecimal digits.
    pub fn finish(self) -> String {
        let digits = |byte: u8| format!("{byte:02x}");
        self.0.finalize().into_iter().map(digits).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An example of FIPS 180-2, appendix B, and the borders of pieces.
    #[test]
    fn it_is_sha_256_and_pieces_have_borders() {
        let digest = |pieces: &[&[u8]]| {
            let mut digest = Digest::default();
            pieces.iter().for_each(|piece| digest.piece(piece));
            digest.finish()
        };
        assert_ne!(digest(&[b"ab", b"c"]), digest(&[b"a", b"bc"]));
        let mut digest = Digest::default();
        digest.add(b"a");
        digest.add(b"bc");
        assert_eq!(
            digest.finish(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
