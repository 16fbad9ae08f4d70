# Tries the .rpm where rpm, dnf and zypper alone manage the system, with its dependencies. The system's libraries are Debian's, from the archive that the other
# systems come from too, turned into .rpm packages; what they provide and require rpm finds as it does on Fedora. It is not Fedora. Sourced by try.sh; needs root.
# shellcheck shell=bash

rpm_root_tools=(debootstrap dnf createrepo-c rpm dpkg xvfb xdotool imagemagick)
# What an rpm system has before anything is installed. Nothing of a window.
rpm_root_system=(bash dash coreutils findutils grep sed mawk util-linux login passwd libpam-runtime libc-bin)

try_rpm_root() {
  local rpm=$1 work=$target/try-rpm status=0 tool
  [ -e "$rpm" ] || { leave_out "the .rpm was not tried in a root managed by dnf: there is none"; return 0; }
  [ "$(id -u)" -eq 0 ] || { leave_out "the .rpm was not tried in a root managed by dnf: that needs root"; return 0; }
  need "${rpm_root_tools[@]}" || true
  need zypper || true
  for tool in debootstrap dnf createrepo_c rpmbuild Xvfb; do
    command -v "$tool" >/dev/null || { leave_out "the .rpm was not tried in a root managed by dnf: $tool is missing"; return 0; }
  done
  rm -rf --one-file-system "$work"
  mkdir -p "$work"
  say "a root managed by dnf and rpm, of Debian's libraries turned into .rpm packages; not Fedora itself"
  walk_through_rpm "$rpm" "$work" || status=1
  cp "$work/log" "$target/try-rpm.log"
  rm -rf --one-file-system "$work"
  leave_out "the .rpm was not tried on Fedora, RHEL or openSUSE themselves: their archives are not at hand; it was installed in a root of Debian's libraries as .rpm packages"
  return $status
}

walk_through_rpm() {
  local rpm=$1 work=$2 root=$2/root packages files
  make_rpm_repository "$work" >>"$work/log" 2>&1 && make_rpm_root "$work" "$root" >>"$work/log" 2>&1 || { tail -n 20 "$work/log"; return 1; }
  settle_newcomer "$root" || return
  packages=$(in_rpm "$work" -qa | sort) files=$(files_of_rpm_root "$root")
  say "rpm root: $(wc -l <<<"$packages") packages, of $(find "$work/repository" -name '*.rpm' | wc -l) that can be had; the .rpm asks for $(names_of_rpm "$rpm" | wc -l) names, of which they lack $(nobody_provides "$work" "$rpm" | wc -l)"
  without_a_window "$work" "$root" "$rpm" || return
  at_a_screen newcomer_with_rpm dnf "$work" "$root" "$rpm" || return
  with_dnf "$work" remove nima-console || return
  nothing_left "$root" || return
  diff <(printf '%s\n' "$packages") <(in_rpm "$work" -qa | sort) >&2 || { say "dnf left other packages than before"; return 1; }
  diff <(printf '%s\n' "$files") <(files_of_rpm_root "$root") >&2 || { say "other files than before are left"; return 1; }
  say "rpm root: dnf removed it and all that came with it; the same $(wc -l <<<"$files") files as before are left, and the user's own"
  command -v zypper >/dev/null || { leave_out "the .rpm was not tried by zypper, which is missing"; return 0; }
  at_a_screen newcomer_with_rpm zypper "$work" "$root" "$rpm" || return
  with_zypper "$work" remove nima-console || return
  nothing_left "$root" || return
  say "rpm root: zypper removed it; nothing of it is left but the user's files"
}

# Without what is the user's, and what dnf and rpm note for themselves.
files_of_rpm_root() {
  find "$1" -xdev \( -path "$1/home/person" -o -path "$1/var/cache/dnf" -o -path "$1/var/lib/dnf" -o -path "$1/var/lib/rpm" -o -path "$1/var/log" \) -prune -o ! -type d -printf '%P\n' | sort
}

# With what is required alone, for a computer without a screen: the loop runs.
without_a_window() {
  local work=$1 root=$2 rpm=$3
  with_dnf "$work" install --setopt=install_weak_deps=False "$rpm" || return
  as_person "$root" nima run --virtual --seconds 5 --json >"$target/try-rpm.json" || return
  say "rpm root: without what it recommends $(in_rpm "$work" -qa | wc -l) packages, and $(grep -m 1 -o '"final_state": "[a-z]*"' "$target/try-rpm.json")"
  with_dnf "$work" remove nima-console
}

newcomer_with_rpm() {
  local manager=$1 work=$2 root=$3 rpm=$4 began=$SECONDS installed lacking
  "install_by_$manager" "$work" "$rpm" || return
  installed=$((SECONDS - began))
  lacking=$(nobody_provides "$work" "$rpm")
  [ -z "$lacking" ] || { say "provided by nothing after $manager installed it: $lacking"; return 1; }
  in_rpm "$work" --verify nima-console || return
  say "rpm root: $manager installed it in $installed s; $(in_rpm "$work" -qa | wc -l) packages now, and every name that it asks for is provided"
  first_minutes "rpm root, $manager" "rpm-$manager" "$root" "$began"
}

# The packages of a minimal Debian, and of a window: those that the .deb recommends, so that a name only in the .rpm is found by nobody.
make_rpm_repository() {
  local work=$1 window
  window=$(sed -n 's/^Recommends: //p' assets/package/deb/control | tr -d ' ')
  debootstrap --variant=minbase --download-only --include="$window" bookworm "$work/debian" http://deb.debian.org/debian &&
    python3 assets/package/rpm/from_debian.py "$work/debian/var/cache/apt/archives" "$work" &&
    rm -rf "$work/debian" "$work/work" &&
    createrepo_c --quiet "$work/repository"
}

make_rpm_root() {
  local work=$1 root=$2
  # The database lies where rpm systems have it, which is not where Debian's rpm would make it.
  echo '%_dbpath /var/lib/rpm' >"$work/.rpmmacros"
  mkdir -p "$root/dev"
  mknod -m 666 "$root/dev/null" c 1 3 && mknod -m 666 "$root/dev/zero" c 1 5 && mknod -m 666 "$root/dev/random" c 1 8 &&
    mknod -m 666 "$root/dev/urandom" c 1 9 && mknod -m 666 "$root/dev/tty" c 5 0 && ln -s pts/ptmx "$root/dev/ptmx" && ln -s /proc/self/fd "$root/dev/fd" || return
  with_dnf "$work" install "${rpm_root_system[@]}"
}

# As a person types it, but from outside; that recommended packages come too is the default of both.
install_by_dnf() { with_dnf "$1" install "$2"; }
install_by_zypper() { with_zypper "$1" install --allow-unsigned-rpm "$2"; }

with_dnf() {
  local work=$1
  shift
  HOME=$work dnf --installroot="$work/root" --releasever=1 --setopt=reposdir=/nonexistent --repofrompath="here,file://$work/repository" --setopt=here.gpgcheck=0 --setopt=localpkg_gpgcheck=0 \
    --noplugins --assumeyes "$@" >>"$work/log" 2>&1 || { tail -n 20 "$work/log"; return 1; }
}

with_zypper() {
  local work=$1
  shift
  HOME=$work zypper --root "$work/root" --releasever 1 --plus-repo "file://$work/repository" --no-gpg-checks --non-interactive "$@" >>"$work/log" 2>&1 || { tail -n 20 "$work/log"; return 1; }
}

in_rpm() {
  local work=$1
  shift
  HOME=$work rpm --root "$work/root" "$@"
}

# All that the .rpm requires and recommends, but for what rpm itself can do.
names_of_rpm() { rpm -qp --requires --recommends "$1" | grep -v '^rpmlib(' | sort -u; }

nobody_provides() {
  local work=$1 name
  while read -r name; do
    in_rpm "$work" -q --whatprovides "$name" >/dev/null 2>&1 || echo "$name"
  done < <(names_of_rpm "$2")
}
