# The portable core alone: what the C library needs, of header-only libraries. No OpenSSL,
# CGAL, TetGen, solvers, devices, tools; HDF5 where a folder of it is named. For Linux,
# Windows and WebAssembly (cmake/toolchains).
set(PALPATE_HEADERS /usr/include CACHE PATH "Folder of Eigen, fmt, nlohmann_json headers")
# Links of their own: a compiler for another system must not see all of /usr/include.
foreach(folder fmt nlohmann)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/headers/${folder})
  file(CREATE_LINK ${PALPATE_HEADERS}/${folder}
       ${PROJECT_BINARY_DIR}/headers/${folder}/${folder} SYMBOLIC)
endforeach()
function(palpate_headers target)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${ARGN})
endfunction()
palpate_headers(Eigen3::Eigen ${PALPATE_HEADERS}/eigen3)
palpate_headers(fmt::fmt ${PROJECT_BINARY_DIR}/headers/fmt)
palpate_headers(nlohmann_json::nlohmann_json
  ${PROJECT_SOURCE_DIR}/cmake/toolchains/libcxx ${PROJECT_BINARY_DIR}/headers/nlohmann)
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
set(threads "")
if(WIN32 OR UNIX)
  find_package(Threads REQUIRED)
  set(threads Threads::Threads)
endif()

# HDF5 as packaging/windows/hdf5 makes it. Nothing is recorded all the same.
set(hdf5 "")
if(PALPATE_CORE_HDF5)
  add_library(hdf5::hdf5 STATIC IMPORTED)
  set_target_properties(hdf5::hdf5 PROPERTIES
    IMPORTED_LOCATION ${PALPATE_CORE_HDF5}/lib/libhdf5.a
    INTERFACE_INCLUDE_DIRECTORIES ${PALPATE_CORE_HDF5}/include
    INTERFACE_LINK_LIBRARIES ${PALPATE_CORE_HDF5}/lib/libz.a)
  set(hdf5 hdf5::hdf5)
  set(PALPATE_OTHER_FORMS "/hdf5/without_hdf5\\.cc$|/recording/recording(_writer)?\\.cc$")
endif()

# What Debian's standard library for WebAssembly lacks (cmake/toolchains/wasm.cmake).
if(NOT WIN32 AND NOT UNIX)
  add_library(palpate_wasm STATIC cmake/toolchains/wasm/exceptions.cc)
  target_compile_features(palpate_wasm PRIVATE cxx_std_20)
  link_libraries(palpate_wasm)
endif()
if(CMAKE_SIZEOF_VOID_P EQUAL 4)  # what does not fit in memory cannot be opened
  target_compile_options(palpate_warnings INTERFACE -Wno-shorten-64-to-32)
endif()

# With vector instructions Eigen adds in another order. WebAssembly has none here.
option(PALPATE_SCALAR "Sums in the order of WebAssembly, for comparisons with it" OFF)
if(PALPATE_SCALAR)
  add_compile_definitions(EIGEN_DONT_VECTORIZE)
endif()

# A unity build joins many sources in one object: the linker drops what nobody calls.
add_compile_options(-ffunction-sections -fdata-sections)
add_link_options(-Wl,--gc-sections)

palpate_precompiled_headers()
palpate_library(formats PIC
  ROOMS formats/base formats/stored formats/hdf5 formats/flat formats/forms formats/mesh
        formats/response formats/database formats/recording formats/service
  LEFT_OUT formats/base/\(command_line|command_words|man_page|toml_text\)
  DEPENDS Eigen3::Eigen fmt::fmt
  PRIVATE_DEPENDS ${hdf5} nlohmann_json::nlohmann_json)
palpate_library(fast PIC
  ROOMS runtime/account runtime/element runtime/memory runtime/needle runtime/paper runtime/fast
        runtime/contacts
  DEPENDS Eigen3::Eigen)
# Clang wants the precompiled header's own level of optimisation.
target_compile_options(palpate_fast PRIVATE
                       $<$<AND:$<CXX_COMPILER_ID:GNU>,$<NOT:$<CONFIG:Debug>>>:-O3>)
palpate_library(slow PIC ROOMS runtime/realtime runtime/device runtime/slow
  LEFT_OUT runtime/realtime/stop_signals
           runtime/device/\(device_driver|driven_device|guardian|socket_device|threaded_device\)
  DEPENDS palpate::formats palpate::fast ${threads})
palpate_library(runtime PIC ROOMS runtime/hand runtime/render runtime/served runtime/c_api
  LEFT_OUT runtime/render/\(recorder|render_loop\)
  DEPENDS palpate::slow)
palpate_c_library(palpate::runtime)

# The runtime of a page that needs no server (docs/PAGE.md).
if(NOT WIN32 AND NOT UNIX)
  palpate_library(page ROOMS formats/report runtime/inverse runtime/attach runtime/view
    LEFT_OUT runtime/inverse/\(emulated_|inverse_link|inverse_socket|service_|websocket_\)
             runtime/attach/\(calibration|device_|driven_|falcon_|hung_|probe|usb_\)
             formats/report/\(body_svg|curves_svg|database_|gzip_|log_plot|markup_|page_export|pressure_|relaxation_|standalone_|surface_picture|taxel_\)
             runtime/view/\(served_news|view_connection|view_policy|view_request|view_server|watch_view\)
    DEPENDS palpate::runtime PRIVATE_DEPENDS nlohmann_json::nlohmann_json)
  add_executable(palpate_module runtime/view/page_module.cc)
  target_link_libraries(palpate_module PRIVATE palpate::page palpate_warnings)
  # Functions to call, and no main().
  target_link_options(palpate_module PRIVATE -mexec-model=reactor -Wl,--strip-all)
  set_target_properties(palpate_module PROPERTIES OUTPUT_NAME palpate SUFFIX .wasm
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/share/palpate)
endif()
if(WIN32)
  include(InstallWindows)
endif()
if(BUILD_TESTING)
  add_subdirectory(tests/platforms)
endif()
