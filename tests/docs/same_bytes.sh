#!/usr/bin/env bash
# Builds the site a second time, in another folder, with another date and another order of hashes, and compares all bytes.
#
#     same_bytes.sh ROOT HTML        HTML: the site that was built first
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
SOURCE_DATE_EPOCH=1000000000 TZ=Asia/Tokyo "$1/scripts/docs" "$work/another folder" 2> "$work/log" || { cat "$work/log"; exit 1; }
diff -r "$2" "$work/another folder/html"
echo "$(find "$2" -type f | wc -l) files have the same bytes"
