# shellcheck shell=bash
# What run and run_windows share. They set `folder`, for what is made, and compile(), which
# makes OUTPUT in it of options and sources.
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
source=$(realpath "$here/../..")
unity=$source/packaging/unity

# An assembly as Unity makes it of a folder: it sees what its definition names, no more.
assembly() {  # FOLDER
  local -a options
  mapfile -t options < <(python3 - "$1"/*.asmdef <<'PY'
import json, sys
with open(sys.argv[1]) as file:
    given = json.load(file)
seen = given["references"] + ([] if given.get("noEngineReferences") else ["UnityEngine"])
print(given["name"] + ".dll", "-target:library", *(f"-r:{name}.dll" for name in seen), sep="\n")
if given.get("allowUnsafeCode"):
    print("-unsafe")
PY
  )
  compile "${options[@]}" "$1"/*.cs
}

# The package's assemblies, the examples of its page, and the tests.
compile_all() {
  compile UnityEngine.dll -target:library "$here"/engine/*.cs
  assembly "$unity/Runtime/Core"
  assembly "$unity/Runtime/Scene"
  assembly "$unity/Samples~/PressWithMouse"
  awk -v to="$folder/example" '/^```csharp$/ {on = 1; ++n; next} /^```$/ {on = 0}
    on {print > (to n ".cs")}' "$unity/README.md"
  local engine=(-r:Palpate.Core.dll -r:Palpate.Unity.dll -r:UnityEngine.dll)
  compile examples.dll -target:library "${engine[@]}" "$folder"/example*.cs
  compile tests.exe "${engine[@]}" -r:Palpate.PressWithMouse.dll -r:examples.dll "$here"/*.cs
}

# The C programs that the tests ask: a host, and what the headers hold.
compile_c() {  # SUFFIX LIBRARY COMPILER...
  "${@:3}" -std=c99 -O2 -Wall -Wextra -Wpedantic -I"$source/runtime/c_api" "$here/host.c" \
    -o "$folder/host$1" "$2"
  "$here/layout" "$source"/runtime/c_api/palpate*.h > "$folder/layout.c"
  "${@:3}" -std=c99 "$folder/layout.c" -o "$folder/layout$1"
}
