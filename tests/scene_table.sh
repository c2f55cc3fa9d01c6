#!/bin/sh
# scene_table.sh - which features scenes use and how well they are read, as a Markdown table. From the root:
#
#     sh tests/scene_table.sh [--compact] DIR...
#
# Reads every .pbrt and .pbrt.gz with a WorldBegin below the folders, by `lightcuts info --json`. The status
# of a feature is the worst of any scene, without regard to files that are missing. --compact: a row for
# each kind, with the number of scenes for each status: the table of
# tests/results/public-scenes.md. Scenes that cannot be read are listed after the
# table with their error; the status is then 1.
set -u
L=${LIGHTCUTS:-build/lightcuts}
T=$(mktemp -d) || exit 2
trap 'rm -rf "$T"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
compact=
[ "${1-}" = --compact ] && compact=1 && shift
[ $# -gt 0 ] || { echo "usage: sh tests/scene_table.sh [--compact] DIR..." >&2; exit 2; }

find "$@" -name '*.pbrt' -o -name '*.pbrt.gz' | sort >"$T/files"
: >"$T/rows"
: >"$T/failed"
n=0
while read -r file; do
    case $file in
    *.gz) gzip -dc "$file" | grep -qa '^[[:space:]]*WorldBegin' || continue ;;
    *) grep -qa '^[[:space:]]*WorldBegin' "$file" || continue ;;
    esac
    n=$((n + 1))
    if timeout 600 "$L" info --json "$file" >"$T/json" 2>"$T/err"; then
        # {"kind": "k", "name": "n", "count": 1, "status": "s", "text": "t"} to tab-separated k n 1 s t
        row='"kind": "\(.*\)", "name": "\(.*\)", "count": \([0-9]*\), "status": "\([a-z]*\)"'
        row=$row', "text": "\(.*\)"'
        sed -n "/^  \"features\"/,/^  \]/s/^    {$row}.*/\1\t\2\t\3\t\4\t\5/p" \
            "$T/json" >>"$T/rows"
    else
        printf '%s\t%s\n' "$file" "$(grep -a 'error' "$T/err" | head -n 1)" >>"$T/failed"
    fi
done <"$T/files"

# A missing file is an error of the scene.
awk -F '\t' -v OFS='\t' '$5 ~ /no such file|neither known nor a file/ { $4 = "yes"; $5 = "" } { print }' \
    "$T/rows" >"$T/all"

worst() {
    echo "| kind | name | status | scenes | statements | how |"
    echo "|---|---|---|---|---|---|"
    awk -F '\t' '
    BEGIN { rank["yes"] = 0; rank["approximated"] = 1; rank["ignored"] = 2 }
    {
        key = $1 "\t" $2
        if (!(key in scenes) || rank[$4] > rank[status[key]]) status[key] = $4
        if (how[key] == "" && $4 != "yes") {
            how[key] = $5
            sub(/^.*:[0-9]+:[0-9]+: /, "", how[key])
            gsub(/\|/, "\\|", how[key])
        }
        scenes[key]++
        count[key] += $3
    }
    END {
        for (key in scenes) print key "\t" status[key] "\t" scenes[key] "\t" count[key] "\t" how[key]
    }' "$T/all" |
        LC_ALL=C sort -t "$(printf '\t')" -k1,1 -k4,4nr -k2,2 |
        awk -F '\t' '{ printf "| %s | %s | %s | %d | %d | %s |\n", $1, $2, $3, $4, $5, $6 }'
}

by_kind() {
    echo "| | yes | approximated | ignored |"
    echo "|---|---|---|---|"
    awk -F '\t' '{ n[$1 "\t" $2 "\t" $4]++ } END { for (key in n) print key "\t" n[key] }' "$T/all" |
        LC_ALL=C sort -t "$(printf '\t')" -k1,1 -k4,4nr -k2,2 |
        awk -F '\t' '
        function row() {
            if (kind == "") return
            printf "| %s | %s | %s | %s |\n", kind, cell["yes"], cell["approximated"], cell["ignored"]
        }
        $1 != kind { row(); kind = $1; split("", cell) }
        { cell[$3] = cell[$3] (cell[$3] == "" ? "" : ", ") "`" $2 "` " $4 }
        END { row() }'
}

if [ "$compact" ]; then by_kind; else worst; fi

echo
echo "$n scenes, $(wc -l <"$T/failed" | tr -d ' ') of which can't be read:"
sed 's/^/- /; s/\t/: /' "$T/failed"
[ ! -s "$T/failed" ]
