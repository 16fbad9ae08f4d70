# Tests of features with large libraries and of separate programs and packages. Sourced by ./dev.
# shellcheck shell=bash

# Tests of the feature `live`, with third-party clients (one reads the messages while they are recorded) and Rerun's check of sessions.
# Separate, because foxglove and Rerun are large.
live() {
  need "${build_packages[@]}" python3 python3-venv || exit 1
  need_cargo
  as_the_tests_build
  timed cargo test --locked -p nima-live --features engine
  fetch_peers
  # With a test of the same crate: the program alone would be built with other features of its libraries.
  timed cargo test --locked --workspace --no-run --test commands --features nima-console/live
  timed "$peers_folder/bin/python" tests/peers/run.py "${CARGO_TARGET_DIR:-target}/debug/nima" session
  # 800 MB: too large for every run of the tests.
  local large=${CARGO_TARGET_DIR:-target}/peers-large
  [ -x "$large/bin/python" ] || python3 -m venv "$large"
  "$large/bin/python" -m pip install --quiet --disable-pip-version-check -r tests/peers/requirements-large.txt
  timed "$large/bin/python" tests/peers/run.py "${CARGO_TARGET_DIR:-target}/debug/nima" rerun
}

# Tests of the bridges: the example client of the OpenIGTLink library, built here, and the loop's cost of clients (figures are printed, without a limit).
bridges() {
  need "${build_packages[@]}" g++ libopenigtlink-dev openigtlink-examples python3 python3-venv || exit 1
  need_cargo
  as_the_tests_build
  fetch_peers
  timed cargo test --locked --workspace --no-run --test commands
  timed "$peers_folder/bin/python" tests/peers/run.py "${CARGO_TARGET_DIR:-target}/debug/nima" openigtlink
  timed cargo test --locked --workspace --lib -- --ignored --nocapture figures_of_the_bridge
}

# Tests of the bridge to ROS 2, a separate program with DDS, with Eclipse Cyclone DDS as its peer. It reads from the `nima` that was built last; the
# workspace is built only if there is none.
ros2() {
  need "${build_packages[@]}" python3 python3-venv || exit 1
  need_cargo
  as_the_tests_build
  local program=(--manifest-path src/extras/bridges/ros2/Cargo.toml) target=${CARGO_TARGET_DIR:-target}
  local built=$target/ros2 peers=$target/peers-ros2 nima=$target/debug/nima
  timed cargo fmt "${program[@]}" --check
  timed cargo test --locked "${program[@]}" --target-dir "$built"
  timed cargo build --locked "${program[@]}" --target-dir "$built"
  [ -x "$nima" ] || timed cargo test --locked --workspace --no-run --test commands
  [ -x "$peers/bin/python" ] || python3 -m venv "$peers"
  "$peers/bin/python" -m pip install --quiet --disable-pip-version-check -r tests/peers/requirements-ros2.txt
  NIMA_BRIDGE_ROS2=$built/debug/nima-bridge-ros2 timed "$peers/bin/python" tests/peers/run.py "$nima" ros2
}

# Tests of the separate program `department`: a rig and its watchers over TLS. Separate, because zenoh takes minutes to build.
department() {
  need "${build_packages[@]}" || exit 1
  need_cargo
  as_the_tests_build
  timed cargo test --locked --manifest-path src/extras/department/Cargo.toml --target-dir "${CARGO_TARGET_DIR:-target}/department"
}

# Tests of the feature `h264`: endoscope video over RTSP, compared with ffmpeg. Separate, because the decoder is C++.
h264() {
  need "${build_packages[@]}" g++ || exit 1
  need_cargo
  as_the_tests_build
  # Uses ffmpeg if it is installed, as a program or as a wheel; without it these tests report that they were left out.
  local ffmpeg
  ffmpeg=$(command -v ffmpeg || python3 -c 'import imageio_ffmpeg; print(imageio_ffmpeg.get_ffmpeg_exe())' 2>/dev/null) || true
  [ -z "$ffmpeg" ] || export NIMA_FFMPEG=$ffmpeg
  timed cargo test --locked -p nima-endoscope --features h264
  timed cargo test --locked -p nima-emulation --features h264 --lib endoscope -- --include-ignored --skip figures_of
  timed cargo test --locked -p nima-console --features h264 --lib a_recorded_stream
}

# A tick of the whole loop under LLVM's RealtimeSanitizer, which only a nightly compiler has. First, the calls that it must find.
rtsan() {
  need_cargo
  cargo +nightly --version >/dev/null 2>&1 || { say "a nightly compiler is missing: rustup toolchain install nightly"; exit 1; }
  local target=${CARGO_TARGET_DIR:-target}/rtsan machine=x86_64-unknown-linux-gnu call
  local program=$target/$machine/debug/nima-rtsan
  RUSTFLAGS=-Zsanitizer=realtime timed cargo +nightly build --locked --manifest-path tests/rtsan/Cargo.toml \
    --target $machine --target-dir "$target"
  for call in allocation lock file; do
    ! "$program" $call 2>/dev/null || { say "the sanitizer does not find: $call"; exit 1; }
  done
  timed "$program"
}

# Builds the wheel of the Python package, installs it into a separate environment, and runs its tests and notebooks there. Separate, because no other
# test needs PyO3 and a release build. --speed also compares its time with that of the same in Rust.
python_package() {
  [[ -z ${1:-} || ${1:-} == --speed ]] || { say "give nothing, or --speed"; exit 2; }
  need "${build_packages[@]}" python3 python3-venv || exit 1
  need_cargo
  as_the_tests_build
  local folder=${CARGO_TARGET_DIR:-target}/python
  mkdir -p "$folder"
  folder=$(realpath "$folder")
  local nima=${CARGO_TARGET_DIR:-target}/debug/nima python=$folder/venv/bin/python
  # With a test of the same crate: the program alone would be built with other features of its libraries.
  timed cargo test --locked --workspace --no-run --test commands
  [ -x "$python" ] || python3 -m venv "$folder/venv"
  "$python" -m pip install --quiet --disable-pip-version-check -r python/tests/requirements.txt
  timed cargo fmt --manifest-path python/Cargo.toml --check
  rm -rf "$folder/wheels"
  CARGO_TARGET_DIR=$folder timed "$python" -m maturin build --release --locked --manifest-path python/Cargo.toml --out "$folder/wheels"
  "$python" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps "$folder"/wheels/*.whl
  NIMA=$(realpath "$nima") timed "$python" -m pytest -q -p no:cacheprovider -c python/pyproject.toml python/tests
  say "the wheel: $(ls "$folder"/wheels/*.whl)"
  [ "${1:-}" = --speed ] || return 0
  CARGO_TARGET_DIR=$folder timed cargo build --release --locked --manifest-path python/Cargo.toml --example identify_time
  timed "$python" python/tests/speed.py "$folder/release/examples/identify_time"
}
