# palpate_library(<name> [PIC] DIR <folder> [DEPENDS ...] [PRIVATE_DEPENDS ...])
# One static library palpate::<name> from every <folder>/*.cc except those of the tool
# and of the C interface. PIC: it goes into a shared library, too.
function(palpate_library name)
  cmake_parse_arguments(ARG "PIC" "DIR" "DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  set(dir ${PROJECT_SOURCE_DIR}/${ARG_DIR})
  file(GLOB sources CONFIGURE_DEPENDS ${dir}/*.cc ${dir}/*.h)
  list(FILTER sources EXCLUDE REGEX "/(main|command_[a-z0-9_]+|palpate_c)\\.cc$")
  add_library(palpate_${name} STATIC ${sources})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_include_directories(palpate_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_features(palpate_${name} PUBLIC cxx_std_20)
  set_target_properties(palpate_${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ${ARG_PIC})
  target_link_libraries(palpate_${name} PUBLIC ${ARG_DEPENDS}
                                        PRIVATE palpate_warnings ${ARG_PRIVATE_DEPENDS})
  target_precompile_headers(palpate_${name} PRIVATE <Eigen/Core> <Eigen/Geometry> <vector>)
endfunction()

# palpate_tool(<tool> DIR <folder> LIBRARY <name>): the command-line tool from
# <folder>/main.cc and one <folder>/command_*.cc per subcommand.
function(palpate_tool tool)
  cmake_parse_arguments(ARG "" "DIR;LIBRARY" "" ${ARGN})
  file(GLOB commands CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${ARG_DIR}/command_*.cc)
  add_executable(${tool} ${PROJECT_SOURCE_DIR}/${ARG_DIR}/main.cc ${commands})
  target_link_libraries(${tool} PRIVATE palpate::${ARG_LIBRARY} palpate_warnings
                                        CLI11::CLI11 nlohmann_json::nlohmann_json)
endfunction()

# palpate_tests(<label> [LIBRARIES ...]): one test <label>/<stem> per tests/<label>/*_test.cc.
function(palpate_tests label)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  file(GLOB tests CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${label}/*_test.cc)
  foreach(test ${tests})
    get_filename_component(stem ${test} NAME_WE)
    set(target ${label}_${stem})
    add_executable(${target} ${test})
    target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} palpate_test_support
                                            palpate_warnings GTest::gtest_main)
    target_precompile_headers(${target} REUSE_FROM palpate_test_pch)
    add_test(NAME ${label}/${stem} COMMAND ${target}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${label}/${stem} PROPERTIES LABELS ${label}
                         SKIP_REGULAR_EXPRESSION "SKIPPED_WHOLE_FILE")
  endforeach()
endfunction()
