# SPDX-License-Identifier: BSD-3-Clause
# The short way. Everything real is in CMakeLists.txt; this sets up a Debian machine and calls it.
#   make demo      set up, build, then render a walk on which the camera is lost, and show what Rumi makes of it
#   make test      set up, build, run every test that needs no virtual machine, browser or sanitizer
#   make test-all  after it, the rest: the tests in virtual machines and in a browser, those of what reads messages, files and images again
#                  under sanitizers, and the linter
#   make quick     set up, build, run the quick tests: what to do after each change
#   make build     set up and build everything
#   make tsan      the tests with threads under ThreadSanitizer, and the live system (a walk is rendered for it)
#   make bench     benchmarks
#   make install   into PREFIX (default /usr/local), building only that: programs, their configuration, units for systemd, wire types for
#                  C++, C and Python, examples, pages, completion for bash and zsh, man pages where help2man is; after it
#                  `cmake --install build --component programs` (or lcmtypes, python) for a part
#   make deb       packages for Debian, of what is committed, into $(DEB_BUILD);    make dist: the sources as a tarball, into $(DIST)
#   make format    rewrite the sources with clang-format;    make lint: complain instead, and run clang-tidy
#                  over what was touched of late; make lint-all: over everything
#   make clean     remove what the above made

BUILD ?= build
ASAN_BUILD ?= build-asan
TSAN_BUILD ?= build-tsan
BENCH_BUILD ?= build-bench
DEB_BUILD ?= build-deb
DIST ?= out
PREFIX ?= /usr/local
JOBS ?= $(shell nproc)
DEMO ?= out/demo

SOURCES = $(shell git ls-files --cached --others --exclude-standard '*.cpp' '*.h')

.PHONY: all demo test test-all quick build apps bench install deb dist packages-test format lint lint-all clean dependencies machine-test browser-test sanitized-test tsan
all: build

# While it builds: per cent, files done of all, seconds so far.
export NINJA_STATUS = [%p %f/%t %es] 

dependencies:
	@scripts/install_dependencies.sh

$(BUILD)/build.ninja: | dependencies
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_INSTALL_PREFIX=$(PREFIX)

build: dependencies $(BUILD)/build.ninja
	cmake --build $(BUILD) -j $(JOBS)

apps: dependencies $(BUILD)/build.ninja
	cmake --build $(BUILD) -j $(JOBS) --target apps

demo: apps
	$(BUILD)/bin/rumi demo -o $(DEMO)

test: build
	ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure -LE "machine|browser|packages"

quick: build
	ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure -L quick

test-all: machine-test browser-test sanitized-test lint

# camera_driver and systemd are tested in virtual machines, bags with ROS's own program; where their packages cannot be had
# the tests are skipped.
machine-test: build
	-@scripts/install_dependencies.sh qemu-system-x86 busybox-static cpio kmod v4l-utils xz-utils systemd udev sqlite3
	-@scripts/install_dependencies.sh python3-rosbag
	ctest --test-dir $(BUILD) --output-on-failure -L machine

# The page of `rumi web` in Chromium, without a display; where that cannot be had the test is skipped.
browser-test: build
	-@scripts/install_dependencies.sh chromium chromium-driver
	ctest --test-dir $(BUILD) --output-on-failure -L browser

sanitized-test: dependencies
	cmake -S . -B $(ASAN_BUILD) -G Ninja -DRUMI_SANITIZE=address,undefined -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1"
	cmake --build $(ASAN_BUILD) -j $(JOBS) --target sanitized_tests
	ctest --test-dir $(ASAN_BUILD) -j $(JOBS) --output-on-failure -L sanitized

tsan: dependencies
	cmake -S . -B $(TSAN_BUILD) -G Ninja -DRUMI_SANITIZE=thread -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1"
	cmake --build $(TSAN_BUILD) -j $(JOBS) --target threaded_tests apps
	ctest --test-dir $(TSAN_BUILD) --output-on-failure -L threads

bench: dependencies
	cmake -S . -B $(BENCH_BUILD) -G Ninja -DRUMI_BENCH=ON -DRUMI_TESTS=OFF
	cmake --build $(BENCH_BUILD) -j $(JOBS)
	@set -e; for b in $(BENCH_BUILD)/bench/*; do if [ -f $$b ] && [ -x $$b ]; then echo "== $$b"; $$b; fi; done

install: apps
	cmake --build $(BUILD) --target manual
	cmake --install $(BUILD) --prefix $(PREFIX)

# Builds the packages, and installs and removes them in a clean chroot, and in a virtual machine with systemd;
# `RUMI_SUITE=trixie make packages-test` does it on that Debian.
packages-test: build
	@scripts/install_dependencies.sh --packaging qemu-system-x86 busybox-static cpio kmod v4l-utils xz-utils
	ctest --test-dir $(BUILD) --output-on-failure -R '^packaging_'

deb: dependencies
	@scripts/install_dependencies.sh --packaging
	packaging/make_deb.sh $(DEB_BUILD) $(JOBS)

dist:
	packaging/make_dist.sh $(DIST)

format:
	@scripts/install_dependencies.sh clang-format
	clang-format -i $(SOURCES)

lint lint-all: dependencies $(BUILD)/build.ninja
	@scripts/install_dependencies.sh clang-format clang-tidy
	clang-format --dry-run -Werror $(SOURCES)
	cmake --build $(BUILD) -j $(JOBS) --target rumi_lcmtypes_generate
	scripts/lint.sh $(BUILD) $(if $(filter lint-all,$@),all,recent)

clean:
	rm -rf $(BUILD) $(ASAN_BUILD) $(TSAN_BUILD) $(BENCH_BUILD) $(DEB_BUILD) out
