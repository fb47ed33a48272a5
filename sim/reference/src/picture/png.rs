//! PNG files by the crate `png`: written with given samples, and read whatever their depth and colour type.

use crate::memory;
use anyhow::{Context, Result, ensure};
use png::{
    BitDepth, ColorType, Compression, Decoder, Encoder, Limits, OutputInfo, Transformations,
};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Bytes of pixels of a file at most; what it claims is not set aside beyond that.
const LARGEST: usize = 512 << 20;

/// The bytes of a file of opaque pixels of three bytes.
pub fn encode_rgb8(size: [usize; 2], bytes: &[u8]) -> Result<Vec<u8>> {
    encode(size, ColorType::Rgb, BitDepth::Eight, bytes)
}

/// The bytes of a file of these columns and rows from its samples, row by row, most significant byte first; too few or
/// too many of them for the size are an error.
pub fn encode(
    size: [usize; 2],
    colour: ColorType,
    depth: BitDepth,
    bytes: &[u8],
) -> Result<Vec<u8>> {
    // Sizes beyond 32 bits cannot be allocated; saturation makes the encoder refuse them.
    let size = size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let mut file = Vec::new();
    let mut writer = encoder(&mut file, size, colour, depth).write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(file)
}

fn encoder(
    file: &mut Vec<u8>,
    [width, height]: [u32; 2],
    colour: ColorType,
    depth: BitDepth,
) -> Encoder<'_, &mut Vec<u8>> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder
}

/// The bytes of one file that shows these files one after the other, for ever; their samples stay as they are.
pub fn animated(frames: &[PathBuf], per_second: u16) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    let Some((first, others)) = frames.split_first() else {
        return Ok(file);
    };
    let (info, samples) = samples_of(first)?;
    let size = [info.width, info.height];
    let mut encoder = encoder(&mut file, size, info.color_type, info.bit_depth);
    encoder.set_animated(u32::try_from(frames.len()).unwrap_or(u32::MAX), 0)?;
    encoder.set_frame_delay(1, per_second)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&samples)?;
    for frame in others {
        let (other, samples) = samples_of(frame)?;
        ensure!(
            [other.width, other.height] == size,
            "'{}' has another size than the first frame, and an animation has one: give --size",
            frame.display()
        );
        writer.write_image_data(&samples)?;
    }
    writer.finish()?;
    Ok(file)
}

/// A file's samples as they stand.
fn samples_of(file: &Path) -> Result<(OutputInfo, Vec<u8>)> {
    let bytes = std::fs::read(file)?;
    let mut reader = Decoder::new(Cursor::new(&bytes)).read_info()?;
    let mut samples = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut samples)?;
    Ok((info, samples))
}

/// Columns and rows of a file of any depth and colour type, and its pixels row by row: red, green, blue, not
/// premultiplied, and opacity, of 16 bits, which hold 8-bit values without loss (v / 255 = 257 v / 65535).
pub fn decode(file: &[u8]) -> Result<([usize; 2], Vec<[u16; 4]>)> {
    let limits = Limits { bytes: LARGEST };
    let mut decoder = Decoder::new_with_limits(Cursor::new(file), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let [width, height] = [reader.info().width, reader.info().height];
    let bytes = reader.output_buffer_size().filter(|size| *size <= LARGEST);
    let too_large = || format!("{width} x {height} pixels are more than 512 MB");
    let bytes = bytes.with_context(too_large)?;
    // The samples, and the pixels that they become.
    let count = u64::from(width) * u64::from(height);
    let what = format!("a picture of {width} x {height} pixels");
    memory::room_for(
        bytes as u64 + count * size_of::<[u16; 4]>() as u64,
        &what,
        memory::FIX,
    )?;
    let mut samples = vec![0; bytes];
    let frame = reader.next_frame(&mut samples)?;
    let channels = frame.color_type.samples();
    let pixels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let words = samples.as_chunks().0.chunks_exact(channels);
            let pixel = |pixel: &[[u8; 2]]| rgba(channels, |c| u16::from_be_bytes(pixel[c]));
            words.map(pixel).collect()
        }
        _ => samples
            .chunks_exact(channels)
            .map(|pixel| rgba(channels, |c| 257 * u16::from(pixel[c])))
            .collect(),
    };
    Ok(([width as usize, height as usize], pixels))
}

/// One channel is grey, an even number of them has opacity last.
fn rgba(channels: usize, sample: impl Fn(usize) -> u16) -> [u16; 4] {
    match channels {
        1 => [sample(0), sample(0), sample(0), u16::MAX],
        2 => [sample(0), sample(0), sample(0), sample(1)],
        3 => [sample(0), sample(1), sample(2), u16::MAX],
        _ => [sample(0), sample(1), sample(2), sample(3)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageFormat};

    /// Frames come out of another crate's reader as they were, and sizes that differ are refused.
    #[test]
    fn frames_of_an_animation_are_the_files() {
        use image::AnimationDecoder;
        let folder = tempfile::tempdir().unwrap();
        let path = |number: usize| folder.path().join(format!("{number}.png"));
        for number in 0..3 {
            let bytes: Vec<u8> = (0..5 * 4 * 3).map(|k| (k * (number + 7)) as u8).collect();
            let file = encode_rgb8([5, 4], &bytes).unwrap();
            std::fs::write(path(number), file).unwrap();
        }
        let file = animated(&[path(0), path(1), path(2)], 15).unwrap();
        let decoder = image::codecs::png::PngDecoder::new(Cursor::new(&file)).unwrap();
        let frames = decoder
            .apng()
            .unwrap()
            .into_frames()
            .collect_frames()
            .unwrap();
        assert_eq!(frames.len(), 3);
        for (number, frame) in frames.iter().enumerate() {
            let expected = image::open(path(number)).unwrap().to_rgba8();
            assert_eq!(frame.buffer(), &expected);
            let (milliseconds, parts) = frame.delay().numer_denom_ms();
            assert!((f64::from(milliseconds) / f64::from(parts) - 1000.0 / 15.0).abs() < 1.0);
        }
        let file = encode_rgb8([1, 1], &[0; 3]).unwrap();
        std::fs::write(path(1), file).unwrap();
        let refused = animated(&[path(0), path(1)], 15).unwrap_err().to_string();
        assert!(refused.contains("1.png' has another size"), "{refused}");
    }

    /// Files by another writer, of every kind that it writes, are read as that writer's own crate reads them.
    #[test]
    fn every_kind_is_read_as_others_read_it() {
        let ramp = |x: u32, y: u32| {
            [
                9000 * x as u16,
                65535 - 5000 * y as u16,
                77,
                41 * (x * y) as u16,
            ]
        };
        let picture = DynamicImage::ImageRgba16(image::ImageBuffer::from_fn(7, 5, |x, y| {
            image::Rgba(ramp(x, y))
        }));
        let kinds = [
            DynamicImage::from(picture.to_luma8()),
            picture.to_luma16().into(),
            picture.to_luma_alpha8().into(),
            picture.to_luma_alpha16().into(),
            picture.to_rgb8().into(),
            picture.to_rgb16().into(),
            picture.to_rgba8().into(),
            picture,
        ];
        for kind in kinds {
            let mut file = Cursor::new(Vec::new());
            kind.write_to(&mut file, ImageFormat::Png).unwrap();
            let (size, read) = decode(file.get_ref()).unwrap();
            assert_eq!(size, [7, 5]);
            let expected: Vec<[u16; 4]> = kind.to_rgba16().pixels().map(|pixel| pixel.0).collect();
            assert_eq!(read, expected, "{:?}", kind.color());
        }
    }

    #[test]
    fn what_others_read_of_a_file_is_what_was_written() {
        let bytes: Vec<u8> = (0..36).map(|byte| 7 * byte).collect();
        let file = encode_rgb8([4, 3], &bytes).unwrap();
        let read = image::load_from_memory_with_format(&file, ImageFormat::Png).unwrap();
        assert_eq!(read.into_rgb8().into_raw(), bytes);
        assert!(encode_rgb8([4, 4], &bytes).is_err());
        assert!(encode_rgb8([4, 2], &bytes).is_err());
        assert!(encode_rgb8([0, 0], &[]).is_err());
    }

    /// A header that claims 17 GB.
    #[test]
    fn claims_are_not_believed() {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, 1 << 16, 1 << 16);
        encoder.set_color(ColorType::Rgba);
        let mut writer = encoder.write_header().unwrap();
        writer.write_chunk(png::chunk::IDAT, &[0x78, 0x9c]).unwrap();
        drop(writer);
        let message = decode(&file).err().unwrap().to_string();
        assert!(message.contains("512 MB"), "{message}");
    }
}
