#!/usr/bin/env bash
# Installs the Debian packages that coxa needs and that are missing; does nothing when all are there. With --programs
# also those that coxa is only compared with (tools/side_by_side.sh).
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache lld
  libeigen3-dev libtbb-dev libfmt-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libtomlplusplus-dev
  libnanoflann-dev libgdcm-dev libvtk9-dev libembree-dev libboost-dev zlib1g-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  clang-format python3
  chromium fonts-dejavu-core
)
# node and npm may have come from elsewhere
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
[ "${1:-}" = --programs ] && packages+=(tetgen gmsh libcgal-dev calculix-ccx python3-numpy python3-vtk9 python3-matplotlib)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q "ok installed" || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "coxa needs root or sudo to install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "installing ${#missing[@]} Debian packages: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
