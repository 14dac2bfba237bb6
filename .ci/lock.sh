#!/usr/bin/env bash
# Write requirements-dev.txt and requirements-simulators.txt: the newest versions of the packages that the extras need,
# for every Python and system that pyproject.toml allows, with the digests of their files. Needs uv (pip install uv).
set -euo pipefail
cd "$(dirname "$0")/.."
{
    echo "# The environment of development, pinned with digests. Written by .ci/lock.sh; install it with"
    echo "#   python -m pip install --require-hashes -r requirements-dev.txt && python -m pip install --no-deps -e ."
    uv pip compile --quiet --universal --generate-hashes --no-header --python-version 3.10 --extra dev pyproject.toml
} >requirements-dev.txt.new
mv requirements-dev.txt.new requirements-dev.txt
{
    echo "# What the extras gymnasium and mujoco need, pinned with digests. Written by .ci/lock.sh. Apart from the environment"
    echo "# of development, because MuJoCo takes 26 MB that no other test needs."
    uv pip compile --quiet --universal --generate-hashes --no-header --python-version 3.10 \
        --constraint requirements-dev.txt --extra gymnasium --extra mujoco pyproject.toml
} >requirements-simulators.txt.new
mv requirements-simulators.txt.new requirements-simulators.txt
