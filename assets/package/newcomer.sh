#!/bin/sh
# The first minutes of a new user with an installed package, as an ordinary user in a minimal system: a force on the virtual clock, the window
# with its force, the devices of the emulated rig. Run by try.sh, which gives the display; prints one line for each.
set -eu
cd "$HOME"
export XDG_RUNTIME_DIR="$HOME/run"
mkdir -p "$XDG_RUNTIME_DIR"
chmod 700 "$XDG_RUNTIME_DIR"

# Prints numbers of a session: seconds, the largest rendered force (N), how often it rose above half of that, and when it first exceeded 0.1 N.
force_of() {
  rm -f table.csv
  nima export "$1" --out table.csv >/dev/null
  awk -F , '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    {
      force = sqrt($column["rendered_x_n"] ^ 2 + $column["rendered_y_n"] ^ 2 + $column["rendered_z_n"] ^ 2)
      if (force > most) most = force
      if (first == "" && force > 0.1) first = $column["t_s"]
      forces[NR] = force; last = $column["t_s"]
    }
    END {
      for (row in forces) rows++
      for (i = 2; i <= rows + 1; i++) { above = forces[i] > most / 2; rises += above && !before; before = above }
      printf "%.1f s, rendered force up to %.2f N, above half of it %d times, first after %.2f s\n", last, most, rises, first
      exit !(most > 0.1 && rises >= 1)
    }' table.csv
}

version=$(nima --version)
printf 'version: %s\n' "$version"

rm -f virtual.mcap
nima run --virtual --seconds 10 --record virtual.mcap --json >virtual.json
printf 'virtual clock: %s\n' "$(force_of virtual.mcap)"

if [ -n "${DISPLAY:-}" ]; then
  # No option except the end time, as for a new user.
  nima console --exit-after 8 --frames frames.json --screenshot window.png
  session=$(find "$HOME/.local/share/nima-console/sessions" -name '*.mcap' | sort | tail -n 1)
  printf 'window: %s\n' "$(force_of "$session")"
fi

# The emulators serve as long as the other end of their standard input is open.
rm -f stay
mkfifo stay
nima emulate rig <stay >emulators.json &
exec 3>stay
tries=0
until nima devices --rig emulated >devices.txt 2>&1; do
  tries=$((tries + 1))
  if [ "$tries" -gt 20 ]; then
    cat devices.txt
    exit 1
  fi
  sleep 1
done
exec 3>&-
wait
printf 'devices: %s of the emulated rig connected, %s with a problem\n' "$(grep -c ' connected' devices.txt)" "$(grep -c ' problem' devices.txt || true)"
