# Judges the packages, and installs them in minimal systems as a newcomer would. Sourced by build.sh; needs root for its systems, and deletes them.
# shellcheck shell=bash

# shellcheck source=assets/package/wine.sh
source assets/package/wine.sh

try_tools=(debootstrap lintian appstream desktop-file-utils xvfb xdotool imagemagick)
try_suites=(bookworm trixie bullseye)

try_packages() {
  local out=$1 deb rpm archive suite failed=0
  deb=$(echo "$out"/*.deb) rpm=$(echo "$out"/*.rpm) archive=$(echo "$out"/*.tar.zst)
  need "${try_tools[@]}" || true
  judge_files "$out" "$deb" || failed=1
  judge_rpm "$rpm" || failed=1
  try_windows "$out" "$deb" || { say "FAILED: Windows"; failed=1; }
  if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
    leave_out "not tried in ${try_suites[*]}: that needs root and debootstrap"
    return $failed
  fi
  for suite in "${try_suites[@]}"; do
    try_in "$suite" "$deb" "$rpm" "$archive" || { say "FAILED: Debian $suite"; failed=1; }
  done
  leave_out "not tried on a real screen or with real devices"
  return $failed
}

# lintian, desktop entry and metainfo.
judge_files() {
  local out=$1 deb=$2 unpacked=$1/../package-build/stage-deb/usr/share failed=0
  if command -v lintian >/dev/null; then
    lintian --tag-display-limit 0 --allow-root "$deb" >"$out/../lintian.txt" 2>&1 || true
    cat "$out/../lintian.txt"
    say "lintian: $(grep -c '^E:' "$out/../lintian.txt") errors, $(grep -c '^W:' "$out/../lintian.txt") warnings"
    ! grep -q '^E:' "$out/../lintian.txt" || failed=1
  else
    leave_out "lintian is missing"
  fi
  if command -v desktop-file-validate >/dev/null; then
    desktop-file-validate "$unpacked/applications/nima-console.desktop" && say "desktop entry: valid" || failed=1
  else
    leave_out "the desktop entry was not judged: desktop-file-utils is missing"
  fi
  if command -v appstreamcli >/dev/null; then
    appstreamcli validate --no-net "$unpacked/metainfo/nima-console.metainfo.xml" || failed=1
  else
    leave_out "the metainfo was not judged: appstream is missing"
  fi
  return $failed
}

# Checks of the .rpm that need no system that uses it.
judge_rpm() {
  local rpm=$1
  [ -e "$rpm" ] && command -v rpm >/dev/null || { leave_out "the .rpm was not tried: it or rpm is missing"; return 0; }
  say "the .rpm: $(rpm -qlp "$rpm" | wc -l) files; needs $(rpm -qp --requires "$rpm" | grep -v '^rpmlib' | tr '\n' ' ')"
  rpm -K --nosignature "$rpm" >&2
}

# Runs a command in a separate system: its processes and mounts end with it.
inside() {
  local root=$1
  shift
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --kill-child sh -c '
    mount --make-rprivate /
    mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" && mount -t tmpfs tmpfs "$0/dev/shm" &&
    mount -t devpts -o newinstance,ptmxmode=0666,mode=620,gid=5 devpts "$0/dev/pts" && exec chroot "$0" "$@"' "$root" \
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive DISPLAY="${try_display:-}" "$@"
}

# The same as an ordinary user who has logged in.
as_person() {
  local root=$1
  shift
  inside "$root" su --login person --whitelist-environment=DISPLAY --command "$*"
}

# Nothing of the package may be left but what the user made.
nothing_left() {
  local root=$1 left
  left=$(find "$root" -xdev -iname '*nima*' ! -path "$root/home/*" ! -path "$root/proc/*" ! -path "$root/tmp/*" ! -path "$root/var/cache/apt/*" ! -path "$root/root/*" -printf '%P\n')
  left+=$(grep -s '^realtime:' "$root/etc/group" || true)
  if [ -n "$left" ]; then
    say "left behind after the package was removed: $left"
    return 1
  fi
  [ -n "$(find "$root/home/person/.local/share/nima-console" -name '*.mcap' 2>/dev/null)" ] || { say "the user's sessions are gone"; return 1; }
}

try_in() {
  local suite=$1 root=$target/try-$1 status=0
  rm -rf --one-file-system "$root"
  say "Debian $suite"
  if ! debootstrap --variant=minbase "$suite" "$root" http://deb.debian.org/debian >"$target/try-$suite.log" 2>&1; then
    leave_out "Debian $suite: debootstrap could not make it ($(tail -n 1 "$target/try-$suite.log"))"
  else
    walk_through "$@" || status=$?
  fi
  rm -rf --one-file-system "$root"
  return $status
}

walk_through() {
  local suite=$1 deb=$2 rpm=$3 archive=$4 root=$target/try-$1
  cp "$deb" "$root/tmp/nima-console.deb"
  settle_newcomer "$root" || return
  inside "$root" apt-get update -q >>"$target/try-$suite.log" 2>&1 || return
  at_a_screen try_all_in "$@"
}

try_all_in() {
  local suite=$1 rpm=$3 archive=$4 root=$target/try-$1
  try_deb "$suite" "$root" && try_archive "$root" "$archive" && try_rpm "$root" "$rpm"
}

# The ordinary user, and what that one will do.
settle_newcomer() {
  local root=$1
  install -D -m 755 assets/package/newcomer.sh "$root/usr/local/bin/newcomer"
  inside "$root" useradd --create-home --shell /bin/sh person
}

# Runs a command while there is a display, which the systems here reach too.
at_a_screen() {
  local try_display=:97 screen status=0
  Xvfb "$try_display" -screen 0 1600x1000x24 -nolisten tcp -noreset -ac >/dev/null 2>&1 &
  screen=$!
  "$@" || status=1
  kill "$screen"
  wait "$screen" 2>/dev/null || true
  return $status
}

try_deb() {
  local suite=$1 root=$2 began=$SECONDS
  inside "$root" apt-get install -y -q /tmp/nima-console.deb >>"$target/try-$suite.log" 2>&1 || { tail -n 20 "$target/try-$suite.log"; return 1; }
  say "Debian $suite: installed in $((SECONDS - began)) s (with what a window needs, from the archive)"
  first_minutes "Debian $suite" "$suite" "$root" "$began" || return
  inside "$root" apt-get purge -y -q nima-console >>"$target/try-$suite.log" 2>&1 || return
  nothing_left "$root"
}

# The newcomer's walk while the screen is watched, and the real-time limits. Seconds count from when the installation began.
first_minutes() {
  local system=$1 kept=$target/try-$2 root=$3 began=$4 watching=
  if command -v xdotool >/dev/null && command -v import >/dev/null; then
    picture "$system" "$kept" "$began" &
    watching=$!
  else
    leave_out "$system: nobody looked at the window, xdotool or imagemagick is missing"
  fi
  as_person "$root" newcomer || return
  [ -z "$watching" ] || wait "$watching" || { say "$system: no window came, or nothing moved in it"; return 1; }
  cp "$root/home/person/window.png" "$kept-window.png"
  say "$system: the window's start-up: $(tr -d ' \n' <"$root/home/person/frames.json" | head -c 400)"
  inside "$root" usermod -aG realtime person || return
  limits_of_realtime "$system" "$root" || return
  inside "$root" gpasswd --delete person realtime >/dev/null
}

# Raising a limit takes a capability (CAP_SYS_RESOURCE, number 24) that root has not in every container.
limits_of_realtime() {
  local system=$1 root=$2 capabilities priority
  capabilities=$(sed -n 's/^CapEff:\t//p' /proc/self/status)
  if [ $((0x$capabilities >> 24 & 1)) -eq 0 ]; then
    leave_out "$system: real-time limits were not judged, root may not raise limits on this machine"
    return 0
  fi
  priority=$(as_person "$root" ulimit -r)
  say "$system: a member of realtime may ask for priority $priority"
  [ "$priority" -eq 95 ]
}

# Two pictures of the screen, a second apart, while the window is open: it shows something, and that moves.
picture() {
  local system=$1 kept=$2 began=$3 differ tries=0
  until DISPLAY=$try_display xdotool search --name 'NIMA Console' >/dev/null 2>&1; do
    tries=$((tries + 1))
    [ "$tries" -lt 120 ] || return
    sleep 0.5
  done
  say "$system: the window is there $((SECONDS - began)) s after the installation began"
  sleep 2
  import -display "$try_display" -window root "$kept-1.png" && sleep 1 && import -display "$try_display" -window root "$kept-2.png" || return
  differ=$(compare -metric AE "$kept-1.png" "$kept-2.png" null: 2>&1 || true)
  say "$system: $differ pixels of the screen changed within a second"
  [[ $differ =~ ^[1-9] ]]
}

# Unpacked in the home of the user, nothing installed.
try_archive() {
  local root=$1 archive=$2 folder
  folder=$(basename "$archive" .tar.zst)
  zstd --quiet --decompress --stdout "$archive" | tar --extract --directory "$root/home/person" || return
  as_person "$root" "$folder/bin/nima" run --virtual --seconds 5 --json >"$target/try-archive.json" || return
  say "unpacked from .tar.zst: $(grep -m 1 -o '"final_state": "[a-z]*"' "$target/try-archive.json")"
  rm -rf "${root:?}/home/person/$folder"
}

# By rpm, with its scripts, in a system that has none of its database: dependencies cannot be judged there, nor dnf and zypper.
try_rpm() {
  local root=$1 rpm=$2
  [ -e "$rpm" ] && command -v rpm >/dev/null || return 0
  # The system's programs have their database elsewhere.
  rpm --root "$root" --dbpath /var/lib/rpm --nodeps --nosignature --install "$rpm" || return
  as_person "$root" nima run --virtual --seconds 5 --json >"$target/try-rpm.json" || return
  say "installed from .rpm: $(grep -m 1 -o '"final_state": "[a-z]*"' "$target/try-rpm.json"), group $(grep '^realtime:' "$root/etc/group")"
  rpm --root "$root" --dbpath /var/lib/rpm --nodeps --erase nima-console || return
  nothing_left "$root"
}

# The packages for Windows under wine: what Windows itself does is not known by that.
try_windows() {
  local out=$1 deb=$2 work=$target/try-windows lacks status=0
  [ -e "$(echo "$out"/*-windows.zip)" ] || return 0
  lacks=$(wine_lacks)
  if [ -n "$lacks" ]; then
    leave_out "the packages for Windows were not tried: $lacks"
    return 0
  fi
  rm -rf "$work"
  mkdir -p "$work"
  walk_through_windows "$out" "$deb" "$work" || status=1
  end_wine "$work"
  rm -rf "$work"
  leave_out "the packages for Windows were not tried on Windows, only under wine"
  return $status
}

# The console as a newcomer starts it, and when its force came.
window_in_wine() {
  local work=$1 nima=$2 screen status=0
  Xvfb :97 -screen 0 1600x1000x24 -nolisten tcp -noreset -ac >/dev/null 2>&1 &
  screen=$!
  # Processes that wine started without a display have none.
  end_wine "$work"
  sleep 3
  try_display=:97 in_wine "$work" wine "$nima" console --exit-after 8 --frames frames.json --screenshot window.png || status=1
  kill "$screen"
  wait "$screen" 2>/dev/null || true
  cp "$work/window.png" "$target/try-windows-window.png" && say "wine: the window's start-up: $(tr -d ' \n' <"$work/frames.json" | head -c 200)" || status=1
  return $status
}

walk_through_windows() {
  local out=$1 deb=$2 work=$3 nima installed
  start_wine "$work" || return
  python3 -m zipfile -e "$out"/*-windows.zip "$work" || return
  nima=$(echo "$work"/nima-console-*-windows/nima.exe)
  say "wine: $(in_wine "$work" wine "$nima" --version | tr -d '\r')"
  in_wine "$work" wine "$nima" devices || return
  in_wine "$work" wine "$nima" run --virtual --seconds 10 --record session.mcap --json >"$target/try-windows.json" || return
  # Each replays what the other one recorded: the same ticks, to the last bit.
  dpkg-deb --extract "$deb" "$work/linux" || return
  (cd "$work" && linux/usr/bin/nima run --virtual --seconds 10 --record linux.mcap --json >/dev/null && linux/usr/bin/nima replay session.mcap) || return
  in_wine "$work" wine "$nima" replay linux.mcap || return
  say "wine: $(grep -m 1 -o '"final_state": "[a-z]*"' "$target/try-windows.json")"
  window_in_wine "$work" "$nima" || return
  in_wine "$work" wine "$out"/*-windows-setup.exe /S || return
  installed=$(find "$work/wine" -path '*/Programs/NIMA Console/nima.exe')
  say "wine, installed by the installer: $(in_wine "$work" wine "$installed" --version | tr -d '\r')"
  in_wine "$work" wine "${installed%/*}/uninstall.exe" /S || return
  # It continues from a copy of itself.
  sleep 5
  installed=$(find "$work/wine" -path '*NIMA Console*')
  [ -z "$installed" ] || { say "left behind: $installed"; return 1; }
}
