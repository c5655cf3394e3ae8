#!/usr/bin/env bash
# Photographs a page, such as that of `fsot report`, to be looked at:
#   docs/screenshot.sh PAGE.html OUT.png [WIDTH [HEIGHT [light|dark]]]
# Needs Chromium: chromium-headless-shell, chromium, google-chrome or whatever $CHROMIUM names (Debian: apt-get install
# chromium-headless-shell; elsewhere: pip install playwright && playwright install chromium).
set -euo pipefail

if [ $# -lt 2 ] || [ $# -gt 5 ]; then
    echo "usage: $0 PAGE.html OUT.png [WIDTH [HEIGHT [light|dark]]]" >&2
    exit 2
fi
page=$1 out=$2 width=${3:-1000} height=${4:-3000} scheme=${5:-light}
case $scheme in
    light) dark=0 ;;
    dark) dark=1 ;;
    *) echo "$scheme is neither light nor dark" >&2; exit 2 ;;
esac
[ -f "$page" ] || { echo "there is no page $page: make one by fsot report TABLE.npy --out $page" >&2; exit 1; }

browser=
for name in ${CHROMIUM:-} chromium-headless-shell chromium chromium-browser google-chrome \
    "$HOME"/.cache/ms-playwright/chromium_headless_shell-*/chrome-*/headless_shell; do
    if command -v "$name" > /dev/null; then browser=$name; break; fi
done
if [ -z "$browser" ]; then
    echo "there is no Chromium: install chromium-headless-shell, or set CHROMIUM to the path of one" >&2
    exit 1
fi

# As root (in a container, say) there is no sandbox. The network is cut off: a page must not need it.
flags=(--headless --disable-gpu --hide-scrollbars --force-device-scale-factor=1 --host-resolver-rules='MAP * ~NOTFOUND'
    --window-size="$width,$height" --blink-settings=preferredColorScheme=$((1 - dark)))
[ "$(id -u)" != 0 ] || flags+=(--no-sandbox)
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT
rm -f "$out"
"$browser" "${flags[@]}" --user-data-dir="$profile" --screenshot="$out" "file://$(realpath "$page")" > "$profile/log" 2>&1 \
    || { cat "$profile/log" >&2; exit 1; }
[ -s "$out" ] || { cat "$profile/log" >&2; echo "$browser made no picture of $page" >&2; exit 1; }
