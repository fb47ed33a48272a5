//! Reading bytes that come from strangers: every access is bounded and nothing is allocated on a header's word alone.
//!
//! Plain data must be there before it is counted; compressed data may claim at most what deflate can unpack from the
//! bytes at hand ([`MAX_DEFLATE_RATIO`]), and unpacking stops one byte past the claim. Memory is therefore bounded by
//! the file's size.

use std::cmp::Ordering;
use std::fmt::Display;
use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};
use num_traits::FromBytes;
use ruzstd::decoding::StreamingDecoder;

use super::error::{Problem, shorten};
use crate::memory;
use anyhow::{Context, anyhow, bail, ensure};

/// Deflate cannot expand further than this (258 bytes out of 2 bits, rounded up).
const MAX_DEFLATE_RATIO: u64 = 1040;

/// A cursor over a file's bytes.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Reader { rest: bytes }
    }

    /// Bytes not yet taken.
    pub(crate) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next `count` bytes; `field` names them in the error.
    pub(crate) fn take(&mut self, count: usize, field: &str) -> Result<&'a [u8], Problem> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or_else(|| truncated(field, count as u64, self.rest.len()))?;
        self.rest = rest;
        Ok(taken)
    }

    /// The next `N` bytes as an array.
    pub(crate) fn array<const N: usize>(&mut self, field: &str) -> Result<[u8; N], Problem> {
        let taken = self.take(N, field)?;
        Ok(taken.first_chunk().copied().unwrap_or([0; N]))
    }

    /// The next number, least significant byte first.
    pub(crate) fn little<T, const N: usize>(&mut self, field: &str) -> Result<T, Problem>
    where
        T: FromBytes<Bytes = [u8; N]>,
    {
        Ok(T::from_le_bytes(&self.array(field)?))
    }

    /// The bytes before the next zero byte, which is taken as well.
    pub(crate) fn up_to_zero(&mut self, field: &str) -> Result<&'a [u8], Problem> {
        let mut parts = self.rest.splitn(2, |byte| *byte == 0);
        let (text, rest) = (parts.next().unwrap_or_default(), parts.next());
        self.rest = rest.ok_or_else(|| truncated(field, text.len() as u64 + 1, text.len()))?;
        Ok(text)
    }

    /// `count` records of `record_bytes` each, refused at once if they are not all there.
    pub(crate) fn records(
        &mut self,
        count: u64,
        record_bytes: usize,
        field: &str,
    ) -> Result<&'a [u8], Problem> {
        let needed = checked_bytes(count, record_bytes as u64, field)?;
        match usize::try_from(needed) {
            Ok(length) => self.take(length, field),
            Err(_) => Err(truncated(field, needed, self.rest.len())),
        }
    }
}

/// The number at a place of a record, least significant byte first; what does not lie in it reads as zero.
pub(super) fn little_at<T, const N: usize>(record: &[u8], at: usize) -> T
where
    T: FromBytes<Bytes = [u8; N]>,
{
    let found = record.get(at..).and_then(|rest| rest.first_chunk());
    T::from_le_bytes(found.unwrap_or(&[0; N]))
}

/// The error of a field that needs more bytes than are left.
pub(super) fn truncated(field: &str, needed: u64, found: usize) -> Problem {
    anyhow!(
        "{field}: {needed} bytes are needed but {found} are left; \
         the file is truncated or its counts are wrong"
    )
}

/// `count * each`, or an error naming the field if no machine could hold that.
pub(super) fn checked_bytes(count: u64, each: u64, field: &str) -> Result<u64, Problem> {
    count.checked_mul(each).with_context(|| {
        format!("{field}: {count} elements of {each} bytes; correct the absurd count in the header")
    })
}

/// Unpacks a gzip stream that must hold exactly `expected` bytes, if there is room for them and for so many `more`,
/// which they become.
pub(super) fn gunzip_exact(
    packed: &[u8],
    expected: u64,
    more: u64,
    field: &str,
) -> Result<Vec<u8>, Problem> {
    possible(packed, expected, more, field)?;
    unpacked(MultiGzDecoder::new(packed), expected, "gzip", field)
}

/// The same for a zlib stream; nothing may follow its end.
pub(super) fn unzlib_exact(
    packed: &[u8],
    expected: u64,
    more: u64,
    field: &str,
) -> Result<Vec<u8>, Problem> {
    possible(packed, expected, more, field)?;
    let mut decoder = ZlibDecoder::new(packed);
    let bytes = unpacked(&mut decoder, expected, "zlib", field)?;
    nothing_behind(packed.len() as u64 - decoder.total_in(), "zlib", field)?;
    Ok(bytes)
}

/// Refuses a claim that deflate cannot keep, or for which there is no room, before anything is unpacked.
fn possible(packed: &[u8], expected: u64, more: u64, field: &str) -> Result<(), Problem> {
    let length = packed.len();
    let possible = (length as u64).saturating_mul(MAX_DEFLATE_RATIO);
    ensure!(
        expected <= possible,
        "{field}: the header claims {expected} bytes, but {length} packed bytes hold at most \
         {possible}; correct the count in the header or fetch the file again"
    );
    Ok(memory::room_for(
        expected.saturating_add(more),
        field,
        memory::FIX,
    )?)
}

/// All that a decoder gives, which must be exactly so many bytes.
fn unpacked(
    decoder: impl Read,
    expected: u64,
    packing: &str,
    field: &str,
) -> Result<Vec<u8>, Problem> {
    let mut bytes = memory::list(expected + 1, field)?;
    // One byte more than expected tells "too long" apart from "exact", and makes the decoder read to the end and check
    // its trailer.
    let read = decoder.take(expected + 1).read_to_end(&mut bytes);
    read.map_err(|error| damaged(packing, field, error))?;
    match (bytes.len() as u64).cmp(&expected) {
        Ordering::Less => Err(truncated(field, expected, bytes.len())),
        Ordering::Equal => Ok(bytes),
        Ordering::Greater => bail!(
            "{field}: more than the {expected} bytes that the header justifies; correct the header"
        ),
    }
}

/// The first `limit` bytes of a gzip stream, fewer if it ends before.
pub(super) fn gunzip_at_most(packed: &[u8], limit: u64, field: &str) -> Result<Vec<u8>, Problem> {
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(packed)
        .take(limit)
        .read_to_end(&mut unpacked);
    read.map_err(|error| damaged("gzip", field, error))?;
    Ok(unpacked)
}

/// The error of a packed part that does not unpack.
fn damaged(packing: &str, field: &str, error: impl Display) -> Problem {
    anyhow!("{field}: the {packing} stream is damaged or truncated ({error}); fetch the file again")
}

fn nothing_behind(left: u64, packing: &str, field: &str) -> Result<(), Problem> {
    match left {
        0 => Ok(()),
        left => Err(damaged(
            packing,
            field,
            format!("{left} bytes follow its end"),
        )),
    }
}

/// Largest window of a zstd stream: what the decoder sets aside before a byte has been unpacked.
const MAX_ZSTD_WINDOW: u64 = 1 << 26;

/// Unpacks a zstd stream that must hold exactly `expected` bytes; the caller has bounded that by the file's size.
pub(super) fn unzstd_exact(
    mut packed: &[u8],
    expected: u64,
    field: &str,
) -> Result<Vec<u8>, Problem> {
    if expected == 0 && packed.is_empty() {
        return Ok(Vec::new());
    }
    let window = MAX_ZSTD_WINDOW.min(expected.max(1 << 20));
    let decoder = StreamingDecoder::new_with_max_window_size(&mut packed, window)
        .map_err(|error| damaged("zstd", field, error))?;
    let bytes = unpacked(decoder, expected, "zstd", field)?;
    nothing_behind(packed.len() as u64, "zstd", field)?;
    Ok(bytes)
}

/// A word of a text as a number; `place` says where it stands.
pub(super) fn number(word: &str, place: impl FnOnce() -> String) -> Result<f64, Problem> {
    word.parse().map_err(|_| {
        let (place, shown) = (place(), shorten(word));
        anyhow!("{place}: '{shown}' is no number; write a number such as 0.5")
    })
}

/// Bytes behind what a header counts mean that it counts wrongly.
pub(crate) fn nothing_left(left: usize, field: &str, last: &str, fix: &str) -> Result<(), Problem> {
    ensure!(
        left == 0,
        "{field}: {left} bytes are left over after the last {last}; {fix}"
    );
    Ok(())
}

/// Byte order of multi-byte numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

/// Number types that formats store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// Stored size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// The number stored in the first [`Self::size`] bytes of `stored`; missing bytes read as zero.
    pub(super) fn decode(self, stored: &[u8], endian: Endian) -> f64 {
        let mut bytes = [0u8; 8];
        let little = &mut bytes[..self.size()];
        for (target, byte) in little.iter_mut().zip(stored) {
            *target = *byte;
        }
        if endian == Endian::Big {
            little.reverse();
        }
        let [b0, b1, b2, b3, ..] = bytes;
        match self {
            Scalar::I8 => i8::from_le_bytes([b0]).into(),
            Scalar::U8 => b0.into(),
            Scalar::I16 => i16::from_le_bytes([b0, b1]).into(),
            Scalar::U16 => u16::from_le_bytes([b0, b1]).into(),
            Scalar::I32 => i32::from_le_bytes([b0, b1, b2, b3]).into(),
            Scalar::U32 => u32::from_le_bytes([b0, b1, b2, b3]).into(),
            Scalar::F32 => f32::from_le_bytes([b0, b1, b2, b3]).into(),
            Scalar::I64 => i64::from_le_bytes(bytes) as f64,
            Scalar::U64 => u64::from_le_bytes(bytes) as f64,
            Scalar::F64 => f64::from_le_bytes(bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::damage_tests::{assert_refused, gzip};
    use super::*;

    #[test]
    fn numbers_are_read_in_both_byte_orders() {
        assert_eq!(Scalar::I16.decode(&[0xfe, 0xff], Endian::Little), -2.0);
        assert_eq!(Scalar::I16.decode(&[0xff, 0xfe], Endian::Big), -2.0);
        assert_eq!(Scalar::U32.decode(&[0, 0, 1, 2], Endian::Big), 258.0);
        assert_eq!(Scalar::F32.decode(&1.5f32.to_be_bytes(), Endian::Big), 1.5);
        assert_eq!(
            Scalar::F64.decode(&(-0.1f64).to_le_bytes(), Endian::Little),
            -0.1
        );
    }

    #[test]
    fn a_gzip_bomb_stops_at_the_size_the_header_justifies() {
        let bomb = gzip(&vec![0; 4_000_000]);
        for (claim, expected) in [
            (1000, "data: more than the 1000 bytes that the header"),
            (1 << 40, "data: the header claims 1099511627776 bytes"),
        ] {
            assert_refused(&[(&bomb, expected)], |b| gunzip_exact(b, claim, 0, "data"));
        }
    }
}
