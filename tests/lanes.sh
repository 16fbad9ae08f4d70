# The tests of `./dev test` when everything is built. Sourced by ./dev.
# shellcheck shell=bash

# The product's crates, which depend on none of the others.
ring1=(nima-testing nima-files nima-charts nima-core nima-devices nima-recording nima-machine nima-session nima-training nima-endoscope nima-simulation)
told=${CARGO_TARGET_DIR:-target}/lanes

# Tests the product's crates only, for daily work.
only_ring1() {
  local failed=0
  timed cargo test --locked "${ring1[@]/#/-p}" --no-run || return
  RUST_TEST_THREADS=4 timed cargo test --locked "${ring1[@]/#/-p}" --no-fail-fast 2>&1 | tee "$told/ring1.txt" || failed=1
  list_unjudged "$told/ring1.txt"
  judge_again "${ring1[@]/#/-p}" || failed=1
  verdict && return $failed
}

# Runs four lanes in parallel. Two run in real time, each with one rig at a time, and mostly wait; the other two compute at idle priority in the
# remaining time. The output of a lane is printed as a whole when it has ended.
lanes() {
  local lane failed=0 leaves_time=yes
  is_quiet || leaves_time=no
  local -A running
  for lane in wires screens units panels; do
    timed "$lane" 3>&2 >"$told/$lane.txt" 2>&1 &
    running[$lane]=$!
  done
  for lane in units panels screens wires; do
    if wait "${running[$lane]}"; then say "passed: $lane"; else failed=1 && say "FAILED: $lane"; fi
    cat "$told/$lane.txt"
  done
  list_unjudged "$told"/*.txt
  # The rest needs a quiet machine. While other work is running it would take its time without a result, so it is left out.
  if is_quiet; then
    alone >"$told/alone.txt" 2>&1 || failed=1
    cat "$told/alone.txt"
    list_unjudged "$told"/*.txt
    [ ! -e "$told/peers-again" ] || peers || failed=1
    judge_again --workspace --lib --bins --tests || failed=1
  else
    printf 'not judged: %s (other work)\n' "${alone[@]}" >>"$told/unjudged"
    [ ! -e "$told/peers-again" ] || echo 'not judged: third-party clients (other work)' >>"$told/unjudged"
  fi
  verdict && return $failed
}

# Tests the emulated devices on real connections, and the third-party clients. (`--bins` has no tests, but for `wires` alone cargo would rebuild the libraries with other features.)
wires() {
  local failed=0
  timed cargo test --locked --workspace --no-fail-fast --bins --test wires || failed=1
  timed cargo test --locked --workspace --lib -- --ignored bota::wire_tests ndi::driver_tests probe_sweep_tests endpoint::tests endpoint::two_hosts_tests || failed=1
  # Third-party clients have their own time limits: a client that gives up while the other lanes run is tested again alone.
  peers || touch "$told/peers-again"
  return $failed
}

# Tests of milliseconds, rates or small motions: faults of every device in the running loop, the panel's measurements of them, an arm that
# presses, its jaws, its shutdown, a marker that must follow, arms from a URDF, frozen sensors, and a simulated user with rings in the real window. While any other work is running, even at the lowest priority, they would be repeated for minutes.
alone=(connecting:: what_goes_wrong_with_any_device killed::a_killed_process the_pid_holds the_sensor_feels an_engaged_arm a_marker_that_follows is_led_through repeats_itself a_person_carries_a_ring
  when_a_program_in_c nobody_else_is_heard the_examples_in_python a_haply_handle_feels)
alone() { timed cargo test --locked --workspace --no-fail-fast --test commands --test screen --test window --test wires -- --ignored "${alone[@]}"; }

# Tests the real window, the commands, and the examples in the documentation.
screens() {
  local failed=0
  timed cargo test --locked --workspace --no-fail-fast --test window --test commands || failed=1
  timed cargo test --locked --workspace --doc || failed=1
  return $failed
}

# The product's crates first: their failures explain later failures.
units() {
  only_idle_time
  local failed=0
  # More threads than cores: many of these tests wait for a simulation in real time, or for a connection.
  export RUST_TEST_THREADS=4
  timed cargo test --locked "${ring1[@]/#/-p}" --no-fail-fast --lib || failed=1
  if [ $failed = 0 ]; then say "passed: units of ring 1"; else say "FAILED: units of ring 1"; fi 2>&3
  timed cargo test --locked --workspace "${ring1[@]/#/--exclude=}" --no-fail-fast --lib || failed=1
  return $failed
}

panels() {
  only_idle_time
  RUST_TEST_THREADS=4 timed cargo test --locked --workspace --no-fail-fast --bins --test screen --test machine --test session --test allocation
}

# Prints the idle percentage of the processors' time in one second.
idle_percent() {
  [ -r /proc/stat ] || { echo 100; return; }
  { head -n 1 /proc/stat; sleep 1; head -n 1 /proc/stat; } | awk '
    { all = 0; for (i = 2; i <= 9; i++) all += $i; idle = $5 + $6 }
    NR == 1 { all_before = all; idle_before = idle }
    END { printf "%d\n", 100 * (idle - idle_before) / (all - all_before + 1e-9) }'
}

# One busy second may be the end of our work: only the third busy second in a row indicates other work.
is_quiet() {
  local _
  for _ in 1 2 3; do [ "$(idle_percent)" -lt 50 ] || return 0; done
  return 1
}

# Runs this shell and its children at idle priority, unless other work leaves no idle time.
only_idle_time() {
  [ "$leaves_time" = yes ] || return 0
  chrt --idle --pid 0 "$BASHPID" 2>/dev/null || renice -n 19 "$BASHPID" >/dev/null
}

# Keeps from these outputs which tests did not judge, and why: lines of nima_testing::unjudged.
list_unjudged() { unjudged_in "$@" >"$told/unjudged"; }
unjudged_in() { sed -nE 's/.*(not judged|left out|data absent): ([[:alnum:]_:]+) \((.*)\)$/\1: \2 (\3)/p' "$@" | sort -u; }

# Tests of these crates that found the machine too busy in every attempt are run again, when nothing else is.
judge_again() {
  local names status=0
  mapfile -t names < <(sed -n 's/^not judged: \([^ ]*\) .*/\1/p' "$told/unjudged")
  [ ${#names[@]} -gt 0 ] || return 0
  timed cargo test --locked "$@" -- --include-ignored "${names[@]}" >"$told/again.txt" 2>&1 || status=$?
  cat "$told/again.txt"
  { grep -v '^not judged: ' "$told/unjudged"; unjudged_in "$told/again.txt"; } | sort -u >"$told/unjudged.new"
  mv "$told/unjudged.new" "$told/unjudged"
  return $status
}

# Names the tests that did not judge, which fails. Where that is allowed, because a machine cannot do everything, data are absent only
# together with their whole folder.
verdict() {
  local refused='.'
  [ -s "$told/unjudged" ] || return 0
  say "tests that did not judge: $(wc -l <"$told/unjudged")"
  cat "$told/unjudged" >&2
  if [ "$allow_unjudged" = yes ]; then
    [ -e ../shared ] || return 0
    refused='^data absent: '
  fi
  ! grep -q "$refused" "$told/unjudged" || { say "FAILED: a test that does not judge passes only with --allow-unjudged, and not where its data should be"; return 1; }
}
