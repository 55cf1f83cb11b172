# What an installation holds, as components and Debian packages: the tools, the shared
# library of the C interface, what a program needs to be built with it, and, where there
# is pybind11, the Python package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Man page and completion of a tool, printed by the tool itself when it is built.
function(palpate_install_tool tool)
  set(pages ${PROJECT_BINARY_DIR}/pages)
  add_custom_command(TARGET ${tool} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -E make_directory ${pages}
    COMMAND ${tool} --man > ${pages}/${tool}.1
    COMMAND ${tool} --completion > ${pages}/${tool} VERBATIM)
  install(TARGETS ${tool} COMPONENT tools)
  install(FILES ${pages}/${tool}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  install(FILES ${pages}/${tool}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tools)
endfunction()
foreach(tool palpate palpate-db palpate-precompute palpate-fit palpate-run)
  palpate_install_tool(${tool})
endforeach()

# What pages hold, where ./bootstrap page has built it.
install(FILES ${PROJECT_BINARY_DIR}/share/palpate/palpate.wasm
        DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate COMPONENT tools OPTIONAL)

install(TARGETS palpate_c EXPORT palpate
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime
                NAMELINK_COMPONENT dev)
install(FILES runtime/c_api/palpate.h runtime/c_api/palpate_draw.h
              runtime/c_api/palpate_needle.h runtime/c_api/palpate_memory.h runtime/c_api/palpate.hpp
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
install(EXPORT palpate NAMESPACE palpate:: FILE palpateConfig.cmake
        DESTINATION ${config_dir} COMPONENT dev)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${config_dir} COMPONENT dev)
file(RELATIVE_PATH PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)  # movable, as the rest
configure_file(cmake/palpate.pc.in palpate.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/palpate.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
install(DIRECTORY runtime/c_api/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT dev)
set(parts tools:palpate runtime:libpalpate-runtime dev:libpalpate-dev)
if(TARGET python)
  list(APPEND parts python:python3-palpate)
  set(packages lib/python3/dist-packages/palpate)  # Debian's
  install(TARGETS python LIBRARY DESTINATION ${packages} COMPONENT python)
  install(DIRECTORY python/palpate/ DESTINATION ${packages} COMPONENT python
          FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed")
  install(DIRECTORY python/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-palpate
          COMPONENT python)
endif()
foreach(part ${parts})
  string(REPLACE ":" ";" part ${part})
  list(GET part 0 component)
  list(GET part 1 package)
  install(FILES LICENSE LICENSE.Apache-2.0 LICENSE.AGPL-3.0 LICENSE.Boost-1.0 COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package})
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package})
endforeach()

set(CPACK_GENERATOR DEB)
list(TRANSFORM parts REPLACE ":.*" "" OUTPUT_VARIABLE CPACK_COMPONENTS_ALL)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_CONTACT "palpate")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libpalpate-runtime (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_GENERATE_SHLIBS ON)
if(TARGET python)
  execute_process(COMMAND ${PYTHON_EXECUTABLE} -c
    "import sys; a, b = sys.version_info[:2]; print(f'python3 (>= {a}.{b}), python3 (<< {a}.{b + 1})', end='')"
    OUTPUT_VARIABLE python_versions COMMAND_ERROR_IS_FATAL ANY)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_versions}, python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS palpate)  # build(), check(), ... run its tools
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
endif()
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
    "force-deflection responses of soft bodies: compute, fit, look, render")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
    "passive haptic rendering of response databases: shared library")
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "passive haptic rendering of response databases: C header and build files")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "force-deflection responses of soft bodies: Python package")
include(CPack)
