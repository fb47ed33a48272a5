#!/usr/bin/env bash
# Tests of the aarch64 wheel on a Python for aarch64, both by qemu: sim/python/tests/aarch64.sh WHEEL
#
# Debian's Python is unpacked into a folder of its own, beside the packages that PyPI has for that processor; nothing is
# installed. Left out are tests that start another Python, which only a kernel that knows qemu could run, and the one
# that takes the time.
set -euo pipefail
version=3.11 # Of bookworm.
packages="python$version-minimal libpython$version-minimal libpython$version-stdlib libc6 libgcc-s1 libstdc++6 zlib1g libexpat1 libffi8 libssl3
    libsqlite3-0 libbz2-1.0 liblzma5 libuuid1"
wheel=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder"/{lists/partial,archives/partial,root}
touch "$folder/status"
cat >"$folder/apt.conf" <<END
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Sandbox::User "root";
Dir { State "$folder"; State::status "$folder/status"; Cache "$folder"; };
END
export APT_CONFIG=$folder/apt.conf
nothing() { echo "aarch64.sh: this machine's package sources have no arm64 packages" >&2; exit 77; }
apt-get update -qq || nothing
# shellcheck disable=SC2086 # A list of words.
(cd "$folder" && apt-get download -qq $packages) || nothing
for each in "$folder"/*.deb; do dpkg-deb -x "$each" "$folder/root"; done
python3 -m pip -q install --target "$folder/site" --python-version "$version" --only-binary=:all: --platform manylinux_2_28_aarch64 \
    --platform manylinux_2_27_aarch64 --platform manylinux_2_17_aarch64 --platform manylinux2014_aarch64 numpy pytest "$wheel"
PYTHONHOME=$folder/root/usr PYTHONPATH=$folder/site qemu-aarch64 -L "$folder/root" "$folder/root/usr/bin/python$version" -m pytest -q \
    -p no:cacheprovider "$(dirname "$0")"/test_{pictures,stages}.py -k "not (three_designs or messages or are_saved or machines_and or millisecond)"
