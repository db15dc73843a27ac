#!/usr/bin/env bash
# Runs all tests, kernel parity on a compute device included; arguments go to `cargo test`.
#
# Where no Vulkan driver is found, the software driver lavapipe is installed with apt-get (as root or with sudo).
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

install_lavapipe() {
    local as_root=()
    if ! command -v apt-get >/dev/null; then
        say "no Vulkan driver found, and no apt-get to install one with."
        say "install your system's package of Mesa's lavapipe (often mesa-vulkan-drivers) and the Vulkan loader, then run this again"
        exit 1
    fi
    if [[ $(id -u) -ne 0 ]]; then
        if ! command -v sudo >/dev/null; then
            say "no Vulkan driver found; as root, run: apt-get install mesa-vulkan-drivers libvulkan1"
            exit 1
        fi
        as_root=(sudo)
    fi
    say "installing lavapipe (mesa-vulkan-drivers, libvulkan1)"
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers libvulkan1 >/dev/null
}

has_driver || install_lavapipe

runtime=$(mktemp -d)
trap 'rm -rf "$runtime"' EXIT
chmod 700 "$runtime"
export XDG_RUNTIME_DIR=$runtime # the driver complains without one
export NODEVICE_SELECT=1        # silences a line of Mesa's on stderr
export HOMEO_REQUIRE_GPU=1      # a test that finds no adapter fails instead of being skipped

cargo test --release "$@"
