#!/usr/bin/env bash
# Opens the pages in a folder that tests/browser.rs made in headless Chromium; see check.mjs beside this file.
#
# Needs Node.js, Chromium (or HOMEO_CHROMIUM, the path of one) and the package playwright-core, which is fetched with npm
# into the build folder. Without them it exits with 77, or with HOMEO_REQUIRE_BROWSER=1 with 1.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
pages=$1

missing() {
    echo "run.sh: $*" >&2
    [[ ${HOMEO_REQUIRE_BROWSER:-} == 1 ]] && exit 1
    exit 77
}

browser=${HOMEO_CHROMIUM:-}
for name in chromium chromium-browser google-chrome; do
    [[ -n $browser ]] || browser=$(command -v "$name" || true)
done
[[ -n $browser ]] || missing "no Chromium here: install the package chromium, or set HOMEO_CHROMIUM"
command -v node >/dev/null || missing "no Node.js here: install nodejs and npm"

modules=$here/../../target/browser
if [[ ! -d $modules/node_modules/playwright-core ]]; then
    command -v npm >/dev/null || missing "no npm here to fetch playwright-core with"
    mkdir -p "$modules"
    npm install --silent --no-audit --no-fund --prefix "$modules" playwright-core >&2 || missing "npm cannot fetch playwright-core"
fi
NODE_PATH=$modules/node_modules exec node "$here/check.mjs" "$browser" "$pages"
