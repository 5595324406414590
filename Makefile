# make build, demo, test, bench, peers, doc. Each gets what is missing by scripts/setup, which says what it does.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.PHONY: build demo test bench peers doc

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

# seconds against error beside other codes, a quarter of an hour; for less: make peers ARGS=--quick
peers: build
	benches/peers/setup && target/peers-env/bin/python benches/peers/run.py $(ARGS)

doc:
	$(setup) && cargo doc --workspace --no-deps "$${STEKLOV_FEATURES[@]}"
	@echo "the pages start at target/doc/steklov/index.html"
