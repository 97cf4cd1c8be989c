#!/bin/sh
# Installs the peers of the benchmark into a folder, each from its ordinary registry:
#
#   crates/bench/peers/install.sh DIR
#
# DIR/py        NumPy, Raysect, Geant4 (geant4-pybind), Embree (embreex, manifold3d for its mesh), and this project's
#               own package, from PyPI and from this working tree; needs Python 3.10 or later
# DIR/pyrayt    PyRayT 0.3.1 with compatible NumPy, pandas and SciPy; PyPI offers that version for Python 3.8 only
# DIR/vecgeom   a program compiled against VecGeom (Debian: libvecgeom-dev veccore-dev vc-dev)
#
# Peers that cannot be installed are printed and left out; the benchmark reports them as missing. PYTHON and PYTHON38
# select the interpreters.
set -u

if [ $# -ne 1 ]; then
    echo "usage: $0 DIR" >&2
    exit 2
fi
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
mkdir -p "$1" && cd "$1" || exit 1
missing=""

step() {
    name=$1
    shift
    echo "== $name"
    "$@" || { echo "$name is left out" >&2; missing="$missing $name"; }
}

python38() {
    for candidate in "${PYTHON38:-}" python3.8 "$HOME"/.pyenv/versions/3.8*/bin/python; do
        [ -n "$candidate" ] || continue
        "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 8))' 2>/dev/null || continue
        echo "$candidate"
        return
    done
    echo "Python 3.8 was not found. Set PYTHON38 to its path." >&2
    return 1
}

packages() {
    "${PYTHON:-python3}" -m venv py && py/bin/pip install --quiet numpy
}

package() {
    py/bin/pip install --quiet "$@"
}

pyrayt() {
    python=$(python38) && "$python" -m venv pyrayt &&
        pyrayt/bin/pip install --quiet 'pyrayt==0.3.1' 'numpy<2' 'pandas<2' 'scipy<1.12'
}

vecgeom() {
    if ! [ -e /usr/include/VecGeom ]; then
        root=""
        [ "$(id -u)" -eq 0 ] || root=sudo
        $root apt-get install -y --no-install-recommends libvecgeom-dev veccore-dev vc-dev || return 1
    fi
    g++ -O3 -std=c++17 -DVECCORE_ENABLE_VC -I/usr/include/VecGeom "$here/vecgeom.cpp" -o vecgeom -lvecgeom -lVc
}

step NumPy packages
step Raysect package raysect
step Geant4 package geant4-pybind
step Embree package embreex manifold3d
step Rayweave package "$here/../../../bindings/python"
step PyRayT pyrayt
step VecGeom vecgeom

if [ -n "$missing" ]; then
    echo "left out:$missing"
fi
