#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Man pages of what --help says, by help2man: rumi.1 and one for each command and process, such as rumi-demo.1.
#   packaging/man_pages.sh RUMI FOLDER       RUMI: the program, installed or in a build tree
set -eu
rumi=$1
folder=$2
mkdir -p "$folder"
version=$("$rumi" --version | sed -n 's/^rumi //p')
helper=$(mktemp)
trap 'rm -f "$helper"' EXIT
# As help2man wants it: two spaces before a flag's help, "-h, --help", and the command that a user types.
cat >"$helper" <<END
#!/bin/sh
"$rumi" "\$@" | sed 's/^\(  -.\{26\} \)\([^ ]\)/\1  \2/; s/^\(  -.\), *--/\1, --/; s/^Usage: \(rumi \)*/Usage: rumi /'
END
chmod 700 "$helper"

page() { # NAME SUMMARY COMMAND
  help2man --no-info --section=1 --version-string="$version" --name="$2" --help-option="$3 --help" \
    --include=- --output="$folder/$1.1" "$helper" <<END
[see also]
.BR rumi (1),
/usr/share/doc/rumi/README.md
END
  title=$(echo "$1" | tr '[:lower:]' '[:upper:]')
  sed -i "s/^\.TH .* \"1\" \(\"[^\"]*\"\) .*/.TH $title 1 \1 \"rumi $version\" \"User Commands\"/
          /^\.SH NAME/{n;s/^.* \\\\- /$1 \\\\- /}" "$folder/$1.1"
}

page rumi "monocular visual SLAM made of small processes" ""
"$rumi" --help | sed -n '/^Subcommands:/I,/^$/s/^  \([a-z-]*\)  *\([A-Z].*\)/\1|\2/p' | while IFS='|' read -r command summary; do
  page "rumi-$command" "$summary" "$command"
done
for process in $("$rumi" --help | sed -n 's/^`rumi \(.*\) \.\.\.`.*/\1/p' | tr '|' ' '); do
  summary=$("$rumi" "$process" --help | sed -n '1s/[.:] .*//p')
  page "rumi-$process" "${summary%.}" "$process"
done
