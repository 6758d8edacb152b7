# The targets of coxa; each does all the set-up it needs. See README.md.
.PHONY: demo tutorial test build web verify bench docs clean deps configure check sanitize

BUILD  := build/release
STRICT := $(if $(CI),ON,OFF)

# Installs what is missing from Debian's packages (quick when nothing is).
deps:
	@tools/install_deps.sh

configure: deps
	@cmake --preset release -DCOXA_WARNINGS_AS_ERRORS=$(STRICT) > build-configure.log 2>&1 \
	  && rm -f build-configure.log || { cat build-configure.log; rm -f build-configure.log; exit 1; }

# The browser application that coxa view serves, into web/dist.
web: deps
	@tools/build_web.sh

# The command at build/release/coxa.
build: configure web
	@cmake --build $(BUILD) --target coxa

# Draws a virtual patient and runs the whole chain on it.
demo: build
	@tools/demo.sh

# Runs the commands of docs/tutorial.md as they stand there.
tutorial: build
	@tools/run_tutorial.py $(BUILD)/coxa build/tutorial

# Everything fast: format, layers, unit tests, the browser application in chromium, some of the sanitizers.
test: check web
	@cmake --build $(BUILD)
	@ctest --test-dir $(BUILD) --output-on-failure --timeout 600 -j 2
	@tools/run_tutorial.py $(BUILD)/coxa build/tutorial
	@tools/test_web.sh $(BUILD)
	@tools/sanitize.sh $(SANITIZED_FAST)

check: configure
	@tools/check_layers.py
	@tools/check_format.sh

# Tests under address and undefined-behaviour sanitizers; make test runs those that build in minutes.
SANITIZED      := core geom solve mesh dynamics collide fem
SANITIZED_FAST := core geom solve dynamics
sanitize: deps
	@tools/sanitize.sh $(SANITIZED)

# Physics against closed forms and published figures.
verify: configure
	@cmake --build $(BUILD) --target coxa_verify
	@$(BUILD)/coxa_verify

# Speed of the hot paths, and coxa beside other programs.
bench: configure
	@tools/install_deps.sh --programs
	@cmake --preset release -DCOXA_BENCHMARKS=ON > /dev/null
	@cmake --build $(BUILD)
	@for program in $(BUILD)/*_bench; do echo "== $$program"; $$program || exit 1; done
	@tools/side_by_side.sh $(BUILD)

# The pages are Markdown in docs/; this checks that every relative link in them leads somewhere.
docs:
	@tools/check_docs.py

clean:
	rm -rf build demo web/dist web/node_modules
