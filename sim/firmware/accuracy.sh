#!/bin/sh
# Accuracy of the firmware's design, with and without interpolation, and of lean18 beside it: fixed point against the
# f64 reference on real scenes, the worse of the colour channels and of alpha. Prints a table.
#
#   sim/firmware/accuracy.sh DATA       DATA holds gaussians/ and golden/; SPLATLINE may name a built program
set -eu
data=$(cd "${1:?usage: accuracy.sh DATA}" && pwd)
cd "$(dirname "$0")/../.."
out=out/firmware
splatline=${SPLATLINE:-cargo run --quiet --release --}
mkdir -p "$out"
(cd sim/firmware && cargo run --quiet --release --features plain --bin fixed -- design) >"$out/plain.toml"

# value GROUP NAME: a number of the report's error section, over all pixels.
value() { tr -d ' \n' <"$out/report.json" | sed 's/"max_at":{[^}]*},//g; s/,"covered":{[^}]*}//g' | sed -n "s/.*\"error\":{.*\"$1\":{[^}]*\"$2\":\([-+.e0-9]*\).*/\1/p"; }

# measure NAME SCENE CAMERA...
measure() {
    name=$1; shift
    for design in micro16 "$out/plain.toml" lean18; do
        $splatline compare "$@" --size 256x256 --rules 3dgs --only -o "$out" --design "$design" >/dev/null
        awk -v scene="$name" -v design="$(basename "$design" .toml)" -v p="$(value rgb psnr_db)" -v q="$(value alpha psnr_db)" \
            -v m="$(value rgb max_abs)" -v n="$(value alpha max_abs)" -v b="$(value rgb bias)" -v c="$(value alpha bias)" 'BEGIN {
            printf "| %s | %s | %.1f | %.2f | %+.1e |\n", scene, design, (p < q ? p : q), 255 * (m > n ? m : n), (b * b > c * c ? b : c) }'
    done
}

echo "| scene | design | PSNR dB | largest x255 | bias |"
echo "|---|---|---:|---:|---:|"
measure guitar "$data/gaussians/guitar.ply" --eye 2.2,-1.2,0.5 --target 0.1,-1.2,0.1 --up 0,-1,0 --fov 50
measure playbot "$data/gaussians/playbot_lod4.ply" --eye 2.2,-1.4,2.2 --target 0,-0.45,0 --up 0,-1,0 --fov 45
measure "400 random" "$data/golden/tiny.ply" --eye 0,-5,-8 --target 0,0,0 --up 0,-1,0 --fov 60
