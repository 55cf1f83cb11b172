# palpate.dll with its version, import libraries for GCC and for Microsoft's linker, and the
# zip of packaging/windows/build.
enable_language(RC)
configure_file(packaging/windows/palpate.rc.in palpate.rc @ONLY)
target_sources(palpate_c PRIVATE ${PROJECT_BINARY_DIR}/palpate.rc)
target_link_options(palpate_c PRIVATE -Wl,--output-def,${PROJECT_BINARY_DIR}/palpate.def)
# LLVM writes what Microsoft's own tools write; GNU's is read by them, too.
find_program(DLLTOOL NAMES llvm-dlltool-22 llvm-dlltool-14 llvm-dlltool
                           x86_64-w64-mingw32-dlltool REQUIRED)
add_custom_command(TARGET palpate_c POST_BUILD
  COMMAND ${DLLTOOL} -m i386:x86-64 -d palpate.def -D palpate.dll -l palpate.lib
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR} BYPRODUCTS palpate.lib VERBATIM)

install(TARGETS palpate_c RUNTIME DESTINATION . ARCHIVE DESTINATION .)
install(FILES ${PROJECT_BINARY_DIR}/palpate.lib ${PROJECT_BINARY_DIR}/palpate.def DESTINATION .)
install(FILES runtime/c_api/palpate.h runtime/c_api/palpate_draw.h runtime/c_api/palpate_memory.h
              runtime/c_api/palpate_needle.h runtime/c_api/palpate.hpp DESTINATION include)
install(FILES runtime/c_api/examples/minimal.c DESTINATION examples)
install(FILES packaging/windows/README.md LICENSE LICENSE.Apache-2.0 LICENSE.Boost-1.0
        DESTINATION .)
# Of what is linked in, as Debian states it.
foreach(package libeigen3-dev libfmt-dev nlohmann-json3-dev gcc-mingw-w64-base
                mingw-w64-x86-64-dev)
  install(FILES /usr/share/doc/${package}/copyright DESTINATION licences RENAME ${package}.txt
          OPTIONAL)
endforeach()
set(CPACK_GENERATOR ZIP)
set(CPACK_PACKAGE_FILE_NAME palpate-${PROJECT_VERSION}-windows-x64)
if(PALPATE_HDF5)
  install(DIRECTORY ${PALPATE_CORE_HDF5}/licences/ DESTINATION licences)
  string(APPEND CPACK_PACKAGE_FILE_NAME -hdf5)
endif()
set(CPACK_STRIP_FILES ON)
include(CPack)
