# Flags and helper functions that every target of the project shares.
#
# Same inputs, same bits: floating-point operations are never contracted into fused ones, and no flag
# names the architecture of the machine that builds.
function(slewlab_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                           -Wno-sign-conversion -ffp-contract=off)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:include/slewlab>)
endfunction()

# The runtime of the sanitizer that is built with; empty without one. An interpreter, which has none, has to load it before it
# loads our extension; and with it the C++ runtime, whose functions it stands in front of: an exception would find none behind it.
# Programs that are fuzzed load no extension. Sources ask for SLEWLAB_SANITIZED: each compiler tells of its sanitizers in its own words.
set(SLEWLAB_SANITIZER_RUNTIME "")
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=(address|thread)")
  add_compile_definitions(SLEWLAB_SANITIZED)
  if(NOT CMAKE_CXX_FLAGS MATCHES "fuzzer")
    string(REGEX REPLACE ".*-fsanitize=([at]).*" "\\1san" sanitizer "${CMAKE_CXX_FLAGS}")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      set(runtime libclang_rt.${sanitizer}-${CMAKE_SYSTEM_PROCESSOR}.so)
    else()
      set(runtime lib${sanitizer}.so)
    endif()
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${runtime} OUTPUT_VARIABLE SLEWLAB_SANITIZER_RUNTIME
                    OUTPUT_STRIP_TRAILING_WHITESPACE)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libstdc++.so.6 OUTPUT_VARIABLE cxx_runtime OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # whose programs have a runtime of their own unless they are told of this one
      get_filename_component(runtime_folder ${SLEWLAB_SANITIZER_RUNTIME} DIRECTORY)
      add_link_options(-shared-libsan LINKER:-rpath,${runtime_folder})
    endif()
    string(APPEND SLEWLAB_SANITIZER_RUNTIME ":${cxx_runtime}")
  endif()
endif()

# Headers that most sources include are compiled once for all libraries and once for all programs, which are compiled with -fPIC and with -fPIE
# (cmake/precompiled*.h). Targets that share them have the same flags.
option(SLEWLAB_PRECOMPILE_HEADERS "Compile common headers once" ON)
function(slewlab_precompiled_headers target header)
  target_link_libraries(${target} PRIVATE ${ARGN})
  target_precompile_headers(${target} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/${header})
endfunction()
if(SLEWLAB_PRECOMPILE_HEADERS)
  # GCC 12 takes the short strings of precompiled headers for out of bounds (GCC's bug 105651).
  add_compile_options("$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-Wno-array-bounds;-Wno-stringop-overflow>")
endif()
function(slewlab_use_precompiled target from)
  get_target_property(sources ${target} SOURCES)
  if(SLEWLAB_PRECOMPILE_HEADERS AND NOT "${sources}" MATCHES "[.]c(;|$)")  # those of C would be others
    target_precompile_headers(${target} REUSE_FROM ${from})
    target_include_directories(${target} PRIVATE $<TARGET_PROPERTY:${from},INCLUDE_DIRECTORIES>)
  endif()
endfunction()

# slewlab_compile_together(TARGET...): eight of its sources in one piece. Half of a small source's time goes into what the common headers leave to
# be instantiated in each. OFF compiles them one by one, for who changes one of them again and again.
option(SLEWLAB_COMPILE_TOGETHER "Compile small sources eight at a time" ON)
function(slewlab_compile_together)
  set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ${SLEWLAB_COMPILE_TOGETHER} UNITY_BUILD_BATCH_SIZE 8)
endfunction()

# slewlab_library(NAME SOURCES a.cpp b.cpp LINK PUBLIC x PRIVATE y). All but those of tools/ are installed, for programs of
# others (cmake/SlewlabInstall.cmake).
function(slewlab_library target)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${target} STATIC ${ARG_SOURCES})
  slewlab_flags(${target})
  slewlab_use_precompiled(${target} slewlab_precompiled)
  target_link_libraries(${target} ${ARG_LINK})
  file(RELATIVE_PATH room ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT room MATCHES "^(tools|tests)")
    install(TARGETS ${target} EXPORT slewlab ARCHIVE DESTINATION lib/slewlab COMPONENT development)
  endif()
endfunction()

# slewlab_hot_sources(a.cpp b.cpp): where the steps of runs and fits spend their time. GCC clears small structures by a repeated string
# instruction of x86, whose beginning alone takes longer than a few wide moves.
function(slewlab_hot_sources)
  set(options -O3)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    list(APPEND options -mmemset-strategy=vector_loop:512:noalign,libcall:-1:noalign)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)  # which are made without it
  endif()
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${options}")
endfunction()

# slewlab_program(NAME SOURCES a.cpp LINK x y)
function(slewlab_program target)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${target} ${ARG_SOURCES})
  slewlab_flags(${target})
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  target_compile_definitions(${target} PRIVATE SLEWLAB_VERSION="${PROJECT_VERSION}")
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

# What a test computes itself is little beside what the libraries compute for it: it is compiled in half of the time. Not without
# optimisation: what it shares with the libraries of Eigen's templates, the linker takes from the test.
function(slewlab_test_flags target)
  slewlab_flags(${target})
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # with which GCC 12 follows Eigen's storage less far
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

# slewlab_time_limit(SECONDS TEST...): after which a test counts as failed; under a sanitizer, where programs are five to fifteen times
# slower, ten times that. What is given more time than others is begun before them (COST), so that no core idles beside a long test in
# the end.
function(slewlab_time_limit seconds)
  set(limit ${seconds})
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    math(EXPR limit "10 * ${seconds}")
  endif()
  set_tests_properties(${ARGN} PROPERTIES TIMEOUT ${limit} COST ${seconds})
endfunction()

# slewlab_test(NAME LABELS physics SOURCES a_test.cpp LINK x y [TIMEOUT 60] [WHOLE] [PRIVATE_NETWORK])
# One build line per test program. Every TEST in it becomes a ctest case, unless WHOLE is given (then the
# program is one case: for programs whose set-up is worth sharing). PRIVATE_NETWORK: every case runs inside
# tools/in-private-network, for tests that open LCM multicast. What is given more time than others is begun before them
# (COST), so that no core idles beside a long test in the end.
function(slewlab_test target)
  cmake_parse_arguments(ARG "WHOLE;PRIVATE_NETWORK" "TIMEOUT" "LABELS;SOURCES;LINK" ${ARGN})
  set(cost)
  if(ARG_TIMEOUT)
    set(cost COST ${ARG_TIMEOUT})
  else()
    set(ARG_TIMEOUT 120)
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${target} ${ARG_SOURCES})
  slewlab_test_flags(${target})
  slewlab_use_precompiled(${target} slewlab_precompiled_tests)
  target_link_libraries(${target} PRIVATE ${ARG_LINK} GTest::gtest_main GTest::gtest)
  target_compile_definitions(${target} PRIVATE SLEWLAB_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
                                               SLEWLAB_BINARY_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(ARG_PRIVATE_NETWORK)
    set_target_properties(${target} PROPERTIES CROSSCOMPILING_EMULATOR
                                               ${CMAKE_SOURCE_DIR}/tools/in-private-network)
  endif()
  if(ARG_WHOLE)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} ${cost}
                                              SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
  else()
    gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120
                         PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} ${cost})
  endif()
endfunction()

# slewlab_effect_sources(OUT catalogue.inc .cpp): a file NAME.cpp for every line EFFECT(NAME) of a catalogue, which is the
# only list of effects that there is.
function(slewlab_effect_sources out catalogue suffix)
  get_filename_component(catalogue ${catalogue} ABSOLUTE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${catalogue})
  file(STRINGS ${catalogue} lines REGEX "^EFFECT[(][a-z0-9_]+[)]$")
  set(sources)
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^EFFECT[(](.*)[)]$" "\\1${suffix}" source ${line})
    list(APPEND sources ${source})
  endforeach()
  set(${out} ${sources} PARENT_SCOPE)
endfunction()

# slewlab_page_block(OUT page text): the first fenced block of a page behind a text in it.
function(slewlab_page_block out page text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page})
  file(READ ${page} content)
  string(FIND "${content}" "${text}" place)
  if(place LESS 0)
    message(FATAL_ERROR "${page}: no '${text}'")
  endif()
  string(SUBSTRING "${content}" ${place} -1 content)
  string(FIND "${content}" "```" place)
  string(SUBSTRING "${content}" ${place} -1 content)
  string(FIND "${content}" "\n" place)
  math(EXPR place "${place} + 1")
  string(SUBSTRING "${content}" ${place} -1 content)
  string(FIND "${content}" "```" place)
  string(SUBSTRING "${content}" 0 ${place} content)
  set(${out} "${content}" PARENT_SCOPE)
endfunction()
