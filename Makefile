# Lightcuts. `make help` lists the targets. Everything that is built lies under build/.

CC ?= cc
CLANG ?= clang
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
STATIC ?= 1
SECONDS ?= 60
JOBS ?= -j$(shell nproc 2>/dev/null || echo 1)
OPT ?= -O3
SAN ?=

# make V=1 shows the commands.
Q := $(if $(V),,@)
say = $(if $(V),,@echo "$1")

# Another processor's compiler: its build has a folder of its own and a zlib of its own.
TARGET := $(firstword $(subst -, ,$(shell $(CC) -dumpmachine 2>/dev/null)))
CROSS := $(filter-out $(shell uname -m) amd64,$(TARGET))
AR := $(if $(CROSS),$(CROSS)-linux-gnu-ar,ar)

# One folder for each set of flags. What is built with sanitizers gets its libraries built with them too: OpenEXR, and with
# MemorySanitizer, which knows only what it has built, zlib.
CONFIG ?= $(or $(CROSS),$(if $(filter 1,$(STATIC)),release,shared))
SAN_DEPS := $(filter -fsanitize=% -fno-sanitize% -fno-omit-frame-pointer,$(SAN))
DEPS := build/deps$(if $(CROSS),/$(CROSS))$(if $(SAN_DEPS),/$(CONFIG))
OWN_ZLIB := $(if $(CROSS)$(findstring memory,$(SAN_DEPS)),$(DEPS)/zlib)
OUT := build/$(if $(filter release,$(CONFIG)),obj,$(CONFIG))
BIN := build/$(if $(filter release,$(CONFIG)),,$(CONFIG)/)

WARN := -Wall -Wextra -Wshadow -Wconversion -Wmissing-prototypes -Wstrict-prototypes -Wvla -Werror
# Neither -fno-math-errno nor -fno-trapping-math changes a result; contraction would, and so does gcc 12's
# straight-line vectorizer, which leaves out the rounding of double to float and back (unit_fmath).
ROUNDING := -ffp-contract=off -fno-tree-slp-vectorize -fno-math-errno -fno-trapping-math
FLAGS := -std=c11 -D_GNU_SOURCE $(OPT) -g $(ROUNDING) -fvisibility=hidden -Iinclude -Isrc \
  $(if $(filter 1,$(STATIC)),,-fPIC) $(if $(OWN_ZLIB),-I$(OWN_ZLIB)) $(WARN) $(SAN) $(CFLAGS)

ifeq ($(STATIC),1)
EXR_GROUP := static
EXR_LIB := $(DEPS)/openexr/lib/libOpenEXRCore.a
EXR_INC := -I$(DEPS)/openexr/include -I/usr/include/Imath
EXR_LINK := $(EXR_LIB)
LINK_STATIC := -static
else
EXR_GROUP := shared
EXR_LIB :=
EXR_INC := -I/usr/include/OpenEXR -I/usr/include/Imath
EXR_LINK := -lOpenEXRCore-3_1
LINK_STATIC :=
endif
LIBS := $(EXR_LINK) $(if $(OWN_ZLIB),$(OWN_ZLIB)/libz.a,-lz) -lm -lpthread $(LDFLAGS)

# The instruction sets that the compiler's processor can have, a word each: name:flag,flag
ISA_LINES := $(shell $(CC) -E -P src/isa/isa_flags.h 2>/dev/null | tr -d '\n' | tr '>' '\n' | sed 's/[<"]//g; s/: */:/; s/ /,/g')
comma := ,
isa_flags = $(subst $(comma), ,$(patsubst $1:%,%,$(filter $1:%,$(ISA_LINES))))
ISAS := $(foreach line,$(ISA_LINES),$(firstword $(subst :, ,$(line))))
ISA_SRC := $(ISAS:%=src/isa/isa_%.c)
NOT_ALONE := $(wildcard src/*/*_tmpl.c) $(filter-out $(ISA_SRC),$(wildcard src/isa/isa_*.c))
# The program's rooms; all others are the library's.
CLI_SRC := $(wildcard src/cli/*.c src/lab/*.c src/app/*.c)
LIB_SRC := $(filter-out $(NOT_ALONE) $(CLI_SRC),$(wildcard src/*/*.c))
LIB_OBJ := $(LIB_SRC:%.c=$(OUT)/%.o)
CLI_OBJ := $(CLI_SRC:%.c=$(OUT)/%.o)
TEST_HELP := $(patsubst %,tests/support/%.c,ref_bounds ref_shine ref_lower gen_clusters gen_run one_bound)
TESTS := $(patsubst tests/%.c,$(BIN)tests/%,$(wildcard tests/unit_*.c tests/check_*.c))
FUZZERS := $(patsubst fuzz/%.c,%,$(wildcard fuzz/fuzz_*.c))
REPLAYS := $(FUZZERS:%=$(BIN)tests/replay_%)

# Without STATIC the library is shared, too; its major number is that of the ABI.
SONAME := liblightcuts.so.0
VERSION := $(shell sed -n 's/.define LC_VERSION "\(.*\)"/\1/p' include/lightcuts.h)
SHARED := $(if $(filter 1,$(STATIC)),,$(BIN)$(SONAME))

all: $(BIN)liblightcuts.a $(SHARED) $(BIN)lightcuts

help:
	@echo "make            library build/liblightcuts.a and static binary build/lightcuts"
	@echo "make demo       install what is missing, build, render the demo pictures to build/demo/"
	@echo "make test       install what is missing, build, run every test; what needs a browser or Slurm says skipped without"
	@echo "make test-all   the same with a browser and Slurm installed, make lint, make test-arm64, which is what CI runs, and make test-deb"
	@echo "make bench      lightcuts bench: kernels, shadow rays, trees, a frame over its own rays"
	@echo "make accept     full-size comparison with the exact method, about 6 minutes"
	@echo "make accept-kill  1300 random kills of renders that are gone on with"
	@echo "make load       200 renders at once at the edges of threads, descriptors, memory and disk, clocks that jump, stops; 10 minutes"
	@echo "make fuzz       build the fuzzers, replay their corpora; make fuzz-run SECONDS=n runs each for n seconds"
	@echo "make fault      every allocation, file operation and thread start fails in turn (make test: some of them)"
	@echo "make test-arm64 what is of the processor on an emulated 64-bit ARM with NEON, with golden hashes of x86"
	@echo "make mutate     breaks one line at a time on purpose; each must be noticed by a test (some 20 minutes of two processors)"
	@echo "make coverage   the tests, and the share of the lines of src/ that they run"
	@echo "make san tsan msan  the tests under ASan and UBSan, under TSan, under MSan; OpenEXR, for MSan zlib too, is built so"
	@echo "make lint       source rules, both compilers"
	@echo "make dist       build/lightcuts-VERSION.tar.gz, which builds without git"
	@echo "make deb        Debian packages in build/deb: lightcuts, liblightcuts0, liblightcuts-dev"
	@echo "make install    PREFIX=/usr/local DESTDIR= LIBDIR=PREFIX/lib; make uninstall"
	@echo "make clean      removes build/ but keeps build/deps; STATIC=0 links shared libraries"

# ---- dependencies ----

.PHONY: FORCE all help deps deps-check demo test test-all test-arm64 test-deb bench accept accept-kill load fault mutate coverage fuzz fuzz-run san tsan msan lint install uninstall dist deb clean run-tests test-programs golden
deps:
	@sh src/deps/install.sh install build $(EXR_GROUP) $(if $(CROSS),$(CROSS))
deps-check:
	@sh src/deps/install.sh check build $(EXR_GROUP)

$(DEPS)/openexr/lib/libOpenEXRCore.a: | deps-check
	@echo "building OpenEXR's C library (once)"
	$(if $(OWN_ZLIB),@CC="$(CC)" AR=$(AR) SAN="$(SAN_DEPS)" sh src/deps/zlib.sh $(DEPS))
	@CC="$(CC)" AR=$(AR) SAN="$(SAN_DEPS)" $(if $(OWN_ZLIB),ZLIB=$(CURDIR)/$(OWN_ZLIB)) sh src/deps/openexr.sh $(DEPS)

.SECONDARY:

# ---- library and program ----

$(foreach isa,$(ISAS),$(eval $(OUT)/src/isa/isa_$(isa).o: ISA_FLAGS := $(call isa_flags,$(isa))))
$(OUT)/src/image/exr.o $(OUT)/src/image/exr_write.o $(OUT)/tests/unit_exr.o: ISA_FLAGS := $(EXR_INC)

# What a build is known by: its sources, compiler and flags. Written anew only where it changed.
BUILD_ID := $(shell { cat $(sort $(wildcard src/*/*.[ch] include/*.h)); echo "$(FLAGS)"; $(CC) --version | head -n 1; } \
  2>/dev/null | sha256sum | cut -c 1-16)
$(OUT)/src/base/build.o: ISA_FLAGS := -DLC_BUILD='"$(BUILD_ID)"'
$(OUT)/src/base/build.o: $(OUT)/build_id
$(OUT)/build_id: FORCE
	@mkdir -p $(@D)
	@echo $(BUILD_ID) | cmp -s - $@ || echo $(BUILD_ID) >$@
FORCE:

$(OUT)/%.o: %.c Makefile | $(EXR_LIB) deps-check
	@mkdir -p $(@D)
	$(call say,CC $<)
	$(Q)$(CC) $(FLAGS) $(ISA_FLAGS) $(COV_FLAGS) -MMD -MP -c $< -o $@

# OpenEXR's objects go into the library, so that its users link -lz -lm -lpthread only.
$(BIN)liblightcuts.a: $(LIB_OBJ) $(EXR_LIB)
	@rm -f $@
	$(call say,AR $@)
	$(Q)$(AR) rcs $@ $(LIB_OBJ)
	$(Q)$(if $(EXR_LIB),printf 'open %s\naddlib %s\nsave\nend\n' $@ $(EXR_LIB) | $(AR) -M)

$(BIN)$(SONAME): $(LIB_OBJ)
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) -shared -Wl,-soname,$(SONAME) -Wl,-z,defs $(LIB_OBJ) $(LIBS) -o $@
	$(Q)ln -sf $(SONAME) $(BIN)liblightcuts.so

$(BIN)lightcuts: $(CLI_OBJ) $(BIN)liblightcuts.a
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) $(if $(SAN),,$(LINK_STATIC)) $(CLI_OBJ) $(BIN)liblightcuts.a $(LIBS) -o $@

-include $(LIB_OBJ:.o=.d) $(CLI_OBJ:.o=.d)

# ---- tests ----

HELP_OBJ := $(TEST_HELP:%.c=$(OUT)/%.o)
TEST_OBJ := $(patsubst %.c,$(OUT)/%.o,$(wildcard tests/unit_*.c tests/check_*.c tests/support/*.c fuzz/*.c))
$(OUT)/tests/%.o $(OUT)/fuzz/%.o: FLAGS += -Itests $(if $(CROSS),-DTEST_SLOWLY)
-include $(TEST_OBJ:.o=.d)

$(BIN)tests/%: $(OUT)/tests/%.o $(HELP_OBJ) $(BIN)liblightcuts.a
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) $(if $(CROSS),-static) $(filter %.o,$^) $(BIN)liblightcuts.a $(LIBS) -o $@

$(BIN)tests/unit_rooms: $(patsubst %,$(OUT)/tests/support/%.o,path_tracer path_tracer_read)

# Without the program's main().
$(BIN)tests/replay_fuzz_options $(BIN)tests/replay_fuzz_csv: $(filter-out %/main.o,$(CLI_OBJ))
$(BIN)tests/replay_%: $(OUT)/fuzz/%.o $(OUT)/fuzz/driver.o $(HELP_OBJ) $(BIN)liblightcuts.a
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) $(if $(CROSS),-static) $(filter %.o,$^) $(BIN)liblightcuts.a $(LIBS) -o $@

# The whole program with the C library's calls led through a shim that lets them fail.
FAULT_CALLS := main malloc calloc realloc aligned_alloc posix_memalign strdup mmap pthread_create pthread_mutex_init open read write \
  close fsync fdatasync rename ftruncate stat fstat access mkdir fchmod realpath pread pwrite fopen fclose fileno \
  unlink flock pipe fork dup2 fcntl
$(BIN)tests/unit_faults: $(OUT)/tests/unit_faults.o $(OUT)/tests/support/fault_shim.o $(CLI_OBJ) $(BIN)liblightcuts.a
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) $(if $(SAN),,$(LINK_STATIC)) $(FAULT_CALLS:%=-Wl,--wrap=%) $(filter %.o,$^) $(BIN)liblightcuts.a $(LIBS) -o $@

# The program with clocks that jump.
$(BIN)tests/lightcuts_clock: $(OUT)/tests/support/clock_shim.o $(CLI_OBJ) $(BIN)liblightcuts.a
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) $(FLAGS) $(if $(SAN),,$(LINK_STATIC)) -Wl,--wrap=clock_gettime $(filter %.o,$^) $(BIN)liblightcuts.a $(LIBS) -o $@

test:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) all test-programs
	@$(MAKE) --no-print-directory run-tests

# What make test does, with a browser, GNU parallel and Slurm there, so that nothing is skipped for want of them; the source rules; and
# another processor.
test-all:
	@sh src/deps/install.sh install browser farm examples
	@$(MAKE) --no-print-directory test
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory test-deb
	@$(MAKE) --no-print-directory test-arm64

test-programs: $(TESTS) $(REPLAYS) $(BIN)lightcuts $(BIN)tests/lightcuts_clock

run-tests: test-programs
	@sh tests/run.sh $(BIN)

# The tests and the golden hashes, with the very bytes of this processor, on an emulated 64-bit ARM.
test-arm64:
	@$(MAKE) --no-print-directory deps
	@sh src/deps/install.sh install aarch64
	@$(MAKE) --no-print-directory $(JOBS) CC=aarch64-linux-gnu-gcc $$(sh tests/arm64.sh --list | sed 's|[^ ]*|build/aarch64/tests/&|g')
	@sh tests/arm64.sh build/aarch64

# Packages, in a fresh root if one can be made.
test-deb: all
	@sh src/deps/install.sh install shared deb root
	@$(MAKE) --no-print-directory deb
	@sh tests/deb.sh build/lightcuts build/deb

golden: build/tests/unit_golden
	build/tests/unit_golden --print > build/hashes.txt
	mv build/hashes.txt tests/golden/hashes.txt

# -g1, lines but no variables: tracking those through the checks takes GCC minutes for the kernels.
SAN_FLAGS := -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -g1
san:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) CONFIG=san OPT="-O1 -DLC_DEBUG" SAN="$(SAN_FLAGS)" run-tests
tsan:
	@$(MAKE) --no-print-directory deps
	@LC_TEST_SECONDS=3600 $(MAKE) --no-print-directory $(JOBS) CONFIG=tsan OPT="-O1" SAN="-fsanitize=thread" run-tests

# clang's: reads of memory that was never written.
msan:
	@$(MAKE) --no-print-directory deps
	@sh src/deps/install.sh install fuzz
	@LC_TEST_SECONDS=3600 $(MAKE) --no-print-directory $(JOBS) CONFIG=msan CC=$(CLANG) OPT="-O1 -DLC_SCALAR_ONLY" \
	  SAN="-fsanitize=memory -fno-omit-frame-pointer" run-tests

fault:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) build/tests/unit_faults
	@build/tests/unit_faults --all
	@$(MAKE) --no-print-directory $(JOBS) CONFIG=san OPT="-O1 -DLC_DEBUG" SAN="$(SAN_FLAGS)" build/san/tests/unit_faults
	@build/san/tests/unit_faults --all

# Not on request of another target: it builds each mutation alone.
mutate:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(EXR_LIB)
	@sh tests/mutate.sh $(MUTATIONS)

coverage:
	@$(MAKE) --no-print-directory deps
	@rm -rf build/coverage/src
	@LC_TEST_SECONDS=3600 $(MAKE) --no-print-directory $(JOBS) CONFIG=coverage OPT="-O1" SAN="--coverage -fprofile-update=atomic" run-tests
	@sh tests/coverage.sh build/coverage

lint:
	@sh src/deps/install.sh install lint build $(EXR_GROUP)
	@$(MAKE) --no-print-directory all
	@sh tests/lint.sh

# ---- fuzzing ----

# The macro makes small scenes cheap: smaller blocks, coarser spheres. A call for each comparison, half of all time with UBSan's
# checks being comparisons too, stays where it finds what a mutation lacks: in readers of binary files.
FUZZ_FLAGS := -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all -DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
$(patsubst src/%.c,build/fuzzlib/src/%.o,$(filter-out src/pbrt/ply.c src/io/%.c src/image/%.c src/render/checkpoint.c src/render/merge.c, \
  $(LIB_SRC) $(CLI_SRC))): COV_FLAGS := -fno-sanitize-coverage=trace-cmp
# Kernels hold all they know on the stack: to mark it at each call would be a tenth of all time.
$(ISAS:%=build/fuzzlib/src/isa/isa_%.o): COV_FLAGS := -fno-sanitize-coverage=trace-cmp -mllvm -asan-stack=0
FUZZ_LINK := -O1 -fsanitize=address,undefined,fuzzer -fno-sanitize-recover=all
FUZZ_LIBS = $(filter-out $(EXR_LIB),$(LIBS)) # OpenEXR with sanitizers is in fuzzlib's archive
FUZZ_DEPS := $(TEST_HELP) $(LIB_SRC) $(wildcard fuzz/*.h src/*/*.h include/*.h)
build/fuzz/%: fuzz/%.c $(FUZZ_DEPS) | deps-check
	@mkdir -p $(@D)
	@$(MAKE) --no-print-directory CONFIG=fuzzlib CC=$(CLANG) OPT=-O1 SAN="$(FUZZ_FLAGS)" build/fuzzlib/liblightcuts.a
	$(call say,LD $@)
	$(Q)$(CLANG) $(FLAGS) $(FUZZ_LINK) -Itests $< $(TEST_HELP) build/fuzzlib/liblightcuts.a $(FUZZ_LIBS) -o $@

build/fuzz/fuzz_options build/fuzz/fuzz_csv: build/fuzz/%: fuzz/%.c $(FUZZ_DEPS) $(CLI_SRC) | deps-check
	@mkdir -p $(@D)
	@$(MAKE) --no-print-directory CONFIG=fuzzlib CC=$(CLANG) OPT=-O1 SAN="$(FUZZ_FLAGS)" \
	  build/fuzzlib/liblightcuts.a $(patsubst %.c,build/fuzzlib/%.o,$(CLI_SRC))
	$(call say,LD $@)
	$(Q)$(CLANG) $(FLAGS) $(FUZZ_LINK) $< \
	  $(patsubst %.c,build/fuzzlib/%.o,$(filter-out %/main.c,$(CLI_SRC))) build/fuzzlib/liblightcuts.a $(FUZZ_LIBS) -o $@

fuzz:
	@sh src/deps/install.sh install fuzz build $(EXR_GROUP)
	@for f in $(FUZZERS); do $(MAKE) --no-print-directory build/fuzz/$$f || exit 1; \
	  build/fuzz/$$f -runs=0 fuzz/corpus/$${f#fuzz_} || exit 1; done

fuzz-run: fuzz
	@sh fuzz/run.sh build/fuzz $(SECONDS) $(FUZZERS)

# ---- pictures and figures ----

demo:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) all
	@sh tests/demo.sh build/lightcuts build/demo

bench:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) all
	@build/lightcuts bench bounds
	@build/lightcuts bench rays -t 1
	@build/lightcuts bench tree -t 1
	@build/lightcuts scene room --lights 2000 -o build/bench.pbrt
	@build/lightcuts bench render build/bench.pbrt --pixelbounds 200,600,150,450

accept:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory all
	@sh tests/accept.sh build/lightcuts build/accept

# Random kills of renders that are gone on with, full size: 1000 of the library over three scenes, 300 of the program.
accept-kill:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) all build/tests/unit_kill
	@build/tests/unit_kill 1000
	@sh tests/farm.sh build/lightcuts 300

load:
	@$(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(JOBS) all build/tests/lightcuts_clock
	@sh tests/load.sh build/lightcuts 600

# ---- installing ----

install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(LIBDIR)/pkgconfig $(DESTDIR)$(PREFIX)/include
	install -d $(DESTDIR)$(PREFIX)/share/man/man1 $(DESTDIR)$(PREFIX)/share/man/man5
	install -d $(DESTDIR)$(PREFIX)/share/bash-completion/completions
	install -m 755 $(BIN)lightcuts $(DESTDIR)$(PREFIX)/bin/
	install -m 644 $(BIN)liblightcuts.a $(DESTDIR)$(LIBDIR)/
	$(if $(SHARED),install -m 644 $(SHARED) $(DESTDIR)$(LIBDIR)/$(SONAME).$(VERSION))
	$(if $(SHARED),ln -sf $(SONAME).$(VERSION) $(DESTDIR)$(LIBDIR)/$(SONAME))
	$(if $(SHARED),ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/liblightcuts.so)
	install -m 644 include/lightcuts.h $(DESTDIR)$(PREFIX)/include/
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR)|' \
	  -e 's|@PUBLIC@|$(if $(SHARED),,-lz -lm -lpthread)|' \
	  -e 's|@PRIVATE@|$(if $(SHARED),$(EXR_LINK) -lz -lm -lpthread)|' \
	  src/app/lightcuts.pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/lightcuts.pc
	install -m 644 src/app/lightcuts.1 $(DESTDIR)$(PREFIX)/share/man/man1/
	install -m 644 src/app/lightcuts-scene.5 $(DESTDIR)$(PREFIX)/share/man/man5/
	install -m 644 src/app/lightcuts.bash $(DESTDIR)$(PREFIX)/share/bash-completion/completions/lightcuts

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/lightcuts $(DESTDIR)$(LIBDIR)/liblightcuts.a $(DESTDIR)$(PREFIX)/include/lightcuts.h
	rm -f $(DESTDIR)$(LIBDIR)/liblightcuts.so $(DESTDIR)$(LIBDIR)/$(SONAME) $(DESTDIR)$(LIBDIR)/$(SONAME).$(VERSION)
	rm -f $(DESTDIR)$(LIBDIR)/pkgconfig/lightcuts.pc $(DESTDIR)$(PREFIX)/share/man/man1/lightcuts.1
	rm -f $(DESTDIR)$(PREFIX)/share/man/man5/lightcuts-scene.5
	rm -f $(DESTDIR)$(PREFIX)/share/bash-completion/completions/lightcuts

# What is committed.
dist:
	@mkdir -p build
	git archive --format=tar.gz --prefix=lightcuts-$(VERSION)/ -o build/lightcuts-$(VERSION).tar.gz HEAD

deb: dist
	@sh src/deps/install.sh install shared deb
	@sh src/deb/build.sh build/lightcuts-$(VERSION).tar.gz build/deb

clean:
	@for f in build/*; do [ "$$f" = build/deps ] || rm -rf "$$f"; done
