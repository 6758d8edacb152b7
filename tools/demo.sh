#!/usr/bin/env bash
# Draws a virtual patient from the atlas, simulates its MRI, and runs the whole chain on it.
set -euo pipefail
cd "$(dirname "$0")/.."
coxa=build/release/coxa

echo "== a virtual patient, drawn from the shipped atlas and changed off the model"
$coxa phantom --seed 11 --out demo/patient
echo "== the whole chain: 0-90 degrees flexion together with 0-40 degrees internal rotation"
$coxa run demo/patient/subject.toml --out demo/result
echo "== distance of the result to the virtual patient's truth (a demonstration, not accuracy)"
$coxa compare demo/result/segment demo/patient/truth --image demo/patient/image.nii.gz
echo
echo "report: $PWD/demo/result/report/report.html"
echo "examine it in a browser: $PWD/$coxa view demo/result"
