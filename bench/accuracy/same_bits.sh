#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The same bits from every compiler: builds bench/accuracy with each (gcc and clang unless named) and lets it hash 2^24
# results of every function with every instruction set of this processor.
set -eu
source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ $# -gt 0 ] || set -- gcc clang
for compiler in "$@"; do
    CC=$compiler meson setup --buildtype=release "$folder/$compiler" "$source" > "$folder/log" || { cat "$folder/log"; exit 2; }
    ninja -C "$folder/$compiler" bench/accuracy/accuracy > "$folder/log" || { cat "$folder/log"; exit 2; }
    "$folder/$compiler/bench/accuracy/accuracy" --same-bits
done
