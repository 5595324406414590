# make build, demo, test, bench, doc. Each gets what is missing by scripts/setup, which says what it does.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.PHONY: build demo test bench doc

setup = scripts/setup && source target/setup.env

build:
	$(setup) && cargo build --release --package steklov "$${STEKLOV_FEATURES[@]}"
	@echo "the command is target/release/steklov"

demo: build
	mkdir -p out
	target/release/steklov solve scenes/block-on-floor.toml --out out/block-on-floor.vtkhdf --plots out --force
	@echo "the result and its pictures are in out:" && ls -l out

test:
	$(setup) && scripts/test "$${STEKLOV_FEATURES[@]}"

bench:
	$(setup) && cargo bench --workspace "$${STEKLOV_FEATURES[@]}"

doc:
	$(setup) && cargo doc --workspace --no-deps "$${STEKLOV_FEATURES[@]}"
	@echo "the pages start at target/doc/steklov/index.html"
