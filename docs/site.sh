# The pages as a site. Sourced by ./dev.
# shellcheck shell=bash

mdbook_version=0.5.4

# Builds the pages as a site, in target/site. README, ARCHITECTURE and the other files outside docs/ become pages of it. Every link of the
# finished pages must lead to a file and a heading.
docs() {
  need_cargo
  need "${build_packages[@]}" python3 || exit 1
  local folder=${CARGO_TARGET_DIR:-target} page
  local tool=$folder/tools/bin/mdbook book=$folder/book
  [ -x "$tool" ] || tool=$(command -v mdbook) || {
    timed cargo install --locked --quiet --version "$mdbook_version" --no-default-features --features search --root "$folder/tools" mdbook
    tool=$folder/tools/bin/mdbook
  }
  rm -rf "$book" && mkdir -p "$book/src/reference"
  cp docs/book.toml "$book/"
  cp docs/*.md docs/*.png "$book/src/"
  cp docs/reference/*.md "$book/src/reference/"
  for page in README ARCHITECTURE CONTRIBUTING CHANGELOG; do
    sed -E 's#\]\(docs/#](#g' "$page.md" >"$book/src/${page,,}.md"
  done
  # Old entries of the changelog name pages that no longer exist.
  sed -E -i 's#\[([^]]*)\]\([a-z-]+\.md[^)]*\)#\1#g' "$book/src/changelog.md"
  # mdBook would turn a page called README into an index.
  mv "$book/src/readme.md" "$book/src/first-minute.md"
  sed -E -i 's#\]\((\.\./)?README\.md#](first-minute.md#g; s#\]\((\.\./)?(ARCHITECTURE|CONTRIBUTING|CHANGELOG)\.md#](\L\2.md#g' "$book"/src/*.md
  # Files of the source, results and decisions are not part of the site: their names remain, without a link.
  sed -E -i 's#\[([^]]*)\]\((\.\./)?(config|src|ui|tests|assets|python|results|decisions)/[^)]*\)#\1#g' "$book"/src/*.md
  "$tool" build "$book" --dest-dir "$PWD/$folder/site"
  python3 tests/site_links.py "$folder/site"
  say "the site: $folder/site/index.html"
}
