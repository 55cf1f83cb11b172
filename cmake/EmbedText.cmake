# cmake -D DIR=<folder> -D OUTPUT=<file.cc> -P EmbedText.cmake
# Writes the files of a folder as the texts that formats/report/page_text.h promises: x.js is
# x_script, x.css x_style, x.html x_body. Modules lose the word "export".
file(GLOB files ${DIR}/*.js ${DIR}/*.css ${DIR}/*.html)
list(SORT files)
set(texts "")
foreach(file ${files})
  get_filename_component(name ${file} NAME_WE)
  get_filename_component(extension ${file} LAST_EXT)
  file(READ ${file} content)
  if(extension STREQUAL ".js")
    string(REGEX REPLACE "(^|\n)export " "\\1" content "${content}")
    set(kind script)
  elseif(extension STREQUAL ".css")
    set(kind style)
  else()
    set(kind body)
  endif()
  string(APPEND texts "const char* const ${name}_${kind} = R\"text(${content})text\";\n\n")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/EmbedText.cmake.
#include \"formats/report/page_text.h\"

namespace palpate {

${texts}}  // namespace palpate
")
