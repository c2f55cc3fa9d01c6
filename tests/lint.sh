#!/bin/sh
# lint.sh - the source rules of the house style that a script can check, and both compilers. From the root: make lint
#
# Ends with "N passed, N failed"; each rule is one test and prints the lines that break it.
set -u
cd "$(dirname "$0")/.." || exit 2
T=$(mktemp -d) || exit 2
trap 'rm -rf "$T"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
passed=0
failed=0

# The rule holds when its finder printed nothing.
rule() # text command...
{
    text=$1
    shift
    "$@" >"$T/found" 2>&1
    if [ -s "$T/found" ]; then
        failed=$((failed + 1))
        echo "FAIL $text"
        head -n 20 "$T/found" | sed 's/^/     /'
    else
        passed=$((passed + 1))
    fi
}

# Copies of the sources without comments and text in quotes but for includes, so that words in them don't count.
strip()
{
    mkdir -p "$T/bare/$(dirname "$1")"
    awk '{
        line = $0
        if (line ~ /^[ ]*#[ ]*include/) { print line; next }
        gsub(/\\"/, "", line)
        gsub(/"[^"]*"/, "\"\"", line)
        gsub(/\/\*[^*]*(\*[^\/*][^*]*)*\*\//, "", line)
        if (comment) { if (match(line, /\*\//)) { line = substr(line, RSTART + 2); comment = 0 } else line = "" }
        if (match(line, /\/\*/)) { line = substr(line, 1, RSTART - 1); comment = 1 }
        sub(/\/\/.*/, "", line)
        print line
    }' "$1" >"$T/bare/$1"
}
for file in src/*/*.[ch] include/*.h tests/*.[ch] tests/support/*.[ch] fuzz/*.c; do strip "$file"; done
bare() { (cd "$T/bare" && "$@"); }
include_of='^[ ]*#[ ]*include[ ]*'

# ---- who may include whom ----

# The rooms in order, from the one place where they stand: the table of src/README.md.
rooms=$(sed -n 's/^| `\([a-z]*\)\/` |.*/\1/p' src/README.md)
library=$(for room in $rooms; do case $room in cli | lab | app) ;; *) echo "src/$room/*.[ch]" ;; esac; done)
all_rooms()
{
    for dir in src/*/; do
        case $dir in src/deps/ | src/deb/) continue ;; esac
        echo "$rooms" | grep -qx "$(basename "$dir")" || echo "$dir is not in src/README.md"
    done
}
# "file included" for each include of our own under src/
own_includes() { grep -HnE "$include_of\"" src/*/*.[ch] | sed 's/^\([^:]*\):[0-9]*:[^"]*"\([^"]*\)".*/\1 \2/' | grep -v ' lightcuts\.h$'; }
upward()
{
    own_includes | awk -v rooms="$(echo "$rooms" | tr '\n' ' ')" '
        BEGIN { n = split(rooms, order, " "); for (i = 1; i <= n; i++) at[order[i]] = i }
        { split($1, from, "/"); split($2, to, "/")
          if ($1 == "src/isa/isa_flags.h" && $2 == "isa_list.h") next # the Makefile preprocesses it without -Isrc
          if (!(to[1] in at)) print $1 ": \"" $2 "\" is not written from src"
          else if (at[to[1]] > at[from[2]]) print $1 ": \"" $2 "\" is of a room below" }'
}
circles() # of files, a .c and its header being one, and so of rooms
{
    # A list of homes (light_kinds.h, lobes.h) includes them where it is not asked for its lines: never when a home includes it.
    own_includes | grep -vE '^src/shade/(light_kinds|lobes)\.h ' | sed 's/^src\///; s/\.[ch]\( \|$\)/\1/g' | awk '$1 != $2' >"$T/edges"
    tsort "$T/edges" >/dev/null
}
own_room_only()
{
    own_includes | awk '$1 ~ /^src\/(cli|app)\// && $2 !~ /^(cli|lab)\// { print $1 ": " $2 }
                        $1 ~ /^src\/cli\// && $2 ~ /^lab\// { print $1 ": " $2 }'
}
# Readers of files make scenes by the calls of lightcuts.h: of the rooms that know scenes they see types and mathematics only.
readers()
{
    data='scene/(camera|env_map|media_data|noise|pixel_filter)|shade/(light|light_spot|material)|trace/half_edge|build/reader'
    own_includes | grep -E '^src/(pbrt|gltf|obj)/' | grep -E ' (scene|shade|tree|trace|cut|isa|prepare|build)/' |
        grep -vE " ($data)\.h$"
}
only_in() # regex allowed-file-regex files...
{
    regex=$1 allowed=$2
    shift 2
    bare grep -nE "$regex" "$@" /dev/null | grep -vE "^($allowed):"
}
own_header_first()
{
    for file in src/*/*.c; do
        header=${file#src/}
        header=${header%.c}.h
        [ -f "src/$header" ] || continue
        first=$(sed -n "s/$include_of[\"<]\(.*\)[\">].*/\1/p" "$file" | head -n 1)
        [ "$first" = "$header" ] || echo "$file: $first comes first"
    done
}
template_includes() # what an instruction set's flags must not compile: code outside of the kernels
{
    data='"(base/(base|vec|fmath)|shade/(point|tree_data|light|lobes|light_kinds|light_target|dir_pack)'
    data="$data"'|cut/cut_list|trace/bvh_data|tree/ploc_list)\.h"|<string\.h>'
    grep -HnE "$include_of" src/*/*_tmpl.c | grep -v '^src/isa/isa_tmpl.c:' | grep -vE "$data"
}
rule 'every folder of src/ is a room of src/README.md' all_rooms
rule 'a room includes only itself and rooms above it, by names written from src' upward
rule 'no file includes itself by way of others' circles
rule 'cli/ and app/ include lightcuts.h and the rooms of the program only' own_room_only
rule 'pbrt/, gltf/ and obj/ make scenes by lightcuts.h and build/reader.h only' readers
rule '<immintrin.h> and its like in simd/ and vec4.h only' \
    only_in '<[a-z]*intrin\.h>|<arm_neon\.h>' 'src/(simd/[a-z_0-9]*|base/vec4)\.h' src/*/*.[ch]
rule 'OpenEXR in exr.c and exr_write.c only' only_in "$include_of[<\"](openexr|ImfC|Imath)" 'src/image/exr(_write)?\.c' src/*/*.[ch]
rule '<pthread.h> in pool.c only' only_in '<pthread\.h>|<threads\.h>' 'src/base/pool\.c' src/*/*.[ch]
# shellcheck disable=SC2086
rule 'malloc and its like in arena.c only' only_in '\<(malloc|calloc|realloc|aligned_alloc|posix_memalign|strdup|strndup)[ ]*\(' \
    'src/base/arena\.c' $library
rule 'simd/ in isa_*.c and simd/ only' only_in "$include_of\"simd/" 'src/(isa/isa_[a-z0-9]*\.c|simd/[a-z_0-9]*\.h)' src/*/*.[ch]
writers() # what opens files to write, renames or removes them, but for lc_file_write and the checkpoint
{
    only_in '\<(O_WRONLY|O_RDWR|O_CREAT|O_TRUNC|O_APPEND)\>|\<(creat|rename|renameat|mkstemp|tmpfile|freopen|truncate|ftruncate)[ ]*\(' \
        'src/(io/(file|wait)|render/checkpoint|app/main)\.c' src/*/*.[ch] # main.c: standard streams that are closed
    grep -nE '\<fopen[ ]*\(.*, *"([wa]|rb?\+)' src/*/*.[ch]
}
rule 'files are written through lc_file_write and lc_file_replace only' writers
leaks() # macros that a template or home defines and leaves defined
{
    for file in src/*/*_tmpl.c src/shade/lobe_*.h; do
        [ "$file" = src/isa/isa_tmpl.c ] && continue
        sed -n 's/^#define \([A-Za-z_0-9]*\).*/\1/p' "$file" | sort -u | while read -r macro; do
            case $macro in AIMED_KIND | LC_LOBE_INFO_*) continue ;; esac # its list ends it; a home's line of the table
            grep -q "^#undef $macro\$" "$file" || echo "$file: $macro"
        done
    done
}
rule 'macros of a template end with it' leaks
rule 'templates include data of their rooms only' template_includes
rule 'a .c includes its own header first' own_header_first

# ---- the library's manners ----

printing='\<(printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror|exit|_exit|getenv|setlocale|system|signal)[ ]*\('
unsafe='\<(gets|strcpy|sprintf|vsprintf|strtok|rand|srand|asctime|ctime|gmtime|localtime|atoi|atof|alloca)[ ]*\('
# shellcheck disable=SC2086
rule 'the library never prints, exits or reads the environment' only_in "$printing" 'none' $library
rule 'no assert on input: LC_ASSERT states what validation has ensured' \
    only_in '(^|[^_A-Za-z])assert[ ]*\(' 'src/base/base\.h' src/*/*.[ch]
rule 'no functions that overflow or keep state' only_in "$unsafe" 'none' src/*/*.[ch]

# ---- files ----

long_files()
{
    for file in src/*/*.c tests/*.c tests/support/*.c fuzz/*.c; do
        n=$(wc -l <"$file")
        case $file in tests/*) most=800 ;; *) most=600 ;; esac
        [ "$n" -lt $most ] || echo "$file: $n lines"
    done
    for file in src/*/*.h tests/support/*.h; do
        n=$(wc -l <"$file")
        case $file in src/shade/light_*.h | src/shade/lobe_*.h) most=260 ;; *) most=200 ;; esac # homes are all of a kind
        [ "$n" -lt $most ] || echo "$file: $n lines"
    done
}
long_functions()
{
    for file in src/*/*.c; do
        awk '/^\{/ { start = NR }
             /^\}/ { if (start && NR - start >= 61) print FILENAME ":" start ": " NR - start - 1 " lines"; start = 0 }' "$file"
    done
}
first_lines()
{
    for file in src/*/*.[ch] tests/*.[ch] tests/support/*.[ch] fuzz/*.c include/*.h; do
        head -n 1 "$file" | grep -q "^/\* $(basename "$file") - " || echo "$file: does not open with its name and what it holds"
    done
}
texts=$(ls src/*/*.[ch] src/app/* src/deps/*.sh src/deb/* include/*.h tests/*.[ch] tests/support/*.[ch] tests/*.sh fuzz/*.c)
tab=$(printf '\t')
rule '.c under 600 lines, .h under 200, homes of light kinds and lobes under 260' long_files
rule 'functions under 60 lines' long_functions
# shellcheck disable=SC2086
rule 'lines of at most 110 columns, of scripts and pages 140' awk 'length($0) > (FILENAME ~ /\.[ch]$/ ? 110 : 140) { print \
    FILENAME ":" FNR ": " length($0) }' $texts
# shellcheck disable=SC2086
rule 'no tabs' grep -n "$tab" $(echo "$texts" | grep -v '^src/deb/rules$')
# shellcheck disable=SC2086
rule 'no spaces at the end of a line' grep -nE ' +$' $texts
rule 'a file opens with its name and what it holds' first_lines
names() { ls src/* tests tests/support fuzz | grep '\.[ch]$' | grep -v '^[a-z0-9_]*\.[ch]$'; }
rule 'file names are lower case' names
scripts() { for file in src/deps/*.sh tests/*.sh; do sh -n "$file"; done; }
rule 'shell scripts parse' scripts

# ---- what is said in several places ----

version=$(sed -n 's/^#define LC_VERSION "\(.*\)"/\1/p' include/lightcuts.h)
versions()
{
    grep -q "^Version: $version\$" src/app/lightcuts.pc.in || echo "src/app/lightcuts.pc.in: not version $version"
    grep -q "^\.TH .*lightcuts $version" src/app/lightcuts.1 || echo "src/app/lightcuts.1: not version $version"
}
options() # each option of --help is in the manual page and in the completion
{
    sed 's/\\-/-/g' src/app/lightcuts.1 >"$T/page"
    for command in render compare scene info preview merge bench report converge lux relight; do
        build/lightcuts $command --help | grep -oE -e '--[a-z][a-z-]+' | sort -u | while read -r option; do
            [ "$option" = --help ] || grep -q -e "$option" "$T/page" || echo "src/app/lightcuts.1: $command lacks $option"
            grep -q -e "$option" src/app/lightcuts.bash || echo "src/app/lightcuts.bash: $command lacks $option"
        done
    done
}
rule 'one version' versions
[ ! -x build/lightcuts ] || rule 'manual page and completion know every option' options

# ---- compilers ----

warn='-Wall -Wextra -Wshadow -Wconversion -Wmissing-prototypes -Wstrict-prototypes -Wvla -Werror'
flags="-D_GNU_SOURCE -ffp-contract=off -Iinclude -Isrc -Itests"
alone() # compiler
{
    for header in src/*/*.h tests/support/*.h; do
        extra=
        case $header in
        src/isa/isa_list.h | src/isa/isa_flags.h | src/simd/vec_words.h | src/simd/vec_block_avx.h) continue ;; # parts of others
        src/simd/vec_*.h)
            isa=$(basename "$header" .h)
            extra=$("$1" -E -P src/isa/isa_flags.h | sed -n "s/^<${isa#vec_}: *\"\(.*\)\">\$/\1/p")
            [ "$isa" != vec_pack ] && ! "$1" -E -P src/isa/isa_flags.h | grep -q "^<${isa#vec_}:" && continue
            ;;
        esac
        # shellcheck disable=SC2086
        echo "#include \"$PWD/$header\"" | "$1" -std=c11 $flags $warn $extra -fsyntax-only -x c - ||
            echo "$header does not compile alone"
    done
}
public() # compiler language standard
{
    echo '#include "lightcuts.h"' | "$1" -std="$3" -Iinclude -Wall -Wextra -Wpedantic -Werror -fsyntax-only -x "$2" -
}
# The whole with clang and the same warnings, beside the other rules.
with_clang() { ${MAKE:-make} --no-print-directory -s CONFIG=clang CC=clang all || echo 'clang: the build failed'; }
clang_build=
if command -v clang >/dev/null 2>&1; then
    with_clang >"$T/clang" 2>&1 &
    clang_build=$!
fi

for cc in gcc clang; do
    if command -v $cc >/dev/null 2>&1; then
        rule "$cc: every header compiles alone" alone $cc
        rule "$cc: lightcuts.h as C99" public $cc c c99
        rule "$cc: lightcuts.h as C11" public $cc c c11
    else
        echo "skip $cc is not here"
    fi
done
for cxx in g++ clang++; do
    if command -v $cxx >/dev/null 2>&1; then rule "$cxx: lightcuts.h as C++11" public $cxx c++ c++11; fi
done

# Symbols of the object files of the release build.
lib_objects() { for room in $rooms; do case $room in cli | lab | app) ;; *) ls build/obj/src/"$room"/*.o 2>/dev/null ;; esac; done; }
exports() { lib_objects | xargs nm -g --defined-only | awk 'NF == 3 && $3 !~ /^lc_/ { print $3 }'; }
kernel_symbols()
{
    nm -g --defined-only build/obj/src/isa/isa_*.o | awk 'NF == 3 && $3 !~ /^lc_kernels_[a-z0-9]*$/ { print $3 }'
}
# .data.rel.ro is constant.
writable() { objdump -t build/obj/src/isa/isa_*.o | grep -E ' O .*\*COM\*| O \.(data|bss|tdata|tbss)([^.]|\.[^r])'; }
instructions() # what an older processor would stop at, outside the kernels
{
    for object in build/obj/src/*/*.o; do
        case $object in */isa_avx*) continue ;; esac
        objdump -d "$object" | grep -qE '%[yz]mm[0-9]|[[:space:]]v(add|mul|mov)[sp][sd] ' && echo "$object holds AVX instructions"
    done
}
if [ -f build/obj/src/base/arena.o ] && command -v nm >/dev/null 2>&1; then
    rule 'objects export lc_ symbols only' exports
    rule "the kernels' names carry their instruction set" kernel_symbols
    rule 'the kernels have no writable globals' writable
    [ "$(uname -m)" != x86_64 ] || rule 'AVX in isa_*.o only' instructions
else
    failed=$((failed + 1))
    echo 'FAIL symbols: no release build; run make first'
fi

if [ -n "$clang_build" ]; then
    wait "$clang_build"
    grep -q -e 'warning: ' -e 'error: ' -e 'build failed' "$T/clang" || : >"$T/clang"
    rule 'clang compiles everything without a warning' cat "$T/clang"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
