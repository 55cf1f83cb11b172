# cmake -D DIR=<folder> [-D MORE=<file>] -D OUTPUT=<file.cc> -P EmbedPage.cmake
# Writes the files of a page, and one from elsewhere, as arrays of bytes and the table that page_assets.h promises.
file(GLOB files ${DIR}/*.html ${DIR}/*.css ${DIR}/*.js ${DIR}/*.txt)
list(APPEND files ${MORE})
list(SORT files)
set(arrays "")
set(rows "")
set(index 0)
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  get_filename_component(extension ${file} LAST_EXT)
  if(extension STREQUAL ".html")
    set(type "text/html; charset=utf-8")
  elseif(extension STREQUAL ".css")
    set(type "text/css; charset=utf-8")
  elseif(extension STREQUAL ".js")
    set(type "text/javascript; charset=utf-8")
  else()
    set(type "text/plain; charset=utf-8")
  endif()
  if(name STREQUAL "index.html")
    set(path "/")
  else()
    set(path "/${name}")
  endif()
  file(READ ${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "constexpr unsigned char kFile${index}[] = {${bytes}};\n")
  string(APPEND rows "    {\"${path}\", \"${type}\", text(kFile${index})},\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/EmbedPage.cmake.
#include \"formats/report/page_assets.h\"

#include <array>
#include <cstddef>

namespace palpate {
namespace {

${arrays}
template <std::size_t kSize>
std::string_view text(const unsigned char (&bytes)[kSize]) {
  return {reinterpret_cast<const char*>(bytes), kSize};
}

}  // namespace

std::span<const ViewAsset> page_assets() {
  static const std::array<ViewAsset, ${index}> kAssets{{
${rows}  }};
  return kAssets;
}

}  // namespace palpate
")
