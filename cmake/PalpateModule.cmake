option(PALPATE_UNITY "Compile the sources of a target together; for cold builds" ON)
set(PALPATE_UNIT_SOURCES 32 CACHE STRING "How many sources one translation unit joins at most")
# Sources of one kind of platform alone end in its name: x_posix.cc, x_windows.cc, x_bare.cc
# (no operating system: WebAssembly), x_none.cc (all but POSIX).
if(WIN32)
  set(PALPATE_OTHER_PLATFORMS "_(posix|bare)\\.cc$")
elseif(UNIX)
  set(PALPATE_OTHER_PLATFORMS "_(windows|bare|none)\\.cc$")
else()
  set(PALPATE_OTHER_PLATFORMS "_(posix|windows)\\.cc$")
endif()
# Without HDF5 databases are flat files alone (formats/flat/FLAT.md), and nothing is recorded.
option(PALPATE_HDF5 "Read and write HDF5" ON)
if(PALPATE_HDF5)
  set(PALPATE_OTHER_FORMS "without_hdf5\\.cc$")
else()
  set(PALPATE_OTHER_FORMS "/hdf5/hdf5_[a-z]+\\.cc$|/recording/recording(_writer)?\\.cc$|/afm_file\\.cc$")
endif()

# palpate_units(<target> <source>...): with PALPATE_UNITY the sources become the fewest
# translation units of equal size: headers, and what they instantiate, are paid once a unit.
# `.ci/unity` keeps the names of a target's sources apart.
function(palpate_units target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PALPATE_UNITY} UNITY_BUILD_MODE GROUP)
  list(FILTER ARGN INCLUDE REGEX "\\.cc$")
  list(LENGTH ARGN count)
  math(EXPR parts "(${count} + ${PALPATE_UNIT_SOURCES} - 1) / ${PALPATE_UNIT_SOURCES}")
  math(EXPR size "(${count} + ${parts} - 1) / ${parts}")
  set(index 0)
  foreach(source ${ARGN})
    math(EXPR part "${index} / ${size}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${part})
    if(source MATCHES "_windows\\.cc$")  # windows.h defines macros: near, far
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
    math(EXPR index "${index} + 1")
  endforeach()
endfunction()

# One precompiled header for each kind of object: position-independent, or not. Without JSON,
# whose header makes each unit instantiate a parser, used or not.
function(palpate_precompiled_headers)
  foreach(kind pic pie)
    add_library(palpate_pch_${kind} OBJECT ${PROJECT_SOURCE_DIR}/cmake/pch.cc)
    target_compile_features(palpate_pch_${kind} PRIVATE cxx_std_20)
    target_link_libraries(palpate_pch_${kind} PRIVATE Eigen3::Eigen fmt::fmt palpate_warnings)
    target_precompile_headers(palpate_pch_${kind} PRIVATE
      <Eigen/Core> <Eigen/Geometry> <fmt/format.h>
      <algorithm> <filesystem> <functional> <map> <optional> <string> <vector>)
  endforeach()
  set_target_properties(palpate_pch_pic PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# palpate_reuse(<target> <kind>): compiles with the precompiled header palpate_pch_<kind>.
# GCC wants the same definitions and options of the libraries that the header holds.
function(palpate_reuse target kind)
  target_precompile_headers(${target} REUSE_FROM palpate_pch_${kind})
  get_target_property(held palpate_pch_${kind} LINK_LIBRARIES)
  foreach(library ${held})
    target_compile_definitions(${target} PRIVATE
      $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_DEFINITIONS>)
    target_compile_options(${target} PRIVATE
      $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_OPTIONS>)
  endforeach()
endfunction()

# palpate_library(<name> [PIC] ROOMS <folder>... [LEFT_OUT <expression>...]
#                 [DEPENDS ...] [PRIVATE_DEPENDS ...])
# One static library palpate::<name> from the sources of some sub-rooms, but those whose
# paths begin with a LEFT_OUT.
# PIC: it goes into a shared library, too.
function(palpate_library name)
  cmake_parse_arguments(ARG "PIC" "" "ROOMS;LEFT_OUT;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  set(sources "")
  foreach(room ${ARG_ROOMS})
    set(dir ${PROJECT_SOURCE_DIR}/${room})
    file(GLOB found CONFIGURE_DEPENDS ${dir}/*.cc ${dir}/*.h)
    list(APPEND sources ${found})
  endforeach()
  # Of the shared library, of the front program and of the page's module alone.
  list(FILTER sources EXCLUDE REGEX "/(palpate_(c|tick|draw|needle|memory|main)|fault_name|page_module)\\.cc$")
  list(FILTER sources EXCLUDE REGEX "${PALPATE_OTHER_PLATFORMS}")
  list(FILTER sources EXCLUDE REGEX "${PALPATE_OTHER_FORMS}")
  foreach(left_out ${ARG_LEFT_OUT})
    list(FILTER sources EXCLUDE REGEX "^${PROJECT_SOURCE_DIR}/${left_out}")
  endforeach()
  add_library(palpate_${name} STATIC ${sources})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_include_directories(palpate_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_features(palpate_${name} PUBLIC cxx_std_20)
  set_target_properties(palpate_${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ${ARG_PIC})
  target_link_libraries(palpate_${name} PUBLIC ${ARG_DEPENDS}
                                        PRIVATE palpate_warnings ${ARG_PRIVATE_DEPENDS})
  if(ARG_PIC)
    palpate_reuse(palpate_${name} pic)
  else()
    palpate_reuse(palpate_${name} pie)
  endif()
  palpate_units(palpate_${name} ${sources})
endfunction()

# palpate_tool(<tool> ROOM <room> LIBRARIES <name>...): the command-line tool from
# <room>/command: main.cc and one command_*.cc per subcommand.
function(palpate_tool tool)
  cmake_parse_arguments(ARG "" "ROOM" "LIBRARIES" ${ARGN})
  file(GLOB commands CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${ARG_ROOM}/command/*.cc)
  add_executable(${tool} ${commands})
  list(TRANSFORM ARG_LIBRARIES PREPEND palpate::)
  target_link_libraries(${tool} PRIVATE ${ARG_LIBRARIES} palpate_warnings
                                        nlohmann_json::nlohmann_json)
  palpate_reuse(${tool} pie)
  palpate_units(${tool} ${commands})
endfunction()

# palpate_test_program(<folder> [WITH <folder>...] [LIBRARIES ...]): one program from
# *_test.cc of these folders of tests/ and, for each file, a test <folder>/<stem> that runs
# the suites of that file.
function(palpate_test_program folder)
  cmake_parse_arguments(ARG "" "" "WITH;LIBRARIES" ${ARGN})
  set(tests "")
  foreach(tested ${folder} ${ARG_WITH})
    file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${tested}/*_test.cc)
    list(APPEND tests ${found})
    set_property(GLOBAL APPEND PROPERTY palpate_tested_folders ${tested})
  endforeach()
  string(REPLACE "/" "_" target ${folder}_tests)
  string(REGEX MATCH "^[^/]+" label ${folder})
  add_executable(${target} ${tests})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} palpate_test_support
                                          palpate_warnings GTest::gtest_main)
  palpate_reuse(${target} tests)
  palpate_units(${target} ${tests})
  set(taken "")
  foreach(test ${tests})
    # A new suite must not go unnoticed: its file's change configures anew.
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${test})
    file(STRINGS ${test} suites REGEX "^(TYPED_)?TEST(_F|_P)?\\([A-Za-z0-9_]+,")
    list(TRANSFORM suites REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+),.*$" "\\1")
    list(REMOVE_DUPLICATES suites)
    foreach(suite ${suites})
      if(suite IN_LIST taken)
        message(FATAL_ERROR "${test}: suite ${suite} is in another file of ${target}, too")
      endif()
    endforeach()
    list(APPEND taken ${suites})
    list(TRANSFORM suites REPLACE "^(.+)$" "\\1.*:*/\\1.*:\\1/*")
    list(JOIN suites ":" filter)
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR}/tests ${test})
    string(REGEX REPLACE "\\.cc$" "" name ${name})
    add_test(NAME ${name} COMMAND ${target} --gtest_filter=${filter}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name} PROPERTIES LABELS ${label}
                         SKIP_REGULAR_EXPRESSION "SKIPPED_WHOLE_FILE")
  endforeach()
endfunction()

# palpate_tests(<room> [LIBRARIES ...]): a program for each folder of tests/<room> that has
# none yet.
function(palpate_tests room)
  file(GLOB folders CONFIGURE_DEPENDS LIST_DIRECTORIES true RELATIVE
       ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/tests/${room}/*)
  get_property(tested GLOBAL PROPERTY palpate_tested_folders)
  foreach(folder ${folders})
    if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/tests/${folder} AND NOT folder IN_LIST tested)
      palpate_test_program(${folder} ${ARGN})
    endif()
  endforeach()
endfunction()

# palpate_c_library(<library>...): the C interface for other simulators, palpate::palpate:
# nothing but its functions can be seen. Without an operating system a static library.
function(palpate_c_library)
  set(kind SHARED)
  if(NOT WIN32 AND NOT UNIX)
    set(kind STATIC)
  endif()
  add_library(palpate_c ${kind} runtime/c_api/palpate_c.cc runtime/c_api/palpate_tick.cc
              runtime/c_api/palpate_draw.cc runtime/c_api/palpate_needle.cc
              runtime/c_api/palpate_memory.cc runtime/c_api/palpate_memory.h
              runtime/c_api/fault_name.cc runtime/c_api/palpate.h
              runtime/c_api/palpate_draw.h runtime/c_api/palpate_needle.h)
  add_library(palpate::palpate ALIAS palpate_c)
  target_include_directories(palpate_c INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/runtime/c_api> $<INSTALL_INTERFACE:include>)
  target_link_libraries(palpate_c PRIVATE ${ARGN} palpate_warnings)
  target_compile_definitions(palpate_c PRIVATE PALPATE_BUILDING_LIBRARY)
  set_target_properties(palpate_c PROPERTIES OUTPUT_NAME palpate EXPORT_NAME palpate
    VERSION 1.${PROJECT_VERSION_MINOR}.${PROJECT_VERSION_PATCH} SOVERSION 1  # ABI version
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(WIN32)
    set_target_properties(palpate_c PROPERTIES PREFIX "")
  elseif(UNIX)
    target_link_options(palpate_c PRIVATE -Wl,--exclude-libs,ALL -Wl,--no-undefined)
  endif()
endfunction()
