#!/bin/sh
# Installs what the benchmark's peers need: a C compiler and SUNDIALS from the distribution (Debian 12
# ships SUNDIALS 6.4.1), and two Python environments, for scipy with numba, which needs an older numpy,
# and for heyoka, with the versions of python/*requirements.txt.
set -eu
cd "$(dirname "$0")"

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

as_root apt-get update
as_root apt-get install -y --no-install-recommends gcc libc6-dev libsundials-dev

environment() {
  folder=../../target/benchmarks/$1
  [ -x "$folder/bin/python" ] || python3 -m venv "$folder"
  "$folder/bin/pip" install --quiet --requirement "$2"
}
environment python python/requirements.txt
environment heyoka python/heyoka-requirements.txt
