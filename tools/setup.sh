# Sourced by tools/quickstart, tools/test and .ci/run: finds what the machine lacks, says it, installs it with apt. POSIX sh.

# A runner may start without it. The password file knows.
: "${HOME:=$(getent passwd "$(id -u)" | cut -d : -f 6)}"
export HOME

say() { printf '%s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# Rust of at least the version that Cargo.toml asks for. Never installed from here: how to is the user's choice.
need_rust() {
    if ! command -v cargo >/dev/null 2>&1 && [ -f "$HOME/.cargo/env" ]; then . "$HOME/.cargo/env"; fi
    wanted=$(sed -n 's/^rust-version *= *"\(.*\)"/\1/p' Cargo.toml | head -n 1)
    command -v cargo >/dev/null 2>&1 || die "Rust $wanted or later is needed, and no cargo was found. https://rustup.rs says how to install it."
    found=$(rustc --version | cut -d ' ' -f 2)
    oldest=$(printf '%s\n%s\n' "$wanted" "$found" | sort -V | head -n 1)
    [ "$oldest" = "$wanted" ] || die "Rust $wanted or later is needed; this is $found. Update it: rustup update stable"
}

has_library() { PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep -q "$1"; }

# A Vulkan driver is there if a manifest of one is, or if the environment names one.
has_driver() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    for folder in /usr/share/vulkan/icd.d /usr/local/share/vulkan/icd.d /etc/vulkan/icd.d "$HOME/.local/share/vulkan/icd.d"; do
        for manifest in "$folder"/*.json; do [ -e "$manifest" ] && return 0; done
    done
    return 1
}

has_validation() {
    for folder in "${VK_LAYER_PATH:-/nowhere}" /usr/share/vulkan/explicit_layer.d /usr/local/share/vulkan/explicit_layer.d /etc/vulkan/explicit_layer.d; do
        [ -e "$folder/VkLayer_khronos_validation.json" ] && return 0
    done
    return 1
}

# The packages that are missing for the purposes named: run, test, shaders.
missing_packages() {
    command -v cc >/dev/null 2>&1 || echo gcc libc6-dev
    has_library libvulkan.so.1 || echo libvulkan1
    has_driver || echo mesa-vulkan-drivers
    for purpose in "$@"; do
        case $purpose in
            test)
                has_validation || echo vulkan-validationlayers
                command -v spirv-val >/dev/null 2>&1 || echo spirv-tools
                command -v glslangValidator >/dev/null 2>&1 || echo glslang-tools
                # For the C program that uses gridwalk.h.
                [ -e /usr/include/vulkan/vulkan_core.h ] || [ -e /usr/local/include/vulkan/vulkan_core.h ] || echo libvulkan-dev
                ;;
            shaders)
                command -v cmake >/dev/null 2>&1 || echo cmake
                command -v python3 >/dev/null 2>&1 || echo python3
                command -v c++ >/dev/null 2>&1 || echo g++
                ;;
        esac
    done
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"
    elif command -v sudo >/dev/null 2>&1; then sudo "$@"
    else die "this needs root, and there is no sudo: $*"
    fi
}

# Installs packages by name; reads the package lists first, and once more if something cannot be had.
install_packages() {
    [ $# -gt 0 ] || return 0
    command -v apt-get >/dev/null 2>&1 || die "missing, and there is no apt-get to install it with (names are Debian's): $*"
    say "installing with apt: $*"
    for attempt in 1 2; do
        as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 update >&2 &&
            as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Acquire::Retries=3 install --no-install-recommends "$@" >&2 && return 0
        say "attempt $attempt failed"
    done
    die "apt could not install: $*"
}

# Installs what is missing for the purposes named.
need_packages() {
    # Names of packages hold no white space.
    # shellcheck disable=SC2046
    install_packages $(missing_packages "$@")
}
