//! All integration tests of the reference in one binary, which compiles and links once.

mod camera;
mod compositing;
mod golden;
mod oracle;
mod reference;
mod scenes;
