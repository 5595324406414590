# make build, demo, gallery, test, bench, peers, curves, locking, doc, book. Each gets what is missing by scripts/setup, which says what it does.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.PHONY: build demo gallery test bench peers curves locking doc book

setup = scripts/setup && source target/setup.env

build:
	$(setup) && cargo build --release --package steklov "$${STEKLOV_FEATURES[@]}"
	@echo "the command is target/release/steklov"

demo: build
	mkdir -p out
	target/release/steklov solve scenes/block-on-floor.toml --out out/block-on-floor.vtkhdf --plots out --force
	@echo "the result and its pictures are in out:" && ls -l out

# the figures of the source as one page, three minutes
gallery: build
	target/release/steklov gallery --out out/gallery --force

test:
	$(setup) && scripts/test "$${STEKLOV_FEATURES[@]}"

bench:
	$(setup) && cargo bench --workspace "$${STEKLOV_FEATURES[@]}"

# seconds against error beside other codes, a quarter of an hour; for less: make peers ARGS=--quick
peers: build
	benches/peers/setup && target/peers-env/bin/python benches/peers/run.py $(ARGS)

# what polygons cost that stand for curves, and plates with holes beside NGSolve; ten minutes, ARGS=--quick three
curves: build
	scripts/python-env target/curves-env numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 ngsolve==6.2.2608
	mkdir -p target/curves && target/curves-env/bin/python benches/curves/facets.py target/release/steklov target/curves
	target/curves-env/bin/python benches/curves/plate.py target/release/steklov target/curves $(ARGS)

# errors as Poisson's ratio tends to 1/2, beside finite elements that lock
locking: build
	scripts/python-env target/locking-env numpy==2.4.6 scipy==1.17.1 scikit-fem==12.0.2
	mkdir -p target/locking && target/locking-env/bin/python benches/locking/q1.py target/locking/q1.json
	target/release/steklov study benches/locking/cook.toml --what stability --beside target/locking/q1.json --out target/locking --force

doc:
	$(setup) && cargo doc --workspace --no-deps "$${STEKLOV_FEATURES[@]}"
	@echo "the pages start at target/doc/steklov/index.html"

# the guide and the theory as HTML
book:
	scripts/book
