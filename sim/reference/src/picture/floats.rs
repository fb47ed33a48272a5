//! Pictures as floating-point files, for measuring: nothing is rounded to steps, clamped or divided by alpha.
//!
//! Both formats are plain enough to be written here: an encoder for them would be the largest dependency of this crate
//! for 60 lines. `.npy` (NumPy, version 1.0) holds height x width x 4 doubles, `.exr` (OpenEXR 2, scan lines,
//! uncompressed) the channels A, B, G, R in single precision. Colours are premultiplied, which is what both worlds
//! expect.

use super::Picture;

/// NumPy wants the data to start at a multiple of this.
const NPY_ALIGNMENT: usize = 64;

/// The bytes of a `.npy` file: height x width x 4 little-endian doubles, row by row, R G B A.
pub(super) fn npy(picture: &Picture) -> Vec<u8> {
    let (height, width) = (picture.height, picture.width);
    let mut heading =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({height}, {width}, 4), }}");
    // Magic, version and length take 10 bytes; a newline ends the heading.
    let length = (10 + heading.len() + 1).next_multiple_of(NPY_ALIGNMENT) - 10;
    heading.extend(std::iter::repeat_n(' ', length - 1 - heading.len()));
    heading.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((length as u16).to_le_bytes());
    file.extend(heading.as_bytes());
    file.extend(
        picture
            .pixels
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes()),
    );
    file
}

/// The bytes of an `.exr` file.
pub(super) fn exr(picture: &Picture) -> Vec<u8> {
    let (width, height) = (picture.width, picture.height);
    let mut file = 20_000_630u32.to_le_bytes().to_vec();
    file.extend(2u32.to_le_bytes());
    let window = [0, 0, width as i32 - 1, height as i32 - 1]
        .map(i32::to_le_bytes)
        .concat();
    attribute(&mut file, "channels", "chlist", &channel_list());
    attribute(&mut file, "compression", "compression", &[0]);
    attribute(&mut file, "dataWindow", "box2i", &window);
    attribute(&mut file, "displayWindow", "box2i", &window);
    attribute(&mut file, "lineOrder", "lineOrder", &[0]);
    attribute(&mut file, "pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute(&mut file, "screenWindowCenter", "v2f", &[0; 8]);
    attribute(&mut file, "screenWindowWidth", "float", &1f32.to_le_bytes());
    file.push(0);
    // Each line: its number, its bytes, then one channel after the other.
    let line_bytes = 4 * 4 * width;
    let first = file.len() + 8 * height;
    for y in 0..height {
        file.extend(((first + y * (8 + line_bytes)) as u64).to_le_bytes());
    }
    for (y, line) in picture.pixels.chunks_exact(width.max(1)).enumerate() {
        file.extend((y as i32).to_le_bytes());
        file.extend((line_bytes as i32).to_le_bytes());
        for channel in [3, 2, 1, 0] {
            file.extend(
                line.iter()
                    .flat_map(|pixel| (pixel[channel] as f32).to_le_bytes()),
            );
        }
    }
    file
}

/// Name, type and length before the value.
fn attribute(file: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) {
    for word in [name, kind] {
        file.extend(word.as_bytes());
        file.push(0);
    }
    file.extend((value.len() as i32).to_le_bytes());
    file.extend(value);
}

/// Four channels of single precision in alphabetical order, as the format demands.
fn channel_list() -> Vec<u8> {
    let mut list = Vec::new();
    for name in ["A", "B", "G", "R"] {
        list.extend(name.as_bytes());
        list.push(0);
        // Single precision; not perceptually linear and three reserved bytes; one sample per pixel.
        list.extend([2, 0, 1, 1].map(i32::to_le_bytes).concat());
    }
    list.push(0);
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        Picture {
            width: 3,
            height: 2,
            pixels: (0..6)
                .map(|i| [f64::from(i), -0.5, 1e-9, 0.1 * f64::from(i)])
                .collect(),
        }
    }

    /// The heading as NumPy's own writer makes it.
    #[test]
    fn npy_is_a_heading_and_the_doubles() {
        let file = npy(&picture());
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        let length = usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!((10 + length) % 64, 0);
        let heading = std::str::from_utf8(&file[10..10 + length]).unwrap();
        assert!(
            heading.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 4), }  ")
                && heading.ends_with(" \n"),
            "{heading:?}"
        );
        let (doubles, rest) = file[10 + length..].as_chunks::<8>();
        let values: Vec<f64> = doubles
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes))
            .collect();
        assert_eq!(values, picture().pixels.concat());
        assert!(rest.is_empty());
    }

    /// The last line's place is stated in the table, and its first channel is A.
    #[test]
    fn exr_lines_are_where_the_table_says() {
        let file = exr(&picture());
        assert_eq!(&file[..8], &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
        let line = 8 + 3 * 4 * 4;
        let table = file.len() - 2 * line - 16;
        let place = u64::from_le_bytes(*file[table + 8..].first_chunk().unwrap()) as usize;
        assert_eq!(place, file.len() - line);
        assert_eq!(file[place..place + 4], 1i32.to_le_bytes());
        assert_eq!(file[place + 8..place + 12], 0.3f32.to_le_bytes());
        assert_eq!(
            file[place + 8 + 3 * 12..place + 8 + 3 * 12 + 4],
            3f32.to_le_bytes()
        );
    }
}
