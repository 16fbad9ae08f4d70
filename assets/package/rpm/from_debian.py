#!/usr/bin/env python3
"""Debian's packages as .rpm packages: `from_debian.py FOLDER_OF_DEBS OUT`, for a system that is managed by rpm alone. What a library provides and what a program
needs of it is found by rpm's own generator, as on Fedora: sonames with their versions. No script of Debian's runs: what theirs would write, the package
`filesystem` brings."""

import subprocess
import sys
from pathlib import Path

# Debian's own way of managing a system.
NOT_TAKEN = {"adduser", "apt", "base-files", "base-passwd", "debconf", "debian-archive-keyring", "debianutils", "dpkg", "init-system-helpers", "perl-base", "usr-is-merged"}
MERGED = ["bin", "sbin", "lib", "lib32", "lib64", "libx32"]
# What only people and compilers read.
NOT_NEEDED = ["doc", "man", "locale", "info", "lintian", "bug", "pkgconfig"]
# What stands in no file, and Fedora's packages of these libraries say themselves: which tables the linker knows, and what is loaded only when it is used.
PROVIDES = {"libc6": ["rtld(GNU_HASH)"]}
REQUIRES = {
    "libglx0": ["libglx-mesa0"],
    "libegl1": ["libegl-mesa0"],
    "libglx-mesa0": ["libgl1-mesa-dri"],
    "libegl-mesa0": ["libgl1-mesa-dri"],
    "libx11-6": ["libx11-data"],
    "libxkbcommon0": ["xkb-data"],
    "util-linux": ["libpam-modules", "libpam-runtime"],
    "passwd": ["libpam-modules", "libpam-runtime"],
}
# Links that scripts of Debian make (update-alternatives).
LINKS = {"mawk": {"usr/bin/awk": "mawk"}}
DIRECTORIES = {"proc": 0o555, "sys": 0o555, "root": 0o700, "tmp": 0o1777, "var/tmp": 0o1777} | dict.fromkeys(
    ["dev/pts", "dev/shm", "etc/pam.d", "home", "mnt", "run", "usr", "var/cache", "var/lib", "var/log"] + [f"usr/{name}" for name in MERGED], 0o755
)
ACCOUNTS = {
    "etc/passwd": ("root:x:0:0:root:/root:/bin/bash\n", 0o644),
    "etc/shadow": ("root:*:19000:0:99999:7:::\n", 0o600),
    "etc/group": ("root:x:0:\ntty:x:5:\nutmp:x:22:\nshadow:x:42:\nusers:x:100:\n", 0o644),
    "etc/gshadow": ("root:*::\ntty:*::\nutmp:*::\nshadow:*::\nusers:*::\n", 0o600),
} | {f"etc/pam.d/common-{kind}": (f"{kind.split('-')[0]} required pam_unix.so\n", 0o644) for kind in ["account", "auth", "password", "session", "session-noninteractive"]}
SPEC = """
Name: filesystem
Version: 1
Release: 1
Summary: Directories, accounts and links of a merged /usr
License: of each package
%description
%{summary}.
%install
cp -a --link %{tree}/. %{buildroot}
%files -f %{lists}/filesystem
"""
PACKAGE = """
%package -n NAME
Version: VERSION
Release: RELEASE
LINES
Summary: Debian's package of this name
Requires(pre): filesystem
%description -n NAME
%{summary}.
%files -n NAME -f %{lists}/NAME
"""
# As Fedora's glibc does after every transaction.
LDCONFIG = "".join(f"\n%{trigger} -n libc-bin -- /usr/lib\n/usr/sbin/ldconfig\n" for trigger in ["transfiletriggerin", "transfiletriggerpostun"])


def name_and_version(deb):
    return subprocess.run(["dpkg-deb", "--show", "--showformat=${Package} ${Version}", deb], check=True, capture_output=True, text=True).stdout.split()


def extract(deb, tree):
    """All but what is not needed to run it, with /bin and its like moved below /usr."""
    moved = r"s,^\./\({}\)\(/\|$\),./usr/\1\2,S".format(r"\|".join(MERGED))
    unpack = ["tar", "--extract", "--directory", tree, f"--transform={moved}"] + [f"--exclude=./usr/share/{name}/*" for name in NOT_NEEDED]
    with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", deb], stdout=subprocess.PIPE) as archive:
        subprocess.run(unpack, stdin=archive.stdout, check=True)


def own(tree):
    """The files and links of a package as a list for rpm. Whatever is a program or a library may be executed, or rpm does not look into it."""
    listed = []
    for path in sorted(tree.rglob("*")):
        if path.is_file() and not path.is_symlink():
            with path.open("rb") as opened:
                if opened.read(4) == b"\x7fELF":
                    path.chmod(path.stat().st_mode | 0o111)
        elif path.is_dir() and not path.is_symlink():
            continue
        listed.append(f"/{path.relative_to(tree)}")
    return listed


def file_list(paths):
    return "%defattr(-,root,root,-)\n" + "".join('"{}"\n'.format(path.replace("%", "%%")) for path in paths)


def make_filesystem(tree):
    for name in DIRECTORIES:
        (tree / name).mkdir(parents=True, exist_ok=True)
    for name in MERGED:
        (tree / name).symlink_to(f"usr/{name}")
    for name, (text, mode) in ACCOUNTS.items():
        (tree / name).write_text(text)
        (tree / name).chmod(mode)
    listed = [f"%dir %attr({mode:o},root,root) /{name}" for name, mode in DIRECTORIES.items()]
    listed += [f"/{name}" for name in MERGED] + [f"%config(noreplace) /{name}" for name in ACCOUNTS]
    return "%defattr(-,root,root,-)\n" + "\n".join(listed) + "\n"


def package(name, version, files):
    epoch, _, version = version.rpartition(":")
    version, _, revision = version.partition("-")
    merged = [path.removeprefix("/usr") for path in files if path.startswith(("/usr/bin/", "/usr/sbin/"))]
    lines = [f"Epoch: {epoch}"] * bool(epoch) + [f"Provides: {what}" for what in merged + PROVIDES.get(name, [])] + [f"Requires: {what}" for what in REQUIRES.get(name, [])]
    return PACKAGE.replace("NAME", name).replace("VERSION", version).replace("RELEASE", revision.replace("-", ".") or "1").replace("LINES", "\n".join(lines))


def main():
    debs, out = Path(sys.argv[1]), Path(sys.argv[2]).resolve()
    work = out / "work"
    tree, lists = work / "tree", work / "files"
    lists.mkdir(parents=True)
    taken = {name: (deb, version) for deb in sorted(debs.glob("*.deb")) for name, version in [name_and_version(deb)] if name not in NOT_TAKEN}
    tree.mkdir()
    (lists / "filesystem").write_text(make_filesystem(tree))
    spec = SPEC
    for name, (deb, version) in taken.items():
        own_tree = work / "packages" / name
        own_tree.mkdir(parents=True)
        extract(deb, own_tree)
        for link, target in LINKS.get(name, {}).items():
            (own_tree / link).symlink_to(target)
        files = own(own_tree)
        (lists / name).write_text(file_list(files))
        spec += package(name, version, files)
        subprocess.run(["cp", "-a", "--link", f"{own_tree}/.", tree], check=True)
    (work / "all.spec").write_text(spec + LDCONFIG)
    given = {
        "tree": tree,
        "lists": lists,
        "_topdir": work,
        "_rpmdir": out / "repository",
        "_binary_payload": "w.ufdio",
        "_build_id_links": "none",
        "debug_package": "%{nil}",
        "__os_install_post": "%{nil}",
        "_build_name_fmt": "%%{NAME}-%%{VERSION}-%%{RELEASE}.%%{ARCH}.rpm",
        "__requires_exclude": "^(/usr/bin/)?perl",
    }
    defined = [word for name, text in given.items() for word in ("--define", f"{name} {text}")]
    subprocess.run(["rpmbuild", "-bb", "--quiet", "--target", "x86_64", *defined, work / "all.spec"], check=True)
    print(f"{len(taken)} packages of Debian's as .rpm packages")


if __name__ == "__main__":
    main()
