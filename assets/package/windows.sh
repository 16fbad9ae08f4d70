# The packages for Windows, cross-built: a .zip to be unpacked anywhere, and an installer for one user. Sourced by build.sh.
# shellcheck shell=bash

windows_target=x86_64-pc-windows-gnu
windows_compiler=(gcc-mingw-w64-x86-64)
windows_tools=("${windows_compiler[@]}" zip nsis)

# Rust's library for that system, where rustup can bring it.
fetch_windows_target() {
  [ -d "$(rustc --print sysroot)/lib/rustlib/$windows_target" ] || { command -v rustup >/dev/null && rustup target add "$windows_target" >&2; } || true
}

# Why programs for it cannot be built here; nothing when they can.
windows_compiler_lacks() {
  command -v x86_64-w64-mingw32-gcc >/dev/null || { echo "x86_64-w64-mingw32-gcc is missing (Debian's package ${windows_compiler[*]})"; return; }
  [ -d "$(rustc --print sysroot)/lib/rustlib/$windows_target" ] || echo "Rust's target $windows_target is missing (rustup target add $windows_target)"
}

# The same for the packages.
windows_lacks() {
  local tool
  for tool in zip makensis; do
    command -v "$tool" >/dev/null || { echo "$tool is missing (Debian's packages ${windows_tools[*]})"; return; }
  done
  windows_compiler_lacks
}

# As build_program, by mingw's linker, which would note the time.
build_windows_program() {
  local target=$1 flags
  mapfile -t flags < <(package_flags "$target")
  flags+=(-Clink-arg=-Wl,--no-insert-timestamp)
  CARGO_ENCODED_RUSTFLAGS=$(IFS=$'\x1f'; printf '%s' "${flags[*]}") CARGO_TARGET_DIR=$target CARGO_INCREMENTAL=0 \
    timed cargo rustc --locked --profile packages --target "$windows_target" -p nima-console --bin nima -- "${package_last_step[@]}"
}

make_windows() {
  local target=$1 out=$2 inventory=$1/inventory-windows name=nima-console-$version-x86_64-windows
  local root=$1/stage-windows/$name
  build_windows_program "$target"
  take_inventory "$target" "$inventory" "$windows_target"
  rm -rf "$root"
  mkdir -p "$root"
  x86_64-w64-mingw32-objcopy --strip-all "$target/$windows_target/packages/nima.exe" "$root/nima.exe"
  cp LICENSE-MIT LICENSE-APACHE README.md CHANGELOG.md "$inventory/sbom.cdx.json" "$inventory/third-party.txt" "$root/"
  python3 - assets/package/nima-console.png "$root/nima-console.ico" <<'PYTHON'
import pathlib, struct, sys
picture = pathlib.Path(sys.argv[1]).read_bytes()
# One picture of 256 x 256 pixels (written 0), as PNG, behind a header of 22 bytes.
pathlib.Path(sys.argv[2]).write_bytes(struct.pack("<3H4B2H2I", 0, 1, 1, 0, 0, 0, 0, 1, 32, len(picture), 22) + picture)
PYTHON
  settle "$root"
  rm -f "$out/$name.zip"
  (cd "$root/.." && find "$name" -type f | LC_ALL=C sort | TZ=UTC zip --quiet -9 -X "$out/$name.zip" -@)
  makensis -V2 -NOCD "-DVERSION=$version" "-DFILES=$root" "-DOUT=$out/$name-setup.exe" assets/package/windows/installer.nsi >&2
}
