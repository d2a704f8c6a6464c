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
  fonts-dejavu-core
TEST_PACKAGES := libgtest-dev libgmock-dev libbenchmark-dev clang-format python3 \
  chromium openexr python3-jsonschema
LINT_PACKAGES := clang-tidy

SOURCES = git ls-files --cached --others --exclude-standard '*.cpp' '*.h'

.DEFAULT_GOAL := all
.PHONY: help deps test-deps lint-deps all demo test unit-test bench asan tsan golden format \
  format-check lint install clean

help:
	@echo "make demo                   build, then capture -> animated glTF on the samples, see out/demo"
	@echo "make demo CAPTURE=FILE.bvh  the same with your own capture"
	@echo "make test                   everything that must pass: tests, sanitizers, format, validator"
	@echo
	@echo "make all      build the tools into $(BUILD)/bin (the default)"
	@echo "make deps     install the Debian packages that the build needs and lacks"
	@echo "make bench    benchmarks, as ratios against a reference in the same run"
	@echo "make asan     the tests under AddressSanitizer and UndefinedBehaviorSanitizer"
	@echo "make tsan     the tests under ThreadSanitizer"
	@echo "make golden   write golden files that are missing and renew the generated pages; with FORCE=1"
	@echo "              replace golden files that differ, too: review them as a diff"
	@echo "make format   clang-format all sources"
	@echo "make lint     clang-tidy over the sources"
	@echo "make install  install tools, library and headers (PREFIX=/usr/local, DESTDIR=)"
	@echo "make clean    remove the build folders"

# install-missing PACKAGES: apt-get only for what is not there, so that no network and no root are
# needed once everything is.
define install-missing
	@missing=""; for package in $(1); do \
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

all: deps
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release $(CMAKE_FLAGS)
	cmake --build $(BUILD) -j $(JOBS)

demo: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF
demo: all
	@KROK_BIN=$(BUILD)/bin samples/walk_to_gltf/run.sh $(if $(CAPTURE),"$(CAPTURE)")

unit-test: CMAKE_FLAGS += -DKROK_BUILD_TESTS=ON
unit-test: test-deps all
	ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure

asan: test-deps
	cmake --preset asan $(CMAKE_FLAGS)
	cmake --build --preset asan -j $(JOBS)
	ctest --preset asan -j $(JOBS)

tsan: test-deps
	cmake --preset tsan $(CMAKE_FLAGS)
	cmake --build --preset tsan -j $(JOBS)
	ctest --preset tsan -j $(JOBS)

# The sanitizers go first: the last line of the output then counts the tests of the release build.
test: test-deps format-check
	$(MAKE) asan
	$(MAKE) unit-test

bench: CMAKE_FLAGS += -DKROK_BUILD_TESTS=ON -DKROK_BUILD_BENCHMARKS=ON
bench: test-deps all
	@for program in $(BUILD)/bench/*; do echo "== $$(basename $$program)"; $$program || exit 1; done

golden: unit-test-build
	tests/golden/update.sh $(if $(FORCE),--force) $(BUILD)

.PHONY: unit-test-build
unit-test-build: CMAKE_FLAGS += -DKROK_BUILD_TESTS=ON
unit-test-build: test-deps all

format: test-deps
	$(SOURCES) | xargs clang-format -i

format-check:
	$(call install-missing,clang-format)
	$(SOURCES) | xargs clang-format --dry-run --Werror

# tests/consumer is a project of its own, built on what is installed.
lint: lint-deps
	cmake --preset release
	$(SOURCES) | grep '\.cpp$$' | grep -v '^tests/consumer/' | \
	  xargs -P $(JOBS) -n 4 clang-tidy -p build --quiet

PREFIX ?= /usr/local
install: CMAKE_FLAGS += -DKROK_BUILD_TESTS=OFF -DCMAKE_INSTALL_PREFIX=$(PREFIX)
install: all
	cmake --install $(BUILD)

clean:
	rm -rf $(BUILD) build build-asan build-tsan build-debug out
