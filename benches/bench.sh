# The benchmarks, and the ratios that are kept of them. Sourced by ./dev.
# shellcheck shell=bash

baseline=benches/baseline.toml

bench() {
  need_cargo
  need "${build_packages[@]}" || exit 1
  local name
  case "${1:-}" in
    "")
      for name in identification tip_force whole_tick tap plots; do cargo_bench "$name"; done
      compare_ratios
      ;;
    --ratios) compare_ratios ;;
    --store) store_ratios ;;
    *) say "give nothing, --ratios (only what is compared) or --store (renew what it is compared with)"; exit 2 ;;
  esac
}

# --workspace: the same features as everything else, so that nothing is built twice.
cargo_bench() {
  local name=$1
  shift
  cargo bench --locked --workspace --bench "$name" -- "$@"
}

# Cost of the alternatives as multiples of ours: the median of five runs of each program, each at other addresses in memory.
ratios() {
  local run name
  for run in 1 2 3 4 5; do
    say "ratios, run $run of 5"
    for name in identification tip_force plots; do cargo_bench "$name" --ratios || exit; done
  done | awk '$1 == "ratio" { print $2, $3 }' | sort -k 1,1 -k 2,2g | awk '
    function tell() { if (count) printf "%s = %.4g\n", name, values[int((count + 1) / 2)] }
    $1 != name { tell(); name = $1; count = 0 }
    { values[++count] = $2 }
    END { tell() }'
}

store_ratios() {
  local now
  now=$(ratios)
  { grep '^#' "$baseline"; printf '%s\n' "$now"; } >"$baseline.new"
  mv "$baseline.new" "$baseline"
  cat "$baseline"
}

# Fails if our code is more than 10 % slower relative to an alternative, or if a stored ratio is no longer measured.
compare_ratios() {
  local now
  now=$(ratios)
  awk '
    $2 != "=" { next }
    FILENAME != "-" { stored[$1] = $3; next }
    {
      seen[$1]
      if (!($1 in stored)) { printf "%-36s %8s, none stored\n", $1, $3; next }
      worse = $3 < stored[$1] / 1.1
      printf "%-36s %8s, stored %8s, %+6.1f %%%s\n", $1, $3, stored[$1], 100 * ($3 / stored[$1] - 1), worse ? "  WORSE" : ""
      failed += worse
    }
    END {
      for (name in stored) if (!(name in seen)) { print name ": not measured"; failed++ }
      exit failed > 0
    }' "$baseline" - <<<"$now" || { say "worse than $baseline by more than 10 % (renew it with: ./dev bench --store)"; exit 1; }
}
