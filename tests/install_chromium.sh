#!/bin/sh
# The browser tests need a Chromium. Install Debian's where that is allowed, else say how to get one.
set -eu
for name in chromium chromium-browser google-chrome; do
    if command -v "$name" >/dev/null 2>&1; then exit 0; fi
done
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    echo "installing Chromium for the browser tests"
    if { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y chromium; } >/dev/null 2>&1; then exit 0; fi
fi
echo "No Chromium found: the browser tests will be skipped. To run them, install one:" >&2
echo "    Debian, Ubuntu: sudo apt-get install chromium    Fedora: sudo dnf install chromium    macOS: brew install --cask chromium" >&2
