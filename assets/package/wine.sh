# Programs for Windows under wine, each user with a separate wine in a folder. Sourced by try.sh and by ./dev windows.
# shellcheck shell=bash

wine_tools=(wine wine64)

# Why nothing can be run here; nothing when it can.
wine_lacks() {
  command -v wine >/dev/null || need "${wine_tools[@]}" >&2 || true
  command -v wine >/dev/null || echo "wine is missing (Debian's packages ${wine_tools[*]})"
}

# Runs a command in the folder, with its wine, without asking for what wine would fetch.
in_wine() {
  local work=$1
  shift
  (cd "$work" && env DISPLAY="${try_display:-}" WINEPREFIX="$work/wine" WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml=' timeout "${wine_limit_s:-300}" "$@")
}

start_wine() {
  in_wine "$1" wine wineboot --init && lend_random_numbers "$1"
}

# Ends what still runs in it.
end_wine() {
  in_wine "$1" wine wineboot --kill || true
}

# Wine before version 9 lacks a library that Rust's programs ask for random numbers.
lend_random_numbers() {
  local work=$1 library=$1/wine/drive_c/windows/system32/bcryptprimitives.dll
  [ ! -e "$library" ] || return 0
  x86_64-w64-mingw32-gcc -O2 -shared -o "$library" -xc - -ladvapi32 <<'C'
#include <windows.h>
BOOLEAN NTAPI SystemFunction036(PVOID, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE to, SIZE_T count) { return SystemFunction036(to, (ULONG)count); }
C
}
