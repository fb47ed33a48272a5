//! 3D Gaussians of a PLY file part by part, for scenes larger than memory.
//!
//! The same records through the same columns and the same builder as [`load`](super::load), so that a part's splats are the whole scene's, in
//! its order. Only files whose records can be found without reading those before are taken: binary ones with nothing but Gaussians.

use super::super::bytes::{Endian, Scalar, checked_bytes, truncated};
use super::super::error::{LoadError, Problem};
use super::super::gaussian::{CAPTURE_UP, GaussianScene, coefficient_count};
use super::super::{Scene, load::is_ply};
use super::header::{self, Element, PlyEncoding, PropertyKind};
use super::{GaussianColumns, vertex_element};
use crate::rules::Rules;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// No header is longer: 80 properties take some 2 KB.
const LONGEST_HEADER: u64 = 1 << 20;

/// A PLY file of Gaussians that is read part by part.
#[derive(Debug)]
pub struct GaussianFile {
    path: PathBuf,
    /// Where the first record begins.
    body: u64,
    count: u64,
    scalars: Vec<Scalar>,
    endian: Endian,
    columns: GaussianColumns,
}

/// The parts of a file, in its order.
pub struct FileParts<'a> {
    file: &'a GaussianFile,
    reader: BufReader<File>,
    left: u64,
    size: usize,
}

impl GaussianFile {
    /// Reads the header. The error says which files can be read part by part if this one cannot.
    pub fn open(path: &Path) -> Result<Self, LoadError> {
        GaussianFile::read_header(path).map_err(|problem| problem.of(path.display().to_string()))
    }

    fn read_header(path: &Path) -> Result<Self, Problem> {
        if !is_ply(path) {
            return Err(not_in_parts("it is no .ply file"));
        }
        let mut file = File::open(path)?;
        crate::input::note(path);
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(Problem::NotAFile);
        }
        let mut head = Vec::new();
        file.by_ref().take(LONGEST_HEADER).read_to_end(&mut head)?;
        let (header, rest) = header::parse(&head)?;
        let vertex = vertex_element(&header.elements)?;
        if vertex.column("packed_position").is_some() {
            return Err(not_in_parts("its Gaussians are packed in groups"));
        }
        let PlyEncoding::Binary(endian) = header.format else {
            return Err(not_in_parts("it is text"));
        };
        let filled = |element: &&Element| !element.properties.is_empty();
        if header.elements.iter().filter(filled).count() > 1 {
            return Err(not_in_parts("it has more elements than 'vertex'"));
        }
        let scalars: Option<Vec<Scalar>> = vertex
            .properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Number(scalar) => Some(scalar),
                PropertyKind::List { .. } => None,
            })
            .collect();
        let body = (head.len() - rest.len()) as u64;
        let found = GaussianFile {
            path: path.to_owned(),
            body,
            count: vertex.count,
            scalars: scalars.ok_or_else(|| not_in_parts("its element 'vertex' has lists"))?,
            endian,
            columns: GaussianColumns::find(vertex)?,
        };
        found.check_length(metadata.len() - body)?;
        Ok(found)
    }

    /// Neither fewer bytes than the records take nor more.
    fn check_length(&self, left: u64) -> Result<(), Problem> {
        let field = format!("element vertex, {} records", self.count);
        let needed = checked_bytes(self.count, self.record_bytes() as u64, &field)?;
        if needed > left {
            return Err(truncated(&field, needed, left as usize));
        }
        match left - needed {
            0 => Ok(()),
            extra => Err(Problem::malformed(
                "PLY body",
                format!("{extra} bytes are left over after the last record"),
                "correct the counts or types in the header",
            )),
        }
    }

    fn record_bytes(&self) -> usize {
        self.scalars.iter().map(|scalar| scalar.size()).sum()
    }

    /// Records, those included that cannot be drawn.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// File name without folders.
    pub fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// The default camera's up direction.
    pub fn up(&self) -> [f64; 3] {
        CAPTURE_UP
    }

    /// The rules that Gaussians are meant for.
    pub fn natural_rules(&self) -> Rules {
        Rules::GAUSSIAN_3D
    }

    /// Reads the file from its start in parts of so many records, at least 1.
    pub fn parts(&self, size: usize) -> Result<FileParts<'_>, LoadError> {
        let open = || {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(self.body))?;
            Ok(BufReader::with_capacity(1 << 20, file))
        };
        Ok(FileParts {
            file: self,
            reader: open().map_err(|error| self.error(error))?,
            left: self.count,
            size: size.max(1),
        })
    }

    fn error(&self, error: std::io::Error) -> LoadError {
        Problem::Unreadable(error).of(self.path.display().to_string())
    }
}

impl Iterator for FileParts<'_> {
    type Item = Result<Scene, LoadError>;

    /// The next part; it holds fewer splats than records if some cannot be drawn.
    fn next(&mut self) -> Option<Self::Item> {
        let file = self.file;
        let records = self.left.min(self.size as u64);
        if records == 0 {
            return None;
        }
        self.left -= records;
        let degree = file.columns.degree();
        let mut scene = GaussianScene::new(degree);
        let mut harmonics = vec![[0.0f32; 3]; coefficient_count(degree)];
        let mut bytes = vec![0; file.record_bytes()];
        let mut values = vec![0.0; file.scalars.len()];
        for _ in 0..records {
            if let Err(error) = self.reader.read_exact(&mut bytes) {
                self.left = 0;
                return Some(Err(file.error(error)));
            }
            let mut at = 0;
            for (value, scalar) in values.iter_mut().zip(&file.scalars) {
                let end = at + scalar.size();
                *value = scalar.decode(&bytes[at..end], file.endian);
                at = end;
            }
            file.columns.read_harmonics(&values, &mut harmonics);
            scene.push(&file.columns.gaussian(&values, &harmonics));
        }
        Some(Ok(scene.finish_part(&file.name())))
    }
}

/// The one message for all files that are not read part by part.
fn not_in_parts(reason: &str) -> Problem {
    Problem::malformed(
        "scene in chunks",
        reason,
        "chunks are read from binary .ply files with nothing but 3D Gaussians: convert the scene, or leave --chunks out",
    )
}
