#!/usr/bin/env bash
# Installs missing packages, builds polyrecon and denoises the shipped samples. out/SAMPLE/ then holds the clean picture,
# the error map, the sample map, the report, and comparison.png: crops of input | result | reference | error, three times
# as large. out/samples.png shows the three comparisons in one picture.
set -euo pipefail
cd "$(dirname "$0")/.."

echo "== packages"
samples/install_dependencies.sh
echo "== build"
cmake --preset release
cmake --build --preset release

polyrecon=build/release/src/polyrecon
declare -A crop=([study]=150,40,110,80 [glass]=90,90,110,80 [lighthouse]=90,70,110,80)
for sample in study glass lighthouse; do
  noisy=samples/${sample}_16.exr reference=samples/${sample}_ref.exr out=out/$sample
  mkdir -p "$out"
  echo
  echo "== $sample (described in samples/README.md)"
  "$polyrecon" denoise -i "$noisy" -o "$out/clean.exr" --error-map "$out/error.exr" \
    --sample-map "$out/samples.exr" --budget 16 --report "$out/report.json" --overwrite
  echo "input and result, compared with the reference:"
  "$polyrecon" compare "$noisy" "$out/clean.exr" "$reference"
  "$polyrecon" preview "$noisy" "$out/clean.exr" "$reference" "$out/error.exr" \
    --region "${crop[$sample]}" --zoom 3 --reference "$reference" -o "$out/comparison.png" --overwrite
done
oiiotool out/{study,glass,lighthouse}/comparison.png --mosaic 1x3 --ch R,G,B -o out/samples.png
echo
echo "See out/samples.png"
