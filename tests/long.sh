# Tests that take minutes, and those on other processors and systems. Sourced by ./dev.
# shellcheck shell=bash

# The first day of the emulated rig in the real window, from an empty folder to both arms engaged: a quarter of an hour; a whole peg transfer there. The day by commands,
# judged by the forces at the tips; the frame calibrations compared with the emulators' ground truth; every fault of every device.
walk() {
  need "${build_packages[@]}" "${window_packages[@]}" "${test_packages[@]}" || exit 1
  need_cargo
  as_the_tests_build
  NIMA_REQUIRE_WINDOW=1 timed cargo test --locked --workspace --no-fail-fast --test window --test commands --test screen --test wires -- --ignored --nocapture \
    one_core:: first_day:: a_person_carries_six_rings frames:: sides_ready:: from_boxes_to_first_touch the_one_device_that_is_missing technician:: every_fault_of_every_device
  live
}

# Experiments of the program and, unless some are named, tests that take minutes and print figures: ./dev figures [STUDY...]
figures() {
  need "${build_packages[@]}" || exit 1
  need_cargo
  as_the_tests_build
  studies "$@"
  [ $# -eq 0 ] || return 0
  timed cargo test --locked --workspace --no-fail-fast --lib --test machine --test session -- --ignored --nocapture --test-threads 1 --skip figures_of_scrubbing \
    figures_of_ how_long_ measure_rate all_fifteen a_thousand_killed in_the_whole_grid
  timed cargo test --locked --workspace --test wires -- --ignored --nocapture --test-threads 1 figures_of_a_minute
}

# Name of the table in docs/results, and the experiment that prints it.
study_commands='baselines: baselines
effects: effects
faults: faults
hands: hands
network: network --clock perfect
network-matched: network --clock perfect --mode matched --own-motion-handle
passivity: passivity --clock perfect
release: release
stability: stability --ticks 10000000
stability-map: stability-map
timing: timing
validation: validation --clock perfect
validation-paper: validation --paper'

# Writes docs/results/NAME.md for each experiment, or for the named ones. A missed aim is a result, not a failure.
studies() {
  local nima=${CARGO_TARGET_DIR:-target}/release/nima folder name command arguments
  folder=$(mktemp -d)
  # Built as for users: with the wrapper of the tests, everything would be built again.
  timed env -u RUSTC_WORKSPACE_WRAPPER -u CLIPPY_ARGS cargo build --release --locked -p nima-console
  while IFS=: read -r name command; do
    [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
    read -ra arguments <<<"$command"
    timed "$nima" study "${arguments[@]}" --out "$folder/$name" >"$folder/$name.txt" </dev/null || say "exit status $?: nima study$command"
    {
      printf '# Results: %s\n\n' "$name"
      # shellcheck disable=SC2016
      printf -- '- Command: `nima study%s`, by `./dev figures %s` (release build)\n' "$command" "$name"
      printf -- '- Commit: %s\n- Machine: %s processors, %s\n' "$(git describe --always --dirty)" "$(nproc)" "$(uname -srm)"
      printf -- '- Date: %s\n\n' "$(date +%F)"
      cat "$folder/$name"/*.md 2>/dev/null || sed -e '1i ```text' -e '$a ```' "$folder/$name.txt"
    } >"docs/results/$name.md"
  done <<<"$study_commands"
  rm -r "$folder"
}

# Sessions of every scene, recorded here, must replay to the last bit on other processors: an older one of this kind (without fused
# multiply-add, for which the C library has other sines) and one of another kind. Both are emulated: a quarter of an hour.
processors() {
  need "${build_packages[@]}" qemu-user gcc-aarch64-linux-gnu libc6-dev-arm64-cross || exit 1
  need_cargo
  local arm=aarch64-unknown-linux-gnu replaying=(cargo test --locked --package nima-tests --test session)
  command -v rustup >/dev/null || { say "rustup is missing, which brings the standard library for $arm: https://rustup.rs"; exit 1; }
  rustup target add "$arm"
  # The first run records, the others replay.
  NIMA_SESSIONS=$(mktemp -d)
  export NIMA_SESSIONS
  timed "${replaying[@]}" -- --ignored --nocapture another_build
  CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER="qemu-x86_64 -cpu Nehalem" timed "${replaying[@]}" -- --ignored --nocapture another_build
  CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu" \
    timed "${replaying[@]}" --target "$arm" -- --ignored --nocapture another_build
  rm -r "$NIMA_SESSIONS"
}

# Cross-builds the unit tests of every crate (or of the named crates) for Windows and runs them under wine. Separate, because everything is built
# again for them.
windows() {
  local target=${CARGO_TARGET_DIR:-$PWD/target} work lacks status=0
  # shellcheck source=assets/package/windows.sh
  source assets/package/windows.sh
  # shellcheck source=assets/package/wine.sh
  source assets/package/wine.sh
  need "${build_packages[@]}" python3 || exit 1
  need "${windows_compiler[@]}" || true
  need_cargo
  fetch_windows_target
  for lacks in "$(windows_compiler_lacks)" "$(wine_lacks)"; do
    [ -z "$lacks" ] || { say "left out: all unit tests on Windows: $lacks"; return 0; }
  done
  work=$(realpath -m "$target/windows")
  mkdir -p "$work"
  CARGO_TARGET_DIR=$work CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_CODEGEN_UNITS=1 CARGO_PROFILE_DEV_DEBUG=none \
    timed cargo test --locked --workspace --lib --no-run --target "$windows_target" --message-format json-render-diagnostics >"$work/built.json"
  start_wine "$work"
  wine_limit_s=7200 in_wine "$work" python3 "$PWD/tests/windows/run.py" --built "$work/built.json" --left-out "$PWD/tests/windows/left_out.txt" --logs "$work/told" "$@" || status=$?
  end_wine "$work"
  return $status
}
