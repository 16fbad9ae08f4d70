# Makes the packages. Sourced by ./dev, which has `say`, `need` and `need_cargo`.
#   ./dev package           all packages into target/packages
#   ./dev package --twice   and again from another folder; fails where a byte differs
#   ./dev package --try     and installs them in minimal systems, as a newcomer would (assets/package/try.sh)
#   ./dev package --sizes   sizes of the program's parts
# shellcheck shell=bash

# shellcheck source=assets/package/windows.sh
source assets/package/windows.sh

package_target=x86_64-unknown-linux-gnu
package_tools=(binutils dpkg python3 python3-venv xz-utils zstd)
zig_version=0.15.2

# Packages that were not built or not tried; listed at the end.
declare -a package_left_out=()
leave_out() { package_left_out+=("$1"); }
tell_left_out() {
  say "left out: ${#package_left_out[@]}"
  printf '   %s\n' "${package_left_out[@]}" >&2
}

# One word of the manifest.
package_version() { sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"$/\1/p' Cargo.toml; }

# Time stored in every package: the time of the last commit.
package_epoch() {
  if [ -n "${SOURCE_DATE_EPOCH:-}" ]; then
    echo "$SOURCE_DATE_EPOCH"
  elif ! git log -1 --format=%ct 2>/dev/null; then
    say "no commit tells the time of this source: set SOURCE_DATE_EPOCH (seconds since 1970)"
    return 1
  fi
}

# Zig comes as a Python package; it brings the linker and what each version of glibc offers.
fetch_zig() {
  local folder=$1/zig
  [ -x "$folder/bin/python" ] || python3 -m venv "$folder"
  "$folder/bin/python" -m pip install --quiet --disable-pip-version-check "ziglang==$zig_version"
  NIMA_ZIG=$("$folder/bin/python" -c 'import pathlib, ziglang; print(pathlib.Path(ziglang.__file__).parent / "zig")')
  export NIMA_ZIG ZIG_GLOBAL_CACHE_DIR=$1/zig-cache ZIG_LOCAL_CACHE_DIR=$1/zig-cache
}

# Arguments of the compiler, one per line. No path of this computer gets into the program.
package_flags() {
  local target=$1 registry=${CARGO_HOME:-$HOME/.cargo}
  printf '%s\n' "--remap-path-prefix=$registry=/cargo" "--remap-path-prefix=$PWD=/nima" "--remap-path-prefix=$target=/target"
}

# The last step optimises all crates together, for size; fast code was optimised for speed in its own crate (Cargo.toml, profile `packages`).
package_last_step=(-Copt-level=z)

# The program with its symbols, built from this folder.
build_program() {
  local target=$1 flags=(-Clinker=nima-linker -Clinker-features=-lld)
  mapfile -t -O 2 flags < <(package_flags "$target")
  PATH=$PWD/assets/package:$PATH CARGO_ENCODED_RUSTFLAGS=$(IFS=$'\x1f'; printf '%s' "${flags[*]}") CARGO_TARGET_DIR=$target CARGO_INCREMENTAL=0 \
    timed cargo rustc --locked --profile packages --target "$package_target" -p nima-console --bin nima -- "${package_last_step[@]}"
}

# SBOM, licence texts and the list of crates of the program for a kind of system.
take_inventory() {
  local target=$1 out=$2 system=$3 zig sysroot also
  zig=$(dirname "$NIMA_ZIG") sysroot=$(rustc --print sysroot)
  case $system in
    *windows*) also=(--also "mingw-w64's start code|MIT|/usr/share/doc/mingw-w64-common/copyright"
      --also "GCC's unwinder and run-time functions|GPL-3.0-or-later WITH GCC-exception-3.1|/usr/share/doc/gcc-mingw-w64-base/copyright") ;;
    *) also=(--also "LLVM's unwinder and run-time functions|Apache-2.0 WITH LLVM-exception|$zig/lib/libcxxabi/LICENSE.TXT"
      --also "zig's linker scripts and start code|MIT|$zig/LICENSE") ;;
  esac
  mkdir -p "$out"
  cargo metadata --locked --format-version 1 --filter-platform "$system" >"$target/metadata.json"
  cargo tree --locked -p nima-console --edges normal,no-proc-macro --target "$system" --prefix none | sed 's/ (\*)$//' | sort -u >"$target/tree.txt"
  python3 assets/package/inventory.py --metadata "$target/metadata.json" --tree "$target/tree.txt" --lock Cargo.lock --standard LICENSE-APACHE \
    --also "Roboto, the fonts of the screen|Apache-2.0|assets/fonts/Roboto-LICENSE.txt" \
    --also "Rust's standard library|MIT OR Apache-2.0|$sysroot/share/doc/rust/COPYRIGHT-library.html" \
    "${also[@]}" \
    --epoch "$SOURCE_DATE_EPOCH" --out "$out"
}

# Without symbols, with the list of crates inside (the section that cargo-auditable writes).
finish_program() {
  objcopy --strip-all --remove-section .comment --add-section ".dep-v0=$2/dep-v0" "$1" "$3"
  chmod 755 "$3"
}

# The glibc version stated in the packages must be sufficient for every function that the program uses.
judge_glibc() {
  local newest
  newest=$(objdump -T "$1" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
  if [ "$(printf '%s\n' GLIBC_2.28 "$newest" | sort -V | tail -n 1)" != GLIBC_2.28 ]; then
    say "the program needs $newest, and the packages say 2.28"
    return 1
  fi
  say "the program needs $newest and: $(objdump -p "$1" | awk '$1 == "NEEDED" { printf "%s ", $2 }')"
}

# Replaces @NAME@ by the value given as NAME=value.
fill() {
  local text
  text=$(cat "$1")
  shift
  for pair; do text=${text//"@${pair%%=*}@"/"${pair#*=}"}; done
  printf '%s\n' "$text"
}

# The files of every package, as they lie in an installed system; zsh completes from another folder on Debian than elsewhere.
stage() {
  local root=$1 program=$2 inventory=$3 zsh=$4 share=$1/usr/share shell
  rm -rf "$root"
  mkdir -p "$root"/{usr/bin,usr/lib/udev/rules.d,etc/security/limits.d} "$share"/{applications,metainfo,man/man1,doc/nima-console} \
    "$share"/{bash-completion/completions,fish/vendor_completions.d,"$zsh"} "$share"/icons/hicolor/{scalable,256x256}/apps
  finish_program "$program" "$inventory" "$root/usr/bin/nima"
  cp assets/70-nima.rules "$root/usr/lib/udev/rules.d/"
  cp assets/package/realtime.conf "$root/etc/security/limits.d/70-nima-realtime.conf"
  cp assets/package/nima-console.desktop "$share/applications/"
  fill assets/package/nima-console.metainfo.xml "VERSION=$version" "DATE=$(date -u -d "@$SOURCE_DATE_EPOCH" +%F)" >"$share/metainfo/nima-console.metainfo.xml"
  cp assets/package/nima-console.svg "$share/icons/hicolor/scalable/apps/"
  cp assets/package/nima-console.png "$share/icons/hicolor/256x256/apps/"
  "$root/usr/bin/nima" completions bash >"$share/bash-completion/completions/nima"
  "$root/usr/bin/nima" completions zsh >"$share/$zsh/_nima"
  "$root/usr/bin/nima" completions fish >"$share/fish/vendor_completions.d/nima.fish"
  "$root/usr/bin/nima" man "$share/man/man1"
  cp "$inventory/sbom.cdx.json" "$inventory/third-party.txt" "$share/doc/nima-console/"
  gzip -9n "$share"/man/man1/*.1 "$share/doc/nima-console/third-party.txt"
  settle "$root"
}

# Rights and times that are the same wherever the packages are made.
settle() {
  find "$1" -type d -exec chmod 755 {} +
  find "$1" -type f ! -path '*/bin/*' ! -path '*/DEBIAN/p*' ! -name '*.sh' -exec chmod 644 {} +
  find "$1" -exec touch --no-dereference -d "@$SOURCE_DATE_EPOCH" {} +
}

make_deb() {
  local root=$1 out=$2 doc=$1/usr/share/doc/nima-console maintainer=${NIMA_MAINTAINER:-NIMA Console maintainers <nima-console@example.org>} mit
  mit=$(sed -n '/^Permission/,$p' LICENSE-MIT | sed 's/^$/./; s/^/ /')
  fill assets/package/deb/copyright "MIT=$mit" >"$doc/copyright"
  printf 'nima-console (%s) unstable; urgency=medium\n\n  * See CHANGELOG.md of the source.\n\n -- %s  %s\n' "$version" "$maintainer" \
    "$(LC_ALL=C date -u -R -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$doc/changelog.gz"
  mkdir "$root/DEBIAN"
  fill assets/package/deb/control "VERSION=$version" "MAINTAINER=$maintainer" "SIZE=$(find "$root" -type f -printf '%s\n' | awk '{ kib += int(($1 + 1023) / 1024) } END { print kib }')" >"$root/DEBIAN/control"
  cp assets/package/deb/{postinst,postrm} "$root/DEBIAN/"
  chmod 755 "$root"/DEBIAN/post*
  echo /etc/security/limits.d/70-nima-realtime.conf >"$root/DEBIAN/conffiles"
  (cd "$root" && find usr -type f | LC_ALL=C sort | xargs md5sum) >"$root/DEBIAN/md5sums"
  settle "$root"
  # Not zstd, which Debian 11 cannot read.
  DPKG_DEB_THREADS_MAX=1 dpkg-deb --root-owner-group -Zxz -z9 --build "$root" "$out/nima-console_${version}_amd64.deb" >&2
}

make_rpm() {
  local root=$1 out=$2 work=$3/rpm-work
  rm -rf "$work"
  mkdir -p "$work"
  cp LICENSE-MIT LICENSE-APACHE CHANGELOG.md "$root/usr/share/doc/nima-console/"
  settle "$root"
  fill assets/package/rpm/nima-console.spec "VERSION=$version" >"$work/nima-console.spec"
  rpmbuild -bb --quiet --target x86_64 --define "_topdir $work" --define "staged $root" --define "_rpmdir $out" --define '_build_name_fmt %%{NAME}-%%{VERSION}-%%{RELEASE}.%%{ARCH}.rpm' \
    --define '_buildhost packages' --define 'use_source_date_epoch_as_buildtime 1' --define 'clamp_mtime_to_source_date_epoch 1' --define 'source_date_epoch_from_changelog 0' \
    --define '_binary_payload w7.xzdio' --define '_build_id_links none' --define 'debug_package %{nil}' --define '__os_install_post %{nil}' "$work/nima-console.spec" >&2
}

# To be unpacked anywhere and run from there.
make_tar() {
  local root=$1 out=$2 name=nima-console-$version-x86_64-linux
  mv "$root/usr" "$root/$name"
  mv "$root/etc" "$root/$name/etc"
  cp LICENSE-MIT LICENSE-APACHE README.md CHANGELOG.md "$root/$name/"
  settle "$root"
  tar --create --sort=name --format=gnu --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" --directory "$root" "$name" |
    zstd --quiet --force -19 --single-thread -o "$out/$name.tar.zst"
}

# Builds all packages of the source in this folder into $2; build products are in $1.
make_packages() {
  local target=$1 out=$2 inventory=$1/inventory program=$1/$package_target/packages/nima
  rm -rf "$out"
  mkdir -p "$out"
  build_program "$target"
  judge_glibc "$program"
  take_inventory "$target" "$inventory" "$package_target"
  stage "$target/stage-deb" "$program" "$inventory" zsh/vendor-completions
  make_deb "$target/stage-deb" "$out"
  stage "$target/stage-tar" "$program" "$inventory" zsh/site-functions
  make_tar "$target/stage-tar" "$out"
  if command -v rpmbuild >/dev/null; then
    stage "$target/stage-rpm" "$program" "$inventory" zsh/site-functions
    make_rpm "$target/stage-rpm" "$out" "$target"
  fi
  [ -n "$(windows_lacks)" ] || make_windows "$target" "$out"
  cp "$inventory/sbom.cdx.json" "$out/nima-console-$version.cdx.json"
  (cd "$out" && sha256sum -- *) >"$target/SHA256SUMS"
  mv "$target/SHA256SUMS" "$out/"
  cat "$out/SHA256SUMS"
}

# The same source in a folder with another name, built into a separate folder.
make_packages_again() {
  local elsewhere=$1/another-folder-for-the-same-source
  rm -rf "$elsewhere"
  mkdir -p "$elsewhere"
  git ls-files -z | tar --create --null --files-from - | tar --extract --directory "$elsewhere"
  (cd "$elsewhere" && make_packages "$elsewhere/target" "$elsewhere/packages")
  if diff "$2/SHA256SUMS" "$elsewhere/packages/SHA256SUMS"; then
    say "two builds in two folders: the same to the last bit"
    rm -rf "$elsewhere"
  else
    say "two builds in two folders differ; the second one is in $elsewhere"
    return 1
  fi
}

package() {
  local version target=${CARGO_TARGET_DIR:-$PWD/target} out what=${1:-} status=0
  case $what in '' | --twice | --try | --sizes) ;; *) say "give nothing, --twice, --try or --sizes"; exit 2 ;; esac
  # shellcheck source=assets/package/try.sh
  source assets/package/try.sh
  out=$target/packages
  need_cargo
  need "${build_packages[@]}" "${package_tools[@]}" || exit 1
  need rpm "${windows_tools[@]}" || true
  fetch_windows_target
  version=$(package_version)
  SOURCE_DATE_EPOCH=$(package_epoch)
  export SOURCE_DATE_EPOCH LC_ALL=C.UTF-8 TZ=UTC
  fetch_zig "$target/tools"
  if [ "$what" = --sizes ]; then
    build_program "$target/package-build"
    python3 assets/package/sizes.py "$target/package-build/$package_target/packages/nima"
    return
  fi
  # Not by `timed`, in which a failure would not end this.
  make_packages "$target/package-build" "$out"
  command -v rpmbuild >/dev/null || leave_out ".rpm: rpmbuild is missing (Debian's package rpm)"
  [ -z "$(windows_lacks)" ] || leave_out "Windows: $(windows_lacks)"
  leave_out "macOS and 64-bit ARM: not built, nothing here could run them"
  case $what in
    --twice) make_packages_again "$target/tools" "$out" ;;
    --try) try_packages "$out" || status=1 ;;
    *) leave_out "not tried in other systems: ./dev package --try" ;;
  esac
  say "packages are in $out"
  tell_left_out
  return $status
}
