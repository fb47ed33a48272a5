//! Atomic file writing: a reader sees the old file or the whole new one, never half of it.
//!
//! The bytes go to a temporary file beside the target, are flushed to the disk and renamed over it, because a rename
//! within one folder is atomic. Devices and pipes (`/dev/stdout`) are written directly: renaming over them would
//! replace them by a plain file. A file that was read on this thread is what the bytes come from: it is refused.

use crate::input;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
#[cfg(unix)]
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Writes `bytes` to `path`, replacing what was there only once everything is on the disk; what was there keeps its
/// permissions.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    refuse_input(path)?;
    // A symbolic link keeps pointing to its file: the file is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let existing = fs::metadata(&target).ok();
    if existing.as_ref().is_some_and(|found| !found.is_file()) {
        return OpenOptions::new()
            .write(true)
            .open(&target)?
            .write_all(bytes);
    }
    let name = target.file_name().ok_or_else(|| {
        let message = format!("'{}' does not name a file", target.display());
        io::Error::new(io::ErrorKind::InvalidInput, message)
    })?;
    let mut builder = tempfile::Builder::new();
    // A file's name may be the longest that there can be, and the temporary one's must not be longer.
    let beginning: String = name.to_string_lossy().chars().take(32).collect();
    let prefix = format!(".{beginning}.");
    builder.prefix(&prefix).suffix(".tmp");
    // Those of a new file, from which the system takes what the user's mask forbids; temporary files would be their
    // owner's alone.
    #[cfg(unix)]
    builder.permissions(PermissionsExt::from_mode(0o666));
    let folder = target.parent().filter(|folder| *folder != Path::new(""));
    let mut file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    // Through the file itself, whose errors do not name the temporary one.
    file.as_file_mut().write_all(bytes)?;
    if let Some(existing) = existing {
        file.as_file().set_permissions(existing.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target)?;
    Ok(())
}

/// Fails if this file was read on this thread, under whatever name.
pub fn refuse_input(path: &Path) -> io::Result<()> {
    match input::read_as(path) {
        None => Ok(()),
        Some(name) => Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            format!(
                "it is read as '{}' and would be destroyed; name another output",
                name.display()
            ),
        )),
    }
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

    #[cfg(target_os = "linux")]
    #[test]
    fn the_longest_name_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let name = "x".repeat(255);
        write(&folder.path().join(&name), b"x").unwrap();
        assert_eq!(names_in(folder.path()), [name]);
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

    #[test]
    fn what_was_read_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ply");
        fs::write(&path, b"scene").unwrap();
        input::text(&path, 9).unwrap();
        let message = write(&path, b"x").unwrap_err().to_string();
        assert!(message.contains("would be destroyed"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"scene");
        input::forget();
        write(&path, b"x").unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_permissions_and_a_new_one_has_the_usual_ones() {
        use std::fs::Permissions;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mode = |name: &str| fs::metadata(path(name)).unwrap().permissions().mode() & 0o777;
        for private in [0o600, 0o640, 0o664] {
            fs::write(path("kept"), b"old").unwrap();
            fs::set_permissions(path("kept"), Permissions::from_mode(private)).unwrap();
            write(&path("kept"), b"new").unwrap();
            assert_eq!(mode("kept"), private);
        }
        fs::write(path("usual"), b"").unwrap();
        write(&path("new"), b"").unwrap();
        assert_eq!(mode("new"), mode("usual"));
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
