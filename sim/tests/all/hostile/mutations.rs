//! The mutation suite: every format's sound file cut and changed at random, seeded and bounded, through the reader and
//! what follows it.
//!
//! A try ends with an answer: what was read was used, or there is a message of one line or more. A panic, an infinite
//! number in a picture, a try of more than [`SLOW`] or memory beyond [`MOST_MEMORY`] fails. SPLATLINE_MUTATIONS=N tries
//! N mutations of each format (and N / 3 cuts) instead of [`USUAL`]; .ci/run takes 300, and 50,000 have been tried by
//! hand.
//!
//! The file of the try that is under way lies in the test's temporary folder, so that even an abort leaves what caused
//! it.

use super::super::shell::Shell;
use super::readers::{FORMATS, Reader};
use super::seeds::seed;
use splatline_sim::plan::Prepared;
use splatline_sim::scene::{self, LoadOptions};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const USUAL: u64 = 40;
/// A try may take this long on a busy machine; usually it takes a millisecond.
const SLOW: Duration = Duration::from_secs(20);
/// The files have some kilobytes: twice their size plus this constant, most of which is the test itself.
const MOST_MEMORY: u64 = 600_000_000;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length);
        start..start + self.below((length - start).min(40)) + usize::from(start < length)
    }
}

const REPORT: &str = "report.json";
const META: &str = "meta.json";

/// What the fuzz targets leave out: files that take others, or this program, to make.
const OWN: &[(&str, Reader)] = &[(META, folder_file), (REPORT, report_file)];

fn bundle() -> zip::ZipArchive<std::io::Cursor<Vec<u8>>> {
    zip::ZipArchive::new(std::io::Cursor::new(seed("second.sog"))).expect("a sound bundle")
}

/// A file of the bundle.
fn unpacked(name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut bundle = bundle();
    let mut entry = bundle.by_name(name).expect("a file of the bundle");
    std::io::Read::read_to_end(&mut entry, &mut bytes).expect("a sound bundle");
    bytes
}

/// The file that names the pictures of an unpacked SOG scene.
fn folder_file(path: &Path) -> Result<(), String> {
    let bundle = bundle();
    for name in bundle.file_names() {
        let name = name.expect("a name in UTF-8");
        let file = path.with_file_name(&*name);
        if !file.exists() {
            std::fs::write(file, unpacked(&name)).expect("a folder for temporary files");
        }
    }
    let read = scene::load(path, &LoadOptions::default());
    read.map(|_| ()).map_err(|error| error.to_string())
}

/// What this program records of a picture.
fn report() -> Vec<u8> {
    let shell = Shell::new();
    shell.succeed("render random:9 --size 16x16 -o x.png --json report.json");
    shell.bytes(REPORT)
}

/// As `--from` reads it. Pictures of any size are asked for; small ones are drawn.
fn report_file(path: &Path) -> Result<(), String> {
    let message = |error| format!("{error:#}");
    let prepared = Prepared::from_file(path, &|_| ()).map_err(message)?;
    let camera = &prepared.plan.camera;
    if camera.width.max(camera.height) > 64 {
        return Err("a picture that takes long".to_owned());
    }
    prepared
        .draw_fixed(&prepared.plan.entry)
        .map(|_| ())
        .map_err(message)
}

/// What numbers in texts are replaced by.
const NUMBERS: [&str; 20] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-308",
    "1e39",
    "1e154",
    "nan",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "65535",
    "32768",
    "0.5",
    "1e",
    "",
];

fn mutate(random: &mut Random, bytes: &mut Vec<u8>) {
    let length = bytes.len();
    match random.below(14) {
        0 | 9..12 if length > 0 => bytes[random.below(length)] ^= 1 << random.below(8),
        1 if length > 0 => {
            bytes[random.below(length)] = [0, 255, 127, 128, b'\n', b' ', b'-'][random.below(7)]
        }
        2 => bytes.insert(random.below(length + 1), random.next() as u8),
        3 => drop(bytes.drain(random.range(length))),
        4 => {
            let copied = bytes[random.range(length)].to_vec();
            let at = random.below(length);
            bytes.splice(at..at, copied);
        }
        5 => {
            let copied = bytes[random.range(length)].to_vec();
            let at = random.range(length);
            bytes.splice(at, copied);
        }
        _ => replace_number(random, bytes),
    }
}

/// A run of digits, with sign, point and exponent, becomes another number.
fn replace_number(random: &mut Random, bytes: &mut Vec<u8>) {
    let part = |byte: &u8| byte.is_ascii_digit() || b".-".contains(byte);
    let begins: Vec<usize> = (0..bytes.len())
        .filter(|at| part(&bytes[*at]) && (*at == 0 || !part(&bytes[at - 1])))
        .collect();
    let Some(start) = begins.get(random.below(begins.len())) else {
        return;
    };
    let length = bytes[*start..].iter().take_while(|byte| part(byte)).count();
    let number = NUMBERS[random.below(NUMBERS.len())];
    bytes.splice(*start..start + length, number.bytes());
}

fn answer(reader: Reader, path: &Path) -> Result<bool, String> {
    let started = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| reader(path)));
    match outcome {
        _ if started.elapsed() > SLOW => Err(format!("took {:?}", started.elapsed())),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or(panic.downcast_ref::<&str>().map(ToString::to_string));
            Err(format!("panicked: {}", text.unwrap_or_default()))
        }
        Ok(Err(message)) if message.trim().is_empty() => {
            Err("an error without a message".to_owned())
        }
        Ok(read) => Ok(read.is_ok()),
    }
}

/// Most memory that this process has had, if the system says.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|text| text.split_whitespace().next()?.parse::<u64>().ok());
    1024 * kilobytes.unwrap_or(0)
}

/// Sets this run's tries apart from another's: SPLATLINE_SEED, or 0, as `cargo test` runs them.
fn series() -> u64 {
    let asked = std::env::var("SPLATLINE_SEED").ok();
    let seed: u64 = asked.map_or(0, |text| text.parse().expect("SPLATLINE_SEED is a number"));
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Tries one format; the answer counts what was read although it was changed. Every failure is told with the try's
/// number.
fn try_format(
    folder: &Path,
    name: &str,
    sound: &[u8],
    reader: Reader,
    mutations: u64,
    failures: &mut Vec<String>,
) -> u64 {
    let path = folder.join(name);
    std::fs::write(&path, sound).unwrap();
    assert_eq!(
        answer(reader, &path),
        Ok(true),
        "{name} is sound as a whole: {:?}",
        reader(&path)
    );
    let cuts = mutations / 3;
    let mut read = 0;
    for number in 0..cuts + mutations {
        let mut random = Random(number ^ series() ^ (name.len() as u64) << 40);
        let mut bytes = sound.to_vec();
        if number < cuts {
            bytes.truncate(random.below(sound.len()));
        } else {
            for _ in 0..1 + random.below(3) / 2 {
                mutate(&mut random, &mut bytes);
            }
        }
        std::fs::write(&path, &bytes).unwrap();
        match answer(reader, &path) {
            Ok(was_read) => read += u64::from(was_read),
            Err(problem) => failures.push(format!("{name}, try {number}: {problem}")),
        }
    }
    read
}

/// Runs itself again in a process of its own, since memory is counted for a process.
#[test]
fn mutated_files_are_answered() {
    if std::env::var_os("SPLATLINE_MUTATIONS_ALONE").is_none() {
        let status = Command::new(std::env::current_exe().unwrap())
            .args([
                "hostile::mutations::mutated_files_are_answered",
                "--exact",
                "--nocapture",
            ])
            .env("SPLATLINE_MUTATIONS_ALONE", "1")
            .status();
        assert!(status.unwrap().success(), "see above");
        return;
    }
    let asked = std::env::var("SPLATLINE_MUTATIONS").ok();
    let mutations = asked.map_or(USUAL, |text| {
        text.parse().expect("SPLATLINE_MUTATIONS is a number")
    });
    let only = std::env::var("SPLATLINE_MUTATIONS_OF").unwrap_or_default();
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let mut failures = Vec::new();
    let all = FORMATS.iter().chain(OWN);
    for (name, reader) in all.filter(|(name, _)| name.contains(&only)) {
        let below = folder.path().join(name);
        std::fs::create_dir(&below).unwrap();
        let started = Instant::now();
        let sound = match *name {
            REPORT => report(),
            META => unpacked(META),
            other => seed(other),
        };
        let read = try_format(&below, name, &sound, *reader, mutations, &mut failures);
        println!(
            "{name}: {} tries, {read} read all the same, {:.1} s",
            mutations + mutations / 3,
            started.elapsed().as_secs_f64()
        );
    }
    let memory = peak_memory();
    println!("most memory {} MB", memory / 1_000_000);
    assert!(
        failures.is_empty(),
        "{} failures:\n{}",
        failures.len(),
        failures.join("\n")
    );
    assert!(memory < MOST_MEMORY, "{memory} bytes");
}
