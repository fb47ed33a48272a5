#!/bin/sh
# Links the example in C with the static library for a Cortex-M0+ without an operating system, and proves that no panic
# path is left: the library's panic handler calls an undefined symbol, so the link fails exactly when one survived.
#
#   sim/capi/link_arm.sh        prints the sizes of the image
set -eu
here=$(cd "$(dirname "$0")" && pwd)
target=thumbv6m-none-eabi
missing() { echo "link_arm.sh: $1" >&2; exit 1; }
command -v arm-none-eabi-gcc >/dev/null || missing "arm-none-eabi-gcc is missing: apt-get install gcc-arm-none-eabi"
rustc --print target-libdir --target $target 2>/dev/null | xargs test -d ||
    missing "the Rust target is missing: rustup target add $target"
out=${CARGO_TARGET_DIR:-$here/../../target}
cd "$here"
CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 \
    cargo rustc --quiet --release --target $target --no-default-features --features prove-panic-free --crate-type staticlib
arm-none-eabi-gcc -mcpu=cortex-m0plus -mthumb -Os -std=c99 -Wall -Wextra -Werror -ffreestanding -ffunction-sections \
    -I include examples/arm_main.c examples/picture.c "$out/$target/release/libsplatline_capi.a" \
    -nostdlib -lgcc -Wl,--gc-sections,-z,noexecstack -T examples/arm.ld -o "$out/$target/splatline_c_example.elf"
arm-none-eabi-size "$out/$target/splatline_c_example.elf"
echo "linked without a panic path: $target/splatline_c_example.elf"
