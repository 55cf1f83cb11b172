# cmake -D DIR=<source folder> -D OUTPUT=<file.cc> -P ProgramDigest.cmake
# Writes what precompute/build/program_digest.h promises: one digest of the sources of
# formats/ and precompute/, but for those that only show results or hand them out, and of the
# rendered field, which stated errors are of.
file(GLOB sources RELATIVE ${DIR}
     ${DIR}/formats/base/*.* ${DIR}/formats/stored/*.* ${DIR}/formats/hdf5/*.*
     ${DIR}/formats/flat/*.* ${DIR}/formats/forms/*.* ${DIR}/formats/mesh/*.* ${DIR}/formats/response/*.*
     ${DIR}/formats/database/*.* ${DIR}/formats/scene/*.* ${DIR}/precompute/*/*.*
     ${DIR}/runtime/account/*.* ${DIR}/runtime/element/*.* ${DIR}/runtime/memory/*.*
     ${DIR}/runtime/needle/*.* ${DIR}/runtime/fast/*.* ${DIR}/runtime/slow/*.*)
list(FILTER sources INCLUDE REGEX "\\.(cc|h)$")
list(FILTER sources EXCLUDE REGEX "^precompute/(command|serve)/")
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 ${DIR}/${source} digest)
  string(APPEND all "${digest} ${source}\n")
endforeach()
string(SHA256 digest "${all}")
file(WRITE ${OUTPUT} "// Made by cmake/ProgramDigest.cmake.
#include \"precompute/build/program_digest.h\"

namespace palpate {

const char* program_digest() {
  return \"${digest}\";
}

}  // namespace palpate
")
