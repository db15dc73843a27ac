#!/usr/bin/env bash
# Runs all tests, kernel parity on a compute device and pages in a browser included; arguments go to `cargo test`.
#
# Where no Vulkan driver is found, the software driver lavapipe is installed with apt-get (as root or with sudo), and so are
# Chromium and Node.js; npm fetches playwright-core. HOMEO_REQUIRE_BROWSER=0 does without a browser.
set -euo pipefail
cd "$(dirname "$0")/.."

say() { printf 'test.sh: %s\n' "$*" >&2; }

# True if a Vulkan loader and at least one driver manifest are installed, or the system has another compute API.
has_driver() {
    case "$(uname -s)" in
        Linux) ;;
        *) return 0 ;; # Metal and DirectX 12 come with the system
    esac
    local libraries drivers
    libraries=$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null || true)
    [[ $libraries == *libvulkan.so.1* ]] || return 1
    [[ -n ${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-} ]] && return 0
    shopt -s nullglob
    drivers=({/usr/share,/usr/local/share,/etc}/vulkan/icd.d/*.json)
    ((${#drivers[@]} > 0))
}

has_node() {
    command -v node >/dev/null && command -v npm >/dev/null
}

has_chromium() {
    local name
    [[ -n ${HOMEO_CHROMIUM:-} ]] && return 0
    for name in chromium chromium-browser google-chrome; do
        command -v "$name" >/dev/null && return 0
    done
    return 1
}

# Installs packages, the first argument says what for.
install() {
    local what=$1 as_root=()
    shift
    if ! command -v apt-get >/dev/null; then
        say "no $what found, and no apt-get to install one with: install your system's packages for $*, then run this again"
        exit 1
    fi
    if [[ $(id -u) -ne 0 ]]; then
        if ! command -v sudo >/dev/null; then
            say "no $what found; as root, run: apt-get install $*"
            exit 1
        fi
        as_root=(sudo)
    fi
    say "installing $*"
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

export HOMEO_REQUIRE_BROWSER=${HOMEO_REQUIRE_BROWSER:-1} # without a browser its test fails instead of being skipped
has_driver || install "Vulkan driver" mesa-vulkan-drivers libvulkan1
if [[ $HOMEO_REQUIRE_BROWSER == 1 ]]; then
    # One by one: a Node.js from elsewhere may bring its npm along, and Debian's does not go with it.
    has_node || install Node.js nodejs npm
    has_chromium || install browser chromium
fi

runtime=$(mktemp -d)
trap 'rm -rf "$runtime"' EXIT
chmod 700 "$runtime"
export XDG_RUNTIME_DIR=$runtime # the driver complains without one
export NODEVICE_SELECT=1        # silences a line of Mesa's on stderr
export HOMEO_REQUIRE_GPU=1      # a test that finds no adapter fails instead of being skipped

cargo test --release "$@"
