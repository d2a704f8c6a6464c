# Everything a user or developer types. `make help` lists it; CMakePresets.json mirrors the builds.

SHELL := /bin/bash
BUILD ?= build
JOBS ?= $(shell nproc)
CAPTURE ?=
CMAKE_FLAGS ?=

# Debian packages: to build, and on top of that to test.
BUILD_PACKAGES := ca-certificates cmake g++ ninja-build libeigen3-dev libfmt-dev libfast-float-dev \
  nlohmann-json3-dev libxxhash-dev libhwy-dev libtinygltf-dev libassimp-dev libopenexr-dev \
  libcli11-dev help2man libembree-dev libpng-dev libjpeg-dev libfreetype-dev libceres-dev \
  libbullet-dev libmeshoptimizer-dev libdraco-dev libzip-dev zlib1g-dev fonts-dejavu-core
TEST_PACKAGES := libgtest-dev libgmock-dev libbenchmark-dev clang-format python3 \
  chromium openexr python3-jsonschema python3-numpy python3-pandas python3-xxhash liborocos-kdl-dev pkg-config ffmpeg librsvg2-bin
LINT_PACKAGES := clang-tidy
DEB_PACKAGES := debhelper dh-python python3-all fakeroot lintian
FUZZ_PACKAGES := afl++
CLUSTER_PACKAGES := snakemake slurm-wlm munge

# CPU minutes of what follows, added to the log under a part of the budget: $(call timed,build) COMMAND
MINUTES_LOG = $(BUILD)/minutes.log
timed = python3 tests/minutes/minutes.py $(MINUTES_LOG) run $(1)

SOURCES = git ls-files --cached --others --exclude-standard '*.cpp' '*.h'

.DEFAULT_GOAL := all
.PHONY: help deps test-deps lint-deps configure all demo quick test test-build compiled-tests sanitize \
  sanitize-list tsan coverage bench cluster-test fuzz golden format format-check lint check-changed \
  headers time minutes install deb tarball clean

help:
	@echo "make demo                   build, then capture -> animated glTF on the samples, see out/demo"
	@echo "make demo CAPTURE=FILE.bvh  the same with your own capture"
	@echo "make quick                  the same with four tools and a page alone, see out/quick"
	@echo "make test                   everything that must pass: format, tests, validator"
	@echo
	@echo "make all       build the tools into $(BUILD)/bin (the default)"
	@echo "make deps      install the Debian packages that the build needs and lacks"
	@echo "make sanitize  the tests under AddressSanitizer and UndefinedBehaviorSanitizer; those that take"
	@echo "               long there, too, with ALL=1"
	@echo "make tsan      the tests under ThreadSanitizer"
	@echo "make fuzz      every reader and many operations under AFL++; MINUTES=60 for all together, of each"
	@echo "               core; TARGETS='bvh operations' for some of them"
	@echo "make cluster-test  samples/cluster with Slurm, 50 times killed; installs Snakemake and Slurm"
	@echo "make bench     benchmarks, as ratios against a reference in the same run"
	@echo "make golden    write golden files that are missing and renew the generated pages; with FORCE=1"
	@echo "               replace golden files that differ, too: review them as a diff"
	@echo "make format    clang-format all sources"
	@echo "make lint      clang-tidy, and each public header by itself; FILES='a.cpp b.cpp' for some sources"
	@echo "make check-changed  what changed in the last three days: compiled alone, and by clang-tidy"
	@echo "make time      where the minutes of the last builds and tests went"
	@echo "make install   install tools, library and headers (PREFIX=/usr/local, DESTDIR=)"
	@echo "make deb       Debian packages krok, libkrok-dev, python3-krok in build-deb"
	@echo "make tarball   the tools with the libraries they need, for any x86-64 Linux, in build-tarball"
	@echo "make clean     remove the build folders"

# install-missing PACKAGES: apt-get only for what is not there, so that no network and no root are
# needed once everything is. Elsewhere than on Debian and its like it only names what is needed.
define install-missing
	@if ! command -v apt-get > /dev/null || ! command -v dpkg-query > /dev/null; then \
	  echo "no apt-get here; needed, by Debian's names: $(1)"; exit 0; fi; \
	missing=""; for package in $(1); do \
	  dpkg-query -W -f '$${Status}' $$package 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$package"; \
	done; \
	if [ -n "$$missing" ]; then \
	  sudo=""; if [ "$$(id -u)" -ne 0 ]; then sudo=sudo; fi; \
	  echo "installing:$$missing"; \
	  $$sudo apt-get update -q && $$sudo env DEBIAN_FRONTEND=noninteractive \
	    apt-get install -y -q --no-install-recommends $$missing; \
	fi
endef

# Node may come from elsewhere than Debian; npm, too. They bundle the viewer page.
deps:
	$(call install-missing,$(BUILD_PACKAGES))
	$(call install-missing,$(if $(shell command -v node),,nodejs) $(if $(shell command -v npm),,npm))

test-deps: deps
	$(call install-missing,$(TEST_PACKAGES))
	cd tests && npm ci --no-audit --no-fund --loglevel=error

lint-deps: test-deps
	$(call install-missing,$(LINT_PACKAGES))

# Percent and seconds of a build.
export NINJA_STATUS = [%p, %es] 

configure: deps
	@echo "== configure $(BUILD)"
	@cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release $(CMAKE_FLAGS) > $(BUILD)-configure.log \
	  2>&1 || { cat $(BUILD)-configure.log; exit 1; }; mv $(BUILD)-configure.log $(BUILD)/configure.log

all: configure
	@echo "== build with $(JOBS) jobs"
	@cmake --build $(BUILD) -j $(JOBS) $(if $(TARGETS),--target $(TARGETS))

demo: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF
demo: all
	@echo "== from a capture to a character: samples/walk_to_gltf"
	@KROK_BIN=$(BUILD)/bin samples/walk_to_gltf/run.sh $(if $(CAPTURE),"$(CAPTURE)")
	@echo "== a walk on a hill, stairs and stones: samples/walk_on_terrain"
	@KROK_BIN=$(abspath $(BUILD))/bin SAMPLES_BIN=$(abspath $(BUILD))/samples samples/walk_on_terrain/run.sh out/demo/walk

quick: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF
quick: TARGETS = krok-import krok-body krok-skin krok-view
quick: all
	@KROK_BIN=$(BUILD)/bin samples/walk_to_gltf/run.sh --quick $(if $(CAPTURE),"$(CAPTURE)")

test-build: CMAKE_FLAGS += -DKROK_BUILD_TESTS=ON
test-build: test-deps all

# The build is a make of its own, for in `make demo test` the demo's is one without tests.
test: test-deps format-check
	@$(call timed,build) $(MAKE) test-build
	@rm -rf $(BUILD)/test_results
	@$(call timed,run) ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure
	@python3 tests/count_tests.py $(BUILD)/test_results

compiled-tests:
	@$(MAKE) test-build TARGETS=krok_compiled_tests

# The sanitizers take what reads, computes and writes, and leave out what only draws or measures, and
# what takes long there (tests/sanitizers/slow_tests.txt) but with ALL=1. Tests themselves are those of
# the release build.
ALL ?=
sanitize: test-deps
	@$(call timed,build) $(MAKE) compiled-tests
	@cmake --preset asan -DKROK_TEST_OBJECTS=$(abspath $(BUILD)) -DKROK_SLOW_TESTS=$(if $(ALL),ON,OFF) $(CMAKE_FLAGS) > /dev/null
	@$(call timed,build) cmake --build --preset asan -j $(JOBS)
	@rm -rf build-asan/test_results
	@$(call timed,run) ctest --preset asan -j $(JOBS)
	@python3 tests/count_tests.py build-asan/test_results

# The share of the library's lines that these tests run.
coverage: test-deps
	@$(MAKE) compiled-tests
	@cmake --preset coverage -DKROK_TEST_OBJECTS=$(abspath $(BUILD)) -DKROK_SLOW_TESTS=$(if $(ALL),ON,OFF) $(CMAKE_FLAGS) > /dev/null
	cmake --build --preset coverage -j $(JOBS)
	find build-coverage -name '*.gcda' -delete
	ctest --preset coverage -j $(JOBS)
	python3 tests/sanitizers/line_coverage.py . build-coverage

# Which tests those are, by their times in `make sanitize`, or in `make test` where they are left out.
sanitize-list:
	python3 tests/sanitizers/slow_tests.py $(BUILD) build-asan > tests/sanitizers/slow_tests.tmp
	mv tests/sanitizers/slow_tests.tmp tests/sanitizers/slow_tests.txt

tsan: test-deps
	cmake --preset tsan $(CMAKE_FLAGS)
	cmake --build --preset tsan -j $(JOBS)
	ctest --preset tsan -j $(JOBS)

MINUTES ?= 60
fuzz: test-deps
	$(call install-missing,$(FUZZ_PACKAGES))
	cmake --preset fuzz $(CMAKE_FLAGS)
	cmake --build --preset fuzz -j $(JOBS)
	python3 tests/guided/fuzz.py build-fuzz/tests/krok_targets --minutes $(MINUTES) --jobs $(JOBS) $(TARGETS)

cluster-test: test-build
	$(call install-missing,$(CLUSTER_PACKAGES))
	python3 tests/cluster/cluster_test.py $(BUILD)/bin $(BUILD)/samples/make-walk . --kills 50 --captures 200

bench: CMAKE_FLAGS += -DKROK_BUILD_TESTS=ON -DKROK_BUILD_BENCHMARKS=ON
bench: test-deps all
	@for program in $(BUILD)/bench/*; do echo "== $$(basename $$program)"; $$program || exit 1; done

golden: test-build
	tests/golden/update.sh $(if $(FORCE),--force) $(BUILD)

format: test-deps
	$(SOURCES) | xargs clang-format -i

# Versions of clang-format differ in what they break where; Debian 12's decides.
format-check:
	$(call install-missing,clang-format)
	@case "$$(clang-format --version)" in \
	  *"version 14."*) $(SOURCES) | xargs clang-format --dry-run --Werror;; \
	  *) echo "format not checked: that takes clang-format 14, and here is $$(clang-format --version)";; \
	esac

# The sources of a folder as one, since nine tenths of the time go into their headers. The analyzer
# follows paths through the sources of a unit only if its name has this word. With FILES each source
# alone, as a build without unity compiles it, so that a forgotten #include shows.
FILES ?=
LINT_UNITS = cmake --preset lint -B build-lint/units -DKROK_UNITY=ON \
  -DKROK_UNITY_PREFIX=UnifiedSource_ > /dev/null && \
  grep -o '"file": "[^"]*"' build-lint/units/compile_commands.json | cut -d '"' -f 4 | grep -v page_text | sort -u | \
  xargs -P $(JOBS) -n 1 clang-tidy -p build-lint/units --quiet --checks=-bugprone-suspicious-include
lint: lint-deps headers
	cmake --preset lint > /dev/null
	@$(if $(FILES),echo $(FILES) | xargs -P $(JOBS) -n 1 clang-tidy -p build-lint --quiet,$(LINT_UNITS))

# Every source and header that changed since the newest commit that CI passed.
check-changed: lint-deps
	@cmake --preset lint > /dev/null
	@cmake --preset lint -B build-lint/alone -DKROK_PRECOMPILED_HEADERS=ON > /dev/null
	@cmake --build build-lint/alone -j $(JOBS) --target krok_precompiled_library krok_precompiled_format \
	  krok_precompiled_tool krok_precompiled_test > /dev/null
	@$(call timed,check) python3 tests/arch/check_changed.py . build-lint --alone build-lint/alone --jobs $(JOBS)

# Would not compile if a public header needed another one to be included before it.
headers: deps
	@git ls-files --cached --others --exclude-standard 'lib/*.h' 'formats/*.h' | grep -v '_internal\.h$$' | \
	  xargs -P $(JOBS) -I{} sh -c 'echo "#include \"{}\"" | $(CXX) -std=c++20 -fsyntax-only -Wall \
	    -I. -Ilib -isystem /usr/include/eigen3 -x c++ - || { echo "{}: does not stand by itself"; exit 255; }'

# Job seconds and tests' seconds of the last builds, from ninja's log and the tests' reports.
time:
	@python3 tests/minutes/build_times.py $(wildcard $(BUILD) build-asan)

# CPU minutes of the commands above against their budget.
minutes:
	@python3 tests/minutes/minutes.py $(MINUTES_LOG) report

PREFIX ?= /usr/local
install: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF -DCMAKE_INSTALL_PREFIX=$(PREFIX)
install: all
	cmake --install $(BUILD)

# Packages of what git has, in build-deb. nodejs and npm may come from elsewhere than Debian, hence -d.
deb: deps
	$(call install-missing,$(DEB_PACKAGES))
	rm -rf build-deb && mkdir -p build-deb/krok
	git ls-files -z -- ':!packaging' | xargs -0 cp --parents -t build-deb/krok
	cp -r packaging/debian build-deb/krok/
	cd build-deb/krok && dpkg-buildpackage -b -us -uc -d -j$(JOBS)
	lintian --pedantic --fail-on error,warning build-deb/*.changes

tarball: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF
tarball: all
	$(call install-missing,patchelf)
	packaging/tarball.sh $(BUILD) build-tarball

clean:
	rm -rf $(BUILD) build build-asan build-tsan build-coverage build-debug build-lint build-deb build-tarball out
