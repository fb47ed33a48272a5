//! LAS point clouds, versions 1.0 to 1.4, record formats 0 to 10; packed ones (`.laz`) with the feature `laz`.
//!
//! A header of fixed offsets, and records of which the places (three i32, with a scale and an offset per axis), the
//! withheld mark and the colours (16 bits, or 8 bits if none exceeds 255) are used. Own code: the crate `las` brings 14
//! crates, among them dates, time zones and identifiers, for what this reader takes from a record; its packed records
//! come from the crate `laz`, which is used here directly (docs/decisions/dependencies.md).

#[cfg(feature = "laz")]
mod laz;
#[cfg(test)]
mod tests;

use super::{Cloud, Record, full_scale};
use crate::memory;
use crate::scene::bytes::{Endian, Reader, Scalar, truncated};
use crate::scene::error::Problem;
use anyhow::{bail, ensure};

const MAGIC: &[u8; 4] = b"LASF";
/// Bits of the format's number that say "packed".
const PACKED: u8 = 0xc0;
/// Least length of a record of each format, and where its colour begins.
const FORMATS: [(usize, Option<usize>); 11] = [
    (20, None),
    (28, None),
    (26, Some(20)),
    (34, Some(28)),
    (57, None),
    (63, Some(28)),
    (30, None),
    (36, Some(30)),
    (38, Some(30)),
    (59, None),
    (67, Some(30)),
];
/// The first format of the longer records.
const FIRST_LONG: u8 = 6;

/// What a header says of the records.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LasHeader {
    header_bytes: usize,
    first_record: usize,
    variable_records: u32,
    format: u8,
    packed: bool,
    record_bytes: usize,
    count: u64,
    scale: [f64; 3],
    offset: [f64; 3],
}

/// Every point that is not withheld as a record.
pub(super) fn cloud(bytes: &[u8]) -> Result<Cloud, Problem> {
    let header = LasHeader::read(bytes)?;
    let mut points = LasPoints {
        header: &header,
        records: Vec::new(),
        withheld: 0,
    };
    if header.packed {
        #[cfg(not(feature = "laz"))]
        return Err(crate::scene::error::without("laz"));
        #[cfg(feature = "laz")]
        {
            laz::check_count(bytes, &header)?;
            points.records = memory::list(header.count, "the points")?;
            laz::unpack(bytes, &header, &mut |record| points.push(record))?;
        }
    } else {
        let mut reader = Reader::new(bytes);
        reader.take(header.first_record, "LAS header")?;
        let records = reader.records(header.count, header.record_bytes, "point records")?;
        points.records = memory::list(header.count, "the points")?;
        records
            .chunks_exact(header.record_bytes)
            .for_each(|record| points.push(record));
    }
    Ok(points.finish())
}

impl LasHeader {
    fn read(bytes: &[u8]) -> Result<LasHeader, Problem> {
        ensure!(
            bytes.starts_with(MAGIC),
            "LAS header, magic: it is not LASF; check that this is a .las or .laz file"
        );
        let number = |place: usize, kind: Scalar| match bytes.get(place..place + kind.size()) {
            Some(stored) => Ok(kind.decode(stored, Endian::Little)),
            None => Err(truncated(
                "LAS header",
                (place + kind.size()) as u64,
                bytes.len(),
            )),
        };
        let byte = |place: usize| number(place, Scalar::U8).map(|value| value as u8);
        let (major, minor) = (byte(24)?, byte(25)?);
        ensure!(
            major == 1 && minor <= 4,
            "LAS header, version: it is {major}.{minor}; 1.0 to 1.4 are read; convert the file"
        );
        let stated = byte(104)?;
        let format = stated & !PACKED;
        let record_bytes = number(105, Scalar::U16)? as usize;
        let Some((least, _)) = FORMATS.get(usize::from(format)) else {
            bail!("LAS header, point format: it is {format}; 0 to 10 are read; convert the file");
        };
        ensure!(
            record_bytes >= *least,
            "LAS header, record length: it is {record_bytes}, and format {format} has {least}; \
             write the file again"
        );
        let three = |place: usize| -> Result<[f64; 3], Problem> {
            let at = |axis: usize| number(place + 8 * axis, Scalar::F64);
            Ok([at(0)?, at(1)?, at(2)?])
        };
        let header = LasHeader {
            header_bytes: number(94, Scalar::U16)? as usize,
            first_record: number(96, Scalar::U32)? as usize,
            variable_records: number(100, Scalar::U32)? as u32,
            format,
            packed: stated != format,
            record_bytes,
            // Since 1.4 a longer field counts where the older one says 0.
            count: match number(107, Scalar::U32)? as u64 {
                0 if minor == 4 => number(247, Scalar::U64)? as u64,
                older => older,
            },
            scale: three(131)?,
            offset: three(155)?,
        };
        let least = if minor == 4 { 375 } else { 227 };
        ensure!(
            header.header_bytes >= least && header.first_record >= header.header_bytes,
            "LAS header, sizes: header {}, points at {}; the header's own sizes overlap; \
             write the file again",
            header.header_bytes,
            header.first_record
        );
        Ok(header)
    }
}

/// Records as they come.
struct LasPoints<'a> {
    header: &'a LasHeader,
    records: Vec<Record>,
    withheld: usize,
}

impl LasPoints<'_> {
    fn push(&mut self, record: &[u8]) {
        let flags = match self.header.format {
            ..FIRST_LONG => record.get(15).copied().unwrap_or_default() >> 7,
            _ => record.get(15).copied().unwrap_or_default() >> 2 & 1,
        };
        if flags == 1 {
            self.withheld += 1;
            return;
        }
        let number = |place: usize, kind: Scalar| {
            kind.decode(record.get(place..).unwrap_or_default(), Endian::Little)
        };
        let place = |axis: usize| {
            let stored = number(4 * axis, Scalar::I32);
            stored * self.header.scale[axis] + self.header.offset[axis]
        };
        let (_, colour) = FORMATS[usize::from(self.header.format)];
        self.records.push(Record {
            centre: [0, 1, 2].map(place),
            colour: colour.map(|first| [0, 2, 4].map(|k| number(first + k, Scalar::U16))),
            ..Record::default()
        });
    }

    fn finish(mut self) -> Cloud {
        full_scale(&mut self.records, &[255.0, 65_535.0]);
        let black = |record: &Record| record.colour == Some([0.0; 3]);
        // A format with colours, written by a scanner that has no camera.
        if self.records.iter().all(black) {
            self.records
                .iter_mut()
                .for_each(|record| record.colour = None);
        }
        let notes = match self.withheld {
            0 => Vec::new(),
            count => vec![format!("{count} withheld points are left out")],
        };
        Cloud {
            records: self.records,
            notes,
        }
    }
}
