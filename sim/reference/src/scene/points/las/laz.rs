//! Packed records, unpacked by the crate `laz` chunk by chunk.
//!
//! What it would set aside on the file's word is checked first: the layers of a chunk must lie in the file before they
//! are unpacked, and the table of chunks, which only seeking needs, is never read. A point may cost as little as a bit
//! or two, so the count is bounded by the file's size. Damaged layers trip the crate's own assertions (debug builds)
//! and checks of places (all builds); such a panic is caught here, at its border, and becomes the message that the file
//! is damaged.

use super::LasHeader;
use crate::scene::bytes::{Reader, truncated};
use crate::scene::error::Problem;
use anyhow::{anyhow, bail, ensure};
use laz::record::{
    LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor,
};
use laz::{LazItemType, LazVlr};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most points per byte of the file.
const MOST_PER_BYTE: u64 = 64;
/// Bytes of the number that leads to the table of chunks.
const TABLE_OFFSET: usize = 8;
/// A chunk size that says: look into the table.
const VARIABLE: u32 = u32::MAX;

type LazBytes<'a> = Cursor<&'a [u8]>;

/// Refuses a count that the file cannot hold.
pub(super) fn check_count(bytes: &[u8], header: &LasHeader) -> Result<(), Problem> {
    let possible = (bytes.len() as u64).saturating_mul(MOST_PER_BYTE);
    ensure!(
        header.count <= possible,
        "LAS header, point count: {} points cannot be in {} bytes; \
         correct it or fetch the file again",
        header.count,
        bytes.len()
    );
    Ok(())
}

/// Calls `point` with every record.
pub(super) fn unpack(
    bytes: &[u8],
    header: &LasHeader,
    point: &mut dyn FnMut(&[u8]),
) -> Result<(), Problem> {
    let vlr = description(bytes, header)?;
    let first = header.first_record + TABLE_OFFSET;
    let chunked = match bytes.get(first..) {
        Some(chunked) => chunked,
        None => return Err(truncated("point records", first as u64, bytes.len())),
    };
    let mut source = Cursor::new(chunked);
    let mut record = vec![0; header.record_bytes];
    let mut left = header.count;
    while left > 0 {
        let in_chunk = left.min(chunk_size(&vlr, &source)?);
        if in_chunk == 0 {
            return Err(damaged("a chunk without points"));
        }
        let whole = catch_unwind(AssertUnwindSafe(|| {
            unpack_chunk(&vlr, source, in_chunk, &mut record, point)
        }));
        source = whole.unwrap_or_else(|_| Err(damaged("its unpacker gave up")))?;
        left -= in_chunk;
    }
    Ok(())
}

/// Unpacks so many points; what follows them.
fn unpack_chunk<'a>(
    vlr: &LazVlr,
    source: LazBytes<'a>,
    count: u64,
    record: &mut [u8],
    point: &mut dyn FnMut(&[u8]),
) -> Result<LazBytes<'a>, Problem> {
    let mut chunk = decompressor(vlr, source)?;
    for _ in 0..count {
        chunk
            .decompress_next(record)
            .map_err(|error| damaged(&error.to_string()))?;
        point(record);
    }
    Ok(chunk.box_into_inner())
}

fn damaged(reason: &str) -> Problem {
    anyhow!("packed points: they are damaged or truncated ({reason}); fetch the file again")
}

/// The record that says how the points are packed, checked against the header.
fn description(bytes: &[u8], header: &LasHeader) -> Result<LazVlr, Problem> {
    let mut reader = Reader::new(bytes);
    reader.take(header.header_bytes, "LAS header")?;
    for _ in 0..header.variable_records {
        reader.take(2, "variable length record")?;
        let user: [u8; 16] = reader.array("variable length record")?;
        let id: u16 = reader.little("variable length record")?;
        let length: u16 = reader.little("variable length record")?;
        reader.take(32, "variable length record")?;
        let data = reader.take(length.into(), "variable length record")?;
        if user.starts_with(LazVlr::USER_ID.as_bytes()) && id == LazVlr::RECORD_ID {
            return checked(data, header);
        }
    }
    bail!(
        "LAS header, variable length records: none says how the points are packed; \
         fetch the file again, or unpack it to .las"
    )
}

fn checked(data: &[u8], header: &LasHeader) -> Result<LazVlr, Problem> {
    let vlr = LazVlr::from_buffer(data).map_err(|error| damaged(&error.to_string()))?;
    let fix = "unpack the file to .las";
    let size = record_size(&vlr);
    ensure!(
        !vlr.items().is_empty() && size == header.record_bytes,
        "LAS header, packed record length: {size} bytes beside records of {}; {fix}",
        header.record_bytes
    );
    let sizes = vlr
        .items()
        .iter()
        .all(|item| item_size(item.item_type()) == item.size());
    let versions = vlr.items().iter().map(|item| item.version());
    let layered = vlr.items()[0].version() >= 3;
    ensure!(
        sizes
            && versions
                .into_iter()
                .all(|version| (version >= 3) == layered),
        "LAS header, packed items: their sizes or versions do not fit; {fix}"
    );
    let size = vlr.chunk_size();
    // Compressor 2 of the description; 1 is one chunk without a table, of the years before 2011.
    let is_chunked = data.first_chunk() == Some(&2u16.to_le_bytes());
    ensure!(
        size != 0 && (layered || is_chunked && size != VARIABLE),
        "LAS header, packed chunks: chunks of {size}; {fix}"
    );
    Ok(vlr)
}

/// Bytes of a record, summed here: the crate's sum has 16 bits, which damaged sizes overflow.
fn record_size(vlr: &LazVlr) -> usize {
    vlr.items()
        .iter()
        .map(|item| usize::from(item.size()))
        .sum()
}

/// Bytes that an item must have: what the crate unpacks into.
fn item_size(item: LazItemType) -> u16 {
    match item {
        LazItemType::Point10 => 20,
        LazItemType::GpsTime => 8,
        LazItemType::RGB12 | LazItemType::RGB14 => 6,
        LazItemType::WavePacket13 | LazItemType::WavePacket14 => 29,
        LazItemType::Point14 => 30,
        LazItemType::RGBNIR14 => 8,
        LazItemType::Byte(count) | LazItemType::Byte14(count) => count,
    }
}

/// Layers of a chunk of each kind of item.
fn layers(item: LazItemType) -> u64 {
    match item {
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(count) => count.into(),
        _ => 1,
    }
}

/// Points of the chunk that begins here. A layered one says it itself, and its layers must be there.
fn chunk_size(vlr: &LazVlr, source: &LazBytes) -> Result<u64, Problem> {
    if vlr.items()[0].version() < 3 {
        return Ok(vlr.chunk_size().into());
    }
    let rest = source.get_ref().get(source.position() as usize..);
    let mut reader = Reader::new(rest.unwrap_or_default());
    let field = "packed points";
    reader.take(record_size(vlr), field)?;
    let count: u32 = reader.little(field)?;
    let layers: u64 = vlr
        .items()
        .iter()
        .map(|item| layers(item.item_type()))
        .sum();
    let mut needed = 0u64;
    for _ in 0..layers {
        needed += u64::from(reader.little::<u32, _>(field)?);
    }
    if needed > reader.remaining() as u64 {
        Err(truncated(field, needed, reader.remaining()))
    } else {
        Ok(count.into())
    }
}

fn decompressor<'a>(
    vlr: &LazVlr,
    source: LazBytes<'a>,
) -> Result<Box<dyn RecordDecompressor<LazBytes<'a>> + 'a>, Problem> {
    let mut chunk: Box<dyn RecordDecompressor<LazBytes<'a>> + 'a> = match vlr.items()[0].version() {
        ..3 => Box::new(SequentialPointRecordDecompressor::new(source)),
        _ => Box::new(LayeredPointRecordDecompressor::new(source)),
    };
    let unknown = |error: laz::LasZipError| damaged(&error.to_string());
    chunk.set_fields_from(vlr.items()).map_err(unknown)?;
    Ok(chunk)
}
