#!/bin/sh
# Installs what the benchmark's peers need: a C compiler and SUNDIALS from the distribution (Debian 12
# ships SUNDIALS 6.4.1), and a Python environment with the versions of python/requirements.txt.
set -eu
cd "$(dirname "$0")"

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

as_root apt-get update
as_root apt-get install -y --no-install-recommends gcc libc6-dev libsundials-dev

environment=../target/peers/python
[ -x "$environment/bin/python" ] || python3 -m venv "$environment"
"$environment/bin/pip" install --quiet --requirement python/requirements.txt
