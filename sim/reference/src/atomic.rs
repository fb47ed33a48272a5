//! Atomic file writing: a reader sees the old file or the whole new one, never half of it.
//!
//! The bytes go to a temporary file beside the target, are flushed to the disk and renamed over it, because a
//! rename within one folder is atomic. Devices and pipes (`/dev/stdout`) are written directly: renaming over
//! them would replace them by a plain file.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Tells apart the temporary files that one process writes at the same time.
static SERIAL: AtomicU64 = AtomicU64::new(0);

/// Writes `bytes` to `path`, replacing what was there only once everything is on the disk.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // A symbolic link keeps pointing to its file: the file is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if fs::metadata(&target).is_ok_and(|metadata| !metadata.is_file()) {
        return OpenOptions::new()
            .write(true)
            .open(&target)?
            .write_all(bytes);
    }
    let temporary = temporary_beside(&target)?;
    let written = write_and_flush(&temporary, bytes).and_then(|()| fs::rename(&temporary, &target));
    if written.is_err() {
        // The first error is the one to report, whether or not the temporary file can be removed.
        let _ = fs::remove_file(&temporary);
    }
    written
}

fn temporary_beside(target: &Path) -> io::Result<PathBuf> {
    let name = target.file_name().ok_or_else(|| {
        let message = format!("'{}' does not name a file", target.display());
        io::Error::new(io::ErrorKind::InvalidInput, message)
    })?;
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(
        ".{}.{}.tmp",
        std::process::id(),
        SERIAL.fetch_add(1, Ordering::Relaxed)
    ));
    Ok(target.with_file_name(hidden))
}

fn write_and_flush(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn replaces_the_old_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        write(&path, b"old").unwrap();
        write(&path, b"new and longer").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new and longer");
        assert_eq!(names_in(folder.path()), ["report.json"]);
    }

    #[test]
    fn a_failure_leaves_the_target_and_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write(&folder.path().join("missing/x.png"), b"x").is_err());
        assert!(
            write(folder.path(), b"x").is_err(),
            "a folder cannot be replaced"
        );
        assert!(write(Path::new(""), b"x").is_err());
        assert!(names_in(folder.path()).is_empty());
    }

    /// A reader at any moment is what is left if the writer dies at that moment.
    #[test]
    fn a_reader_never_sees_half_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let whole = [vec![b'a'; 300_000], vec![b'b'; 500_000]];
        write(&path, &whole[0]).unwrap();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| {
                for turn in 0..20 {
                    write(&path, &whole[turn % 2]).unwrap();
                }
            });
            while !writer.is_finished() {
                let seen = fs::read(&path).unwrap();
                assert!(whole.contains(&seen), "{} bytes", seen.len());
            }
        });
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_and_links_are_followed() {
        use std::os::unix::fs::FileTypeExt;
        write(Path::new("/dev/null"), b"x").unwrap();
        assert!(
            fs::metadata("/dev/null")
                .unwrap()
                .file_type()
                .is_char_device()
        );

        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}
